//! The farthest point of an image of a box cut by a plane: a small linear program.
//!
//! Formula  max c^T z  over  |A z| <= b
//! Shapes   A: n x m of rank m <= n, b: n entries > 0, c: m entries
//! Units    any
//! Method   from z = 0 go along what the active rows leave of c until the next row stops it; where
//!          nothing is left, let go a row whose multiplier has the wrong sign; at the optimum go
//!          on along a second direction, so that the result is a corner. For n = m the corner is
//!          known at once: the signs of A^-T c.
//! Valid    as above. Rows of nearly the same direction are taken as they come; a bound on the
//!          steps makes the cost finite, and any point returned is within the bounds.
//! Why so   at most 14 x 14 here, and z = 0 is inside: an active set of 100 lines needs no solver
//! Source   Nocedal & Wright, Numerical Optimization, 2nd ed., section 16.5, without curvature
//! Checked  tests/it/hull.rs::box_program_*

use super::matrix::Matrix;
use super::qr::{Qr, solve_upper};
use crate::tolerance::BOX_PROGRAM;

/// `|A z| <= b`.
#[derive(Debug, Clone)]
pub struct BoxProgram {
    /// A^T with rows divided by b: column i is the normal of the pair of bounds `|a_i z| <= 1`.
    normals: Matrix,
    /// Columns of (A / b)^-1, when A is square.
    inverse: Option<Matrix>,
}

impl BoxProgram {
    /// Of A (n x m, rank m) and positive bounds b.
    ///
    /// # Panics
    /// If there is not a bound for each row.
    #[must_use]
    pub fn new(a: &Matrix, bounds: &[f64]) -> Self {
        assert_eq!(a.rows(), bounds.len(), "a bound for each row");
        let normals = Matrix::from_fn(a.cols(), a.rows(), |j, i| a[(i, j)] / bounds[i]);
        let inverse = (a.rows() == a.cols()).then(|| inverse(&normals.transpose()));
        Self { normals, inverse }
    }

    /// A corner of largest `c . z`, and among these of largest `second . z`.
    #[must_use]
    pub fn farthest(&self, c: &[f64], second: &[f64]) -> Vec<f64> {
        match &self.inverse {
            Some(inverse) => {
                let n = inverse.cols();
                let mut signs = vec![0.0; n];
                let size = norm(c);
                for (j, sign) in signs.iter_mut().enumerate() {
                    let column = inverse.column(j);
                    let first = dot(column, c);
                    let tie = first.abs() <= BOX_PROGRAM * size * norm(column);
                    *sign = if tie { dot(column, second) } else { first };
                    *sign = if *sign < 0.0 { -1.0 } else { 1.0 };
                }
                inverse.mul_vec(&signs)
            }
            None => self.active_set(c, second),
        }
    }

    fn active_set(&self, c: &[f64], second: &[f64]) -> Vec<f64> {
        let (m, n) = (self.normals.rows(), self.normals.cols());
        let mut z = vec![0.0; m];
        let mut active: Vec<(usize, f64)> = Vec::new();
        let mut tie_break = false;
        for _ in 0..8 * (n + m) {
            let columns = Matrix::from_fn(m, active.len(), |i, j| {
                self.normals[(i, active[j].0)] * active[j].1
            });
            let qr = Qr::plain(columns);
            let goal = if tie_break { second } else { c };
            let mut parts = goal.to_vec();
            qr.apply_transposed(&mut parts);
            let rank = active.len();
            let left = norm(&parts[rank..]);
            if rank < m && left > BOX_PROGRAM * norm(goal) {
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
                Some(i) if multipliers[i] < -BOX_PROGRAM * norm(&multipliers) => {
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
            if rate.abs() <= BOX_PROGRAM * size * norm(normal) {
                continue;
            }
            let step = ((1.0 - now * rate.signum()) / rate.abs()).max(0.0);
            if first.is_none_or(|f| step < f.0) {
                first = Some((step, i, rate.signum()));
            }
        }
        first
    }
}

/// The inverse of a regular square matrix.
fn inverse(a: &Matrix) -> Matrix {
    let n = a.rows();
    let qr = Qr::plain(a.clone());
    let r = qr.r();
    let mut inverse = Matrix::zeros(n, n);
    for j in 0..n {
        let mut e = vec![0.0; n];
        e[j] = 1.0;
        qr.apply_transposed(&mut e);
        inverse.column_mut(j).copy_from_slice(&solve_upper(&r, &e));
    }
    inverse
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}
