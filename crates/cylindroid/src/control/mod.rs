//! Cartesian control: the servo loop, its limits and secondary tasks, time laws and paths.
//!
//! Five parts, each reading only from the left: `solver` (joint velocities within bounds), `servo`
//! (one control step), `tasks` (many tasks in one step), `laws` (force, shared and internal-force
//! control), `motion` (trajectories and simulation).
//!
//! A path gives the pose over `s` in [0, 1], a time law gives `s` over time, and a move combines
//! both: the fastest law on this path within every bound. A servo follows a move, or moves straight
//! towards a pose.
//!
//! [`HybridController`] and [`SharedController`] compute a twist from a projector on a screw
//! system, to control motions and contact wrenches simultaneously, or to share a tool between a
//! robot and an operator. A servo executes it as the feed-forward of a [`Target`] at the tool's own
//! pose.

mod laws;
mod motion;
mod servo;
mod solver;
mod tasks;

#[cfg(fuzzing)]
pub(crate) use solver::hierarchy::optimality::check as check_solver;

pub use crate::task::Task;
pub use laws::{
    Admittance, AdmittanceGain, AuthorityTimes, HybridCommand, HybridController, HybridInput,
    InternalForceCommand, InternalForceController, OperatorAuthority, SharedCommand,
    SharedController, SharedInput,
};
pub use motion::{
    AxisRotation, CartesianBounds, CartesianMove, CartesianPath, CartesianSample, JointDefaults,
    JointMove, JointPath, JointSample, KinematicBounds, LawSample, MotionResult, PathDeviation,
    Reconfiguration, TimeLaw, TrajectorySample, WaypointMove, find_reachable_configuration,
    simulate, simulate_twist,
};
pub use servo::{
    ConditionReport, InverseChoice, InverseSelection, JointState, NamedInverse, Plant,
    PoseTolerance, ReferencePointComparison, SecondaryNullSpace, SecondaryTask, Servo, ServoGains,
    ServoOptions, SpeedLimit, Stall, Status, Step, Target, TaskProjection, TwistStatus, TwistStep,
    VelocitiesAtPoint,
};
pub use solver::{LimitKind, Saturation, VelocityBounds};
pub use tasks::{
    CollisionAvoidance, CustomTask, HalfSpace, MotionTask, StoppedBy, TaskGoals, TaskMotionResult,
    TaskObjective, TaskReport, TaskServo, TaskServoOptions, goals_of,
};
