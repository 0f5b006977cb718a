//! The passive joints of loops that share joints, as functions of the actuated ones.
//!
//! Formula  C_p s_p + C_a s_a = -r (rows of loops and contacts, r their residuals). C_p P = Q [R; 0]
//!          by Householder reflections, Q^T [C_a r] = [B r_1; S r_2]: S s_a = -r_2 restricts the
//!          actuated joints, s_p = -R^+ (B s_a + r_1) follows. Motions, r = 0: W^(1/2) s_a = D y, D
//!          an orthonormal basis of ker S W^(-1/2). Correction, for these r: the least
//!          |W^(1/2) s_a|, then the least |s_p|
//! Shapes   C_p: t x p, C_a: t x a, D: a x d
//! Source   Wehage & Haug 1982; least norms: Golub & Van Loan, Matrix Computations, 4th ed., 5.5.6
//! Checked  src/closure/mobility/coordinate_partitioning.rs

use crate::closure::constraint::rate_rank::rate_size;
use crate::linalg::{Elimination, Matrix, RankGap, dot, norm};
use crate::tolerance::MIN_ACTUATED_SHARE;

/// Remainders of columns that are roundings of zero, and those that are regular, for columns of
/// length one [-].
const GAP: RankGap = RankGap { zero: 1e-11, regular: 1e-6 };

/// A coordinate or actuated loop joint.
#[derive(Debug, Clone, Copy)]
pub(super) struct Velocity {
    /// Its place among the coordinates and loop joints.
    pub(super) place: usize,
    /// rate = scale * scaled rate
    pub(super) scale: f64,
}

/// The rows of loops and contacts that share joints.
#[derive(Debug, Clone)]
pub(super) struct CoupledLoops {
    /// The columns: passive ones come first.
    velocities: Vec<Velocity>,
    passive: usize,
    /// The number of rows loaded, and the size of the unit of each: with memory for all, also in copies.
    rows: usize,
    row_sizes: Vec<f64>,
    /// [C_p C_a r], then [R B r_1; 0 S r_2]: t x (p + a + 1).
    system: Matrix,
    left: Elimination,
    /// R^T where the passive joints have motions of their own: p x r.
    transposed: Matrix,
    right: Elimination,
    /// -R^+ B: p x a.
    dependence: Matrix,
    /// (S W^(-1/2))^T: a x (t - r).
    restriction: Matrix,
    across: Elimination,
    /// W^(1/2), in scaled rates.
    roots: Vec<f64>,
    passive_rates: Vec<f64>,
    actuated_rates: Vec<f64>,
    right_side: Vec<f64>,
    /// Passive rates in the order of the elimination.
    ordered: Vec<f64>,
}

impl CoupledLoops {
    /// For at most t rows.
    pub(super) fn new(passive: Vec<Velocity>, actuated: Vec<Velocity>, t: usize) -> Self {
        let (p, a) = (passive.len(), actuated.len());
        Self {
            velocities: passive.into_iter().chain(actuated).collect(),
            passive: p,
            rows: 0,
            row_sizes: vec![0.0; t],
            system: Matrix::zeros(t, p + a + 1),
            left: Elimination::workspace(p),
            transposed: Matrix::zeros(p, t.min(p)),
            right: Elimination::workspace(t.min(p)),
            dependence: Matrix::zeros(p, a),
            restriction: Matrix::zeros(a, t),
            across: Elimination::workspace(t),
            roots: vec![1.0; a],
            passive_rates: vec![0.0; p],
            actuated_rates: vec![0.0; a],
            right_side: vec![0.0; t.max(p)],
            ordered: vec![0.0; p],
        }
    }

    /// The columns.
    pub(super) fn velocities(&self) -> &[Velocity] {
        &self.velocities
    }

    fn actuated(&self) -> usize {
        self.velocities.len() - self.passive
    }

    /// Removes all rows.
    pub(super) fn clear(&mut self) {
        self.rows = 0;
        self.system.as_mut_slice().fill(0.0);
    }

    /// Adds a row of zeros with a residual, `size` that of its unit; returns its place.
    pub(super) fn push_row(&mut self, size: f64, residual: f64) -> usize {
        let (row, last) = (self.rows, self.velocities.len());
        self.row_sizes[row] = size;
        self.rows += 1;
        self.system[(row, last)] = residual / size;
        row
    }

    /// Adds a rate of a row per unit of a coordinate or loop joint.
    pub(super) fn add(&mut self, row: usize, column: usize, rate: f64) {
        self.system[(row, column)] += rate * self.velocities[column].scale / self.row_sizes[row];
    }

    /// Solves the rows for the passive joints, `weights` for the actuated ones of all coordinates and
    /// loop joints (or none): the square of the norm of R^+ B, or `None` where a rank is not clear,
    /// or where the actuated joints may take a small share of a motion.
    pub(super) fn solve(&mut self, weights: &[f64]) -> Option<f64> {
        let (p, a) = (self.passive, self.actuated());
        let size = (0..p + a).map(|j| norm(self.system.column(j))).fold(0.0, f64::max);
        let size = rate_size(size);
        if !size.is_finite() || !self.left.eliminate(&mut self.system, p, GAP.times(size)) {
            return None;
        }
        let rank = self.left.rank();
        if rank < p {
            for i in 0..rank {
                let column = self.transposed.column_mut(i);
                column[..i].fill(0.0);
                for (j, x) in column.iter_mut().enumerate().skip(i) {
                    *x = self.system[(i, j)];
                }
            }
            if !self.right.eliminate(&mut self.transposed, rank, GAP.times(size)) {
                return None;
            }
        }
        let mut square = 0.0;
        for k in 0..a {
            self.right_side[..rank].copy_from_slice(&self.system.column(p + k)[..rank]);
            self.follow();
            for (x, rate) in self.dependence.column_mut(k).iter_mut().zip(&self.passive_rates) {
                *x = -rate;
            }
            square += dot(&self.passive_rates, &self.passive_rates);
        }
        if !((1.0 + square) * MIN_ACTUATED_SHARE * MIN_ACTUATED_SHARE < 1.0) {
            return None;
        }
        for (root, velocity) in self.roots.iter_mut().zip(&self.velocities[p..]) {
            *root = velocity.scale * weights.get(velocity.place).map_or(1.0, |w| w.sqrt());
        }
        self.restrict(rank, size).then_some(square)
    }

    /// The rows that restrict the actuated joints; false where their rank is not clear.
    fn restrict(&mut self, rank: usize, size: f64) -> bool {
        let (p, a, t) = (self.passive, self.actuated(), self.system.rows());
        let mut most = 0.0_f64;
        for i in rank..t {
            let column = self.restriction.column_mut(i - rank);
            for (k, x) in column.iter_mut().enumerate() {
                *x = self.system[(i, p + k)];
                most = most.max(x.abs());
            }
        }
        if most <= GAP.zero * size {
            self.restriction.as_mut_slice().fill(0.0);
        } else if most < GAP.regular * size {
            return false;
        }
        for j in 0..t - rank {
            let column = self.restriction.column_mut(j);
            column.iter_mut().zip(&self.roots).for_each(|(x, root)| *x /= root);
        }
        let size = (0..t - rank).map(|j| norm(self.restriction.column(j))).fold(0.0, f64::max);
        self.across.eliminate(&mut self.restriction, t - rank, GAP.times(size))
            && self.across.rank() <= a
    }

    /// The least s_p with `R P^T s_p = right_side`, into the passive rates.
    fn follow(&mut self) {
        let (p, rank) = (self.passive, self.left.rank());
        let ordered = &mut self.ordered[..p];
        if rank < p {
            self.right.least_solution(&self.transposed, &self.right_side[..rank], ordered);
        } else {
            ordered.copy_from_slice(&self.right_side[..p]);
            self.left.solve(&self.system, ordered);
        }
        self.restore_order();
    }

    /// Passive rates in the order of their columns.
    fn restore_order(&mut self) {
        for (x, &i) in self.ordered.iter().zip(self.left.order()) {
            self.passive_rates[i] = *x;
        }
    }

    /// d: number of independent actuated motions.
    pub(super) fn motions(&self) -> usize {
        self.actuated() - self.across.rank()
    }

    /// Writes the rates of motion `j` of the d, for y = e_j.
    pub(super) fn motion_into(&mut self, j: usize, rates: &mut [f64]) {
        self.actuated_rates.fill(0.0);
        self.actuated_rates[self.across.rank() + j] = 1.0;
        self.across.apply(&self.restriction, &mut self.actuated_rates);
        self.actuated_rates.iter_mut().zip(&self.roots).for_each(|(x, root)| *x /= root);
        self.dependence.mul_vec_into(&self.actuated_rates, &mut self.passive_rates);
        self.store(rates);
    }

    /// Number of motions of the passive joints alone.
    pub(super) fn passive_motions(&self) -> usize {
        self.passive - self.left.rank()
    }

    /// Writes the rates of motion `j` of them, of unit norm (scaled).
    pub(super) fn passive_motion_into(&mut self, j: usize, rates: &mut [f64]) {
        self.ordered.fill(0.0);
        self.ordered[self.left.rank() + j] = 1.0;
        self.right.apply(&self.transposed, &mut self.ordered);
        self.restore_order();
        self.actuated_rates.fill(0.0);
        self.store(rates);
    }

    /// Writes the changes that close the loops to first order: of the passive joints alone, and of the
    /// actuated ones with the passive ones that follow them.
    pub(super) fn correction_into(&mut self, passive_step: &mut [f64], actuated_step: &mut [f64]) {
        let (rank, last) = (self.left.rank(), self.system.cols() - 1);
        let residuals = self.system.column(last);
        self.right_side[..rank].copy_from_slice(&residuals[..rank]);
        self.across.least_solution(&self.restriction, &residuals[rank..], &mut self.actuated_rates);
        self.actuated_rates.iter_mut().zip(&self.roots).for_each(|(x, root)| *x /= -root);
        self.dependence.mul_vec_into(&self.actuated_rates, &mut self.passive_rates);
        self.store(actuated_step);
        self.follow();
        self.passive_rates.iter_mut().for_each(|x| *x = -*x);
        self.actuated_rates.fill(0.0);
        self.store(passive_step);
    }

    /// Rates from the scaled ones.
    fn store(&self, rates: &mut [f64]) {
        let scaled = self.passive_rates.iter().chain(&self.actuated_rates);
        for (s, velocity) in scaled.zip(&self.velocities) {
            rates[velocity.place] = s * velocity.scale;
        }
    }
}
