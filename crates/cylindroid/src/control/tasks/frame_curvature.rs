//! The curvature of what limits leave of the error of a frame.
//!
//! Formula  `servo/edge.rs`, of each frame over the joints of its chain
//! Shapes   u x u over all unknowns, of which those of the chain are not zero
//! Valid    frames on trees
//! Checked  tests in this file, tests/it/servo/task_edges.rs

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
        let chain = Chain::of(mechanism, *end_effector);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::ReferenceFrame;
    use crate::model::catalogue;

    /// -left . dA/dq by central differences of the scaled rows A, symmetrised: of frames in the middle
    /// and at the end, with weights of the task and of joints, added to what is there.
    #[test]
    fn curvatures_are_those_of_differences() {
        let robot = catalogue::load("panda").unwrap();
        let (n, root, h) = (robot.n(), 1.5, 1e-6);
        let mut options = TaskServoOptions::new(&robot);
        options.joint_weights = (0..n).map(|j| 1.0 + 0.5 * j as f64).collect();
        let limits: Vec<Limits> = robot.coordinates().iter().map(|c| c.limits).collect();
        let left = [0.1, -0.2, 0.15, 0.3, -0.1, 0.05];
        let q: Vec<f64> = robot.home().iter().map(|x| x + 0.2).collect();
        for name in ["link4", robot.frame_of(robot.tool()).name.as_str()] {
            let frame = robot.frame(name).unwrap();
            let target = robot.state(&q).unwrap().pose_of(frame).into();
            let objective =
                TaskObjective::Frame { end_effector: frame.into(), components: Task::POSE, target };
            let mut own = FrameCurvature::of(&objective, &robot, &limits, &options).unwrap();
            assert!(own.is_of(&objective));
            let mut found = Matrix::identity(n);
            own.add(&q, (&left, root), &mut found);
            let scale = |j: usize| 1.0 / options.joint_weights[j].sqrt();
            let rates = |q: &[f64]| -> Vec<f64> {
                let state = robot.state(q).unwrap();
                let jacobian = state.jacobian(frame, ReferenceFrame::LocalWorldAligned).unwrap();
                let unit = |r: usize| root * if r < 3 { 1.0 / options.length } else { 1.0 };
                let entry =
                    |j: usize| (0..6).map(|r| left[r] * unit(r) * jacobian[(r, j)]).sum::<f64>();
                (0..n).map(|j| scale(j) * entry(j)).collect()
            };
            let slope = |i: usize| -> Vec<f64> {
                let (mut ahead, mut behind) = (q.clone(), q.clone());
                ahead[i] += h;
                behind[i] -= h;
                let pairs = rates(&ahead).into_iter().zip(rates(&behind));
                pairs.map(|(a, b)| scale(i) * (a - b) / (2.0 * h)).collect()
            };
            let slopes: Vec<Vec<f64>> = (0..n).map(slope).collect();
            for i in 0..n {
                for j in 0..n {
                    let expected =
                        f64::from(u8::from(i == j)) - 0.5 * (slopes[i][j] + slopes[j][i]);
                    assert!((found[(i, j)] - expected).abs() < 1e-8, "{name}: {i}, {j}");
                }
            }
        }
    }
}
