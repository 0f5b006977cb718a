//! Euler angles of a rotation: roll-pitch-yaw, ZYZ and XYZ.
//!
//! Formula  the pages of [`Rpy`], [`Zyz`] and [`Xyz`].
//!          The first angle is read from its two entries, the last one from the rows of
//!          Rz(first)^T R, which cancels the rounding error of the first near gimbal lock.
//! Units    rad; pitch in [-pi/2, pi/2], beta in [0, pi]
//! Valid    everywhere; at gimbal lock (|pitch| = pi/2, beta = 0 or pi) only a sum of two angles
//!          is determined: the last one (roll, gamma) is set to zero where the entries are nothing
//!          but rounding (`tolerance::GIMBAL_LOCK`)
//! Source   URDF specification; Siciliano et al. 2009, section 2.4
//! Checked  tests/it/spatial.rs::angles_*

use super::rotation::Rotation;
use super::vec3::{Mat3, Vec3};
use crate::scalar::sin_cos;
use crate::tolerance::GIMBAL_LOCK;

/// Roll, pitch and yaw: about the fixed axes x, y, z in this order (rad).
///
/// ```text
/// R = Rz(yaw) Ry(pitch) Rx(roll)
/// ```
///
/// As in a URDF. At gimbal lock (|pitch| = pi/2) roll is zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rpy {
    /// About the fixed x axis.
    pub roll: f64,
    /// About the fixed y axis.
    pub pitch: f64,
    /// About the fixed z axis.
    pub yaw: f64,
}

/// ZYZ Euler angles: about z, the turned y, the turned z (rad).
///
/// ```text
/// R = Rz(alpha) Ry(beta) Rz(gamma)
/// ```
///
/// At gimbal lock (beta = 0 or pi) gamma is zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Zyz {
    /// First, about z.
    pub alpha: f64,
    /// Second, about the turned y.
    pub beta: f64,
    /// Third, about the turned z.
    pub gamma: f64,
}

/// XYZ Euler angles: about x, the turned y, the turned z (rad). The Robotics Toolbox calls them yaw,
/// pitch and roll of 'rpy/xyz'.
///
/// ```text
/// R = Rx(alpha) Ry(beta) Rz(gamma)
/// ```
///
/// At gimbal lock (|beta| = pi/2) gamma is zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Xyz {
    /// First, about x.
    pub alpha: f64,
    /// Second, about the turned y.
    pub beta: f64,
    /// Third, about the turned z.
    pub gamma: f64,
}

/// The half turn that exchanges x and z and turns y round.
fn exchange() -> Rotation {
    Rotation::assume(Mat3::from_cols(Vec3::Z, -Vec3::Y, Vec3::X))
}

impl Xyz {
    /// The same angles about the axes of [`Rpy`], after [`exchange`].
    fn exchanged(self) -> Rpy {
        Rpy { roll: self.gamma, pitch: -self.beta, yaw: self.alpha }
    }

    /// The rotation of these angles.
    #[must_use]
    pub fn rotation(self) -> Rotation {
        exchange() * self.exchanged().rotation() * exchange()
    }

    /// The angles of a rotation, beta in [-pi/2, pi/2].
    ///
    /// ```
    /// use cylindroid::spatial::{Rotation, Xyz};
    ///
    /// let angles = Xyz::of(Rotation::about_z(0.3));
    /// assert_eq!((angles.alpha, angles.beta), (0.0, 0.0));
    /// assert!((angles.gamma - 0.3).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn of(rotation: Rotation) -> Self {
        let Rpy { roll, pitch, yaw } = Rpy::of(exchange() * rotation * exchange());
        Self { alpha: yaw, beta: -pitch, gamma: roll }
    }

    /// `omega = E rates`: from (alpha, beta, gamma) rates to the angular velocity in the axes of
    /// frame a of `a_from_b`. det E = cos(beta).
    #[must_use]
    pub fn omega_from_rates(self) -> Mat3 {
        let ((sa, ca), (sb, cb)) = (sin_cos(self.alpha), sin_cos(self.beta));
        Mat3::from_cols(Vec3::X, Vec3::new(0.0, ca, sa), Vec3::new(sb, -sa * cb, ca * cb))
    }
}

impl Rpy {
    /// The rotation of these angles.
    #[must_use]
    pub fn rotation(self) -> Rotation {
        let ((sr, cr), (sp, cp), (sy, cy)) =
            (sin_cos(self.roll), sin_cos(self.pitch), sin_cos(self.yaw));
        Rotation::assume(Mat3::from_rows([
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]))
    }

    /// The angles of a rotation, pitch in [-pi/2, pi/2].
    ///
    /// ```
    /// use cylindroid::spatial::Rpy;
    ///
    /// let angles = Rpy { roll: 0.1, pitch: -0.2, yaw: 1.3 };
    /// let again = Rpy::of(angles.rotation());
    /// assert!((again.yaw - 1.3).abs() < 1e-15 && (again.pitch + 0.2).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn of(rotation: Rotation) -> Self {
        let m = rotation.matrix().to_rows();
        let cos_pitch = m[0][0].hypot(m[1][0]);
        let pitch = (-m[2][0]).atan2(cos_pitch);
        if cos_pitch < GIMBAL_LOCK {
            return Self { roll: 0.0, pitch, yaw: (-m[0][1]).atan2(m[1][1]) };
        }
        let yaw = m[1][0].atan2(m[0][0]);
        let (s, c) = sin_cos(yaw);
        let roll = (s * m[0][2] - c * m[1][2]).atan2(c * m[1][1] - s * m[0][1]);
        Self { roll, pitch, yaw }
    }

    /// `omega = E rates`: from (roll, pitch, yaw) rates to the angular velocity in the axes of
    /// frame a of `a_from_b`. det E = cos(pitch).
    #[must_use]
    pub fn omega_from_rates(self) -> Mat3 {
        let ((sp, cp), (sy, cy)) = (sin_cos(self.pitch), sin_cos(self.yaw));
        Mat3::from_cols(Vec3::new(cy * cp, sy * cp, -sp), Vec3::new(-sy, cy, 0.0), Vec3::Z)
    }
}

impl Zyz {
    /// The rotation of these angles.
    #[must_use]
    pub fn rotation(self) -> Rotation {
        let tilt = Rpy { roll: 0.0, pitch: self.beta, yaw: 0.0 }.rotation();
        Rotation::about_z(self.alpha) * tilt * Rotation::about_z(self.gamma)
    }

    /// The angles of a rotation, beta in [0, pi].
    #[must_use]
    pub fn of(rotation: Rotation) -> Self {
        let m = rotation.matrix().to_rows();
        let sin_beta = m[0][2].hypot(m[1][2]);
        let beta = sin_beta.atan2(m[2][2]);
        if sin_beta < GIMBAL_LOCK {
            // alpha + gamma (beta = 0) or alpha - gamma (beta = pi) is all that is determined.
            let sign = m[2][2].signum();
            return Self { alpha: (sign * m[1][0]).atan2(sign * m[0][0]), beta, gamma: 0.0 };
        }
        let alpha = m[1][2].atan2(m[0][2]);
        let (s, c) = sin_cos(alpha);
        let gamma = (c * m[1][0] - s * m[0][0]).atan2(c * m[1][1] - s * m[0][1]);
        Self { alpha, beta, gamma }
    }

    /// `omega = E rates`: from (alpha, beta, gamma) rates to the angular velocity in the axes of
    /// frame a of `a_from_b`. det E = -sin(beta).
    #[must_use]
    pub fn omega_from_rates(self) -> Mat3 {
        let ((sa, ca), (sb, cb)) = (sin_cos(self.alpha), sin_cos(self.beta));
        Mat3::from_cols(Vec3::Z, Vec3::new(-sa, ca, 0.0), Vec3::new(ca * sb, sa * sb, cb))
    }
}
