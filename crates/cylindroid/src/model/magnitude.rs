//! The range of numbers in models: finite, and small enough that sums of products are finite.
//!
//! Checked  tests/formats/magnitudes.rs, tests/it/magnitudes.rs

use crate::error::{Error, Result, all_finite};
use crate::spatial::Pose;
use crate::tolerance::MAX_MAGNITUDE;

/// Returns an error for the first number that is not finite, or out of range, with its name.
pub(crate) fn check(values: &[f64], name: impl Fn(usize) -> String) -> Result<()> {
    if let Some(i) = values.iter().position(|x| !x.is_finite()) {
        return Err(Error::NotFinite { what: name(i), value: values[i] });
    }
    match values.iter().position(|x| x.abs() > MAX_MAGNITUDE) {
        None => Ok(()),
        Some(i) => Err(Error::OutOfRange { what: name(i), value: values[i], range: MAX_MAGNITUDE }),
    }
}

/// The end of a sentence about numbers of which one is not finite or out of range.
pub(crate) fn fault(values: &[f64]) -> Option<String> {
    if all_finite(values) { bound_fault(values) } else { Some("is not finite".into()) }
}

/// The same where infinity means no limit.
pub(crate) fn bound_fault(values: &[f64]) -> Option<String> {
    let beyond = |x: &&f64| x.is_finite() && x.abs() > MAX_MAGNITUDE;
    let x = values.iter().find(beyond)?;
    Some(format!("is {x:e}, out of range: magnitudes up to {MAX_MAGNITUDE:e} are accepted"))
}

pub(crate) fn pose_fault(pose: &Pose) -> Option<String> {
    if pose.is_finite() {
        fault(&pose.translation.to_array())
    } else {
        Some("is not finite".into())
    }
}
