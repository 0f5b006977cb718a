//! All joint velocities that move a point of the end effector along a given direction.
//!
//! Formula  J_x = v + w x x (columns of J at the point x); joint velocities qd with J_x qd parallel
//!          to d are lambda J_x+ d + the null space of J_x, if d is in the range of J_x, otherwise
//!          the null space
//! Shapes   J: 6 x m, x and d: 3
//! Units    m, rad; the first joint velocities are per 1 m/s along d
//! Frame    that of J
//! Valid    any m and rank. They need not be the only ones that produce a twist: dependent joints
//!          add their null space
//! Source   Donelan & Selig, example 3, corrected: the set is {qd : J qd in S}, S the twists that
//!          move x along d, not the image of S under a pseudoinverse, which is larger
//! Checked  tests/it/screws/vectors/examples.rs::example_3, tests/it/screws/point_direction.rs

use crate::error::{Error, Result};
use crate::linalg::{Matrix, RowSpace, Svd, dot};
use crate::spatial::{Twist, Vec3};
use crate::tolerance::{MAX_MAGNITUDE, SCREW_CLASS, SCREW_RANK, ZERO_AXIS};

/// The joint velocities that move a point along a line.
#[derive(Debug, Clone, PartialEq)]
pub struct PointDirection {
    /// The smallest joint velocities that move the point at 1 m/s along the direction; `None` if
    /// there are none.
    pub along: Option<Vec<f64>>,
    /// Joint velocities that keep the point at rest: an orthonormal basis, m x d.
    pub still: Matrix,
}

/// All joint velocities that move `point` along `direction` (of any length).
///
/// ```text
/// J_x = v + w cross x (columns of J at the point x)
/// {qd : J_x qd parallel to q} = {a J_x+ q + z : J_x z = 0} if q is in the range of J_x,
///                               the null space of J_x otherwise
/// ```
///
/// `j` is 6 x m, linear first; its linear rows are the velocity at the origin of the frame in which
/// `point` (m) and `direction` are given. The first velocities of the result are for 1 m/s.
///
/// Source: Donelan & Selig, example 3, corrected: its `J+h(S)`, with S the twists that move the
/// point along the direction, is larger than this set.
///
/// ```
/// use cylindroid::{Matrix, Vec3, inverse};
///
/// // A rotation about z moves a point on the x axis along y, and never along z.
/// let j = Matrix::from_rows(&[[0.0], [0.0], [0.0], [0.0], [0.0], [1.0]]).unwrap();
/// let along_y = inverse::point_direction(&j, Vec3::X * 2.0, Vec3::Y)?;
/// assert!((along_y.along.unwrap()[0] - 0.5).abs() < 1e-15); // rad/s for 1 m/s
/// assert!(inverse::point_direction(&j, Vec3::X, Vec3::Z)?.along.is_none());
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// A matrix that has not six rows or has non-finite entries; a direction of no length.
pub fn point_direction(j: &Matrix, point: Vec3, direction: Vec3) -> Result<PointDirection> {
    Error::check_len("rows of the matrix of twists", 6, j.rows())?;
    Error::check_finite("matrix", j.as_slice())?;
    Error::check_within("point", &point.to_array(), MAX_MAGNITUDE)?;
    let Some(q) = direction.unit(ZERO_AXIS) else {
        return Err(Error::InvalidOption {
            option: "direction",
            value: format!("{:?}", direction.to_array()),
            reason: "a direction must be finite and non-zero".to_owned(),
        });
    };
    let mut velocity = Matrix::zeros(3, j.cols());
    // Size of the terms: where they cancel, the remainder is their rounding.
    let mut size = 0.0_f64;
    for c in 0..j.cols() {
        let twist = Twist::from_array(std::array::from_fn(|i| j.column(c)[i]));
        size = size.max(twist.linear.norm() + twist.angular.norm() * point.norm());
        velocity.column_mut(c).copy_from_slice(&twist.at_point(point).linear.to_array());
    }
    let svd = Svd::of(&velocity);
    let rank = svd.values().filter(|s| *s > SCREW_RANK * size).count();
    let space = RowSpace::first(&svd, rank);
    let along = svd.solve(&q.to_array(), space.rank());
    let mut outside = q.to_array();
    for i in 0..space.rank() {
        let component = dot(svd.u(i), &q.to_array());
        outside.iter_mut().zip(svd.u(i)).for_each(|(o, u)| *o -= component * u);
    }
    let reachable = Vec3::from_array(outside).norm() <= SCREW_CLASS;
    Ok(PointDirection { along: reachable.then_some(along), still: space.null_space_basis() })
}
