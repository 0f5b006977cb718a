//! Secondary tasks: joint velocities executed in the null space of the primary task.
//!
//! `table` lists the tasks with their parameters; each has a file with its formula, which reads a
//! `context` (the present step) and adds joint velocities; `gradient` evaluates one without a servo. A new task is such a file and a row.

mod centring;
mod context;
mod gradient;
mod limit_avoidance;
mod manipulability;
mod posture;
mod table;

pub(super) use context::Context;
pub(in crate::control) use gradient::SecondaryVelocities;
pub(in crate::control) use posture::ways as posture_ways;
pub use table::SecondaryTask;
