//! Intervals of joint rates, and the limit that sets each end: what the solver keeps.
//!
//! Units    rad/s or m/s
//! Checked  tests/it/servo/limits.rs::limits_*, tests in `servo/limits.rs`

use crate::tolerance::LIMIT_MET;

/// The rates allowed in the next step, and which limit sets each end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityBounds {
    /// Smallest rate [rad/s or m/s].
    pub lower: f64,
    /// Largest rate [rad/s or m/s].
    pub upper: f64,
    /// What sets the smallest rate.
    pub lower_cause: LimitKind,
    /// What sets the largest rate.
    pub upper_cause: LimitKind,
}

/// The kind of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum LimitKind {
    /// Position: the joint is at its limit or brakes before it.
    Position,
    /// Velocity.
    Velocity,
    /// Acceleration.
    Acceleration,
}

impl LimitKind {
    /// Its name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
        }
    }
}

impl VelocityBounds {
    /// Any rate.
    pub(in crate::control) const NONE: Self = Self {
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        lower_cause: LimitKind::Velocity,
        upper_cause: LimitKind::Velocity,
    };

    /// The nearest allowed rate; NaN stays NaN, it is near to none.
    #[must_use]
    pub fn clamp(&self, rate: f64) -> f64 {
        if rate < self.lower {
            self.lower
        } else if rate > self.upper {
            self.upper
        } else {
            rate
        }
    }

    /// The limit that a rate has run into, if any.
    #[must_use]
    pub fn met(&self, rate: f64) -> Option<LimitKind> {
        if rate >= self.upper - LIMIT_MET * self.upper.abs() {
            Some(self.upper_cause)
        } else if rate <= self.lower + LIMIT_MET * self.lower.abs() {
            Some(self.lower_cause)
        } else {
            None
        }
    }

    /// True if the rate is allowed.
    #[must_use]
    pub fn contains(&self, rate: f64) -> bool {
        rate >= self.lower && rate <= self.upper
    }
}
