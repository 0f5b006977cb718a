//! Authority of an operator: the share of the operator's twist that an arm near its limits can
//! follow without losing the robot's part.
//!
//! Formula  the page of [`OperatorAuthority`]
//! Units    dt, fall, rise s; s [-]
//! Valid    any result of a step
//! Fails    never; but limits are met before s has fallen: while the joints of an arm brake, a tool
//!          may leave its surface by the distance that `an_arm_keeps_the_surface` prints
//! Why so   a servo scales a motion as a whole and, if no scale is feasible, changes its direction:
//!          the robot's part then suffers from the operator's. Removing the operator at once is no
//!          better: joints that must brake within their acceleration limits change the direction as
//!          well
//! Checked  tests/it/servo/shared.rs::an_arm_keeps_the_surface, ::the_authority_of_the_operator

use crate::control::solver::saturation::Saturation;
use crate::error::{Error, Result};

/// The share of the operator's twist to pass to [`SharedController`](super::SharedController).
///
/// ```text
/// s <- s exp(-dt / fall)         after a step that limits scaled or changed
/// s <- min(1, s + dt / rise)     after any other step,   s = 0 at the start
/// ```
///
/// Times in s; the share s has no unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OperatorAuthority {
    share: f64,
    kept: f64,
    gained: f64,
}

/// Time constants of an operator's authority.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AuthorityTimes {
    /// Time between two steps (s).
    pub dt: f64,
    /// Time in which the share falls to 1/e at limits (s): the braking time of the joints.
    pub fall: f64,
    /// Time in which it rises from 0 to 1 (s): the acceleration time of the joints, or more.
    pub rise: f64,
}

impl OperatorAuthority {
    /// Zero at first, one after `rise` seconds without active limits.
    ///
    /// ```
    /// use cylindroid::control::{AuthorityTimes, OperatorAuthority, Saturation};
    ///
    /// let times = AuthorityTimes { dt: 0.01, fall: 0.1, rise: 0.5 };
    /// let mut authority = OperatorAuthority::new(times)?;
    /// let free = Saturation { scale: 1.0, direction_lost: false };
    /// (0..60).for_each(|_| authority.update(free));
    /// assert_eq!(authority.get(), 1.0);
    /// authority.update(Saturation { scale: 0.5, direction_lost: false });
    /// assert!((authority.get() - (-0.1_f64).exp()).abs() < 1e-15);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
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

    /// Updates the share with the saturation of the last step.
    pub fn update(&mut self, saturation: Saturation) {
        self.share = if saturation.direction_lost || saturation.scale < 1.0 {
            self.share * self.kept
        } else {
            (self.share + self.gained).min(1.0)
        };
    }
}
