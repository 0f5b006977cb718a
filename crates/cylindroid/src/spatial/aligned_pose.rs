//! Aligned pose: the columns of a pose padded to four numbers, one register each, as kernels hold
//! it.
//!
//! Shapes   x, y, z, p: the columns of the rotation and the translation; the fourth number is 0
//! Checked  src/kinematics/forward.rs::fused_and_plain_agree, tests/it/pinocchio.rs

use super::pose::Pose;
use super::rotation::Rotation;
use super::vec3::{Mat3, Vec3};

/// A pose `a_from_b`, padded.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(32))]
pub(crate) struct AlignedPose {
    pub(crate) x: [f64; 4],
    pub(crate) y: [f64; 4],
    pub(crate) z: [f64; 4],
    pub(crate) p: [f64; 4],
}

impl AlignedPose {
    /// Frame b is frame a.
    pub(crate) const IDENTITY: Self = Self {
        x: [1.0, 0.0, 0.0, 0.0],
        y: [0.0, 1.0, 0.0, 0.0],
        z: [0.0, 0.0, 1.0, 0.0],
        p: [0.0; 4],
    };

    /// The axes of b in a.
    #[inline]
    pub(crate) fn axes(&self) -> [Vec3; 3] {
        [xyz(&self.x), xyz(&self.y), xyz(&self.z)]
    }

    /// Axis z of b in a.
    #[inline]
    pub(crate) fn z_axis(&self) -> Vec3 {
        xyz(&self.z)
    }

    /// Origin of b in a.
    #[inline]
    pub(crate) fn translation(&self) -> Vec3 {
        xyz(&self.p)
    }

    /// The same as a pose.
    #[inline]
    pub(crate) fn pose(&self) -> Pose {
        let [x, y, z] = self.axes();
        Pose {
            rotation: Rotation::assume(Mat3::from_cols(x, y, z)),
            translation: self.translation(),
        }
    }
}

impl From<Pose> for AlignedPose {
    fn from(pose: Pose) -> Self {
        let pad = |v: Vec3| [v.x, v.y, v.z, 0.0];
        let [x, y, z] = pose.rotation.matrix().cols;
        Self { x: pad(x), y: pad(y), z: pad(z), p: pad(pose.translation) }
    }
}

#[inline(always)]
fn xyz(c: &[f64; 4]) -> Vec3 {
    Vec3::new(c[0], c[1], c[2])
}
