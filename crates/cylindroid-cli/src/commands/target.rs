//! Where a tool shall be, and what of that matters: the target of `move` and `ik`.

use cylindroid::control::Task;
use cylindroid::model::Mechanism;
use cylindroid::spatial::{Quaternion, Rpy};
use cylindroid::{Error, Pose, ReferenceFrame, Result, Rotation, Vec3};

use crate::args::{TargetArgs, TaskAxes};
use crate::output::number;

/// The task, and what is controlled in words. Waypoints say whether they give positions and
/// orientations.
pub(super) fn task(
    args: &TargetArgs,
    waypoints: Option<[bool; 2]>,
    robot: &Mechanism,
) -> Result<(Task, String)> {
    let of_pose = args.rpy.is_some() || args.quaternion.is_some() || args.rotation_vector.is_some();
    let [position, orientation] = waypoints.unwrap_or([args.to.is_some(), of_pose]);
    let components = args.components()?;
    let named = match (components, position, orientation) {
        (Some(task), ..) => task,
        (None, true, false) => "position",
        (None, false, true) => "orientation",
        (None, ..) => "pose",
    };
    let mut task = Task::named(named, robot)?;
    match args.task_axes {
        None => {}
        Some(TaskAxes::Local) => task.axes = ReferenceFrame::Local,
        Some(TaskAxes::World) => task.axes = ReferenceFrame::LocalWorldAligned,
    }
    let controlled = match (components, named) {
        (None, "position") => {
            "position only (--rpy, --quaternion or --rotation-vector give an orientation)".into()
        }
        (None, "orientation") => "orientation only (--to gives a position)".into(),
        (None, _) => "position and orientation".into(),
        (_, "pose") if !orientation => {
            "position and orientation, the orientation kept as at the start".into()
        }
        (_, "pose") if !position => {
            "position and orientation, the position kept as at the start".into()
        }
        (_, "pose") => "position and orientation".into(),
        _ => {
            let names = Task::COMPONENTS.iter().zip(task.components).filter(|(_, on)| *on);
            let names: Vec<&str> = names.map(|(name, _)| *name).collect();
            let axes = if task.axes == ReferenceFrame::Local { "tool" } else { "world" };
            format!("{} along and about the axes of the {axes}", names.join(", "))
        }
    };
    Ok((task, controlled))
}

/// Lines of a table with the errors of position and orientation, where they matter.
pub(super) fn errors(task: Task, position: f64, orientation: f64) -> [(&'static str, String); 2] {
    let (linear, angular) = task.components.split_at(3);
    let controlled = |components: &[bool], value: f64| {
        if components.contains(&true) { number(value) } else { "not controlled".to_owned() }
    };
    [
        ("position error [m]", controlled(linear, position)),
        ("orientation error [rad]", controlled(angular, orientation)),
    ]
}

/// What is given of the target, the rest as at the start; where nothing is, the error has the
/// `other` ways to say where.
pub(super) fn target_pose(
    args: &TargetArgs,
    from: Pose,
    degrees: bool,
    other: &str,
) -> anyhow::Result<Pose> {
    let si = |x: f64| if degrees { x.to_radians() } else { x };
    let mut pose = from;
    let mut given = false;
    if let Some(to) = args.to {
        Error::check_finite("--to", &to.0)?;
        pose.translation = Vec3::from_array(to.0);
        given = true;
    }
    let rotation = if let Some(rpy) = args.rpy {
        Error::check_finite("--rpy", &rpy.0)?;
        let [roll, pitch, yaw] = rpy.0.map(si);
        Some(Rpy { roll, pitch, yaw }.rotation())
    } else if let Some(vector) = args.rotation_vector {
        Error::check_finite("--rotation-vector", &vector.0)?;
        Some(Rotation::exp(Vec3::from_array(vector.0.map(si))))
    } else if let Some(quaternion) = args.quaternion {
        let [w, x, y, z] = quaternion.0;
        Some(Quaternion { w, x, y, z }.rotation()?)
    } else {
        None
    };
    if let Some(rotation) = rotation {
        pose.rotation = rotation;
        given = true;
    }
    if given {
        return Ok(pose);
    }
    anyhow::bail!(
        "no target: say where with --to x,y,z, or with an orientation (--rpy, --quaternion, \
         --rotation-vector){other}"
    )
}
