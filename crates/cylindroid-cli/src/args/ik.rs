//! The arguments of `ik`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::RangedU64ValueParser;

use super::{CollisionArgs, ConfigurationArgs, FrameArgs, LimitsArgs, MOST, TargetArgs};

pub(crate) const ABOUT: &str = "\
Inverse kinematics: configurations that bring a frame to a target, within all limits

For six revolute joints of which three axes intersect or are parallel (a spherical wrist, a UR \
arm), all solutions are computed in closed form; for seven, one joint is sampled over its range. \
Otherwise, a numerical solver starts at --q (clamped to the limits) and then at random \
configurations, until one reaches the target. Every solution is verified by forward kinematics, \
and the same seed gives the same solution. If no solution is found, the closest configuration is \
printed with the reason: the target is farther away than the arm is long (which proves that there \
is none), bodies are too close in every solution found, a solution exists outside half-spaces \
or outside the position limits, or none of these.

For a closed chain the loops are closed together with the target, from --q and then from random \
configurations: one frame, by default the reference, of whose orientation all, two or no components \
are given. --all returns its working modes.

With --task FRAME=X,Y,Z several frames are brought to their targets at once; --tasks reads \
further goals from a file: frames seen from others, the centre of mass, gaze, half-spaces that are \
not left, a posture. With --avoid or --obstacle links keep a distance from each other and from \
obstacles.

--maximise takes from what the goals leave free the best of the maxima to which random restarts lead: \
manipulability is Yoshikawa's measure of the first frame and its components (lengths over the \
characteristic length), limit-avoidance minus half of the sum of squares of the shares by which \
joints are away from the middles of their ranges.

Exit code 0 if the target is reached, 1 if not, 2 on an error.";

pub(crate) const EXAMPLES: &str = "\
Examples:
  cylindroid ik panda --to 0.45,0.15,0.35 --rpy 3.1416,0,0.6
  cylindroid ik ur5e --to 0.3,0.4,0.5 --rpy 3.1416,0,0 --all 8
  cylindroid ik panda --to 0.45,0.15,0.35 --q 0,-0.5,0,-2,0,1.5,0.7 --nearest
  cylindroid ik panda --to 0.45,0.15,0.35 --rpy 3.1416,0,0.6 --maximise manipulability
  cylindroid ik panda --tasks docs/goals.toml
  cylindroid ik five-bar --to 1,1.5,0 --all 4
  cylindroid ik docs/cell.toml --to 0.4,0,0.4 --avoid --obstacle ball=sphere:0.1@0.4,0.1,0.3

A file of tasks is one of `move`, see `move --help`. A solution reaches all of its tasks of type \
frame, relative_frame, center_of_mass and gaze, lies inside every [[half_space]] (frame, point, \
normal, tool) and [[box]] (frame, center, size, rpy, tool), and is the closest one to its posture, \
or the best one by its task of type manipulability or limit_avoidance. \
Weights count where not all tasks can be reached; gains, levels, velocities and tolerances do not \
count.

An obstacle is NAME=SHAPE@X,Y,Z or NAME=SHAPE@X,Y,Z,ROLL,PITCH,YAW [m, rad], see `distance --help`.";

/// Distances to other bodies.
#[derive(Debug, Args)]
#[command(next_help_heading = "Collision")]
pub(crate) struct AvoidanceArgs {
    /// Keep links at a distance from each other and from obstacles
    #[arg(long)]
    pub(crate) avoid: bool,

    /// Least distance that --avoid keeps [m] [default: 0.01]
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(crate) gap: Option<f64>,

    #[command(flatten)]
    pub(crate) collision: CollisionArgs,
}

impl AvoidanceArgs {
    /// Least distance where none is given (m).
    const GAP: f64 = 0.01;

    /// The least distance (m), if distances are to be kept; otherwise an option that has no effect,
    /// if one is given.
    pub(crate) fn gap(&self) -> Result<Option<f64>, &'static str> {
        if self.avoid || !self.collision.obstacle.is_empty() {
            return Ok(Some(self.gap.unwrap_or(Self::GAP)));
        }
        let given = [
            ("--gap", self.gap.is_some()),
            ("--meshes", self.collision.meshes.is_some()),
            ("--samples", self.collision.samples.is_some()),
        ];
        match given.into_iter().find(|(_, is_given)| *is_given) {
            Some((option, _)) => Err(option),
            None => Ok(None),
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct IkArgs {
    #[command(flatten)]
    pub(crate) configuration: ConfigurationArgs,

    #[command(flatten)]
    pub(crate) frame: FrameArgs,

    #[command(flatten)]
    pub(crate) limits: LimitsArgs,

    #[command(flatten)]
    pub(crate) target: TargetArgs,

    /// File of further goals, half-spaces and a posture, see below
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) tasks: Option<PathBuf>,

    /// Return the solution closest to --q
    #[arg(long, help_heading = "Search")]
    pub(crate) nearest: bool,

    /// Make manipulability or limit-avoidance as large as possible by what the goals leave free
    #[arg(long, value_name = "CRITERION", conflicts_with = "nearest", help_heading = "Search")]
    pub(crate) maximise: Option<String>,

    /// Return up to N distinct solutions, the closest to --q first, with --maximise the best
    #[arg(long, value_name = "N", conflicts_with = "nearest", allow_negative_numbers = true)]
    #[arg(help_heading = "Search")]
    #[arg(value_parser = RangedU64ValueParser::<usize>::new().range(1..=MOST))]
    pub(crate) all: Option<usize>,

    /// Seed for the random restarts
    #[arg(long, value_name = "SEED", default_value_t = 0, allow_negative_numbers = true)]
    #[arg(help_heading = "Search")]
    pub(crate) seed: u64,

    /// Position tolerance of a solution [m]
    #[arg(long, value_name = "M", default_value_t = 1e-6, allow_hyphen_values = true)]
    #[arg(help_heading = "Search")]
    pub(crate) tolerance_position: f64,

    /// Orientation tolerance of a solution [rad]
    #[arg(long, value_name = "RAD", default_value_t = 1e-6, allow_hyphen_values = true)]
    #[arg(help_heading = "Search")]
    pub(crate) tolerance_orientation: f64,

    /// Iteration limit, over all restarts
    #[arg(long, value_name = "N", default_value_t = 20_000, allow_negative_numbers = true)]
    #[arg(help_heading = "Search")]
    #[arg(value_parser = RangedU64ValueParser::<usize>::new().range(0..=MOST))]
    pub(crate) iterations: usize,

    #[command(flatten)]
    pub(crate) avoidance: AvoidanceArgs,
}
