//! The lines that meet all of a set of lines.

use cylindroid::screws::{self, Transversals};
use pyo3::prelude::*;

use super::lines::lines_of;
use super::scale_of;
use crate::arrays::{self, Array, Numbers};
use crate::error::{Result, argument};

/// The lines that meet all of a set of lines.
///
/// Parameters
/// ----------
/// lines : array_like, (6, m) or (m, 2, 3)
///     As `involution`.
/// length, center, noise
///     As `ScrewSystem`.
///
/// Returns
/// -------
/// Transversals
///
/// Raises
/// ------
/// NotFiniteError, InvalidOptionError
#[pyfunction]
#[pyo3(signature = (lines, length = None, center = None, noise = None))]
pub(crate) fn transversals(
    lines: Numbers<'_>,
    #[pyo3(from_py_with = argument)] length: Option<f64>,
    center: Option<Numbers<'_>>,
    #[pyo3(from_py_with = argument)] noise: Option<f64>,
) -> Result<PyTransversals> {
    let options = scale_of(length, center.as_ref(), noise)?;
    Ok(PyTransversals { inner: screws::transversals(&lines_of(&lines)?, &options)? })
}

/// The lines that meet all of a set of lines.
///
/// Attributes
/// ----------
/// infinitely_many : bool
///     True if there are; then `lines` is empty.
/// lines : ndarray, (k, 2, 3)
///     Points and directions of the transversals.
/// at_infinity : ndarray, (k, 3)
///     Transversals at infinity, as normals of the planes that hold them.
/// double : bool
///     True if the one transversal counts twice.
#[pyclass(frozen, name = "Transversals", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyTransversals {
    pub(super) inner: Transversals,
}

#[pymethods]
impl PyTransversals {
    #[getter]
    fn infinitely_many(&self) -> bool {
        self.inner.infinitely_many
    }

    #[getter]
    fn lines<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::written(py, Some(self.inner.lines.len()), &[2, 3], |out| {
            for (line, out) in self.inner.lines.iter().zip(out.chunks_exact_mut(6)) {
                out[..3].copy_from_slice(&line.point.to_array());
                out[3..].copy_from_slice(&line.direction.to_array());
            }
        })
    }

    #[getter]
    fn at_infinity<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::written(py, Some(self.inner.at_infinity.len()), &[3], |out| {
            for (normal, out) in self.inner.at_infinity.iter().zip(out.chunks_exact_mut(3)) {
                out.copy_from_slice(&normal.to_array());
            }
        })
    }

    #[getter]
    fn double(&self) -> bool {
        self.inner.double
    }

    fn __repr__(&self) -> String {
        let t = &self.inner;
        match (t.infinitely_many, t.lines.len()) {
            (true, _) => "<Transversals: infinitely many>".to_owned(),
            (false, n) => format!("<Transversals: {n}, {} at infinity>", t.at_infinity.len()),
        }
    }
}
