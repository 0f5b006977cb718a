//! The problem of a saturation: a task, the bounds of the rates, the last step.
//!
//! Shapes   J: m x a
//! Checked  src/control/solver/saturation/tests.rs

use crate::control::solver::bounds::VelocityBounds;
use crate::linalg::{Matrix, norm};

/// Least damping of a task whose direction is changed [-].
pub(in crate::control) const LEAST_DAMPING: f64 = 1e-6;

/// A task beyond this many times gain times error is mainly fed forward, which has no way that ends
/// [-].
pub(in crate::control) const FED_FORWARD: f64 = 2.0;

/// Motions of the joints up to which a Jacobian describes that of the task (scaled) [-].
const LINEAR: f64 = 1.0;

/// Joint motions that are larger than those of the task by more than this are those of a weak
/// direction (scaled) [-].
const AMPLIFIED: f64 = 20.0;

/// The task and the bounds of a step.
#[derive(Debug, Clone, Copy)]
pub(in crate::control) struct Problem<'a> {
    /// The task in the unknowns.
    pub(in crate::control) j: &'a Matrix,
    /// Of the rates.
    pub(in crate::control) bounds: &'a [VelocityBounds],
    /// The rates of the last step.
    pub(in crate::control) last: &'a [f64],
    /// Velocities of the task for an error of 1 [1/s].
    pub(in crate::control) gain: f64,
    /// The error of the task: what of it cannot be reached has a curvature, unlike a twist that is
    /// fed forward.
    pub(in crate::control) error: &'a [f64],
}

impl Problem<'_> {
    /// True if a small share of the unbounded solution is a step on its way: not where it goes far
    /// beyond the range of the linearisation for little motion of the task.
    pub(super) fn is_sensible(&self, primary: &[f64], task: f64) -> bool {
        let size = norm(primary);
        size <= self.gain * LINEAR || size <= AMPLIFIED * task
    }
}
