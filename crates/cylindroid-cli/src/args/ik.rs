//! The arguments of `ik`.

use clap::Args;
use clap::builder::RangedU64ValueParser;

use super::{FrameArgs, PostureArgs, TargetArgs};

pub(crate) const ABOUT: &str = "\
Inverse kinematics: configurations that put a frame at a target, within all limits

Where six joints are hinges and three of their axes meet or are parallel (a spherical wrist, a UR arm), \
formulas give all answers; where there are seven, those for one value after another of one of them. Else \
attempts start at --q (moved within the limits), then at postures drawn within them, until one reaches the target; \
what is claimed was checked by forward kinematics. The same seed gives the same answer. Where \
nothing is found the nearest posture is printed: a proof that none reaches only where the target \
is farther away than the arm is long.

Exit code 0 if the target is reached, 1 if not, 2 on an error.";

pub(crate) const EXAMPLES: &str = "\
Examples:
  cylindroid ik panda --to 0.45,0.15,0.35 --rpy 3.1416,0,0.6
  cylindroid ik ur5e --to 0.3,0.4,0.5 --rpy 3.1416,0,0 --all 8
  cylindroid ik panda --to 0.45,0.15,0.35 --q 0,-0.5,0,-2,0,1.5,0.7 --nearest";

#[derive(Debug, Args)]
pub(crate) struct IkArgs {
    #[command(flatten)]
    pub(crate) posture: PostureArgs,

    #[command(flatten)]
    pub(crate) frame: FrameArgs,

    #[command(flatten)]
    pub(crate) target: TargetArgs,

    /// Of the answers that are found, the nearest to --q
    #[arg(long)]
    pub(crate) nearest: bool,

    /// Up to so many distinct answers, the nearest to --q first
    #[arg(long, value_name = "N", conflicts_with = "nearest", allow_negative_numbers = true)]
    #[arg(value_parser = RangedU64ValueParser::<usize>::new().range(1..))]
    pub(crate) all: Option<usize>,

    /// Of the postures that are drawn
    #[arg(long, value_name = "SEED", default_value_t = 0, allow_negative_numbers = true)]
    pub(crate) seed: u64,

    /// Largest position error of an answer [m]
    #[arg(long, value_name = "M", default_value_t = 1e-6, allow_hyphen_values = true)]
    pub(crate) tolerance_position: f64,

    /// Largest orientation error of an answer [rad]
    #[arg(long, value_name = "RAD", default_value_t = 1e-6, allow_hyphen_values = true)]
    pub(crate) tolerance_orientation: f64,

    /// Steps of all attempts, when to give up
    #[arg(long, value_name = "N", default_value_t = 20_000, allow_negative_numbers = true)]
    pub(crate) iterations: usize,
}
