//! A level that no inequality stops: one orthogonalisation of its rows, without a decomposition.
//!
//! Formula  A = C Q_0^T + L Q^T, Q_0 the basis of higher levels, L lower triangular;
//!          y + Q L^-1 (b - A y) performs the level, and Q continues the basis
//! Valid    rows whose least singular value outside Q_0 is above a bound, for which 1 / |L^-1|_F is a
//!          lower bound; no working rows; a solution within all inequalities. Otherwise nothing changes
//! Cost     of the order of m (k + m) n for m rows after k
//! Source   Golub & Van Loan, Matrix Computations, 2013, 5.2.8 (modified Gram-Schmidt, twice)
//! Checked  src/control/solver/hierarchy/tests.rs::free_levels_are_those_of_the_active_set

use super::{ActiveSet, Level};
use crate::linalg::{dot, norm};

/// A row that keeps less than this share of its norm is orthogonalised again [-].
const AGAIN: f64 = 0.5;

impl ActiveSet {
    /// Performs a level as a whole if no inequality stops it and all its directions have singular
    /// values above `eps` of the norm of its rows; false, without effect, otherwise.
    pub(in crate::control) fn solve_freely(&mut self, level: &mut Level, eps: f64) -> bool {
        let (m, n) = (level.rows.rows(), self.y.len());
        if !self.working.is_empty() || self.fixed + m > n {
            return false;
        }
        level.scale = level.rows.frobenius_norm();
        if !self.orthogonalise(level) {
            return false;
        }
        level.load_residual(&self.y);
        // z = L^-1 (b - A y), and |L^-1|_F column by column.
        let mut size = 0.0;
        for k in 0..m {
            level.along.fill(0.0);
            level.along[k] = 1.0;
            solve_lower(level, k);
            size += dot(&level.along, &level.along);
        }
        let least = eps * level.scale;
        // NaN as well.
        if !(size * least * least < 1.0) {
            return false;
        }
        level.along.copy_from_slice(&level.residual);
        solve_lower(level, 0);
        self.direction.copy_from_slice(&self.y);
        for (k, z) in level.along.iter().enumerate() {
            let column = self.basis.column(self.fixed + k);
            self.direction.iter_mut().zip(column).for_each(|(d, q)| *d += z * q);
        }
        let rows = 0..self.inequalities.len();
        let within = |i| {
            let value = self.inequalities.value(i, &self.direction);
            value >= self.inequalities.lower[i] && value <= self.inequalities.upper[i]
        };
        if !rows.into_iter().all(within) {
            return false;
        }
        self.y.copy_from_slice(&self.direction);
        self.fixed += m;
        true
    }

    /// Continues the basis by the rows of the level, with L in the first columns of `projected`; false
    /// if a row depends on others.
    fn orthogonalise(&mut self, level: &mut Level) -> bool {
        for i in 0..level.rows.rows() {
            for (j, x) in self.normal.iter_mut().enumerate() {
                *x = level.rows[(i, j)];
            }
            let whole = norm(&self.normal);
            (0..i).for_each(|k| level.projected[(i, k)] = 0.0);
            let mut before = whole;
            for _ in 0..2 {
                for k in 0..self.fixed + i {
                    let column = self.basis.column(k);
                    let along = dot(column, &self.normal);
                    self.normal.iter_mut().zip(column).for_each(|(x, q)| *x -= along * q);
                    if k >= self.fixed {
                        level.projected[(i, k - self.fixed)] += along;
                    }
                }
                let after = norm(&self.normal);
                let is_done = after > AGAIN * before;
                before = after;
                if is_done {
                    break;
                }
            }
            if !(before > super::DEPENDENT * whole) {
                return false;
            }
            level.projected[(i, i)] = before;
            let column = self.basis.column_mut(self.fixed + i);
            column.iter_mut().zip(&self.normal).for_each(|(q, x)| *q = x / before);
        }
        true
    }
}

/// Solves `L z = along` in place; the entries before `first` are zero.
fn solve_lower(level: &mut Level, first: usize) {
    let (l, z) = (&level.projected, &mut level.along);
    for i in first..z.len() {
        let done: f64 = (first..i).map(|k| l[(i, k)] * z[k]).sum();
        z[i] = (z[i] - done) / l[(i, i)];
    }
}
