//! The arguments of `zone`.

use clap::builder::RangedU64ValueParser;
use clap::{Args, ValueEnum};
use cylindroid::sweep::ZoneShape;

use super::{FrameArgs, MOST, ModelArgs};
use crate::values::{Assignment, Joints, List};

pub(crate) const ABOUT: &str = "\
The largest ball or box around a configuration without singularities

In components of the platform's pose (the reference of a closed chain, or the tool of an arm) or in \
coordinates of actuated joints. Rays from the centre follow the mode of --q to the first singularity \
or position limit; from there the nearest point is found by descent on the locus, to rounding. The \
smallest distance is the size: nothing larger is free. That nothing is nearer is checked only along \
rays; on those counted as certified each step was short enough for the change of the Jacobians. \
More --rays look more closely.";

pub(crate) const EXAMPLES: &str = "\
Examples:
  cylindroid zone five-bar --actuated q1,q5 --components x,y
  cylindroid zone stewart --components x,y,z --no-limits
  cylindroid zone stewart --components roll,pitch,yaw --shape box --rays 64
  cylindroid zone 3r --components joint2,joint3

Components: x, y, z [m], roll, pitch, yaw [rad, R = Rz(yaw) Ry(pitch) Rx(roll)]; in the plane x, y, \
rz; or actuated joints.";

#[derive(Debug, Args)]
pub(crate) struct ZoneArgs {
    #[command(flatten)]
    pub(crate) model: ModelArgs,

    /// The actuated joints, replacing those of the file
    #[arg(long, value_name = "JOINTS", value_delimiter = ',')]
    pub(crate) actuated: Vec<String>,

    /// The components of the zone: those of the platform's pose, or actuated joints
    #[arg(long, value_name = "NAMES", value_delimiter = ',', required = true)]
    pub(crate) components: Vec<String>,

    /// Ball, or a box with sides along the components
    #[arg(long, value_name = "NAME", default_value = "ball")]
    pub(crate) shape: ShapeName,

    /// The lengths of the ball's axes, or half the sides of the box, for a size of 1 [m or rad]
    /// [default: 1; of lengths beside angles the characteristic length]
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub(crate) scales: Option<List>,

    /// The value of a component in the centre [m or rad], of the zone or another one; repeat for
    /// further ones
    #[arg(long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub(crate) at: Vec<Assignment>,

    /// A component of the pose that may have any value; repeat for further ones
    #[arg(long, value_name = "NAME")]
    pub(crate) free: Vec<String>,

    #[command(flatten)]
    pub(crate) frame: FrameArgs,

    /// The configuration in the centre [rad or m], as for other commands
    #[arg(long, value_name = "Q", default_value = "home", allow_hyphen_values = true)]
    pub(crate) q: Joints,

    /// Ignore position limits
    #[arg(long)]
    pub(crate) no_limits: bool,

    /// Number of rays beside those along the components; of one component those are all
    #[arg(long, value_name = "N", default_value_t = 256, allow_negative_numbers = true)]
    #[arg(value_parser = RangedU64ValueParser::<usize>::new().range(0..=MOST))]
    pub(crate) rays: usize,

    /// Seed for the directions of the rays
    #[arg(long, value_name = "SEED", default_value_t = 0, allow_negative_numbers = true)]
    pub(crate) seed: u64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShapeName {
    /// The root of the sum of the squares of components over their scales
    Ball,
    /// The largest of them
    Box,
}

impl ShapeName {
    pub(crate) const fn shape(self) -> ZoneShape {
        match self {
            Self::Ball => ZoneShape::Ball,
            Self::Box => ZoneShape::Box,
        }
    }
}
