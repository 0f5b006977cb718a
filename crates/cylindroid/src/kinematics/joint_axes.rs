//! Where joints and contacts stand in the world: the axes of joints of the tree and of loop joints,
//! the points of contacts.
//!
//! Formula  world_from_joint = world_from_parent * parent_from_joint on the parent, world_from_child
//!          * child_from_joint on the child; the axis is that of the joint frame
//! Shapes   a line for each side of a joint, a point for each side of a contact
//! Units    m; unit directions
//! Frame    world
//! Valid    any joint; a joint without an axis (spherical, fixed) has the z axis of its frame. The
//!          second axis of a universal joint is in its kind
//! Checked  tests/it/joint_axes.rs

use super::State;
use crate::screws::Line;
use crate::spatial::{Pose, Vec3};

/// The axis of a joint in the world, through the origin of the joint frame, on each of its links.
///
/// The two coincide for a revolute joint, and for a prismatic joint they are displaced along the
/// axis by its coordinate; those of a loop joint differ besides by the closure error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointAxis {
    /// On its parent, or on the first link of a loop joint.
    pub on_parent: Line,
    /// On its child, or on the second link of a loop joint.
    pub on_child: Line,
}

impl JointAxis {
    fn of(on_parent: Pose, on_child: Pose, axis: Vec3) -> Self {
        let line = |pose: Pose| Line { point: pose.translation, direction: pose.rotation * axis };
        Self { on_parent: line(on_parent), on_child: line(on_child) }
    }
}

impl State {
    /// The axes of all joints of the tree, in the order of [`Mechanism::joints`].
    ///
    /// [`Mechanism::joints`]: crate::model::Mechanism::joints
    #[must_use]
    pub fn joint_axes(&self) -> Vec<JointAxis> {
        let joints = self.mechanism().joints().iter();
        joints
            .map(|j| {
                let on_parent = self.link_pose(j.parent) * j.parent_from_joint;
                let on_child = self.link_pose(j.child) * j.joint_from_child.inverse();
                JointAxis::of(on_parent, on_child, j.axis)
            })
            .collect()
    }

    /// The axes of all loop joints, in the order of [`Mechanism::loops`].
    ///
    /// ```
    /// use cylindroid::Vec3;
    ///
    /// // The five-bar is cut at its last pivot, on the ground.
    /// let five_bar = cylindroid::load("five-bar")?;
    /// let axes = five_bar.state(five_bar.home())?.loop_joint_axes();
    /// assert_eq!(five_bar.loops()[0].name, "q5");
    /// assert!((axes[0].on_parent.point - Vec3::new(2.0, 0.0, 0.0)).norm() < 1e-15);
    /// assert_eq!(axes[0].on_parent.direction, Vec3::Z);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// [`Mechanism::loops`]: crate::model::Mechanism::loops
    #[must_use]
    pub fn loop_joint_axes(&self) -> Vec<JointAxis> {
        let joints = self.mechanism().loops().iter();
        joints
            .map(|j| {
                let on_first = self.link_pose(j.a) * j.link_a_from_joint;
                let on_second = self.link_pose(j.b) * j.link_b_from_joint;
                JointAxis::of(on_first, on_second, j.axis)
            })
            .collect()
    }

    /// The points of all contacts in the world (m), on the first link and on the second, in the order
    /// of [`Mechanism::contacts`]; the two differ by the closure error.
    ///
    /// ```
    /// // Two arms hold a box on opposite sides; its reference point is in the middle.
    /// let arms = cylindroid::load("two-arm")?;
    /// let state = arms.state(arms.home())?;
    /// let [left, right] = [state.contact_points()[0], state.contact_points()[1]];
    /// let middle = (left[1] + right[1]) * 0.5;
    /// assert!((middle - state.pose(arms.reference())?.translation).norm() < 1e-12);
    /// assert!((left[0] - left[1]).norm() < 1e-9);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// [`Mechanism::contacts`]: crate::model::Mechanism::contacts
    #[must_use]
    pub fn contact_points(&self) -> Vec<[Vec3; 2]> {
        let contacts = self.mechanism().contacts().iter();
        contacts
            .map(|c| {
                let on_first = self.link_pose(c.a) * c.link_a_from_contact;
                let on_second = self.link_pose(c.b) * c.link_b_from_contact;
                [on_first.translation, on_second.translation]
            })
            .collect()
    }

    /// The pose of a link in the world.
    pub(crate) fn link_pose(&self, link: usize) -> Pose {
        self.pose_of(self.mechanism().link_frame(link))
    }
}
