//! Shared control: the robot constrains some motions of its tool, an operator commands the others.
//!
//! Formula  the page of [`SharedController`]
//! Shapes   twists of one frame; P 6 x 6
//! Units    gain 1/s; e m and rad; x, f, u m/s and rad/s
//! Frame    any, common to the projector and the twists. For a servo: world axes at the tool
//! Valid    gain * dt < 2. S1 and S2 h-reciprocal or merely complementary. No allocation. An arm at
//!          its limits cannot perform every twist: see `operator_authority.rs`
//! Fails    on non-finite values. If P does not exist there is no control law: see
//!          [`Projector::of`](crate::screws::Projector::of)
//! Why so   the projector on the operator's motions, as in hybrid control that on the motions in
//!          the contact: for a tool on a surface both laws use the same one. The operator's part
//!          has no component along S1 for any input, and e may be any twist to the surface: the
//!          robot's part discards the component within it
//! Source   Donelan & Selig, section 6.3
//! Checked  tests/it/servo/shared.rs, examples/04_operator_on_a_surface.rs

use crate::error::{Error, Result};
use crate::screws::Projector;
use crate::spatial::Twist;

/// Shared controller of a robot and an operator.
///
/// ```text
/// x = (1 - P) (gain e + f) + P u
/// ```
///
/// P projects on the operator's motions S2 along the robot's motions S1. e is the twist error (m,
/// rad), f the feed-forward twist and u the operator's twist (m/s, rad/s), x the commanded twist;
/// all in one frame. The operator's part has no component along S1. Requires `gain * dt < 2`.
///
/// Source: Donelan & Selig, section 6.3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SharedController {
    gain: f64,
}

/// Input of one step of shared control, all in one frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SharedInput {
    /// Twist from the tool to any pose that satisfies the constraint of the robot.
    pub error: Twist,
    /// The twist of the constraint: zero for a surface at rest.
    pub feed_forward: Twist,
    /// The twist commanded by the operator.
    pub operator: Twist,
}

/// Output of one step of shared control.
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
    /// A controller with the proportional `gain` [1/s] of the twist error.
    ///
    /// # Errors
    /// A gain that is not positive and finite.
    pub fn new(gain: f64) -> Result<Self> {
        Error::check_positive("gain", gain)?;
        Ok(Self { gain })
    }

    /// The twist of this step; `projector` projects on the operator's motions along the robot's.
    ///
    /// ```
    /// use cylindroid::control::{SharedController, SharedInput};
    /// use cylindroid::screws::{Complement, Projector, ScrewOptions};
    /// use cylindroid::{Twist, Vec3};
    ///
    /// // The operator moves the tool in the plane and rotates it; the robot keeps its height.
    /// let turn = |angular| Twist { linear: Vec3::ZERO, angular };
    /// let slide = |linear| Twist { linear, angular: Vec3::ZERO };
    /// let free = [turn(Vec3::X), turn(Vec3::Y), turn(Vec3::Z), slide(Vec3::X), slide(Vec3::Y)];
    /// let along = Complement::Reciprocal { h: f64::INFINITY };
    /// let projector = Projector::of(&free, along, &ScrewOptions::default())?.expect("it exists");
    /// let input = SharedInput {
    ///     error: slide(Vec3::Z * 0.1),
    ///     operator: slide(Vec3::new(0.3, 0.0, 0.4)),
    ///     ..SharedInput::default()
    /// };
    /// let command = SharedController::new(2.0)?.command(&projector, &input)?;
    /// assert!((command.twist.linear - Vec3::new(0.3, 0.0, 0.2)).norm() < 1e-15);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// Non-finite input, or a twist that overflows.
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
