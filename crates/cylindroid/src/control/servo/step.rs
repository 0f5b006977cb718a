//! What goes into a step of the servo and what comes out.

use super::options::ServoOptions;
use crate::control::solver::direct::Saturation;
use crate::error::{Error, Result};
use crate::spatial::{Pose, Twist};

/// A moving target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// `world_from_tool` as it should be.
    pub pose: Pose,
    /// The twist of the target, world axes, at the tool.
    pub feed_forward: Twist,
}

impl From<Pose> for Target {
    fn from(pose: Pose) -> Self {
        Self { pose, feed_forward: Twist::ZERO }
    }
}

impl Target {
    /// Refuses numbers that are not finite.
    pub(super) fn check(&self) -> Result<()> {
        Error::check_finite("target position", &self.pose.translation.to_array())?;
        if !self.pose.is_finite() {
            return Err(Error::NotFinite { what: "target orientation".into(), value: f64::NAN });
        }
        Error::check_finite("feed-forward twist", &self.feed_forward.to_array())
    }

    /// The motion that is asked for, in the axes of the task, the components that matter alone.
    pub(super) fn desired(&self, pose: Pose, options: &ServoOptions) -> Result<DesiredMotion> {
        let error = pose.error_to(self.pose);
        let gain = options.gain;
        let seen = |t: Twist| options.task.seen(pose, t);
        let desired = DesiredMotion {
            error: seen(error),
            feedback: seen(Twist {
                linear: error.linear * gain.position,
                angular: error.angular * gain.orientation,
            }),
            feed_forward: seen(self.feed_forward),
        };
        Error::check_finite("error to the target", &desired.error.to_array())?;
        let twist = desired.feedback + desired.feed_forward;
        Error::check_finite("gain * error + feed-forward", &twist.to_array())?;
        Ok(desired)
    }
}

/// What a step is asked for, in the axes of the task.
#[derive(Debug, Clone, Copy)]
pub(super) struct DesiredMotion {
    pub(super) error: Twist,
    /// gain * error
    pub(super) feedback: Twist,
    pub(super) feed_forward: Twist,
}

/// Where a servo stands after a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// On its way.
    Moving,
    /// Both errors are within tolerance, and so slow is the tool against the target, by the rates
    /// of this step, that they stay so: speed <= gain * tolerance.
    Reached,
    /// The error no longer falls; [`Servo::stall`](super::controller::Servo::stall) says why.
    Stalled,
}

/// What one step did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Where the servo stands.
    pub status: Status,
    /// The pose of the tool before the step.
    pub pose: Pose,
    /// Distance to the target, of the components that matter (m).
    pub position_error: f64,
    /// Angle to the target, of the components that matter (rad).
    pub orientation_error: f64,
    /// Smallest singular value of the scaled task Jacobian over the largest.
    pub singular_ratio: f64,
    /// Directions realised by at least half.
    pub rank: usize,
    /// What the limits left of the task.
    pub saturation: Saturation,
}
