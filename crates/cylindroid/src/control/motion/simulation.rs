//! Simulation of a servo with an ideal robot, until it reaches its target or stalls: the loop of
//! `move`.
//!
//! Checked  tests/it/servo/steps.rs, tests/it/servo/stall.rs

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
    /// The joint velocities commanded by the step [rad/s or m/s].
    pub joint_velocities: &'a [f64],
    /// The result of the step.
    pub step: &'a Step,
}

/// The result of a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionResult {
    /// True if the target was reached.
    pub reached: bool,
    /// The reason of a stall; `None` if the target was reached or the time ran out.
    pub stall: Option<Stall>,
    /// The last configuration.
    pub q: Vec<f64>,
    /// The result of the last step.
    pub last: Step,
    /// Number of steps.
    pub steps: usize,
    /// Duration (s).
    pub time: f64,
    /// Largest time that the tool was behind a moving target (s), see [`Step::lag`].
    pub largest_lag: f64,
    /// Smallest ratio of singular values during the motion.
    pub min_singular_ratio: f64,
    /// Limits that bounded a joint velocity during the motion: index in `q` and kind.
    pub limits_hit: BTreeSet<(usize, LimitKind)>,
    /// The reason why the requested projection did not exist, at its first occurrence.
    pub no_inverse: Option<NoInverse>,
    /// Number of such steps, performed by the fallback if one was given.
    pub steps_without_inverse: usize,
}

/// Steps `servo` from `q` until the motion ends, or for `duration` seconds (one step if it is NaN).
/// `target` gives the target at a time (s) and whether it is the final one, `observe` receives
/// every step.
///
/// ```
/// use cylindroid::control::simulate;
/// use cylindroid::{Servo, ServoOptions};
///
/// let robot = cylindroid::load("panda")?;
/// let target = robot.state(&[0.3, -0.4, 0.1, -2.0, 0.2, 1.7, 0.5])?.pose(robot.tool());
/// let mut servo = Servo::new(&robot, ServoOptions::new(&robot))?;
/// let mut times = Vec::new();
/// let result = simulate(
///     &mut servo,
///     robot.home(),
///     10.0,
///     |_| (target.into(), true),
///     |sample| times.push(sample.time),
/// )?;
/// assert!(result.reached && times.len() == result.steps + 1);
/// # Ok::<(), cylindroid::Error>(())
/// ```
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
    let (mut largest_lag, mut min_singular_ratio) = (0.0_f64, f64::INFINITY);
    let mut limits_hit = BTreeSet::new();
    let mut no_inverse = None;
    let mut steps_without_inverse = 0;
    loop {
        let time = steps as f64 * dt;
        let (now, is_final) = target(time);
        let step = servo.step(&q, now)?;
        largest_lag = largest_lag.max(step.lag);
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
        // An arm that stopped because no inverse exists does not follow the target any further.
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
                largest_lag,
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
