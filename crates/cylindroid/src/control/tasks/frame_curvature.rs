//! The curvature of what limits leave of the error of a frame.
//!
//! Formula  `servo/edge.rs`, of each frame over the joints of its chain
//! Shapes   u x u over all unknowns, of which those of the chain are not zero
//! Valid    frames on trees
//! Checked  tests/it/servo/task_edges.rs

use super::objective::TaskObjective;
use super::options::TaskServoOptions;
use crate::control::servo::{TaskScaling, TaskSpace, curvature_into};
use crate::kinematics::{Chain, EndEffector};
use crate::linalg::Matrix;
use crate::model::{Limits, Mechanism};
use crate::task::Task;

/// The chain of a frame, and workspace.
#[derive(Debug, Clone)]
pub(super) struct FrameCurvature {
    of: (EndEffector, Task),
    chain: Chain,
    space: TaskSpace,
    /// 6 x n for each joint of the chain.
    hessian: Vec<Matrix>,
    own: Matrix,
}

impl FrameCurvature {
    /// Of the frame of a task; `None` for other tasks and mechanisms.
    pub(super) fn of(
        objective: &TaskObjective,
        mechanism: &Mechanism,
        limits: &[Limits],
        options: &TaskServoOptions,
    ) -> Option<Box<Self>> {
        let TaskObjective::Frame { end_effector, components, .. } = objective else { return None };
        if mechanism.is_closed() {
            return None;
        }
        let chain = Chain::new(mechanism, *end_effector);
        let own: Vec<Limits> = chain.coordinates().iter().map(|&i| limits[i]).collect();
        let scaling = TaskScaling {
            task: *components,
            length: options.length,
            joint_weights: &options.joint_weights,
        };
        let (space, n) = (TaskSpace::new(scaling, &chain, &own), chain.n());
        let hessian = vec![Matrix::zeros(6, n); n];
        Some(Box::new(Self {
            of: (*end_effector, *components),
            chain,
            space,
            hessian,
            own: Matrix::zeros(n, n),
        }))
    }

    /// False if the objective has become another one: the curvature is not that of it.
    pub(super) fn is_of(&self, objective: &TaskObjective) -> bool {
        matches!(objective, TaskObjective::Frame { end_effector, components, .. }
            if (*end_effector, *components) == self.of)
    }

    /// Adds the curvature at `q` to that of other tasks: `left` is what is left of the error, scaled by
    /// its units and the root of the weight of the task.
    pub(super) fn add(&mut self, q: &[f64], (left, root): (&[f64], f64), out: &mut Matrix) {
        self.chain.set(q);
        curvature_into((&self.chain, &self.space), &mut self.hessian, left, &mut self.own);
        for (j, &column) in self.chain.coordinates().iter().enumerate() {
            for (i, &row) in self.chain.coordinates().iter().enumerate() {
                out[(row, column)] += root * self.own[(i, j)];
            }
        }
    }
}
