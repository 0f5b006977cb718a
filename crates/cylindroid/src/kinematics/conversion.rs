//! The velocity conversion matrix between two frames on one rigid body.
//!
//! Formula  bV_a = [[bRa, -bRa s(atb)], [0, bRa]], bRa: rotation of a seen from b, atb: origin of b
//!          in a, s(x) y = x cross y; the adjoint of `b_from_a`, in the notes' symbols
//! Shapes   6 x 6, linear first
//! Source   course notes on Cartesian control, 7.2.1 to 7.2.3
//! Checked  tests/it/kinematics.rs::jacobian_is_assembled_by_conversion

use crate::linalg::Matrix;
use crate::spatial::{Pose, Twist};

/// The matrix that turns a body's twist in frame a into its twist in frame b.
///
/// ```
/// use cylindroid::kinematics::velocity_conversion;
/// use cylindroid::{Pose, Vec3};
///
/// let v = velocity_conversion(Pose::from_translation(Vec3::X));
/// assert_eq!(v.column(5), [0.0, -1.0, 0.0, 0.0, 0.0, 1.0]); // a rotation about z
/// ```
#[must_use]
pub fn velocity_conversion(b_from_a: Pose) -> Matrix {
    let mut v = Matrix::zeros(6, 6);
    for j in 0..6 {
        let mut unit = [0.0; 6];
        unit[j] = 1.0;
        let converted = b_from_a.adjoint(Twist::from_array(unit));
        v.column_mut(j).copy_from_slice(&converted.to_array());
    }
    v
}
