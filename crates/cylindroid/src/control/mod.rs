//! Cartesian control: the servo loop, its limits, its secondary tasks, time laws and paths.
//!
//! A path says where (`s` in 0 to 1), a time law says when (`s` over time), a move is both: the
//! fastest law on this path that keeps every bound. A servo follows a move, or goes straight at a
//! pose.
//!
//! [`HybridController`] and [`SharedController`] give a twist from a projector on a screw system:
//! motions and contact wrenches controlled side by side, a robot and an operator on one tool. A
//! servo carries it out as the feed-forward of a [`Target`] at the tool's own pose.

mod laws;
mod motion;
mod servo;
mod solver;

pub use crate::ik::Task;
pub use laws::{
    Admittance, AdmittanceGain, AuthorityTimes, HybridCommand, HybridController, HybridInput,
    InternalForceCommand, InternalForceController, OperatorAuthority, SharedCommand,
    SharedController, SharedInput,
};
pub use motion::{
    AxisRotation, CartesianBounds, CartesianMove, CartesianPath, CartesianSample, JointDefaults,
    JointMove, JointPath, JointSample, KinematicBounds, LawSample, MotionResult, PathDeviation,
    Reconfiguration, TimeLaw, TrajectorySample, find_reachable_configuration, simulate,
};
pub use servo::{
    ConditionReport, InverseChoice, InverseSelection, JointState, NamedInverse, PoseTolerance,
    ReferencePointComparison, SecondaryNullSpace, SecondaryTask, Servo, ServoGains, ServoOptions,
    SpeedLimit, Stall, Status, Step, Target, TaskProjection, VelocitiesAtPoint,
};
pub use solver::{LimitKind, Saturation, VelocityBounds};
