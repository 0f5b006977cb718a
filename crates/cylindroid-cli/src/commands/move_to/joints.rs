//! Motions from one configuration straight to another.

use std::collections::BTreeSet;

use cylindroid::control::{
    self, JointMove, JointSample, LimitKind, MotionResult, Plant, Target, TrajectorySample,
};
use cylindroid::{Result, Servo};

use super::job::Job;

/// Share of its limit from which a rate counts as having met it: a law leaves a rounding [-].
const AT_SPEED: f64 = 1.0 - 1e-9;

/// Runs it, step by step like a servo, until its end or the time limit. The servo only reports
/// pose, errors and singular values on the way; its joint velocities are not used.
pub(super) fn simulate(
    servo: &mut Servo,
    job: &Job,
    motion: &JointMove,
    mut observe: impl FnMut(TrajectorySample<'_>),
) -> Result<MotionResult> {
    let dt = job.options.dt;
    let (mut q, mut rates) = (job.start.clone(), vec![0.0; job.robot.n()]);
    let mut steps = 0_usize;
    let mut min_singular_ratio = f64::INFINITY;
    let mut limits_hit = BTreeSet::new();
    loop {
        let time = steps as f64 * dt;
        motion.sample_into(time, JointSample { positions: &mut q, velocities: &mut rates })?;
        servo.reset();
        let last = servo.step(&q, job.target_pose)?;
        min_singular_ratio = min_singular_ratio.min(last.singular_ratio);
        let all = job.robot.coordinates().iter().zip(&rates).enumerate();
        let is_fast = all.filter(|(_, (c, rate))| rate.abs() >= AT_SPEED * c.limits.velocity);
        let limits: Vec<_> = is_fast.map(|(i, _)| (i, LimitKind::Velocity)).collect();
        observe(TrajectorySample {
            time,
            q: &q,
            joint_velocities: &rates,
            step: &last,
            limits: &limits,
        });
        limits_hit.extend(limits);
        let reached = time >= motion.law().duration();
        if reached || time >= job.time_limit {
            let stall = None;
            return Ok(MotionResult {
                reached,
                stall,
                q,
                last,
                steps,
                time,
                largest_lag: 0.0,
                min_singular_ratio,
                limits_hit,
                no_inverse: None,
                steps_without_inverse: 0,
                followed: None,
            });
        }
        steps += 1;
    }
}

/// The same, and where the robot is not ideal the servo at its end: it decides whether this robot
/// reaches the target. The joint motion is that of an ideal one.
pub(super) fn simulate_with_plant(
    servo: &mut Servo,
    job: &Job,
    motion: &JointMove,
    mut observe: impl FnMut(TrajectorySample<'_>),
) -> Result<MotionResult> {
    let joints = simulate(servo, job, motion, &mut observe)?;
    if job.options.plant == Plant::IDEAL || !joints.reached {
        return Ok(joints);
    }
    servo.reset();
    let begin = joints.time + job.options.dt;
    let target = |_| (Target::from(job.target_pose), true);
    let observe = |sample: TrajectorySample<'_>| {
        observe(TrajectorySample { time: begin + sample.time, ..sample });
    };
    let end = control::simulate(servo, &joints.q, job.time_limit - begin, target, observe)?;
    Ok(MotionResult {
        steps: joints.steps + 1 + end.steps,
        time: begin + end.time,
        min_singular_ratio: joints.min_singular_ratio.min(end.min_singular_ratio),
        limits_hit: &joints.limits_hit | &end.limits_hit,
        ..end
    })
}
