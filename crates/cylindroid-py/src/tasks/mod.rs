//! The class `TaskServo` and its tasks: many tasks in one step.

mod collision_avoidance;
mod custom;
mod description;
mod gradient_tasks;
mod half_space;
mod motion_task;
mod report;
mod task_servo;

pub(crate) use collision_avoidance::PyCollisionAvoidance;
pub(crate) use gradient_tasks::{PyLimitAvoidanceTask, PyManipulabilityTask};
pub(crate) use half_space::PyHalfSpace;
pub(crate) use motion_task::{
    PyCenterOfMassTask, PyCustomTask, PyFrameTask, PyGazeTask, PyJointVelocitiesTask, PyMotionTask,
    PyPostureTask, PyRelativeFrameTask,
};
pub(crate) use report::PyTaskReport;
pub(crate) use task_servo::{PyTaskServo, TaskServoNumbers};

use cylindroid::Mechanism;
use cylindroid::control::{HalfSpace, MotionTask};
use pyo3::Py;

use self::custom::Raised;
use crate::error::Result;

/// The tasks for a mechanism, whose functions are not called.
pub(crate) fn motion_tasks(
    robot: &Mechanism,
    tasks: &[Py<PyMotionTask>],
) -> Result<Vec<MotionTask>> {
    let raised = Raised::default();
    tasks.iter().map(|task| task.get().of(robot, &raised)).collect()
}

/// The half-spaces for a mechanism.
pub(crate) fn half_spaces(robot: &Mechanism, all: &[Py<PyHalfSpace>]) -> Result<Vec<HalfSpace>> {
    all.iter().map(|half_space| half_space.get().of(robot)).collect()
}
