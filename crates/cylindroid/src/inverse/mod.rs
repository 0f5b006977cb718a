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
mod method;
mod numerical_filtering;
mod parameter;
mod point_direction;
mod report;
mod selectively_damped;
mod singular_value_filtering;
pub(crate) mod truncated;
mod variable_damping;
mod weighted;

pub use batch::{InverseBatch, Inverses};
pub(crate) use damped::damp;
pub use hyperbolic::{HyperbolicDamping, HyperbolicOptions, hyperbolic, hyperbolic_with, oblique};
pub use hyperbolic_fixed::hyperbolic_into;
pub use method::Method;
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
/// # Errors
/// A matrix with NaN or infinity; `eps` outside [0, 1).
pub fn truncated(j: &Matrix, eps: f64) -> Result<Inverse> {
    Method::Truncated { eps }.inverse(j)
}

/// The damped least-squares inverse `J^T (J J^T + damping^2)^-1`.
///
/// # Errors
/// A matrix with NaN or infinity; damping that is not positive.
pub fn damped(j: &Matrix, damping: f64) -> Result<Inverse> {
    Method::Damped { damping }.inverse(j)
}

/// The selectively damped inverse for the motion `task` (m entries): joint velocities are
/// `matrix * task`, none above `max_joint_velocity`.
///
/// # Errors
/// A matrix or task with NaN or infinity, a task of the wrong size, a velocity that is not
/// positive.
pub fn selectively_damped(j: &Matrix, task: &[f64], max_joint_velocity: f64) -> Result<Inverse> {
    Error::check_len("task", j.rows(), task.len())?;
    Error::check_finite("task", task)?;
    compute::compute(Method::SelectivelyDamped { max_joint_velocity }, j, task, &Weights::NONE)
}

/// Any method in the metrics of joints and task: minimises the weighted rates among the motions
/// that make the weighted task error smallest.
///
/// # Errors
/// As [`Method::inverse`]; metrics of the wrong size.
pub fn weighted(j: &Matrix, method: Method, weights: &Weights) -> Result<Inverse> {
    compute::compute(method, j, &[], weights)
}
