//! Trajectories: Cartesian paths, Cartesian and joint-space moves, time laws.

mod cartesian_move;
mod joint_move;
mod path;
mod time_law;
mod waypoints;

use cylindroid::Error;
use cylindroid::control::KinematicBounds;

use crate::arrays::Numbers;
use crate::error::{Failure, Result};
use crate::options::pair;

pub(crate) use cartesian_move::PyCartesianMove;
pub(crate) use joint_move::PyJointMove;
pub(crate) use path::PyCartesianPath;
pub(crate) use time_law::PyTimeLaw;
pub(crate) use waypoints::PyWaypointMove;

/// Default speed and acceleration of a path, the same as those of the command line.
const SPEED: (f64, f64) = (0.25, 1.0);
const ACCELERATION: (f64, f64) = (1.0, 4.0);

/// Arguments speed, acceleration and jerk, each a number or a pair (translation, rotation).
type Given<'a, 'py> = [&'a Option<Numbers<'py>>; 3];

/// Bounds of translation and rotation. A single number bounds translations, and also rotations if
/// `of_both`; otherwise rotations keep their default.
fn bounds(given: Given<'_, '_>, of_both: bool) -> Result<(KinematicBounds, KinematicBounds)> {
    let [speed, acceleration, jerk] = given;
    let of = |name, given: &Option<Numbers<'_>>, default: (f64, f64)| match given {
        None => Ok(default),
        Some(given) => {
            if let Some(bad) = given.values().iter().find(|x| x.is_nan() || **x <= 0.0) {
                let reason = "it must be positive; infinity means no bound";
                return Err(Failure::option(name, bad.to_string(), reason));
            }
            pair(name, given, if of_both { f64::NAN } else { default.1 })
        }
    };
    let v = of("speed", speed, SPEED)?;
    let a = of("acceleration", acceleration, ACCELERATION)?;
    let j = of("jerk", jerk, (f64::INFINITY, f64::INFINITY))?;
    Ok((
        KinematicBounds { velocity: v.0, acceleration: a.0, jerk: j.0 },
        KinematicBounds { velocity: v.1, acceleration: a.1, jerk: j.1 },
    ))
}

/// The values of an argument that is a number or a vector; infinite values are accepted, NaN is
/// rejected.
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

/// Refuses a NaN time, and a period that is not positive.
fn check_instant(t: f64, dt: f64) -> Result<()> {
    if t.is_nan() {
        return Err(Error::NotFinite { what: "t".to_owned(), value: t }.into());
    }
    Ok(Error::check_positive("dt", dt)?)
}
