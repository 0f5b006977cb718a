//! A frame at a pose relative to another one.
//!
//! Formula  e as of a frame, for reference_from_tool in the axes of the reference;
//!          J = R_a^T (J_b - J_a at the point of b), a the reference, b the tool
//! Shapes   e: 6; J: 6 x n
//! Units    m, rad
//! Checked  tests/it/servo/tasks.rs::jacobians_are_derivatives_of_errors

use super::{Task, check_pose, twist_of};
use crate::error::Result;
use crate::kinematics::{EndEffector, State};
use crate::linalg::Matrix;
use crate::model::Mechanism;
use crate::spatial::{Pose, Twist};

/// Two frames and the desired pose of the one seen from the other.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RelativeFrame {
    pub(crate) end_effector: EndEffector,
    pub(crate) reference: EndEffector,
    /// In the axes of the reference.
    pub(crate) components: Task,
    /// Desired pose `reference_from_tool`.
    pub(crate) target: Pose,
}

impl RelativeFrame {
    /// Rejects frames of other mechanisms and non-finite values.
    pub(crate) fn check(&self, mechanism: &Mechanism) -> Result<()> {
        mechanism.check_frame(self.end_effector.frame)?;
        mechanism.check_frame(self.reference.frame)?;
        check_pose("tool of the frame", &self.end_effector.frame_from_tool)?;
        check_pose("tool of the reference frame", &self.reference.frame_from_tool)?;
        check_pose("target of the relative frame", &self.target)?;
        self.components.check()
    }

    /// The error at `state`, zero in components that do not count.
    pub(crate) fn error(&self, state: &State) -> Twist {
        let seen = state.pose_of(self.reference).inverse() * state.pose_of(self.end_effector);
        self.components.error(seen, self.target)
    }

    /// The Jacobian at `state`, of all six components, into `out` (6 x n).
    pub(crate) fn jacobian_into(&self, state: &State, out: &mut Matrix) {
        let (base, tip) = (state.tip(self.reference), state.tip(self.end_effector));
        tip.relative_jacobian_into(&base, out);
        let seen = base.world_from_tip.inverse() * tip.world_from_tip;
        let all = Task { components: [true; 6], ..self.components };
        for j in 0..out.cols() {
            let twist = twist_of(out.column(j));
            out.column_mut(j).copy_from_slice(&all.seen(seen, twist).to_array());
        }
    }
}
