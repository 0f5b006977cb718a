//! The six joints of a chain: their kind, and their axes at zero.
//!
//! Checked  tests/it/analytic/

use super::geometry::Axes;
use crate::kinematics::{Chain, EndEffector, ReferenceFrame};
use crate::linalg::Matrix;
use crate::model::{Mechanism, NodeKind};
use crate::screws::Screw;
use crate::spatial::Twist;

/// True if each coordinate rotates exactly one revolute joint between the ground and the end
/// effector.
pub(super) fn are_revolute(
    mechanism: &Mechanism,
    end_effector: EndEffector,
    coordinates: &[usize; 6],
) -> bool {
    let mut slot = mechanism.frame_of(end_effector.frame).slot;
    let mut revolute = 0;
    while slot > 0 {
        let node = &mechanism.nodes()[slot - 1];
        if coordinates.contains(&node.coordinate) && node.kind.dof() > 0 {
            if node.kind != NodeKind::Revolute || (node.multiplier, node.offset) != (1.0, 0.0) {
                return false;
            }
            revolute += 1;
        }
        slot = node.parent;
    }
    revolute == 6
}

/// True if the locked coordinates move only nodes that follow the six joints: the tool, and none of
/// their axes.
pub(super) fn move_tool_only(
    mechanism: &Mechanism,
    end_effector: EndEffector,
    coordinates: &[usize; 6],
    locked: &[usize],
) -> bool {
    let mut slot = mechanism.frame_of(end_effector.frame).slot;
    let mut has_met_six = false;
    while slot > 0 {
        let node = &mechanism.nodes()[slot - 1];
        let own = node.coordinate..node.coordinate + node.kind.dof();
        has_met_six |= own.clone().any(|c| coordinates.contains(&c));
        if has_met_six && own.into_iter().any(|c| locked.contains(&c)) {
            return false;
        }
        slot = node.parent;
    }
    true
}

/// The axes with the six coordinates at zero and the others as in `q`.
pub(super) fn axes(
    chain: &mut Chain,
    coordinates: &[usize; 6],
    q: &[f64],
    jacobian: &mut Matrix,
) -> Option<Axes> {
    let tool = chain.set(q).translation;
    chain.jacobian_into(ReferenceFrame::World, jacobian);
    let mut lines = [crate::screws::Line { point: tool, direction: crate::spatial::Vec3::Z }; 6];
    for (line, c) in lines.iter_mut().zip(coordinates) {
        let column = jacobian.column(chain.coordinates().partition_point(|x| x < c));
        *line = Screw::of(Twist::from_array(column.try_into().ok()?))?.axis;
    }
    Some(Axes { lines, tool })
}
