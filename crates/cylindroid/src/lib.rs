//! Kinematics, Cartesian control, screw systems and closed chains of robots and mechanisms, with
//! results that are independent of the chosen reference frame.
//!
//! ```
//! use cylindroid::{catalogue, ReferenceFrame};
//!
//! let robot = catalogue::load("panda")?; // `cylindroid::load` reads URDF, MJCF, SDF, TOML
//! let state = robot.state(robot.home())?;
//! let world_from_tool = state.pose(robot.tool())?;
//! let jacobian = state.jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned)?;
//! assert_eq!((jacobian.rows(), jacobian.cols()), (6, 7));
//! # assert!(world_from_tool.translation.x > 0.3);
//! # Ok::<(), cylindroid::Error>(())
//! ```
//!
//! # Where to find things
//!
//! | to ... | start at |
//! |---|---|
//! | load or build a robot or mechanism | [`load`], [`ParametricModel`], [`catalogue`], [`model::Builder`], [`Mechanism`] |
//! | compute forward kinematics and Jacobians | [`State`]; in a loop [`kinematics::Chain`]; for many configurations [`kinematics::KinematicsBatch`] |
//! | find distances between links and to obstacles | [`collision::CollisionModel`] |
//! | solve inverse kinematics | [`ik::solve`], [`ik::Solver`]; in closed form [`ik::Analytic`] |
//! | control an end effector or an object in Cartesian space | [`Servo`], [`ServoOptions`]; whole motions with [`control::simulate`] |
//! | plan time laws and paths | [`control::TimeLaw`], [`control::CartesianMove`], [`control::JointMove`] |
//! | control forces, share control with an operator | [`control::HybridController`], [`control::SharedController`], [`control::InternalForceController`] |
//! | invert a Jacobian near singularities | [`Method`], [`inverse::truncated`], [`inverse::damped`] |
//! | invert it independently of frame and unit | [`inverse::hyperbolic`], [`inverse::oblique`] |
//! | analyse screws | [`Screw`], [`ScrewSystem`], [`screws::involution`] |
//! | close loops, enumerate assembly modes, track a path of configurations | [`closure::assemble`], [`closure::assembly_modes`], [`closure::track_path`] |
//! | count mobility, find singularities | [`closure::Mobility`], [`closure::Diagnosis`], [`closure::FiniteMobility`] |
//! | resolve forces of closed chains and grasps | [`closure::joint_torques`], [`closure::contact_forces`], [`closure::grasp_quality`] |
//! | measure manipulability (Yoshikawa, ellipsoids, polytopes) | [`manipulability::Manipulability`], [`manipulability::Polytope`] |
//! | sample millions of configurations into Parquet files | [`sweep::Sweep`] |
//! | map the workspace and its singularity loci | [`sweep::Map`] |
//!
//! # Conventions
//!
//! SI units and radians. Twists and wrenches as vectors are linear first (`[v; w]`, `[f; m]`).
//! `world_from_tool` names a pose; a Jacobian always names its [`ReferenceFrame`]. Degenerate results
//! are values that explain themselves; errors ([`Error`]) are for input that has no answer.
//!
//! # Layers
//!
//! The modules form one line, each imports only those before it: `error, tolerance, scalar, linalg,
//! spatial, screws, inverse, model, kinematics, collision, closure, manipulability, task,
//! ik, control, sweep`.
//!
//! # Features
//!
//! All are on by default: `formats` (file loaders and the catalogue), `parallel` (batches on several
//! threads) and `sweep` (millions of configurations into Parquet files).

#![cfg_attr(test, allow(clippy::float_cmp_const))]

pub mod closure;
pub mod collision;
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
#[cfg(feature = "sweep")]
pub mod sweep;
mod task;
pub mod tolerance;

#[cfg(feature = "formats")]
pub use closure::{ParametricModel, load, load_file, load_text, load_with_parameters};
pub use control::{Servo, ServoOptions};
pub use error::{Error, FileError, Result};
pub use inverse::{Inverse, Method};
pub use kinematics::{EndEffector, ReferenceFrame, State};
pub use linalg::Matrix;
#[cfg(feature = "formats")]
pub use model::catalogue;
pub use model::{FrameId, Mechanism};
pub use screws::{Screw, ScrewSystem};
pub use spatial::{Pose, Rotation, Twist, Vec3, Wrench};

#[cfg(fuzzing)]
#[doc(hidden)]
pub mod fuzzing {
    //! What fuzz targets call beside the public functions.

    /// Solves a problem of the bounded solver that bytes describe, and checks its optimality.
    pub fn solver(bytes: &[u8]) {
        crate::control::check_solver(bytes);
    }
}

/// The code of the README and of the book is compiled and run.
#[cfg(doctest)]
mod book {
    macro_rules! pages {
        ($($name:ident $path:literal)*) => { $(#[doc = include_str!($path)] struct $name;)* };
    }
    pages! {
        Readme "../../../README.md"
        OfCrate "../README.md"
        ConceptsFrames "../../../docs/concepts/frames.md"
        ConceptsRanks "../../../docs/concepts/ranks.md"
        GuideAssembly "../../../docs/guide/assembly.md"
        GuideControl "../../../docs/guide/control.md"
        GuideDistances "../../../docs/guide/distances.md"
        GuideGrasps "../../../docs/guide/grasps.md"
        GuideInverseKinematics "../../../docs/guide/inverse-kinematics.md"
        GuideInverses "../../../docs/guide/inverses.md"
        GuideKinematics "../../../docs/guide/kinematics.md"
        GuideLoading "../../../docs/guide/loading.md"
        GuideManipulability "../../../docs/guide/manipulability.md"
        GuideMaps "../../../docs/guide/maps.md"
        GuideMobility "../../../docs/guide/mobility.md"
        GuideScrews "../../../docs/guide/screws.md"
        GuideStatics "../../../docs/guide/statics.md"
        GuideSweeps "../../../docs/guide/sweeps.md"
        StartRust "../../../docs/start/rust.md"
    }
}
