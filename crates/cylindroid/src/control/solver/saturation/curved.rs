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

use super::newton_step::NewtonStep;
use super::problem::{FED_FORWARD, Problem};
use crate::control::solver::active_set::{ActiveSet, Level, Precision};
use crate::linalg::{Matrix, dot, norm};

/// Joint velocities below this share of all are roundings of zero [-].
const ROUNDING: f64 = 1e-9;

/// The second derivatives of a task, and the limits of its joints.
pub(in crate::control) trait Curvature {
    /// `out = - left . dJ/dq`, symmetric, n x n, in the coordinates of the task and its unknowns.
    fn load(&mut self, left: &[f64], out: &mut Matrix);

    /// The share of `rates` from which every joint can stop within `way`; `gradient` is that of the
    /// task along the unknowns.
    fn share(&self, way: &[f64], rates: &[f64], gradient: &[f64]) -> f64;
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
    newton: NewtonStep,
    /// The same problem as n rows.
    level: Level,
    way: Vec<f64>,
    rates: Vec<f64>,
    gradient: Vec<f64>,
}

impl Curved {
    pub(super) fn new(m: usize, n: usize) -> Self {
        Self {
            left: vec![0.0; m],
            newton: NewtonStep::new(m, n),
            level: Level::new(n, n),
            way: vec![0.0; n],
            rates: vec![0.0; n],
            gradient: vec![0.0; n],
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
        set.least_residual(task, Precision::STRAIGHT);
        self.left.copy_from_slice(task.left(set.point()));
        let (size, error) = (norm(&self.left), norm(p.error));
        let scale = if size > 0.0 { (1.0 / p.gain).min(error / size) } else { 0.0 };
        self.left.iter_mut().for_each(|x| *x *= scale);
        curvature.load(&self.left, &mut self.newton.curvature);
        self.newton.decompose(p.j, &[&task.target, p.error]);
        self.newton.solution_into(0, &mut self.rates);
        self.newton.solution_into(1, &mut self.way);
        // Joints that take no part in the task move by rounding only, and have no way.
        let rounding = ROUNDING * norm(&self.rates);
        self.rates.iter_mut().filter(|rate| rate.abs() <= rounding).for_each(|rate| *rate = 0.0);
        let share = if norm(&task.target) > FED_FORWARD * p.gain * error {
            1.0
        } else {
            for (j, g) in self.gradient.iter_mut().enumerate() {
                *g = dot(p.j.column(j), &task.target);
            }
            curvature.share(&self.way, &self.rates, &self.gradient)
        };
        self.newton.rows_into(&mut self.level.rows);
        for (b, x) in self.level.target.iter_mut().zip(self.newton.right_side(0)) {
            *b = share * x;
        }
        set.start(p.last);
        set.least_residual(&mut self.level, Precision::STRAIGHT);
    }
}
