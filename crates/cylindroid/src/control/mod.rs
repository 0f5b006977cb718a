//! Cartesian control: the servo loop, its limits, its secondary tasks, time laws and paths.
//!
//! A path says where (`s` in 0 to 1), a time law says when (`s` over time), a move is both: the
//! fastest law on this path that keeps every bound. A servo follows a move, or goes straight at a
//! pose.
//!
//! [`HybridLaw`] and [`SharedLaw`] give a twist from a projector on a screw system: motions and
//! contact wrenches controlled side by side, a robot and an operator on one tool. A servo carries
//! it out as the feed-forward of a [`Target`] at the tool's own pose.

mod laws;
mod motion;
mod servo;
mod solver;

pub use crate::ik::Task;
pub use laws::{
    Admittance, AdmittanceGain, HybridCommand, HybridInput, HybridLaw, InternalForceCommand,
    InternalForceLaw, OperatorShare, ShareTimes, SharedCommand, SharedInput, SharedLaw,
};
pub use motion::{
    Bounds, CartesianBounds, CartesianMove, CartesianPath, CartesianSample, Detour, Deviation,
    JointDefaults, JointMove, JointPath, JointSample, LawSample, Outcome, Sample, TimeLaw, Turn,
    drive, find_posture,
};
pub use servo::{
    Gain, InverseChoice, Motion1, Posture, Projection, Projector, RatesAtPoint, ReferencePoints,
    SecondaryTask, Servo, ServoOptions, Speed, Stall, Status, Step, Target, Tolerance,
};
pub use solver::{LimitKind, RateBounds, Saturation};
