//! From the arguments of `move` to a job that can be done: options of the servo, start, target.

use cylindroid::control::{
    CartesianMove, CartesianPath, JointDefaults, JointMove, SecondaryNullSpace, SecondaryTask,
    ServoGains, WaypointMove,
};
use cylindroid::model::{Dimension, Mechanism};
use cylindroid::{Error, Pose, Result, ServoOptions, Vec3, tolerance};

use super::super::target::{target_pose, task};
use super::bounds::{check_jerks, joint_defaults, path_bounds, speed_of};
use super::twist_goal::TwistGoal;
use super::waypoints::Waypoints;
use super::{idle, inverse};
use crate::args::{MoveArgs, NullSpaceName, PathArgs, ServoArgs};
use crate::commands::shared::{
    all_actuated, configuration, end_effector, limited, load, within_limits,
};
use crate::values::{Named, Weights};

/// A motion to compute.
#[derive(Debug)]
pub(super) struct Job {
    pub(super) robot: Mechanism,
    pub(super) options: ServoOptions,
    /// Name of the frame that is controlled.
    pub(super) frame: String,
    pub(super) start: Vec<f64>,
    /// The final pose of the tool; components that were not given are as at the start.
    pub(super) target_pose: Pose,
    pub(super) goal: Goal,
    /// The controlled components, in words.
    pub(super) controlled: String,
    pub(super) time_limit: f64,
    /// Whether to reconfigure if the servo alone stalls on its way to a pose.
    pub(super) reconfigure: bool,
    /// For joint moves.
    pub(super) defaults: JointDefaults,
}

/// How the target moves.
#[derive(Debug)]
pub(super) enum Goal {
    /// Not at all.
    Pose(Pose),
    /// Along a path.
    Along(Box<CartesianMove>),
    /// Through waypoints.
    Waypoints(Box<WaypointMove>),
    /// There is none: the joints move.
    Joints(Box<JointMove>),
    /// There is none: the tool follows a twist.
    Twist(TwistGoal),
}

impl Job {
    pub(super) fn new(args: &MoveArgs) -> anyhow::Result<Self> {
        let robot = load(&args.configuration.model, &args.actuated)?;
        let robot = limited(robot, &args.limits)?;
        if !args.actuated.is_empty() && !robot.is_closed() {
            return Err(all_actuated(&robot).into());
        }
        let degrees = args.configuration.degrees;
        let start = configuration(&robot, &args.configuration)?;
        within_limits(&robot, "--q", &start)?;

        check_jerks(&args.path)?;

        let mut options = ServoOptions::new(&robot);
        options.end_effector = end_effector(&robot, &args.frame)?;
        let waypoints = args.path.waypoints.as_deref();
        let waypoints = waypoints.map(|path| Waypoints::read(path, degrees)).transpose()?;
        idle::refuse(args, waypoints.as_ref().is_some_and(Waypoints::are_timed))?;
        let given = waypoints.as_ref().map(|w| [true, w.orientations]);
        let (task, controlled) = task(&args.target, given, &robot)?;
        options.task = task;
        apply(&args.servo, &mut options)?;
        inverse::apply(&args.inverse, &start, &robot, &mut options)?;
        options.secondary = secondary(&args.servo.secondary, &robot, &options, &start)?;
        // Before the target is looked at: a broken option is the clearer message.
        options.check(&robot)?;
        check_steps(args, options.dt)?;

        let defaults = joint_defaults(args);
        let pose = |q: &[f64]| robot.state(q)?.pose(options.end_effector);
        let from = pose(&start)?;
        let (target_pose, goal, controlled) = if let Some(q) = &args.path.joint_to {
            no_loops(&robot)?;
            let q = q.configuration(&robot, args.configuration.model.srdf.as_deref(), degrees)?;
            robot.check_q("--joint-to", &q)?;
            within_limits(&robot, "--joint-to", &q)?;
            let motion = Box::new(JointMove::within_limits(&robot, &start, &q, &defaults)?);
            (pose(&q)?, Goal::Joints(motion), "all joints, straight".to_owned())
        } else if let Some(waypoints) = waypoints {
            let mut bounds = path_bounds(args);
            if waypoints.have_speeds() && args.servo.speed.is_none() {
                bounds.linear.velocity = f64::INFINITY;
            }
            options.speed = speed_of(&bounds);
            let motion = waypoints.motion(from, bounds, &args.path)?;
            let to = motion.at(f64::INFINITY).0;
            (to, Goal::Waypoints(Box::new(motion)), controlled)
        } else if let Some(twist) = TwistGoal::of(&args.path, task)? {
            (twist.end(from, options.task.axes), Goal::Twist(twist), controlled)
        } else {
            let to = target_pose(
                &args.target,
                from,
                degrees,
                ", or with --joint-to q, --waypoints or --twist",
            )?;
            stays_in_plane(&robot, from, to)?;
            let path = path(&args.path, from, to)?;
            let goal = match path {
                None => Goal::Pose(to),
                Some(path) => {
                    let bounds = path_bounds(args);
                    options.speed = speed_of(&bounds);
                    Goal::Along(Box::new(CartesianMove::new(path, bounds)?))
                }
            };
            (to, goal, controlled)
        };
        let frame = robot.frame_of(options.end_effector.frame).name.clone();
        let time_limit = args.time_limit;
        let reconfigure = !args.no_reconfigure && matches!(goal, Goal::Pose(_));
        Ok(Self {
            robot,
            options,
            frame,
            start,
            target_pose,
            goal,
            controlled,
            time_limit,
            reconfigure,
            defaults,
        })
    }
}

/// Steps of a motion at most, and of one whose steps are kept for a file or a picture.
const MOST_STEPS: f64 = 1e9;
const MOST_KEPT: f64 = 1e7;

/// Returns an error for a time limit that is not positive or has too many steps of `dt`.
pub(super) fn check_steps(args: &MoveArgs, dt: f64) -> Result<()> {
    let time_limit = args.time_limit;
    Error::check_positive("--time-limit", time_limit)?;
    let is_kept = args.out.is_some() || args.plot.is_some();
    let most = if is_kept { MOST_KEPT } else { MOST_STEPS };
    if time_limit / dt > most {
        return Err(Error::InvalidOption {
            option: "--time-limit",
            value: format!("{time_limit} s"),
            reason: format!(
                "it has {:.1e} steps of {dt:?} s, more than {most:e}{}; lower it, or take a longer \
                 --dt",
                time_limit / dt,
                if is_kept { ", and each is kept for --out or --plot" } else { "" }
            ),
        });
    }
    Ok(())
}

/// Joints of loops cannot all move straight.
fn no_loops(robot: &Mechanism) -> Result<()> {
    if !robot.is_closed() {
        return Ok(());
    }
    Err(Error::InvalidOption {
        option: "--joint-to",
        value: robot.name().to_owned(),
        reason: "its loops would open if every joint moved straight; give a pose (--to, --rpy)"
            .to_owned(),
    })
}

fn apply(args: &ServoArgs, options: &mut ServoOptions) -> Result<()> {
    if let Some(gain) = args.gain {
        let orientation = gain.angular.unwrap_or(gain.linear);
        options.gain = ServoGains { position: gain.linear, orientation };
    }
    if let Some(speed) = args.speed {
        options.speed.linear = speed.linear;
        options.speed.angular = speed.angular.unwrap_or(f64::INFINITY);
    }
    let set = |to: &mut f64, value: Option<f64>| *to = value.unwrap_or(*to);
    set(&mut options.dt, args.dt);
    set(&mut options.tolerance.position, args.tolerance_position);
    set(&mut options.tolerance.orientation, args.tolerance_orientation);
    options.acceleration = args.acceleration;
    set(&mut options.jerk, args.jerk);
    set(&mut options.length, args.length);
    options.plant = args.plant();
    match &args.joint_weights {
        None => {}
        Some(Weights::Inertia) => options.inertia_weights = true,
        Some(Weights::Diagonal(weights)) => options.joint_weights.clone_from(weights),
        Some(Weights::File(path)) => {
            return Err(Error::InvalidOption {
                option: "--joint-weights",
                value: path.display().to_string(),
                reason: "a servo weights single joints; give a list of weights, or inertia"
                    .to_owned(),
            });
        }
    }
    options.null_space = match args.null_space {
        NullSpaceName::Exact => SecondaryNullSpace::Exact,
        NullSpaceName::Retained => SecondaryNullSpace::Retained,
    };
    Ok(())
}

fn secondary(
    named: &[Named],
    robot: &Mechanism,
    options: &ServoOptions,
    start: &[f64],
) -> Result<Vec<SecondaryTask>> {
    if named.is_empty() {
        return options.default_secondary(robot);
    }
    if let [Named { name, parameters }] = named
        && name == "none"
        && parameters.is_empty()
    {
        return Ok(Vec::new());
    }
    let build = |n: &Named| {
        let task = SecondaryTask::named(&n.name, start)?;
        n.parameters.iter().try_fold(task, |task, (name, value)| task.with(name, *value))
    };
    named.iter().map(build).collect()
}

fn path(args: &PathArgs, from: Pose, to: Pose) -> Result<Option<CartesianPath>> {
    if let Some(via) = args.via {
        return CartesianPath::circle(from, Vec3::from_array(via.0), to).map(Some);
    }
    if args.line { CartesianPath::line(from, to).map(Some) } else { Ok(None) }
}

/// Targets of a planar chain lie in its plane.
fn stays_in_plane(robot: &Mechanism, from: Pose, to: Pose) -> Result<()> {
    let most = tolerance::POSITION.max(1e-9 * robot.reach());
    let (z, plane) = (to.translation.z, from.translation.z);
    if !robot.is_closed() || robot.dimension() != Dimension::Planar || (z - plane).abs() <= most {
        return Ok(());
    }
    Err(Error::InvalidOption {
        option: "--to",
        value: format!("z = {z} m"),
        reason: format!("'{}' moves in the plane z = {plane} m", robot.name()),
    })
}
