//! The loop-closure error: the residual of the loops and contacts of a configuration.
//!
//! Formula  the largest residual, in absolute value, over all rows (`constraint_rows.rs`)
//! Units    m for forces, rad for moments
//! Checked  tests/it/closure/graph.rs::loops_that_are_open_say_by_how_much

use super::velocity_constraint::Unit;
use crate::tolerance::CLOSED;

/// The loop-closure error of a configuration: the largest violation of its loops and contacts.
///
/// ```text
/// distance = max |r_i| over constraint rows of forces (m),   angle = max |r_i| over moments (rad)
/// ```
///
/// r_i is the displacement of a loop joint or contact along (about) one of its constrained
/// directions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LoopClosureError {
    /// Largest violation along constrained directions (m).
    pub distance: f64,
    /// Largest violation about constrained directions (rad).
    pub angle: f64,
}

impl LoopClosureError {
    /// Takes the residual of a row of this unit into account.
    pub(crate) fn widen(&mut self, unit: Unit, residual: f64) {
        let widest = match unit {
            Unit::Length => &mut self.distance,
            Unit::Angle => &mut self.angle,
        };
        *widest = widest.max(residual.abs());
    }

    /// True up to `tolerance::CLOSED` of a length (m), mostly the characteristic length, and in
    /// angle.
    /// ```
    /// use cylindroid::closure::ClosedChain;
    ///
    /// let five_bar = cylindroid::load("five-bar")?;
    /// let at = |q: &[f64]| ClosedChain::of(&five_bar.state(q)?, None, None);
    /// let mut q = five_bar.home().to_vec();
    /// assert!(at(&q)?.closure_error.is_closed(five_bar.reach()));
    /// q[0] += 0.1; // one joint alone opens the loop
    /// assert!(!at(&q)?.closure_error.is_closed(five_bar.reach()));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn is_closed(self, length: f64) -> bool {
        self.distance <= CLOSED * length && self.angle <= CLOSED
    }
}
