//! The twist that `move --twist` follows.

use cylindroid::spatial::{Twist, exp};
use cylindroid::{Error, Pose, ReferenceFrame, Result, Rotation};

use crate::args::PathArgs;

/// The twist to follow.
#[derive(Debug, Clone, Copy)]
pub(super) struct TwistGoal {
    /// In the axes of the task.
    pub(super) twist: Twist,
    /// Time for which it is commanded [s].
    pub(super) duration: f64,
}

impl TwistGoal {
    pub(super) fn of(args: &PathArgs) -> Result<Option<Self>> {
        let Some(twist) = args.twist else { return Ok(None) };
        Error::check_finite("--twist", &twist.0)?;
        let duration = args.duration.unwrap_or(1.0);
        Error::check_positive("--duration", duration)?;
        Ok(Some(Self { twist: Twist::from_array(twist.0), duration }))
    }

    /// The pose to which the twist leads from a pose.
    pub(super) fn end(&self, from: Pose, axes: ReferenceFrame) -> Pose {
        let way = self.twist * self.duration;
        match axes {
            ReferenceFrame::Local => from * exp(way),
            _ => Pose {
                translation: from.translation + way.linear,
                rotation: Rotation::exp(way.angular) * from.rotation,
            },
        }
    }
}
