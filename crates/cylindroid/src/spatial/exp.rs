//! Exponential and logarithm of rigid displacements, and the derivatives of both.
//!
//! Formula  the pages of [`exp`], [`exp_derivative`] and their inverses;
//!          a..d, and the two coefficients of Q, in `series.rs`
//! Units    v in m, w in rad
//! Valid    exp everywhere; log on the whole group, |w| <= pi; D^-1 for |w| < 2 pi
//! Source   Barfoot, State Estimation for Robotics, 2017, eq. 7.85, 7.86 (Q)
//! Checked  tests/it/spatial.rs::exp_*, ::log_*, ::derivative*

use super::pose::Pose;
use super::rotation::Rotation;
use super::series::{cosc, cosc4, cotc, sinc3, sinc5};
use super::twist::Twist;
use super::vec3::{Mat3, Vec3};

/// A linear map of twists of the form `[R Q; 0 R]`, linear first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Derivative6 {
    /// The two equal diagonal blocks.
    pub diagonal: Mat3,
    /// The upper right block: linear from angular.
    pub coupling: Mat3,
}

impl Derivative6 {
    /// The image of a twist.
    ///
    /// ```
    /// use cylindroid::spatial::exp_derivative;
    /// use cylindroid::{Twist, Vec3};
    ///
    /// // At zero the derivative of the exponential is the identity.
    /// let step = Twist { linear: Vec3::X, angular: Vec3::Z };
    /// assert_eq!(exp_derivative(Twist::ZERO).apply(step), step);
    /// ```
    #[must_use]
    pub fn apply(&self, t: Twist) -> Twist {
        Twist {
            linear: self.diagonal * t.linear + self.coupling * t.angular,
            angular: self.diagonal * t.angular,
        }
    }
}

/// The exponential map: the displacement of the constant twist `x` in one second.
///
/// ```text
/// exp([v; w]) = (exp(w), V v),   V = 1 + (1 - cos t) / t^2 K + (t - sin t) / t^3 K^2
/// ```
///
/// K is the matrix of the vector product with w, and t its norm. v in m, w in rad; the pose is
/// `a_from_b`, the twist in the axes and at the origin of frame a.
///
/// ```
/// use cylindroid::spatial::{exp, log};
/// use cylindroid::{Twist, Vec3};
///
/// // A screw motion about z: the point moves on a helix.
/// let twist = Twist { linear: Vec3::Z, angular: Vec3::new(0.0, 0.0, 0.5) };
/// let pose = exp(twist);
/// assert!((pose.translation - Vec3::Z).norm() < 1e-15);
/// assert!((log(pose).angular - twist.angular).norm() < 1e-15);
/// ```
#[must_use]
pub fn exp(x: Twist) -> Pose {
    Pose {
        rotation: Rotation::exp(x.angular),
        translation: rotation_exp_derivative(x.angular) * x.linear,
    }
}

/// The logarithm: the twist that produces this displacement in one second, rotating by at most pi.
///
/// ```
/// use cylindroid::spatial::log;
/// use cylindroid::{Pose, Rotation, Vec3};
///
/// // A quarter turn about z, and 1 m along it.
/// let quarter = std::f64::consts::FRAC_PI_2;
/// let twist = log(Pose { rotation: Rotation::about_z(quarter), translation: Vec3::Z });
/// assert!((twist.angular - Vec3::Z * quarter).norm() < 1e-15);
/// assert!((twist.linear - Vec3::Z).norm() < 1e-15);
/// ```
#[must_use]
pub fn log(pose: Pose) -> Twist {
    let angular = pose.rotation.log();
    Twist { linear: rotation_log_derivative(angular) * pose.translation, angular }
}

impl Pose {
    /// The screw motion that takes this pose to `target` in one second, rotating by at most pi:
    /// its twist, in the axes of frame a, at the origin of this pose.
    ///
    /// Unlike [`Pose::error_to`] it is the motion of a body: the same whichever point of the body
    /// the two poses are of.
    ///
    /// ```
    /// use cylindroid::{Pose, Rotation, Vec3};
    /// let pose = Pose::from_translation(Vec3::X);
    /// let quarter = Pose::from_rotation(Rotation::exp(Vec3::Z * std::f64::consts::FRAC_PI_2));
    /// // About the origin, by which the pose is at radius 1 m.
    /// let twist = pose.screw_to(quarter * pose);
    /// assert!((twist.linear - Vec3::Y * std::f64::consts::FRAC_PI_2).norm() < 1e-15);
    /// ```
    #[must_use]
    pub fn screw_to(self, target: Self) -> Twist {
        let rotation = target.rotation * self.rotation.inverse();
        log(Self { rotation, translation: target.translation - self.translation })
    }
}

/// V: `d exp(w) = skew(V dw) exp(w)`, the left derivative of the rotation by the vector `w`.
///
/// ```
/// use cylindroid::spatial::rotation_exp_derivative;
/// use cylindroid::{Rotation, Vec3};
///
/// // exp(w + d) = exp(V d) exp(w), to first order in d.
/// let (w, d) = (Vec3::new(0.3, -0.2, 0.5), Vec3::new(1e-6, 2e-6, -1e-6));
/// let angular = (Rotation::exp(w + d) * Rotation::exp(w).inverse()).log();
/// assert!((rotation_exp_derivative(w) * d - angular).norm() < 1e-11);
/// ```
#[must_use]
pub fn rotation_exp_derivative(w: Vec3) -> Mat3 {
    let t = w.norm();
    let k = Mat3::skew(w);
    Mat3::IDENTITY + k * cosc(t) + (k * k) * sinc3(t)
}

/// V^-1: the rate of the rotation vector for an angular velocity; |w| < 2 pi.
///
/// ```
/// use cylindroid::spatial::{rotation_exp_derivative, rotation_log_derivative};
/// use cylindroid::Vec3;
///
/// let (w, d) = (Vec3::new(0.3, -0.2, 0.5), Vec3::X);
/// let again = rotation_log_derivative(w) * (rotation_exp_derivative(w) * d);
/// assert!((again - d).norm() < 1e-15);
/// ```
#[must_use]
pub fn rotation_log_derivative(w: Vec3) -> Mat3 {
    let k = Mat3::skew(w);
    Mat3::IDENTITY - k * 0.5 + (k * k) * cotc(w.norm())
}

/// D: `d exp(x) = (D dx)^ exp(x)`, in the axes and at the origin of frame a of `a_from_b`.
///
/// ```text
/// D = [V Q; 0 V],   V = rotation_exp_derivative(w)
/// ```
///
/// 6 x 6, linear part first; Q is that of Barfoot's eq. 7.86.
///
/// Source: Barfoot, State Estimation for Robotics, 2017, eqs. 7.85 and 7.86.
///
/// ```
/// use cylindroid::spatial::{exp, exp_derivative, log};
/// use cylindroid::{Twist, Vec3};
///
/// // exp(x + d) = exp(D d) exp(x), to first order in d.
/// let x = Twist { linear: Vec3::X, angular: Vec3::new(0.3, -0.2, 0.5) };
/// let d = Twist { linear: Vec3::Z * 1e-6, angular: Vec3::Y * 1e-6 };
/// let twist = log(exp(x + d) * exp(x).inverse());
/// assert!((exp_derivative(x).apply(d) - twist).linear.norm() < 1e-11);
/// ```
#[must_use]
pub fn exp_derivative(x: Twist) -> Derivative6 {
    Derivative6 { diagonal: rotation_exp_derivative(x.angular), coupling: coupling(x) }
}

/// D^-1: the rate of `log` for a twist in the axes and at the origin of frame a; |w| < 2 pi.
///
/// ```text
/// D^-1 = [V^-1, -V^-1 Q V^-1; 0, V^-1]
/// ```
///
/// ```
/// use cylindroid::spatial::{exp_derivative, log_derivative};
/// use cylindroid::{Twist, Vec3};
///
/// let x = Twist { linear: Vec3::X, angular: Vec3::new(0.3, -0.2, 0.5) };
/// let d = Twist { linear: Vec3::Y, angular: Vec3::Z };
/// let again = log_derivative(x).apply(exp_derivative(x).apply(d));
/// assert!((again - d).linear.norm() < 1e-15 && (again - d).angular.norm() < 1e-15);
/// ```
#[must_use]
pub fn log_derivative(x: Twist) -> Derivative6 {
    let inverse = rotation_log_derivative(x.angular);
    Derivative6 { diagonal: inverse, coupling: inverse * coupling(x) * inverse * -1.0 }
}

/// Q of Barfoot's eq. 7.86.
fn coupling(x: Twist) -> Mat3 {
    let t = x.angular.norm();
    let (p, r) = (Mat3::skew(x.angular), Mat3::skew(x.linear));
    let (pr, rp) = (p * r, r * p);
    let prp = pr * p;
    r * 0.5 + (pr + rp + prp) * sinc3(t)
        - (p * pr + rp * p - prp * 3.0) * cosc4(t)
        - (prp * p + p * prp) * (0.5 * (cosc4(t) - 3.0 * sinc5(t)))
}
