//! An axis of a grid.
//!
//! Checked  tests/sweep/sampling.rs

use crate::error::{Error, Result};

/// An axis of a grid: `count` values from `from` to `to`, both included (rad or m).
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The coordinate.
    pub name: String,
    /// First value.
    pub from: f64,
    /// Last value.
    pub to: f64,
    /// Number of values; 1 is `from` alone.
    pub count: u64,
}

impl Axis {
    /// The value `i`.
    #[must_use]
    pub fn value(&self, i: u64) -> f64 {
        let last = self.count.saturating_sub(1);
        match i {
            0 => self.from,
            i if i == last => self.to,
            i => self.from + (self.to - self.from) * (i as f64 / last as f64),
        }
    }
}

/// Number of points of a grid.
pub(super) fn points(axes: &[Axis]) -> Result<u64> {
    axes.iter().try_fold(1_u64, |rows, axis| {
        let reason = match rows.checked_mul(axis.count) {
            Some(0) => "an axis has one value at least",
            Some(rows) if rows <= 1 << 48 => return Ok(rows),
            _ => "the grid has more than 2^48 points",
        };
        let (value, reason) = (axis.name.clone(), reason.to_owned());
        Err(Error::InvalidOption { option: "over", value, reason })
    })
}
