//! Dependence of an inverse on the reference point: the same twist of the same tool, inverted with
//! another point as reference.
//!
//! Formula  q'_t = J_t+ s_t and q'_p = J_p+ s_p, s_p = [v + w x (p - t); w], J_p likewise
//! Shapes   J: 6 x m, m joints that move the tool; q': m
//! Units    m, rad, s; linear rows over L if the inverse mixes lengths with angles
//! Frame    world axes; reference points: the tool's origin t and the point p, fixed to the tool
//! Valid    trees, any rank. Hyperbolic inverses give the same joint velocities at every point,
//!          other inverses only if no component is discarded (rank 6 and no damping)
//! Why so   the Moore-Penrose inverse of an arm with fewer than six joints, and damping of any arm,
//!          weigh metres against radians, and the metres depend on the point
//! Source   Donelan & Selig, sections 1 and 5; Doty, Melchiorri & Bonivento 1993
//! Checked  tests/it/servo/reference_point.rs

use super::inverse_choice::InverseChoice;
use crate::error::{Error, Result};
use crate::kinematics::{Chain, EndEffector, ReferenceFrame, State};
use crate::linalg::{Matrix, norm};
use crate::screws::NoInverse;
use crate::spatial::{Pose, Twist, Vec3};
use crate::tolerance::{MAX_MAGNITUDE, SAME_RATES};

/// The inverse of a twist for one reference point.
#[derive(Debug, Clone, PartialEq)]
pub struct VelocitiesAtPoint {
    /// Velocities of the joints that move the tool [rad/s or m/s]; `None` if there is no inverse.
    pub joint_velocities: Option<Vec<f64>>,
    /// The realised twist, at the tool, world axes.
    pub achieved: Option<Twist>,
    /// The reason why there is none.
    pub reason: Option<NoInverse>,
}

/// Comparison of an inverse at two reference points: the same twist of the same tool, inverted at
/// the tool's origin t and at another point p fixed to the tool.
///
/// ```text
/// q'_t = J_t+ s_t,   q'_p = J_p+ s_p,   s_p = [v + w x (p - t); w],   J_p likewise
/// ```
///
/// World axes; J is 6 x m for the m joints that move the tool, with linear rows divided by L if the
/// inverse mixes lengths with angles. Hyperbolic inverses give the same joint velocities at every
/// point, other inverses only if no component is discarded (rank 6 and no damping).
///
/// Source: Donelan & Selig, sections 1 and 5; Doty, Melchiorri & Bonivento 1993.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferencePointComparison {
    /// Indices in `q` of the joints that move the tool.
    pub coordinates: Vec<usize>,
    /// With the tool's origin as reference point.
    pub at_tool: VelocitiesAtPoint,
    /// With the other point as reference point.
    pub at_point: VelocitiesAtPoint,
    /// Norm of the difference of the joint velocities [rad/s or m/s]; `None` if one of them does
    /// not exist.
    pub difference: Option<f64>,
    /// True if the difference is rounding (`tolerance::SAME_RATES` of the velocities).
    pub invariant: bool,
}

impl InverseChoice {
    /// Inverts `asked`, the twist of the tool (at the tool, world axes), at the tool and with the
    /// reference point moved to `point` (world).
    ///
    /// ```
    /// use cylindroid::control::{InverseChoice, TaskProjection};
    /// use cylindroid::{EndEffector, Method, Twist, Vec3};
    ///
    /// // An arm with three joints: the truncated inverse depends on the reference point.
    /// let robot = cylindroid::load("3r")?;
    /// let state = robot.state(&[0.3, 0.5, -0.8])?;
    /// let choice = InverseChoice {
    ///     method: Method::default(),
    ///     projection: TaskProjection::Orthogonal,
    ///     length: robot.reach(),
    /// };
    /// let asked = Twist { linear: Vec3::new(0.1, 0.2, 0.3), angular: Vec3::new(0.3, 0.2, 0.1) };
    /// let tool = EndEffector::from(robot.tool());
    /// let compared = choice.at_two_points(&state, tool, asked, Vec3::new(1.0, 2.0, 3.0))?;
    /// assert!(!compared.invariant && compared.difference.is_some());
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A closed chain, whose joints are not independent; an end effector of another mechanism;
    /// values that are non-finite or outside the domain of the method.
    pub fn at_two_points(
        &self,
        state: &State,
        tool: EndEffector,
        asked: Twist,
        point: Vec3,
    ) -> Result<ReferencePointComparison> {
        let mechanism = state.mechanism();
        mechanism.check_frame(tool.frame)?;
        if mechanism.is_closed() {
            return Err(Error::Model {
                model: mechanism.name().to_owned(),
                culprit: String::new(),
                message: "inverses can be compared only for arms without loops; loops couple the \
                          joint velocities"
                    .to_owned(),
            });
        }
        Error::check_within("twist", &asked.to_array(), MAX_MAGNITUDE)?;
        Error::check_within("point", &point.to_array(), MAX_MAGNITUDE)?;
        let pose = state.pose_of(tool);
        let coordinates = Chain::of(mechanism, tool).coordinates().to_vec();
        let at = |p: Vec3| self.at_point(state, (tool, pose), &coordinates, asked, p);
        let (at_tool, at_point) = (at(pose.translation)?, at(point)?);
        let both = at_tool.joint_velocities.as_ref().zip(at_point.joint_velocities.as_ref());
        let difference =
            both.map(|(a, b)| norm(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>()));
        let size = at_tool.joint_velocities.as_ref().map_or(0.0, |rates| norm(rates));
        let invariant = difference.is_some_and(|d| d <= SAME_RATES * size);
        Ok(ReferencePointComparison { coordinates, at_tool, at_point, difference, invariant })
    }

    /// With the reference point `p` (world).
    fn at_point(
        &self,
        state: &State,
        (tool, pose): (EndEffector, Pose),
        coordinates: &[usize],
        asked: Twist,
        p: Vec3,
    ) -> Result<VelocitiesAtPoint> {
        let moved = pose.inverse() * Pose { translation: p, ..pose };
        let there = EndEffector { frame_from_tool: tool.frame_from_tool * moved, ..tool };
        let all = state.jacobian(there, ReferenceFrame::LocalWorldAligned)?;
        let j = Matrix::from_fn(6, coordinates.len(), |i, k| all[(i, coordinates[k])]);
        let twist = asked.at_point(p - pose.translation);
        let at_p = |t: Twist, from| match from {
            ReferenceFrame::Local => pose.adjoint(t).at_point(p),
            ReferenceFrame::World => t.at_point(p),
            ReferenceFrame::LocalWorldAligned => t.at_point(p - pose.translation),
        };
        let inverse = self.of_matrix(&j, Some(twist), at_p)?;
        if !inverse.exists {
            return Ok(VelocitiesAtPoint {
                joint_velocities: None,
                achieved: None,
                reason: inverse.reason,
            });
        }
        let rates = inverse.matrix.mul_vec(&twist.to_array());
        let done = j.mul_vec(&rates);
        let done = Twist::from_array(std::array::from_fn(|i| done[i]));
        let done = done.at_point(pose.translation - p);
        Ok(VelocitiesAtPoint { joint_velocities: Some(rates), achieved: Some(done), reason: None })
    }
}
