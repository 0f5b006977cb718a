//! Inverses of Jacobians: one file per method, one report for all.
//!
//! Every method here replaces `1 / s_i` in the pseudoinverse `V diag(1 / s) U^T` by a gain that
//! stays finite as `s_i` goes to zero. The share `s_i * gain_i` of a task motion along `u_i` is
//! realised: 1 in regular directions, 0 in cut ones; below one half a direction counts as dropped.
//!
//! ```
//! use cylindroid::{Matrix, inverse};
//!
//! let j = Matrix::from_rows(&[[1.0, 0.0, 0.0], [0.0, 1e-9, 0.0]]).unwrap();
//! let inverse = inverse::truncated(&j, 1e-3)?;
//! assert_eq!(inverse.rank, 1);
//! assert_eq!(inverse.dropped[0].direction, [0.0, 1.0]);
//! # Ok::<(), cylindroid::Error>(())
//! ```

mod batch;
mod compute;
mod damped;
mod hyperbolic;
mod hyperbolic_fixed;
mod hyperbolic_svd;
mod method;
mod numerical_filtering;
mod parameter;
mod point_direction;
mod report;
mod selectively_damped;
mod singular_value_filtering;
pub(crate) mod truncated;
mod truncated_batched;
mod variable_damping;
mod weighted;

pub use batch::{InverseBatch, Inverses};
pub(crate) use damped::damp;
pub use hyperbolic::{HyperbolicDamping, HyperbolicOptions, hyperbolic, hyperbolic_with, oblique};
pub use hyperbolic_fixed::hyperbolic_into;
pub use hyperbolic_svd::{HyperbolicPolar, HyperbolicSvd, PolarKind, hyperbolic_svd};
pub use method::Method;
pub(crate) use parameter::impl_parameters;
pub use parameter::{Domain, Parameter};
pub use point_direction::{PointDirection, point_direction};
pub(crate) use report::is_kept;
pub use report::{Inverse, TruncatedDirection};
pub use weighted::Weights;

use crate::error::{Error, Result};
use crate::linalg::Matrix;

/// The truncated pseudoinverse: singular values `s_i <= eps * s_1` are cut, as in
/// `numpy.linalg.pinv(J, eps)`.
///
/// ```text
/// J = U diag(s) V^T,   J+ = V diag(g) U^T,   g_i = 1 / s_i if s_i > eps s_1, otherwise 0
/// ```
///
/// `j` is m x n, the inverse n x m; `eps` has no unit. `J J+ = 1` if `j` has full row rank and
/// nothing is cut. Gains are at most `1 / (eps s_1)`; they jump where a singular value crosses the
/// threshold.
///
/// ```
/// use cylindroid::{Matrix, inverse};
///
/// // Every small value is cut, not the smallest alone.
/// let found = inverse::truncated(&Matrix::diagonal(&[1.0, 1e-4, 1e-5]), 1e-3)?;
/// assert_eq!(found.rank, 1);
/// assert_eq!(found.matrix, Matrix::diagonal(&[1.0, 0.0, 0.0]));
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// Source: course notes on Cartesian control, 7.3.2, corrected in the chapter
/// `docs/theory/control.md` of the book.
///
/// # Errors
/// A matrix with non-finite entries; `eps` outside [0, 1).
pub fn truncated(j: &Matrix, eps: f64) -> Result<Inverse> {
    Method::Truncated { eps }.inverse(j)
}

/// The damped least-squares inverse (Levenberg-Marquardt), smooth everywhere and exact nowhere.
///
/// ```text
/// J+ = J^T (J J^T + l^2 1)^-1,   g_i = s_i / (s_i^2 + l^2)
/// ```
///
/// `j` is m x n, the inverse n x m; `damping` l > 0 is in the unit of the singular values. A
/// direction with `s_i = l` is carried out to one half; joint velocities are at most `|v| / (2 l)`.
///
/// ```
/// use cylindroid::{Matrix, inverse};
///
/// let found = inverse::damped(&Matrix::diagonal(&[2.0, 0.0]), 1.0)?;
/// assert!((found.matrix[(0, 0)] - 0.4).abs() < 1e-15 && found.matrix[(1, 1)] == 0.0);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// Source: Nakamura & Hanafusa 1986; Wampler 1986.
///
/// # Errors
/// A matrix with non-finite entries; damping that is not positive.
pub fn damped(j: &Matrix, damping: f64) -> Result<Inverse> {
    Method::Damped { damping }.inverse(j)
}

/// The selectively damped inverse for the motion `task`: joint velocities are `matrix * task`, none
/// above `max_joint_velocity`.
///
/// ```text
/// r_i = (u_i . x) / s_i v_i,   M_i = sum_j |v_ji| |J_j| / s_i,   c_i = min(1, 1 / M_i) max
/// ```
///
/// The joint velocities `r_i` of each direction are scaled down until the largest is at most `c_i`,
/// and their sum until the largest is at most the maximum. `j` is m x n, `task` x has m entries,
/// `J_j` is a column of `j`; `max_joint_velocity` is in rad/s (m/s for prismatic joints). Valid for
/// any rank; at equal singular values the clamps depend on the choice of directions, and the
/// velocities may jump.
///
/// ```
/// use cylindroid::{Matrix, inverse};
///
/// // The second direction is all but lost; no joint exceeds 2 rad/s.
/// let j = Matrix::diagonal(&[1.0, 1e-6]);
/// let found = inverse::selectively_damped(&j, &[0.5, 0.5], 2.0)?;
/// let velocities = found.matrix.mul_vec(&[0.5, 0.5]);
/// assert!(velocities.iter().all(|v| v.abs() <= 2.0));
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// Source: Buss & Kim 2005, eqs. 13 to 15, for one task vector instead of several end effectors.
///
/// # Errors
/// A matrix or task with non-finite entries, a task of the wrong size, `max_joint_velocity` not
/// positive.
pub fn selectively_damped(j: &Matrix, task: &[f64], max_joint_velocity: f64) -> Result<Inverse> {
    Error::check_len("task", j.rows(), task.len())?;
    Error::check_finite("task", task)?;
    compute::compute(Method::SelectivelyDamped { max_joint_velocity }, j, task, &Weights::NONE)
}

/// Any method in the metrics of joints and task: minimises the weighted joint velocities among the
/// motions that make the weighted task error smallest.
///
/// ```text
/// W = L L^T,   J_w = L_x^T J L_q^-T,   J+ = L_q^-T J_w+ L_x^T
/// ```
///
/// `j` is m x n, `W_q` n x n and `W_x` m x m, both positive definite; the method's parameters apply
/// to the singular values of `J_w`.
///
/// ```
/// use cylindroid::inverse::{self, Method, Weights};
/// use cylindroid::linalg::Metric;
/// use cylindroid::Matrix;
///
/// // The second joint is four times as costly, and moves a quarter as fast.
/// let j = Matrix::from_rows(&[[1.0, 1.0]]).unwrap();
/// let weights = Weights { joint: Some(Metric::diagonal("joints", &[1.0, 4.0])?), task: None };
/// let found = inverse::weighted(&j, Method::default(), &weights)?;
/// assert!((found.matrix[(0, 0)] - 0.8).abs() < 1e-12);
/// assert!((found.matrix[(1, 0)] - 0.2).abs() < 1e-12);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// Source: Whitney 1969; Ben-Israel & Greville 2003, section 3.3.
///
/// # Errors
/// As [`Method::inverse`]; metrics of the wrong size.
pub fn weighted(j: &Matrix, method: Method, weights: &Weights) -> Result<Inverse> {
    compute::compute(method, j, &[], weights)
}
