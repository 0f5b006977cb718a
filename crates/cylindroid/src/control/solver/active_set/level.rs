//! The rows of a level, their targets, and the memory to solve it.
//!
//! Shapes   A: m x n, b: m
//! Checked  src/control/solver/hierarchy/tests.rs

use crate::linalg::{Matrix, Svd, norm};

/// The rows of a level, their targets and the memory to solve it.
#[derive(Debug, Clone)]
pub(in crate::control) struct Level {
    /// A, m x n.
    pub(in crate::control) rows: Matrix,
    /// b
    pub(in crate::control) target: Vec<f64>,
    /// Norm of the rows, or of those that they are a part of: what is small beside it is rounding.
    pub(in crate::control::solver) scale: f64,
    /// A on the free motions.
    pub(super) projected: Matrix,
    pub(super) svd: Svd,
    pub(super) residual: Vec<f64>,
    /// Of the rows along a direction.
    pub(super) along: Vec<f64>,
    pub(super) gains: Vec<f64>,
}

impl Level {
    pub(in crate::control) fn new(m: usize, n: usize) -> Self {
        Self {
            rows: Matrix::zeros(m, n),
            target: vec![0.0; m],
            scale: 0.0,
            projected: Matrix::zeros(m, n),
            svd: Svd::workspace(m, n),
            residual: vec![0.0; m],
            along: vec![0.0; m],
            gains: vec![0.0; m.min(n)],
        }
    }

    /// `residual = b - A y`
    pub(super) fn load_residual(&mut self, y: &[f64]) {
        self.residual.copy_from_slice(&self.target);
        for (j, y) in y.iter().enumerate() {
            for (r, a) in self.residual.iter_mut().zip(self.rows.column(j)) {
                *r -= a * y;
            }
        }
    }

    /// b - A y
    pub(in crate::control) fn left(&mut self, y: &[f64]) -> &[f64] {
        self.load_residual(y);
        &self.residual
    }

    /// |A y - b|
    pub(in crate::control) fn residual(&mut self, y: &[f64]) -> f64 {
        norm(self.left(y))
    }

    /// `projected = A (1 - Q Q^T)` with the first columns of Q.
    pub(super) fn project(&mut self, basis: &Matrix, columns: usize) {
        self.projected.as_mut_slice().copy_from_slice(self.rows.as_slice());
        for k in 0..columns {
            self.remove_direction(basis.column(k));
        }
    }

    /// `projected (1 - v v^T)`
    pub(super) fn remove_direction(&mut self, v: &[f64]) {
        self.projected.mul_vec_into(v, &mut self.along);
        for (j, v) in v.iter().enumerate() {
            if *v != 0.0 {
                for (p, r) in self.projected.column_mut(j).iter_mut().zip(&self.along) {
                    *p -= r * v;
                }
            }
        }
    }
}
