//! Paths, moves and time laws.

mod cartesian_move;
mod joint_move;
mod path;
mod time_law;

use crate::arrays::Numbers;
use crate::error::{Failure, Result};

pub(crate) use cartesian_move::PyCartesianMove;
pub(crate) use joint_move::PyJointMove;
pub(crate) use path::PyCartesianPath;
pub(crate) use time_law::PyTimeLaw;

/// Speeds and accelerations on a path where none are given, as on the command line.
const SPEED: (f64, f64) = (0.25, 1.0);
const ACCELERATION: (f64, f64) = (1.0, 4.0);

/// Numbers of an argument that may be one number or a vector of them.
fn times<'a>(name: &'static str, of: &'a Numbers<'_>) -> Result<(&'a [f64], Option<usize>)> {
    match *of.shape() {
        [] => Ok((of.values(), None)),
        [count] => Ok((of.values(), Some(count))),
        _ => Err(Failure::option(name, "an array of several axes", "give a number or a vector")),
    }
}
