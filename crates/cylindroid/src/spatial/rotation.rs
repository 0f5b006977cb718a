//! Rotations as orthonormal matrices of determinant 1: exponential map, logarithm, axes.
//!
//! Formula  exp(r) = 1 + sin t K + 2 sin^2(t/2) K^2, K = skew(r / t), t = |r|
//!          log through the quaternion of largest component: r = 2 atan2(|v|, w) v / |v|
//! Units    r in rad: axis times angle, log's angle in [0, pi]
//! Valid    everywhere. At an angle of pi both axes are valid; the one whose first non-zero
//!          component is positive is returned. Never NaN for finite input.
//! Why so   the textbook logarithm, acos of the trace, loses half the digits at 0 and all at pi;
//!          the quaternion of largest component (Shepperd) loses none; its switch is for speed
//! Source   Shepperd 1978; Sola et al. 2018 (arXiv 1812.01537), eq. 132, 146
//! Checked  tests/it/spatial.rs

use std::ops::Mul;

use super::quaternion::Quaternion;
use super::series::atanc;
use super::vec3::{Mat3, Vec3};
use crate::error::{Error, Result};
use crate::scalar::sin_cos;
use crate::tolerance::{ORTHONORMAL, SMALL_TANGENT, ZERO_AXIS};

/// A rotation, `a_from_b`: its columns are the axes of frame b in frame a.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation {
    matrix: Mat3,
}

impl Rotation {
    /// No rotation.
    pub const IDENTITY: Self = Self { matrix: Mat3::IDENTITY };

    /// The rotation by the vector `r`: about `r`, by `|r|` rad.
    ///
    /// ```
    /// use cylindroid::{Rotation, Vec3};
    ///
    /// let quarter_turn = Rotation::exp(Vec3::new(0.0, 0.0, std::f64::consts::FRAC_PI_2));
    /// assert!((quarter_turn * Vec3::X - Vec3::Y).norm() < 1e-15);
    /// ```
    #[doc(alias = "Rodrigues")]
    #[must_use]
    pub fn exp(r: Vec3) -> Self {
        let t = r.norm();
        if t == f64::INFINITY && r.is_finite() {
            let quarter = Self::exp(r * 0.25); // the length is beyond all numbers
            return quarter * quarter * quarter * quarter;
        }
        // Without a direction: no rotation, or NaN from a vector that is not finite.
        Self::about_unit(r.unit(0.0).unwrap_or(r), t)
    }

    /// The rotation vector: axis times angle, angle in [0, pi] (rad).
    ///
    /// ```
    /// use cylindroid::{Rotation, Vec3};
    ///
    /// let r = Vec3::new(0.1, -0.4, 0.2);
    /// assert!((Rotation::exp(r).log() - r).norm() < 1e-15);
    /// ```
    #[must_use]
    pub fn log(self) -> Vec3 {
        let q = Quaternion::multiple_of_matrix(self.matrix);
        let v = Vec3::new(q.x, q.y, q.z);
        // |v| / w is the tangent of half the angle.
        let inverse = 1.0 / q.w;
        let square = v.dot(v) * inverse * inverse;
        let factor = if square < SMALL_TANGENT {
            2.0 * inverse * atanc(square)
        } else {
            let s = v.norm();
            2.0 * s.atan2(q.w) / s
        };
        v * factor
    }

    /// The rotation about `axis` (any length) by `angle` rad; `None` if the axis has no direction.
    ///
    /// ```
    /// use cylindroid::{Rotation, Vec3};
    ///
    /// let half_turn = Rotation::about(Vec3::new(0.0, 0.0, 3.0), std::f64::consts::PI).unwrap();
    /// assert!((half_turn * Vec3::X + Vec3::X).norm() < 1e-15);
    /// assert!(Rotation::about(Vec3::ZERO, 1.0).is_none());
    /// ```
    #[must_use]
    pub fn about(axis: Vec3, angle: f64) -> Option<Self> {
        Some(Self::about_unit(axis.unit(ZERO_AXIS)?, angle))
    }

    fn about_unit(n: Vec3, angle: f64) -> Self {
        let (sin, half) = (sin_cos(angle).0, sin_cos(0.5 * angle).0);
        let k = Mat3::skew(n);
        Self { matrix: Mat3::IDENTITY + k * sin + (k * k) * (2.0 * half * half) }
    }

    /// The rotation about z by `angle` rad.
    ///
    /// ```
    /// use cylindroid::{Rotation, Vec3};
    ///
    /// let quarter = Rotation::about_z(std::f64::consts::FRAC_PI_2);
    /// assert!((quarter * Vec3::X - Vec3::Y).norm() < 1e-15);
    /// ```
    #[must_use]
    pub fn about_z(angle: f64) -> Self {
        let (s, c) = sin_cos(angle);
        Self { matrix: Mat3::from_cols(Vec3::new(c, s, 0.0), Vec3::new(-s, c, 0.0), Vec3::Z) }
    }

    /// A rotation that takes z to the direction of `axis`: exact for the six coordinate axes.
    /// `None` if the axis has no direction.
    ///
    /// ```
    /// use cylindroid::{Rotation, Vec3};
    ///
    /// let rotation = Rotation::z_to(Vec3::new(1.0, 1.0, 0.0)).unwrap();
    /// assert!((rotation * Vec3::Z - (Vec3::X + Vec3::Y) * 0.5_f64.sqrt()).norm() < 1e-15);
    /// assert_eq!(Rotation::z_to(Vec3::ZERO), None);
    /// ```
    #[must_use]
    pub fn z_to(axis: Vec3) -> Option<Self> {
        let n = axis.unit(ZERO_AXIS)?;
        if n == Vec3::Z {
            return Some(Self::IDENTITY);
        }
        // The coordinate axis least along n gives the first column.
        let (ax, ay, az) = (n.x.abs(), n.y.abs(), n.z.abs());
        let other = if az <= ax && az <= ay {
            Vec3::Z
        } else if ay <= ax {
            Vec3::Y
        } else {
            Vec3::X
        };
        let x = (other - n * n.dot(other)).unit(0.0)?;
        Some(Self { matrix: Mat3::from_cols(x, n.cross(x), n) })
    }

    /// The rotation with this matrix, made exactly orthonormal.
    ///
    /// ```
    /// use cylindroid::Rotation;
    /// use cylindroid::spatial::Mat3;
    ///
    /// let half = Mat3::from_rows([[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]);
    /// assert!((Rotation::from_matrix(half)?.log().norm() - std::f64::consts::PI).abs() < 1e-15);
    /// assert!(Rotation::from_matrix(half * 2.0).is_err());
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A non-finite matrix, or farther from a rotation than `tolerance::ORTHONORMAL`.
    pub fn from_matrix(m: Mat3) -> Result<Self> {
        let error = (m.transpose() * m - Mat3::IDENTITY).max_abs();
        if error <= ORTHONORMAL && m.determinant() > 0.0 && m.is_finite() {
            return Ok(Self { matrix: m }.renormalised());
        }
        Err(Self::refused(m, error))
    }

    #[cold]
    fn refused(m: Mat3, error: f64) -> Error {
        if !m.is_finite() {
            return Error::NotFinite { what: "rotation matrix".into(), value: f64::NAN };
        }
        Error::InvalidOption {
            option: "rotation matrix",
            value: format!("{:?}", m.to_rows()),
            reason: format!(
                "its columns must be orthonormal and right-handed; R^T R differs from 1 by \
                 {error:.1e} and det R = {:.6}",
                m.determinant()
            ),
        }
    }

    /// Trusts the caller that `m` is a rotation (checked in debug builds).
    #[must_use]
    #[inline]
    pub(crate) fn assume(m: Mat3) -> Self {
        debug_assert!(
            !m.is_finite() || (m.transpose() * m - Mat3::IDENTITY).max_abs() < 1e-9,
            "not a rotation: {m:?}"
        );
        Self { matrix: m }
    }

    /// The 3 x 3 matrix.
    #[must_use]
    #[inline]
    pub fn matrix(self) -> Mat3 {
        self.matrix
    }

    /// The inverse rotation.
    #[must_use]
    pub fn inverse(self) -> Self {
        Self { matrix: self.matrix.transpose() }
    }

    /// Axis x of frame b in frame a.
    #[must_use]
    pub fn x_axis(self) -> Vec3 {
        self.matrix.cols[0]
    }

    /// Axis y of frame b in frame a.
    #[must_use]
    pub fn y_axis(self) -> Vec3 {
        self.matrix.cols[1]
    }

    /// Axis z of frame b in frame a.
    #[must_use]
    #[inline]
    pub fn z_axis(self) -> Vec3 {
        self.matrix.cols[2]
    }

    /// The angle between two rotations, in [0, pi] rad.
    ///
    /// ```
    /// use cylindroid::Rotation;
    ///
    /// let angle = Rotation::about_z(0.1).angle_to(Rotation::about_z(0.4));
    /// assert!((angle - 0.3).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn angle_to(self, other: Self) -> f64 {
        (self.inverse() * other).log().norm()
    }

    /// The unit quaternion with `w >= 0`.
    #[must_use]
    pub fn to_quaternion(self) -> Quaternion {
        Quaternion::of_matrix(self.matrix)
    }

    /// The same rotation with the rounding of many products removed (one Newton step).
    #[must_use]
    pub fn renormalised(self) -> Self {
        let mut m = self.matrix;
        // Two steps: from 1e-5 (six printed digits) to 1e-10 to rounding.
        for _ in 0..2 {
            m = m * (Mat3::IDENTITY * 3.0 - m.transpose() * m) * 0.5;
        }
        Self { matrix: m }
    }
}

impl Default for Rotation {
    fn default() -> Self {
        Self::IDENTITY
    }
}

/// `a_from_b * b_from_c = a_from_c`
impl Mul for Rotation {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        Self { matrix: self.matrix * o.matrix }
    }
}

impl Mul<Vec3> for Rotation {
    type Output = Vec3;
    #[inline]
    fn mul(self, v: Vec3) -> Vec3 {
        self.matrix * v
    }
}

impl Quaternion {
    /// The rotation of this quaternion, which may have any length but zero.
    ///
    /// # Errors
    /// A zero or non-finite quaternion.
    pub fn rotation(self) -> Result<Rotation> {
        let Self { w, x, y, z } = self;
        let norm = w.hypot(x).hypot(y).hypot(z);
        if !(norm > 0.0 && norm.is_finite()) {
            return Err(Error::InvalidOption {
                option: "quaternion",
                value: format!("({w}, {x}, {y}, {z})"),
                reason: "it must be finite and not zero".to_owned(),
            });
        }
        let (w, x, y, z) = (w / norm, x / norm, y / norm, z / norm);
        Ok(Rotation::assume(Mat3::from_rows([
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ])))
    }
}
