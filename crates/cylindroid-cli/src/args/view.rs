//! The arguments of `view`.

use std::path::PathBuf;

use clap::Args;

use super::{ConfigurationArgs, FrameArgs};

pub(crate) const ABOUT: &str = "\
The web viewer: see a model, drag its tool or object, and watch its measures

Prints the URL of the page and serves it until ctrl-c. Every browser window has the model for \
itself: configuration, target, drives. The servo is that of `move`, with the limits of all joints. \
Closed chains are assembled first.

The server listens on the loopback interface unless --host says otherwise. It gives out meshes from \
the model's own folders alone: that of its file, its package, and the packages that it names.";

pub(crate) const EXAMPLES: &str = "\
Examples:
  cylindroid view panda
  cylindroid view five-bar --actuated q2,q4 --port 8080
  cylindroid view ur5e --q 0,-1.2,1.4,0,1.5,0 --check";

#[derive(Debug, Args)]
pub(crate) struct ViewArgs {
    #[command(flatten)]
    pub(crate) configuration: ConfigurationArgs,

    #[command(flatten)]
    pub(crate) frame: FrameArgs,

    /// The driven joints of a mechanism with loops, in place of those of the file
    #[arg(long, value_name = "JOINTS", value_delimiter = ',')]
    pub(crate) actuated: Vec<String>,

    /// Port, 0 for any that is free
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    pub(crate) port: u16,

    /// Address or name of this machine to listen at; others than 127.0.0.1 and ::1 let other
    /// machines in
    #[arg(long, value_name = "HOST", default_value = "127.0.0.1")]
    pub(crate) host: String,

    /// A further folder that meshes may be given out from; may be given several times
    #[arg(long, value_name = "FOLDER")]
    pub(crate) meshes: Vec<PathBuf>,

    /// Start, print the URL and stop
    #[arg(long)]
    pub(crate) check: bool,
}
