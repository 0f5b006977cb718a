//! The truncated pseudoinverse.

use cylindroid::Method;
use pyo3::prelude::*;

use super::{PyInverse, by_method};
use crate::arrays::Numbers;
use crate::error::{Result, argument};

/// The truncated pseudoinverse: singular values at or below `eps` times the largest are cut.
///
/// Parameters
/// ----------
/// J : array_like, (m, n) or (N, m, n)
///     One matrix or a stack of them. To compare lengths with angles divide the linear rows by a
///     characteristic length first.
/// eps : float
///     Relative threshold, in [0, 1).
///
/// Returns
/// -------
/// Inverse
///     Its `matrix` is `numpy.linalg.pinv(J, eps)`.
///
/// Raises
/// ------
/// NotFiniteError
///     For entries that are NaN or infinite.
/// InvalidOptionError
///     For an `eps` outside of its interval or a J that is no matrix.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> inverse = cy.pinv([[1.0, 0.0, 0.0], [0.0, 1e-9, 0.0]], eps=1e-3)
/// >>> inverse.rank
/// 1
/// >>> inverse.dropped[0].direction
/// array([0., 1.])
#[pyfunction]
#[pyo3(signature = (J, eps = 1e-3))]
#[expect(non_snake_case, reason = "the field's name")]
pub(crate) fn pinv(
    py: Python<'_>,
    J: Numbers<'_>,
    #[pyo3(from_py_with = argument)] eps: f64,
) -> Result<PyInverse> {
    by_method(py, &J, Method::Truncated { eps })
}
