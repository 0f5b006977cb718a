//! Lines in involution.

use cylindroid::screws::{self, Involution};
use pyo3::prelude::*;

use super::lines::lines_of;
use super::{PyScrew, PyScrewSystem, PyTransversals, scale_of};
use crate::arrays::{self, Array, Numbers};
use crate::error::{Result, argument};

/// Involution test of lines: whether joints on them transmit some load without any joint torque.
///
/// Parameters
/// ----------
/// lines : array_like, (6, m) or (m, 2, 3)
///     Twists of pitch zero as columns, linear part first, or points and directions (m).
/// length, center, noise
///     As `ScrewSystem`.
///
/// Returns
/// -------
/// Involution
///
/// Raises
/// ------
/// NotFiniteError, InvalidOptionError
///     Also for a column that is no line.
///
/// Examples
/// --------
/// Three parallel lines in a plane, and one that meets them:
///
/// >>> import cylindroid as cy
/// >>> lines = [[[x, 0, 0], [0, 0, 1]] for x in (0.0, 1.0, 2.0)]
/// >>> cy.involution(lines).independent
/// False
#[pyfunction]
#[pyo3(signature = (lines, length = None, center = None, noise = None))]
pub(crate) fn involution(
    lines: Numbers<'_>,
    #[pyo3(from_py_with = argument)] length: Option<f64>,
    center: Option<Numbers<'_>>,
    #[pyo3(from_py_with = argument)] noise: Option<f64>,
) -> Result<PyInvolution> {
    let options = scale_of(length, center.as_ref(), noise)?;
    Ok(PyInvolution { inner: screws::involution(&lines_of(&lines)?, &options)? })
}

/// The involution test of a set of lines: dependence, and a common null twist.
///
/// Attributes
/// ----------
/// in_involution : bool
///     True if the lines are dependent, or their span contains a twist reciprocal to all of it.
/// independent : bool
///     True if none of them is spanned by the others.
/// null_twist : ndarray, (6,), or None
///     A twist of their span that is reciprocal to all of it.
/// null_twists : ndarray, (6, k)
/// null_screw : Screw or None
/// wrench : ndarray, (6,), or None
///     The wrench on it, force first, which no joint on the lines feels.
/// transversals : Transversals
/// margin, threshold : float
/// system : ScrewSystem
#[pyclass(frozen, name = "Involution", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyInvolution {
    inner: Involution,
}

#[pymethods]
impl PyInvolution {
    #[getter]
    fn in_involution(&self) -> bool {
        self.inner.in_involution
    }

    #[getter]
    fn independent(&self) -> bool {
        self.inner.independent
    }

    #[getter]
    fn null_twist<'py>(&self, py: Python<'py>) -> Option<Array<'py>> {
        self.inner.null_twists.first().map(|t| arrays::vector(py, &t.to_array()))
    }

    #[getter]
    fn null_twists<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::twists(py, &self.inner.null_twists)
    }

    #[getter]
    fn null_screw(&self) -> Option<PyScrew> {
        self.inner.null_screw.as_ref().map(PyScrew::from)
    }

    #[getter]
    fn wrench<'py>(&self, py: Python<'py>) -> Option<Array<'py>> {
        self.inner.wrench.map(|w| arrays::vector(py, &w.to_array()))
    }

    #[getter]
    fn transversals(&self) -> PyTransversals {
        PyTransversals { inner: self.inner.transversals.clone() }
    }

    #[getter]
    fn margin(&self) -> f64 {
        self.inner.margin
    }

    #[getter]
    fn threshold(&self) -> f64 {
        self.inner.threshold
    }

    #[getter]
    fn system(&self) -> PyScrewSystem {
        PyScrewSystem { inner: self.inner.system.clone() }
    }

    fn __repr__(&self) -> String {
        format!(
            "<Involution of {} lines: {}in involution, {}independent>",
            self.inner.lines,
            if self.inner.in_involution { "" } else { "not " },
            if self.inner.independent { "" } else { "not " }
        )
    }
}
