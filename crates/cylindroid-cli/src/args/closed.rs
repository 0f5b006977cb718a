//! The arguments of the commands on closed chains.

use std::path::PathBuf;

use clap::builder::RangedU64ValueParser;
use clap::{Args, ValueEnum};
use cylindroid::manipulability::EllipsoidView;

use super::{ConfigurationArgs, MOST};
use crate::values::Joints;
use crate::values::{ByName, Intervals, List, Weights};

pub(crate) const MOBILITY: &str = "\
Mobility of a mechanism: degrees of freedom, redundancy, idle motions, hyperstaticity, singularities

Counts are ranks at this configuration, printed with their gap, the Gruebler-Kutzbach count \
and the finite mobility (first-order motions that extend to finite motions). The configuration is \
compared with other closed configurations of the mechanism: at a singularity, the blocked wrench \
and the motions lost or gained are given as screws in the world frame. The counts assume closed \
loops and contacts; the loop-closure error is printed. With --modes, the operation modes of the \
mechanism are searched instead: components of its closed configurations with their dimension and \
counts, and where they meet.";

pub(crate) const MOBILITY_EXAMPLES: &str = "\
Examples:
  cylindroid mobility stewart
  cylindroid mobility five-bar --actuated q1,q5
  cylindroid mobility ur5e --q zero
  cylindroid mobility delta --modes 64";

pub(crate) const MANIPULABILITY: &str = "\
Manipulability: transmission of motion and force from the actuated joints to the reference frame

Efficiencies are squared ratios of output to input along the principal directions: of motion \
(object velocity over joint velocity), of active force (exerted wrench over torques, undetermined \
wrenches of least norm) and of passive force (resisted wrench). Zero: no output. Infinite: output \
without input.";

pub(crate) const MANIPULABILITY_EXAMPLES: &str = "\
Examples:
  cylindroid manipulability five-bar --actuated q2,q4 --plot ellipses.svg
  cylindroid manipulability five-bar --plot ellipses.svg --view section
  cylindroid manipulability panda --metric limits --task x,y,z --polytope
  cylindroid manipulability stewart --metric length --gradient smallest
  cylindroid manipulability path/to/ur5_robot.urdf --metric length --wq inertia
  cylindroid manipulability stewart --configurations configurations.csv --json";

#[derive(Debug, Args)]
pub(crate) struct ClosedArgs {
    #[command(flatten)]
    pub(crate) configuration: ConfigurationArgs,

    /// The actuated joints, replacing those of the file
    #[arg(long, value_name = "JOINTS", value_delimiter = ',')]
    pub(crate) actuated: Vec<String>,

    /// The frame whose motion is the goal [default: the reference of the file, else the tool]
    #[arg(long, value_name = "NAME")]
    pub(crate) frame: Option<String>,

    /// Characteristic length [m] [default: that of the model, see `info`]
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(crate) length: Option<f64>,
}

#[derive(Debug, Args)]
pub(crate) struct MobilityArgs {
    #[command(flatten)]
    pub(crate) closed: ClosedArgs,

    /// Search for operation modes from this many starts: the configuration with all its branches,
    /// then random restarts within limits. Modes may be missed, and one mode may comprise several
    /// components with equal counts
    #[arg(long, value_name = "STARTS", allow_negative_numbers = true)]
    #[arg(value_parser = RangedU64ValueParser::<usize>::new().range(0..=MOST))]
    pub(crate) modes: Option<usize>,

    /// Seed of the random restarts of --modes
    #[arg(long, value_name = "N", default_value_t = 0, requires = "modes")]
    #[arg(allow_negative_numbers = true)]
    pub(crate) seed: u64,
}

pub(crate) const ASSEMBLE: &str = "\
Closes the loops of a mechanism from an initial guess, within its position limits

One assembly is found, usually the nearest; use --modes to enumerate the assembly modes. With --to, \
coordinates move straight to other values while the loops stay closed in the same assembly mode; \
the path ends before a singularity or at a position limit, which is reported.

Exit code 0 if all loops and contacts are closed (with --modes: in at least one mode; with --to: at \
the goal), 1 if not, 2 on an error. The line q can be passed to --q of other commands. Loop joints \
have no coordinate: they cannot be prescribed, and their limits are not enforced.";

pub(crate) const ASSEMBLE_EXAMPLES: &str = "\
Examples:
  cylindroid assemble five-bar --q 0.2,-0.1,0,0 --hold q1
  cylindroid assemble stewart --hold actuated --modes 200
  cylindroid assemble four-bar --to q1=6.283185307
  cylindroid assemble stewart --to leg1=0.2,leg2=0.2";

#[derive(Debug, Args)]
pub(crate) struct AssembleArgs {
    #[command(flatten)]
    pub(crate) configuration: ConfigurationArgs,

    /// Prescribed coordinates, which keep the values of --q: names of coordinates or joints, or
    /// `actuated` for all actuated ones (the passive ones follow)
    #[arg(long, value_name = "JOINTS", value_delimiter = ',')]
    pub(crate) hold: Vec<String>,

    /// Enumerate the assembly modes from this many starts: the guess, then random restarts within
    /// limits. Modes may be missed; the number of starts that led to each is printed
    #[arg(long, value_name = "STARTS", conflicts_with = "to")]
    #[arg(allow_negative_numbers = true)]
    #[arg(value_parser = RangedU64ValueParser::<usize>::new().range(0..=MOST))]
    pub(crate) modes: Option<usize>,

    /// Seed of the random restarts of --modes
    #[arg(long, value_name = "N", default_value_t = 0, requires = "modes")]
    #[arg(allow_negative_numbers = true)]
    pub(crate) seed: u64,

    /// Move these coordinates from --q (assembled) to these values [rad or m], those of --hold fixed
    /// and all others following: `name=value,...`
    #[arg(long, value_name = "NAME=VALUE,...", allow_hyphen_values = true)]
    pub(crate) to: Option<Joints>,

    /// Smallest accepted distance of --to to a singularity [-]: smallest over largest singular value
    /// of the loop Jacobian with respect to the free coordinates, 1e-5 to 1 [default: 0.001]
    #[arg(long, value_name = "D", allow_hyphen_values = true, requires = "to")]
    #[arg(conflicts_with = "modes")]
    pub(crate) least_distance: Option<f64>,
}

#[derive(Debug, Args)]
pub(crate) struct ManipulabilityArgs {
    #[command(flatten)]
    pub(crate) closed: ClosedArgs,

    /// Metric of motions: `unit` (m and rad, unscaled), `length` (lengths over the characteristic
    /// length), `limits` (as `length`, and joint velocities over their limits), `inertia` (twists
    /// by the kinetic energy of the body of the reference frame)
    #[arg(long, value_name = "NAME", default_value = "unit")]
    pub(crate) metric: MetricName,

    /// Metric of twists (of the task with --task): weights, or a .csv or .json file with the rows
    /// of a symmetric positive definite matrix; in place of that of --metric
    #[arg(long, value_name = "WEIGHTS", allow_hyphen_values = true)]
    pub(crate) wu: Option<Weights>,

    /// Metric of the velocities of the actuated joints, likewise; `inertia`: twice the kinetic energy
    /// of the whole mechanism, from the masses of the model
    #[arg(long, value_name = "WEIGHTS", allow_hyphen_values = true)]
    pub(crate) wq: Option<Weights>,

    /// Metric of wrenches [default: the inverse of that of twists]
    #[arg(long, value_name = "WEIGHTS", allow_hyphen_values = true)]
    pub(crate) ww: Option<Weights>,

    /// Metric of the torques of the actuated joints [default: the inverse of that of
    /// velocities]
    #[arg(long, value_name = "WEIGHTS", allow_hyphen_values = true)]
    pub(crate) wtau: Option<Weights>,

    /// Weights of the forces in loop joints and contacts, for the efficiencies of internal forces:
    /// a number for all, `name=number` for some; for moments divided by the square of the
    /// characteristic length. A compliance [m/N] measures them by elastic energy [default: 1]
    #[arg(long, value_name = "WEIGHTS", allow_hyphen_values = true)]
    pub(crate) wt: Option<ByName>,

    /// Components of the motion that matter, of x, y, z, rx, ry, rz (in the plane x, y, rz)
    #[arg(long, value_name = "COMPONENTS", value_delimiter = ',')]
    pub(crate) task: Vec<String>,

    /// A task that is not components: a .csv or .json file with a row for each of its numbers,
    /// linear in the twist
    #[arg(long, value_name = "FILE", conflicts_with = "task")]
    pub(crate) task_map: Option<PathBuf>,

    /// Also compute all velocities and forces within the limits of the actuators: ranges of each
    /// component, and vertices for up to three components
    #[arg(long)]
    pub(crate) polytope: bool,

    /// Rate limits of the actuated joints in place of the model's [rad/s or m/s]: `2,-1:3,...`, one
    /// or two numbers for each
    #[arg(long, value_name = "LIMITS", allow_hyphen_values = true)]
    pub(crate) velocity_limits: Option<Intervals>,

    /// Torque limits of the actuated joints in place of the model's [N m or N], likewise; a cable
    /// that pulls is `-5:0` or `0:5`
    #[arg(long, value_name = "LIMITS", allow_hyphen_values = true)]
    pub(crate) torque_limits: Option<Intervals>,

    /// Also the gradient of a measure of motion with respect to q: `volume` (Yoshikawa's),
    /// `smallest`, `largest`, `anisotropy`
    #[arg(long, value_name = "MEASURE")]
    pub(crate) gradient: Option<MeasureName>,

    /// In place of one configuration those of a .csv, .json or .parquet file, a row each [rad or m]:
    /// mobility, distances to singularities and measures of motion as numbers, those of --task if
    /// it is given. Columns with names,
    /// those of Parquet and of a first line of CSV, may be in any order; other columns are ignored,
    /// as in the files of `move --out`
    #[arg(long, value_name = "FILE", conflicts_with_all = [
        "q", "degrees", "ww", "wtau", "wt", "polytope", "torque_limits", "gradient", "plot",
    ])]
    pub(crate) configurations: Option<PathBuf>,

    /// Draw the mechanism with its ellipses of velocity and force and, where limits are known,
    /// polytopes: in the plane, in the three planes of space, or in two or three components of
    /// --task. The drawn numbers are added to the output
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) plot: Option<PathBuf>,

    /// Components that are not drawn in a plane of --plot: free (`projection`) or zero (`section`)
    #[arg(long, value_name = "NAME", default_value = "projection", requires = "plot")]
    pub(crate) view: ViewName,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ViewName {
    /// The other components are free
    Projection,
    /// The other components are zero
    Section,
}

impl ViewName {
    pub(crate) const fn view(self) -> EllipsoidView {
        match self {
            Self::Projection => EllipsoidView::Projection,
            Self::Section => EllipsoidView::Section,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MetricName {
    /// Metres and radians, unscaled
    Unit,
    /// Lengths over the characteristic length
    Length,
    /// As `length`, and joint velocities over their limits
    Limits,
    /// Twists by kinetic energy
    Inertia,
}

impl MetricName {
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Unit => "unit",
            Self::Length => "length",
            Self::Limits => "limits",
            Self::Inertia => "inertia",
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MeasureName {
    /// Product of the roots of the finite efficiencies
    Volume,
    /// Smallest finite efficiency
    Smallest,
    /// Largest finite efficiency
    Largest,
    /// Largest over smallest
    Anisotropy,
}

pub(crate) const STATICS: &str = "\
Joint torques in equilibrium with a wrench, forces in loops and contacts, stiffness and deflection

The wrench acts on the reference frame from outside, at its origin and in world axes: N, then N m. \
The torques are exerted by the actuators in equilibrium: for every motion, torques times joint \
velocities plus wrench times twist is zero. They have the least norm; internal torques may be \
added. The transmitted wrench of a joint or contact is exerted by its first link on its second; a \
contact that pushes has a positive normal force.";

pub(crate) const STATICS_EXAMPLES: &str = "\
Examples:
  cylindroid statics panda --wrench 0,0,-10,0,0,0
  cylindroid statics five-bar --actuated q1,q5 --wrench 3,-1,0.2
  cylindroid statics two-arm --wrench 0,0,-9.81,0,0,0 --compliance 1e-6
  cylindroid statics stewart --wrench 0,0,-1000,0,0,0 --stiffness 2e7";

#[derive(Debug, Args)]
pub(crate) struct StaticsArgs {
    #[command(flatten)]
    pub(crate) closed: ClosedArgs,

    /// The wrench on the reference frame [N, N m]: fx,fy,fz,mx,my,mz, in the plane fx,fy,mz
    #[arg(long, value_name = "WRENCH", allow_hyphen_values = true)]
    pub(crate) wrench: List,

    /// Metric of the torque norm: weights of the actuated joints, or a file
    #[arg(long, value_name = "WEIGHTS", allow_hyphen_values = true)]
    pub(crate) wtau: Option<Weights>,

    /// Stiffness of joints along their motion [N m/rad or N/m], of the drives of actuated joints and
    /// of springs in passive ones: a number for all actuated joints, `name=number` for some. With it,
    /// or with `[[elasticity]]` in the file, stiffness and compliance at the reference frame, their
    /// eigenscrews and the deflection under the wrench are printed too
    #[arg(long, value_name = "N/M", allow_hyphen_values = true)]
    pub(crate) stiffness: Option<ByName>,

    /// Compliance of loop joints and contacts [m/N] for elastic forces: a number for all,
    /// `name=number` for some; for moments it is divided by the square of the characteristic
    /// length
    #[arg(long, value_name = "M/N", allow_hyphen_values = true)]
    pub(crate) compliance: Option<ByName>,
}

pub(crate) const GRASP: &str = "\
Force closure of a grasp with friction, its quality, and immobilisation without friction

The quality epsilon (Ferrari and Canny) is the norm of the smallest wrench that the fingers cannot \
resist, in its worst direction, given between certified bounds; moments are divided by the \
characteristic length. Fingers push along their normals, into the object. Contacts must be points: \
point_frictionless, hard_finger, soft_finger.\n\n\
Without friction, fixed fingers immobilise the object to first order (form closure), or to second \
order by the curvatures of both bodies (Rimon and Burdick), which the file gives; a contact without \
curvature is a sharp finger on a flat face. Exit code 0 for force closure, 1 otherwise.";

pub(crate) const GRASP_EXAMPLES: &str = "\
Examples:
  cylindroid grasp docs/grasp.toml --torsion 0.01
  cylindroid grasp docs/grasp.toml --torsion 0.01 --mu 0.4,tip1=0.6 --strength 20";

#[derive(Debug, Args)]
pub(crate) struct GraspArgs {
    #[command(flatten)]
    pub(crate) configuration: ConfigurationArgs,

    /// A frame of the object; moments are about its origin [default: the reference of the file]
    #[arg(long, value_name = "NAME")]
    pub(crate) frame: Option<String>,

    /// Coefficient of friction, replacing that of the file: a number for all contacts,
    /// `name=number` for some
    #[arg(long, value_name = "MU", allow_hyphen_values = true)]
    pub(crate) mu: Option<ByName>,

    /// Largest moment about the normal over the normal force, of soft fingers [m], likewise
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(crate) torsion: Option<ByName>,

    /// Largest normal force of each finger [N], likewise; without it, the normal forces of all
    /// fingers sum to 1 N
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) strength: Option<ByName>,

    /// Characteristic length that moments are divided by [m] [default: from the origin of the
    /// frame to the farthest contact]
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(crate) length: Option<f64>,
}
