//! A changed direction where a part of the task is out of reach: the curvature of what is left of the
//! error takes the place of a scalar damping, and the motion slows down early enough to stop there.
//!
//! Formula  min |J y - s x|^2 + y^T C y within the bounds, C = P(- e_l . dJ/dq) + d, P the part with
//!          positive eigenvalues, e_l the error that the bounds leave; near the best pose y is s gain
//!          times the Newton step to it, (J^T J + C)^-1 J^T e; s lets every joint stop within that
//! Shapes   J: m x n, C: n x n
//! Valid    trees; e_l is at most as large as the error
//! Why so   |J y - x|^2 alone ends with full speed at the edge of reach, and a scalar damping that
//!          prevents it slows weak directions that are not at an edge
//! Source   Nocedal & Wright, Numerical Optimization, 2006, section 10.1 (Newton's method for least
//!          squares)
//! Checked  tests/it/servo/edge.rs

use super::problem::{FED_FORWARD, LEAST_DAMPING, Problem, STRAIGHT};
use crate::control::solver::active_set::{ActiveSet, Level};
use crate::linalg::{Elimination, Matrix, RankGap, Svd, norm};

/// Joint velocities below this share of all are roundings of zero [-].
const ROUNDING: f64 = 1e-9;

/// The second derivatives of a task, and the limits of its joints.
pub(in crate::control) trait Curvature {
    /// `out = - left . dJ/dq`, symmetric, n x n, in the coordinates of the task and its unknowns.
    fn load(&mut self, left: &[f64], out: &mut Matrix);

    /// The share of `rates` from which every joint can stop within `way`.
    fn share(&self, way: &[f64], rates: &[f64]) -> f64;
}

/// The path of a task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::control) enum Path {
    /// Straight as long as the bounds permit.
    Straight,
    /// Towards the nearest pose from the start: the target is out of reach.
    Curved,
}

/// Workspace.
#[derive(Debug, Clone)]
pub(super) struct Curved {
    left: Vec<f64>,
    curvature: Matrix,
    eigen: Svd,
    /// [J; B] with B^T B = C beside [x; 0] and [e; 0].
    stacked: Matrix,
    elimination: Elimination,
    /// The same problem as n rows.
    level: Level,
    way: Vec<f64>,
    rates: Vec<f64>,
    ordered: Vec<f64>,
}

impl Curved {
    pub(super) fn new(m: usize, n: usize) -> Self {
        Self {
            left: vec![0.0; m],
            curvature: Matrix::zeros(n, n),
            eigen: Svd::workspace(n, n),
            stacked: Matrix::zeros(m + n, n + 2),
            elimination: Elimination::workspace(n),
            level: Level::new(n, n),
            way: vec![0.0; n],
            rates: vec![0.0; n],
            ordered: vec![0.0; n],
        }
    }

    /// Moves `set`, at its start, to the solution; `task` is the task without curvature.
    pub(super) fn solve(
        &mut self,
        set: &mut ActiveSet,
        task: &mut Level,
        p: &Problem<'_>,
        curvature: &mut dyn Curvature,
    ) {
        let (m, n) = (p.j.rows(), p.j.cols());
        set.least_residual(task, STRAIGHT);
        self.left.copy_from_slice(task.left(set.point()));
        let (size, error) = (norm(&self.left), norm(p.error));
        let scale = if size > 0.0 { (1.0 / p.gain).min(error / size) } else { 0.0 };
        self.left.iter_mut().for_each(|x| *x *= scale);
        curvature.load(&self.left, &mut self.curvature);
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
        for j in 0..n {
            self.stacked.column_mut(j)[..m].copy_from_slice(p.j.column(j));
        }
        self.stacked.column_mut(n)[..m].copy_from_slice(&task.target);
        self.stacked.column_mut(n + 1)[..m].copy_from_slice(p.error);
        // Regular: C has at least the least damping.
        self.elimination.eliminate(&mut self.stacked, n, RankGap { zero: 0.0, regular: 0.0 });
        for (column, solution) in [(n, &mut self.rates), (n + 1, &mut self.way)] {
            self.ordered.copy_from_slice(&self.stacked.column(column)[..n]);
            self.elimination.solve(&self.stacked, &mut self.ordered);
            for (x, &j) in self.ordered.iter().zip(self.elimination.order()) {
                solution[j] = *x;
            }
        }
        // Joints that take no part in the task move by rounding only, and have no way.
        let rounding = ROUNDING * norm(&self.rates);
        self.rates.iter_mut().filter(|rate| rate.abs() <= rounding).for_each(|rate| *rate = 0.0);
        let share = if norm(&task.target) > FED_FORWARD * p.gain * error {
            1.0
        } else {
            curvature.share(&self.way, &self.rates)
        };
        for (k, &j) in self.elimination.order().iter().enumerate() {
            let column = self.level.rows.column_mut(j);
            column.fill(0.0);
            column[..=k].copy_from_slice(&self.stacked.column(k)[..=k]);
        }
        for (b, x) in self.level.target.iter_mut().zip(self.stacked.column(n)) {
            *b = share * x;
        }
        set.start(p.last);
        set.least_residual(&mut self.level, STRAIGHT);
    }
}
