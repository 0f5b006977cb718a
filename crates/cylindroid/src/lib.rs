//! `cylindroid` loads a robot or a mechanism, drives its end effector in Cartesian space, and
//! tells what it can do, in numbers that do not change when the frame does.
//!
//! Conventions, once for all: SI units and radians; twists and wrenches as vectors are linear
//! first (`[v; w]`, `[f; m]`); `world_from_tool` names a pose; a Jacobian always names its
//! [`Reference`]. The modules form one line, each imports only those before it:
//! `error, tolerance, scalar, linalg, spatial, inverse, model, kinematics, control`.

#![cfg_attr(test, allow(clippy::float_cmp_const))]

pub mod control;
pub mod error;
pub mod linalg;
pub mod model;
mod scalar;
pub mod spatial;
pub mod tolerance;

pub use error::{Error, FileError, Result};
pub use linalg::Matrix;
pub use model::{FrameId, Mechanism, catalogue, load};
pub use spatial::{Pose, Rotation, Twist, Vec3, Wrench};
