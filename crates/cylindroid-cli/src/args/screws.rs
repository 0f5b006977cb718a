//! The arguments of `screws`.

use std::path::PathBuf;

use clap::Args;

use super::{ConfigurationArgs, FrameArgs};
use crate::values::{Numbers, Weights};

pub(crate) const ABOUT: &str = "\
The screw system of the joints: class, pitches, frame, and which inverses exist

For the joint twists of a robot at a configuration, for the motions that the loops of a closed \
chain permit its reference or another frame, or for twists read from a file: order and \
Gibson-Hunt class of the screw system they span, principal pitches and screws, canonical frame, \
reciprocal system, the pitches h at which a hyperbolic pseudoinverse exists, the pitch with the \
smallest projector norm, and whether the joint axes are in involution. With --h, the hyperbolic \
pseudoinverse and its projectors; with --twist, the joint velocities and the error form. The results are independent \
of the reference frame and of the unit of length.";

pub(crate) const EXAMPLES: &str = "\
Examples:
  cylindroid screws youbot
  cylindroid screws youbot --q 0.4,0.6,0.9,0.5,0.2 --h 0.1 --plot screws.svg
  cylindroid screws youbot --h 0.1 --h inf --twist 0.05,0.02,0,0.2,0.1,0.1
  cylindroid screws axes.csv --length 0.5 --noise 1e-6

Instead of a model, a file of twists (.csv or .json) can be given: six numbers per twist, the \
linear part first, as rows of a CSV file or a JSON list of lists.";

#[derive(Debug, Args)]
pub(crate) struct ScrewsArgs {
    #[command(flatten)]
    pub(crate) configuration: ConfigurationArgs,

    #[command(flatten)]
    pub(crate) frame: FrameArgs,

    /// Characteristic length, in the unit of the linear parts [default: that of the model; 1
    /// for a file of twists]
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(crate) length: Option<f64>,

    /// Centre at which twists are scaled, in the frame of the twists [default: the point closest to
    /// all axes]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub(crate) center: Option<Numbers<3>>,

    /// Relative error of the twists [default: rounding]
    #[arg(long, value_name = "SHARE", allow_hyphen_values = true)]
    pub(crate) noise: Option<f64>,

    /// Pitch of the hyperbolic pseudoinverse [m/rad], `inf` for the limit; repeatable. Prints its
    /// existence, the inverse, the projectors of twists and wrenches, the Gram determinant and the
    /// h-reciprocal system
    #[arg(long, value_name = "H", allow_hyphen_values = true)]
    pub(crate) h: Vec<f64>,

    /// Metric of joint velocities for the inverse of --h: weights, or a .csv or .json file with the
    /// rows of a symmetric positive definite matrix, or `inertia`: the mass matrix of the model. Of
    /// redundant joints it selects the velocities of least norm
    #[arg(long, value_name = "WEIGHTS", allow_hyphen_values = true, requires = "h")]
    pub(crate) joint_metric: Option<Weights>,

    /// Also compute the joint velocities for this twist at the pitches of --h, and the pitches at
    /// which its error form vanishes; at the origin of the world, world axes (of a file: in its frame
    /// and order) [m/s, rad/s]
    #[arg(long, value_name = "VX,VY,VZ,WX,WY,WZ", allow_hyphen_values = true)]
    pub(crate) twist: Option<Numbers<6>>,

    /// Also compute the joint velocities that move this point of the controlled frame along
    /// --direction; world axes [m]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "direction")]
    pub(crate) point: Option<Numbers<3>>,

    /// Direction of the motion of --point, of any length; world axes
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "point")]
    pub(crate) direction: Option<Numbers<3>>,

    /// The twists of the file have the angular part first
    #[arg(long)]
    pub(crate) angular_first: bool,

    /// Draw the Gram determinant and the projector norm over the pitch, the cylindroid of a
    /// two-system, and the conics of equal pitch of a three-system
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) plot: Option<PathBuf>,
}
