//! The screws of joints: the relative motions that a joint permits between its two links.
//!
//! Formula  tree joint: the columns that it contributes to the Jacobian of its child;
//!          loop-closure joint: its axis on its first link (the second axis of a universal joint on
//!          its second link)
//! Shapes   a screw for each coordinate; for a loop-closure joint as many as its kind has
//! Units    m, rad; amplitude 1, except for mimic joints, whose amplitude is their multiplier
//! Frame    world, at the world's origin
//! Valid    any configuration; the screws of a loop-closure joint are those of the closed loop
//! Checked  tests/it/kinematics.rs::screws_of_joints, tests/it/kinematics.rs::screws_of_*

use super::state::State;
use crate::model::JointKind;
use crate::screws::Screw;
use crate::spatial::{Pose, Twist, Vec3};

impl State {
    /// The screws of a joint of the tree (place in `Mechanism::joints`), one for each coordinate
    /// that moves it; none for a fixed joint or an invalid place.
    ///
    /// ```
    /// let robot = cylindroid::load("ur5e")?;
    /// let state = robot.state(robot.home())?;
    /// let joints = 0..robot.joints().len();
    /// let screws: Vec<_> = joints.flat_map(|joint| state.joint_screws(joint)).collect();
    /// assert_eq!(screws.len(), 6);
    /// assert!(screws.iter().all(|screw| screw.pitch.abs() < 1e-12));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn joint_screws(&self, joint: usize) -> Vec<Screw> {
        let Some(joint) = self.mechanism().joints().get(joint) else { return Vec::new() };
        let mut screws: Vec<(usize, Option<Screw>)> = Vec::new();
        self.for_each_twist_of(joint, |c, twist| screws.push((c, Screw::of(twist))));
        screws.sort_by_key(|(c, _)| *c);
        screws.into_iter().filter_map(|(_, screw)| screw).collect()
    }

    /// The screws of a loop-closure joint (place in `Mechanism::loops`); none for a fixed or free
    /// joint or an invalid place.
    ///
    /// ```
    /// let mechanism = cylindroid::load("five-bar")?;
    /// let state = mechanism.state(mechanism.home())?;
    /// // The revolute joint that closes the loop: one screw of pitch zero.
    /// let screws = state.loop_screws(0);
    /// assert!(screws.len() == 1 && screws[0].pitch == 0.0);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn loop_screws(&self, closing: usize) -> Vec<Screw> {
        let mechanism = self.mechanism();
        let Some(joint) = mechanism.loops().get(closing) else { return Vec::new() };
        let on_a: Pose = self.link_pose(joint.a) * joint.link_a_from_joint;
        let on_b: Pose = self.link_pose(joint.b) * joint.link_b_from_joint;
        let origin = on_a.translation;
        let axis = on_a.rotation * joint.axis;
        let turn = |direction: Vec3| Twist { linear: origin.cross(direction), angular: direction };
        let slide = |direction: Vec3| Twist { linear: direction, angular: Vec3::ZERO };
        let [x, y, z] = [on_a.rotation.x_axis(), on_a.rotation.y_axis(), on_a.rotation.z_axis()];
        let twists = match joint.kind {
            JointKind::Fixed | JointKind::Free => Vec::new(),
            JointKind::Revolute | JointKind::Continuous => vec![turn(axis)],
            JointKind::Prismatic => vec![slide(axis)],
            JointKind::Helical { pitch } => vec![turn(axis) + slide(axis) * pitch],
            JointKind::Cylindrical => vec![slide(axis), turn(axis)],
            JointKind::Universal { second } => vec![turn(axis), turn(on_b.rotation * second)],
            JointKind::Spherical => vec![turn(x), turn(y), turn(z)],
            JointKind::Planar => {
                let across = [x, y, z].map(|d| d - axis * d.dot(axis));
                let mut across: Vec<Vec3> =
                    across.into_iter().filter_map(|d| d.unit(0.5)).collect();
                across.truncate(1);
                let first = across.pop().unwrap_or(x);
                vec![slide(first), slide(axis.cross(first)), turn(axis)]
            }
        };
        twists.into_iter().filter_map(Screw::of).collect()
    }
}
