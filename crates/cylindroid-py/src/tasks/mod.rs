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
