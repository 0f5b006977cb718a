//! Goals of inverse kinematics: a target pose, or a subset of its components.
//!
//! Checked  tests/it/ik.rs

use crate::error::{Error, Result};
use crate::kinematics::EndEffector;
use crate::model::Mechanism;
use crate::spatial::Pose;
use crate::task::Task;

/// An end effector, its target and the components of the task.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// The frame and tool point.
    pub end_effector: EndEffector,
    /// Desired `world_from_tool`.
    pub target: Pose,
    /// The components of the task.
    pub task: Task,
    /// Factor of its errors, against those of other goals, where not all can be reached; a solution
    /// reaches all of them in any case.
    pub weight: f64,
}

impl Goal {
    /// The complete pose.
    ///
    /// ```
    /// use cylindroid::ik::{Goal, IkOptions, Task, solve};
    ///
    /// // The complete pose, then its position only.
    /// let robot = cylindroid::load("ur5e")?;
    /// let target = robot.state(&[0.3, -1.1, 1.4, 0.2, 1.0, 0.4])?.pose(robot.tool());
    /// let pose = Goal::pose(robot.tool(), target);
    /// let position = Goal { task: Task::POSITION, ..pose };
    /// assert!(solve(&robot, &[pose], &IkOptions::default())?.success);
    /// assert!(solve(&robot, &[position], &IkOptions::default())?.success);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn pose(end_effector: impl Into<EndEffector>, target: Pose) -> Self {
        Self { end_effector: end_effector.into(), target, task: Task::POSE, weight: 1.0 }
    }

    /// Rejects frames of other mechanisms and non-finite values.
    pub(super) fn check(&self, mechanism: &Mechanism) -> Result<()> {
        mechanism.check_frame(self.end_effector.frame)?;
        if !self.end_effector.frame_from_tool.is_finite() {
            let what = "frame_from_tool of the end effector".to_owned();
            return Err(Error::NotFinite { what, value: f64::NAN });
        }
        Error::check_finite("target position", &self.target.translation.to_array())?;
        if !self.target.is_finite() {
            return Err(Error::NotFinite { what: "target orientation".into(), value: f64::NAN });
        }
        Error::check_positive("weight of the goal", self.weight)?;
        self.task.check()
    }
}

/// Returns an error for no goals, a closed chain, or a goal that is none for the mechanism.
pub(super) fn check_all(mechanism: &Mechanism, goals: &[Goal]) -> Result<()> {
    if goals.is_empty() {
        return Err(Error::InvalidOption {
            option: "goals",
            value: "none".to_owned(),
            reason: "name an end effector and its target".to_owned(),
        });
    }
    if mechanism.is_closed() {
        return Err(Error::Model {
            model: mechanism.name().to_owned(),
            culprit: String::new(),
            message: format!(
                "'{}' has loops or contacts, which inverse kinematics of its spanning tree would \
                 open; move its reference with a servo, or assemble it for given actuated joints",
                mechanism.name()
            ),
        });
    }
    goals.iter().try_for_each(|goal| goal.check(mechanism))
}
