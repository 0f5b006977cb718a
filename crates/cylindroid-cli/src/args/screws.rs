//! The arguments of `screws`.

use std::path::PathBuf;

use clap::Args;

use super::{ConfigurationArgs, FrameArgs};
use crate::values::Numbers;

pub(crate) const ABOUT: &str = "\
The screw system of the joints: class, pitches, frame, and which inverses exist

For the joint twists of a robot at a configuration, or for any twists in a file: the order and \
Gibson-Hunt class of the system they span, its principal pitches and screws, its canonical frame, \
the reciprocal system, for which pitches h a hyperbolic pseudoinverse exists and which h keeps its \
projector small, and whether the joint axes are in involution. Verdicts depend neither on the \
frame nor on the unit of length.";

pub(crate) const EXAMPLES: &str = "\
Examples:
  cylindroid screws youbot
  cylindroid screws youbot --q 0.4,0.6,0.9,0.5,0.2 --h 0.1 --plot screws.svg
  cylindroid screws axes.csv --length 0.5 --noise 1e-6

In place of a model, a file of twists (.csv or .json) has six numbers for each, the linear part first: rows of a CSV, \
or a JSON list of lists.";

#[derive(Debug, Args)]
pub(crate) struct ScrewsArgs {
    #[command(flatten)]
    pub(crate) configuration: ConfigurationArgs,

    #[command(flatten)]
    pub(crate) frame: FrameArgs,

    /// Characteristic length, in the unit of the linear parts [default: the reach of the model; 1
    /// for a file of twists]
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(crate) length: Option<f64>,

    /// Point at which lengths are judged, in the frame of the twists [default: the point nearest
    /// to all axes]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub(crate) center: Option<Numbers<3>>,

    /// Error of the twists, relative to each [default: rounding]
    #[arg(long, value_name = "SHARE", allow_hyphen_values = true)]
    pub(crate) noise: Option<f64>,

    /// Pitches at which the hyperbolic inverse is looked at [m/rad], `inf` among them; may be
    /// given several times
    #[arg(long, value_name = "H", allow_hyphen_values = true)]
    pub(crate) h: Vec<f64>,

    /// Also the joint rates that move this point, fixed to the frame that is driven, along
    /// --direction; world axes [m]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "direction")]
    pub(crate) point: Option<Numbers<3>>,

    /// Direction of the motion of --point, of any length; world axes
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "point")]
    pub(crate) direction: Option<Numbers<3>>,

    /// The twists of the file are written with the angular part first
    #[arg(long)]
    pub(crate) angular_first: bool,

    /// Draw the Gram determinant and the size of the projector over the pitch, and the cylindroid
    /// of a two-system
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) plot: Option<PathBuf>,
}
