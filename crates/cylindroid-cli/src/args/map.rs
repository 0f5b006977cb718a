//! The arguments of `map`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;
use clap::builder::RangedU64ValueParser;

use super::sweep::AxisArg;
use super::{FrameArgs, MOST, ModelArgs};
use crate::values::{Assignment, Joints};

pub(crate) const ABOUT: &str = "\
The workspace over components of the platform's pose, for each working mode, with singularity loci

The platform is the reference of a closed chain, or the tool of an arm. Every working mode, found by \
random restarts, is followed from cell to cell of the grid by steps that pass no singularity of type \
I. Curves of singularities, of type I (boundaries, where legs stretch), type II (the actuated joints \
no longer hold the platform), passive (only passive joints move) and of position limits, are refined \
by Newton's method and followed by predictor and corrector, for two axes. For three axes, those of type \
II and passive ones are surfaces of triangles.

Components that are neither axes nor given keep their value at the start as far as the mechanism has \
freedoms for them, and follow otherwise.

Exit code 0 if a mode is found, 1 if not, 2 on an error, 130 after an interrupt.";

pub(crate) const EXAMPLES: &str = "\
Examples:
  cylindroid map five-bar --actuated q1,q5 --over x=-1:3:200 --over y=-1:3:200 --plot map.svg
  cylindroid map 3rrr --over x=-0.4:0.4:81 --over y=-0.4:0.4:81 --at rz=0.2 --out map.csv
  cylindroid map 3rps --over pitch=-1.5:1.5:61 --over roll=-1.5:1.5:61 --plot map.svg
  cylindroid map stewart --over x=-0.4:0.4:41 --over y=-0.4:0.4:41 --at z=1.1
  cylindroid map panda --over x=0:0.8:41 --over z=0:1:51 --free yaw
  cylindroid map 3rrr --over x=-0.3:0.3:9 --over y=-0.3:0.3:9 --over rz=-1:1:9 --mesh locus.obj

Components: x, y, z [m], roll, pitch, yaw [rad, R = Rz(yaw) Ry(pitch) Rx(roll)]; in the plane x, y, rz.";

#[derive(Debug, Args)]
pub(crate) struct MapArgs {
    #[command(flatten)]
    pub(crate) model: ModelArgs,

    /// The actuated joints, replacing those of the file
    #[arg(long, value_name = "JOINTS", value_delimiter = ',')]
    pub(crate) actuated: Vec<String>,

    /// An axis [m or rad]: a component, its first and last value and the number of values; one, two
    /// or three of them, of which the last changes fastest
    #[arg(long, value_name = "NAME=A:B:N", required = true, allow_hyphen_values = true)]
    pub(crate) over: Vec<AxisArg>,

    /// The value of another component [m or rad]; repeat for further ones
    #[arg(long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub(crate) at: Vec<Assignment>,

    /// A component that may have any value; repeat for further ones
    #[arg(long, value_name = "NAME")]
    pub(crate) free: Vec<String>,

    #[command(flatten)]
    pub(crate) frame: FrameArgs,

    /// A configuration in the workspace [rad or m], as for other commands
    #[arg(long, value_name = "Q", default_value = "home", allow_hyphen_values = true)]
    pub(crate) q: Joints,

    /// Random restarts that look for working modes at the start; others look in other cells
    #[arg(long, value_name = "N", default_value_t = 64, allow_negative_numbers = true)]
    #[arg(value_parser = RangedU64ValueParser::<usize>::new().range(1..=MOST))]
    pub(crate) starts: usize,

    /// Seed for the random restarts
    #[arg(long, value_name = "SEED", default_value_t = 0, allow_negative_numbers = true)]
    pub(crate) seed: u64,

    /// Leave out the curves and surfaces
    #[arg(long)]
    pub(crate) no_loci: bool,

    /// A .csv file with a row for each mode and cell that it reaches, or a .json file with the curves
    /// and surfaces as well
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,

    /// An OBJ file with the surfaces of three axes, a group for each mode
    #[arg(long, value_name = "FILE.obj", conflicts_with = "no_loci")]
    pub(crate) mesh: Option<PathBuf>,

    /// Draw two axes as an SVG, a panel for each mode; of three axes slices along the last one of up to
    /// three modes
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) plot: Option<PathBuf>,

    /// Number of threads [default: that of the processor]
    #[arg(long, value_name = "K", allow_negative_numbers = true)]
    pub(crate) threads: Option<NonZeroUsize>,
}
