//! Poses, twists and wrenches as distinct types, and the maps between them.
//!
//! Power is the only product of a twist and a wrench. Twists move between frames by the adjoint,
//! wrenches by the coadjoint, so that power is the same in every frame. `a_from_b` names the pose
//! that takes coordinates in frame b to coordinates in frame a.

mod aligned_pose;
mod angles;
mod exp;
mod forms;
mod pose;
mod quaternion;
mod rotation;
mod series;
mod twist;
mod vec3;
mod vector3_like;

pub(crate) use aligned_pose::AlignedPose;
pub use angles::{Rpy, Xyz, Zyz};
pub use exp::{
    Derivative6, exp, exp_derivative, log, log_derivative, rotation_exp_derivative,
    rotation_log_derivative,
};
pub use pose::Pose;
pub use quaternion::Quaternion;
pub use rotation::Rotation;
pub use twist::{Twist, Wrench};
pub use vec3::{Mat3, Vec3};
#[cfg(target_arch = "x86_64")]
pub(crate) use vector3_like::PackedVec3;
pub(crate) use vector3_like::{Columns, SingleVector3, Vector3Like, dot};
