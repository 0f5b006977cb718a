//! Closed chains, cooperating arms and grasps: how they can move and which forces they hold.
//!
//! Everything here starts from one matrix equation, `J_a q_a + J_p q_p = G^T u` ([`Constraint`]),
//! whatever it was built from. Its solutions are the [`MotionSpace`]; what they leave of the actuated
//! joints and the object is a linear [`Relation`] between `q_a` and `u`, in general neither a map
//! one way nor the other. The forces that do no work on it are the complement, so statics needs
//! no equations of its own.
//!
//! ```
//! use cylindroid::closure::{ConstraintBlocks, Constraint, MotionSpace};
//! use cylindroid::Matrix;
//!
//! // A slider pushed through a lever: q_a turns, the object slides twice as fast.
//! let blocks = ConstraintBlocks {
//!     actuated: Matrix::from_rows(&[[2.0]]).unwrap(),
//!     passive: Matrix::zeros(1, 0),
//!     grasp: Matrix::identity(1),
//! };
//! let relation = MotionSpace::of(&Constraint::new(blocks)?).relation();
//! assert_eq!(relation.dimensions().coordinate, 1);
//! # Ok::<(), cylindroid::Error>(())
//! ```

mod constraint;
mod mobility;
mod position;
mod singularity;
mod singularity_kind;
mod statics;

pub use constraint::closed_chain::ClosedChain;
pub(crate) use constraint::closed_chain_batched::BatchedConstraintPlan;
pub use constraint::loop_closure_error::LoopClosureError;
pub use constraint::velocity_constraint::{Constraint, ConstraintBlocks, Unit, Units};
pub use mobility::actuation_map::ActuationMap;
pub use mobility::counts::MobilityCounts;
pub use mobility::finite_mobility::{Branch, FiniteMobility, MobilityEvidence};
pub use mobility::motion_space::{MotionSpace, RowSelection};
pub use mobility::relation::{Relation, RelationBases, RelationDimensions};
pub use mobility::report::{CoordinateKinds, JointMobility, Mobility, RankWarning};
pub use mobility::subspace::Subspace;
pub use position::assembly::{Assembly, assemble, recover_passive};
pub use position::assembly_modes::{AssemblyModes, Mode, ModeOptions, assembly_modes};
pub use position::continuation::{
    ContinuationOptions, ContinuationResult, PathEnd, PathPoint, PathSingularity, track_path,
};
pub use singularity::diagnosis::Diagnosis;
pub use singularity::generic_mobility::GenericMobility;
pub use singularity::singularity_types::{Singularities, SingularityDistances};
pub use singularity_kind::SingularityKind;
pub(crate) use statics::contact_forces::ContactForceSolver;
pub use statics::contact_forces::{
    ContactForces, StaticLoad, contact_forces, internal_forces, structural_forces,
};
pub use statics::force_closure::{
    EpsilonQuality, FingerContact, Friction, GraspMetric, GraspQuality, WrenchSpace, grasp_quality,
};
pub use statics::grasp_contacts::{ContactProperties, grasp_contacts};
pub use statics::joint_torques::{JointTorques, joint_torques};
pub use statics::transmitted_wrenches::{TransmittedWrench, row_compliance, transmitted_wrenches};
