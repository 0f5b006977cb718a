//! The components of an end effector's motion that form a task.
//!
//! Checked  tests/it/ik.rs

use crate::error::{Error, Result};
use crate::kinematics::ReferenceFrame;
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
