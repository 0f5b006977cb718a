//! The twist that `move --twist` follows.

use cylindroid::control::Task;
use cylindroid::spatial::{Twist, exp};
use cylindroid::tolerance::MAX_MAGNITUDE;
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
    /// `--twist`, whose parts are all components of the task.
    pub(super) fn of(args: &PathArgs, task: Task) -> Result<Option<Self>> {
        let Some(twist) = args.twist else { return Ok(None) };
        Error::check_within("--twist", &twist.0, MAX_MAGNITUDE)?;
        let names = Task::COMPONENTS.iter().zip(task.components);
        if let Some(((name, _), x)) =
            names.clone().zip(twist.0).find(|((_, on), x)| !on && *x != 0.0)
        {
            let controlled: Vec<&str> =
                names.filter(|(_, on)| *on).map(|(name, _)| *name).collect();
            return Err(Error::InvalidOption {
                option: "--twist",
                value: format!("{name} = {x}"),
                reason: format!(
                    "the task has no {name}, but {}; set it to zero, or name it in --task if the \
                     mechanism moves so",
                    controlled.join(", ")
                ),
            });
        }
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
