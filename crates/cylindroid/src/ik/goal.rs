//! Goals of inverse kinematics: frames, frames relative to each other, the centre of mass, gaze.
//!
//! Checked  tests/it/ik.rs, tests/it/ik_goals.rs

use std::ops::RangeInclusive;

use crate::error::{Error, Result};
use crate::kinematics::EndEffector;
use crate::model::Mechanism;
use crate::spatial::{Pose, Vec3};
use crate::task::{Gaze, RelativeFrame, Task, check_pose, check_target};
use crate::tolerance::MAX_MAGNITUDE;

/// Weights whose squares, and the products with those of errors, are numbers [-].
const WEIGHTS: RangeInclusive<f64> = 1e-100..=1e100;

/// What a goal places, and its target.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Objective {
    /// A frame at a pose in the world.
    Frame {
        /// The frame and tool point.
        end_effector: EndEffector,
        /// The components of the task.
        components: Task,
        /// Desired `world_from_tool`.
        target: Pose,
    },
    /// A frame at a pose relative to another one: two hands on one object, a tool beside a tool.
    RelativeFrame {
        /// The frame and tool point.
        end_effector: EndEffector,
        /// The frame from which its pose is seen.
        reference: EndEffector,
        /// The components of the task, in the axes of the reference.
        components: Task,
        /// Desired `reference_from_tool`.
        target: Pose,
    },
    /// The centre of mass of the moving links at a point of the world (m).
    CenterOfMass {
        /// The axes that count.
        axes: [bool; 3],
        /// The point.
        target: Vec3,
    },
    /// The z axis of a frame towards a point of the world.
    Gaze {
        /// The frame that looks along its z axis.
        end_effector: EndEffector,
        /// The point (m).
        point: Vec3,
    },
}

impl Objective {
    /// True if both differ in their targets alone.
    pub(super) fn is_as(&self, other: &Self) -> bool {
        let at_origin = |objective: &Self| match *objective {
            Self::Frame { end_effector, components, .. } => {
                Self::Frame { end_effector, components, target: Pose::IDENTITY }
            }
            Self::RelativeFrame { end_effector, reference, components, .. } => {
                let target = Pose::IDENTITY;
                Self::RelativeFrame { end_effector, reference, components, target }
            }
            Self::CenterOfMass { axes, .. } => Self::CenterOfMass { axes, target: Vec3::ZERO },
            Self::Gaze { end_effector, .. } => Self::Gaze { end_effector, point: Vec3::ZERO },
        };
        at_origin(self) == at_origin(other)
    }

    /// Rejects frames of other mechanisms, non-finite values, and a goal without components.
    fn check(&self, mechanism: &Mechanism) -> Result<()> {
        match *self {
            Self::Frame { end_effector, components, target } => {
                mechanism.check_frame(end_effector.frame)?;
                check_pose("frame_from_tool of the end effector", &end_effector.frame_from_tool)?;
                check_target(&target)?;
                components.check()
            }
            Self::RelativeFrame { end_effector, reference, components, target } => {
                RelativeFrame { end_effector, reference, components, target }.check(mechanism)
            }
            Self::CenterOfMass { axes, target } => {
                let what = "target of the centre of mass";
                Error::check_within(what, &target.to_array(), MAX_MAGNITUDE)?;
                if !axes.contains(&true) {
                    return Err(Error::InvalidOption {
                        option: "axes of the centre of mass",
                        value: "none".to_owned(),
                        reason: "name at least one of x, y, z".to_owned(),
                    });
                }
                mechanism.check_masses()
            }
            Self::Gaze { end_effector, point } => Gaze { end_effector, point }.check(mechanism),
        }
    }
}

/// A goal with its weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// What it places, and its target.
    pub objective: Objective,
    /// Factor of its errors, against those of other goals, where not all can be reached; a solution
    /// reaches all of them in any case.
    pub weight: f64,
}

impl From<Objective> for Goal {
    fn from(objective: Objective) -> Self {
        Self { objective, weight: 1.0 }
    }
}

impl Goal {
    /// A frame at a complete pose.
    ///
    /// ```
    /// use cylindroid::ik::{Goal, IkOptions, Task, solve};
    ///
    /// // The complete pose, then its position only.
    /// let robot = cylindroid::load("ur5e")?;
    /// let target = robot.state(&[0.3, -1.1, 1.4, 0.2, 1.0, 0.4])?.pose(robot.tool())?;
    /// let pose = Goal::pose(robot.tool(), target);
    /// let position = Goal::frame(robot.tool(), Task::POSITION, target);
    /// assert!(solve(&robot, &[pose], &IkOptions::default())?.success);
    /// assert!(solve(&robot, &[position], &IkOptions::default())?.success);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn pose(end_effector: impl Into<EndEffector>, target: Pose) -> Self {
        Self::frame(end_effector, Task::POSE, target)
    }

    /// Some components of a frame's pose.
    #[must_use]
    pub fn frame(end_effector: impl Into<EndEffector>, components: Task, target: Pose) -> Self {
        let end_effector = end_effector.into();
        Objective::Frame { end_effector, components, target }.into()
    }

    /// A frame at a complete pose seen from another one, `reference_from_tool`.
    ///
    /// ```
    /// use cylindroid::ik::{Goal, IkOptions, solve};
    /// use cylindroid::{Pose, Vec3};
    ///
    /// // The hand 0.3 m from the elbow along the axis of the forearm, and 0.2 m beside it.
    /// let panda = cylindroid::load("panda")?;
    /// let (hand, elbow) = (panda.tool(), panda.frame("link4")?);
    /// let state = panda.state(&[0.0, 0.2, 0.0, -1.5, 0.4, 1.2, 0.3])?;
    /// let goal = Goal::relative(hand, elbow, state.pose(elbow)?.inverse() * state.pose(hand)?);
    /// let found = solve(&panda, &[goal], &IkOptions::default())?;
    /// assert!(found.success && found.position_error < 1e-5);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn relative(
        end_effector: impl Into<EndEffector>,
        reference: impl Into<EndEffector>,
        target: Pose,
    ) -> Self {
        let (end_effector, reference) = (end_effector.into(), reference.into());
        let components = Task::POSE;
        Objective::RelativeFrame { end_effector, reference, components, target }.into()
    }

    /// The centre of mass at a point of the world (m).
    #[must_use]
    pub fn center_of_mass(target: Vec3) -> Self {
        Objective::CenterOfMass { axes: [true; 3], target }.into()
    }

    /// The z axis of a frame towards a point of the world (m).
    ///
    /// ```
    /// use cylindroid::ik::{Goal, IkOptions, solve};
    /// use cylindroid::Vec3;
    ///
    /// let panda = cylindroid::load("panda")?;
    /// let point = Vec3::new(0.8, 0.5, 0.1);
    /// let found = solve(&panda, &[Goal::gaze(panda.tool(), point)], &IkOptions::default())?;
    /// let hand = panda.state(&found.q)?.pose(panda.tool())?;
    /// let way = point - hand.translation;
    /// assert!(hand.rotation.z_axis().cross(way).norm() < 1e-5 * way.norm());
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    #[doc(alias = "look-at")]
    pub fn gaze(end_effector: impl Into<EndEffector>, point: Vec3) -> Self {
        Objective::Gaze { end_effector: end_effector.into(), point }.into()
    }

    /// The same goal with another weight.
    #[must_use]
    pub fn with_weight(self, weight: f64) -> Self {
        Self { weight, ..self }
    }
}

/// The target of a frame alone.
pub(super) fn target_of(goals: &[Goal]) -> Option<Pose> {
    match goals {
        [Goal { objective: Objective::Frame { target, .. }, .. }] => Some(*target),
        _ => None,
    }
}

/// Returns an error for no goals, a closed chain, or a goal that is none for the mechanism.
pub(super) fn check_all(mechanism: &Mechanism, goals: &[Goal]) -> Result<()> {
    if mechanism.is_closed() {
        return Err(Error::Model {
            model: mechanism.name().to_owned(),
            culprit: String::new(),
            message: format!(
                "'{}' has loops or contacts, which a solver of its spanning tree would open; use \
                 ik::solve or ik::solve_distinct, which close them",
                mechanism.name()
            ),
        });
    }
    check_each(mechanism, goals)
}

/// Returns an error for no goals, or a goal that is none for the mechanism.
pub(super) fn check_each(mechanism: &Mechanism, goals: &[Goal]) -> Result<()> {
    if goals.is_empty() {
        return Err(Error::InvalidOption {
            option: "goals",
            value: "none".to_owned(),
            reason: "name an end effector and its target".to_owned(),
        });
    }
    goals.iter().try_for_each(|goal| {
        Error::check_range("weight of the goal", goal.weight, &WEIGHTS)?;
        goal.objective.check(mechanism)
    })
}
