//! Simulation of a servo of many tasks, until none of them moves any further.
//!
//! Checked  tests/it/servo/task_reports.rs

use std::collections::BTreeSet;

use super::options::TaskReport;
use super::task_servo::TaskServo;
use crate::collision::NearPair;
use crate::control::servo::{SimulatedRobot, Status};
use crate::control::solver::bounds::LimitKind;
use crate::error::Result;

/// The result of a motion with many tasks.
#[derive(Debug, Clone, PartialEq)]
pub struct TaskMotionResult {
    /// As of the last step; moving if the time ran out.
    pub status: Status,
    /// The last configuration.
    pub q: Vec<f64>,
    /// The tasks after the last step.
    pub reports: Vec<TaskReport>,
    /// Number of steps.
    pub steps: usize,
    /// Duration (s).
    pub time: f64,
    /// Limits that bounded a joint velocity during the motion: index in `q` and kind.
    pub limits_hit: BTreeSet<(usize, LimitKind)>,
    /// The nearest that two watched bodies came, if any came nearer than the margin.
    pub nearest: Option<NearPair>,
}

impl TaskServo {
    /// Steps from `q`, with a robot as [`TaskServoOptions::plant`](super::TaskServoOptions::plant)
    /// describes it, until every task is reached or stalled, or for `duration` seconds (one step if
    /// it is NaN). `observe` receives the time (s), the configuration before the step and the servo
    /// after it.
    ///
    /// # Errors
    /// As [`TaskServo::step`].
    pub fn simulate(
        &mut self,
        q: &[f64],
        duration: f64,
        mut observe: impl FnMut(f64, &[f64], &Self),
    ) -> Result<TaskMotionResult> {
        let (plant, dt) = (self.plant(), self.dt());
        let mut robot = SimulatedRobot::new(self.mechanism(), q, plant, dt);
        let (mut steps, mut limits_hit, mut nearest) = (0_usize, BTreeSet::new(), None);
        loop {
            let time = steps as f64 * dt;
            let status = self.step(robot.measure())?;
            observe(time, robot.q(), self);
            limits_hit.extend(self.active_limits());
            for near in self.near() {
                if nearest.is_none_or(|n: NearPair| near.distance < n.distance) {
                    nearest = Some(*near);
                }
            }
            let moves = self.reports().iter().any(|r| r.status == Status::Moving);
            let in_time = time < duration; // NaN is not
            if !moves || !in_time {
                let reports = self.reports().to_vec();
                return Ok(TaskMotionResult {
                    status,
                    q: robot.into_q(),
                    reports,
                    steps,
                    time,
                    limits_hit,
                    nearest,
                });
            }
            let close = |q: &mut [f64]| self.close(q);
            robot.follow(self.mechanism(), self.joint_velocities(), dt, close);
            steps += 1;
        }
    }
}
