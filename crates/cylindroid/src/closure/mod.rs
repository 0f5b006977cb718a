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

mod assembly;
mod branches;
mod constraint;
mod continuation;
mod coordinates;
mod diagnosis;
mod fingers;
mod finite;
mod generic;
mod graph;
mod grasp;
mod guesses;
mod lanes;
mod marks;
mod mobility;
mod modes;
mod motions;
mod pairs;
mod reference_motions;
mod relation;
mod singularity;
mod statics;
mod steering;
mod transmitted;
mod vicinity;
mod way;

pub use assembly::{Assembly, assemble, recover_passive};
pub use constraint::{Blocks, Constraint, Unit, Units};
pub use continuation::{FollowOptions, Followed, PathEnd, PathPoint, PathSingularity, follow};
pub use diagnosis::Diagnosis;
pub use fingers::{Touch, fingers_on};
pub use finite::{Branch, Evidence, FiniteMobility};
pub use generic::Generic;
pub use graph::{ClosedChain, Gap};
pub use grasp::{Effort, FingerContact, Friction, GraspQuality, WrenchSpace, grasp_quality};
pub(crate) use lanes::Plan;
pub use mobility::{CoordinateKinds, Doubt, JointMobility, Mobility, Subspace};
pub use modes::{AssemblyModes, Mode, ModeOptions, assembly_modes};
pub use motions::{Motions, Rows};
pub use relation::{Parts, Relation, RelationDimensions};
pub use singularity::{Counts, Distances, Singularities, SingularityKind};
pub(crate) use statics::Supports;
pub use statics::{
    ContactForces, Load, Torques, contact_forces, internal_forces, joint_torques, structural_forces,
};
pub use steering::Steering;
pub use transmitted::{Transmitted, row_compliance, transmitted};
