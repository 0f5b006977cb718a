//! `cylindroid` loads a robot or a mechanism, drives its end effector in Cartesian space, and
//! tells what it can do, in numbers that do not change when the frame does.
//!
//! ```
//! use cylindroid::{catalogue, ReferenceFrame};
//!
//! let robot = catalogue::load("panda")?;
//! let state = robot.state(robot.home())?;
//! let world_from_tool = state.pose(robot.tool());
//! let jacobian = state.jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned);
//! assert_eq!((jacobian.rows(), jacobian.cols()), (6, 7));
//! # assert!(world_from_tool.translation.x > 0.3);
//! # Ok::<(), cylindroid::Error>(())
//! ```
//!
//! Conventions, once for all: SI units and radians; twists and wrenches as vectors are linear
//! first (`[v; w]`, `[f; m]`); `world_from_tool` names a pose; a Jacobian always names its
//! [`ReferenceFrame`]. The modules form one line, each imports only those before it:
//! `error, tolerance, scalar, linalg, spatial, screws, inverse, model, kinematics, closure,
//! manipulability, ik, control`.

#![cfg_attr(test, allow(clippy::float_cmp_const))]

pub mod closure;
pub mod control;
pub mod error;
pub mod ik;
pub mod inverse;
pub mod kinematics;
pub mod linalg;
pub mod manipulability;
pub mod model;
mod scalar;
pub mod screws;
pub mod spatial;
pub mod tolerance;

pub use control::{Servo, ServoOptions};
pub use error::{Error, FileError, Result};
pub use inverse::{Inverse, Method};
pub use kinematics::{EndEffector, ReferenceFrame, State};
pub use linalg::Matrix;
pub use model::{FrameId, Mechanism};
#[cfg(feature = "formats")]
pub use model::{catalogue, load};
pub use screws::{Screw, ScrewSystem};
pub use spatial::{Pose, Rotation, Twist, Vec3, Wrench};

/// The code of the README and of the book is compiled and run.
#[cfg(doctest)]
mod book {
    macro_rules! pages {
        ($($name:ident $path:literal)*) => { $(#[doc = include_str!($path)] struct $name;)* };
    }
    pages! {
        Readme "../../../README.md"
        ConceptsFrames "../../../docs/concepts/frames.md"
        ConceptsRanks "../../../docs/concepts/ranks.md"
        GuideAssembly "../../../docs/guide/assembly.md"
        GuideControl "../../../docs/guide/control.md"
        GuideGrasps "../../../docs/guide/grasps.md"
        GuideInverseKinematics "../../../docs/guide/inverse-kinematics.md"
        GuideInverses "../../../docs/guide/inverses.md"
        GuideKinematics "../../../docs/guide/kinematics.md"
        GuideLoading "../../../docs/guide/loading.md"
        GuideManipulability "../../../docs/guide/manipulability.md"
        GuideMobility "../../../docs/guide/mobility.md"
        GuideScrews "../../../docs/guide/screws.md"
        GuideStatics "../../../docs/guide/statics.md"
        StartRust "../../../docs/start/rust.md"
    }
}
