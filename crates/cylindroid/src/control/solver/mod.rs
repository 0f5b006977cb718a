//! The bounded solver: joint velocities that carry out a Cartesian task within their bounds.
//!
//! Read `bounds` (the interval of each joint and the limit that sets it), then `direct` (trees: the
//! unknowns are the joint velocities), then `reduced` (closed chains: the unknowns are the actuated
//! motions, the bounds those of all joints). Nothing here knows targets, gains or time.

pub(super) mod bounds;
pub(super) mod direct;
pub(super) mod reduced;

pub use bounds::{LimitKind, VelocityBounds};
pub use direct::Saturation;
