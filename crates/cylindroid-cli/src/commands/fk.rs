//! `fk`: where frames are.

use std::io::Write;

use serde::Serialize;

use crate::args::FkArgs;
use crate::commands::shared::{Style, configuration, end_effector, load};
use crate::exit::Exit;
use crate::output::{self, Align, PoseJson};

#[derive(Debug, Serialize)]
struct FkJson<'a> {
    model: &'a str,
    frame: &'a str,
    q: &'a [f64],
    joint_names: Vec<&'a str>,
    outside_limits: Vec<&'a str>,
    /// `world_from_frame`
    pose: PoseJson,
}

#[derive(Debug, Serialize)]
struct AllJson<'a> {
    model: &'a str,
    q: &'a [f64],
    joint_names: Vec<&'a str>,
    outside_limits: Vec<&'a str>,
    frames: Vec<FrameJson<'a>>,
}

#[derive(Debug, Serialize)]
struct FrameJson<'a> {
    frame: &'a str,
    /// `world_from_frame`
    pose: PoseJson,
}

pub(crate) fn run(args: &FkArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    let robot = load(&args.configuration.model, &[])?;
    let state = robot.state(&configuration(&robot, &args.configuration)?)?;
    let outside_limits = output::outside_limits(&robot, state.q());
    let joint_names = output::joint_names(&robot);
    let (model, q) = (robot.name(), state.q());

    if args.all {
        let ids = robot.frame_ids().map(|id| (robot.frame_of(id).name.as_str(), id));
        if style == Style::Json {
            let frames = ids
                .map(|(frame, id)| Ok(FrameJson { frame, pose: state.pose(id)?.into() }))
                .collect::<cylindroid::Result<_>>()?;
            output::json(out, &AllJson { model, q, joint_names, outside_limits, frames })?;
            return Ok(Exit::SUCCESS);
        }
        print_posture(out, model, q, &outside_limits)?;
        let mut columns = vec![("frame", Align::Left)];
        columns.extend(output::POSE_COLUMNS);
        let row = |(name, id): (&str, _)| {
            let mut row = vec![name.to_owned()];
            row.extend(output::pose_cells(state.pose(id)?));
            Ok(row)
        };
        let rows: Vec<_> = ids.map(row).collect::<cylindroid::Result<_>>()?;
        writeln!(out)?;
        output::table(out, &columns, rows)?;
        return Ok(Exit::SUCCESS);
    }

    let end_effector = end_effector(&robot, &args.frame)?;
    let frame = robot.frame_of(end_effector.frame).name.as_str();
    let pose = state.pose(end_effector)?;
    if style == Style::Json {
        let pose = pose.into();
        output::json(out, &FkJson { model, frame, q, joint_names, outside_limits, pose })?;
        return Ok(Exit::SUCCESS);
    }
    print_posture(out, model, q, &outside_limits)?;
    let quaternion = pose.rotation.to_quaternion();
    let cells = output::pose_cells(pose);
    output::pairs(
        out,
        [
            ("frame", frame.to_owned()),
            ("position x, y, z [m]", cells[..3].join(", ")),
            ("roll, pitch, yaw [rad]", cells[3..].join(", ")),
            (
                "quaternion w, x, y, z",
                output::entries(&[quaternion.w, quaternion.x, quaternion.y, quaternion.z]),
            ),
        ],
    )?;
    writeln!(out, "\nworld_from_frame")?;
    let rows: Vec<Vec<f64>> = pose.to_matrix().iter().map(|row| row.to_vec()).collect();
    output::matrix(
        out,
        &["x", "y", "z", ""],
        &["x axis", "y axis", "z axis", "origin [m]"],
        &rows,
    )?;
    Ok(Exit::SUCCESS)
}

fn print_posture(
    out: &mut dyn Write,
    model: &str,
    q: &[f64],
    outside_limits: &[&str],
) -> std::io::Result<()> {
    output::pairs(
        out,
        [
            ("model", model.to_owned()),
            ("q [rad or m]", output::entries(q)),
            ("note", output::outside_note(outside_limits)),
        ],
    )
}
