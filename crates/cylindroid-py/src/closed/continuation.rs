//! Continuation: tracks a path of closed configurations.

use cylindroid::closure::{ContinuationOptions, ContinuationResult, PathEnd, track_path};
use pyo3::prelude::*;

use crate::arrays::{self, Array};
use crate::coordinates::Coordinates;
use crate::error::{Result, argument};
use crate::mechanism::PyMechanism;
use crate::screws::PyScrew;
use crate::table;

/// A path of closed configurations of a mechanism with loops (continuation).
///
/// Attributes
/// ----------
/// reached : bool
/// end : str
///     'reached', 'singular', 'limit', 'open', 'contradiction' or 'lost'.
/// q : ndarray, (n,)
///     The last configuration.
/// fraction : float
///     Fraction of the path that was tracked, 0 to 1.
/// path : ndarray, (S, n)
///     All configurations on the path.
/// fractions, distances : ndarray, (S,)
///     Fraction of the path, and distance to the closest singularity.
/// screw : Screw or None
///     The motion of the reference frame that a singularity would gain.
#[pyclass(frozen, name = "ContinuationResult", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyContinuationResult {
    inner: ContinuationResult,
}

#[pymethods]
impl PyContinuationResult {
    #[getter]
    fn reached(&self) -> bool {
        self.inner.end == PathEnd::Reached
    }

    #[getter]
    fn end(&self) -> String {
        self.inner.end.to_string()
    }

    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.q)
    }

    #[getter]
    fn fraction(&self) -> f64 {
        self.inner.fraction
    }

    #[getter]
    fn path<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let all = &self.inner.path;
        arrays::rows(py, Some(all.len()), self.inner.q.len(), all.iter().map(|p| &p.q))
    }

    #[getter]
    fn fractions<'py>(&self, py: Python<'py>) -> Array<'py> {
        let all: Vec<f64> = self.inner.path.iter().map(|p| p.fraction).collect();
        arrays::vector(py, &all)
    }

    #[getter]
    fn distances<'py>(&self, py: Python<'py>) -> Array<'py> {
        let all: Vec<f64> = self.inner.path.iter().map(|p| p.distance).collect();
        arrays::vector(py, &all)
    }

    #[getter]
    fn screw(&self) -> Option<PyScrew> {
        match &self.inner.end {
            PathEnd::Singular(singular) => singular.screw.as_ref().map(PyScrew::from),
            _ => None,
        }
    }

    fn __repr__(&self) -> String {
        let fraction = table::number(100.0 * self.inner.fraction);
        format!("<ContinuationResult: {}, {fraction} % of the way>", self.inner.end)
    }
}

#[pymethods]
impl PyMechanism {
    /// Moves some coordinates to their goal on one branch, the others following the loops, and
    /// stops before singularities and limits.
    ///
    /// Parameters
    /// ----------
    /// start : array_like, (n,)
    /// goal : dict of float by str
    ///     Coordinates and their goals [rad or m].
    /// step : float
    ///     Largest change of any coordinate in a step [rad, or reaches].
    /// least_distance : float, optional
    ///     Least distance to a singularity, from 1e-5 to below 1.
    ///
    /// Returns
    /// -------
    /// ContinuationResult
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError, InvalidOptionError
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> linkage = cy.load("four-bar")
    /// >>> linkage.track_path(linkage.home, {linkage.joint_names[0]: 0.2}).reached
    /// True
    #[pyo3(signature = (start, goal, step = 0.1, least_distance = None))]
    fn track_path(
        &self,
        py: Python<'_>,
        start: Coordinates<'_>,
        #[pyo3(from_py_with = argument)] goal: std::collections::BTreeMap<String, f64>,
        #[pyo3(from_py_with = argument)] step: f64,
        #[pyo3(from_py_with = argument)] least_distance: Option<f64>,
    ) -> Result<PyContinuationResult> {
        let names: Vec<String> = goal.keys().cloned().collect();
        let prescribed = self.places(&names)?;
        let goals: Vec<f64> = goal.values().copied().collect();
        let mut options = ContinuationOptions { step, ..ContinuationOptions::default() };
        options.least_distance = least_distance.unwrap_or(options.least_distance);
        let start = start.vector(&self.inner, "start")?;
        let inner = py.detach(|| track_path(&self.inner, start, &prescribed, &goals, options))?;
        Ok(PyContinuationResult { inner })
    }
}
