//! Analytical Jacobians: rates of position and Euler angles instead of a twist.
//!
//! Formula  [dp/dt; dphi/dt] = [J_v; E(phi)^-1 J_w] qd, omega = E(phi) dphi/dt
//! Shapes   6 x n, world axes
//! Units    m/s and rad/s
//! Valid    det E: cos(pitch) for rpy, -sin(beta) for zyz, cos(beta) for xyz, never zero for the rotation
//!          vector.
//!          Where |det E| <= `tolerance::ANGLE_SINGULAR` no angle rates produce some angular
//!          velocities: `exists` is false and the angle rows hold the least-squares rates.
//! Source   Siciliano et al. 2009, section 3.6
//! Checked  tests/it/kinematics.rs::analytical_*

use crate::inverse::truncated;
use crate::linalg::Matrix;
use crate::spatial::{Mat3, Pose, Rpy, Vec3, Xyz, Zyz, rotation_log_derivative};
use crate::tolerance::ANGLE_SINGULAR;

/// The orientation coordinates whose rates replace the angular velocity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum OrientationRates {
    /// Roll, pitch, yaw about fixed x, y, z.
    Rpy,
    /// Euler angles about z, y, z.
    Zyz,
    /// Euler angles about x, y, z.
    Xyz,
    /// The rotation vector (axis times angle in [0, pi]).
    RotationVector,
}

/// An analytical Jacobian: rates of position and of orientation coordinates, and its existence at
/// this configuration.
///
/// ```text
/// [dp/dt; dphi/dt] = [J_v; E(phi)^-1 J_w] qd,   omega = E(phi) dphi/dt
/// ```
///
/// 6 x n, world axes, m/s and rad/s. det E is cos(pitch) for roll, pitch, yaw, -sin(beta) for z, y,
/// z angles, cos(beta) for x, y, z angles, and never zero for the rotation vector. Where E is singular, the rows of the angles
/// are least-squares rates.
///
/// Source: Siciliano et al. 2009, section 3.6.
#[doc(alias = "analytical Jacobian")]
#[doc(alias = "Euler rates")]
#[derive(Debug, Clone, PartialEq)]
pub struct AnalyticalJacobian {
    /// Rows: x, y, z of the position, then the three angles; n columns.
    pub matrix: Matrix,
    /// Determinant of the map from angle rates to angular velocity.
    pub determinant: f64,
    /// False at the representation's own singularity (gimbal lock).
    pub exists: bool,
}

pub(super) fn analytical(
    world_from_tool: Pose,
    jacobian: &Matrix,
    rates: OrientationRates,
) -> AnalyticalJacobian {
    let rotation = world_from_tool.rotation;
    let (rates_from_omega, determinant) = match rates {
        OrientationRates::Rpy => inverse3(Rpy::of(rotation).omega_from_rates()),
        OrientationRates::Zyz => inverse3(Zyz::of(rotation).omega_from_rates()),
        OrientationRates::Xyz => inverse3(Xyz::of(rotation).omega_from_rates()),
        OrientationRates::RotationVector => {
            let inverse = rotation_log_derivative(rotation.log());
            (inverse, 1.0 / inverse.determinant())
        }
    };
    let mut matrix = jacobian.clone();
    for j in 0..matrix.cols() {
        let column = matrix.column_mut(j);
        let omega = Vec3::new(column[3], column[4], column[5]);
        column[3..].copy_from_slice(&(rates_from_omega * omega).to_array());
    }
    AnalyticalJacobian { matrix, determinant, exists: determinant.abs() > ANGLE_SINGULAR }
}

/// The inverse, or the least-squares inverse where there is none, and the determinant.
fn inverse3(e: Mat3) -> (Mat3, f64) {
    let determinant = e.determinant();
    let [a, b, c] = e.cols;
    if determinant.abs() > ANGLE_SINGULAR {
        let rows = Mat3::from_cols(b.cross(c), c.cross(a), a.cross(b)).transpose();
        return (rows * (1.0 / determinant), determinant);
    }
    let rows = e.to_rows();
    let matrix = Matrix::from_fn(3, 3, |i, j| rows[i][j]);
    let inverse = truncated::of(&matrix, ANGLE_SINGULAR);
    let rows = [0, 1, 2].map(|i| [0, 1, 2].map(|j| inverse[(i, j)]));
    (Mat3::from_rows(rows), determinant)
}
