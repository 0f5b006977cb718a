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
use crate::tolerance::MAX_MAGNITUDE;

/// The pose of frame b relative to frame a: `a_from_b`.
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
    ///
    /// ```
    /// use cylindroid::{Pose, Rotation, Vec3};
    ///
    /// // 0.5 m along x, then a rotation about the z axis there.
    /// let turn = Pose::from_rotation(Rotation::about_z(0.3));
    /// let pose = Pose::from_translation(Vec3::X * 0.5) * turn;
    /// assert_eq!(pose.translation, Vec3::X * 0.5);
    /// assert_eq!(pose.rotation, Rotation::about_z(0.3));
    /// ```
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
    /// ```
    /// use cylindroid::{Pose, Vec3};
    ///
    /// let mut rows = Pose::IDENTITY.to_matrix();
    /// (rows[0][3], rows[2][3]) = (0.5, 0.2);
    /// let world_from_tool = Pose::from_matrix(rows)?;
    /// assert_eq!(world_from_tool.translation, Vec3::new(0.5, 0.0, 0.2));
    /// assert_eq!(world_from_tool.to_matrix(), rows);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A non-finite matrix, whose rotation part is not a rotation, or whose last row is
    /// not 0 0 0 1.
    pub fn from_matrix(m: [[f64; 4]; 4]) -> Result<Self> {
        Error::check_within("pose matrix", m.as_flattened(), MAX_MAGNITUDE)?;
        if m[3] != [0.0, 0.0, 0.0, 1.0] {
            return Err(Error::InvalidOption {
                option: "pose matrix",
                value: format!("last row {:?}", m[3]),
                reason: "the last row of a pose must be 0 0 0 1; is the matrix transposed?"
                    .to_owned(),
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
    ///
    /// ```
    /// use cylindroid::{Pose, Rotation, Vec3};
    ///
    /// let a_from_b = Pose { rotation: Rotation::about_z(0.3), translation: Vec3::X };
    /// let point = Vec3::new(0.1, 0.2, 0.3);
    /// assert!((a_from_b.inverse() * (a_from_b * point) - point).norm() < 1e-15);
    /// ```
    #[must_use]
    pub fn inverse(self) -> Self {
        let rotation = self.rotation.inverse();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// The adjoint: expresses a twist of frame b in frame a.
    ///
    /// ```text
    /// [v; w] -> [R v + t x R w; R w]
    /// ```
    ///
    /// ```
    /// use cylindroid::{Pose, Twist, Vec3};
    ///
    /// // A rotation about the z axis of b, whose origin is 2 m along x.
    /// let a_from_b = Pose::from_translation(Vec3::new(2.0, 0.0, 0.0));
    /// let in_a = a_from_b.adjoint(Twist { linear: Vec3::ZERO, angular: Vec3::Z });
    /// assert_eq!(in_a, Twist { linear: Vec3::new(0.0, -2.0, 0.0), angular: Vec3::Z });
    /// ```
    #[doc(alias = "twist transformation")]
    #[must_use]
    #[inline]
    pub fn adjoint(self, twist: Twist) -> Twist {
        let angular = self.rotation * twist.angular;
        Twist { linear: self.rotation * twist.linear + self.translation.cross(angular), angular }
    }

    /// The coadjoint: expresses a wrench of frame b in frame a.
    ///
    /// ```text
    /// [f; m] -> [R f; R m + t x R f]
    /// ```
    ///
    /// ```
    /// use cylindroid::{Pose, Twist, Vec3, Wrench};
    ///
    /// let a_from_b = Pose::from_translation(Vec3::new(2.0, 0.0, 0.0));
    /// let wrench = Wrench { force: Vec3::Y, moment: Vec3::ZERO };
    /// let twist = Twist { linear: Vec3::Y, angular: Vec3::Z };
    /// assert_eq!(a_from_b.coadjoint(wrench).moment, Vec3::new(0.0, 0.0, 2.0));
    /// // Power is the same in both frames.
    /// let power = a_from_b.adjoint(twist).power(a_from_b.coadjoint(wrench));
    /// assert!((power - twist.power(wrench)).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn coadjoint(self, wrench: Wrench) -> Wrench {
        let force = self.rotation * wrench.force;
        Wrench { force, moment: self.rotation * wrench.moment + self.translation.cross(force) }
    }

    /// The pose error of a controller, in the axes of frame a: the translation from this pose
    /// to `target` (m) and the rotation vector from this orientation to the target's (rad).
    ///
    /// ```
    /// use cylindroid::{Pose, Rotation, Vec3};
    ///
    /// let rotation = Rotation::about_z(0.2);
    /// let target = Pose { rotation, translation: Vec3::new(0.1, 0.0, 0.0) };
    /// let error = Pose::IDENTITY.error_to(target);
    /// assert_eq!(error.linear, Vec3::new(0.1, 0.0, 0.0));
    /// assert!((error.angular - Vec3::new(0.0, 0.0, 0.2)).norm() < 1e-15);
    /// ```
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
