//! Specification of a joint for the builder, and its validation.
//!
//! Checked  tests/it/model.rs

use super::dimension::Dimension;
use super::joint::{JointKind, Limits, Mimic};
use super::magnitude;
use crate::spatial::{Pose, Vec3};
use crate::tolerance::ZERO_AXIS;

/// The specification of a joint for the builder; links by name.
#[derive(Debug, Clone, PartialEq)]
pub struct JointSpec {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: JointKind,
    /// Name of the parent link.
    pub parent: String,
    /// Name of the child link.
    pub child: String,
    /// The joint frame at zero, in the parent link.
    pub parent_from_joint: Pose,
    /// The child's link frame, in the joint frame that moves it.
    pub joint_from_child: Pose,
    /// The axis in the joint frame, any length.
    pub axis: Vec3,
    /// True if its coordinates describe the motion of the parent relative to the child.
    pub reversed: bool,
    /// Its limits.
    pub limits: Limits,
    /// The joint that it follows, for a mimic joint.
    pub mimic: Option<Mimic>,
    /// True if it is actuated.
    pub actuated: bool,
    /// Inertia of its drive, reflected to the joint [kg m^2, or kg for a slide], for each of its
    /// coordinates.
    pub armature: f64,
}

impl JointSpec {
    /// An actuated joint about (or along) z at the origin of the parent, without limits.
    #[must_use]
    pub fn new(name: &str, kind: JointKind, parent: &str, child: &str) -> Self {
        Self {
            name: name.to_owned(),
            kind,
            parent: parent.to_owned(),
            child: child.to_owned(),
            parent_from_joint: Pose::IDENTITY,
            joint_from_child: Pose::IDENTITY,
            axis: Vec3::Z,
            reversed: false,
            limits: Limits::NONE,
            mimic: None,
            actuated: true,
            armature: 0.0,
        }
    }

    /// Joints of one axis are reversed by their axis: the inverse motion is that about (or along)
    /// the opposite axis, pitch included.
    pub(super) fn normalise(&mut self) {
        if self.reversed && !self.kind.has_several_axes() {
            self.axis = -self.axis;
            self.reversed = false;
        }
    }

    /// The first fault of the specification, if any.
    pub(super) fn fault(&self, dimension: Dimension) -> Option<String> {
        let origins = [&self.parent_from_joint, &self.joint_from_child];
        if let Some(fault) = origins.into_iter().find_map(magnitude::pose_fault) {
            return Some(format!("the origin of joint '{}' {fault}", self.name));
        }
        if !(self.armature >= 0.0 && self.armature.is_finite()) {
            let (name, armature) = (&self.name, self.armature);
            return Some(format!(
                "the armature of joint '{name}' is {armature}; it must be finite and not negative"
            ));
        }
        fault(&self.name, self.kind, self.axis, &self.limits, dimension)
    }
}

/// The first fault of a joint, if any.
pub(super) fn fault(
    name: &str,
    kind: JointKind,
    axis: Vec3,
    limits: &Limits,
    dimension: Dimension,
) -> Option<String> {
    let in_plane = matches!(
        kind,
        JointKind::Fixed
            | JointKind::Revolute
            | JointKind::Continuous
            | JointKind::Prismatic
            | JointKind::Planar
    );
    if dimension == Dimension::Planar && !in_plane {
        return Some(format!(
            "joint '{name}' is {}, which leaves the plane; with dimension = 2 joints are \
             revolute, prismatic, planar or fixed",
            kind.name()
        ));
    }
    let mut axes = vec![];
    if !matches!(kind, JointKind::Fixed | JointKind::Spherical | JointKind::Free) {
        axes.push(axis);
    }
    if let JointKind::Universal { second } = kind {
        axes.push(second);
    }
    if axes.iter().any(|a| a.unit(ZERO_AXIS).is_none()) {
        return Some(format!(
            "the axis of joint '{name}' has no direction; give a vector that is finite and not zero"
        ));
    }
    // Their lengths are irrelevant: short axes are not parallel ones.
    if let JointKind::Universal { second } = kind
        && let (Some(a), Some(b)) = (axis.unit(ZERO_AXIS), second.unit(ZERO_AXIS))
        && a.cross(b).norm() <= ZERO_AXIS
    {
        return Some(format!(
            "the two axes of universal joint '{name}' are parallel; give two directions, or \
             make it revolute"
        ));
    }
    if let JointKind::Helical { pitch } = kind
        && let Some(fault) = magnitude::fault(&[pitch])
    {
        return Some(format!("the pitch of joint '{name}' {fault}"));
    }
    let l = limits;
    let all = [l.lower, l.upper, l.velocity, l.acceleration, l.jerk, l.effort];
    if let Some(fault) = magnitude::bound_fault(&all) {
        return Some(format!("a limit of joint '{name}' {fault}; for no limit use infinity"));
    }
    if l.lower.is_nan() || l.upper.is_nan() || l.lower > l.upper {
        return Some(format!(
            "joint '{name}' has lower limit {} above its upper limit {}; exchange them",
            l.lower, l.upper
        ));
    }
    if !l.permit_a_position() {
        return Some(format!(
            "joint '{name}' has position limits {} and {}, which exclude every finite position; \
             for no limits use -inf and inf",
            l.lower, l.upper
        ));
    }
    let bounded = l.lower > f64::NEG_INFINITY || l.upper < f64::INFINITY;
    if bounded && !kind.takes_position_limits() {
        return Some(format!(
            "joint '{name}' is {} and has position limits {} and {}, which cannot be enforced: \
             its velocities are not the derivative of q; leave them infinite, or model it as \
             revolute and prismatic joints in series, each with its limits",
            kind.name(),
            l.lower,
            l.upper
        ));
    }
    let sizes = [("velocity", l.velocity), ("acceleration", l.acceleration), ("effort", l.effort)];
    for (what, value) in sizes {
        if value.is_nan() || value < 0.0 {
            return Some(format!(
                "joint '{name}' has {what} limit {value}; it must not be negative"
            ));
        }
    }
    // Zero would keep a moving joint from ever stopping.
    if !(l.jerk > 0.0) {
        return Some(format!("joint '{name}' has jerk limit {}; it must be positive", l.jerk));
    }
    None
}
