//! Simulation of a servo, until it reaches its target or stalls: the loops of `move`.
//!
//! Checked  tests/it/servo/steps.rs, tests/it/servo/stall.rs, tests/it/servo/plant.rs,
//!          tests/it/servo/twist.rs

use std::collections::BTreeSet;

use crate::control::servo::{Servo, SimulatedRobot, Stall, Status, Step, Target, TwistStatus};
use crate::control::solver::LimitKind;
use crate::error::Result;
use crate::screws::NoInverse;
use crate::spatial::Twist;

/// Share of the motion of a twist that may be missing where it counts as followed [-].
const NOT_FOLLOWED: f64 = 0.05;

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
    /// Limits that bound a joint velocity in this step: index in `q` and kind.
    pub limits: &'a [(usize, LimitKind)],
}

/// The result of a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionResult {
    /// True if the target was reached; of twists, if the tool made 95 % of their motion at least, and rests.
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
    /// Of twists the share of their motion that the tool made, while they were commanded and until it
    /// stopped: below 1 where limits slowed it.
    pub followed: Option<f64>,
}

impl MotionResult {
    /// True for a twist of whose motion more than 5 % is missing.
    #[must_use]
    pub fn is_slowed(&self) -> bool {
        self.followed.is_some_and(|share| share < 1.0 - NOT_FOLLOWED)
    }
}

/// Steps `servo` from `q`, with a robot as [`ServoOptions::plant`](crate::ServoOptions::plant)
/// describes it, until the motion ends, or for `duration` seconds (one step if it is NaN).
/// `target` gives the target at a time (s) and whether it is the final one, `observe` receives
/// every step.
///
/// ```
/// use cylindroid::control::simulate;
/// use cylindroid::{Servo, ServoOptions};
///
/// let robot = cylindroid::load("panda")?;
/// let target = robot.state(&[0.3, -0.4, 0.1, -2.0, 0.2, 1.7, 0.5])?.pose(robot.tool())?;
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
    let mut run = Run::new(servo, q);
    loop {
        let time = run.time();
        let (now, is_final) = target(time);
        let step = run.servo.step(run.robot.measure(), now)?;
        run.note(step, &mut observe);
        let reached = is_final && step.status == Status::Reached;
        // An arm that stopped because no inverse exists does not follow the target any further.
        let stalled = step.status == Status::Stalled && (is_final || run.servo.is_stopped());
        let in_time = time < duration; // NaN is not
        if reached || stalled || !in_time {
            return Ok(run.end(step, reached, stalled));
        }
        run.advance();
    }
}

/// The same in velocity mode: follows the twist that `command` gives for a time (s) and a
/// configuration, world axes, at the tool. `None` is the end: the joints brake, and the motion is
/// over at rest. It ends early at a stall, and after `duration` (s).
///
/// ```
/// use cylindroid::control::simulate_twist;
/// use cylindroid::{Servo, ServoOptions, Twist, Vec3};
///
/// let robot = cylindroid::load("panda")?;
/// let mut servo = Servo::new(&robot, ServoOptions::new(&robot))?;
/// let up = Twist { linear: Vec3::Z * 0.1, angular: Vec3::ZERO };
/// let command = |time, _: &[f64]| Ok((time < 1.0).then_some(up));
/// let result = simulate_twist(&mut servo, robot.home(), 10.0, command, |_| ())?;
/// let way = |q| Ok::<_, cylindroid::Error>(robot.state(q)?.pose(robot.tool())?.translation);
/// assert!(result.reached && (way(&result.q)? - way(robot.home())?).norm() > 0.09);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// As [`Servo::step_twist`], and those of `command`.
pub fn simulate_twist(
    servo: &mut Servo,
    q: &[f64],
    duration: f64,
    mut command: impl FnMut(f64, &[f64]) -> Result<Option<Twist>>,
    mut observe: impl FnMut(TrajectorySample<'_>),
) -> Result<MotionResult> {
    servo.mechanism().check_q("q", q)?;
    let mut run = Run::new(servo, q);
    let length = run.servo.options().length;
    let product =
        |a: Twist, b: Twist| a.linear.dot(b.linear) / (length * length) + a.angular.dot(b.angular);
    let (mut last, mut made, mut whole) = (Twist::ZERO, 0.0, 0.0);
    loop {
        let time = run.time();
        let twist = command(time, run.robot.q())?;
        let now = run.servo.step_twist(run.robot.measure(), Some(twist.unwrap_or(Twist::ZERO)))?;
        run.note(now.step, &mut observe);
        // What the tool lacks while the joints accelerate, it makes while they brake.
        last = twist.unwrap_or(last);
        made += product(now.achieved, last);
        whole += twist.map_or(0.0, |twist| product(twist, twist));
        let followed = if whole > 0.0 { made / whole } else { 1.0 };
        run.followed = Some(followed);
        let stalled = now.status == TwistStatus::Stalled;
        let is_over = twist.is_none() && now.status == TwistStatus::AtRest;
        let reached = is_over && followed >= 1.0 - NOT_FOLLOWED;
        let in_time = time < duration; // NaN is not
        if is_over || stalled || !in_time {
            return Ok(run.end(now.step, reached, stalled));
        }
        run.advance();
    }
}

/// A simulation and what it has seen.
struct Run<'a> {
    servo: &'a mut Servo,
    robot: SimulatedRobot,
    steps: usize,
    largest_lag: f64,
    min_singular_ratio: f64,
    limits: Vec<(usize, LimitKind)>,
    limits_hit: BTreeSet<(usize, LimitKind)>,
    no_inverse: Option<NoInverse>,
    steps_without_inverse: usize,
    followed: Option<f64>,
}

impl<'a> Run<'a> {
    fn new(servo: &'a mut Servo, q: &[f64]) -> Self {
        let (plant, dt) = (servo.options().plant, servo.options().dt);
        Self {
            robot: SimulatedRobot::new(servo.mechanism(), q, plant, dt),
            servo,
            steps: 0,
            largest_lag: 0.0,
            min_singular_ratio: f64::INFINITY,
            limits: Vec::new(),
            limits_hit: BTreeSet::new(),
            no_inverse: None,
            steps_without_inverse: 0,
            followed: None,
        }
    }

    fn time(&self) -> f64 {
        self.steps as f64 * self.servo.options().dt
    }

    fn note(&mut self, step: Step, observe: &mut impl FnMut(TrajectorySample<'_>)) {
        self.largest_lag = self.largest_lag.max(step.lag);
        self.min_singular_ratio = self.min_singular_ratio.min(step.singular_ratio);
        self.limits.clear();
        self.limits.extend(self.servo.active_limits());
        self.limits_hit.extend(&self.limits);
        if let Some(reason) = self.servo.no_inverse() {
            self.no_inverse.get_or_insert(reason);
            self.steps_without_inverse += 1;
        }
        observe(TrajectorySample {
            time: self.time(),
            q: self.robot.q(),
            joint_velocities: self.servo.joint_velocities(),
            step: &step,
            limits: &self.limits,
        });
    }

    fn advance(&mut self) {
        let servo = &*self.servo;
        let (velocities, dt) = (servo.joint_velocities(), servo.options().dt);
        self.robot.follow(servo.mechanism(), velocities, dt, |q| servo.close(q));
        self.steps += 1;
    }

    fn end(self, last: Step, reached: bool, stalled: bool) -> MotionResult {
        MotionResult {
            reached,
            stall: stalled.then(|| self.servo.stall()),
            time: self.time(),
            q: self.robot.into_q(),
            last,
            steps: self.steps,
            largest_lag: self.largest_lag,
            min_singular_ratio: self.min_singular_ratio,
            limits_hit: self.limits_hit,
            no_inverse: self.no_inverse,
            steps_without_inverse: self.steps_without_inverse,
            followed: self.followed,
        }
    }
}
