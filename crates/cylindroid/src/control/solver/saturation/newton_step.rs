//! A step of Newton's method for least squares, with the positive part of the curvature.
//!
//! Formula  (J^T J + P(C) + d) y = J^T b: [J; B] y = [b; 0] by Householder reflections,
//!          B^T B = P(C) + d, P the part with positive eigenvalues
//! Shapes   J: m x n, C: n x n symmetric, b: m, two of them
//! Valid    any J and C; without the negative part every step descends
//! Source   Nocedal & Wright, Numerical Optimization, 2006, sections 3.4 and 10.1
//! Checked  tests/it/servo/edge.rs

use super::problem::LEAST_DAMPING;
use crate::linalg::{Elimination, Matrix, RankGap, Svd};

/// Workspace.
#[derive(Debug, Clone)]
pub(in crate::control) struct NewtonStep {
    /// C; changed by [`NewtonStep::decompose`].
    pub(in crate::control) curvature: Matrix,
    eigen: Svd,
    /// [J; B] beside [b; 0] of each right side; then triangular.
    stacked: Matrix,
    elimination: Elimination,
    ordered: Vec<f64>,
}

impl NewtonStep {
    pub(in crate::control) fn new(m: usize, n: usize) -> Self {
        Self {
            curvature: Matrix::zeros(n, n),
            eigen: Svd::workspace(n, n),
            stacked: Matrix::zeros(m + n, n + 2),
            elimination: Elimination::workspace(n),
            ordered: vec![0.0; n],
        }
    }

    /// Decomposes the problem of the curvature for these right sides, two at most.
    pub(in crate::control) fn decompose(&mut self, j: &Matrix, right_sides: &[&[f64]]) {
        let (m, n) = (j.rows(), j.cols());
        // Shifted: then singular values are eigenvalues.
        let shift = self.curvature.frobenius_norm();
        for i in 0..n {
            self.curvature[(i, i)] += shift;
        }
        self.eigen.decompose_warm(&self.curvature);
        self.stacked.as_mut_slice().fill(0.0);
        for i in 0..n {
            let root = ((self.eigen.value(i) - shift).max(0.0) + LEAST_DAMPING).sqrt();
            for (j, v) in self.eigen.v(i).iter().enumerate() {
                self.stacked[(m + i, j)] = root * v;
            }
        }
        for i in 0..n {
            self.stacked.column_mut(i)[..m].copy_from_slice(j.column(i));
        }
        for (i, b) in right_sides.iter().enumerate() {
            self.stacked.column_mut(n + i)[..m].copy_from_slice(b);
        }
        // Regular: C has at least the least damping.
        self.elimination.eliminate(&mut self.stacked, n, RankGap { zero: 0.0, regular: 0.0 });
    }

    /// Writes the solution of a right side.
    pub(in crate::control) fn solution_into(&mut self, right_side: usize, solution: &mut [f64]) {
        let n = solution.len();
        self.ordered.copy_from_slice(&self.stacked.column(n + right_side)[..n]);
        self.elimination.solve(&self.stacked, &mut self.ordered);
        for (x, &j) in self.ordered.iter().zip(self.elimination.order()) {
            solution[j] = *x;
        }
    }

    /// Writes the triangular rows, n x n, with the unknowns in their order.
    pub(in crate::control) fn rows_into(&self, rows: &mut Matrix) {
        for (k, &j) in self.elimination.order().iter().enumerate() {
            let column = rows.column_mut(j);
            column.fill(0.0);
            column[..=k].copy_from_slice(&self.stacked.column(k)[..=k]);
        }
    }

    /// The right side of these rows.
    pub(in crate::control) fn right_side(&self, right_side: usize) -> &[f64] {
        let n = self.ordered.len();
        &self.stacked.column(n + right_side)[..n]
    }
}
