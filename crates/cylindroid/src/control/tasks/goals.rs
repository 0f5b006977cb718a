//! Tasks of a servo as goals of inverse kinematics.
//!
//! Checked  tests/it/ik_goals.rs::tasks_are_goals

use super::objective::TaskObjective;
use super::options::MotionTask;
use crate::error::{Error, Result};
use crate::ik::{Criterion, Goal, Objective};

/// What inverse kinematics makes of the tasks of a servo.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TaskGoals {
    /// The goals, with their weights.
    pub goals: Vec<Goal>,
    /// The configuration of a posture: for [`IkOptions::posture`](crate::ik::IkOptions::posture).
    pub posture: Option<Vec<f64>>,
    /// That of a gradient: for [`IkOptions::criterion`](crate::ik::IkOptions::criterion).
    pub criterion: Option<Criterion>,
}

/// The goals of these tasks, and the posture or the criterion among them. A solution reaches all
/// goals: gains, levels, tolerances and velocities of the tasks do not count.
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
/// let own = goals_of(&tasks)?;
/// let options = IkOptions { posture: own.posture, ..IkOptions::default() };
/// assert!(solve(&panda, &own.goals, &options)?.success);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// A task that is neither a goal nor a posture nor a criterion, named; several postures or criteria.
pub fn goals_of(tasks: &[MotionTask]) -> Result<TaskGoals> {
    let refuse = |task: &MotionTask, reason: &str| {
        let reason = reason.to_owned();
        Err(Error::InvalidOption { option: "tasks", value: task.name.clone(), reason })
    };
    let (mut all, mut criteria) = (TaskGoals::default(), Vec::new());
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
                if all.posture.replace(q.clone()).is_some() {
                    return refuse(task, "inverse kinematics takes one posture");
                }
                continue;
            }
            TaskObjective::Manipulability { end_effector, components } => {
                let (end_effector, components) = (*end_effector, *components);
                criteria.push((task, Criterion::Manipulability { end_effector, components }));
                continue;
            }
            TaskObjective::LimitAvoidance { margin } => {
                criteria.push((task, Criterion::LimitAvoidance { margin: *margin }));
                continue;
            }
            TaskObjective::JointVelocities { .. } | TaskObjective::Custom(_) => {
                return refuse(
                    task,
                    "inverse kinematics takes frames, relative frames, the centre of mass, gaze, \
                     a posture, manipulability and limit avoidance",
                );
            }
        };
        all.goals.push(Goal::from(objective).with_weight(task.weight));
    }
    if let Some((task, _)) = criteria.get(1) {
        return refuse(task, "inverse kinematics takes one criterion");
    }
    all.criterion = criteria.first().map(|(_, criterion)| *criterion);
    Ok(all)
}
