//! Goals of inverse kinematics: a target pose, or a subset of its components.
//!
//! Checked  tests/it/ik.rs

use crate::error::{Error, Result};
use crate::kinematics::{EndEffector, ReferenceFrame};
use crate::model::{Dimension, Mechanism};
use crate::spatial::{Pose, Twist};

/// The components of an end effector's motion that form a task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Task {
    /// Translation along x, y, z and rotation about x, y, z.
    pub components: [bool; 6],
    /// The axes of the components: `Local` (the tool's) or `LocalWorldAligned` (the world's).
    pub axes: ReferenceFrame,
}

impl Task {
    /// The names of the components, in the order of a twist.
    pub const COMPONENTS: [&str; 6] = ["x", "y", "z", "rx", "ry", "rz"];

    /// Position and orientation.
    pub const POSE: Self = Self { components: [true; 6], axes: ReferenceFrame::LocalWorldAligned };
    /// Position and orientation in the plane x-y.
    pub const PLANAR: Self = Self {
        components: [true, true, false, false, false, true],
        axes: ReferenceFrame::LocalWorldAligned,
    };
    /// Position alone.
    pub const POSITION: Self = Self {
        components: [true, true, true, false, false, false],
        axes: ReferenceFrame::LocalWorldAligned,
    };
    /// Orientation alone.
    pub const ORIENTATION: Self = Self {
        components: [false, false, false, true, true, true],
        axes: ReferenceFrame::LocalWorldAligned,
    };
    /// Position and the direction of the tool's z axis: a task for five joints.
    pub const POINTING: Self =
        Self { components: [true, true, true, true, true, false], axes: ReferenceFrame::Local };

    /// The task of this name: `pose`, `position`, `orientation`, `pointing`, or components such as
    /// `x,y,rz`. For planar mechanisms with loops the first three refer to the plane, as in
    /// [`ServoOptions::new`](crate::ServoOptions::new).
    ///
    /// ```
    /// use cylindroid::{catalogue, ik::Task};
    ///
    /// let (arm, linkage) = (catalogue::load("3r")?, catalogue::load("five-bar")?);
    /// assert_eq!(Task::named("pose", &arm)?, Task::POSE);
    /// assert_eq!(Task::named("pose", &linkage)?, Task::PLANAR);
    /// assert_eq!(Task::named("x, y,rz", &arm)?, Task::PLANAR);
    /// assert!(Task::named("x,yaw", &arm).is_err());
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest names.
    pub fn named(name: &str, mechanism: &Mechanism) -> Result<Self> {
        let mut task = match name {
            "pose" => Self::POSE,
            "position" => Self::POSITION,
            "orientation" => Self::ORIENTATION,
            "pointing" => return Ok(Self::POINTING),
            list => return Self::of_components(list),
        };
        if mechanism.is_closed() && mechanism.dimension() == Dimension::Planar {
            for (on, in_plane) in task.components.iter_mut().zip(Self::PLANAR.components) {
                *on &= in_plane;
            }
        }
        Ok(task)
    }

    fn of_components(list: &str) -> Result<Self> {
        let mut components = [false; 6];
        for name in list.split(',').map(str::trim) {
            let place = Self::COMPONENTS.iter().position(|c| *c == name).ok_or_else(|| {
                let known = ["pose", "position", "orientation", "pointing"];
                let known = known.iter().chain(&Self::COMPONENTS);
                Error::unknown("task or task component", name, known)
            })?;
            components[place] = true;
        }
        Ok(Self { components, ..Self::POSE })
    }

    /// Rejects a task without components, and axes at the world origin.
    pub(crate) fn check(self) -> Result<()> {
        if !self.components.contains(&true) {
            return Err(Error::InvalidOption {
                option: "task",
                value: "no components".to_owned(),
                reason: "name at least one of x, y, z, rx, ry, rz".to_owned(),
            });
        }
        if self.axes == ReferenceFrame::World {
            return Err(Error::InvalidOption {
                option: "task axes",
                value: "world".to_owned(),
                reason: "the error is taken at the tool; use local or local_world_aligned"
                    .to_owned(),
            });
        }
        Ok(())
    }

    /// The error from `pose` to `target` in the axes of the task, zero in the other components.
    ///
    /// ```
    /// use cylindroid::ik::Task;
    /// use cylindroid::{Pose, Rotation, Vec3};
    ///
    /// // The position only: an error of orientation does not count.
    /// let target = Pose { rotation: Rotation::about_z(0.3), translation: Vec3::X };
    /// let error = Task::POSITION.error(Pose::IDENTITY, target);
    /// assert_eq!((error.linear, error.angular), (Vec3::X, Vec3::ZERO));
    /// ```
    #[must_use]
    pub fn error(self, pose: Pose, target: Pose) -> Twist {
        self.seen(pose, pose.error_to(target))
    }

    /// A twist of the tool in world axes, in the axes and components of the task.
    pub(crate) fn seen(self, pose: Pose, twist: Twist) -> Twist {
        let r = pose.rotation.matrix();
        let twist = match self.axes {
            ReferenceFrame::Local => {
                Twist { linear: r.tr_mul(twist.linear), angular: r.tr_mul(twist.angular) }
            }
            ReferenceFrame::World | ReferenceFrame::LocalWorldAligned => twist,
        };
        let mut v = twist.to_array();
        for (x, keep) in v.iter_mut().zip(self.components) {
            *x *= f64::from(u8::from(keep));
        }
        Twist::from_array(v)
    }
}

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
