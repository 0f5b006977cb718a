//! The loop-closure error: how far the loops and contacts of a configuration are open.
//!
//! Formula  the largest residual, in absolute value, over all constraint rows (`constraint_rows.rs`)
//! Units    m for forces, rad for moments
//! Checked  tests/it/closure/graph.rs::rates_are_derivatives_of_the_gap

use super::velocity_constraint::Unit;
use crate::tolerance::CLOSED;

/// How far loops and contacts are from being closed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LoopClosureError {
    /// Along held directions (m).
    pub distance: f64,
    /// About held directions (rad).
    pub angle: f64,
}

impl LoopClosureError {
    /// Takes in a row of this unit.
    pub(crate) fn widen(&mut self, unit: Unit, residual: f64) {
        let widest = match unit {
            Unit::Length => &mut self.distance,
            Unit::Angle => &mut self.angle,
        };
        *widest = widest.max(residual.abs());
    }

    /// True up to `tolerance::CLOSED` of a length (m), mostly the reach, and in angle.
    #[must_use]
    pub fn is_closed(self, length: f64) -> bool {
        self.distance <= CLOSED * length && self.angle <= CLOSED
    }
}
