//! A level with a damping that depends on the direction.
//!
//! Formula  min |A y - b|^2 + y^T (P(C) + d) y = |[A; B] y - [b; 0]|^2 + d |y|^2, B^T B = P(C), P the
//!          part with positive eigenvalues, or with the absolute values of all: at a saddle A has
//!          nothing that bounds the motion
//! Shapes   A: m x n, b: m, B and C: n x n, C symmetric
//! Why so   one damping for all slows motions that are far from any edge for the sake of others
//! Source   Nocedal & Wright, Numerical Optimization, 2006, sections 3.4 and 10.1; Dauphin et al. 2014 for
//!          absolute values
//! Checked  tests in this file, src/control/solver/hierarchy/tests.rs::curved_levels_*, ::damped_levels_*

use super::Level;
use crate::linalg::{Matrix, Svd};

/// A level and its damping.
#[derive(Debug, Clone)]
pub(in crate::control) struct DampedLevel {
    pub(in crate::control) level: Level,
    /// C
    pub(in crate::control) curvature: Matrix,
    /// The columns of C that are not zero, C without the others, and its decomposition.
    bent: Vec<usize>,
    block: Matrix,
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
            bent: Vec::with_capacity(n),
            block: Matrix::zeros(n, n),
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
        // Tasks far from any edge bend nothing.
        let Self { level, curvature, bent, block, eigen, stacked, .. } = self;
        bent.clear();
        bent.extend((0..n).filter(|&j| curvature.column(j).iter().any(|x| *x != 0.0)));
        block.reshape(bent.len(), bent.len());
        for (b, &j) in bent.iter().enumerate() {
            for (x, &i) in block.column_mut(b).iter_mut().zip(&*bent) {
                *x = curvature[(i, j)];
            }
            block[(b, b)] += shift;
        }
        eigen.reshape(bent.len(), bent.len());
        eigen.decompose_warm(block);
        stacked.target[..m].copy_from_slice(&level.target);
        for j in 0..n {
            let column = stacked.rows.column_mut(j);
            column[..m].copy_from_slice(level.rows.column(j));
            column[m..].fill(0.0);
        }
        for (b, &j) in bent.iter().enumerate() {
            let column = &mut stacked.rows.column_mut(j)[m..];
            for (i, x) in column[..bent.len()].iter_mut().enumerate() {
                let value = eigen.value(i) - shift;
                let counted = if both_signs { value.abs() } else { value.max(0.0) };
                *x = counted.sqrt() * eigen.v(i)[b];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::uniform;

    /// B^T B = P(C) where C has columns of zeros, others in every call.
    #[test]
    fn curvatures_of_some_columns_are_those_of_all() {
        let (n, mut random) = (6, 7);
        let mut level = DampedLevel::new(2, n);
        for round in 0..60_usize {
            let bent: Vec<usize> = (0..n).filter(|j| (round >> (j % 6)) & 1 == 0).collect();
            let mut c = Matrix::zeros(n, n);
            for &i in &bent {
                for &j in bent.iter().filter(|j| **j <= i) {
                    c[(i, j)] = uniform(&mut random) - 0.5;
                    c[(j, i)] = c[(i, j)];
                }
            }
            level.curvature = c.clone();
            level.damp(1e-6, false);
            let b = Matrix::from_fn(n, n, |i, j| level.stacked.rows[(2 + i, j)]);
            let positive = &b.transpose() * &b;
            level.damp(1e-6, true);
            assert_eq!(level.is_curved, !bent.is_empty());
            if !level.is_curved {
                continue;
            }
            // |C| = root of C C, as B^T B.
            let b = Matrix::from_fn(n, n, |i, j| level.stacked.rows[(2 + i, j)]);
            let absolute = &b.transpose() * &b;
            let (found, expected) = (&absolute * &absolute, &c * &c);
            for (x, e) in found.as_slice().iter().zip(expected.as_slice()) {
                assert!((x - e).abs() < 1e-12, "{bent:?}: {x} {e}");
            }
            // P(C) = (C + |C|) / 2
            let parts = positive.as_slice().iter().zip(c.as_slice()).zip(absolute.as_slice());
            for ((p, c), a) in parts {
                assert!((p - 0.5 * (c + a)).abs() < 1e-12, "{bent:?}: {p} {c} {a}");
            }
        }
    }
}
