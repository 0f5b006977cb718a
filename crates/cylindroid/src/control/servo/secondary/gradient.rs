//! The velocities of a secondary task by itself, for servos of many tasks: with its own chain and
//! decomposition.
//!
//! Shapes   velocities of all n coordinates
//! Checked  tests/it/servo/task_kinds.rs::gradients_climb

use super::super::task_space::{TaskScaling, TaskSpace};
use super::{Context, SecondaryTask};
use crate::kinematics::{Chain, EndEffector};
use crate::linalg::{Matrix, Svd};
use crate::model::{Limits, Mechanism};
use crate::task::Task;

/// Memory for the velocities of a secondary task.
#[derive(Debug, Clone)]
pub(in crate::control) struct SecondaryVelocities {
    mechanism: Mechanism,
    chain: Chain,
    space: TaskSpace,
    task: Matrix,
    svd: Svd,
    hessian: Vec<Matrix>,
    own: Vec<f64>,
}

impl SecondaryVelocities {
    /// For the task of an end effector, all joints weighted alike.
    pub(in crate::control) fn new(
        mechanism: &Mechanism,
        (end_effector, task): (EndEffector, Task),
        length: f64,
    ) -> Self {
        let chain = Chain::of(mechanism, end_effector);
        Self::over(mechanism, chain, task, length)
    }

    /// For tasks of all joints.
    pub(in crate::control) fn of_all(mechanism: &Mechanism) -> Self {
        let chain = Chain::whole(mechanism, mechanism.tool());
        Self::over(mechanism, chain, Task::POSE, 1.0)
    }

    fn over(mechanism: &Mechanism, chain: Chain, task: Task, length: f64) -> Self {
        let limits: Vec<Limits> =
            chain.coordinates().iter().map(|&c| mechanism.coordinates()[c].limits).collect();
        let scaling = TaskScaling { task, length, joint_weights: &[] };
        let space = TaskSpace::new(scaling, &chain, &limits);
        let (m, n) = (space.rows.len(), chain.n());
        Self {
            mechanism: mechanism.clone(),
            task: Matrix::zeros(m, n),
            svd: Svd::workspace(m, n),
            hessian: vec![Matrix::zeros(6, n); n],
            own: vec![0.0; n],
            space,
            chain,
        }
    }

    /// Adds the velocities at `q` to `out`, `share` of them.
    pub(in crate::control) fn add(
        &mut self,
        secondary: &SecondaryTask,
        q: &[f64],
        share: f64,
        out: &mut [f64],
    ) {
        self.chain.set(q);
        if secondary.needs_hessian() {
            self.space.load(&self.chain, &mut self.task);
            self.svd.decompose(&self.task);
        }
        self.own.fill(0.0);
        let mut context = Context {
            mechanism: &self.mechanism,
            chain: &self.chain,
            svd: &self.svd,
            task: &self.space,
            hessian: &mut self.hessian,
            limits: &[],
            dt: 0.0,
        };
        secondary.add_velocities(&mut context, &mut self.own);
        for (velocity, &c) in self.own.iter().zip(self.chain.coordinates()) {
            out[c] += share * velocity;
        }
    }
}
