//! Polytopes of velocity and force: all that the limits of the driven joints allow.
//!
//! Formula  velocity {u: (q, u) in R, |q_i| <= limit_i}, force {w: (tau, w) in F, |tau_i| <= limit_i}
//! Shapes   limits: q_a entries; vertices: d entries
//! Units    of the object's twist or wrench
//! Frame    that of the object's twist
//! Valid    any relation. Directions in which nothing limits the object (motions that the drives
//!          do not control, wrenches that the structure holds) are listed apart; the polytope is
//!          then the cross-section orthogonal to them in scaled units. More than three dimensions
//!          have many facets: take a task first. The velocity polytope of a task is the shadow of
//!          the whole one, the force polytope its section by forces that only the task works with.
//! Why so   only where rates of all driven joints are free of each other is this the image of a
//!          box; driven joints of closed chains are not, so a small linear program finds each
//!          corner, and the hull grows from corner to corner
//! Source   Chiacchio, Bouffard-Vercelli & Pierrot 1997; Bicchi & Prattichizzo 2000
//! Checked  tests/it/manipulability/polytope.rs

use crate::closure::{Parts, Relation};
use crate::error::{Error, Result};
use crate::linalg::{BoxProgram, Hull, HullGoal, HullOptions, Matrix};
use crate::tolerance::{HULL, MOST_FACETS};

/// A polytope of twists or wrenches, about zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Polytope {
    /// Corners and facets. Flat where fewer directions than components can be reached.
    pub hull: Hull,
    /// Directions without limit, a column each.
    pub unbounded: Matrix,
}

/// All twists of the object (or velocities of the task) within the rate limits of the driven
/// joints.
///
/// # Errors
/// A limit that is not positive and finite, or not one for each driven joint.
pub fn velocity_polytope(relation: &Relation, rate_limits: &[f64]) -> Result<Polytope> {
    polytope(relation, relation.motions(), "rate limit", rate_limits)
}

/// All wrenches on the object (or forces of the task) that torques within their limits balance.
///
/// # Errors
/// A limit that is not positive and finite, or not one for each driven joint.
pub fn force_polytope(relation: &Relation, torque_limits: &[f64]) -> Result<Polytope> {
    polytope(relation, relation.forces(), "torque limit", torque_limits)
}

fn polytope(
    relation: &Relation,
    parts: Parts,
    option: &'static str,
    limits: &[f64],
) -> Result<Polytope> {
    Error::check_len(option, relation.joints(), limits.len())?;
    if let Some(limit) = limits.iter().find(|l| !(l.is_finite() && **l > 0.0)) {
        return Err(Error::InvalidOption {
            option,
            value: limit.to_string(),
            reason: "limits are positive and finite; give one for each driven joint".to_owned(),
        });
    }
    // q = joint y + zero z, u = object y; the limits bind q alone.
    let (c, d) = (parts.joint.cols(), relation.object());
    let joints = Matrix::beside(relation.joints(), &[&parts.joint, &parts.zero]);
    let program = BoxProgram::new(&joints, limits);
    let pull = |n: &[f64]| {
        let mut goal = vec![0.0; joints.cols()];
        parts.object.tr_mul_vec_into(n, &mut goal[..c]);
        goal
    };
    // Where a whole face is farthest, a direction of no pattern picks one of its corners.
    let second = pull(&(0..d).map(|i| ((i + 1) as f64).sqrt().fract() + 0.1).collect::<Vec<_>>());
    let hull = Hull::of(
        d,
        |n| parts.object.mul_vec(&program.farthest(&pull(n), &second)[..c]),
        HullOptions { goal: HullGoal::Whole, tolerance: HULL, most_facets: MOST_FACETS },
    );
    Ok(Polytope { hull, unbounded: parts.infinite })
}
