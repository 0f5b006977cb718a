//! Reads the twists: of a robot at a configuration, or of a file.

use std::ffi::OsStr;
use std::path::Path;

use cylindroid::closure::{ClosedChain, LoopClosureError, frame_twists};
use cylindroid::kinematics::Chain;
use cylindroid::model::Mechanism;
use cylindroid::{EndEffector, Error, Matrix, Result, State, Twist, Vec3};

use crate::args::ScrewsArgs;
use crate::commands::shared::{configuration, end_effector, load};
use crate::number_file::{self, Row};

/// Twists with names, in one frame.
#[derive(Debug)]
pub(super) struct Twists {
    /// The robot and its configuration; `None` for a file of twists.
    pub(super) robot: Option<(Mechanism, String, Vec<f64>)>,
    pub(super) file: String,
    pub(super) names: Vec<String>,
    pub(super) twists: Vec<Twist>,
    /// How far the loops of a closed chain are open.
    pub(super) closure_error: Option<LoopClosureError>,
    /// Their characteristic length.
    pub(super) length: f64,
}

impl Twists {
    pub(super) fn read(args: &ScrewsArgs) -> Result<Self> {
        let path = Path::new(&args.configuration.model.name);
        match path.extension().and_then(OsStr::to_str) {
            Some("csv" | "json") => {
                let rows = number_file::rows(path)?;
                let twists = rows.iter().map(|row| six(path, row)).collect::<Result<_>>()?;
                Self::of_file(args, twists)
            }
            _ => Self::of_robot(args),
        }
    }

    fn of_file(args: &ScrewsArgs, rows: Vec<[f64; 6]>) -> Result<Self> {
        if !args.configuration.model.parameter.is_empty() {
            return Err(Error::InvalidOption {
                option: "--parameter",
                value: args.configuration.model.name.clone(),
                reason: "a file of twists has no parameters; omit the option".to_owned(),
            });
        }
        if args.frame.frame.is_some() || args.frame.tool.is_some() {
            return Err(Error::InvalidOption {
                option: "--frame or --tool",
                value: args.configuration.model.name.clone(),
                reason: "a file of twists has no frames; omit the option".to_owned(),
            });
        }
        Ok(Self {
            robot: None,
            file: args.configuration.model.name.clone(),
            names: (1..=rows.len()).map(|i| i.to_string()).collect(),
            twists: rows.into_iter().map(|row| Self::in_order(args, row)).collect(),
            closure_error: None,
            length: 1.0,
        })
    }

    /// A twist from its numbers in the order of the options.
    pub(super) fn in_order(args: &ScrewsArgs, [a, b, c, d, e, f]: [f64; 6]) -> Twist {
        let (first, second) = (Vec3::new(a, b, c), Vec3::new(d, e, f));
        let (linear, angular) = if args.angular_first { (second, first) } else { (first, second) };
        Twist { linear, angular }
    }

    fn of_robot(args: &ScrewsArgs) -> Result<Self> {
        if args.angular_first {
            return Err(Error::InvalidOption {
                option: "--angular-first",
                value: args.configuration.model.name.clone(),
                reason: "it applies only to files of twists (.csv, .json)".to_owned(),
            });
        }
        let robot = load(&args.configuration.model, &[])?;
        let q = configuration(&robot, &args.configuration)?;
        let end_effector = end_effector(&robot, &args.frame)?;
        let found = Self::of(&robot.state(&q)?, end_effector)?;
        if found.is_of_loops() && args.point.is_some() {
            return Err(Error::InvalidOption {
                option: "--point",
                value: args.configuration.model.name.clone(),
                reason: "the loops couple its joint velocities; move solves for them".to_owned(),
            });
        }
        Ok(found)
    }

    /// The twists of the joints that move a tool; in a closed chain those that the loops permit.
    pub(super) fn of(state: &State, end_effector: EndEffector) -> Result<Self> {
        let robot = state.mechanism();
        let frame = robot.frame_of(end_effector.frame).name.clone();
        let twists = frame_twists(state, end_effector)?;
        let closed = robot.is_closed();
        let names = if closed {
            (1..=twists.len()).map(|i| i.to_string()).collect()
        } else {
            let chain = Chain::new(robot, end_effector)?;
            let coordinates = chain.coordinates().iter();
            coordinates.map(|&c| robot.coordinates()[c].name.clone()).collect()
        };
        let closure_error = match closed {
            true => Some(ClosedChain::of(state, None, None)?.closure_error),
            false => None,
        };
        Ok(Self {
            file: String::new(),
            names,
            twists,
            closure_error,
            length: robot.reach(),
            robot: Some((robot.clone(), frame, state.q().to_vec())),
        })
    }

    /// True for the motions that the loops of a closed chain permit: not those of single joints.
    pub(super) fn is_of_loops(&self) -> bool {
        self.closure_error.is_some()
    }

    /// The twists as columns.
    pub(super) fn matrix(&self) -> Matrix {
        Matrix::from_fn(6, self.twists.len(), |i, j| self.twists[j].to_array()[i])
    }

    /// The title of a plot.
    pub(super) fn title(&self) -> String {
        match &self.robot {
            Some((robot, frame, _)) => format!("{}: screws of {frame}", robot.name()),
            None => format!("screws of {}", self.file),
        }
    }
}

fn six(path: &Path, row: &Row) -> Result<[f64; 6]> {
    row.numbers.as_slice().try_into().map_err(|_| {
        let (place, given) = (&row.place, row.numbers.len());
        let message =
            format!("{place} has {given} numbers; a twist has six, the linear part first");
        number_file::cannot_read(path, &message)
    })
}
