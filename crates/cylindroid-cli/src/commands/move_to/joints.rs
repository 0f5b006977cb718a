//! Motions from one configuration straight to another.

use std::collections::BTreeSet;

use cylindroid::control::{Bounds, JointMove, JointPath, JointSample, Outcome, Sample};
use cylindroid::model::{CoordinateKind, Mechanism};
use cylindroid::{Error, Result, Servo};

use super::job::Job;
use crate::args::{LawName, MoveArgs};

/// The fastest such motion within the limits of all joints.
pub(super) fn plan(
    robot: &Mechanism,
    start: &[f64],
    goal: &[f64],
    args: &MoveArgs,
) -> Result<JointMove> {
    let path = JointPath::new(start, goal)?;
    let mut bounds = Vec::with_capacity(robot.n());
    for (coordinate, displacement) in robot.coordinates().iter().zip(path.displacement()) {
        let (acceleration, jerk) = match coordinate.kind {
            CoordinateKind::Angle => (args.path.acceleration_angular, args.path.jerk_angular),
            CoordinateKind::Length => (args.path.acceleration_linear, args.path.jerk_linear),
            CoordinateKind::RotationVector | CoordinateKind::Position if *displacement != 0.0 => {
                return Err(Error::InvalidOption {
                    option: "--joint-to",
                    value: coordinate.name.clone(),
                    reason: "spherical and free joints have no straight motion between two \
                             configurations; drive a frame with --to instead"
                        .to_owned(),
                });
            }
            CoordinateKind::RotationVector | CoordinateKind::Position => (1.0, 1.0),
        };
        let own = coordinate.limits.acceleration;
        bounds.push(Bounds {
            velocity: coordinate.limits.velocity,
            acceleration: if own.is_finite() {
                own
            } else {
                args.servo.acceleration.unwrap_or(acceleration)
            },
            jerk: match args.path.law {
                LawName::Trapezoidal => f64::INFINITY,
                LawName::JerkLimited => jerk,
            },
        });
    }
    JointMove::new(path, &bounds)
}

/// Runs it, step by step like a servo, until its end or the time limit. The servo only reports
/// pose, errors and singular values on the way; its rates are not used.
pub(super) fn drive(
    servo: &mut Servo,
    job: &Job,
    motion: &JointMove,
    mut observe: impl FnMut(Sample<'_>),
) -> Result<Outcome> {
    let dt = job.options.dt;
    let (mut q, mut rates) = (job.start.clone(), vec![0.0; job.robot.n()]);
    let mut steps = 0_usize;
    let mut min_singular_ratio = f64::INFINITY;
    loop {
        let time = steps as f64 * dt;
        motion.sample_into(time, JointSample { positions: &mut q, velocities: &mut rates })?;
        servo.reset();
        let last = servo.step(&q, job.target_pose)?;
        min_singular_ratio = min_singular_ratio.min(last.singular_ratio);
        observe(Sample { time, q: &q, rates: &rates, step: &last });
        let reached = time >= motion.law().duration();
        if reached || time >= job.time_limit {
            let (stall, limits_hit) = (None, BTreeSet::new());
            return Ok(Outcome {
                reached,
                stall,
                q,
                last,
                steps,
                time,
                min_singular_ratio,
                limits_hit,
            });
        }
        steps += 1;
    }
}
