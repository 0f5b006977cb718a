//! Poses: rigid displacements `a_from_b`.
//!
//! Formula  p_a = R p_b + t; twist: [R v + t x R w; R w] (adjoint);
//!          wrench: [R f; R m + t x R f] (coadjoint)
//! Why so   the coadjoint is the inverse transpose of the adjoint, so power is invariant; moving
//!          wrenches by the adjoint is the classical silent error
//! Checked  tests/it/spatial.rs::power_is_invariant, ::adjoint_*

use std::ops::Mul;

use super::rotation::Rotation;
use super::twist::{Twist, Wrench};
use super::vec3::{Mat3, Vec3};
use crate::error::{Error, Result};

/// The pose of frame b seen from frame a: `a_from_b`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// The axes of b in a.
    pub rotation: Rotation,
    /// The origin of b in a (m).
    pub translation: Vec3,
}

impl Pose {
    /// Frame b is frame a.
    pub const IDENTITY: Self = Self { rotation: Rotation::IDENTITY, translation: Vec3::ZERO };

    /// A pose without rotation.
    #[must_use]
    pub const fn from_translation(translation: Vec3) -> Self {
        Self { rotation: Rotation::IDENTITY, translation }
    }

    /// A pose without translation.
    #[must_use]
    pub const fn from_rotation(rotation: Rotation) -> Self {
        Self { rotation, translation: Vec3::ZERO }
    }

    /// From the rows of the 4 x 4 matrix.
    ///
    /// # Errors
    /// A non-finite matrix, whose rotation part is not a rotation, or whose last row is
    /// not 0 0 0 1.
    pub fn from_matrix(m: [[f64; 4]; 4]) -> Result<Self> {
        Error::check_finite("pose matrix", m.as_flattened())?;
        if m[3] != [0.0, 0.0, 0.0, 1.0] {
            return Err(Error::InvalidOption {
                option: "pose matrix",
                value: format!("last row {:?}", m[3]),
                reason: "the last row of a pose is 0 0 0 1; is the matrix transposed?".to_owned(),
            });
        }
        let rotation = Mat3::from_rows([0, 1, 2].map(|i: usize| [m[i][0], m[i][1], m[i][2]]));
        Ok(Self {
            rotation: Rotation::from_matrix(rotation)?,
            translation: Vec3::new(m[0][3], m[1][3], m[2][3]),
        })
    }

    /// The rows of the 4 x 4 matrix.
    #[must_use]
    pub fn to_matrix(self) -> [[f64; 4]; 4] {
        let r = self.rotation.matrix().to_rows();
        let t = self.translation.to_array();
        let row = |i: usize| [r[i][0], r[i][1], r[i][2], t[i]];
        [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
    }

    /// `b_from_a`.
    #[must_use]
    pub fn inverse(self) -> Self {
        let rotation = self.rotation.inverse();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// The adjoint: a twist in frame b, seen from frame a.
    #[must_use]
    #[inline]
    pub fn adjoint(self, twist: Twist) -> Twist {
        let angular = self.rotation * twist.angular;
        Twist { linear: self.rotation * twist.linear + self.translation.cross(angular), angular }
    }

    /// The coadjoint: a wrench in frame b, seen from frame a.
    #[must_use]
    pub fn coadjoint(self, wrench: Wrench) -> Wrench {
        let force = self.rotation * wrench.force;
        Wrench { force, moment: self.rotation * wrench.moment + self.translation.cross(force) }
    }

    /// The error that a controller closes, in the axes of frame a: the translation from this pose
    /// to `target` (m) and the rotation vector from this orientation to the target's (rad).
    #[must_use]
    pub fn error_to(self, target: Self) -> Twist {
        Twist {
            linear: target.translation - self.translation,
            angular: (target.rotation * self.rotation.inverse()).log(),
        }
    }

    /// True if no entry is NaN or infinite.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.rotation.matrix().is_finite() && self.translation.is_finite()
    }
}

/// `a_from_b * b_from_c = a_from_c`
impl Mul for Pose {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        Self {
            rotation: self.rotation * o.rotation,
            translation: self.rotation * o.translation + self.translation,
        }
    }
}

/// The point with coordinates `p` in frame b, in frame a.
impl Mul<Vec3> for Pose {
    type Output = Vec3;
    #[inline]
    fn mul(self, p: Vec3) -> Vec3 {
        self.rotation * p + self.translation
    }
}
