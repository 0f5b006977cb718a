//! Half-spaces as one-sided rows: zero inside, the distance outside.
//!
//! Formula  e = max(0, -d) / L, J = n^T J_v / L where d < 0, otherwise 0; d by `task/half_space.rs`,
//!          L the characteristic length
//! Units    m
//! Why so   a row that is zero inside takes nothing from the goals, and Newton's method brings a
//!          configuration from outside to the boundary in the steps that it needs for the goals
//! Checked  tests/it/ik_half_spaces.rs, src/ik/goal_rows.rs (finite differences)

use crate::kinematics::State;
use crate::linalg::Matrix;
use crate::model::Mechanism;
use crate::task::HalfSpace;

/// The half-spaces of a problem, with their distances at the configuration evaluated last.
#[derive(Debug, Clone)]
pub(super) struct HalfSpaceRows {
    pub(super) all: Vec<HalfSpace>,
    /// Distances inside (m, negative outside).
    pub(super) rooms: Vec<f64>,
    /// Left out of the errors: to find the reason of a miss.
    pub(super) ignored: bool,
    jacobian: Matrix,
    gradient: Vec<f64>,
}

impl HalfSpaceRows {
    pub(super) fn new(mechanism: &Mechanism, all: &[HalfSpace]) -> Self {
        Self {
            rooms: vec![f64::INFINITY; all.len()],
            all: all.to_vec(),
            ignored: false,
            jacobian: Matrix::zeros(6, mechanism.n()),
            gradient: vec![0.0; mechanism.n()],
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    pub(super) fn evaluate(&mut self, state: &State) {
        for (room, half_space) in self.rooms.iter_mut().zip(&self.all) {
            *room = if self.ignored { f64::INFINITY } else { half_space.room(state) };
        }
    }

    /// The gradient of the distance of half-space i, over all coordinates.
    pub(super) fn gradient(&mut self, i: usize, state: &State) -> &[f64] {
        self.all[i].gradient_into(state, &mut self.jacobian, &mut self.gradient);
        &self.gradient
    }

    /// The names of the half-spaces that `state` violates by more than `tolerance` (m).
    pub(super) fn violated(&self, state: &State, tolerance: f64) -> Vec<String> {
        let outside = self.all.iter().filter(|h| h.room(state) < -tolerance);
        outside.map(|h| h.name.clone()).collect()
    }
}
