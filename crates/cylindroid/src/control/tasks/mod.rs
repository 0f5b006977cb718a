//! Many tasks at once: frames, frames relative to each other, the centre of mass, gaze, posture,
//! with priorities and weights inside the limits of all joints and outside of collisions.
//!
//! Read `objective` (a task as an error and a Jacobian), `options` (gain, weight, level; reports),
//! `task_servo` (one step), `motions` (its unknowns), `rows` (limits, distances, half-spaces), `stack`
//! (the levels, solved with `solver/hierarchy.rs`), `linear_range` (how far they go), `braking` (what
//! must stay possible after a step), `braking_in_time` (joints that stop before tasks turn back),
//! `escape` and `escaping` (from configurations in which they are lost), `velocity_mode` (twists in
//! place of targets) and `simulation`.

mod braking;
mod braking_in_time;
mod braking_path;
mod escape;
mod escaping;
mod frame_curvature;
mod goals;
mod gradient;
mod levels;
mod linear_range;
mod motions;
mod objective;
mod options;
mod rows;
mod simulation;
mod stack;
mod task_servo;
mod turning_back;
mod twist_command;
mod velocity_mode;

pub use crate::task::HalfSpace;
pub use goals::{TaskGoals, goals_of};
pub use objective::{CustomTask, TaskObjective};
pub use options::{CollisionAvoidance, MotionTask, StoppedBy, TaskReport, TaskServoOptions};
pub use simulation::TaskMotionResult;
pub use task_servo::TaskServo;
