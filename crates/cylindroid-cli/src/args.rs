//! The command line as plain data, interpreted in `commands`.

use clap::{Args, Parser, Subcommand, ValueEnum};

mod closed;
mod distance;
mod ik;
pub(crate) mod inverses;
mod manual;
mod map;
mod move_to;
mod optimise;
mod screws;
mod shared;
mod sweep;
mod tasks;
mod view;
mod zone;
pub(crate) use closed::{
    AssembleArgs, ClosedArgs, GraspArgs, ManipulabilityArgs, MeasureName, MetricName, MobilityArgs,
    StaticsArgs,
};
pub(crate) use distance::{CollisionArgs, DistanceArgs, MeshName};
pub(crate) use ik::IkArgs;
pub(crate) use manual::{CompletionsArgs, ManArgs};
pub(crate) use map::MapArgs;
pub(crate) use move_to::{
    InverseArgs, LawName, MoveArgs, NullSpaceName, PathArgs, ServoArgs, TargetArgs, TaskAxes,
};

pub(crate) use optimise::OptimiseArgs;
pub(crate) use screws::ScrewsArgs;
pub(crate) use shared::{ConfigurationArgs, FrameArgs, LimitsArgs, MOST, ModelArgs};
pub(crate) use sweep::{AxisArg, Count, SweepArgs};
pub(crate) use tasks::{FrameTaskArg, TasksArgs};
pub(crate) use view::ViewArgs;
pub(crate) use zone::ZoneArgs;

use self::inverses::NamedInverseArgs;
use crate::values::{Joints, Motion};

const EXAMPLES: &str = "\
Examples:
  cylindroid info panda
  cylindroid jacobian ur5e --q 0,-1.2,1.4,0,1.5,0 --reference local
  cylindroid move panda --to 0.45,0.15,0.35 --rpy 3.1416,0,0.6 --plot move.svg
  cylindroid screws youbot

`cylindroid ros2` is a ROS 2 node, a program of its own: cylindroid-ros2.

Exit codes: 0 success, 1 negative answer (target not reached, loops or grasp not closed, collision), \
2 error.";

const JACOBIAN_EXAMPLES: &str = "\
Examples:
  cylindroid jacobian ur5e --twist 0.1,0,0,0,0,0.2 --eps 1e-3 --length 0.8
  cylindroid jacobian youbot --twist 0.05,0,0,0,0.1,0 --inverse hyperbolic --h 0.1
  cylindroid jacobian five-bar --twist x

The inverse is printed if --twist, --inverse or a parameter of an inverse is given. In a closed \
chain its joint velocities keep the loops closed, with the least motion of the actuated joints.";

/// Computes the kinematics and capabilities of robots and mechanisms, and controls them in
/// Cartesian space.
///
/// All quantities are in SI units and radians. Twists and rows of Jacobians have the linear part
/// first. A <MODEL> is a file (.urdf, .xml of MuJoCo, .sdf, .toml) or a catalogue name
/// (`cylindroid models`).
#[derive(Debug, Parser)]
#[command(name = "cylindroid", version, after_help = EXAMPLES, max_term_width = 100)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,

    /// Print one JSON object with full precision instead of tables (infinite values are null)
    #[arg(long, global = true)]
    pub(crate) json: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// List the built-in robots, which can be loaded by name
    Models,
    /// Show a model: tree, joints and their limits, frames, elements ignored by the loader
    Info(InfoArgs),
    /// Forward kinematics: the pose of a frame, world_from_frame
    Fk(FkArgs),
    /// The Jacobian of a frame, its singular values, rank and inverse
    #[command(after_long_help = JACOBIAN_EXAMPLES)]
    Jacobian(Box<JacobianArgs>),
    /// Inverse kinematics: configurations that bring a frame to a target, within all limits
    #[command(long_about = ik::ABOUT, after_long_help = ik::EXAMPLES)]
    Ik(Box<IkArgs>),
    /// Cartesian control: move a frame to a target and report whether and how it was reached
    #[command(long_about = move_to::ABOUT, after_long_help = move_to::EXAMPLES)]
    Move(Box<MoveArgs>),
    /// The screw system of the joints: class, pitches, frame, and which inverses exist
    #[command(long_about = screws::ABOUT, after_long_help = screws::EXAMPLES)]
    Screws(Box<ScrewsArgs>),
    /// Distances between links that can collide, and from links to obstacles
    #[command(long_about = distance::ABOUT, after_long_help = distance::EXAMPLES)]
    Distance(Box<DistanceArgs>),
    /// Close the loops of a mechanism from an initial guess, within its position limits
    #[command(long_about = closed::ASSEMBLE, after_long_help = closed::ASSEMBLE_EXAMPLES)]
    Assemble(Box<AssembleArgs>),
    /// Mobility of a mechanism: degrees of freedom, redundant and idle motions, overconstraint
    #[command(long_about = closed::MOBILITY, after_long_help = closed::MOBILITY_EXAMPLES)]
    Mobility(Box<MobilityArgs>),
    /// Manipulability: transmission of motion and force from actuated joints to a reference frame
    #[command(long_about = closed::MANIPULABILITY, after_long_help = closed::MANIPULABILITY_EXAMPLES)]
    Manipulability(Box<ManipulabilityArgs>),
    /// Statics: joint torques that balance a wrench, and the forces in loops and contacts
    #[command(long_about = closed::STATICS, after_long_help = closed::STATICS_EXAMPLES)]
    Statics(Box<StaticsArgs>),
    /// Force closure of the contacts on an object, and grasp quality
    #[command(long_about = closed::GRASP, after_long_help = closed::GRASP_EXAMPLES)]
    Grasp(Box<GraspArgs>),
    /// Quantities of millions of configurations: samples, grids or files, into Parquet
    #[command(long_about = sweep::ABOUT, after_long_help = sweep::EXAMPLES)]
    Sweep(Box<SweepArgs>),
    /// Optimal designs: parameters of a mechanism file for the best indices, and their trade-offs
    #[command(long_about = optimise::ABOUT, after_long_help = optimise::EXAMPLES)]
    Optimise(Box<OptimiseArgs>),
    /// The workspace in the platform's coordinates, per working mode, with singularity loci
    #[command(long_about = map::ABOUT, after_long_help = map::EXAMPLES)]
    Map(Box<MapArgs>),
    /// The largest ball or box without singularities around a configuration
    #[command(long_about = zone::ABOUT, after_long_help = zone::EXAMPLES)]
    Zone(Box<ZoneArgs>),
    /// The web viewer: display a model, drag its tool or object, and monitor its measures
    #[command(long_about = view::ABOUT, after_long_help = view::EXAMPLES)]
    View(Box<ViewArgs>),
    /// Completions of commands and options for a shell
    #[command(long_about = manual::COMPLETIONS, after_long_help = manual::COMPLETIONS_EXAMPLES)]
    Completions(CompletionsArgs),
    /// Manual pages: one of the binary and one of each command
    #[command(long_about = manual::MAN, after_long_help = manual::MAN_EXAMPLES)]
    Man(ManArgs),
}

#[derive(Debug, Args)]
pub(crate) struct InfoArgs {
    #[command(flatten)]
    pub(crate) model: ModelArgs,

    #[command(flatten)]
    pub(crate) limits: LimitsArgs,
}

#[derive(Debug, Args)]
pub(crate) struct FkArgs {
    #[command(flatten)]
    pub(crate) configuration: ConfigurationArgs,

    #[command(flatten)]
    pub(crate) frame: FrameArgs,

    /// Every frame of the model
    #[arg(long, conflicts_with_all = ["frame", "tool"])]
    pub(crate) all: bool,
}

#[derive(Debug, Args)]
pub(crate) struct JacobianArgs {
    #[command(flatten)]
    pub(crate) configuration: ConfigurationArgs,

    #[command(flatten)]
    pub(crate) frame: FrameArgs,

    /// Point and axes of the twist: `local` (the frame's origin, its axes), `world` (the world's
    /// origin and axes), `local_world_aligned` (the frame's origin, the world's axes)
    #[arg(long, value_name = "NAME", default_value = "local_world_aligned")]
    pub(crate) reference: ReferenceName,

    /// The twist of --frame relative to this frame, which may move, at the origin of --frame and in
    /// the axes of this one; joints that carry both do not count
    #[arg(long, value_name = "FRAME", conflicts_with_all = ["reference", "analytical", "velocities"])]
    pub(crate) relative_to: Option<String>,

    /// Angle rates instead of an angular velocity in the last three rows [rad/s], world axes
    #[arg(long, value_name = "ANGLES", conflicts_with_all = ["reference", "velocities"])]
    pub(crate) analytical: Option<Angles>,

    /// Also compute the time derivative of the Jacobian at these joint velocities [rad/s or m/s];
    /// format as for --q, joints that are not named are at rest
    #[arg(long, value_name = "VELOCITIES", allow_hyphen_values = true)]
    pub(crate) velocities: Option<Joints>,

    /// Characteristic length that divides the linear rows for singular values, rank and inverse [m]
    /// [default: that of the model]
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(crate) length: Option<f64>,

    /// Print the inverse and the joint velocities for this twist `vx,vy,vz,wx,wy,wz` [m/s, rad/s],
    /// or for 1 m/s or 1 rad/s along x, y, z, rx, ry or rz; point and axes are those of --reference
    #[arg(long, value_name = "TWIST", allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["analytical", "relative_to"])]
    #[arg(help_heading = "Inverse")]
    pub(crate) twist: Option<Motion>,

    #[command(flatten, next_help_heading = "Inverse")]
    pub(crate) inverse: NamedInverseArgs,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub(crate) enum ReferenceName {
    /// The frame's origin, the frame's axes
    Local,
    /// The world's origin, the world's axes
    World,
    /// The frame's origin, the world's axes
    LocalWorldAligned,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Angles {
    /// Roll, pitch, yaw about the fixed x, y, z
    Rpy,
    /// Euler angles about z, the rotated y, the rotated z
    Zyz,
    /// Euler angles about x, the rotated y, the rotated z
    Xyz,
    /// The rotation vector, axis times angle
    RotationVector,
}
