//! Shared control: a robot keeps some motions of its tool, an operator has the others.
//!
//! Formula  x = (1 - P) (gain e + f) + P u, P the projector on the operator's motions S2 along the
//!          robot's S1; e the twist error, f the feed-forward, u the operator's twist
//! Shapes   twists of one frame; P 6 x 6
//! Units    gain 1/s; e m and rad; x, f, u m/s and rad/s
//! Frame    any; that of the projector and of the twists. For a servo: the world's axes at the tool
//! Valid    gain * dt < 2. S1 and S2 h-reciprocal or merely complementary. No allocation. An arm at
//!          its limits cannot carry out every twist: see `operator_authority.rs`
//! Fails    on numbers that are not finite. Where P does not exist there is no law: see
//!          [`Projector::of`](crate::screws::Projector::of)
//! Why so   the projector on the operator's motions, as in hybrid control that on the motions in
//!          the contact: for a tool on a surface both laws take the same one. The operator's part
//!          has no component along S1, whatever the operator does, and e may be any twist to the
//!          surface: the robot's part drops where on it that leads
//! Source   Donelan & Selig, section 6.3
//! Checked  tests/it/servo/shared.rs, examples/04_operator_on_a_surface.rs

use crate::error::{Error, Result};
use crate::screws::Projector;
use crate::spatial::Twist;

/// The gain of shared control.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SharedController {
    gain: f64,
}

/// What one step of shared control is asked for, all in one frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SharedInput {
    /// From the tool to a pose that the robot shall keep; any of them.
    pub error: Twist,
    /// The twist of what the robot keeps to: zero for a surface at rest.
    pub feed_forward: Twist,
    /// The twist that the operator wants.
    pub operator: Twist,
}

/// What to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SharedCommand {
    /// The twist of the tool: the sum of the two parts.
    pub twist: Twist,
    /// The robot's part, in S1.
    pub robot_part: Twist,
    /// The operator's part, in S2.
    pub operator_part: Twist,
}

impl SharedController {
    /// A law with the proportional `gain` [1/s] of the twist error.
    ///
    /// # Errors
    /// A gain that is not positive and finite.
    pub fn new(gain: f64) -> Result<Self> {
        Error::check_positive("gain", gain)?;
        Ok(Self { gain })
    }

    /// The twist of this step; `projector` is that on the operator's motions, along the robot's.
    ///
    /// # Errors
    /// Input that is not finite, or a twist that overflows.
    pub fn command(&self, projector: &Projector, input: &SharedInput) -> Result<SharedCommand> {
        Error::check_finite("twist error", &input.error.to_array())?;
        Error::check_finite("feed-forward twist", &input.feed_forward.to_array())?;
        Error::check_finite("operator's twist", &input.operator.to_array())?;
        let robot_part = projector.rest(input.error * self.gain + input.feed_forward);
        let operator_part = projector.motion(input.operator);
        let twist = robot_part + operator_part;
        Error::check_finite("commanded twist", &twist.to_array())?;
        Ok(SharedCommand { twist, robot_part, operator_part })
    }
}
