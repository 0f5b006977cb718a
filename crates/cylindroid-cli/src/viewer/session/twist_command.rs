//! The twist that a session in velocity mode follows.

use cylindroid::Twist;

/// A command holds this long (s): pages on slow networks send some twenty a second.
pub(super) const COMMAND_TIMEOUT: f64 = 0.25;

/// The command that is followed.
#[derive(Debug)]
pub(super) struct Driven {
    pub(super) twist: Twist,
    /// True until a step has seen it.
    pub(super) is_new: bool,
    /// Time since it came (s).
    pub(super) age: f64,
}

impl Driven {
    /// Zero if the command is too old.
    pub(super) fn desired(&self) -> Twist {
        if self.age < COMMAND_TIMEOUT { self.twist } else { Twist::ZERO }
    }
}
