//! The arguments of `mobility` and `manipulability`.

use clap::{Args, ValueEnum};

use super::PostureArgs;

pub(crate) const MOBILITY: &str = "\
Mobility of a mechanism: how it can move, what is redundant, idle or held twice

Counts come from ranks at this configuration, with their gap; Grubler's formula is given beside \
them, and so is what remains of the motions when the loops are closed after a step (finite motion). \
The pose is compared with other closed postures of the mechanism: where it is singular, the wrench \
that blocks and the motion lost or gained are named as screws, seen from the world. Loops and \
contacts are taken as closed: the gap by which they are open is printed.";

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

It finds one assembly, mostly the nearest; there may be others. Exit code 0 if all loops and \
contacts are closed, 1 if not, 2 on an error. The line q can be given to --q of other commands.";

#[derive(Debug, Args)]
pub(crate) struct AssembleArgs {
    #[command(flatten)]
    pub(crate) posture: PostureArgs,

    /// Coordinates that keep the values of --q
    #[arg(long, value_name = "JOINTS", value_delimiter = ',')]
    pub(crate) hold: Vec<String>,
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
