//! Input and output of a servo step: target, status, errors.
//!
//! Checked  tests/it/servo/steps.rs, tests/it/servo/plant.rs

use super::options::ServoOptions;
use crate::control::solver::saturation::Saturation;
use crate::error::{Error, Result};
use crate::spatial::{Pose, Rotation, Twist};
use crate::task::check_target;
use crate::tolerance::MAX_MAGNITUDE;

/// A moving target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// Desired `world_from_tool`.
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
    /// Checks for values that are not finite or out of range.
    pub(in crate::control) fn check(&self) -> Result<()> {
        check_target(&self.pose)?;
        Error::check_within("feed-forward twist", &self.feed_forward.to_array(), MAX_MAGNITUDE)
    }

    /// The desired motion, in the axes of the task, restricted to its components.
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

/// What a step follows.
#[derive(Debug, Clone, Copy)]
pub(super) enum Aim {
    Target(Target),
    /// World axes, at the tool; without an error.
    Twist(Twist),
}

impl Aim {
    /// True where no motion is commanded.
    pub(super) fn is_rest(self) -> bool {
        matches!(self, Self::Twist(twist) if twist == Twist::ZERO)
    }

    /// The target of a tool at this pose.
    pub(super) fn target(self, pose: Pose) -> Target {
        match self {
            Self::Target(target) => target,
            Self::Twist(feed_forward) => Target { pose, feed_forward },
        }
    }

    /// A target moves on by its twist for `time` (s).
    pub(super) fn after(self, time: f64) -> Self {
        let Self::Target(Target { pose, feed_forward }) = self else { return self };
        let turn = Rotation::exp(feed_forward.angular * time);
        let pose = Pose {
            rotation: (turn * pose.rotation).renormalised(),
            translation: pose.translation + feed_forward.linear * time,
        };
        Self::Target(Target { pose, feed_forward })
    }
}

/// The desired motion of a step, in the axes of the task.
#[derive(Debug, Clone, Copy)]
pub(super) struct DesiredMotion {
    pub(super) error: Twist,
    /// gain * error
    pub(super) feedback: Twist,
    pub(super) feed_forward: Twist,
}

/// Status of a servo after a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Moving towards the target.
    Moving,
    /// Both errors are within tolerance, and the tool moves so slowly relative to the target that
    /// they stay within it: speed <= gain * tolerance.
    Reached,
    /// The error no longer falls, or the tool no longer moves although the target does;
    /// [`Servo::stall`](super::controller::Servo::stall) gives the reason.
    Stalled,
}

impl Status {
    /// The name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Moving => "moving",
            Self::Reached => "reached",
            Self::Stalled => "stalled",
        }
    }
}

/// Result of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Status of the servo.
    pub status: Status,
    /// The pose of the tool before the step.
    pub pose: Pose,
    /// Distance to the target, in the components of the task (m).
    pub position_error: f64,
    /// Angle to the target, in the components of the task (rad).
    pub orientation_error: f64,
    /// Time that the tool is behind a moving target (s): the error along the target's motion, over its
    /// largest speed of the last second or so; at most the time since the target began to move. Zero for
    /// fixed targets.
    pub lag: f64,
    /// Ratio of the smallest to the largest singular value of the scaled task Jacobian.
    pub singular_ratio: f64,
    /// Number of directions with a gain times singular value of at least one half.
    pub rank: usize,
    /// The share of the task that the limits permit.
    pub saturation: Saturation,
}
