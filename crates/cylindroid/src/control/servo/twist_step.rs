//! Velocity mode: the commanded twist with its watchdog, and the verdict of a step.
//!
//! Formula  s = <achieved, desired> / |desired|^2 in scaled task coordinates; its mean over the last
//!          `WINDOW` seconds, exponentially weighted, is below `FOLLOWED`: stalled
//! Watchdog a command holds for `ServoOptions::command_timeout` seconds, then the twist is zero
//! Why so   a twist has no error that could cease to fall; a mean is below the share also where the
//!          tool swings to and fro at an edge of its workspace
//! Checked  tests/it/servo/twist.rs

use super::step::Step;
use crate::linalg::dot;
use crate::scalar::clamp;
use crate::spatial::Twist;

/// Time constant of the mean share (s).
const WINDOW: f64 = 0.25;
/// Mean share of the desired twist below which it is not followed [-].
const FOLLOWED: f64 = 0.05;

/// Ratio of singular values below which the limits of velocities, with a twist that they scale to
/// nothing, are not the cause of a stall but the singularity [-].
pub(super) const NEAR_SINGULAR: f64 = 0.02;

/// Status of a servo in velocity mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TwistStatus {
    /// No twist is commanded, or the last command is too old, and all joints are at rest; passive ones of
    /// closed chains but for the velocities that close the measured loops.
    AtRest,
    /// No twist is commanded, or the last command is too old: the joints brake.
    Braking,
    /// The tool follows the twist, at least in part.
    Following,
    /// The tool does not move along the twist; [`Servo::stall`](super::controller::Servo::stall)
    /// gives the reason.
    Stalled,
}

impl TwistStatus {
    /// The name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::AtRest => "at-rest",
            Self::Braking => "braking",
            Self::Following => "following",
            Self::Stalled => "stalled",
        }
    }
}

/// Result of a step in velocity mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwistStep {
    /// Status of the servo.
    pub status: TwistStatus,
    /// The twist that the step follows, world axes, at the tool: the last command, or zero, also where the
    /// command has no part in the components of the task.
    pub desired: Twist,
    /// The twist of the joint velocities, in the components of the task, world axes, at the tool.
    pub achieved: Twist,
    /// True if the last command is older than `ServoOptions::command_timeout`.
    pub timed_out: bool,
    /// Pose, singular value ratio, rank and saturation; its errors are zero, its status means
    /// nothing here.
    pub step: Step,
}

/// The last command and the progress along it.
#[derive(Debug, Clone, Default)]
pub(super) struct TwistFollower {
    command: Twist,
    /// Time since the command (s).
    age: f64,
    /// The desired twist of the last step, scaled; zero before the first.
    last: Vec<f64>,
    mean_share: f64,
    /// True if the last step was one of velocity mode, and did not follow its twist.
    pub(super) is_stalled: bool,
}

impl TwistFollower {
    /// For tasks of m components.
    pub(super) fn new(m: usize) -> Self {
        Self { last: vec![0.0; m], ..Self::default() }
    }

    pub(super) fn reset(&mut self) {
        (self.command, self.age) = (Twist::ZERO, 0.0);
        self.last.fill(0.0);
    }

    /// The twist to follow for `dt` seconds, and whether the last command is too old.
    pub(super) fn desired(&self, new: Option<Twist>, dt: f64, timeout: f64) -> (Twist, bool) {
        match new {
            Some(twist) => (twist, false),
            None if self.age + dt > timeout * (1.0 + 1e-9) => {
                (Twist::ZERO, self.command != Twist::ZERO)
            }
            None => (self.command, false),
        }
    }

    /// Records a step. Both twists are scaled.
    pub(super) fn record(
        &mut self,
        new: Option<Twist>,
        desired: &[f64],
        achieved: &[f64],
        dt: f64,
    ) {
        match new {
            Some(twist) => (self.command, self.age) = (twist, 0.0),
            None => self.age += dt,
        }
        let size = dot(desired, desired);
        if dot(desired, &self.last) <= 0.0 {
            self.mean_share = 1.0; // another motion
        }
        self.last.copy_from_slice(desired);
        if size == 0.0 {
            return;
        }
        let share = clamp(dot(achieved, desired) / size, -1.0, 1.0);
        self.mean_share += (share - self.mean_share) * (dt / (WINDOW + dt));
        self.is_stalled = self.mean_share < FOLLOWED;
    }
}
