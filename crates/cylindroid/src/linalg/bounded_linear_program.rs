//! A linear program with bounds on linear functions: the support point of a box cut by a subspace.
//!
//! Formula  max c^T z  subject to  lower <= A z <= upper, with lower <= 0 <= upper
//! Shapes   A: n x m of rank m <= n, bounds: n entries, c: m entries
//! Units    any
//! Method   active set. From z = 0, move along the projection of c on the kernel of the active rows
//!          until the next row becomes active; where the projection vanishes, release a row whose
//!          multiplier has the wrong sign; at the optimum continue along a second objective, so
//!          that the result is a vertex. For n = m the vertex is known at once: the signs of A^-T
//!          c.
//! Valid    as above. Nearly parallel rows are taken in order; a bound on the number of steps makes
//!          the cost finite, and any point returned is within the bounds.
//! Why so   at most 14 x 14 here, and z = 0 is feasible: an active set of 100 lines needs no solver
//! Source   Nocedal & Wright, Numerical Optimization, 2nd ed., section 16.5, without curvature
//! Checked  src/linalg/bounded_linear_program/tests.rs

use super::matrix::Matrix;
use super::qr::{Qr, solve_upper};
use super::vector::{dot, norm};
use crate::tolerance::LINEAR_PROGRAM;

/// Bounds of a row: from `lower` to `upper`, which contain zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Lower bound, at most zero.
    pub lower: f64,
    /// Upper bound, at least zero.
    pub upper: f64,
}

impl Interval {
    /// From `-most` to `most`.
    #[must_use]
    pub fn symmetric(most: f64) -> Self {
        Self { lower: -most, upper: most }
    }

    /// True for finite bounds with zero between them, or at one of them, and a positive length.
    #[must_use]
    pub fn is_around_zero(&self) -> bool {
        let finite = self.lower.is_finite() && self.upper.is_finite();
        finite && self.lower <= 0.0 && self.upper >= 0.0 && self.lower < self.upper
    }

    /// The larger of both bounds.
    pub(crate) fn size(&self) -> f64 {
        self.upper.max(-self.lower)
    }
}

/// A linear program with the constraints `lower <= A z <= upper`.
#[derive(Debug, Clone)]
pub(crate) struct BoundedLinearProgram {
    /// A^T with columns divided by the larger bound of each.
    normals: Matrix,
    /// Bounds divided by the same.
    bounds: Vec<Interval>,
    /// Columns of the inverse of the scaled A, when it is square.
    inverse: Option<Matrix>,
}

/// The objective of a linear program, with a second one for ties.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Objective<'a> {
    /// c.
    pub(crate) first: &'a [f64],
    /// Second objective, for vertices with equal `first`.
    pub(crate) second: &'a [f64],
}

impl BoundedLinearProgram {
    /// The program of A (n x m, rank m) with bounds that contain zero.
    ///
    /// # Panics
    /// If the number of bounds is not that of the rows.
    #[must_use]
    pub(crate) fn new(a: &Matrix, bounds: &[Interval]) -> Self {
        assert_eq!(a.rows(), bounds.len(), "a bound for each row");
        let normals = Matrix::from_fn(a.cols(), a.rows(), |j, i| a[(i, j)] / bounds[i].size());
        let inverse = (a.rows() == a.cols())
            .then(|| Qr::plain(normals.transpose()).solve(Matrix::identity(a.rows())));
        let scaled =
            |b: &Interval| Interval { lower: b.lower / b.size(), upper: b.upper / b.size() };
        Self { normals, bounds: bounds.iter().map(scaled).collect(), inverse }
    }

    /// A vertex of largest `first . z`, and among these of largest `second . z`.
    #[must_use]
    pub(crate) fn maximize(&self, objective: Objective<'_>) -> Vec<f64> {
        match &self.inverse {
            Some(inverse) => {
                let n = inverse.cols();
                let mut corner = vec![0.0; n];
                let size = norm(objective.first);
                for (j, value) in corner.iter_mut().enumerate() {
                    let column = inverse.column(j);
                    let first = dot(column, objective.first);
                    let tie = first.abs() <= LINEAR_PROGRAM * size * norm(column);
                    let pulled = if tie { dot(column, objective.second) } else { first };
                    let Interval { lower, upper } = self.bounds[j];
                    *value = if pulled < 0.0 { lower } else { upper };
                }
                inverse.mul_vec(&corner)
            }
            None => self.active_set(objective),
        }
    }

    fn active_set(&self, objective: Objective<'_>) -> Vec<f64> {
        let (m, n) = (self.normals.rows(), self.normals.cols());
        let mut z = vec![0.0; m];
        let mut active: Vec<(usize, f64)> = Vec::new();
        let mut tie_break = false;
        for _ in 0..8 * (n + m) {
            let columns = Matrix::from_fn(m, active.len(), |i, j| {
                self.normals[(i, active[j].0)] * active[j].1
            });
            let qr = Qr::plain(columns);
            let goal = if tie_break { objective.second } else { objective.first };
            let mut parts = goal.to_vec();
            qr.apply_transposed(&mut parts);
            let rank = active.len();
            let left = norm(&parts[rank..]);
            if rank < m && left > LINEAR_PROGRAM * norm(goal) {
                parts[..rank].fill(0.0);
                qr.apply(&mut parts);
                let Some((step, row, sign)) = self.next_row(&z, &parts, &active) else { break };
                z.iter_mut().zip(&parts).for_each(|(z, d)| *z += step * d);
                active.push((row, sign));
                continue;
            }
            if tie_break {
                break;
            }
            // c = sum of multipliers times active normals.
            let multipliers = solve_upper(&qr.r(), &parts[..rank]);
            let worst = (0..rank).min_by(|&i, &j| multipliers[i].total_cmp(&multipliers[j]));
            match worst {
                Some(i) if multipliers[i] < -LINEAR_PROGRAM * norm(&multipliers) => {
                    active.remove(i);
                }
                _ => tie_break = true,
            }
        }
        z
    }

    /// The first bound met on the way along `d`: step, row and its sign.
    fn next_row(&self, z: &[f64], d: &[f64], active: &[(usize, f64)]) -> Option<(f64, usize, f64)> {
        let mut first: Option<(f64, usize, f64)> = None;
        let size = norm(d);
        for i in (0..self.normals.cols()).filter(|i| active.iter().all(|a| a.0 != *i)) {
            let normal = self.normals.column(i);
            let (now, rate) = (dot(normal, z), dot(normal, d));
            if rate.abs() <= LINEAR_PROGRAM * size * norm(normal) {
                continue;
            }
            let Interval { lower, upper } = self.bounds[i];
            let bound = if rate > 0.0 { upper } else { lower };
            let step = ((bound - now) / rate).max(0.0);
            if first.is_none_or(|f| step < f.0) {
                first = Some((step, i, rate.signum()));
            }
        }
        first
    }
}

#[cfg(test)]
mod tests;
