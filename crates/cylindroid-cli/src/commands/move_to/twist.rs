//! Motions that follow a twist for a time, then stop.

use std::collections::BTreeSet;

use cylindroid::control::{MotionResult, TrajectorySample, TwistStatus};
use cylindroid::spatial::Twist;
use cylindroid::{Pose, ReferenceFrame, Result, Rotation, Servo};

use super::job::Job;
use super::twist_goal::TwistGoal;

/// Follows the twist until its end, a stall or the time limit, then brakes.
pub(super) fn simulate(
    servo: &mut Servo,
    job: &Job,
    goal: &TwistGoal,
    mut observe: impl FnMut(TrajectorySample<'_>),
) -> Result<MotionResult> {
    let dt = job.options.dt;
    let mut q = job.start.clone();
    let mut steps = 0_usize;
    let mut min_singular_ratio = f64::INFINITY;
    let mut limits_hit = BTreeSet::new();
    let (mut no_inverse, mut steps_without_inverse) = (None, 0);
    loop {
        let time = steps as f64 * dt;
        let commanded = time < goal.duration;
        let twist = match job.options.task.axes {
            _ if !commanded => Twist::ZERO,
            ReferenceFrame::Local => {
                let axes = job.robot.state(&q)?.pose(job.options.end_effector).rotation;
                let Twist { linear, angular } = goal.twist;
                Twist { linear: axes * linear, angular: axes * angular }
            }
            _ => goal.twist,
        };
        let now = servo.step_twist(&q, Some(twist))?;
        let mut last = now.step;
        [last.position_error, last.orientation_error] = errors(job, last.pose);
        min_singular_ratio = min_singular_ratio.min(last.singular_ratio);
        limits_hit.extend(servo.active_limits());
        if let Some(reason) = servo.no_inverse() {
            no_inverse.get_or_insert(reason);
            steps_without_inverse += 1;
        }
        observe(TrajectorySample {
            time,
            q: &q,
            joint_velocities: servo.joint_velocities(),
            step: &last,
        });
        let stalled = now.status == TwistStatus::Stalled;
        let reached = !commanded && now.status == TwistStatus::AtRest;
        if stalled || reached || time >= job.time_limit {
            return Ok(MotionResult {
                reached,
                stall: stalled.then(|| servo.stall()),
                q,
                last,
                steps,
                time,
                largest_lag: 0.0,
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

/// Distance and angle to the target, in the components of the task.
fn errors(job: &Job, pose: Pose) -> [f64; 2] {
    let task = job.options.task;
    let axes = match task.axes {
        ReferenceFrame::Local => pose.rotation.inverse(),
        _ => Rotation::IDENTITY,
    };
    let error = pose.error_to(job.target_pose);
    let error = Twist { linear: axes * error.linear, angular: axes * error.angular }.to_array();
    let (linear, angular) = task.components.split_at(3);
    let norm = |on: &[bool], error: &[f64]| {
        on.iter().zip(error).map(|(on, e)| if *on { e * e } else { 0.0 }).sum::<f64>().sqrt()
    };
    [norm(linear, &error[..3]), norm(angular, &error[3..])]
}
