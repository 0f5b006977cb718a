//! Memory of a stack of tasks: the rows of each task, and the levels that they form.
//!
//! Shapes   of a task: rows x n; of a level: the sum of the rows of its tasks x n
//! Checked  tests/it/servo/tasks.rs, tests in this file

use std::ops::Range;

use super::frame_curvature::FrameCurvature;
use super::objective::TaskObjective;
use super::options::{MotionTask, StoppedBy};
use crate::control::servo::PoseTolerance;
use crate::control::solver::active_set::{DampedLevel, Level};
use crate::control::solver::hierarchy::ScaledLevel;
use crate::linalg::{Basis, Matrix, norm};

/// Gain that makes an error of the velocity of a task that has none [1/s].
pub(super) const USUAL_GAIN: f64 = 5.0;

/// A level of the stack.
#[derive(Debug, Clone)]
pub(super) struct Stack {
    pub(super) members: Vec<Member>,
    pub(super) level: ScaledLevel,
    /// The rows of its tasks whose directions are changed; the others are zero.
    pub(super) turned: DampedLevel,
    /// The target before singular directions are left out of it.
    pub(super) asked: Vec<f64>,
    /// Share of the level that higher levels or singular directions leave out.
    pub(super) left_out: f64,
}

/// A task in its level.
#[derive(Debug, Clone)]
pub(super) struct Member {
    /// Its index, and its rows in the level.
    pub(super) task: usize,
    pub(super) rows: Range<usize>,
    /// Its weight over the largest of the level [-].
    pub(super) weight: f64,
    pub(super) direction_changed: bool,
    /// True if the linearised task goes beyond its range.
    pub(super) is_curved: bool,
    /// Norm of its scaled error, and of its velocity divided by its gain.
    pub(super) error: f64,
    pub(super) way: f64,
    /// Of a frame on a tree.
    pub(super) curvature: Option<Box<FrameCurvature>>,
    /// Of its changed direction: the part of its scaled error that limits leave.
    pub(super) left: Vec<f64>,
    pub(super) scale: f64,
    pub(super) stopped_by: Option<StoppedBy>,
    /// Workspace: of the space of its rows, and one of them.
    pub(super) basis: Basis,
    pub(super) row: Vec<f64>,
}

impl Stack {
    /// The levels of tasks in n unknowns, the highest first, with the curvatures of their objectives.
    pub(super) fn of_levels(
        tasks: &[MotionTask],
        n: usize,
        curvature: impl Fn(&TaskObjective) -> Option<Box<FrameCurvature>>,
    ) -> Vec<Self> {
        let with_rows = || tasks.iter().enumerate().filter(|(_, t)| t.objective.rows() > 0);
        let mut levels: Vec<usize> = with_rows().map(|(_, task)| task.level).collect();
        levels.sort_unstable();
        levels.dedup();
        let stack = |level| {
            let (mut first, mut members) = (0, Vec::new());
            let own = || with_rows().filter(|(_, task)| task.level == level);
            let largest = own().map(|(_, task)| task.weight).fold(0.0, f64::max);
            for (i, task) in own() {
                let rows = first..first + task.objective.rows();
                first = rows.end;
                let weight = task.weight / largest;
                members.push(Member::new((i, weight), rows, n, curvature(&task.objective)));
            }
            let starts = members.iter().map(|m| m.rows.start).collect();
            Self {
                members,
                level: ScaledLevel::new(starts, first, n),
                turned: DampedLevel::new(first, n),
                asked: vec![0.0; first],
                left_out: 0.0,
            }
        };
        levels.into_iter().map(stack).collect()
    }
}

impl Member {
    /// Of a task in n unknowns.
    fn new(
        (task, weight): (usize, f64),
        rows: Range<usize>,
        n: usize,
        curvature: Option<Box<FrameCurvature>>,
    ) -> Self {
        Self {
            task,
            weight,
            direction_changed: false,
            is_curved: false,
            error: 0.0,
            way: 0.0,
            curvature,
            left: vec![0.0; rows.len()],
            rows,
            scale: 1.0,
            stopped_by: None,
            basis: Basis::workspace(n),
            row: vec![0.0; n],
        }
    }

    /// Stores the part of the scaled error of which `velocities` are what is left.
    pub(super) fn load_left(&mut self, gain: f64, velocities: &[f64]) {
        let gain = if gain > 0.0 { gain } else { USUAL_GAIN };
        let scale = (1.0 / gain).min(self.way / norm(velocities).max(f64::MIN_POSITIVE));
        self.left.iter_mut().zip(velocities).for_each(|(x, left)| *x = scale * left);
    }

    /// Adds the curvature of what is left; of other tasks than frames k |error| |A_j|, with the rows of
    /// the level and k.
    pub(super) fn add_curvature(
        &mut self,
        task: &MotionTask,
        q: &[f64],
        (level, k): (&Level, f64),
        out: &mut Matrix,
    ) {
        if let Some(of_frame) = &mut self.curvature
            && of_frame.is_of(&task.objective)
        {
            of_frame.add(q, (&self.left, self.weight.sqrt()), out);
            return;
        }
        let damping = k * norm(&self.left);
        for j in 0..out.cols() {
            out[(j, j)] += damping * norm(&level.rows.column(j)[self.rows.clone()]);
        }
    }
}

/// Rows of one task.
#[derive(Debug, Clone)]
pub(super) struct TaskRows {
    /// At the measured configuration, and at the one to which the commands lead.
    pub(super) measured_error: Vec<f64>,
    pub(super) error: Vec<f64>,
    pub(super) feed_forward: Vec<f64>,
    pub(super) jacobian: Matrix,
    /// True for rows that are lengths.
    pub(super) is_length: Vec<bool>,
}

impl TaskRows {
    /// Of an objective of a mechanism with n coordinates.
    pub(super) fn new(objective: &TaskObjective, n: usize) -> Self {
        let m = objective.rows();
        Self {
            measured_error: vec![0.0; m],
            error: vec![0.0; m],
            feed_forward: vec![0.0; m],
            jacobian: Matrix::zeros(m, n),
            is_length: (0..m).map(|i| objective.is_length(i)).collect(),
        }
    }

    /// Scale of a row: 1 / length of those that are lengths [1/m], 1 of angles.
    pub(super) fn unit(&self, row: usize, length: f64) -> f64 {
        if self.is_length[row] { 1.0 / length } else { 1.0 }
    }

    /// True if the error exceeds a tolerance.
    pub(super) fn exceeds(&self, tolerance: PoseTolerance) -> bool {
        let mut parts = [0.0_f64; 2];
        for (error, is_length) in self.error.iter().zip(&self.is_length) {
            parts[usize::from(!is_length)] += error * error;
        }
        let [position, orientation] = parts.map(f64::sqrt);
        position > tolerance.position || orientation > tolerance.orientation
    }

    /// The rate at which these joint velocities reduce the error, its lengths divided by `length`
    /// [1/s]; without an error or rows infinite.
    pub(super) fn progress(&self, rates: &[f64], length: f64) -> f64 {
        self.along(&self.error, rates, length)
    }

    /// The share of the feed-forward velocity that these joint velocities have, likewise [-].
    pub(super) fn followed(&self, rates: &[f64], length: f64) -> f64 {
        self.along(&self.feed_forward, rates, length)
    }

    fn along(&self, goal: &[f64], rates: &[f64], length: f64) -> f64 {
        let (mut reduced, mut square) = (0.0, 0.0);
        for (i, goal) in goal.iter().enumerate() {
            let scaled = goal * self.unit(i, length).powi(2);
            let velocity: f64 =
                (0..self.jacobian.cols()).map(|j| self.jacobian[(i, j)] * rates[j]).sum();
            reduced += scaled * velocity;
            square += scaled * goal;
        }
        if square > 0.0 { reduced / square } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// e^T U^2 J y / e^T U^2 e, U = 1 / length for lengths; the same in other units of length.
    #[test]
    fn progress_weighs_lengths_and_angles() {
        let rows = |unit: f64| TaskRows {
            measured_error: vec![0.0; 2],
            error: vec![0.2 * unit, -0.3],
            feed_forward: vec![0.0; 2],
            jacobian: Matrix::from_rows(&[[0.5 * unit, unit], [-1.0, 2.0]]).unwrap(),
            is_length: vec![true, false],
        };
        let rates = [0.7, -0.4];
        let velocity = [0.5 * 0.7 - 0.4, -0.7 - 0.8];
        let weights = [1.0 / 0.25, 1.0];
        let expected = (weights[0] * 0.2 * velocity[0] - weights[1] * 0.3 * velocity[1])
            / (weights[0] * 0.04 + weights[1] * 0.09);
        for unit in [1.0, 1000.0] {
            let found = rows(unit).progress(&rates, 0.5 * unit);
            assert!(
                (found - expected).abs() < 1e-15 * expected.abs().max(1.0),
                "{found} {expected}"
            );
        }
        let none = TaskRows { error: vec![0.0; 2], ..rows(1.0) };
        assert_eq!(none.progress(&rates, 0.5), f64::INFINITY);
    }
}
