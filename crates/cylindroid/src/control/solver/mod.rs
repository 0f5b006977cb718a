//! The bounded solver: joint velocities that perform tasks within their bounds.
//!
//! Read `bounds` (the interval of each joint and the limit that sets it), `inequalities` (bounds as
//! rows), `active_set` (least squares within them), `hierarchy` (level after level, scaled before
//! changed), then `saturation` (one task with its secondary motion, for trees and closed chains). The
//! solver knows neither targets nor gains nor time.

pub(super) mod active_set;
pub(super) mod bounds;
pub(super) mod hierarchy;
pub(super) mod inequalities;
pub(super) mod saturation;

pub use bounds::{LimitKind, VelocityBounds};
pub use saturation::Saturation;
