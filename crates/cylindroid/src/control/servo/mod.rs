//! The servo: one step from joint positions and a target to joint velocities.
//!
//! Read `options`, `step` (the input and output of a step) and `controller`, which runs the stages
//! in `controller/stages.rs`. A stage calls `task_space` (scaling), `projection` and `secondary`
//! (primary and secondary task), `coupled` (closed chains, with `loop_motions`), `approach` and `limits` (braking), then
//! the solver; `stall` reports why there is no progress. `named_inverse` lists the inverses for the
//! front ends, `inverse_choice` computes one for a single Jacobian, `reference_point` compares them.

mod approach;
mod controller;
mod coupled;
mod edge;
mod elsewhere;
mod escape;
mod following;
mod inertia_weights;
mod inverse_choice;
mod jerk_limited_stop;
mod limits;
mod loop_edge;
mod loop_motions;
mod named_inverse;
mod nearest_pose;
mod options;
mod plant;
mod projection;
mod reference_point;
mod saddle;
mod secondary;
mod sensor_fit;
mod stall;
mod step;
mod stopping;
mod task_space;
mod twist_step;

pub(super) use approach::share_of_gain;
pub(super) use edge::curvature_into;
pub(super) use jerk_limited_stop::{JerkLimitedStop, largest_approach};
pub(super) use limits::{DefaultLimits, acceleration_of, limits_of_servo};
pub(super) use loop_motions::{LoopMotions, nothing_actuated};
pub(super) use plant::{Predictor, SimulatedRobot};
pub(super) use saddle::{AT_REST, Progress, Saddle, Surroundings};
pub(super) use secondary::{SecondaryVelocities, posture_ways};
pub(super) use stall::{BrakingState, Remainder, StallDetector};
pub(super) use stopping::{
    NEGLIGIBLE_WAY_BACK, SHARE_HALVINGS, jerk_limited_stopping_velocity, stopping_time,
};
pub(super) use task_space::{TaskScaling, TaskSpace, is_locked};

pub use controller::Servo;
pub use controller::condition::ConditionReport;
pub use inverse_choice::InverseChoice;
pub use limits::JointState;
pub use named_inverse::{InverseSelection, NamedInverse};
pub use options::{PoseTolerance, SecondaryNullSpace, ServoGains, ServoOptions, SpeedLimit};
pub use plant::Plant;
pub use projection::TaskProjection;
pub use reference_point::{ReferencePointComparison, VelocitiesAtPoint};
pub use secondary::SecondaryTask;
pub use stall::Stall;
pub use step::{Status, Step, Target};
pub use twist_step::{TwistStatus, TwistStep};
