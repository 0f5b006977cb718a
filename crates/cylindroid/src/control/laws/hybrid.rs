//! Hybrid control: some motions of a tool are controlled in position, the wrenches that do no work
//! on them in force.
//!
//! Formula  the page of [`HybridController`]
//! Shapes   twists and wrenches of one frame; P 6 x 6
//! Units    gain 1/s; e m and rad; x, f m/s and rad/s; wrenches N and N m
//! Frame    any, common to the projector, C, the twists and the wrenches. For a servo: world axes
//!          at the tool
//! Valid    gain * dt < 2, and for a contact of stiffness k (N/m) c_f k dt < 2. No allocation
//! Fails    on non-finite values. If P does not exist there is no control law: see
//!          [`Projector::of`](crate::screws::Projector::of)
//! Why so   selecting rows of a task frame, or projecting orthogonally on S and its complement in
//!          R^6, mixes metres and radians: another origin commands another motion. Here the two
//!          parts do not interfere in any frame: the force part yields along Z alone, to wrenches
//!          that do no work on S; the position part moves along S, on which they do no work
//! Source   Donelan & Selig, section 6.3; the flaw of the first formulation (Raibert & Craig 1981):
//!          Lipkin & Duffy 1988
//! Checked  tests/it/servo/hybrid.rs, examples/03_write_on_a_tilted_plane.rs

use super::admittance::Admittance;
use crate::error::{Error, Result};
use crate::screws::Projector;
use crate::spatial::{Pose, Twist, Wrench};

/// Hybrid motion and force controller.
///
/// ```text
/// x = P (gain e + f) + (1 - P) C P* (w_d - w),   P* = 1 - P^T
/// ```
///
/// P projects on the motions S that are controlled in position, along the twists Z; P* projects on
/// the wrenches that do no work on S. e is the twist error (m, rad), f the feed-forward twist (m/s,
/// rad/s), C the [`Admittance`], `w_d` and `w` the desired and the measured wrench (N, N m), x the
/// commanded twist; all in one frame. Neither part interferes with the other in any frame. Requires
/// `gain * dt < 2`, and `c_f k dt < 2` for a contact of stiffness k (N/m).
///
/// Source: Donelan & Selig, section 6.3; on the first formulation (Raibert & Craig 1981): Lipkin &
/// Duffy 1988.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HybridController {
    gain: f64,
    admittance: Admittance,
}

/// Input of one step of hybrid control, all in one frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HybridInput {
    /// From the tool to its target: [`Pose::screw_to`](crate::Pose::screw_to).
    pub error: Twist,
    /// The twist of the target.
    pub feed_forward: Twist,
    /// The desired wrench of the tool on its surroundings.
    pub desired: Wrench,
    /// The measured wrench of the tool on its surroundings: the negative of the reading of a wrist
    /// sensor.
    pub measured: Wrench,
}

/// Output of one step of hybrid control.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HybridCommand {
    /// The twist of the tool: the sum of the two parts.
    pub twist: Twist,
    /// The part in S, of the twist error and the feed-forward.
    pub position_part: Twist,
    /// The part along Z, of the wrench error.
    pub force_part: Twist,
    /// The effective wrench error: P* (desired - measured).
    pub wrench_error: Wrench,
}

impl HybridController {
    /// A controller with the proportional `gain` [1/s] of the twist error, and an admittance.
    ///
    /// # Errors
    /// A gain that is not positive and finite.
    pub fn new(gain: f64, admittance: Admittance) -> Result<Self> {
        Error::check_positive("gain", gain)?;
        Ok(Self { gain, admittance })
    }

    /// The twist of this step; `projector` projects on the motions controlled in position.
    ///
    /// ```
    /// use cylindroid::control::{Admittance, AdmittanceGain, HybridController, HybridInput};
    /// use cylindroid::screws::{Complement, Projector, ScrewOptions};
    /// use cylindroid::{Twist, Vec3, Wrench};
    ///
    /// // A point on a surface of normal z: force along the normal, the other motions in position.
    /// let turn = |angular| Twist { linear: Vec3::ZERO, angular };
    /// let slide = |linear| Twist { linear, angular: Vec3::ZERO };
    /// let free = [turn(Vec3::X), turn(Vec3::Y), turn(Vec3::Z), slide(Vec3::X), slide(Vec3::Y)];
    /// let along = Complement::Reciprocal { h: f64::INFINITY };
    /// let projector = Projector::of(&free, along, &ScrewOptions::default())?.expect("it exists");
    /// let admittance = Admittance::at(Vec3::ZERO, AdmittanceGain { force: 0.002, moment: 0.0 })?;
    /// let input = HybridInput {
    ///     error: slide(Vec3::new(0.01, 0.0, 0.3)), // the z component is left to the force
    ///     desired: Wrench { force: Vec3::Z * -5.0, moment: Vec3::ZERO },
    ///     ..HybridInput::default()
    /// };
    /// let command = HybridController::new(2.0, admittance)?.command(&projector, &input)?;
    /// assert!((command.twist.linear - Vec3::new(0.02, 0.0, -0.01)).norm() < 1e-15);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// Non-finite input, or a twist that overflows.
    pub fn command(&self, projector: &Projector, input: &HybridInput) -> Result<HybridCommand> {
        Error::check_finite("twist error", &input.error.to_array())?;
        Error::check_finite("feed-forward twist", &input.feed_forward.to_array())?;
        Error::check_finite("desired wrench", &input.desired.to_array())?;
        Error::check_finite("measured wrench", &input.measured.to_array())?;
        let position_part = projector.motion(input.error * self.gain + input.feed_forward);
        let wrench_error = projector.constraint(input.desired - input.measured);
        let force_part = projector.rest(self.admittance.apply(wrench_error));
        let twist = position_part + force_part;
        Error::check_finite("commanded twist", &twist.to_array())?;
        Ok(HybridCommand { twist, position_part, force_part, wrench_error })
    }

    /// The same controller in another frame; `self` is in frame b.
    #[must_use]
    pub fn seen_from(&self, a_from_b: Pose) -> Self {
        Self { admittance: self.admittance.seen_from(a_from_b), ..*self }
    }
}
