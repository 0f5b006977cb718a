//! Tasks as errors and Jacobians, shared by inverse kinematics and the servos.
//!
//! `components` (the part of an end effector's motion that counts), `relative_frame`, `gaze` and
//! `half_space`; the centre of mass is that of [`MassMatrix`](crate::kinematics::MassMatrix).

mod components;
mod gaze;
mod half_space;
mod relative_frame;

pub use components::Task;
pub(crate) use gaze::Gaze;
pub use half_space::HalfSpace;
pub(crate) use relative_frame::RelativeFrame;

use crate::error::{Error, Result};
use crate::spatial::{Pose, Twist};
use crate::tolerance::MAX_MAGNITUDE;

/// Refuses a target that is not finite, or too far away for finite results.
pub(crate) fn check_target(target: &Pose) -> Result<()> {
    Error::check_within("target position", &target.translation.to_array(), MAX_MAGNITUDE)?;
    if !target.is_finite() {
        return Err(Error::NotFinite { what: "target orientation".to_owned(), value: f64::NAN });
    }
    Ok(())
}

/// Refuses a pose that is not finite, or too far away for finite results.
pub(crate) fn check_pose(what: &str, pose: &Pose) -> Result<()> {
    if !pose.is_finite() {
        return Err(Error::NotFinite { what: what.to_owned(), value: f64::NAN });
    }
    Error::check_within(what, &pose.translation.to_array(), MAX_MAGNITUDE)
}

/// The twist of a column of a Jacobian.
fn twist_of(column: &[f64]) -> Twist {
    Twist::from_array(std::array::from_fn(|i| column[i]))
}
