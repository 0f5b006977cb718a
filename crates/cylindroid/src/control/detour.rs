//! A way round: a posture within all limits that reaches a target which the servo, moving straight
//! at it, does not.
//!
//! Method   runs the servo, freed of speed and acceleration limits, from the home posture and then
//!          from postures drawn evenly within the limits, until one run reaches the target. Limits
//!          of position form a box, so the straight way there through joint space keeps them.
//! Units    rad, m
//! Valid    any task; trees without spherical and free joints (else `None`). `None` says that no run of so many reached it: likely, not proved,
//!          that no posture does. The draws are the same on every run.
//! Why so   what stops a servo is nearly always the posture it started from
//! Checked  tests/it/servo/ways.rs::a_detour_reaches_what_the_servo_does_not

use super::servo::Servo;
use super::step::{Status, Target};
use crate::error::Result;
use crate::model::CoordinateKind;
use crate::scalar::uniform;
use crate::spatial::Pose;

/// Steps of one run: far more than a converging run takes.
const STEPS: usize = 400;
/// Period and gain of the runs: the error halves with every step.
const DT: f64 = 0.02;
const GAIN: f64 = 25.0;

/// A posture that reaches the target.
#[derive(Debug, Clone, PartialEq)]
pub struct Detour {
    /// The posture, all n coordinates.
    pub q: Vec<f64>,
    /// Runs it took to find it.
    pub runs: usize,
}

/// A posture within the limits from which the servo's end effector is at `target`; coordinates
/// that do not move the end effector, and those that a limit locks, keep their values of `q`.
///
/// # Errors
/// A `q` of the wrong size or not finite, and as [`Servo::step`].
pub fn find_posture(
    servo: &Servo,
    q: &[f64],
    target: Pose,
    most_runs: usize,
) -> Result<Option<Detour>> {
    let mechanism = servo.mechanism().clone();
    mechanism.check_q("q", q)?;
    if mechanism.is_closed() {
        return Ok(None); // nor through joint space where loops couple the joints
    }
    let straight = |c: &usize| {
        matches!(mechanism.coordinates()[*c].kind, CoordinateKind::Angle | CoordinateKind::Length)
    };
    if !servo.coordinates().iter().all(straight) {
        return Ok(None); // there is no straight way for spherical and free joints
    }
    let mut search = servo.unhurried(DT, GAIN)?;
    let mut random = 0_u64;
    for run in 0..most_runs {
        let mut posture = q.to_vec();
        for c in servo.free_coordinates() {
            let limits = &mechanism.coordinates()[c].limits;
            let (lower, upper) =
                (limits.lower.max(-std::f64::consts::PI), limits.upper.min(std::f64::consts::PI));
            posture[c] = if run == 0 {
                mechanism.home()[c].clamp(limits.lower, limits.upper)
            } else {
                // Limits that exclude [-pi, pi] leave one end of it.
                (lower + (upper - lower) * uniform(&mut random)).clamp(limits.lower, limits.upper)
            };
        }
        search.reset();
        for _ in 0..STEPS {
            match search.step(&posture, Target::from(target))?.status {
                Status::Reached => return Ok(Some(Detour { q: posture, runs: run + 1 })),
                Status::Stalled => break,
                Status::Moving => search.advance(&mut posture),
            }
        }
    }
    Ok(None)
}
