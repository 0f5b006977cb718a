//! Arguments of several commands: a model, its configuration, a frame.

use std::path::PathBuf;

use clap::Args;

use crate::values::{Assignment, Joints, Numbers};

/// Starts, iterations, solutions, samples or rays at most: time grows with them.
pub(crate) const MOST: u64 = 1_000_000;

/// A model.
#[derive(Debug, Args)]
pub(crate) struct ModelArgs {
    /// Model file or catalogue name
    #[arg(id = "model", value_name = "MODEL")]
    pub(crate) name: String,

    /// Value of a parameter of a mechanism file in place of the file's; repeatable
    #[arg(long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub(crate) parameter: Vec<Assignment>,

    /// SRDF of the model: its groups (--group), its states as values of --q, and the pairs of links
    /// that `disable_collisions` leaves out
    #[arg(long, value_name = "FILE")]
    pub(crate) srdf: Option<PathBuf>,

    /// Only the joints of this group of the SRDF move, the others rest at home; its tip is the tool
    #[arg(long, value_name = "NAME", requires = "srdf")]
    pub(crate) group: Option<String>,
}

/// A model at a configuration.
#[derive(Debug, Args)]
pub(crate) struct ConfigurationArgs {
    #[command(flatten)]
    pub(crate) model: ModelArgs,

    /// Configuration [rad or m]: numbers in the order of `info` (`0,-0.8,...`), `name=value,...`
    /// with the other coordinates at home, `home`, `zero`, or a state of the SRDF
    #[arg(long, value_name = "Q", default_value = "home", allow_hyphen_values = true)]
    pub(crate) q: Joints,

    /// Angles of configurations, joint velocities, --rpy and --rotation-vector are given in
    /// degrees. Lengths, speeds, tolerances and all output remain in SI units
    #[arg(long)]
    pub(crate) degrees: bool,
}

/// A frame and a point fixed to it.
#[derive(Debug, Args)]
pub(crate) struct FrameArgs {
    /// Frame [default: the tool frame of the model]
    #[arg(long, value_name = "NAME")]
    pub(crate) frame: Option<String>,

    /// Point fixed to the frame that replaces its origin, in its axes [m]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub(crate) tool: Option<Numbers<3>>,
}

/// Limits in place of those of the model.
#[derive(Debug, Args)]
pub(crate) struct LimitsArgs {
    /// Limits of joints in place of those of the model: a table [NAME] for each joint with `lower`,
    /// `upper` (narrower than in the model), `velocity`, `acceleration`, `jerk`, `effort` [rad or m, s,
    /// N m or N]
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) limits: Option<PathBuf>,
}
