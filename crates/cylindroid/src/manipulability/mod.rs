//! What a mechanism can do, in numbers: efficiencies of motion and force, indices and their
//! gradients, polytopes.
//!
//! Serial arms and closed chains use the same code: both are a [`Relation`] between actuated
//! joints and object. For a serial arm the finite kinematic efficiencies are the squares of the
//! singular values of its Jacobian, and the directions the axes of the textbook ellipsoid.
//!
//! ```
//! use cylindroid::closure::{Constraint, MotionSpace};
//! use cylindroid::manipulability::{Manipulability, Metrics};
//! use cylindroid::Matrix;
//!
//! let jacobian = Matrix::from_rows(&[[2.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
//! let relation = MotionSpace::of(&Constraint::serial(&jacobian)?).relation();
//! let m = Manipulability::of(&relation, &Metrics::UNIT)?;
//! assert_eq!(m.kinematic.zeros.cols(), 1); // the third joint moves nothing
//! assert!((m.kinematic.values()[0] - 4.0).abs() < 1e-12);
//! assert!((m.force.values()[0] - 1.0).abs() < 1e-12);
//! # Ok::<(), cylindroid::Error>(())
//! ```
//!
//! [`Relation`]: crate::closure::Relation

mod actuated_inertia;
mod batch;
mod closed_chain_batched;
mod efficiency;
mod ellipsoid;
mod gradient;
mod index;
mod inertia;
mod internal_force;
mod metrics;
mod polytope;
mod stiffness;

pub use actuated_inertia::actuated_inertia;
pub use batch::{BatchOptions, ManipulabilityBatch};
pub use efficiency::{Direction, Manipulability, Pair, Spectrum};
pub use ellipsoid::{Ellipsoid, EllipsoidView};
pub(crate) use gradient::log_volume_slope;
pub use gradient::{Goal, Gradient, Measure, gradient};
pub use index::Index;
pub use inertia::body_inertia;
pub use internal_force::internal_force_manipulability;
pub use metrics::Metrics;
pub use polytope::{Polytope, force_polytope, force_range, velocity_polytope, velocity_range};
pub use stiffness::{Deflection, PartDeflection, Stiffness};
