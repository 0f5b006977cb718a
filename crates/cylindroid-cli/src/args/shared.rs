//! Arguments of several commands: a model at a configuration, a frame.

use clap::Args;

use crate::values::{Joints, Numbers};

/// A model at a configuration.
#[derive(Debug, Args)]
pub(crate) struct ConfigurationArgs {
    /// A model file or a name of the catalogue
    pub(crate) model: String,

    /// Configuration, in the order of `info` [rad or m]: numbers `0,-0.8,...`, or `name=value,...`
    /// over home, or `home`, or `zero`
    #[arg(long, value_name = "Q", default_value = "home", allow_hyphen_values = true)]
    pub(crate) q: Joints,

    /// Angles on the command line are in degrees: those of configurations (and rates), --rpy and
    /// --rotation-vector. Lengths, speeds, tolerances and all output stay in SI units
    #[arg(long)]
    pub(crate) degrees: bool,
}

/// A frame and a point fixed to it.
#[derive(Debug, Args)]
pub(crate) struct FrameArgs {
    /// Frame [default: the tool frame of the model]
    #[arg(long, value_name = "NAME")]
    pub(crate) frame: Option<String>,

    /// Point fixed to the frame, in its axes [m], taken instead of the frame's origin
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub(crate) tool: Option<Numbers<3>>,
}
