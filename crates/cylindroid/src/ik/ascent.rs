//! The value of a criterion, and the direction in which it grows.
//!
//! Formula  manipulability: w = s_1 ... s_r of the scaled task Jacobian, r = min(m, k); the motion
//!          follows the gradient of ln w, sum_i u_i^T (dJ/dq) v_i / s_i. Limit avoidance:
//!          -1/2 sum p^2, p = 1 - d / (margin range) of every limit at a distance d within the
//!          margin
//! Shapes   m components of the task, k coordinates that move the frame
//! Units    lengths over the characteristic length [-]
//! Valid    any tree. Without a gradient (a singular task, all joints away from their limits) the
//!          configuration stays
//! Source   Yoshikawa 1985; Liegeois 1977 (gradient projection)
//! Checked  tests/it/ik_criteria.rs

use super::criterion::Criterion;
use super::levenberg_marquardt::Problem;
use crate::kinematics::{Chain, EndEffector, ReferenceFrame};
use crate::linalg::{Matrix, Svd};
use crate::manipulability::log_volume_slope;
use crate::model::{CoordinateKind, Mechanism};
use crate::task::Task;

/// A criterion with its memory.
#[derive(Debug, Clone)]
pub(super) struct Ascent {
    criterion: Criterion,
    frame: Option<FrameJacobian>,
}

/// The scaled task Jacobian of a frame.
#[derive(Debug, Clone)]
struct FrameJacobian {
    chain: Chain,
    axes: ReferenceFrame,
    /// Rows of the Jacobian, and their scale.
    rows: Vec<(usize, f64)>,
    jacobian: Matrix,
    scaled: Matrix,
    hessian: Vec<Matrix>,
    svd: Svd,
}

impl Ascent {
    pub(super) fn new(mechanism: &Mechanism, criterion: Criterion, length: f64) -> Self {
        let frame = match criterion {
            Criterion::Manipulability { end_effector, components } => {
                Some(FrameJacobian::new(mechanism, end_effector, components, length))
            }
            Criterion::LimitAvoidance { .. } => None,
        };
        Self { criterion, frame }
    }

    /// The value at `q`.
    pub(super) fn value(&mut self, problem: &Problem, q: &[f64]) -> f64 {
        match (&mut self.frame, self.criterion) {
            (Some(frame), _) => frame.volume_at(q),
            (None, Criterion::LimitAvoidance { margin }) => {
                let of = |i| pushes(problem, q, i, margin);
                let squares = (0..problem.coordinates.len()).filter_map(of);
                -0.5 * squares.map(|(lower, upper, _)| lower * lower + upper * upper).sum::<f64>()
            }
            (None, _) => f64::NAN,
        }
    }

    /// Full turns of joints that permit them, towards the middle of their range, if limits count.
    pub(super) fn wrap_angles(&self, problem: &Problem, q: &mut [f64]) {
        if matches!(self.criterion, Criterion::LimitAvoidance { .. }) {
            for (i, &c) in problem.coordinates.iter().enumerate() {
                q[c] = problem.turned_to_middle(i, q[c]);
            }
        }
    }

    /// What the ascent makes smaller at `q`: minus the logarithm of a product, minus a sum.
    pub(super) fn cost(&mut self, problem: &Problem, q: &[f64]) -> f64 {
        let value = self.value(problem, q);
        if self.frame.is_some() { -value.ln() } else { -value }
    }

    /// The gradient of minus the cost at `q`, over the coordinates of the problem.
    pub(super) fn gradient(&mut self, problem: &Problem, q: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        match (&mut self.frame, self.criterion) {
            (Some(frame), _) => frame.add_slopes(problem, q, out),
            (None, Criterion::LimitAvoidance { margin }) => {
                for (i, slope) in out.iter_mut().enumerate() {
                    if let Some((lower, upper, near)) = pushes(problem, q, i, margin) {
                        *slope = (lower - upper) / near;
                    }
                }
            }
            (None, _) => {}
        }
    }
}

/// The shares by which coordinate `i` of the problem is inside the margin of its lower and of its
/// upper limit, and the width of the margin; `None` without limits.
fn pushes(problem: &Problem, q: &[f64], i: usize, margin: f64) -> Option<(f64, f64, f64)> {
    let coordinate = &problem.mechanism.coordinates()[problem.coordinates[i]];
    let is_scalar = matches!(coordinate.kind, CoordinateKind::Angle | CoordinateKind::Length);
    let near = margin * (problem.upper[i] - problem.lower[i]);
    if !is_scalar || problem.fixed[i] || !(near.is_finite() && near > 0.0) {
        return None;
    }
    let push = |distance: f64| (1.0 - distance / near).max(0.0);
    let x = q[problem.coordinates[i]];
    Some((push(x - problem.lower[i]), push(problem.upper[i] - x), near))
}

impl FrameJacobian {
    fn new(
        mechanism: &Mechanism,
        end_effector: EndEffector,
        components: Task,
        length: f64,
    ) -> Self {
        let chain = Chain::of(mechanism, end_effector);
        let scale = |i: usize| if i < 3 { 1.0 / length } else { 1.0 };
        let rows = (0..6).filter(|&i| components.components[i]).map(|i| (i, scale(i)));
        let (rows, k) = (rows.collect::<Vec<_>>(), chain.n());
        Self {
            axes: components.axes,
            jacobian: Matrix::zeros(6, k),
            scaled: Matrix::zeros(rows.len(), k),
            hessian: vec![Matrix::zeros(6, k); k],
            svd: Svd::workspace(rows.len(), k),
            rows,
            chain,
        }
    }

    /// Decomposes the Jacobian at `q`; returns the product of its singular values.
    fn volume_at(&mut self, q: &[f64]) -> f64 {
        self.chain.set(q);
        self.chain.jacobian_into(self.axes, &mut self.jacobian);
        for j in 0..self.scaled.cols() {
            for (row, &(i, scale)) in self.rows.iter().enumerate() {
                self.scaled[(row, j)] = scale * self.jacobian[(i, j)];
            }
        }
        self.svd.decompose(&self.scaled);
        self.svd.values().product()
    }

    /// Adds the derivatives of the logarithm of that product.
    fn add_slopes(&mut self, problem: &Problem, q: &[f64], out: &mut [f64]) {
        self.volume_at(q);
        let rank = self.svd.machine_rank().rank;
        if rank == 0 || rank < self.svd.len() {
            return;
        }
        self.chain.hessian_into(self.axes, &mut self.hessian);
        for (h, c) in self.hessian.iter().zip(self.chain.coordinates()) {
            let entry = |row: usize, j: usize| {
                let (i, scale) = self.rows[row];
                scale * h[(i, j)]
            };
            if let Ok(place) = problem.coordinates.binary_search(c) {
                out[place] += log_volume_slope(&self.svd, rank, entry);
            }
        }
    }
}
