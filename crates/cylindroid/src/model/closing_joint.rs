//! A joint that closes a loop and is actuated or has limits: it keeps its coordinate, and the loop is
//! cut in a link.
//!
//! Method   the joint connects its first link with a half of the second one, `second.joint`, and a
//!          weld at the joint's place connects both halves. The half brings as many coordinates as
//!          the weld has more rows than the joint
//! Valid    joints with coordinates. Mobility, hyperstaticity and singularities are those of the
//!          mechanism without limits
//! Why so   limits and measured positions need a coordinate; otherwise those of one joint of every
//!          loop would be ignored, and the spanning tree would choose which
//! Source   cut bodies besides cut joints: Wittenburg, Dynamics of Multibody Systems, 2nd ed., 2008
//! Checked  tests/formats/closing_limits.rs

use super::builder::Builder;
use super::joint::JointKind;
use super::joint_spec::JointSpec;
use super::loop_joint::{LoopJointSpec, weld_of};
use crate::spatial::Pose;

impl Builder {
    /// Adds the joint of a file that closes a loop: as a loop joint or, if it is actuated or has limits
    /// of position or velocity, with coordinates of its own.
    pub(super) fn closing_joint(&mut self, joint: LoopJointSpec) -> &mut Self {
        let limits = &joint.limits;
        let is_bounded = limits.lower > f64::NEG_INFINITY
            || limits.upper < f64::INFINITY
            || limits.velocity < f64::INFINITY;
        if joint.kind.dof() == 0 || !(joint.actuated || is_bounded) {
            return self.loop_joint(joint);
        }
        let half = format!("{}.{}", joint.b, joint.name);
        self.joint(JointSpec {
            parent_from_joint: joint.link_a_from_joint,
            axis: joint.axis,
            limits: joint.limits,
            actuated: joint.actuated,
            ..JointSpec::new(&joint.name, joint.kind, &joint.a, &half)
        });
        // No end of a chain (`default_tool.rs`).
        self.halves.insert(half.clone());
        self.loop_joint(LoopJointSpec {
            link_a_from_joint: Pose::IDENTITY,
            link_b_from_joint: joint.link_b_from_joint,
            ..LoopJointSpec::new(&weld_of(&half), JointKind::Fixed, &half, &joint.b)
        })
    }
}
