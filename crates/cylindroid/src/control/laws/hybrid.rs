//! Hybrid control: some motions of a tool are controlled in position, the wrenches that do no work
//! on them in force.
//!
//! Formula  x = P (gain e + f) + (1 - P) C P* (w_d - w), P the projector on the motions S along
//!          some Z, P* = 1 - P^T that on the wrenches that do no work on S;
//!          e = log(T_d T^-1) the twist error, f the feed-forward, C the admittance
//! Shapes   twists and wrenches of one frame; P 6 x 6
//! Units    gain 1/s; e m and rad; x, f m/s and rad/s; wrenches N and N m
//! Frame    any; that of the projector, of C, of the twists and of the wrenches. For a servo: the
//!          world's axes at the tool
//! Valid    gain * dt < 2, and for a contact of stiffness k (N/m) c_f k dt < 2. No allocation
//! Fails    on numbers that are not finite. Where P does not exist there is no law: see
//!          [`Projector::of`](crate::screws::Projector::of)
//! Why so   selecting rows of a task frame, or projecting orthogonally on S and on what is left of
//!          R^6, mixes metres and radians: another origin commands another motion. Here the two
//!          parts do not interfere in any frame: the force part gives way along Z alone, for
//!          wrenches that do no work on S; the position part moves along S, on which they do no
//!          work
//! Source   Donelan & Selig, section 6.3; the flaw of the first formulation (Raibert & Craig 1981):
//!          Lipkin & Duffy 1988
//! Checked  tests/it/servo/hybrid.rs, examples/03_write_on_a_tilted_plane.rs

use super::admittance::Admittance;
use crate::error::{Error, Result};
use crate::screws::Projector;
use crate::spatial::{Pose, Twist, Wrench};

/// The gains of hybrid control.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HybridController {
    gain: f64,
    admittance: Admittance,
}

/// What one step of hybrid control is asked for, all in one frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HybridInput {
    /// From the tool to its target: [`Pose::screw_to`](crate::Pose::screw_to).
    pub error: Twist,
    /// The twist of the target.
    pub feed_forward: Twist,
    /// What the tool shall exert on its surroundings.
    pub desired: Wrench,
    /// What the tool exerts on its surroundings: the negative of what a sensor in the wrist reads.
    pub measured: Wrench,
}

/// What to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HybridCommand {
    /// The twist of the tool: the sum of the two parts.
    pub twist: Twist,
    /// The part in S, of the twist error and the feed-forward.
    pub position_part: Twist,
    /// The part along Z, of the wrench error.
    pub force_part: Twist,
    /// What counts of the wrench error: P* (desired - measured).
    pub wrench_error: Wrench,
}

impl HybridController {
    /// A law with the proportional `gain` [1/s] of the twist error, and an admittance.
    ///
    /// # Errors
    /// A gain that is not positive and finite.
    pub fn new(gain: f64, admittance: Admittance) -> Result<Self> {
        Error::check_positive("gain", gain)?;
        Ok(Self { gain, admittance })
    }

    /// The twist of this step; `projector` is that on the motions controlled in position.
    ///
    /// # Errors
    /// Input that is not finite, or a twist that overflows.
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

    /// The same law seen from another frame: `self` is in frame b.
    #[must_use]
    pub fn seen_from(&self, a_from_b: Pose) -> Self {
        Self { admittance: self.admittance.seen_from(a_from_b), ..*self }
    }
}
