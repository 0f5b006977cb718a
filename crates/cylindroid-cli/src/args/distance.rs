//! The arguments of `distance`.

use clap::builder::RangedU64ValueParser;
use clap::{Args, ValueEnum};
use cylindroid::collision::MeshShape;

use super::{ConfigurationArgs, MOST};
use crate::obstacle::ObstacleArg;

pub(crate) const ABOUT: &str = "\
Distances between links that can collide, and from links to obstacles

For each pair of collision shapes nearer than --margin: the signed distance (negative: penetration \
depth), the closest points and the unit normal from the first to the second, in the world. Links \
that a joint connects, pairs that an SRDF disables, and pairs that always or never touch are not \
watched. The exit code is 1 if shapes penetrate each other.";

pub(crate) const EXAMPLES: &str = "\
Examples:
  cylindroid distance docs/cell.toml --margin 0.5
  cylindroid distance docs/cell.toml --obstacle ball=sphere:0.1@0.5,0,0.4 --q home --json

An obstacle is NAME=SHAPE@X,Y,Z or NAME=SHAPE@X,Y,Z,ROLL,PITCH,YAW [m, rad], with SHAPE one of \
sphere:RADIUS, capsule:RADIUS,LENGTH, cylinder:RADIUS,LENGTH, box:X,Y,Z, ellipsoid:X,Y,Z, half_space \
(below its own x-y plane) and mesh:FILE.";

#[derive(Debug, Args)]
pub(crate) struct DistanceArgs {
    #[command(flatten)]
    pub(crate) configuration: ConfigurationArgs,

    /// Pairs farther apart than this are not listed [m]; `inf` for all
    #[arg(long, value_name = "M", default_value_t = 0.1, allow_hyphen_values = true)]
    pub(crate) margin: f64,

    #[command(flatten)]
    pub(crate) collision: CollisionArgs,
}

/// The shapes and the pairs that are watched.
#[derive(Debug, Args)]
#[command(next_help_heading = "Collision")]
pub(crate) struct CollisionArgs {
    /// An obstacle in the world, see below; repeatable
    #[arg(long, value_name = "NAME=SHAPE@POSE", allow_hyphen_values = true)]
    pub(crate) obstacle: Vec<ObstacleArg>,

    /// Shape that stands for a mesh [default: convex_hull]
    #[arg(long, value_name = "SHAPE")]
    pub(crate) meshes: Option<MeshName>,

    /// Random configurations by which pairs that always or never touch are found; 0 keeps all pairs
    /// [default: 200]
    #[arg(long, value_name = "N")]
    #[arg(value_parser = RangedU64ValueParser::<usize>::new().range(0..=MOST))]
    pub(crate) samples: Option<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub(crate) enum MeshName {
    /// The convex hull of its vertices
    ConvexHull,
    /// A small capsule around its vertices
    Capsule,
}

impl From<MeshName> for MeshShape {
    fn from(name: MeshName) -> Self {
        match name {
            MeshName::ConvexHull => Self::ConvexHull,
            MeshName::Capsule => Self::Capsule,
        }
    }
}
