//! Joint transforms, and the poses of all links at a configuration.
//!
//! Formula  parent_from_child = parent_from_joint transform(q) joint_from_child, with the inverse
//!          of the transform for reversed joints
//! Why so   kinematics works on nodes and depends on the model; loaders need poses while they
//!          write the model, once for each file, so the plain product is sufficient here
//! Checked  tests/it/graph.rs::motion_* (against `State`), tests/formats/closed_file.rs

use std::collections::BTreeMap;

use super::joint::{Joint, JointKind};
use super::mechanism::Mechanism;
use crate::spatial::{Pose, Rotation, Vec3};
use crate::tolerance::ZERO_AXIS;

impl JointKind {
    /// The joint transform: the pose of the joint frame moved by `q`, in the joint frame at zero.
    /// Missing coordinates count as zero.
    ///
    /// ```text
    /// parent_from_child = parent_from_joint transform(q) joint_from_child
    /// ```
    ///
    /// Revolute `R(a, q)`; prismatic `T(q a)`; helical `T(pitch q a) R(a, q)`; cylindrical
    /// `T(q0 a) R(a, q1)`; universal `R(a, q0) R(second, q1)`; spherical `exp(q)`; planar `q0`,
    /// `q1` across and `q2` about the axis; free: translation, then rotation vector. a is the unit
    /// `axis`; angles in rad, lengths in m, pitch in m/rad. Reversed joints use the inverse.
    ///
    /// ```
    /// use cylindroid::Vec3;
    /// use cylindroid::model::JointKind;
    ///
    /// // Half a turn advances a helical joint by pi times its pitch.
    /// let half = JointKind::Helical { pitch: 0.01 }.transform(Vec3::Z, &[std::f64::consts::PI]);
    /// assert_eq!(half.translation, Vec3::Z * (0.01 * std::f64::consts::PI));
    /// ```
    #[must_use]
    pub fn transform(self, axis: Vec3, q: &[f64]) -> Pose {
        let axis = axis.unit(ZERO_AXIS).unwrap_or(Vec3::Z);
        let x = |i: usize| q.get(i).copied().unwrap_or(0.0);
        let vector = |i: usize| Vec3::new(x(i), x(i + 1), x(i + 2));
        let turn = |axis: Vec3, angle: f64| Rotation::about(axis, angle).unwrap_or_default();
        match self {
            Self::Fixed => Pose::IDENTITY,
            Self::Revolute | Self::Continuous => Pose::from_rotation(turn(axis, x(0))),
            Self::Prismatic => Pose::from_translation(axis * x(0)),
            Self::Helical { pitch } => {
                Pose { rotation: turn(axis, x(0)), translation: axis * (pitch * x(0)) }
            }
            Self::Cylindrical => Pose { rotation: turn(axis, x(1)), translation: axis * x(0) },
            Self::Universal { second } => {
                Pose::from_rotation(turn(axis, x(0)) * turn(second, x(1)))
            }
            Self::Spherical => Pose::from_rotation(Rotation::exp(vector(0))),
            Self::Planar => {
                let frame = Rotation::z_to(axis).unwrap_or_default();
                let translation = frame * Vec3::new(x(0), x(1), 0.0);
                Pose { rotation: turn(axis, x(2)), translation }
            }
            Self::Free => Pose { rotation: Rotation::exp(vector(3)), translation: vector(0) },
        }
    }
}

impl Mechanism {
    /// The pose of every link in the root, for a `q` that was checked.
    pub(crate) fn link_poses(&self, q: &[f64]) -> Vec<Pose> {
        let mut poses = vec![Pose::IDENTITY; self.links().len()];
        for (joint, motion) in self.joints().iter().zip(self.joint_motions(q)) {
            poses[joint.child] =
                poses[joint.parent] * joint.parent_from_joint * motion * joint.joint_from_child;
        }
        poses
    }

    /// The motion of every joint of the tree from zero, in its frame, for a `q` that was checked.
    pub(super) fn joint_motions(&self, q: &[f64]) -> Vec<Pose> {
        let values = self.mimic_values(q);
        let motion = |(joint, value): (&Joint, f64)| {
            let motion = if joint.mimic.is_some() {
                joint.kind.transform(joint.axis, &[value])
            } else {
                joint.kind.transform(joint.axis, &q[joint.coordinates.clone()])
            };
            if joint.reversed { motion.inverse() } else { motion }
        };
        self.joints().iter().zip(values).map(motion).collect()
    }

    /// The values of the mimic joints, zero for the others.
    fn mimic_values(&self, q: &[f64]) -> Vec<f64> {
        let joints = self.joints();
        let index: BTreeMap<&str, usize> = if joints.iter().any(|j| j.mimic.is_some()) {
            joints.iter().enumerate().map(|(i, j)| (j.name.as_str(), i)).collect()
        } else {
            BTreeMap::new()
        };
        let mut values = vec![0.0; joints.len()];
        let mut known = vec![false; joints.len()];
        for start in (0..joints.len()).filter(|&i| joints[i].mimic.is_some()) {
            // Mimic joints may follow one another, in any order of the tree.
            let mut chain = Vec::new();
            let mut at = start;
            while let Some(mimic) = joints[at].mimic.as_ref().filter(|_| !known[at]) {
                chain.push((at, mimic));
                let Some(&source) = index.get(mimic.joint.as_str()) else { break };
                at = source;
            }
            let mut value = if joints[at].mimic.is_some() {
                values[at]
            } else {
                joints[at].coordinates.clone().map(|c| q[c]).sum()
            };
            for (joint, mimic) in chain.into_iter().rev() {
                value = mimic.multiplier * value + mimic.offset;
                (values[joint], known[joint]) = (value, true);
            }
        }
        values
    }
}
