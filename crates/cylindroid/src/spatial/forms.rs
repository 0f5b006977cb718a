//! The invariant quadratic forms of twists and wrenches.
//!
//! Formula  <a, b>_h = 1/2 (v_a . w_b + w_a . v_b) - h w_a . w_b      (h finite)
//!          <a, b>_inf = -w_a . w_b = 1/4 Killing, Killing = tr(ad a ad b) = -4 w_a . w_b
//!          <a, b>_0 is the Klein form; <a, a>_h = 0 exactly for screws of pitch h
//!          on wrenches the inverse form: <a, b>*_h = 2 (f_a . m_b + m_a . f_b) + 4 h f_a . f_b
//! Shapes   as matrices 6 x 6 on vectors with the linear part first: Q_h = [[0, 1/2], [1/2, -h]]
//! Units    h in m/rad; `f64::INFINITY` (of either sign) names the form at infinity
//! Valid    unchanged when both arguments move by one adjoint (coadjoint for wrenches): se(3) has
//!          no other invariant forms, and no invariant inner product
//! Source   Donelan & Selig, Hyperbolic pseudoinverses, section 2.1 (which writes the angular part
//!          first, and has Killing's factor as 1/2: that of so(3))
//! Checked  tests/it/screws/forms.rs

use super::twist::{Twist, Wrench};
use super::vec3::Vec3;

impl Twist {
    /// The form of pitch `h` (m/rad) of two twists in one frame [m rad/s^2; rad^2/s^2 for an
    /// infinite pitch].
    ///
    /// ```text
    /// <a, b>_h = 1/2 (v_a . w_b + w_a . v_b) - h w_a . w_b,   <a, b>_inf = -w_a . w_b
    /// ```
    ///
    /// Source: Donelan & Selig, section 2.1.
    ///
    /// ```
    /// use cylindroid::{Twist, Vec3};
    ///
    /// // A screw of pitch 0.2 m/rad is isotropic in the form of its pitch.
    /// let screw = Twist { linear: Vec3::Z * 0.2, angular: Vec3::Z };
    /// assert!(screw.pitch_form(screw, 0.2).abs() < 1e-15);
    /// ```
    #[must_use]
    #[inline]
    pub fn pitch_form(self, other: Self, h: f64) -> f64 {
        if h.is_infinite() {
            return -self.angular.dot(other.angular);
        }
        self.klein(other) - h * self.angular.dot(other.angular)
    }

    /// The Klein form: the form of pitch zero. Two twists are reciprocal when it vanishes: a
    /// wrench on the one screw does no work on the other.
    ///
    /// ```text
    /// <a, b>_0 = 1/2 (v_a . w_b + w_a . v_b)
    /// ```
    ///
    /// ```
    /// use cylindroid::{Twist, Vec3};
    ///
    /// // Two rotations about axes that intersect are reciprocal.
    /// let a = Twist { linear: Vec3::ZERO, angular: Vec3::Z };
    /// let b = Twist { linear: Vec3::ZERO, angular: Vec3::X };
    /// assert_eq!(a.klein(b), 0.0);
    /// ```
    #[must_use]
    #[inline]
    pub fn klein(self, other: Self) -> f64 {
        0.5 * (self.linear.dot(other.angular) + self.angular.dot(other.linear))
    }

    /// The Killing form `tr(ad(self) ad(other))` [rad^2/s^2].
    ///
    /// ```
    /// use cylindroid::{Twist, Vec3};
    ///
    /// let rotation = Twist { linear: Vec3::ZERO, angular: Vec3::Z };
    /// assert_eq!(rotation.killing(rotation), -4.0);
    /// ```
    #[must_use]
    pub fn killing(self, other: Self) -> f64 {
        -4.0 * self.angular.dot(other.angular)
    }

    /// `Q_h self` as the wrench whose power with any twist is the form of pitch `h` with it.
    ///
    /// ```
    /// use cylindroid::{Twist, Vec3};
    ///
    /// let a = Twist { linear: Vec3::X, angular: Vec3::Z };
    /// let b = Twist { linear: Vec3::Y, angular: Vec3::new(0.5, 0.0, 0.5) };
    /// assert_eq!(b.power(a.lowered(0.2)), a.pitch_form(b, 0.2));
    /// ```
    #[must_use]
    #[inline]
    pub fn lowered(self, h: f64) -> Wrench {
        if h.is_infinite() {
            return Wrench { force: Vec3::ZERO, moment: -self.angular };
        }
        Wrench { force: self.angular * 0.5, moment: self.linear * 0.5 - self.angular * h }
    }
}

impl Wrench {
    /// The inverse of the form of pitch `h` on wrenches of one frame. For an infinite pitch the
    /// form has no inverse; its limit is `f_a . f_b`.
    ///
    /// ```text
    /// <a, b>*_h = 2 (f_a . m_b + m_a . f_b) + 4 h f_a . f_b
    /// ```
    ///
    /// ```
    /// use cylindroid::{Vec3, Wrench};
    ///
    /// // A force along z with a moment of -0.2 N m per N vanishes in the form of pitch 0.2 m/rad.
    /// let wrench = Wrench { force: Vec3::Z, moment: Vec3::Z * -0.2 };
    /// assert!(wrench.pitch_form(wrench, 0.2).abs() < 1e-15);
    /// ```
    #[must_use]
    #[inline]
    pub fn pitch_form(self, other: Self, h: f64) -> f64 {
        if h.is_infinite() {
            return self.force.dot(other.force);
        }
        2.0 * (self.force.dot(other.moment) + self.moment.dot(other.force))
            + 4.0 * h * self.force.dot(other.force)
    }

    /// `Q_h^-1 self`: the twist that [`Twist::lowered`] takes to this wrench, for a finite pitch.
    ///
    /// ```
    /// use cylindroid::{Twist, Vec3};
    ///
    /// let twist = Twist { linear: Vec3::X, angular: Vec3::Z };
    /// assert_eq!(twist.lowered(0.2).raised(0.2), twist);
    /// ```
    #[must_use]
    #[inline]
    pub fn raised(self, h: f64) -> Twist {
        Twist { linear: self.moment * 2.0 + self.force * (4.0 * h), angular: self.force * 2.0 }
    }
}
