//! Geometry of links and obstacles: distances, closest points, normals and their gradients.
//!
//! Read in this order: `convex.rs` (shapes), `closed_form.rs` and `gjk.rs` (distance of a
//! pair), `pairs.rs` and `sampling.rs` (the pairs that are watched), `model.rs`
//! ([`CollisionModel`]).

mod body;
mod capsule_fit;
mod closed_form;
mod convex;
mod depth;
mod distance;
mod gjk;
mod gradient;
mod hull;
mod model;
mod options;
mod pairs;
mod sampling;
mod scene;
mod separation;
mod simplex;
mod way;

pub use body::Body;
pub use distance::distance;
pub use model::CollisionModel;
pub use options::{CollisionOptions, MeshShape};
pub use scene::{NearPair, Pair};
pub use separation::Separation;
