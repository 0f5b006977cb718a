//! From the arguments of `move` to a servo of several tasks.

use cylindroid::collision::CollisionModel;
use cylindroid::control::{
    CollisionAvoidance, HalfSpace, MotionTask, PoseTolerance, Task, TaskObjective, TaskServo,
    TaskServoOptions,
};
use cylindroid::model::Mechanism;
use cylindroid::{Error, State};

use super::file;
use crate::args::{FrameTaskArg, LawName, MoveArgs, NullSpaceName};
use crate::commands::distance::collision_model;
use crate::commands::move_to::job::check_steps;
use crate::commands::shared::{
    all_actuated, configuration, end_effector, limited, load, within_limits,
};
use crate::commands::target::{target_pose, task};
use crate::output;
use crate::values::Weights;

/// Distances that are kept where none are given (m).
const GAP: f64 = 0.01;
const MARGIN: f64 = 0.3;

/// A motion with several tasks.
#[derive(Debug)]
pub(super) struct TaskJob {
    pub(super) robot: Mechanism,
    pub(super) servo: TaskServo,
    pub(super) start: Vec<f64>,
    pub(super) time_limit: f64,
    /// Least distance and margin (m), if distances are kept.
    pub(super) distances: Option<(f64, f64)>,
}

impl TaskJob {
    pub(super) fn new(args: &MoveArgs) -> anyhow::Result<Self> {
        refuse_foreign(args)?;
        let robot = load(&args.configuration.model, &args.actuated)?;
        let robot = limited(robot, &args.limits)?;
        if !args.actuated.is_empty() && !robot.is_closed() {
            return Err(all_actuated(&robot).into());
        }
        let start = configuration(&robot, &args.configuration)?;
        within_limits(&robot, "--q", &start)?;
        let (tasks, half_spaces) = tasks(args, &robot, &start)?;
        let mut options = options(args, &robot)?;
        options.half_spaces = half_spaces;
        if let Some(CollisionAvoidance { model, .. }) = &mut options.collisions {
            check_free(model, &robot.state(&start)?)?;
        }
        let distances = options.collisions.as_ref().map(|c| (c.gap, c.margin));
        let servo = TaskServo::new(&robot, tasks, options)?;
        check_steps(args, servo.dt())?;
        Ok(Self { robot, servo, start, time_limit: args.time_limit, distances })
    }
}

/// Refuses a start at which bodies penetrate each other.
fn check_free(model: &mut CollisionModel, start: &State) -> anyhow::Result<()> {
    let mut near = Vec::new();
    model.near(start, 0.0, &mut near)?;
    if let Some(near) = near.iter().find(|near| near.distance < 0.0) {
        let ([a, b], depth) = (model.names(near.pair), output::number(-near.distance));
        anyhow::bail!("--q: {a} and {b} penetrate each other by {depth} m at the start");
    }
    Ok(())
}

/// Refuses options that belong to the servo of one frame.
fn refuse_foreign(args: &MoveArgs) -> anyhow::Result<()> {
    let (path, servo, inverse) = (&args.path, &args.servo, &args.inverse);
    let truncated = inverse.named.inverse.as_deref().is_none_or(|name| name == "truncated");
    let foreign = [
        ("--line", path.line),
        ("--via", path.via.is_some()),
        ("--joint-to", path.joint_to.is_some()),
        ("--waypoints", path.waypoints.is_some()),
        ("--twist", path.twist.is_some()),
        ("--law", path.law != LawName::Trapezoidal),
        ("--duration", path.duration.is_some()),
        ("--acceleration-linear", path.acceleration_linear.is_some()),
        ("--acceleration-angular", path.acceleration_angular.is_some()),
        ("--jerk-linear", path.jerk_linear.is_some()),
        ("--jerk-angular", path.jerk_angular.is_some()),
        ("--speed", servo.speed.is_some()),
        ("--secondary", !servo.secondary.is_empty()),
        ("--null-space", servo.null_space != NullSpaceName::Exact),
        ("--inverse", !truncated),
        ("--give-up", !inverse.named.give_up.is_empty()),
        ("--fallback", inverse.fallback.is_some()),
        ("--no-reconfigure", args.no_reconfigure),
    ];
    let parameter = inverse.named.parameters.0.keys().find(|name| **name != "eps");
    let option = foreign.into_iter().find(|(_, given)| *given).map(|(option, _)| option);
    if let Some(option) = option.or(parameter.and_then(|name| crate::args::inverses::option(name)))
    {
        anyhow::bail!(
            "{option} belongs to the servo of one frame: omit it, or omit --tasks, --task \
             FRAME=..., --avoid and --obstacle"
        );
    }
    Ok(())
}

/// Gain and tolerances where a task has none of its own.
fn usual(args: &MoveArgs) -> anyhow::Result<MotionTask> {
    let mut usual = MotionTask::new("", TaskObjective::Posture { q: Vec::new() });
    if let Some(gain) = args.servo.gain {
        if gain.angular.is_some_and(|angular| angular != gain.linear) {
            anyhow::bail!("--gain: a task has one gain for its position and orientation");
        }
        usual.gain = gain.linear;
    }
    let PoseTolerance { position, orientation } = &mut usual.tolerance;
    *position = args.servo.tolerance_position.unwrap_or(*position);
    *orientation = args.servo.tolerance_orientation.unwrap_or(*orientation);
    Ok(usual)
}

/// The target of the arguments, the tasks of frames, and those of the file with its half-spaces.
fn tasks(
    args: &MoveArgs,
    robot: &Mechanism,
    start: &[f64],
) -> anyhow::Result<(Vec<MotionTask>, Vec<HalfSpace>)> {
    let (usual, state) = (usual(args)?, robot.state(start)?);
    let degrees = args.configuration.degrees;
    let (mut tasks, mut half_spaces) = (Vec::new(), Vec::new());
    let of =
        |name: &str, objective| MotionTask { name: name.to_owned(), objective, ..usual.clone() };
    let frames = args.target.frame_tasks()?;
    let target = &args.target;
    let is_given = target.to.is_some()
        || target.rpy.is_some()
        || target.quaternion.is_some()
        || target.rotation_vector.is_some();
    if is_given || (frames.is_empty() && args.tasks.tasks.is_none()) {
        let end_effector = end_effector(robot, &args.frame)?;
        let (components, _) = task(target, None, robot)?;
        let from = state.pose(end_effector)?;
        let other = ", with --task FRAME=X,Y,Z or with --tasks FILE.toml";
        let pose = target_pose(target, from, degrees, other)?;
        let name = robot.frame_of(end_effector.frame).name.clone();
        let target = pose.into();
        tasks.push(of(&name, TaskObjective::Frame { end_effector, components, target }));
    } else if args.frame.frame.is_some() || args.frame.tool.is_some() {
        let option = if args.frame.frame.is_some() { "--frame" } else { "--tool" };
        anyhow::bail!("{option}: there is no target for it; add --to or an orientation");
    }
    for arg in &frames {
        let FrameTaskArg { frame, rpy, .. } = arg;
        let end_effector = robot.frame(frame)?.into();
        let components = if rpy.is_some() { Task::POSE } else { Task::POSITION };
        let target = arg.target(degrees).into();
        tasks.push(of(frame, TaskObjective::Frame { end_effector, components, target }));
    }
    if let Some(path) = &args.tasks.tasks {
        let (own, walls) = file::load(path, &state, &usual)?;
        tasks.extend(own);
        half_spaces = walls;
    }
    Ok((tasks, half_spaces))
}

fn options(args: &MoveArgs, robot: &Mechanism) -> anyhow::Result<TaskServoOptions> {
    let mut options = TaskServoOptions::new(robot);
    let set = |to: &mut f64, value: Option<f64>| *to = value.unwrap_or(*to);
    set(&mut options.dt, args.servo.dt);
    set(&mut options.length, args.servo.length);
    set(&mut options.acceleration, args.servo.acceleration);
    set(&mut options.jerk, args.servo.jerk);
    options.plant = args.servo.plant();
    options.keep_directions = !args.tasks.least_squares;
    set(&mut options.eps, args.inverse.named.parameters.0.get("eps").copied());
    match &args.servo.joint_weights {
        None => {}
        Some(Weights::Diagonal(weights)) => options.joint_weights.clone_from(weights),
        Some(Weights::Inertia | Weights::File(_)) => {
            return Err(Error::InvalidOption {
                option: "--joint-weights",
                value: String::new(),
                reason: "several tasks take a list of weights".to_owned(),
            }
            .into());
        }
    }
    if args.tasks.avoids() {
        let (gap, margin) = (args.tasks.gap.unwrap_or(GAP), args.tasks.margin.unwrap_or(MARGIN));
        if let Err(Error::InvalidOption { value, reason, .. }) =
            CollisionAvoidance::check_distances(gap, margin)
        {
            anyhow::bail!("--gap and --margin = {value} cannot be used: {reason}");
        }
        let model = collision_model(
            robot,
            &args.tasks.collision,
            args.configuration.model.srdf.as_deref(),
        )?;
        options.collisions = Some(CollisionAvoidance { model, gap, margin });
    } else if let Some(option) = args.tasks.without_effect() {
        anyhow::bail!("{option} has no effect without --avoid or --obstacle");
    }
    Ok(options)
}
