//! Closed chains, cooperating arms and grasps: mobility, singularities and statics.
//!
//! The starting point is one matrix equation, `J_a q_a + J_p q_p = G^T u` ([`Constraint`]). Its
//! solutions form the [`MotionSpace`]; its projection on the actuated joints and the object is a
//! linear [`Relation`] between `q_a` and `u`, in general not a map in either direction. The forces
//! that do no work on it form the dual relation, so that statics needs no further equations.
//!
//! Each module reads only those before it: `constraint`, `position`, `mobility`, then
//! `singularity` and `statics`.
//!
//! ```
//! use cylindroid::closure::{ConstraintBlocks, Constraint, MotionSpace};
//! use cylindroid::Matrix;
//!
//! // A slider pushed by a lever: the object moves twice as fast as q_a rotates.
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
#[cfg(feature = "sweep")]
pub(crate) use constraint::rate_rank::rate_rank;
pub(crate) use constraint::velocity_constraint::check_coordinates;
pub use constraint::velocity_constraint::{Constraint, ConstraintBlocks, Unit, Units};
pub use mobility::actuation_map::ActuationMap;
pub use mobility::blocks::CoordinateKinds;
pub(crate) use mobility::coordinate_partitioning::CoordinatePartitioning;
pub use mobility::counts::MobilityCounts;
pub use mobility::finite_mobility::{Branch, FiniteMobility, MobilityEvidence};
pub use mobility::force_spaces::{internal_forces, structural_forces};
pub use mobility::limbs::{Limb, LimbScrews};
pub use mobility::motion_space::{MotionSpace, RowSelection};
pub use mobility::reference_twists::frame_twists;
pub(crate) use mobility::relation::check_components;
pub use mobility::relation::{Relation, RelationBases, RelationDimensions};
pub use mobility::report::{JointMobility, Mobility, MotionBlock, RankWarning};
pub use mobility::second_order::{SecondOrder, SecondOrderRigidity};
pub use mobility::subspace::Subspace;
pub use position::assembly::{Assembly, assemble, recover_passive};
pub use position::assembly_modes::{AssemblyModes, Mode, ModeOptions, assembly_modes};
pub use position::continuation::{
    ContinuationOptions, ContinuationResult, PathEnd, PathPoint, PathSingularity, track_path,
};
#[cfg(feature = "formats")]
pub use position::load::{load, load_file, load_text, load_with_parameters};
#[cfg(feature = "formats")]
pub use position::parametric_model::ParametricModel;
pub(crate) use position::platform::{Platform, PlatformChain, PlatformRotation};
#[cfg(feature = "sweep")]
pub(crate) use position::{
    assembly_modes::assembly_modes_while,
    configuration_signature::{Landmarks, link_poses, signature_distance},
    initial_guesses::perturbed,
    loop_equations::LoopEquations,
    nearest_singularity::CentredNorm,
    platform_path::{Obstruction, PathNode, PlatformPath},
    signed_singularity::SignedSingularity,
    singular_curve::{Curve, CurveDomain, CurveTracer, Vanishing},
};
pub use singularity::diagnosis::Diagnosis;
pub use singularity::generic_mobility::GenericMobility;
pub use singularity::operation_modes::{
    ModeMeeting, OperationMode, OperationModes, operation_modes,
};
pub(crate) use singularity::singularity_types::Excess;
pub use singularity::singularity_types::{Singularities, SingularityDistances};
pub use singularity::transmission::{ActuatorTransmission, Transmission};
pub use singularity::verdict::{LocalStructure, Verdict};
pub use singularity::zlatanov::ZlatanovType;
pub use singularity_kind::SingularityKind;
pub(crate) use statics::contact_forces::ContactForceSolver;
pub use statics::contact_forces::{ContactForces, StaticLoad, contact_forces};
pub(crate) use statics::elastic_chain::ElasticChain;
pub use statics::force_closure::{
    EpsilonQuality, FingerContact, Friction, GraspMetric, GraspQuality, WrenchSpace, grasp_quality,
};
pub use statics::grasp_contacts::{ContactProperties, grasp_contacts};
pub use statics::grasp_mobility::{Escape, GraspMobility, Immobilisation, grasp_mobility};
pub(crate) use statics::internal_force_relation::internal_force_relation;
pub use statics::joint_torques::{JointTorques, joint_torques};
pub use statics::transmitted_wrenches::{TransmittedWrench, row_compliance, transmitted_wrenches};
