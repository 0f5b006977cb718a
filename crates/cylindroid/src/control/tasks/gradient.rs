//! Gradients as tasks of the lowest level: manipulability of a frame, avoidance of joint limits.
//!
//! Formula  `control/servo/secondary/manipulability.rs`, `limit_avoidance.rs`
//! Shapes   n joint velocities
//! Units    for a gain of 1
//! Checked  tests/it/servo/task_kinds.rs::gradients_climb

use crate::control::servo::{SecondaryTask, SecondaryVelocities};
use crate::kinematics::State;

/// The gradient of a task at the present configuration, and memory for it.
#[derive(Debug, Clone)]
pub(super) struct Gradient {
    pub(super) velocities: SecondaryVelocities,
    pub(super) now: Vec<f64>,
}

impl Gradient {
    /// Computes the gradient of this task.
    pub(super) fn load(&mut self, task: &SecondaryTask, state: &State) {
        self.now.fill(0.0);
        self.velocities.add(task, state.q(), 1.0, &mut self.now);
    }
}
