//! Velocity bounds: an interval for each joint velocity, and the limit that sets each end.
//!
//! Units    rad/s or m/s
//! Checked  tests/it/servo/limits.rs::limits_*, src/control/servo/limits.rs

use crate::tolerance::LIMIT_MET;

/// The velocities permitted in the next step, and the limit that sets each end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityBounds {
    /// Smallest velocity [rad/s or m/s].
    pub lower: f64,
    /// Largest velocity [rad/s or m/s].
    pub upper: f64,
    /// The limit that sets the smallest velocity.
    pub lower_cause: LimitKind,
    /// The limit that sets the largest velocity.
    pub upper_cause: LimitKind,
}

/// The kind of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum LimitKind {
    /// Position: the joint is at its limit or brakes before it.
    Position,
    /// Velocity.
    Velocity,
    /// Acceleration.
    Acceleration,
    /// Jerk.
    Jerk,
}

impl LimitKind {
    /// The name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
        }
    }
}

impl VelocityBounds {
    /// No bounds.
    pub(in crate::control) const NONE: Self = Self {
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        lower_cause: LimitKind::Velocity,
        upper_cause: LimitKind::Velocity,
    };

    /// The closest permitted velocity; NaN stays NaN.
    #[must_use]
    pub fn clamp(&self, velocity: f64) -> f64 {
        if velocity < self.lower {
            self.lower
        } else if velocity > self.upper {
            self.upper
        } else {
            velocity
        }
    }

    /// The limit met by a velocity, if any.
    #[must_use]
    pub fn met(&self, velocity: f64) -> Option<LimitKind> {
        if velocity >= self.upper - LIMIT_MET * self.upper.abs() {
            Some(self.upper_cause)
        } else if velocity <= self.lower + LIMIT_MET * self.lower.abs() {
            Some(self.lower_cause)
        } else {
            None
        }
    }

    /// True if the velocity is permitted.
    #[must_use]
    pub fn contains(&self, velocity: f64) -> bool {
        velocity >= self.lower && velocity <= self.upper
    }
}
