//! How much of an operator's twist an arm near its limits can take without losing what the robot
//! keeps.
//!
//! Formula  s <- s exp(-dt / fall) after a step that limits slowed or bent,
//!          min(1, s + dt / rise) after any other; s = 0 at the start
//! Units    dt, fall, rise s; s [-]
//! Valid    any outcome of a step
//! Fails    not at all; but limits are met before s has fallen: while the joints of an arm brake,
//!          a tool may leave its surface by what `an_arm_keeps_the_surface` prints
//! Why so   a servo slows a motion as a whole and, where that leaves nothing, bends it: the robot's
//!          part then suffers for the operator's. Cutting off the operator at once is no better:
//!          joints that must brake within their accelerations bend the motion as well
//! Checked  tests/it/servo/shared.rs::an_arm_keeps_the_surface, ::the_share_of_the_operator

use crate::control::solver::direct::Saturation;
use crate::error::{Error, Result};

/// The share of the operator's twist to pass on to [`SharedController`](super::SharedController).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OperatorAuthority {
    share: f64,
    kept: f64,
    gained: f64,
}

/// How fast an operator's share changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AuthorityTimes {
    /// Between two steps (s).
    pub dt: f64,
    /// In which the share falls to 1/e at limits (s): what the joints need to brake.
    pub fall: f64,
    /// In which it rises from nothing to all (s): what they need to gain speed, or more.
    pub rise: f64,
}

impl OperatorAuthority {
    /// Nothing at first, all of it after a while without limits.
    ///
    /// # Errors
    /// Times that are not positive and finite.
    pub fn new(times: AuthorityTimes) -> Result<Self> {
        Error::check_positive("dt", times.dt)?;
        Error::check_positive("fall", times.fall)?;
        Error::check_positive("rise", times.rise)?;
        let kept = (-times.dt / times.fall).exp();
        Ok(Self { share: 0.0, kept, gained: times.dt / times.rise })
    }

    /// The share, in [0, 1].
    #[must_use]
    pub fn get(&self) -> f64 {
        self.share
    }

    /// Learns what became of the last step.
    pub fn update(&mut self, saturation: Saturation) {
        self.share = if saturation.direction_lost || saturation.scale < 1.0 {
            self.share * self.kept
        } else {
            (self.share + self.gained).min(1.0)
        };
    }
}
