//! The bounded solver: joint velocities that perform a Cartesian task within their bounds.
//!
//! Read `bounds` (the interval of each joint and the limit that sets it), then `direct` (trees: the
//! unknowns are the joint velocities), then `reduced` (closed chains: the unknowns are the actuated
//! motions, the bounds apply to all joints). The solver knows neither targets nor gains nor time.

pub(super) mod active_set;
pub(super) mod bounds;
pub(super) mod direct;
pub(super) mod hierarchy;
pub(super) mod inequalities;
pub(super) mod reduced;

pub use bounds::{LimitKind, VelocityBounds};
pub use direct::Saturation;
