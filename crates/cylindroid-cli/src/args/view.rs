//! The arguments of `view`.

use std::path::PathBuf;

use clap::Args;

use super::{ConfigurationArgs, FrameArgs, LimitsArgs};
use crate::obstacle::ObstacleArg;

pub(crate) const ABOUT: &str = "\
The web viewer: display a model, drag its tool or object, and monitor its measures

Prints the URL of the page and serves it until Ctrl-C. Every browser window has a session of its \
own: configuration, target and actuated joints. Windows with the same `?session=NAME` at the end of \
the URL share one: the first drives, the others observe or take over. The servo is that of `move` \
and respects all joint limits. Closed chains are assembled first.

When the file of the model, or one that it includes, changes, the pages show the new version with \
the joints where they were; a fault in it is shown beside the old one.

The server listens on the loopback interface unless --host is given. Meshes are served only from \
the folders of the model: the folder of its file, its package, and the packages it refers to.";

pub(crate) const EXAMPLES: &str = "\
Examples:
  cylindroid view panda
  cylindroid view five-bar --actuated q2,q4 --port 8080
  cylindroid view ur5e --q 0,-1.2,1.4,0,1.5,0 --check
  cylindroid view docs/cell.toml --obstacle ball=sphere:0.1@0.5,0,0.4

Obstacles are given as in `distance`.";

#[derive(Debug, Args)]
pub(crate) struct ViewArgs {
    #[command(flatten)]
    pub(crate) configuration: ConfigurationArgs,

    #[command(flatten)]
    pub(crate) frame: FrameArgs,

    #[command(flatten)]
    pub(crate) limits: LimitsArgs,

    /// Actuated joints of a mechanism with loops, replacing those of the file
    #[arg(long, value_name = "JOINTS", value_delimiter = ',')]
    pub(crate) actuated: Vec<String>,

    /// Port; 0 selects a free one. By default 7411, and a free one where that is taken
    #[arg(long, value_name = "PORT")]
    pub(crate) port: Option<u16>,

    /// Open the page in the browser of this machine
    #[arg(long)]
    pub(crate) open: bool,

    /// Serve nothing but what is below a random path, which the printed URL contains: on a machine
    /// that others use
    #[arg(long)]
    pub(crate) token: bool,

    /// Address or host name to listen on; any other than 127.0.0.1 and ::1 allows access from other
    /// machines
    #[arg(long, value_name = "HOST", default_value = "127.0.0.1")]
    pub(crate) host: String,

    /// Additional folder from which meshes may be served; repeatable
    #[arg(long, value_name = "FOLDER")]
    pub(crate) meshes: Vec<PathBuf>,

    /// Keep links at a distance from each other and from obstacles
    #[arg(long)]
    pub(crate) avoid: bool,

    /// An obstacle in the world, as in `distance`; repeatable. Distances are kept, as with --avoid
    #[arg(long, value_name = "NAME=SHAPE@POSE", allow_hyphen_values = true)]
    pub(crate) obstacle: Vec<ObstacleArg>,

    /// Do not load the model again when its files change
    #[arg(long)]
    pub(crate) no_watch: bool,

    /// Start, print the URL and exit
    #[arg(long, conflicts_with = "open")]
    pub(crate) check: bool,
}
