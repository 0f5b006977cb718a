//! Hierarchical least squares within inequalities: level after level, scaled along its direction
//! before the direction is changed.
//!
//! Formula  y_k = argmin |A_k y - b_k| over the minima of the levels before, l <= G y <= u for all.
//!          Scaled: of all y with A_k y parallel to b_k the one with the largest scale s <= 1,
//!          A_k y = s b_k; as two levels, (1 - p p^T) A_k y = 0 and p^T A_k y = |b_k|, p = b_k / |b_k|
//! Shapes   A_k: m_k x n
//! Valid    any rank; a direction that cannot be kept exactly is reported
//! Source   Escande, Mansard & Wieber 2014; Flacco, De Luca & Khatib 2015 (scaling)
//! Checked  src/control/solver/hierarchy/tests.rs

use super::active_set::{ActiveSet, Level, Objective, Precision};
use crate::linalg::{dot, norm};

/// A level whose direction is preserved first.
#[derive(Debug, Clone)]
pub(in crate::control) struct ScaledLevel {
    /// Rows and target of the whole level.
    pub(in crate::control) whole: Level,
    /// The rows across the target, and the row along it.
    across: Level,
    along: Level,
}

/// The share of a level that the inequalities permit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::control) struct Share {
    /// s
    pub(in crate::control) scale: f64,
    /// True if the level points along its target.
    pub(in crate::control) is_straight: bool,
    /// True if one of the inequalities that were asked for stops it.
    pub(in crate::control) is_stopped: bool,
}

/// Parts across the target below this share of it are roundings [-].
const ACROSS: f64 = 1e-9;

impl ScaledLevel {
    pub(in crate::control) fn new(m: usize, n: usize) -> Self {
        Self { whole: Level::new(m, n), across: Level::new(m, n), along: Level::new(1, n) }
    }

    /// Splits the level; returns the size of the target.
    fn split(&mut self) -> f64 {
        let Self { whole, across, along } = self;
        let size = norm(&whole.target);
        whole.scale = whole.rows.frobenius_norm();
        (across.scale, along.scale) = (whole.scale, whole.scale);
        if size == 0.0 {
            return size;
        }
        for j in 0..whole.rows.cols() {
            let column = whole.rows.column(j);
            let share = dot(column, &whole.target) / size;
            along.rows[(0, j)] = share;
            let parts = across.rows.column_mut(j).iter_mut().zip(column).zip(&whole.target);
            parts.for_each(|((x, a), b)| *x = a - share * (b / size));
        }
        across.target.fill(0.0);
        along.target[0] = size;
        size
    }
}

impl ActiveSet {
    /// The least-squares solution of a level within what the levels before leave.
    pub(in crate::control) fn solve(&mut self, level: &mut Level, precision: Precision) {
        level.scale = level.rows.frobenius_norm();
        self.minimise(Objective::Rows(level), precision);
        self.keep(level, precision);
    }

    /// The point nearest to `desired` within what the levels before leave.
    pub(in crate::control) fn approach(&mut self, desired: &[f64], precision: Precision) {
        self.minimise(Objective::Nearest(desired), precision);
    }

    /// The largest share of a level along its direction; `stops` are the inequalities (row and sign
    /// of the bound) to report.
    pub(in crate::control) fn solve_scaled(
        &mut self,
        level: &mut ScaledLevel,
        precision: Precision,
        mut stops: impl FnMut(usize, f64) -> bool,
    ) -> Share {
        let size = level.split();
        if size == 0.0 {
            self.solve(&mut level.whole, precision);
            return Share { scale: 1.0, is_straight: true, is_stopped: false };
        }
        self.minimise(Objective::Rows(&mut level.across), precision);
        self.keep(&mut level.across, precision);
        let cut = precision.rank * level.whole.scale * norm(self.point());
        let is_straight = level.across.residual(self.point()) <= ACROSS * size + cut;
        self.minimise(Objective::Rows(&mut level.along), precision);
        let is_stopped = self.stopping().any(|(row, sign)| stops(row, sign));
        self.keep(&mut level.along, precision);
        let scale = dot_row(&level.along, self.point()) / size;
        Share { scale, is_straight, is_stopped }
    }
}

/// `A y` of a level with one row.
fn dot_row(level: &Level, y: &[f64]) -> f64 {
    dot(level.rows.as_slice(), y)
}

#[cfg(test)]
mod tests;
