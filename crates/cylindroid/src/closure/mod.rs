//! Closed chains, cooperating arms and grasps: how they can move and which forces they hold.
//!
//! Everything here starts from one matrix equation, `J_a q_a + J_p q_p = G^T u` ([`Constraint`]),
//! whatever it was built from. Its solutions are the [`Motions`]; what they leave of the driven
//! joints and the object is a linear [`Relation`] between `q_a` and `u`, in general neither a map
//! one way nor the other. The forces that do no work on it are the complement, so statics needs
//! no equations of its own.
//!
//! ```
//! use cylindroid::closure::{Blocks, Constraint, Motions};
//! use cylindroid::Matrix;
//!
//! // A slider pushed through a lever: q_a turns, the object slides twice as fast.
//! let blocks = Blocks {
//!     actuated: Matrix::from_rows(&[[2.0]]).unwrap(),
//!     passive: Matrix::zeros(1, 0),
//!     grasp: Matrix::identity(1),
//! };
//! let relation = Motions::of(&Constraint::new(blocks)?).relation();
//! assert_eq!(relation.dimensions().coordinate, 1);
//! # Ok::<(), cylindroid::Error>(())
//! ```

mod constraint;
mod mobility;
mod position;
mod singularity;
mod statics;

pub use constraint::closed_chain::{ClosedChain, Gap};
pub(crate) use constraint::closed_chain_batched::Plan;
pub use constraint::velocity_constraint::{Blocks, Constraint, Unit, Units};
pub use mobility::actuation_map::Steering;
pub use mobility::finite_mobility::{Branch, Evidence, FiniteMobility};
pub use mobility::motion_space::{Motions, Rows};
pub use mobility::relation::{Parts, Relation, RelationDimensions};
pub use mobility::report::{CoordinateKinds, Doubt, JointMobility, Mobility, Subspace};
pub use position::assembly::{Assembly, assemble, recover_passive};
pub use position::assembly_modes::{AssemblyModes, Mode, ModeOptions, assembly_modes};
pub use position::continuation::{
    FollowOptions, Followed, PathEnd, PathPoint, PathSingularity, follow,
};
pub use singularity::diagnosis::Diagnosis;
pub use singularity::generic_mobility::Generic;
pub use singularity::singularity_types::{Counts, Distances, Singularities, SingularityKind};
pub(crate) use statics::contact_forces::Supports;
pub use statics::contact_forces::{
    ContactForces, Load, Torques, contact_forces, internal_forces, joint_torques, structural_forces,
};
pub use statics::force_closure::{
    Effort, FingerContact, Friction, GraspQuality, WrenchSpace, grasp_quality,
};
pub use statics::grasp_contacts::{Touch, fingers_on};
pub use statics::transmitted_wrenches::{Transmitted, row_compliance, transmitted};
