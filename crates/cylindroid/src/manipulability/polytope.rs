//! Velocity and force polytopes: the twists and wrenches within the limits of the actuated joints.
//!
//! Formula  the pages of [`velocity_polytope`], [`force_polytope`] and the ranges
//! Shapes   limits: q_a intervals; vertices: d entries
//! Units    of the object's twist or wrench
//! Frame    that of the object's twist
//! Valid    any relation, limits around zero (a cable pulls: from 0 to its strength). Unlimited
//!          directions (motions that the actuators do not control, wrenches that the structure
//!          resists) are listed separately; the polytope is then the cross-section orthogonal to
//!          them in scaled units. More than three dimensions have many facets: select a task first.
//!          The velocity polytope of a task is the projection of the whole one, the force polytope
//!          its section by forces that only the task works with.
//! Why so   only where the velocities of all actuated joints are independent is this the image of a
//!          box; in closed chains they are not, so a small linear program finds each vertex, and
//!          the hull grows from vertex to vertex
//! Source   Chiacchio, Bouffard-Vercelli & Pierrot 1997; Bicchi & Prattichizzo 2000
//! Checked  tests/it/manipulability/polytope.rs

use crate::closure::{Relation, RelationBases};
use crate::error::{Error, Result};
use crate::linalg::{
    BoundedLinearProgram, Hull, HullGoal, HullOptions, Interval, Matrix, Objective,
};
use crate::tolerance::{CLOSURE_BLOCK, HULL, MAX_FACETS, MAX_MAGNITUDE};

/// A polytope of twists or wrenches; zero is in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Polytope {
    /// Vertices and facets. Flat where fewer directions than components are reachable.
    pub hull: Hull,
    /// Unlimited directions, a column each.
    pub unbounded: Matrix,
}

/// All twists of the object (or velocities of the task) within the velocity limits of the actuated
/// joints.
///
/// ```text
/// {u : (qd_a, u) in R,  lower <= qd_a <= upper}
/// ```
///
/// R is the relation of actuated joints and object; an interval [rad/s or m/s] for each actuated
/// joint, which contains zero. A vertex has the d entries of the twist (m/s, rad/s), at the point
/// and in the axes of the object's twist. Unlimited directions are listed separately; the polytope
/// is then the cross-section orthogonal to them. That of a task is the projection of the whole one.
///
/// Source: Chiacchio, Bouffard-Vercelli & Pierrot 1997; Bicchi & Prattichizzo 2000.
///
/// ```
/// use cylindroid::Matrix;
/// use cylindroid::closure::{Constraint, MotionSpace};
/// use cylindroid::linalg::Interval;
/// use cylindroid::manipulability::{velocity_polytope, velocity_range};
///
/// let jacobian = Matrix::from_rows(&[[1.0, 1.0], [0.0, 1.0]]).unwrap();
/// let relation = MotionSpace::of(&Constraint::serial(&jacobian)?).relation();
/// let limits = [Interval::symmetric(1.0); 2];
/// assert_eq!(velocity_polytope(&relation, &limits)?.hull.vertices.len(), 4);
/// assert!((velocity_range(&relation, &limits)?[0].upper - 2.0).abs() < 1e-12);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// Limits that do not contain zero, or whose larger one is not from 1 / [`MAX_MAGNITUDE`] to that; a
/// number of limits other than that of the actuated joints.
#[doc(alias = "zonotope")]
#[doc(alias = "manipulability polytope")]
pub fn velocity_polytope(relation: &Relation, velocity_limits: &[Interval]) -> Result<Polytope> {
    Ok(Body::new(relation.motions(), "velocity limit", velocity_limits)?.polytope())
}

/// All wrenches on the object (or forces of the task) that torques within their limits balance.
///
/// ```text
/// {w : (tau, w) in F = R^perp,  lower <= tau <= upper}
/// ```
///
/// F is the dual relation; an interval (N m or N) for each actuated joint. A vertex has the d
/// entries of the wrench (N, N m), at the point and in the axes of the object's twist. That of a
/// task is the section by the forces that only the task works with. [`velocity_polytope`] has an
/// example.
///
/// # Errors
/// As [`velocity_polytope`].
pub fn force_polytope(relation: &Relation, torque_limits: &[Interval]) -> Result<Polytope> {
    Ok(Body::new(relation.forces(), "torque limit", torque_limits)?.polytope())
}

/// From the smallest to the largest value of each component of the twist within the velocity
/// limits, infinite where it is unlimited.
///
/// ```text
/// [min u_i, max u_i]   over the velocity polytope, for each component i
/// ```
///
/// [`velocity_polytope`] has an example.
///
/// # Errors
/// As [`velocity_polytope`].
pub fn velocity_range(relation: &Relation, velocity_limits: &[Interval]) -> Result<Vec<Interval>> {
    Ok(Body::new(relation.motions(), "velocity limit", velocity_limits)?.range())
}

/// From the smallest to the largest value of each component of the wrench that torques within their
/// limits balance, infinite where the structure resists it. The other components are arbitrary.
///
/// ```text
/// [min w_i, max w_i]   over the force polytope, for each component i
/// ```
///
/// # Errors
/// As [`velocity_polytope`].
pub fn force_range(relation: &Relation, torque_limits: &[Interval]) -> Result<Vec<Interval>> {
    Ok(Body::new(relation.forces(), "torque limit", torque_limits)?.range())
}

/// q = joint y + zero z, u = object y + infinite x; the limits bind q alone.
struct Body {
    parts: RelationBases,
    program: BoundedLinearProgram,
}

impl Body {
    fn new(parts: RelationBases, option: &'static str, limits: &[Interval]) -> Result<Self> {
        let joints = parts.joint.rows();
        Error::check_len(option, joints, limits.len())?;
        let range = MAX_MAGNITUDE.recip()..=MAX_MAGNITUDE;
        let is_limit = |l: &Interval| l.is_around_zero() && range.contains(&l.size());
        if let Some(limit) = limits.iter().find(|l| !is_limit(l)) {
            return Err(Error::InvalidOption {
                option,
                value: format!("{} to {}", limit.lower, limit.upper),
                reason: format!(
                    "limits must be finite, zero must lie between them or be one of them, and the \
                     larger must be from {:e} to {:e}; give a pair for each actuated joint",
                    range.start(),
                    range.end()
                ),
            });
        }
        let all = Matrix::hstack(joints, &[&parts.joint, &parts.zero]);
        Ok(Self { program: BoundedLinearProgram::new(&all, limits), parts })
    }

    /// What a direction of the object asks of y and z.
    fn objective(&self, n: &[f64]) -> Vec<f64> {
        let c = self.parts.joint.cols();
        let mut goal = vec![0.0; c + self.parts.zero.cols()];
        self.parts.object.tr_mul_vec_into(n, &mut goal[..c]);
        goal
    }

    /// A corner farthest along `n`; `second` picks one where a whole face is farthest.
    fn support_point(&self, n: &[f64], second: &[f64]) -> Vec<f64> {
        let corner = self.program.maximize(Objective { first: &self.objective(n), second });
        self.parts.object.mul_vec(&corner[..self.parts.joint.cols()])
    }

    fn polytope(self) -> Polytope {
        let d = self.parts.object.rows();
        // A direction of no pattern.
        let odd: Vec<f64> = (0..d).map(|i| ((i + 1) as f64).sqrt().fract() + 0.1).collect();
        let second = self.objective(&odd);
        let hull = Hull::of(
            d,
            |n| self.support_point(n, &second),
            HullOptions { goal: HullGoal::Whole, tolerance: HULL, max_facets: MAX_FACETS },
        );
        Polytope { hull, unbounded: self.parts.infinite }
    }

    fn range(&self) -> Vec<Interval> {
        let d = self.parts.object.rows();
        let largest = self.parts.infinite.max_abs();
        (0..d)
            .map(|i| {
                let infinite = &self.parts.infinite;
                if (0..infinite.cols()).any(|j| infinite[(i, j)].abs() > CLOSURE_BLOCK * largest) {
                    return Interval::symmetric(f64::INFINITY);
                }
                let end = |sign: f64| {
                    let n: Vec<f64> = (0..d).map(|l| if l == i { sign } else { 0.0 }).collect();
                    self.support_point(&n, &self.objective(&n))[i]
                };
                Interval { lower: end(-1.0), upper: end(1.0) }
            })
            .collect()
    }
}
