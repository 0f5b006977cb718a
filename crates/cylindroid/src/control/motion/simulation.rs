//! Driving a servo against an ideal robot that does as it is told: what `move` does.

use std::collections::BTreeSet;

use crate::control::servo::{Servo, Stall, Status, Step, Target};
use crate::control::solver::LimitKind;
use crate::error::Result;
use crate::screws::NoInverse;

/// One instant of a motion.
#[derive(Debug)]
pub struct TrajectorySample<'a> {
    /// Time since the start (s).
    pub time: f64,
    /// The configuration before the step.
    pub q: &'a [f64],
    /// The rates commanded by the step [rad/s or m/s].
    pub joint_velocities: &'a [f64],
    /// What the step reported.
    pub step: &'a Step,
}

/// How a motion ended.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionResult {
    /// True if the target was reached.
    pub reached: bool,
    /// Why it stalled; `None` if it was reached or the time ran out.
    pub stall: Option<Stall>,
    /// The last configuration.
    pub q: Vec<f64>,
    /// What the last step reported.
    pub last: Step,
    /// Steps taken.
    pub steps: usize,
    /// Duration (s).
    pub time: f64,
    /// Smallest singular value ratio on the way.
    pub min_singular_ratio: f64,
    /// Limits that set a rate on the way: place in `q` and kind.
    pub limits_hit: BTreeSet<(usize, LimitKind)>,
    /// Why the projection that was asked for did not exist, where that happened first.
    pub no_inverse: Option<NoInverse>,
    /// Steps in which it did not: taken by the fallback, if one was named.
    pub steps_without_inverse: usize,
}

/// Steps `servo` from `q` until it reports the end, or for `duration` seconds (at once after the
/// first step where it is NaN). `target` gives the
/// target at a time (s) and whether it is the final one, `observe` sees every step.
///
/// # Errors
/// As [`Servo::step`].
pub fn simulate(
    servo: &mut Servo,
    q: &[f64],
    duration: f64,
    mut target: impl FnMut(f64) -> (Target, bool),
    mut observe: impl FnMut(TrajectorySample<'_>),
) -> Result<MotionResult> {
    let dt = servo.options().dt;
    let mut q = q.to_vec();
    let mut steps = 0_usize;
    let mut min_singular_ratio = f64::INFINITY;
    let mut limits_hit = BTreeSet::new();
    let mut no_inverse = None;
    let mut steps_without_inverse = 0;
    loop {
        let time = steps as f64 * dt;
        let (now, is_final) = target(time);
        let step = servo.step(&q, now)?;
        min_singular_ratio = min_singular_ratio.min(step.singular_ratio);
        limits_hit.extend(servo.active_limits());
        observe(TrajectorySample {
            time,
            q: &q,
            joint_velocities: servo.joint_velocities(),
            step: &step,
        });
        let reached = is_final && step.status == Status::Reached;
        if let Some(reason) = servo.no_inverse() {
            no_inverse.get_or_insert(reason);
            steps_without_inverse += 1;
        }
        // An arm that stands still for want of an inverse does not follow a target any further.
        let stalled = step.status == Status::Stalled && (is_final || servo.is_stopped());
        let in_time = time < duration; // NaN is not
        if reached || stalled || !in_time {
            return Ok(MotionResult {
                reached,
                stall: stalled.then(|| servo.stall()),
                q,
                last: step,
                steps,
                time,
                min_singular_ratio,
                limits_hit,
                no_inverse,
                steps_without_inverse,
            });
        }
        servo.advance(&mut q);
        steps += 1;
    }
}
