//! Where joints that brake come to rest, and the part of their motion along what tasks ask for: memory of
//! `braking_in_time.rs`.
//!
//! Formula  g = sum over rows  w u / L^2 (J q'),  u = K (e + t f) + f, f the feed-forward, with 1 in place
//!          of the length L for angles
//! Shapes   q': n; u: the rows of the level
//! Checked  tests/it/servo/task_braking.rs

use super::levels::TaskRows;
use super::motions::Motions;
use super::objective::Scratch;
use super::options::MotionTask;
use crate::kinematics::State;
use crate::model::{Limits, Mechanism};

/// Where the joints come to rest, and workspace.
#[derive(Debug, Clone)]
pub(super) struct TurningBack {
    pub(super) state: State,
    pub(super) scratch: Scratch,
    /// Of each task.
    pub(super) rows: Vec<TaskRows>,
    pub(super) q: Vec<f64>,
    /// Of the joints that are tried [rad/s or m/s].
    pub(super) rates: Vec<f64>,
    /// Unknowns: of the solver, braked, and between them.
    pub(super) solved: Vec<f64>,
    pub(super) braked: Vec<f64>,
    pub(super) trial: Vec<f64>,
}

/// A motion along what the tasks of a level ask for.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Along {
    pub(super) part: f64,
    /// The square of the size of what they ask for.
    pub(super) square: f64,
}

impl Along {
    /// Adds a task whose target moves on for `later` seconds, with this weight.
    pub(super) fn add(
        &mut self,
        (task, rows): (&MotionTask, &TaskRows),
        rate: impl Fn(usize) -> f64,
        (weight, later, length): (f64, f64, f64),
    ) {
        for (r, (error, forward)) in rows.error.iter().zip(&rows.feed_forward).enumerate() {
            let asked = task.gain * (error + later * forward) + forward;
            let scaled = weight * asked * rows.unit(r, length).powi(2);
            let columns = 0..rows.jacobian.cols();
            self.part += scaled * columns.map(|j| rows.jacobian[(r, j)] * rate(j)).sum::<f64>();
            self.square += scaled * asked;
        }
    }
}

impl TurningBack {
    /// For joints with these limits; `None` where nothing turns back, or nothing is known about it.
    pub(super) fn new(
        mechanism: &Mechanism,
        motions: &Motions,
        limits: &[Limits],
        tasks: &[MotionTask],
    ) -> Option<Self> {
        let Motions::Tree(columns) = motions else { return None };
        let mut moving = limits.iter().zip(columns).filter(|(_, column)| **column != 0.0);
        if !moving.any(|(l, _)| l.acceleration < f64::INFINITY || l.jerk < f64::INFINITY) {
            return None;
        }
        let n = mechanism.n();
        let needs_masses = tasks.iter().any(|task| task.objective.needs_masses());
        Some(Self {
            state: mechanism.state(mechanism.home()).ok()?,
            scratch: Scratch::new(mechanism, needs_masses),
            rows: tasks.iter().map(|task| TaskRows::new(&task.objective, n)).collect(),
            q: vec![0.0; n],
            rates: vec![0.0; n],
            solved: vec![0.0; n],
            braked: vec![0.0; n],
            trial: vec![0.0; n],
        })
    }

    /// Velocities between the braked ones and those of the solver.
    pub(super) fn mix(&mut self, share: f64) {
        let all = self.trial.iter_mut().zip(&self.braked).zip(&self.solved);
        all.for_each(|((trial, braked), solved)| *trial = braked + share * (solved - braked));
    }
}
