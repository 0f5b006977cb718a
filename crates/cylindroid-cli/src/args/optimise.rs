//! The arguments of `optimise`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{ArgGroup, Args};

use super::sweep::{AxisArg, Count, RangeArg, SweepMetricName};
use super::{FrameArgs, ModelArgs};
use crate::values::Joints;

pub(crate) const ABOUT: &str = "\
Optimal designs: parameters of a mechanism file that minimise or maximise indices, and their trade-offs

Designs are sampled within the ranges of --vary (a scrambled Sobol' sequence), and the best of them \
are refined by the Nelder-Mead method, restarted until it improves nothing. With several indices the \
result is a Pareto front: the designs found that no other one dominates; each refinement then improves \
a sample in all indices.

An index is a column of `sweep` over the configurations of the design: samples, a grid, a file, or the \
one of --q. Without a statistic it is that of the worst configuration: the largest of an index that is \
minimised, the smallest of one that is maximised. Parameters in --over are a workspace at each point of \
which the design is evaluated.

A design that cannot be loaded, or whose index is not finite, is no result; both are counted. Optima \
are those found: nothing proves that there are no better ones.

Exit code 0 if a design has the indices, 1 if none has, 2 on an error.";

pub(crate) const EXAMPLES: &str = "\
Examples:
  cylindroid optimise docs/designs.toml --vary crank=0.3:0.8 --minimise anisotropy
  cylindroid optimise docs/designs.toml --vary rod=0.5:0.9 --minimise anisotropy --maximise type_ii
  cylindroid optimise docs/designs.toml --vary rod=0.5:0.9 --over point_x=0:0.1:3 --maximise type_i

Indices: columns of numbers of `sweep`, such as condition, smallest_singular_value, yoshikawa, \
limit_distance, x, y, z; of measures, for closed chains too: anisotropy, volume, smallest, largest, \
type_i, type_ii.
Statistics: smallest, mean, largest. Exit code 130 after an interrupt.";

#[derive(Debug, Args)]
#[command(group = ArgGroup::new("objectives").multiple(true).required(true))]
pub(crate) struct OptimiseArgs {
    #[command(flatten)]
    pub(crate) model: ModelArgs,

    /// The range of a parameter, in the unit of the file; repeatable
    #[arg(long, value_name = "NAME=A:B", required = true, allow_hyphen_values = true)]
    pub(crate) vary: Vec<RangeArg>,

    /// An index to minimise, with a statistic over the configurations; repeatable
    #[arg(long, value_name = "INDEX[:STATISTIC]", group = "objectives")]
    pub(crate) minimise: Vec<String>,

    /// An index to maximise; repeatable
    #[arg(long, value_name = "INDEX[:STATISTIC]", group = "objectives")]
    pub(crate) maximise: Vec<String>,

    /// Number of sampled designs
    #[arg(long, value_name = "N", default_value = "64", allow_hyphen_values = true)]
    pub(crate) designs: Count,

    /// How many of them are refined: the best, or with several indices some along the front
    #[arg(long, value_name = "N", default_value = "4", allow_hyphen_values = true)]
    pub(crate) starts: Count,

    /// Designs that a refinement evaluates at most
    #[arg(long, value_name = "N", default_value = "2000", allow_hyphen_values = true)]
    pub(crate) evaluations: Count,

    /// Selects one of the sequences of designs and of configurations
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    pub(crate) seed: u64,

    /// An axis of a grid of configurations: a coordinate [rad or m], its first and last value and the
    /// number of values; or one of the workspace: a parameter. Repeatable
    #[arg(long, value_name = "NAME=A:B:N", allow_hyphen_values = true)]
    pub(crate) over: Vec<AxisArg>,

    /// Number of configurations, samples within the position limits of each design
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) samples: Option<Count>,

    /// A .csv, .json or .parquet file with a configuration in each row [rad or m], as for `sweep`
    #[arg(long, value_name = "FILE", conflicts_with = "samples")]
    pub(crate) configurations: Option<PathBuf>,

    /// The configuration, or the other coordinates of a grid [rad or m], as for other commands
    #[arg(long, value_name = "Q", default_value = "home", allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["samples", "configurations"])]
    pub(crate) q: Joints,

    #[command(flatten)]
    pub(crate) frame: FrameArgs,

    /// The frame from which --frame is seen, which may move, as for `sweep`: two arms together
    #[arg(long, value_name = "FRAME")]
    pub(crate) relative_to: Option<String>,

    /// Components of the twist that the measures of the Jacobian see: pose, position, orientation,
    /// or a list of x,y,z,rx,ry,rz, in world axes or those of --relative-to [default: pose]
    #[arg(long, value_name = "TASK")]
    pub(crate) task: Option<String>,

    /// Metric of yoshikawa and of the columns of measures, as for `sweep`
    #[arg(long, value_name = "NAME", default_value = "unit")]
    pub(crate) metric: SweepMetricName,

    /// Characteristic length [m] [default: that of each design]
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(crate) length: Option<f64>,

    /// Number of threads [default: that of the processor]
    #[arg(long, value_name = "K", allow_negative_numbers = true)]
    pub(crate) threads: Option<NonZeroUsize>,
}
