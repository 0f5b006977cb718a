//! The arguments of `sweep`.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::str::FromStr;

use clap::{ArgGroup, Args, ValueEnum};
use cylindroid::sweep::{Axis, ParameterRange, VelocityMetric};

use super::{CollisionArgs, FrameArgs, MeshName, ModelArgs};
use crate::obstacle::ObstacleArg;
use crate::values::{Joints, Numbers};

pub(crate) const ABOUT: &str = "\
Quantities of millions of configurations: samples within the limits, grids, files of configurations \
or poses; capability maps

Samples are points of a scrambled Sobol' sequence: sample i depends on the seed and i alone. Without \
--out, statistics of each column are printed. With --out, the rows are written into a folder of \
Parquet files, which can be interrupted and resumed: the files are the same to the byte whatever the \
number of threads and interruptions. Column names are those of coordinates and quantities; units \
are in the manifest.

Parameters of a mechanism file in --over or --vary are designs, each with all configurations; alone, \
with the configuration of --q. A design that cannot be loaded has rows with design_valid 0 and no \
numbers.

--poses asks inverse kinematics for a configuration at each pose of a file, from home: --task names the \
components that count. Rows have the configuration and reached, 1 or 0; those that are not reached have \
NaN, counts of 0 and empty names, which statistics leave out. Positions are reached within 1e-6 of the \
reach of the model, see `info`.

--reach asks inverse kinematics at the points of a grid: of --directions that approach from all sides, \
each with --rolls about it, it finds those that the tool reaches within the limits. Rows have their \
number, reachability (the share of the directions), and of --quantities the best value over the \
solutions.";

pub(crate) const EXAMPLES: &str = "\
Examples:
  cylindroid sweep panda --samples 1e4 --quantities yoshikawa,condition,limit_distance
  cylindroid sweep panda --samples 1e5 --quantities pose,jacobian,singular_values --out map
  cylindroid sweep ur5e --over shoulder_lift_joint=-3:0:61 --over elbow_joint=0:3:61 --task x,y,z
  cylindroid sweep docs/designs.toml --over crank=0.4:0.7:5 --quantities measures
  cylindroid sweep docs/designs.toml --vary crank=0.4:0.7 --designs 100 --quantities measures
  cylindroid sweep stewart --configurations configurations.csv --quantities pose,measures
  cylindroid sweep ur5e --poses poses.csv --quantities limit_distance,condition --out reached.csv
  cylindroid sweep ur5e --reach x=-1:1:21 --reach z=-0.5:1:16 --plot reach.svg
  cylindroid sweep panda --samples 1e4 --quantities pose,yoshikawa --plot cloud.svg
  cylindroid sweep docs/cell.toml --samples 1e4 --quantities self_distance
  cylindroid sweep docs/two-arms.toml --samples 1e4 --relative-to right/hand_tcp

Quantities:
  pose                     position and unit quaternion of the frame
  jacobian                 Jacobian at the frame's origin, world axes
  singular_values          of the Jacobian, linear rows over the characteristic length
  smallest_singular_value  the last of them
  condition                the largest over the smallest of them
  yoshikawa                sqrt(det J J^T), in --metric
  limit_distance           smallest distance to a position limit, negative outside
  self_distance            smallest distance of links that can collide, negative: penetration depth
  obstacle_distance        the same of links to each --obstacle
  payload                  largest force along --direction [N] within the effort limits, without weight
  gibson_hunt              class and principal pitches of the screw system
  measures                 mobility, distances to singularities, kinematic efficiencies, in --metric

For closed chains: pose, limit_distance, self_distance, obstacle_distance, payload and measures. \
With --relative-to: all but payload and measures. \
For --reach: yoshikawa, smallest_singular_value, condition, limit_distance, self_distance, \
obstacle_distance and payload. Exit code 130 after an \
interrupt.";

#[derive(Debug, Args)]
#[command(group = ArgGroup::new("sampled").multiple(true))]
pub(crate) struct SweepArgs {
    #[command(flatten)]
    pub(crate) model: ModelArgs,

    /// Number of samples within the position limits, e.g. 1e6; joints without limits rotate
    /// through -pi to pi. Of a closed chain those of the actuated joints, the others follow from home
    #[arg(long, value_name = "N", group = "sampled", allow_hyphen_values = true)]
    #[arg(required_unless_present_any = ["over", "vary", "configurations", "poses", "reach"])]
    pub(crate) samples: Option<Count>,

    /// Selects one of the sequences of samples and of designs
    #[arg(long, value_name = "N", default_value_t = 0, requires = "sampled")]
    #[arg(allow_negative_numbers = true)]
    pub(crate) seed: u64,

    /// An axis of a grid: a coordinate [rad or m] or a parameter, its first and last value and the
    /// number of values; repeat for further axes, of which the last changes fastest
    #[arg(long, value_name = "NAME=A:B:N", allow_hyphen_values = true)]
    pub(crate) over: Vec<AxisArg>,

    /// The range of a parameter for sampled designs; repeatable
    #[arg(long, value_name = "NAME=A:B", requires = "designs", allow_hyphen_values = true)]
    pub(crate) vary: Vec<RangeArg>,

    /// Number of sampled designs, points of a scrambled Sobol' sequence
    #[arg(long, value_name = "N", requires = "vary", group = "sampled")]
    #[arg(allow_hyphen_values = true)]
    pub(crate) designs: Option<Count>,

    /// The other coordinates of a grid, or the configuration of all designs [rad or m], as for other
    /// commands
    #[arg(long, value_name = "Q", default_value = "home", allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["samples", "configurations", "poses", "reach"])]
    pub(crate) q: Joints,

    /// A .csv, .json or .parquet file with a configuration in each row [rad or m]. Columns with
    /// names may be in any order; others than those of the coordinates are ignored
    #[arg(long, value_name = "FILE", conflicts_with = "samples")]
    pub(crate) configurations: Option<PathBuf>,

    /// A .csv, .json or .parquet file with a pose of the tool in each row: x, y, z [m] and a unit
    /// quaternion qw, qx, qy, qz, without one where --task has no rotations. Inverse kinematics looks
    /// for a configuration of each
    #[arg(long, value_name = "FILE", conflicts_with_all = ["samples", "configurations"])]
    pub(crate) poses: Option<PathBuf>,

    /// An axis of a capability map [m]: x, y or z, its first and last value and the number of values;
    /// repeat for further axes, the others are 0
    #[arg(long, value_name = "NAME=A:B:N", allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["samples", "configurations", "poses"])]
    pub(crate) reach: Vec<AxisArg>,

    /// Approach directions of the tool's z axis at each point, evenly spread over the sphere, in the
    /// plane angles; 0: positions alone [default: 50]
    #[arg(long, value_name = "N", requires = "reach", allow_hyphen_values = true)]
    pub(crate) directions: Option<Count>,

    /// Rotations about each direction; 0: any, for arms of five joints [default: 12]
    #[arg(long, value_name = "N", requires = "reach", allow_hyphen_values = true)]
    pub(crate) rolls: Option<Count>,

    /// Placement of the axes of --reach in the world [m, rad] [default: that of the world]
    #[arg(long, value_name = "X,Y,Z,ROLL,PITCH,YAW", requires = "reach")]
    #[arg(allow_hyphen_values = true)]
    pub(crate) reach_from: Option<Numbers<6>>,

    /// The quantities of each configuration, see below
    /// [default: pose,yoshikawa,smallest_singular_value,limit_distance,gibson_hunt; of a closed chain
    /// pose,measures; of --reach none]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) quantities: Vec<String>,

    #[command(flatten)]
    pub(crate) frame: FrameArgs,

    /// The frame from which --frame is seen, which may move: two arms together. Poses, Jacobians,
    /// their measures and the screw system are relative to it, in its axes
    #[arg(long, value_name = "FRAME", conflicts_with_all = ["poses", "reach"])]
    pub(crate) relative_to: Option<String>,

    /// The components that count, of the twist for measures and those of the Jacobian, of the pose for
    /// --poses: pose, position, orientation, or a list of x,y,z,rx,ry,rz, in world axes or those of
    /// --relative-to; of poses
    /// without measures also pointing [default: pose]
    #[arg(long, value_name = "TASK")]
    pub(crate) task: Option<String>,

    /// Metric of yoshikawa and measures: `unit` (m and rad, unscaled), `length` (lengths over the
    /// characteristic length), `limits` (as `length`, and joint velocities over their limits)
    #[arg(long, value_name = "NAME", default_value = "unit")]
    pub(crate) metric: SweepMetricName,

    /// Characteristic length [m] [default: that of the model, see `info`]
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(crate) length: Option<f64>,

    /// Direction of the force of payload, in world axes [default: 0,0,-1]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub(crate) direction: Option<Numbers<3>>,

    /// An obstacle of obstacle_distance in the world, as for `distance`; repeatable
    #[arg(long, value_name = "NAME=SHAPE@POSE", allow_hyphen_values = true)]
    pub(crate) obstacle: Vec<ObstacleArg>,

    /// Shape that stands for a mesh in self_distance and obstacle_distance [default: convex_hull]
    #[arg(long, value_name = "SHAPE")]
    pub(crate) meshes: Option<MeshName>,

    /// Folder of the Parquet files, or a file that ends in .csv
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Continue a folder that was interrupted; finished parts are verified by their checksums
    #[arg(long, requires = "out")]
    pub(crate) resume: bool,

    /// Rows of a file: the unit of work, which each thread has once in memory [default: 65536,
    /// of designs 1024, of --poses 128, of --reach 64]
    #[arg(long, value_name = "N", requires = "out", allow_hyphen_values = true)]
    pub(crate) part_rows: Option<Count>,

    /// Draw the rows as an SVG: grids as slices, poses as clouds of points, others as histograms
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) plot: Option<PathBuf>,

    /// The column that colours the drawing [default: the first of a single quantity]
    #[arg(long, value_name = "COLUMN", requires = "plot")]
    pub(crate) color: Option<String>,

    /// Number of threads [default: that of the processor]
    #[arg(long, value_name = "K", allow_negative_numbers = true)]
    pub(crate) threads: Option<NonZeroUsize>,
}

impl SweepArgs {
    /// The shapes of distances, as those of `distance`.
    pub(crate) fn collision(&self) -> CollisionArgs {
        CollisionArgs { obstacle: self.obstacle.clone(), meshes: self.meshes, samples: None }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SweepMetricName {
    /// Metres and radians, unscaled
    Unit,
    /// Lengths over the characteristic length
    Length,
    /// As `length`, and joint velocities over their limits
    Limits,
}

impl SweepMetricName {
    pub(crate) const fn metric(self) -> VelocityMetric {
        match self {
            Self::Unit => VelocityMetric::Unit,
            Self::Length => VelocityMetric::Length,
            Self::Limits => VelocityMetric::Limits,
        }
    }
}

/// A whole number, `1e7` too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Count(pub(crate) u64);

impl FromStr for Count {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let whole = |x: f64| ((0.0..1e15).contains(&x) && x.fract() == 0.0).then_some(x);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number"
        )]
        let scientific = || text.parse::<f64>().ok().and_then(whole).map(|x| x as u64);
        let count = text.parse().ok().or_else(scientific);
        count.map(Self).ok_or_else(|| format!("'{text}' is not a whole number such as 1000 or 1e7"))
    }
}

/// `NAME=A:B`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RangeArg(pub(crate) ParameterRange);

impl FromStr for RangeArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("'{text}' is not of the form name=smallest:largest");
        let (name, values) = text.rsplit_once('=').ok_or_else(wrong)?;
        let (from, to) = values.split_once(':').ok_or_else(wrong)?;
        let number = |text: &str| text.trim().parse::<f64>().map_err(|_| wrong());
        let name = name.trim().to_owned();
        Ok(Self(ParameterRange { name, from: number(from)?, to: number(to)? }))
    }
}

/// `NAME=A:B:N`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AxisArg(pub(crate) Axis);

impl FromStr for AxisArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("'{text}' is not of the form name=first:last:number");
        let (name, values) = text.rsplit_once('=').ok_or_else(wrong)?;
        let [from, to, count] =
            <[&str; 3]>::try_from(values.split(':').collect::<Vec<_>>()).map_err(|_| wrong())?;
        let number = |text: &str| text.trim().parse::<f64>().map_err(|_| wrong());
        let count = count.trim().parse::<Count>()?.0;
        let name = name.trim().to_owned();
        Ok(Self(Axis { name, from: number(from)?, to: number(to)?, count }))
    }
}
