//! Whether the hyperbolic pseudoinverse of a screw system exists, and its projectors.

use cylindroid::Error;
use cylindroid::screws::Existence;
use pyo3::prelude::*;

use super::PyScrewSystem;
use super::pitch::check_pitch;
use crate::arrays::{self, Array};
use crate::error::{Result, argument};
use crate::table;

/// Whether a hyperbolic pseudoinverse exists, and how clearly.
///
/// Attributes
/// ----------
/// exists : bool
/// margin, threshold : float
///     Smallest singular value of the Gram matrix of the pitch form; at or below the threshold
///     there is none.
/// reason : str or None
#[pyclass(frozen, get_all, name = "Existence", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyExistence {
    exists: bool,
    margin: f64,
    threshold: f64,
    reason: Option<String>,
}

impl From<Existence> for PyExistence {
    fn from(e: Existence) -> Self {
        let reason = e.reason.map(|r| r.to_string());
        Self { exists: e.exists, margin: e.margin, threshold: e.threshold, reason }
    }
}

#[pymethods]
impl PyExistence {
    fn __bool__(&self) -> bool {
        self.exists
    }

    fn __repr__(&self) -> String {
        match &self.reason {
            None => format!("<exists, margin {}>", table::number(self.margin)),
            Some(reason) => format!("<does not exist: {reason}>"),
        }
    }
}

#[pymethods]
impl PyScrewSystem {
    /// Whether the hyperbolic pseudoinverse of pitch h exists.
    ///
    /// Parameters
    /// ----------
    /// h : float
    ///     [m/rad], or infinite for the limit.
    ///
    /// Returns
    /// -------
    /// Existence
    #[pyo3(signature = (h))]
    fn existence(&self, #[pyo3(from_py_with = argument)] h: f64) -> Result<PyExistence> {
        check_pitch(h)?;
        Ok(self.inner.existence(h).into())
    }

    /// The signature of the form of pitch h on the system.
    ///
    /// Parameters
    /// ----------
    /// h : float
    ///     [m/rad], finite.
    ///
    /// Returns
    /// -------
    /// tuple of (int, int, int)
    ///     Numbers of positive, negative and zero eigenvalues of the Gram matrix of any basis. The
    ///     inverse exists if the last is zero.
    #[pyo3(signature = (h))]
    fn signature(&self, #[pyo3(from_py_with = argument)] h: f64) -> Result<(usize, usize, usize)> {
        Error::check_finite("h", &[h])?;
        let s = self.inner.signature(h);
        Ok((s.positive, s.negative, s.zero))
    }

    /// The projector onto this system along its h-reciprocal system, independent of frame and unit.
    ///
    /// Parameters
    /// ----------
    /// h : float
    ///     [m/rad], or infinite for the limit.
    ///
    /// Returns
    /// -------
    /// ndarray, (6, 6), or None
    ///     P for twists, linear part first; None if it does not exist, see `existence(h)`.
    ///     `1 - P.T` projects wrenches onto those that do no work on the system.
    #[pyo3(signature = (h))]
    fn projector<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = argument)] h: f64,
    ) -> Result<Option<Array<'py>>> {
        check_pitch(h)?;
        self.inner.projector(h).map(|p| arrays::matrix(py, &p.matrix())).transpose()
    }

    /// The projector onto this system along another one; None if they are not complementary.
    ///
    /// Parameters
    /// ----------
    /// other : ScrewSystem
    ///     The complement: twists that may be discarded.
    ///
    /// Returns
    /// -------
    /// ndarray, (6, 6), or None
    #[pyo3(signature = (other))]
    fn projector_along<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = argument)] other: PyRef<'_, Self>,
    ) -> Result<Option<Array<'py>>> {
        let projector = self.inner.projector_along(&other.inner);
        projector.map(|p| arrays::matrix(py, &p.matrix())).transpose()
    }

    /// The norm of the projector of pitch h: the largest factor by which it enlarges a twist;
    /// infinite if it does not exist.
    ///
    /// Parameters
    /// ----------
    /// h : float
    ///
    /// Returns
    /// -------
    /// float
    #[pyo3(signature = (h))]
    fn projector_norm(&self, #[pyo3(from_py_with = argument)] h: f64) -> Result<f64> {
        check_pitch(h)?;
        Ok(self.inner.projector_norm(h))
    }

    /// The pitch that minimises the norm of the projector: a recommended `h`.
    ///
    /// Returns
    /// -------
    /// (float or None, float)
    ///     The pitch [m/rad], infinite if the limit is best, None if the projector exists for no
    ///     pitch; and the norm of the projector. Where the norm decreases as `|h|` grows and the
    ///     limit does not exist, no pitch is best: the largest searched is returned, 1000
    ///     characteristic lengths.
    fn choose_pitch(&self, py: Python<'_>) -> (Option<f64>, f64) {
        let choice = py.detach(|| self.inner.choose_pitch());
        (choice.pitch, choice.norm)
    }
}
