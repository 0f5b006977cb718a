//! Escape of the first level from configurations in which no velocity makes its errors smaller although
//! a finite motion would: stretched arms, joints at limits.
//!
//! Formula  `servo/saddle.rs` with e the scaled errors of the first level; its Hessian by differences
//!          H e_j = (g(q) - g(q + h e_j)) / h, of `COLUMNS` joints in a step while the robot rests
//! Shapes   H: n x n
//! Valid    trees, first levels without custom tasks (which may count their evaluations). Tasks whose
//!          points are out of reach of their chains do not count, and no half-space or pair of bodies may
//!          stop the others. Lower levels wait until the first one progresses
//! Cost     nothing while it progresses; otherwise `COLUMNS` evaluations of its tasks in a step, and in
//!          one step an eigenvalue decomposition. No allocation
//! Checked  tests/it/servo/task_edges.rs, tests/allocation/main.rs

use super::levels::Stack;
use super::motions::Motions;
use super::objective::TaskObjective;
use super::options::MotionTask;
use crate::control::servo::{Progress, Saddle};
use crate::control::solver::bounds::VelocityBounds;
use crate::kinematics::Chain;
use crate::model::Mechanism;
use crate::spatial::Vec3;

/// What is done about a level that makes no progress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Phase {
    /// It progresses.
    Watching,
    /// The next column of the Hessian.
    Probing(usize),
    /// The way out, for so long (s), of which this is left (scaled).
    Leaving { time: f64, left: f64 },
    /// No way leads out; the error then.
    Resting(f64),
}

/// Progress of the first level, and workspace.
#[derive(Debug, Clone)]
pub(super) struct Escape {
    pub(super) phase: Phase,
    pub(super) progress: Progress,
    pub(super) saddle: Saddle,
    /// At the start of the differences.
    pub(super) q: Vec<f64>,
    pub(super) gradient: Vec<f64>,
    /// Workspace: another configuration, a unit velocity, scaled bounds.
    pub(super) other: Vec<f64>,
    pub(super) unit: Vec<f64>,
    pub(super) bounds: Vec<VelocityBounds>,
    /// 1 / root of the weight of each joint.
    pub(super) columns: Vec<f64>,
    /// Velocities of the last step, scaled.
    pub(super) last: Vec<f64>,
    /// Origin and length of the chain of each task (m).
    pub(super) chains: Vec<Option<(Vec3, f64)>>,
}

/// Share of the velocity that the first level asks for, and the size of its error.
#[derive(Debug, Clone, Copy)]
pub(super) struct Achieved {
    pub(super) share: f64,
    pub(super) error: f64,
}

impl Escape {
    /// For tasks in these levels; `None` where there is no escape.
    pub(super) fn new(
        mechanism: &Mechanism,
        motions: &Motions,
        tasks: &[MotionTask],
        stacks: &[Stack],
    ) -> Option<Self> {
        let Motions::Tree(columns) = motions else { return None };
        let first = stacks.first()?;
        let is_custom = |task: usize| matches!(tasks[task].objective, TaskObjective::Custom(_));
        if first.members.iter().any(|m| is_custom(m.task)) {
            return None;
        }
        let n = columns.len();
        Some(Self {
            phase: Phase::Watching,
            progress: Progress::new(),
            saddle: Saddle::new(n),
            q: vec![0.0; n],
            gradient: vec![0.0; n],
            other: vec![0.0; n],
            unit: vec![0.0; n],
            bounds: vec![VelocityBounds::NONE; n],
            columns: columns.clone(),
            last: vec![0.0; n],
            chains: tasks.iter().map(|task| reach(mechanism, &task.objective)).collect(),
        })
    }

    /// True if the chain of a task can reach its point.
    pub(super) fn counts(&self, task: usize, objective: &TaskObjective) -> bool {
        match (self.chains[task], objective) {
            (Some((origin, length)), TaskObjective::Frame { target, .. }) => {
                (target.pose.translation - origin).norm() <= length
            }
            _ => true,
        }
    }

    pub(super) fn reset(&mut self) {
        self.phase = Phase::Watching;
        self.progress.reset();
    }
}

/// Origin and length of the chain of a task of all three positions of a frame (m).
fn reach(mechanism: &Mechanism, objective: &TaskObjective) -> Option<(Vec3, f64)> {
    match objective {
        TaskObjective::Frame { end_effector, components, .. }
            if components.components[..3] == [true; 3] =>
        {
            let chain = Chain::of(mechanism, *end_effector);
            Some((chain.first_origin(), chain.length_after_first_joint(mechanism)))
        }
        _ => None,
    }
}
