//! The arguments of `mobility` and `manipulability`.

use clap::{Args, ValueEnum};

use super::PostureArgs;
use crate::values::Joints;

pub(crate) const MOBILITY: &str = "\
Mobility of a mechanism: how it can move, what is redundant, idle or held twice

Counts come from ranks at this configuration, with their gap; Grubler's formula is given beside \
them. Loops and contacts are taken as closed: the gap by which they are open is printed.";

pub(crate) const MANIPULABILITY: &str = "\
How well motion and force go from the driven joints to the reference frame

Efficiencies are squares of output over input along the principal directions: of motion (object \
speed over joint speed), of force exerted (wrench over torques, the object's free wrenches chosen \
for the least) and of force resisted. Zero: nothing comes out. Infinite: without any input.";

#[derive(Debug, Args)]
pub(crate) struct ClosedArgs {
    #[command(flatten)]
    pub(crate) posture: PostureArgs,

    /// The driven joints, in place of those of the file
    #[arg(long, value_name = "JOINTS", value_delimiter = ',')]
    pub(crate) actuated: Vec<String>,

    /// The frame whose motion is the goal [default: the reference of the file, else the tool]
    #[arg(long, value_name = "NAME")]
    pub(crate) frame: Option<String>,

    /// Characteristic length beside angles [m] [default: the reach]
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(crate) length: Option<f64>,
}

pub(crate) const ASSEMBLE: &str = "\
Closes the loops of a mechanism from a guess, within its position limits

It finds one assembly, mostly the nearest; there may be others, which --modes looks for. With --to, \
coordinates go from there straight to other values while the loops stay closed in the same assembly \
mode; the way ends before a singularity and at position limits, and says which.

Exit code 0 if all loops and contacts are closed (with --modes: in one mode at least; with --to: at \
the goal), 1 if not, 2 on an error. The line q can be given to --q of other commands. Joints that \
close loops have no coordinate: they cannot be held, and their limits do not count.";

pub(crate) const ASSEMBLE_EXAMPLES: &str = "\
Examples:
  cylindroid assemble five-bar --q 0.2,-0.1,0,0 --hold q1
  cylindroid assemble stewart --hold driven --modes 200
  cylindroid assemble four-bar --to q1=6.283185307
  cylindroid assemble stewart --to leg1=0.2,leg2=0.2";

#[derive(Debug, Args)]
pub(crate) struct AssembleArgs {
    #[command(flatten)]
    pub(crate) posture: PostureArgs,

    /// Coordinates that keep the values of --q: names of coordinates or joints, or `driven` for
    /// all that are driven (the passive ones follow)
    #[arg(long, value_name = "JOINTS", value_delimiter = ',')]
    pub(crate) hold: Vec<String>,

    /// Look for all ways in which the loops close, from this many starts: the guess, then random
    /// ones within limits. Some may be missed; how often each was found is printed
    #[arg(long, value_name = "STARTS", conflicts_with = "to")]
    pub(crate) modes: Option<usize>,

    /// Other random starts for --modes
    #[arg(long, value_name = "N", default_value_t = 0, requires = "modes")]
    pub(crate) seed: u64,

    /// Move these coordinates from --q (assembled) to these values [rad or m], those of --hold at
    /// rest, all others following: `name=value,...`
    #[arg(long, value_name = "NAME=VALUE,...", allow_hyphen_values = true)]
    pub(crate) to: Option<Joints>,

    /// How near to a singularity --to goes [-]: smallest over largest singular value of the rates
    /// at which the others open the loops, 1e-5 to 1 [default: 0.001]
    #[arg(long, value_name = "D", allow_hyphen_values = true, requires = "to")]
    pub(crate) least_distance: Option<f64>,
}

#[derive(Debug, Args)]
pub(crate) struct ManipulabilityArgs {
    #[command(flatten)]
    pub(crate) closed: ClosedArgs,

    /// How motions are measured: `unit` (m beside rad, as they are), `length` (lengths over the
    /// characteristic length), `limits` (lengths so, joint rates over their limits)
    #[arg(long, value_name = "NAME", default_value = "unit")]
    pub(crate) metric: MetricName,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MetricName {
    /// Metres beside radians
    Unit,
    /// Lengths over the characteristic length
    Length,
    /// Lengths so, joint rates over their limits
    Limits,
}
