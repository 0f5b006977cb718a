//! The damped and the selectively damped inverse.

use cylindroid::{Method, inverse};
use pyo3::prelude::*;

use super::{PyInverse, by_method};
use crate::arrays::{Many, Numbers};
use crate::error::{Result, argument};

/// The damped least-squares inverse `J^T (J J^T + damping^2)^-1`.
///
/// Parameters
/// ----------
/// J : array_like, (m, n) or (N, m, n)
///     One matrix or a stack of them.
/// damping : float
///     Positive, in the unit of the singular values. At rank loss `|qd| <= |v| / (2 damping)`.
///
/// Returns
/// -------
/// Inverse
///
/// Raises
/// ------
/// NotFiniteError, InvalidOptionError
///     As `pinv`.
///
/// Notes
/// -----
/// Nakamura and Hanafusa 1986.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> cy.damped([[1.0, 0.0], [0.0, 0.1]], damping=0.1).matrix.round(3)
/// array([[0.99, 0.  ],
///        [0.  , 5.  ]])
#[pyfunction]
#[pyo3(signature = (J, damping))]
#[expect(non_snake_case, reason = "the field's name")]
pub(crate) fn damped(
    py: Python<'_>,
    J: Numbers<'_>,
    #[pyo3(from_py_with = argument)] damping: f64,
) -> Result<PyInverse> {
    by_method(py, &J, Method::Damped { damping })
}

/// The selectively damped inverse for one motion.
///
/// Parameters
/// ----------
/// J : array_like, (m, n)
/// task : array_like, (m,)
///     The motion to be realised.
/// max_joint_velocity : float
///     Largest rate of any joint [rad/s or m/s].
///
/// Returns
/// -------
/// Inverse
///     `matrix @ task` has no entry above `max_joint_velocity`.
///
/// Raises
/// ------
/// NotFiniteError, DimensionError, InvalidOptionError
///
/// Notes
/// -----
/// Buss and Kim 2005.
#[pyfunction]
#[pyo3(signature = (J, task, max_joint_velocity = std::f64::consts::FRAC_PI_4))]
#[pyo3(text_signature = "(J, task, max_joint_velocity=0.7853981633974483)")]
#[expect(non_snake_case, reason = "the field's name")]
pub(crate) fn selectively_damped(
    J: Numbers<'_>,
    task: Numbers<'_>,
    #[pyo3(from_py_with = argument)] max_joint_velocity: f64,
) -> Result<PyInverse> {
    let j = J.matrix("J")?;
    let inner = inverse::selectively_damped(&j, task.vector("task")?, max_joint_velocity)?;
    Ok(PyInverse::new(&Many::One(j), Many::One(inner), (0, 0)))
}
