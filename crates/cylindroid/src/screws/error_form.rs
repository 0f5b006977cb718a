//! The error form of a twist: the pitch form of the part that a hyperbolic pseudoinverse discards,
//! and the pitches at which it vanishes.
//!
//! Formula  Phi_h = (s - P_h s)^T Q_h (s - P_h s) = <s, s>_h - <P_h s, s>_h, the stationary value of
//!          (s - J x)^T Q_h (s - J x) over x, reached at x = J+h s
//!          = det([J s]^T Q_h [J s]) / det(J^T Q_h J) for independent columns of J (the Schur
//!          complement of the Gram matrix): its zeros are the principal pitches of the screw system
//!          spanned by J and s, without those at which J has no inverse
//! Shapes   one twist; at most three zeros
//! Units    h in m/rad; Phi_h in m rad/s^2 (for an infinite pitch rad^2/s^2)
//! Frame    that of the system; the value does not depend on it
//! Valid    where the projector P_h exists. Zero for every h if s belongs to the system, and if
//!          together with it s spans a system without any inverse; the discarded part may then be
//!          non-zero, since the form is indefinite
//! Why so   the quotient of determinants turns the zeros into principal pitches, which do not lose
//!          digits as the roots of interpolated polynomials do
//! Source   Donelan & Selig, section 6.2, eqs. 24 and 25, example 4 (whose value belongs to 2 Q_h);
//!          the quotient and the zeros by principal pitches are not in the paper
//! Checked  tests/it/screws/error_form.rs, tests/it/screws/vectors/examples.rs::examples_1_and_4

use super::span_estimation::ScrewOptions;
use super::system::ScrewSystem;
use crate::error::{Error, Result};
use crate::spatial::Twist;
use crate::tolerance::MAX_MAGNITUDE;

/// The pitches at which the error form of a twist vanishes, see [`ScrewSystem::error_form_zeros`].
#[derive(Debug, Clone, PartialEq)]
pub enum ErrorFormZeros {
    /// At these pitches [m/rad], largest first; of an inverse that exists there.
    At(Vec<f64>),
    /// At every pitch at which the inverse exists.
    Everywhere,
    /// The form is defined for no pitch: the system has no hyperbolic pseudoinverse.
    Undefined,
}

impl ScrewSystem {
    /// The error form of a twist: the pitch form of the part that the hyperbolic pseudoinverse of
    /// pitch `h` discards; `None` where the inverse does not exist.
    ///
    /// ```text
    /// Phi_h = (s - P_h s)^T Q_h (s - P_h s),   P_h = J J+h
    /// ```
    ///
    /// `twist` is in the frame of the system, `h` in m/rad; the value is in m rad/s^2 (for an
    /// infinite pitch in rad^2/s^2) and the same in every frame. J+h s makes the form stationary
    /// among all joint velocities, minimal only below the smallest principal pitch of a system of
    /// class IA, IIA or alike (order three or less, no translations).
    ///
    /// Source: Donelan & Selig, eq. 24; their example 4 is without the 1/2 of Q_h.
    ///
    /// ```
    /// use cylindroid::screws::{Line, ScrewOptions, ScrewSystem};
    /// use cylindroid::{Twist, Vec3};
    ///
    /// // A rotation about z realises the rotation of a screw; its translation is the error.
    /// let revolute = Line { point: Vec3::ZERO, direction: Vec3::Z };
    /// let system = ScrewSystem::of(&[revolute.twist()], &ScrewOptions::default())?;
    /// let twist = Twist { linear: Vec3::X * 0.3, angular: Vec3::X };
    /// assert!((system.error_form(twist, 0.1).unwrap() - 0.2).abs() < 1e-15);
    /// assert!(system.error_form(twist, 0.0).is_none()); // the pitch of the joint
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn error_form(&self, twist: Twist, h: f64) -> Option<f64> {
        let rest = self.projector(h)?.rest(twist);
        Some(rest.pitch_form(rest, h))
    }

    /// The pitches at which the error form of a twist vanishes: there the hyperbolic pseudoinverse
    /// discards a screw of its own pitch (or nothing).
    ///
    /// ```text
    /// Phi_h = det([J s]^T Q_h [J s]) / det(J^T Q_h J)   for independent columns of J
    /// ```
    ///
    /// The zeros [m/rad] are the principal pitches of the system spanned by J and s, without those
    /// of J. They depend on the twist: a pitch that annuls the error of one twist does so for no
    /// other in general.
    ///
    /// Source: Donelan & Selig, example 4; the quotient is not in the paper.
    ///
    /// ```
    /// use cylindroid::screws::{ErrorFormZeros, Line, ScrewOptions, ScrewSystem};
    /// use cylindroid::{Twist, Vec3};
    ///
    /// let revolute = Line { point: Vec3::ZERO, direction: Vec3::Z };
    /// let system = ScrewSystem::of(&[revolute.twist()], &ScrewOptions::default())?;
    /// let twist = Twist { linear: Vec3::X * 0.3, angular: Vec3::X };
    /// let ErrorFormZeros::At(zeros) = system.error_form_zeros(twist)? else { panic!() };
    /// assert!(zeros.len() == 1 && (zeros[0] - 0.3).abs() < 1e-15);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A twist with non-finite entries.
    pub fn error_form_zeros(&self, twist: Twist) -> Result<ErrorFormZeros> {
        Error::check_within("twist", &twist.to_array(), MAX_MAGNITUDE)?;
        if self.class().never_invertible() {
            return Ok(ErrorFormZeros::Undefined);
        }
        let center = Some(self.center());
        let options = ScrewOptions { center, ..ScrewOptions::with_length(self.length()) };
        let both = self.sum(&Self::of(&[twist], &options)?);
        if both.order() == self.order() || both.class().never_invertible() {
            return Ok(ErrorFormZeros::Everywhere);
        }
        let mut zeros = both.principal_pitches();
        zeros.retain(|h| self.existence(*h).exists);
        zeros.sort_by(|a, b| b.total_cmp(a));
        zeros.dedup();
        Ok(ErrorFormZeros::At(zeros))
    }
}
