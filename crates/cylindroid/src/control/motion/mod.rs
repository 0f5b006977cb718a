//! Motions over time: trajectories for a servo to follow, and their simulation.
//!
//! Read `time_law` (one coordinate over time), `path` (the geometry of a Cartesian motion),
//! `cartesian_move`, `joint_move` and `waypoints` (both combined), then `simulation` (a servo simulated until it
//! reaches its target or stalls) and `reconfiguration` (a configuration that reaches a target at
//! which the servo stalls).

mod cartesian_move;
mod joint_move;
mod path;
mod reconfiguration;
mod simulation;
mod time_law;
mod waypoints;

pub use cartesian_move::{CartesianBounds, CartesianMove, CartesianSample};
pub use joint_move::{JointDefaults, JointMove, JointPath, JointSample};
pub use path::{AxisRotation, CartesianPath, PathDeviation};
pub use reconfiguration::{Reconfiguration, find_reachable_configuration};
pub use simulation::{MotionResult, TrajectorySample, simulate, simulate_twist};
pub use time_law::{KinematicBounds, LawSample, TimeLaw};
pub use waypoints::WaypointMove;
