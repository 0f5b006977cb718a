//! Targets from messages: poses and twists in the axes of the frame that their header names.

use cylindroid::spatial::Quaternion;
use cylindroid::{Pose, State, Twist, Vec3};

use crate::messages::{self, Header, PoseStamped, TwistStamped};

/// How far the length of a quaternion may be from one [-]: of three printed digits.
const UNIT_LENGTH: f64 = 1e-2;

/// What the tool follows, in the axes of the robot's root.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Aim {
    Pose(Pose),
    Twist(Twist),
}

/// The pose that a message asks for.
pub(crate) fn pose(
    message: &PoseStamped,
    at: Option<&State>,
    robot: &Root<'_>,
) -> Result<Aim, String> {
    let root_from_frame = robot.frame(&message.header, at)?;
    let messages::Pose { position: p, orientation: o } = &message.pose;
    let (translation, q) =
        (Vec3::new(p.x, p.y, p.z), Quaternion { w: o.w, x: o.x, y: o.y, z: o.z });
    let length = q.w.hypot(q.x).hypot(q.y).hypot(q.z);
    if !translation.is_finite() || !length.is_finite() {
        return Err("a target pose is not finite".to_owned());
    }
    if (length - 1.0).abs() > UNIT_LENGTH {
        return Err(format!("the quaternion of a target pose has length {length:.3}, not 1"));
    }
    let rotation = q.rotation().map_err(|e| e.to_string())?;
    Ok(Aim::Pose(root_from_frame * Pose { rotation, translation }))
}

/// The twist that a message asks for: at the tool, in the axes of the frame, whatever its origin.
pub(crate) fn twist(
    message: &TwistStamped,
    scale: [f64; 2],
    at: Option<&State>,
    robot: &Root<'_>,
) -> Result<Aim, String> {
    let axes = robot.frame(&message.header, at)?.rotation;
    let vector = |v: &messages::Vector3, scale: f64| axes * (Vec3::new(v.x, v.y, v.z) * scale);
    let messages::Twist { linear, angular } = &message.twist;
    let twist = Twist { linear: vector(linear, scale[0]), angular: vector(angular, scale[1]) };
    if !(twist.linear.is_finite() && twist.angular.is_finite()) {
        return Err("a twist is not finite".to_owned());
    }
    Ok(Aim::Twist(twist))
}

/// The robot's root, in which targets are resolved.
pub(crate) struct Root<'a>(pub(crate) &'a cylindroid::Mechanism);

impl Root<'_> {
    /// `root_from_frame` of a header. No frame means the root.
    fn frame(&self, header: &Header, at: Option<&State>) -> Result<Pose, String> {
        let name = header.frame_id.trim_start_matches('/');
        if name.is_empty() || self.0.links().first().is_some_and(|link| link.name == name) {
            return Ok(Pose::IDENTITY);
        }
        let refused = |error: cylindroid::Error| format!("a target is refused: {error}");
        let id = self.0.frame(name).map_err(refused)?;
        let state = at.ok_or_else(|| {
            format!("a target in '{name}' is refused: the joint states are not complete")
        })?;
        state.pose(id).map_err(refused)
    }
}
