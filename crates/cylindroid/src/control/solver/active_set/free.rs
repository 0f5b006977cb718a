//! A level that is performed as a whole: one orthogonalisation of its rows, without a decomposition.
//!
//! Formula  A = C Q_0^T + L Q^T, Q_0 the basis of higher levels, L lower triangular (`Basis`);
//!          y + Q L^-1 (b - A y) performs the level, and Q continues the basis; working rows stay at
//!          their bounds and rows that are left are taken to theirs, one by one, by motions outside Q
//! Valid    rows whose least singular value outside Q_0 is above a bound (`LowerTriangle::is_clear`);
//!          a solution within all inequalities. Otherwise nothing changes
//! Why so   any point within all inequalities that performs the level is optimal for it, whichever
//!          rows are at their bounds: lower levels release those that need not be
//! Cost     of the order of m (k + m) n for m rows after k
//! Checked  src/control/solver/hierarchy/tests.rs::free_levels_are_those_of_the_active_set

use super::{ActiveSet, DEPENDENT, Level, Use, Working};
use crate::error::all_finite;

/// Singular values below this share of the norm of the rows would cost the basis its orthogonality
/// [-].
const CLEAR: f64 = 1e-4;

/// How a level ended that was to be performed as a whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::control) enum Whole {
    Performed,
    /// An inequality stops it; all its directions can be moved.
    Stopped,
    /// The singular values decide which of its directions can be moved.
    Unclear,
}

impl ActiveSet {
    /// Performs a level as a whole if no inequality stops it and all its directions have singular
    /// values above `eps` of the norm of its rows; without effect otherwise.
    pub(in crate::control) fn solve_freely(&mut self, level: &mut Level, eps: f64) -> Whole {
        level.scale = level.rows.frobenius_norm();
        self.perform(level, level.rows.rows(), eps)
    }

    /// Performs the first m rows of a level, which has a scale.
    pub(in crate::control::solver) fn perform(
        &mut self,
        level: &mut Level,
        m: usize,
        eps: f64,
    ) -> Whole {
        let is_clear = self.load_rows(level, self.fixed, m, eps);
        let before = self.working.len();
        if is_clear && self.move_freely(level, m) {
            return Whole::Performed;
        }
        self.working.drain(before..).for_each(|w| self.uses[w.row] = Use::Free);
        self.rebuild(0);
        if is_clear { Whole::Stopped } else { Whole::Unclear }
    }

    /// True if all directions of a level have singular values above `eps` of the norm of its rows.
    pub(in crate::control) fn is_clear(&mut self, level: &mut Level, eps: f64) -> bool {
        level.scale = level.rows.frobenius_norm();
        let is_clear = self.load_rows(level, self.fixed, level.rows.rows(), eps);
        self.rebuild(0);
        is_clear
    }

    /// Makes the first m rows columns of the basis from `first` on, orthonormal outside those before;
    /// false if singular values below `eps` of the norm of the rows decide which directions count.
    pub(super) fn load_rows(
        &mut self,
        level: &mut Level,
        first: usize,
        m: usize,
        eps: f64,
    ) -> bool {
        if first + m > self.y.len() {
            return false;
        }
        for i in 0..m {
            let column = self.basis.column_mut(first + i).iter_mut();
            column.enumerate().for_each(|(j, x)| *x = level.rows[(i, j)]);
        }
        let least = eps.max(CLEAR) * level.scale;
        self.basis.orthonormalise(first, m, DEPENDENT, &mut level.lower)
            && level.lower.is_clear(m, least)
    }

    /// Moves to a point within all inequalities that performs the rows, whose basis is loaded, and
    /// keeps them; false, with further working rows, if none is found.
    fn move_freely(&mut self, level: &mut Level, m: usize) -> bool {
        level.load_residual(&self.y);
        level.along.copy_from_slice(&level.residual);
        self.candidate.copy_from_slice(&self.y);
        level.add_least_motion(&self.basis, self.fixed, m, &mut self.candidate);
        self.fixed += m;
        let is_held = (0..self.working.len()).all(|k| {
            let Working { row, sign } = self.working[k];
            self.inequalities.write(row, sign, &mut self.normal);
            self.multipliers[k] = 0.0;
            self.append(self.fixed + k, Some(k)) && {
                self.advance_to_bound(k);
                true
            }
        });
        if !(is_held && self.add_bounds()) {
            self.fixed -= m;
            return false;
        }
        let boxed = self.inequalities.boxed();
        for (i, (y, x)) in self.y.iter_mut().zip(&self.candidate).enumerate() {
            // Single unknowns keep their bounds to the last bit.
            if i >= boxed || self.uses[i] != Use::Fixed {
                *y = *x;
            }
        }
        for w in self.working.iter().filter(|w| w.row < boxed) {
            self.y[w.row] = self.inequalities.bound(w.row, w.sign);
        }
        true
    }

    /// Adds the rows that the candidate leaves, the worst first, and takes it to their bounds;
    /// false if one of them depends on the others.
    fn add_bounds(&mut self) -> bool {
        loop {
            let mut worst = (0.0, None);
            for i in 0..self.inequalities.len() {
                if matches!(self.uses[i], Use::Working | Use::Fixed) {
                    continue;
                }
                let value = self.inequalities.value(i, &self.candidate);
                let (excess, sign) = self.inequalities.excess(i, value);
                let share = excess / self.inequalities.length(i).max(f64::MIN_POSITIVE);
                if share > worst.0 {
                    worst = (share, Some((i, sign)));
                }
            }
            let Some((row, sign)) = worst.1 else {
                return all_finite(&self.candidate);
            };
            if !self.add(row, sign) {
                return false;
            }
            self.advance_to_bound(self.working.len() - 1);
        }
    }

    /// Takes the candidate to the bound of the k-th working row, along its own direction in
    /// the basis: the rows before stay.
    fn advance_to_bound(&mut self, k: usize) {
        let Working { row, sign } = self.working[k];
        let excess =
            self.inequalities.value(row, &self.candidate) - self.inequalities.bound(row, sign);
        let way = -sign * excess / self.triangle[(k, k)];
        let column = self.basis.column(self.fixed + k);
        self.candidate.iter_mut().zip(column).for_each(|(x, q)| *x += way * q);
    }
}
