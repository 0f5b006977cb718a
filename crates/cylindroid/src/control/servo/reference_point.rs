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

use super::projection::TaskProjection;
use crate::error::{Error, Result};
use crate::inverse::{
    HyperbolicDamping, HyperbolicOptions, Inverse, Method, hyperbolic_with, oblique,
    selectively_damped,
};
use crate::kinematics::{Chain, EndEffector, ReferenceFrame, State};
use crate::linalg::{Matrix, norm};
use crate::screws::{NoInverse, ScrewOptions};
use crate::spatial::{Pose, Twist, Vec3};
use crate::tolerance::SAME_RATES;

/// An inverse as chosen in [`ServoOptions`](super::ServoOptions): method, projection and length.
#[derive(Debug, Clone, PartialEq)]
pub struct InverseChoice {
    /// The method near singularities.
    pub method: Method,
    /// The part of a motion that is realised; the method is used only if it is orthogonal.
    pub projection: TaskProjection,
    /// Characteristic length (m).
    pub length: f64,
}

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
        Error::check_finite("twist", &asked.to_array())?;
        Error::check_finite("point", &point.to_array())?;
        Error::check_positive("length", self.length)?;
        self.projection.check()?;
        let pose = state.pose(tool);
        let coordinates = Chain::new(mechanism, tool).coordinates().to_vec();
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
        let all = state.jacobian(there, ReferenceFrame::LocalWorldAligned);
        let j = Matrix::from_fn(6, coordinates.len(), |i, k| all[(i, coordinates[k])]);
        let twist = asked.at_point(p - pose.translation).to_array();
        let (inverse, twist) = self.inverse(&j, twist, (pose, p))?;
        if !inverse.exists {
            return Ok(VelocitiesAtPoint {
                joint_velocities: None,
                achieved: None,
                reason: inverse.reason,
            });
        }
        let rates = inverse.matrix.mul_vec(&twist);
        let done = j.mul_vec(&rates);
        let done = Twist::from_array(std::array::from_fn(|i| done[i]));
        let done = done.at_point(pose.translation - p);
        Ok(VelocitiesAtPoint { joint_velocities: Some(rates), achieved: Some(done), reason: None })
    }

    /// The inverse at the reference point `p`, and the twist in the units that it takes.
    fn inverse(
        &self,
        j: &Matrix,
        twist: [f64; 6],
        (pose, p): (Pose, Vec3),
    ) -> Result<(Inverse, [f64; 6])> {
        let options = |damping| HyperbolicOptions {
            scale: ScrewOptions::with_length(self.length),
            damping,
            ..HyperbolicOptions::default()
        };
        let found = match &self.projection {
            TaskProjection::Orthogonal => {
                let scale = |i: usize| if i < 3 { 1.0 / self.length } else { 1.0 };
                let scaled = j.clone().scale_rows(&std::array::from_fn::<f64, 6, _>(scale));
                let twist = std::array::from_fn(|i| twist[i] * scale(i));
                let inverse = match self.method {
                    Method::SelectivelyDamped { max_joint_velocity } => {
                        selectively_damped(&scaled, &twist, max_joint_velocity)?
                    }
                    method => method.inverse(&scaled)?,
                };
                return Ok((inverse, twist));
            }
            TaskProjection::Hyperbolic { h } => {
                hyperbolic_with(j, *h, &options(HyperbolicDamping::None))?
            }
            TaskProjection::DampedHyperbolic { h, damping } => {
                hyperbolic_with(j, *h, &options(*damping))?
            }
            TaskProjection::Oblique { complement, reference } => {
                let at_p = |t: Twist| match reference {
                    ReferenceFrame::Local => pose.adjoint(t).at_point(p),
                    ReferenceFrame::World => t.at_point(p),
                    ReferenceFrame::LocalWorldAligned => t.at_point(p - pose.translation),
                };
                let given_up: Vec<[f64; 6]> =
                    complement.iter().map(|t| at_p(*t).to_array()).collect();
                let complement = Matrix::from_fn(6, given_up.len(), |i, k| given_up[k][i]);
                oblique(j, &complement, &options(HyperbolicDamping::None))?
            }
        };
        Ok((found, twist))
    }
}
