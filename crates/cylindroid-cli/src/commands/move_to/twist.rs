//! Motions that follow a twist for a time, then stop.

use cylindroid::control::{MotionResult, Step, TrajectorySample, simulate_twist};
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
    let command = |time: f64, q: &[f64]| {
        if time >= goal.duration {
            return Ok(None);
        }
        Ok(Some(match job.options.task.axes {
            ReferenceFrame::Local => {
                let axes = job.robot.state(q)?.pose(job.options.end_effector)?.rotation;
                let Twist { linear, angular } = goal.twist;
                Twist { linear: axes * linear, angular: axes * angular }
            }
            _ => goal.twist,
        }))
    };
    let seen = |step: &Step| {
        let [position_error, orientation_error] = errors(job, step.pose);
        Step { position_error, orientation_error, ..*step }
    };
    let observe = |sample: TrajectorySample<'_>| {
        observe(TrajectorySample { step: &seen(sample.step), ..sample });
    };
    let result = simulate_twist(servo, &job.start, job.time_limit, command, observe)?;
    Ok(MotionResult { last: seen(&result.last), ..result })
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
