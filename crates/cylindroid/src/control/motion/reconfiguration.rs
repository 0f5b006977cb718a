//! A way round: a posture within all limits that reaches a target which the servo, moving straight
//! at it, does not.
//!
//! Method   inverse kinematics from the present posture, of several answers the nearest. Limits of
//!          position form a box, so the straight way there through joint space keeps them.
//! Units    rad, m
//! Valid    any task; trees without spherical and free joints (else `None`). `None` says that no
//!          attempt of so many reached it: likely, not proved, that no posture does. The attempts
//!          are the same on every run.
//! Why so   what stops a servo is nearly always the posture it started from
//! Checked  tests/it/servo/reconfiguration.rs::a_reconfiguration_reaches_what_the_servo_does_not

use crate::control::servo::Servo;
use crate::error::Result;
use crate::ik::{Budget, Goal, ITERATIONS_PER_RESTART, IkOptions, solve};
use crate::model::CoordinateKind;
use crate::spatial::Pose;

/// Share of the servo's tolerance within which the posture reaches the target [-].
const WITHIN: f64 = 0.5;

/// A posture that reaches the target.
#[derive(Debug, Clone, PartialEq)]
pub struct Reconfiguration {
    /// The posture, all n coordinates.
    pub q: Vec<f64>,
    /// Attempts it took to find it, and to look for nearer ones.
    pub restarts: usize,
}

/// A posture within the limits in which the servo's end effector is at `target`; coordinates
/// that do not move the end effector, and those that a limit locks, keep their values of `q`.
///
/// # Errors
/// A `q` of the wrong size or not finite; a target that is not finite.
pub fn find_reachable_configuration(
    servo: &Servo,
    q: &[f64],
    target: Pose,
    max_restarts: usize,
) -> Result<Option<Reconfiguration>> {
    let mechanism = servo.mechanism();
    mechanism.check_q("q", q)?;
    let straight = |c: &usize| {
        matches!(mechanism.coordinates()[*c].kind, CoordinateKind::Angle | CoordinateKind::Length)
    };
    if mechanism.is_closed() || !servo.coordinates().iter().all(straight) {
        return Ok(None); // there is no straight way for spherical and free joints, nor in loops
    }
    let options = servo.options();
    let free: Vec<usize> = servo.free_coordinates().collect();
    let ik = IkOptions {
        position_tolerance: WITHIN * options.tolerance.position,
        orientation_tolerance: WITHIN * options.tolerance.orientation,
        initial_guess: Some(q.to_vec()),
        fixed: (0..mechanism.n()).filter(|c| !free.contains(c)).collect(),
        nearest: true,
        seed: 0,
        budget: Budget { iterations: ITERATIONS_PER_RESTART * max_restarts.max(1), time: None },
        length: Some(options.length),
    };
    let goal = Goal { end_effector: options.end_effector, target, task: options.task };
    let found = solve(mechanism, &[goal], &ik)?;
    Ok(found.success.then_some(Reconfiguration { q: found.q, restarts: found.restarts }))
}
