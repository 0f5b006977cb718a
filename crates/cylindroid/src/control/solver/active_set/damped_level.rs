//! A level with a damping that depends on the direction.
//!
//! Formula  min |A y - b|^2 + y^T (P(C) + d) y = |[A; B] y - [b; 0]|^2 + d |y|^2, B^T B = P(C), P the
//!          part with positive eigenvalues, or with the absolute values of all: at a saddle A has
//!          nothing that bounds the motion
//! Shapes   A: m x n, b: m, B and C: n x n, C symmetric
//! Why so   one damping for all slows motions that are far from any edge for the sake of others
//! Source   Nocedal & Wright, Numerical Optimization, 2006, sections 3.4 and 10.1; Dauphin et al. 2014 for
//!          absolute values
//! Checked  src/control/solver/hierarchy/tests.rs::curved_levels_*, ::damped_levels_*

use super::Level;
use crate::linalg::{Matrix, Svd};

/// A level and its damping.
#[derive(Debug, Clone)]
pub(in crate::control) struct DampedLevel {
    pub(in crate::control) level: Level,
    /// C; changed by [`DampedLevel::damp`].
    pub(in crate::control) curvature: Matrix,
    eigen: Svd,
    /// d
    pub(super) damping: f64,
    /// True if C counts.
    pub(super) is_curved: bool,
    /// The rows of A, then those of B.
    pub(super) stacked: Level,
}

impl DampedLevel {
    pub(in crate::control) fn new(m: usize, n: usize) -> Self {
        Self {
            level: Level::new(m, n),
            curvature: Matrix::zeros(n, n),
            eigen: Svd::workspace(n, n),
            damping: 0.0,
            is_curved: false,
            stacked: Level::new(m + n, n),
        }
    }

    /// Forgets the last decompositions.
    pub(in crate::control) fn reset(&mut self) {
        self.level.reset();
        self.stacked.reset();
        self.eigen.forget();
    }

    /// Damps all directions alike.
    pub(in crate::control) fn damp_alike(&mut self, damping: f64) {
        (self.damping, self.is_curved) = (damping, false);
    }

    /// Damps directions by their curvature, those of negative curvature as well if `both_signs`, and
    /// all of them by `damping` at least.
    pub(in crate::control) fn damp(&mut self, damping: f64, both_signs: bool) {
        self.damp_alike(damping);
        let (m, n) = (self.level.rows.rows(), self.level.rows.cols());
        // Shifted: then singular values are eigenvalues, and none vanishes, which would have no direction.
        let shift = 2.0 * self.curvature.frobenius_norm();
        if shift == 0.0 {
            return;
        }
        self.is_curved = true;
        for i in 0..n {
            self.curvature[(i, i)] += shift;
        }
        self.eigen.decompose_warm(&self.curvature);
        self.stacked.target[..m].copy_from_slice(&self.level.target);
        for j in 0..n {
            let column = self.stacked.rows.column_mut(j);
            column[..m].copy_from_slice(self.level.rows.column(j));
            for (i, x) in column[m..].iter_mut().enumerate() {
                let value = self.eigen.value(i) - shift;
                let counted = if both_signs { value.abs() } else { value.max(0.0) };
                *x = counted.sqrt() * self.eigen.v(i)[j];
            }
        }
    }
}
