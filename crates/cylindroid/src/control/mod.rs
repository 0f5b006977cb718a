//! Cartesian control: the servo loop, its limits, its secondary tasks, time laws and paths.
//!
//! A path says where (`s` in 0 to 1), a time law says when (`s` over time), a move is both: the
//! fastest law on this path that keeps every bound. A servo follows a move, or goes straight at a
//! pose.
//!
//! [`HybridLaw`] and [`SharedLaw`] give a twist from a projector on a screw system: motions and
//! contact wrenches controlled side by side, a robot and an operator on one tool. A servo carries
//! it out as the feed-forward of a [`Target`] at the tool's own pose.

mod admittance;
mod approach;
mod cartesian_move;
mod coupled;
mod detour;
mod drive;
mod hybrid;
mod internal_force;
mod joint_move;
mod limits;
mod operator_share;
mod options;
mod path;
mod projection;
mod reference_point;
mod saturation;
mod secondary;
mod servo;
mod shared;
mod stall;
mod step;
mod task_space;
mod time_law;

pub use crate::ik::Task;
pub use admittance::{Admittance, AdmittanceGain};
pub use cartesian_move::{CartesianBounds, CartesianMove, CartesianSample};
pub use detour::{Detour, find_posture};
pub use drive::{Outcome, Sample, drive};
pub use hybrid::{HybridCommand, HybridInput, HybridLaw};
pub use internal_force::{InternalForceCommand, InternalForceLaw};
pub use joint_move::{JointDefaults, JointMove, JointPath, JointSample};
pub use limits::{LimitKind, Motion1, RateBounds};
pub use operator_share::{OperatorShare, ShareTimes};
pub use options::{Gain, Projector, ServoOptions, Speed, Tolerance};
pub use path::{CartesianPath, Deviation, Turn};
pub use projection::Projection;
pub use reference_point::{InverseChoice, RatesAtPoint, ReferencePoints};
pub use saturation::Saturation;
pub use secondary::Secondary;
pub use servo::{Posture, Servo};
pub use shared::{SharedCommand, SharedInput, SharedLaw};
pub use stall::Stall;
pub use step::{Status, Step, Target};
pub use time_law::{Bounds, LawSample, TimeLaw};
