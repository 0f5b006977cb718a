//! The arguments of `move`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use cylindroid::control::{Plant, SecondaryTask};
use cylindroid::inverse::Parameter;
use cylindroid::{Error, Result};

use super::inverses::NamedInverseArgs;
use super::{ConfigurationArgs, FrameArgs, FrameTaskArg, LimitsArgs, TasksArgs};
use crate::values::{Joints, Named, Numbers, Pair, Weights};

pub(crate) const ABOUT: &str = "\
Cartesian control: move a frame to a target and report whether and how it was reached

A servo with period dt controls an ideal robot: joint velocities = J+ (gain * error + \
feed-forward), within the limits of all joints, until both errors are within tolerance, the error \
no longer falls, or the time limit is reached. Without an orientation only the position is \
controlled, and vice versa. With --line, --via or --waypoints the target moves along a path, with --joint-to \
every joint moves straight to its goal, with --twist the tool follows a twist. If the servo stalls on its way to a pose that another \
configuration within all limits reaches, the robot reconfigures: every joint moves straight to \
that configuration instead (--no-reconfigure keeps the motion of the servo).

With --avoid or --obstacle links keep a distance from each other and from obstacles. Several \
tasks with priorities and weights come from --task FRAME=... and from a file (--tasks): frames, \
frames relative to each other, the centre of mass, the gaze of a frame, a posture, joint \
velocities. Such a motion ends when every task is reached or stalled, and each task reports what \
stops it.

Mechanisms with loops or contacts are controlled at their reference, through their actuated joints \
(--actuated) with minimum effort; passive joints follow, loops stay closed, and the motion stops \
before a type II singularity, where the object would gain an uncontrolled motion.

Exit code 0 if the target was reached, 1 if not, 2 on an error.";

pub(crate) const EXAMPLES: &str = "\
Examples:
  cylindroid move panda --to 0.45,0.15,0.35 --rpy 3.1416,0,0.6
  cylindroid move ur5e --to -0.3,0.4,0.5 --inverse damped --damping 0.05 --out move.csv
  cylindroid move panda --to 0.45,0.15,0.35 --line --speed 0.1 --plot line.svg
  cylindroid move youbot --to 0.35,0,0.25 --rpy 0,2,0 --inverse hyperbolic --h 0.1
  cylindroid move stewart --to 0.1,0.05,1.1 --rpy 0,0,0.1
  cylindroid move five-bar --actuated q1,q5 --to 1.2,1.8,0
  cylindroid move docs/cell.toml --to 0.4,0,0.4 --avoid --obstacle ball=sphere:0.1@0.4,0.1,0.3
  cylindroid move docs/cell.toml --task hand_tcp=0.4,0.1,0.5 --avoid --gap 0.005
  cylindroid move panda --tasks docs/tasks.toml
  cylindroid move panda --twist 0,0,-0.1,0,0,0 --duration 2

A file of tasks has a table [[task]] for each, with `type` and its keys: frame (frame, xyz, rpy, \
tool, components, axes), relative_frame (frame, reference, xyz, rpy, tool, components), \
center_of_mass (xyz, components), gaze (frame, point, tool), posture (q) and joint_velocities \
(velocities); and with name, level (0 first), weight, gain, tolerance_position and \
tolerance_orientation. Lengths are in m, angles in rad; the default target is the start.

An obstacle is NAME=SHAPE@X,Y,Z or NAME=SHAPE@X,Y,Z,ROLL,PITCH,YAW [m, rad], see `distance \
--help`.";

#[derive(Debug, Args)]
pub(crate) struct MoveArgs {
    #[command(flatten)]
    pub(crate) configuration: ConfigurationArgs,

    #[command(flatten)]
    pub(crate) frame: FrameArgs,

    #[command(flatten)]
    pub(crate) limits: LimitsArgs,

    /// Actuated joints of a mechanism with loops, overriding those of the file
    #[arg(long, value_name = "JOINTS", value_delimiter = ',')]
    pub(crate) actuated: Vec<String>,

    #[command(flatten)]
    pub(crate) target: TargetArgs,

    #[command(flatten)]
    pub(crate) tasks: TasksArgs,

    #[command(flatten)]
    pub(crate) path: PathArgs,

    #[command(flatten)]
    pub(crate) servo: ServoArgs,

    #[command(flatten)]
    pub(crate) inverse: InverseArgs,

    /// If the servo stalls, do not reconfigure through joint space
    #[arg(long)]
    pub(crate) no_reconfigure: bool,

    /// Stop after this time [s]
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, allow_hyphen_values = true)]
    pub(crate) time_limit: f64,

    /// Write the motion: time, q, joint velocities, pose, errors, singular value ratio of every step,
    /// and the limits that bound a joint; with several tasks the poses, errors and scales of all, and
    /// the nearest distance
    #[arg(long, value_name = "FILE.csv|FILE.json")]
    pub(crate) out: Option<PathBuf>,

    /// Draw joints, errors and singular value ratio over time; with several tasks their realised
    /// velocities and the nearest distance
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) plot: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Target")]
pub(crate) struct TargetArgs {
    /// Position of the tool in the world [m]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub(crate) to: Option<Numbers<3>>,

    /// Orientation: roll, pitch, yaw about the fixed x, y, z [rad]
    #[arg(long, value_name = "R,P,Y", allow_hyphen_values = true, group = "orientation")]
    pub(crate) rpy: Option<Numbers<3>>,

    /// Orientation: quaternion of any length but zero
    #[arg(long, value_name = "W,X,Y,Z", allow_hyphen_values = true, group = "orientation")]
    pub(crate) quaternion: Option<Numbers<4>>,

    /// Orientation: axis times angle [rad]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, group = "orientation")]
    pub(crate) rotation_vector: Option<Numbers<3>>,

    /// Controlled components: `pose`, `position`, `orientation`, `pointing` (position and direction of
    /// the tool's z axis), or components like `x,y,rz` [default: those of the target]. Where the
    /// task asks for more than the target gives, the start's position or orientation is kept. Also
    /// FRAME=X,Y,Z or FRAME=X,Y,Z,ROLL,PITCH,YAW: a task of another frame [m, rad]; may be given
    /// several times
    #[arg(long, value_name = "TASK")]
    pub(crate) task: Vec<String>,

    /// Axes of the components [default: world; local, the tool's, for `pointing`]
    #[arg(long, value_name = "AXES")]
    pub(crate) task_axes: Option<TaskAxes>,
}

impl TargetArgs {
    /// The components; several are an error.
    pub(crate) fn components(&self) -> Result<Option<&str>> {
        let mut named = self.task.iter().filter(|task| !task.contains('='));
        match (named.next(), named.next()) {
            (first, None) => Ok(first.map(String::as_str)),
            (_, Some(second)) => Err(Error::InvalidOption {
                option: "--task",
                value: second.clone(),
                reason: "the components are given twice; a task of another frame is FRAME=X,Y,Z"
                    .to_owned(),
            }),
        }
    }

    /// True if there are tasks of frames.
    pub(crate) fn has_frame_tasks(&self) -> bool {
        self.task.iter().any(|task| task.contains('='))
    }

    /// The tasks of frames.
    pub(crate) fn frame_tasks(&self) -> Result<Vec<FrameTaskArg>> {
        let frames = self.task.iter().filter(|task| task.contains('='));
        let parse = |text: &String| {
            text.parse().map_err(|reason| Error::InvalidOption {
                option: "--task",
                value: text.clone(),
                reason,
            })
        };
        frames.map(parse).collect()
    }
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Paths and time laws")]
pub(crate) struct PathArgs {
    /// Move the target along the straight line from the start, from rest to rest
    #[arg(long, requires = "to")]
    pub(crate) line: bool,

    /// Move the target along the arc of the circle through this point [m]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, conflicts_with = "line")]
    #[arg(requires = "to")]
    pub(crate) via: Option<Numbers<3>>,

    /// Move every joint straight to this configuration, all ending together; as --q
    #[arg(long, value_name = "Q", allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["to", "orientation", "line", "via", "task", "task_axes"])]
    pub(crate) joint_to: Option<Joints>,

    /// Move through the poses of a file without stopping, from the start to the last one: rows
    /// `x,y,z` or `x,y,z,qw,qx,qy,qz` [m], with a time [s] before them if they have one. A header
    /// may name the columns, in any order: `x`, `y`, `z`, and `qw`, `qx`, `qy`, `qz` or `roll`,
    /// `pitch`, `yaw` [rad], and `time` (or `t`) or `speed` [m/s], the largest on the way to the row,
    /// which --speed bounds only if it is given
    #[arg(long, value_name = "FILE.csv")]
    #[arg(conflicts_with_all = ["to", "orientation", "line", "via", "joint_to"])]
    pub(crate) waypoints: Option<PathBuf>,

    /// Follow this twist of the tool [m/s, rad/s] for --duration, in the axes of --task-axes, then
    /// stop
    #[arg(long, value_name = "VX,VY,VZ,WX,WY,WZ", allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["to", "orientation", "line", "via", "joint_to", "waypoints"])]
    pub(crate) twist: Option<Numbers<6>>,

    /// Time for which --twist is commanded [s] [default: 1]
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, requires = "twist")]
    pub(crate) duration: Option<f64>,

    /// Time law of --line, --via and --joint-to; --waypoints takes the trapezoidal one
    #[arg(long, value_name = "LAW", default_value = "trapezoidal")]
    pub(crate) law: LawName,

    /// Acceleration on the path, and of sliding joints without a limit [m/s^2] [default: 1]
    #[arg(long, value_name = "A", allow_hyphen_values = true)]
    pub(crate) acceleration_linear: Option<f64>,

    /// Angular acceleration on the path, and of rotating joints without a limit [rad/s^2]
    /// [default: 4]
    #[arg(long, value_name = "A", allow_hyphen_values = true)]
    pub(crate) acceleration_angular: Option<f64>,

    /// Jerk on the path with the law jerk-limited [m/s^3] [default: 10]
    #[arg(long, value_name = "J", allow_hyphen_values = true)]
    pub(crate) jerk_linear: Option<f64>,

    /// Angular jerk on the path, and jerk of joints, with the law jerk-limited [rad/s^3]
    /// [default: 40]
    #[arg(long, value_name = "J", allow_hyphen_values = true)]
    pub(crate) jerk_angular: Option<f64>,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Servo")]
pub(crate) struct ServoArgs {
    /// Gain, or gains of position and orientation [1/s]; gain * dt below 2 [default: 5]
    #[arg(long, value_name = "K[,K]", allow_hyphen_values = true)]
    pub(crate) gain: Option<Pair>,

    /// Time between steps [s] [default: 0.001]
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    pub(crate) dt: Option<f64>,

    /// Position error at which the target counts as reached [m] [default: 1e-6]
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(crate) tolerance_position: Option<f64>,

    /// Orientation error at which the target counts as reached [rad] [default: 1e-6]
    #[arg(long, value_name = "RAD", allow_hyphen_values = true)]
    pub(crate) tolerance_orientation: Option<f64>,

    /// Largest speed of the tool [m/s], and largest angular speed [rad/s] [default: what the
    /// joints allow; on paths 0.25 m/s and 1 rad/s]
    #[arg(long, value_name = "V[,W]", allow_hyphen_values = true)]
    pub(crate) speed: Option<Pair>,

    /// Acceleration limit of joints that have none in the model [rad/s^2 or m/s^2]; inf for none
    /// [default: 20 rad/s^2, or lengths of the mechanism/s^2, the default ramp; none with
    /// several tasks]
    #[arg(long, value_name = "A", allow_hyphen_values = true)]
    pub(crate) acceleration: Option<f64>,

    /// Jerk limit of joints that have none in the model [rad/s^3 or m/s^3] [default: none]
    #[arg(long, value_name = "J", allow_hyphen_values = true)]
    pub(crate) jerk: Option<f64>,

    /// The robot is behind its commands: time until they arrive at its drives [s] [default: 0]
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    pub(crate) delay: Option<f64>,

    /// Time constant of its drives [s] [default: 0]
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    pub(crate) time_constant: Option<f64>,

    /// Largest error of its encoders [rad or m] [default: 0]
    #[arg(long, value_name = "RAD", allow_hyphen_values = true)]
    pub(crate) noise: Option<f64>,

    /// Length that scales the linear rows of the Jacobian for the inverse and for singular values
    /// [m] [default: that of the model]
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(crate) length: Option<f64>,

    /// Weights of joint velocities, one for each coordinate: a large one keeps a joint almost at
    /// rest. `inertia`: the diagonal of the mass matrix, at the configuration of every step
    /// [default: 1; of slides beside joints that turn 1/L^2 with the length L of the model, but not
    /// with tasks]
    #[arg(long, value_name = "WEIGHTS", allow_hyphen_values = true)]
    pub(crate) joint_weights: Option<Weights>,

    #[arg(long, value_name = "NAME[=GAIN][,PARAMETER=VALUE]|none", help = secondary_help())]
    pub(crate) secondary: Vec<Named>,

    /// The null space that they may use: `exact` never disturbs the task, `retained` also lets
    /// them through directions that the inverse cut
    #[arg(long, value_name = "NAME", default_value = "exact")]
    pub(crate) null_space: NullSpaceName,
}

/// The tasks and their parameters, from the library's table.
fn secondary_help() -> String {
    let named = SecondaryTask::all(&[]).map(|task| {
        let of = |p: &Parameter| match p.unit {
            "-" => format!("{}={}", p.name, p.default),
            unit => format!("{}={} {unit}", p.name, p.default),
        };
        let parameters: Vec<String> = task.parameters().iter().map(of).collect();
        format!("{} ({})", task.name(), parameters.join(", "))
    });
    format!(
        "Secondary task in the null space of the primary one: {}; posture is that of the start; \
         may be given several times [default: limit-avoidance for redundant arms and closed \
         chains, otherwise none]",
        named.join(", ")
    )
}

impl ServoArgs {
    /// The robot that is simulated, and that the servo knows.
    pub(crate) fn plant(&self) -> Plant {
        Plant {
            delay: self.delay.unwrap_or(0.0),
            time_constant: self.time_constant.unwrap_or(0.0),
            noise: self.noise.unwrap_or(0.0),
        }
    }
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Inverse")]
pub(crate) struct InverseArgs {
    #[command(flatten)]
    pub(crate) named: NamedInverseArgs,

    /// Inverse used where the chosen one does not exist or enlarges motions too much: `truncated`,
    /// `hyperbolic-damped`, `hyperbolic-gram`, `hyperbolic`, `oblique` [default: none, the arm
    /// stops and reports the reason]
    #[arg(long, value_name = "NAME")]
    pub(crate) fallback: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum TaskAxes {
    /// The tool's
    Local,
    /// The world's
    World,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum LawName {
    /// Constant acceleration, constant speed, constant deceleration
    Trapezoidal,
    /// The same with bounded jerk
    JerkLimited,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum NullSpaceName {
    /// Never disturbs the task
    Exact,
    /// Also the directions that the inverse cut
    Retained,
}
