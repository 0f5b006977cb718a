//! Paths, moves and time laws.

mod cartesian_move;
mod joint_move;
mod path;
mod time_law;

use cylindroid::Error;
use cylindroid::control::KinematicBounds;

use crate::arrays::Numbers;
use crate::error::{Failure, Result};
use crate::options::pair;

pub(crate) use cartesian_move::PyCartesianMove;
pub(crate) use joint_move::PyJointMove;
pub(crate) use path::PyCartesianPath;
pub(crate) use time_law::PyTimeLaw;

/// Speeds and accelerations on a path where none are given, as on the command line.
const SPEED: (f64, f64) = (0.25, 1.0);
const ACCELERATION: (f64, f64) = (1.0, 4.0);

/// Speed, acceleration and jerk as they are given: a number, or one for translations and one for
/// rotations each.
type Given<'a, 'py> = [&'a Option<Numbers<'py>>; 3];

/// Bounds of translations and rotations. A single number is that of translations, and of rotations
/// as well if `of_both`; else those keep their default.
fn bounds(given: Given<'_, '_>, of_both: bool) -> Result<(KinematicBounds, KinematicBounds)> {
    let [speed, acceleration, jerk] = given;
    let of = |name, given: &Option<Numbers<'_>>, default: (f64, f64)| match given {
        None => Ok(default),
        Some(given) => pair(name, given, if of_both { f64::NAN } else { default.1 }),
    };
    let v = of("speed", speed, SPEED)?;
    let a = of("acceleration", acceleration, ACCELERATION)?;
    let j = of("jerk", jerk, (f64::INFINITY, f64::INFINITY))?;
    Ok((
        KinematicBounds { velocity: v.0, acceleration: a.0, jerk: j.0 },
        KinematicBounds { velocity: v.1, acceleration: a.1, jerk: j.1 },
    ))
}

/// Numbers of an argument that may be one number or a vector of them; infinite ones are allowed.
fn times<'a>(name: &'static str, of: &'a Numbers<'_>) -> Result<(&'a [f64], Option<usize>)> {
    let (values, count) = match *of.shape() {
        [] => (of.values(), None),
        [count] => (of.values(), Some(count)),
        _ => {
            let reason = "give a number or a vector";
            return Err(Failure::option(name, "an array of several axes", reason));
        }
    };
    if let Some(i) = values.iter().position(|x| x.is_nan()) {
        let what = if count.is_some() { format!("{name}[{i}]") } else { name.to_owned() };
        return Err(Error::NotFinite { what, value: f64::NAN }.into());
    }
    Ok((values, count))
}
