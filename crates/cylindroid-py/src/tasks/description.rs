//! Tasks before they belong to a mechanism: names of frames, targets.

use std::sync::Arc;

use cylindroid::control::{Target, Task, TaskObjective};
use cylindroid::{EndEffector, Mechanism, Pose, Vec3};
use pyo3::prelude::*;

use super::custom::{FunctionTask, Raised};
use crate::arrays::Numbers;
use crate::error::{Failure, Result, entry};
use crate::options;

/// The objective of a task, with frames by name.
#[derive(Debug)]
pub(super) enum Description {
    Frame { frame: Named, components: String, axes: Option<String>, target: Target },
    RelativeFrame { frame: Named, reference: Named, components: String, target: Pose },
    CenterOfMass { axes: [bool; 3], target: Vec3, velocity: Vec3 },
    Gaze { frame: Named, point: Vec3 },
    Posture { q: Vec<f64> },
    JointVelocities { velocities: Vec<f64> },
    Manipulability { frame: Named, components: String },
    LimitAvoidance { margin: f64 },
    Custom { function: Arc<Py<PyAny>>, rows: usize },
}

/// A frame by its name, and a tool point fixed to it.
#[derive(Debug)]
pub(super) struct Named {
    pub(super) frame: String,
    pub(super) frame_from_tool: Pose,
}

impl Named {
    pub(super) fn new(name: &'static str, frame: &str, tool: Option<&Numbers<'_>>) -> Result<Self> {
        let frame_from_tool = tool.map_or(Ok(Pose::IDENTITY), |tool| tool.pose(name))?;
        Ok(Self { frame: frame.to_owned(), frame_from_tool })
    }

    pub(super) fn of(&self, robot: &Mechanism) -> Result<EndEffector> {
        let frame = robot.frame(&self.frame)?;
        Ok(EndEffector { frame, frame_from_tool: self.frame_from_tool })
    }
}

impl Description {
    /// The name of the class in Python.
    pub(super) const fn class(&self) -> &'static str {
        match self {
            Self::Frame { .. } => "FrameTask",
            Self::RelativeFrame { .. } => "RelativeFrameTask",
            Self::CenterOfMass { .. } => "CenterOfMassTask",
            Self::Gaze { .. } => "GazeTask",
            Self::Posture { .. } => "PostureTask",
            Self::JointVelocities { .. } => "JointVelocitiesTask",
            Self::Manipulability { .. } => "ManipulabilityTask",
            Self::LimitAvoidance { .. } => "LimitAvoidanceTask",
            Self::Custom { .. } => "CustomTask",
        }
    }

    /// The objective for a mechanism; `name` and `raised` are for functions.
    pub(super) fn objective(
        &self,
        robot: &Mechanism,
        name: &str,
        raised: &Raised,
    ) -> Result<TaskObjective> {
        let task =
            |components: &str, axes| options::task(robot, Some(components), axes, Task::POSE);
        Ok(match self {
            Self::Frame { frame, components, axes, target } => TaskObjective::Frame {
                end_effector: frame.of(robot)?,
                components: task(components, axes.as_deref())?,
                target: *target,
            },
            Self::RelativeFrame { frame, reference, components, target } => {
                TaskObjective::RelativeFrame {
                    end_effector: frame.of(robot)?,
                    reference: reference.of(robot)?,
                    components: task(components, None)?,
                    target: *target,
                }
            }
            Self::CenterOfMass { axes, target, velocity } => {
                TaskObjective::CenterOfMass { axes: *axes, target: *target, velocity: *velocity }
            }
            Self::Manipulability { frame, components } => TaskObjective::Manipulability {
                end_effector: frame.of(robot)?,
                components: task(components, None)?,
            },
            Self::LimitAvoidance { margin } => TaskObjective::LimitAvoidance { margin: *margin },
            Self::Gaze { frame, point } => {
                TaskObjective::Gaze { end_effector: frame.of(robot)?, point: *point }
            }
            Self::Posture { q } => TaskObjective::Posture { q: q.clone() },
            Self::JointVelocities { velocities } => {
                TaskObjective::JointVelocities { velocities: velocities.clone() }
            }
            Self::Custom { function, rows } => TaskObjective::Custom(Box::new(FunctionTask {
                function: Arc::clone(function),
                rows: *rows,
                name: name.to_owned(),
                raised: Arc::clone(raised),
            })),
        })
    }
}

/// A pose, or a pose and the twist with which it moves.
pub(super) fn moving_target(name: &'static str, value: &Bound<'_, PyAny>) -> Result<Target> {
    if let Ok((pose, twist)) = value.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>)>() {
        let pose: Numbers<'_> = entry(name, &pose)?;
        let twist: Numbers<'_> = entry(name, &twist)?;
        return Ok(Target { pose: pose.pose(name)?, feed_forward: twist.twist(name)? });
    }
    Ok(entry::<Numbers<'_>>(name, value)?.pose(name)?.into())
}

/// A point, or a point and the velocity with which it moves.
fn moving_point(name: &'static str, value: &Bound<'_, PyAny>) -> Result<(Vec3, Vec3)> {
    let point = |value: &Bound<'_, PyAny>| -> Result<Vec3> {
        let numbers: Numbers<'_> = entry(name, value)?;
        Ok(Vec3::from_array(numbers.entries(name)?))
    };
    if let Ok((at, velocity)) = value.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>)>() {
        return Ok((point(&at)?, point(&velocity)?));
    }
    Ok((point(value)?, Vec3::ZERO))
}

/// Sets the target of an objective.
pub(super) fn retarget(
    name: &str,
    objective: &mut TaskObjective,
    value: &Bound<'_, PyAny>,
) -> Result<()> {
    if let TaskObjective::Frame { target, .. } = objective {
        *target = moving_target("targets", value)?;
        return Ok(());
    }
    if let TaskObjective::CenterOfMass { target, velocity, .. } = objective {
        (*target, *velocity) = moving_point("targets", value)?;
        return Ok(());
    }
    let numbers: Numbers<'_> = entry("targets", value)?;
    let point = || Ok::<_, Failure>(Vec3::from_array(numbers.entries("targets")?));
    match objective {
        TaskObjective::RelativeFrame { target, .. } => *target = numbers.pose("targets")?,
        TaskObjective::Gaze { point: target, .. } => *target = point()?,
        TaskObjective::Posture { q: all } | TaskObjective::JointVelocities { velocities: all } => {
            *all = numbers.vector("targets")?.to_vec();
        }
        _ => {
            let reason = "its function or its gradient is all there is; it has no target";
            return Err(Failure::option("targets", name, reason));
        }
    }
    Ok(())
}
