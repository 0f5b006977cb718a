//! The rows of a level, their targets, and the memory to solve it.
//!
//! Shapes   A: m x n, b: m
//! Checked  src/control/solver/hierarchy/tests.rs

use std::ops::Range;

use crate::linalg::{
    Basis, Damped, DampedProblem, Elimination, LowerTriangle, Matrix, RankGap, Svd, dot, norm,
};

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
    /// Of its rows outside those of higher levels.
    pub(super) lower: LowerTriangle,
    /// [A r] on the free motions, then [R Q^T r], and R^T: the solution without a decomposition.
    system: Matrix,
    left: Elimination,
    transposed: Matrix,
    right: Elimination,
    ordered: Vec<f64>,
    /// Columns that are not zero.
    moving: Vec<usize>,
    damped: Damped,
    clamped: Vec<bool>,
}

/// Damping below this share of the square of the rows leaves their products indefinite by rounding
/// [-].
const DEFINITE: f64 = 1e-10;

/// Remainders of columns that are zero [-].
const ZERO: f64 = 1e-12;

/// Singular values below this share of the norm would cost the steps of an elimination their
/// orthogonality to the working rows [-].
const CLEAR: f64 = 1e-7;

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
            lower: LowerTriangle::zeros(m),
            system: Matrix::zeros(m, n + 1),
            left: Elimination::workspace(n),
            transposed: Matrix::zeros(n, m.min(n)),
            right: Elimination::workspace(m.min(n)),
            ordered: vec![0.0; n],
            moving: Vec::with_capacity(n),
            damped: Damped::new(m, n),
            clamped: vec![false; n],
        }
    }

    /// Forgets the last decomposition.
    pub(in crate::control) fn reset(&mut self) {
        self.svd.forget();
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
    pub(super) fn project(&mut self, basis: &Basis, columns: usize) {
        self.project_on(basis, 0..columns);
    }

    /// The same where the columns before these have been projected out, if any.
    pub(super) fn project_on(&mut self, basis: &Basis, columns: Range<usize>) {
        if columns.start == 0 {
            self.projected.as_mut_slice().copy_from_slice(self.rows.as_slice());
        }
        for k in columns {
            self.remove_direction(basis.column(k));
        }
    }

    /// Which remainders of columns count, where singular values of at least `least` do.
    fn gap(&self, least: f64) -> RankGap {
        RankGap { zero: ZERO * self.scale, regular: least }
    }

    /// Eliminates the columns of the projected rows; false if singular values below `least` decide the
    /// rank.
    fn eliminate(&mut self, least: f64) -> bool {
        let gap = self.gap(least);
        let Self { system, left, projected, moving, lower, .. } = self;
        // Working rows of single unknowns leave columns of zeros.
        moving.clear();
        for j in 0..projected.cols() {
            let column = projected.column(j);
            if column.iter().any(|a| *a != 0.0) {
                system.column_mut(moving.len()).copy_from_slice(column);
                moving.push(j);
            }
        }
        let n = moving.len();
        system.column_mut(n).copy_from_slice(&self.residual);
        left.eliminate_beside(system, n, 1, gap) && {
            // Of fewer columns: more of them only increase singular values.
            lower.load_transposed(system, left.rank());
            lower.is_clear(left.rank(), least)
        }
    }

    /// The least x that minimises |projected x - residual| where all singular values are clearly above the
    /// share `rank` of the scale, or zero; false elsewhere.
    pub(super) fn least_squares(&mut self, rank: f64, x: &mut [f64]) -> bool {
        let least = rank.max(CLEAR) * self.scale;
        if !self.eliminate(least) {
            return false;
        }
        let gap = self.gap(least);
        let Self { system, left, transposed, right, ordered, moving, .. } = self;
        let (n, rank) = (moving.len(), left.rank());
        x.fill(0.0);
        if rank == n {
            ordered[..n].copy_from_slice(&system.column(n)[..n]);
            left.solve(system, &mut ordered[..n]);
        } else if rank > 0 {
            transposed.as_mut_slice().fill(0.0);
            for i in 0..rank {
                let column = transposed.column_mut(i)[..n].iter_mut().enumerate();
                column.skip(i).for_each(|(j, t)| *t = system[(i, j)]);
            }
            if !right.eliminate_beside(transposed, rank, 0, gap) || right.rank() < rank {
                return false;
            }
            right.least_solution(transposed, &system.column(n)[..rank], ordered);
        } else {
            return true;
        }
        for (value, &j) in ordered[..n].iter().zip(left.order()) {
            x[moving[j]] = *value;
        }
        true
    }

    /// Takes the part that the projected rows contradict out of residual and target; the square of its
    /// size, or `None` if singular values below `least` decide the rank.
    pub(super) fn remove_contradiction(&mut self, least: f64) -> Option<f64> {
        if !self.eliminate(least) {
            return None;
        }
        let Self { system, left, along, residual, target, moving, .. } = self;
        along.copy_from_slice(system.column(moving.len()));
        along[..left.rank()].fill(0.0);
        left.apply(system, along);
        for ((r, b), part) in residual.iter_mut().zip(target).zip(&*along) {
            *r -= part;
            *b -= part;
        }
        Some(dot(along, along))
    }

    /// Adds the least motion that changes the first m rows, whose basis is loaded from `first` on, by
    /// `along`, which becomes its coordinates.
    pub(super) fn add_least_motion(
        &mut self,
        basis: &Basis,
        first: usize,
        m: usize,
        x: &mut [f64],
    ) {
        self.lower.solve(&mut self.along[..m]);
        for (k, z) in self.along[..m].iter().enumerate() {
            x.iter_mut().zip(basis.column(first + k)).for_each(|(x, q)| *x += z * q);
        }
    }

    /// The x that minimises |projected x - residual|^2 + damping |x|^2.
    pub(super) fn damped_least_squares(&mut self, damping: f64, x: &mut [f64]) {
        let Self { projected, residual, damped, clamped, svd, gains, .. } = self;
        let problem = DampedProblem { a: projected.as_slice(), e: residual, clamped, damping };
        if damping > DEFINITE * projected.frobenius_norm().powi(2)
            && damped.solve_refined(problem, x)
        {
            return;
        }
        svd.decompose_warm(projected);
        for (gain, s) in gains.iter_mut().zip(svd.values()) {
            *gain = s / (s * s + damping);
        }
        svd.apply_gains_into(residual, gains, x);
    }

    /// The inverse singular values of the projected rows, zero below the share `least` of the scale;
    /// returns the rank.
    pub(super) fn load_gains(&mut self, least: f64) -> usize {
        self.svd.decompose_warm(&self.projected);
        let mut rank = 0;
        for (gain, s) in self.gains.iter_mut().zip(self.svd.values()) {
            let is_kept = s > least * self.scale;
            *gain = if is_kept { 1.0 / s } else { 0.0 };
            rank += usize::from(is_kept);
        }
        rank
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
