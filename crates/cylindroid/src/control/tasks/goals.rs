//! Tasks of a servo as goals of inverse kinematics.
//!
//! Checked  tests/it/ik_goals.rs::tasks_are_goals

use super::objective::TaskObjective;
use super::options::MotionTask;
use crate::error::{Error, Result};
use crate::ik::{Goal, Objective};

/// The goals of these tasks, with their weights, and the configuration of a posture among them:
/// for [`IkOptions::posture`](crate::ik::IkOptions::posture). A solution reaches all goals: gains,
/// levels, tolerances and velocities of the tasks do not count.
///
/// ```
/// use cylindroid::control::{MotionTask, TaskObjective, goals_of};
/// use cylindroid::ik::{IkOptions, solve};
/// use cylindroid::Vec3;
///
/// let panda = cylindroid::load("panda")?;
/// let gaze = TaskObjective::Gaze { end_effector: panda.tool().into(), point: Vec3::X };
/// let posture = TaskObjective::Posture { q: panda.home().to_vec() };
/// let tasks = [MotionTask::new("gaze", gaze), MotionTask::new("posture", posture)];
/// let (goals, posture) = goals_of(&tasks)?;
/// let options = IkOptions { posture, ..IkOptions::default() };
/// assert!(solve(&panda, &goals, &options)?.success);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// A task that is neither a goal nor a posture, named; several postures.
pub fn goals_of(tasks: &[MotionTask]) -> Result<(Vec<Goal>, Option<Vec<f64>>)> {
    let refuse = |task: &MotionTask, reason: &str| {
        let reason = reason.to_owned();
        Err(Error::InvalidOption { option: "tasks", value: task.name.clone(), reason })
    };
    let (mut goals, mut posture) = (Vec::new(), None);
    for task in tasks {
        let objective = match &task.objective {
            TaskObjective::Frame { end_effector, components, target } => Objective::Frame {
                end_effector: *end_effector,
                components: *components,
                target: target.pose,
            },
            TaskObjective::RelativeFrame { end_effector, reference, components, target } => {
                Objective::RelativeFrame {
                    end_effector: *end_effector,
                    reference: *reference,
                    components: *components,
                    target: *target,
                }
            }
            TaskObjective::CenterOfMass { axes, target, .. } => {
                Objective::CenterOfMass { axes: *axes, target: *target }
            }
            TaskObjective::Gaze { end_effector, point } => {
                Objective::Gaze { end_effector: *end_effector, point: *point }
            }
            TaskObjective::Posture { q } => {
                if posture.replace(q.clone()).is_some() {
                    return refuse(task, "inverse kinematics takes one posture");
                }
                continue;
            }
            TaskObjective::JointVelocities { .. }
            | TaskObjective::Manipulability { .. }
            | TaskObjective::LimitAvoidance { .. }
            | TaskObjective::Custom(_) => {
                return refuse(
                    task,
                    "inverse kinematics takes frames, relative frames, the centre of mass, gaze \
                     and a posture",
                );
            }
        };
        goals.push(Goal::from(objective).with_weight(task.weight));
    }
    Ok((goals, posture))
}
