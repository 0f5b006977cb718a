//! Making a robot move: time laws, geometric paths, and the moves that join the two.
//!
//! A path says where (`s` in [0, 1]), a time law says when (`s` over time), a move is both: the
//! fastest law on this path that keeps every bound.

mod cartesian_move;
mod joint_move;
mod path;
mod time_law;

pub use cartesian_move::{CartesianBounds, CartesianMove, CartesianSample};
pub use joint_move::{JointMove, JointPath, JointSample};
pub use path::{CartesianPath, Deviation, Turn};
pub use time_law::{Bounds, Sample, TimeLaw};
