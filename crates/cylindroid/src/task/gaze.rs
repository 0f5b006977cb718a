//! The z axis of a frame towards a point of the world.
//!
//! Formula  e = angle(z, d) along z x d,  d = (p - o) / |p - o|;
//!          J = (1 - d d^T) (J_w + [d]x J_v / |p - o|)
//! Shapes   e: 3; J: 3 x n, in world axes
//! Units    rad
//! Valid    a point at the origin of the frame is looked at in every direction: e and J are zero
//! Checked  tests/it/servo/tasks.rs::jacobians_are_derivatives_of_errors

use super::{check_pose, twist_of};
use crate::error::{Error, Result};
use crate::kinematics::{EndEffector, ReferenceFrame, State};
use crate::linalg::Matrix;
use crate::model::Mechanism;
use crate::spatial::Vec3;
use crate::tolerance::MAX_MAGNITUDE;

/// A frame that looks along its z axis, and the point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gaze {
    pub(crate) end_effector: EndEffector,
    pub(crate) point: Vec3,
}

impl Gaze {
    /// Rejects frames of other mechanisms and non-finite values.
    pub(crate) fn check(&self, mechanism: &Mechanism) -> Result<()> {
        mechanism.check_frame(self.end_effector.frame)?;
        check_pose("tool of the gaze", &self.end_effector.frame_from_tool)?;
        Error::check_within("point of the gaze", &self.point.to_array(), MAX_MAGNITUDE)
    }

    /// The direction of the point, and its distance; `None` if it is at the origin of the frame.
    fn direction(&self, state: &State) -> Option<(Vec3, f64)> {
        let way = self.point - state.pose_of(self.end_effector).translation;
        let distance = way.norm();
        (distance > 0.0).then(|| (way * distance.recip(), distance))
    }

    /// The rotation vector from the z axis to the direction of the point, in world axes.
    pub(crate) fn error(&self, state: &State) -> Vec3 {
        let z = state.pose_of(self.end_effector).rotation.z_axis();
        self.direction(state).map_or(Vec3::ZERO, |(d, _)| turn_between(z, d))
    }

    /// The Jacobian at `state` into `out` (3 x n); `memory` is 6 x n.
    pub(crate) fn jacobian_into(&self, state: &State, memory: &mut Matrix, out: &mut Matrix) {
        let Some((d, distance)) = self.direction(state) else {
            out.as_mut_slice().fill(0.0);
            return;
        };
        state.tip(self.end_effector).jacobian_into(ReferenceFrame::LocalWorldAligned, memory);
        for j in 0..out.cols() {
            let own = twist_of(memory.column(j));
            let turned = own.angular + d.cross(own.linear) * distance.recip();
            out.column_mut(j).copy_from_slice(&(turned - d * d.dot(turned)).to_array());
        }
    }
}

/// The rotation vector of the smallest turn from one unit vector to another; about any axis across
/// if they are opposite.
fn turn_between(from: Vec3, to: Vec3) -> Vec3 {
    let across = from.cross(to);
    let (sin, cos) = (across.norm(), from.dot(to));
    if sin > 0.0 {
        return across * (sin.atan2(cos) / sin);
    }
    if cos > 0.0 {
        return Vec3::ZERO;
    }
    let other = if from.x.abs() < 0.6 { Vec3::X } else { Vec3::Y };
    let axis = from.cross(other);
    axis * (std::f64::consts::PI / axis.norm())
}
