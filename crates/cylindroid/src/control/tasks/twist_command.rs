//! The twist that a task follows, with its watchdog.
//!
//! Checked  tests/it/servo/task_twist.rs

use crate::spatial::Twist;

/// The twist that a task follows.
#[derive(Debug, Clone, Copy)]
pub(super) struct TwistCommand {
    pub(super) twist: Twist,
    pub(super) timeout: f64,
    /// Time for which it has been followed (s).
    pub(super) age: f64,
}

impl TwistCommand {
    /// The twist of the next step.
    pub(super) fn desired(&self) -> Twist {
        if self.age > self.timeout * (1.0 + 1e-9) { Twist::ZERO } else { self.twist }
    }
}
