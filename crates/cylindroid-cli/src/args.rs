//! The command line as plain data; what it means is worked out in `commands`.

use clap::{Args, Parser, Subcommand, ValueEnum};

mod closed;
mod ik;
pub(crate) mod inverses;
mod move_to;
mod screws;
mod shared;
mod view;
pub(crate) use closed::{
    AssembleArgs, ClosedArgs, GraspArgs, ManipulabilityArgs, MeasureName, MetricName, StaticsArgs,
};
pub(crate) use ik::IkArgs;
pub(crate) use move_to::{
    InverseArgs, LawName, MoveArgs, NullSpaceName, PathArgs, ServoArgs, TargetArgs, TaskAxes,
};

pub(crate) use screws::ScrewsArgs;
pub(crate) use shared::{ConfigurationArgs, FrameArgs};
pub(crate) use view::ViewArgs;

use crate::values::Joints;

const EXAMPLES: &str = "\
Examples:
  cylindroid info panda
  cylindroid jacobian ur5e --q 0,-1.2,1.4,0,1.5,0 --reference local
  cylindroid move panda --to 0.45,0.15,0.35 --rpy 3.1416,0,0.6 --plot move.svg
  cylindroid screws youbot

Exit codes: 0 done, 1 a negative answer (a target not reached, loops or a grasp not closed), 2 an error.";

/// Moves robots in Cartesian space and tells what they can do.
///
/// SI units and radians everywhere: lengths in m, angles in rad, times in s. Twists and the rows of
/// Jacobians are linear first. A <MODEL> is a file (.urdf, .xml of MuJoCo, .sdf, .toml) or a
/// name of the catalogue (`cylindroid models`).
#[derive(Debug, Parser)]
#[command(name = "cylindroid", version, after_help = EXAMPLES, max_term_width = 100)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,

    /// Print one JSON object, numbers in full, instead of tables (infinite numbers are null)
    #[arg(long, global = true)]
    pub(crate) json: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// List the catalogue: robots that can be loaded by name
    Models,
    /// Show what a model is: tree, joints and their limits, frames, what the loader ignored
    Info(InfoArgs),
    /// Forward kinematics: the pose of a frame, world_from_frame
    Fk(FkArgs),
    /// The Jacobian of a frame, its singular values and rank
    Jacobian(JacobianArgs),
    /// Inverse kinematics: configurations that put a frame at a target, within all limits
    #[command(long_about = ik::ABOUT, after_long_help = ik::EXAMPLES)]
    Ik(Box<IkArgs>),
    /// Cartesian control: drive a frame to a target and say whether and how it got there
    #[command(long_about = move_to::ABOUT, after_long_help = move_to::EXAMPLES)]
    Move(Box<MoveArgs>),
    /// The screw system of the joints: class, pitches, frame, and which inverses exist
    #[command(long_about = screws::ABOUT, after_long_help = screws::EXAMPLES)]
    Screws(Box<ScrewsArgs>),
    /// Close the loops of a mechanism from a guess, within its position limits
    #[command(long_about = closed::ASSEMBLE, after_long_help = closed::ASSEMBLE_EXAMPLES)]
    Assemble(Box<AssembleArgs>),
    /// Mobility of a mechanism: how it can move, what is redundant, idle or held twice
    #[command(long_about = closed::MOBILITY, after_long_help = closed::MOBILITY_EXAMPLES)]
    Mobility(Box<ClosedArgs>),
    /// How well motion and force go from the driven joints to the reference frame
    #[command(long_about = closed::MANIPULABILITY, after_long_help = closed::MANIPULABILITY_EXAMPLES)]
    Manipulability(Box<ManipulabilityArgs>),
    /// Joint torques that hold a wrench, and the forces in loops and contacts
    #[command(long_about = closed::STATICS, after_long_help = closed::STATICS_EXAMPLES)]
    Statics(Box<StaticsArgs>),
    /// Force closure of the contacts on an object, and its quality
    #[command(long_about = closed::GRASP, after_long_help = closed::GRASP_EXAMPLES)]
    Grasp(Box<GraspArgs>),
    /// The web viewer: see a model, drag its tool or object, and watch its measures
    #[command(long_about = view::ABOUT, after_long_help = view::EXAMPLES)]
    View(Box<ViewArgs>),
}

#[derive(Debug, Args)]
pub(crate) struct InfoArgs {
    /// A model file or a name of the catalogue
    pub(crate) model: String,
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

    /// Rates of angles instead of an angular velocity in the last three rows [rad/s], world axes
    #[arg(long, value_name = "ANGLES", conflicts_with_all = ["reference", "velocities"])]
    pub(crate) analytical: Option<Angles>,

    /// Also compute the time derivative of the Jacobian at these joint velocities [rad/s or m/s];
    /// format as for --q, joints that are not named are at rest
    #[arg(long, value_name = "VELOCITIES", allow_hyphen_values = true)]
    pub(crate) velocities: Option<Joints>,
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
    /// Euler angles about z, the turned y, the turned z
    Zyz,
    /// The rotation vector, axis times angle
    RotationVector,
}
