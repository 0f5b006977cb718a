//! Assembly: loops and contacts closed from an initial guess.

use cylindroid::closure::{Assembly, LoopClosureError, assemble};
use pyo3::prelude::*;

use crate::arrays::{self, Array};
use crate::coordinates::Coordinates;
use crate::error::{Result, argument};
use crate::mechanism::PyMechanism;
use crate::table;

/// The loop-closure error: the largest violation of loops and contacts.
///
/// Attributes
/// ----------
/// distance : float
///     Along constrained directions (m).
/// angle : float
///     About constrained directions (rad).
#[pyclass(frozen, get_all, name = "LoopClosureError", module = "cylindroid")]
#[derive(Debug, Clone, Copy)]
pub(crate) struct PyLoopClosureError {
    distance: f64,
    angle: f64,
}

impl From<LoopClosureError> for PyLoopClosureError {
    fn from(closure_error: LoopClosureError) -> Self {
        Self { distance: closure_error.distance, angle: closure_error.angle }
    }
}

#[pymethods]
impl PyLoopClosureError {
    fn __repr__(&self) -> String {
        format!("LoopClosureError(distance={:.3e}, angle={:.3e})", self.distance, self.angle)
    }
}

/// An assembly: the result of closing loops and contacts from an initial guess.
///
/// Attributes
/// ----------
/// q : ndarray, (n,)
///     The configuration.
/// closed : bool
///     True if every loop and contact is closed.
/// closure_error : LoopClosureError
///     The remaining violation.
/// steps : int
/// at_limit : list of str
///     Coordinates at a position limit.
#[pyclass(frozen, name = "Assembly", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyAssembly {
    q: Vec<f64>,
    #[pyo3(get)]
    closed: bool,
    #[pyo3(get)]
    closure_error: PyLoopClosureError,
    #[pyo3(get)]
    steps: usize,
    #[pyo3(get)]
    at_limit: Vec<String>,
}

impl PyAssembly {
    pub(super) fn new(found: &Assembly, names: &[String]) -> Self {
        Self {
            q: found.q.clone(),
            closed: found.closed,
            closure_error: found.closure_error.into(),
            steps: found.steps,
            at_limit: found.at_limit.iter().map(|&i| names[i].clone()).collect(),
        }
    }
}

#[pymethods]
impl PyAssembly {
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.q)
    }

    fn __bool__(&self) -> bool {
        self.closed
    }

    fn __repr__(&self) -> String {
        format!(
            "<Assembly: {}, open by {:.1e} m, {:.1e} rad, q = {}>",
            if self.closed { "closed" } else { "not closed" },
            self.closure_error.distance,
            self.closure_error.angle,
            table::list(&self.q)
        )
    }
}

#[pymethods]
impl PyMechanism {
    /// Closes loops and contacts from an initial guess, within position limits (assembly).
    ///
    /// It finds one assembly, usually the nearest; there may be others, and failure to find one is
    /// not a proof that none exists.
    ///
    /// Parameters
    /// ----------
    /// guess : array_like, (n,), optional
    ///     Default: home.
    /// hold : list of str, optional
    ///     Coordinates that keep the values of the guess.
    ///
    /// Returns
    /// -------
    /// Assembly
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> cy.load("five-bar").assemble([-0.2, 0.1, 0.0, 0.0]).closed
    /// True
    #[pyo3(signature = (guess = None, hold = None))]
    fn assemble(
        &self,
        py: Python<'_>,
        guess: Option<Coordinates<'_>>,
        #[pyo3(from_py_with = argument)] hold: Option<Vec<String>>,
    ) -> Result<PyAssembly> {
        let m = &self.inner;
        let guess = self.or_home("guess", guess.as_ref())?;
        let prescribed = self.places(&hold.unwrap_or_default())?;
        let found = py.detach(|| assemble(m, guess, &prescribed))?;
        let names: Vec<String> = m.coordinates().iter().map(|c| c.name.clone()).collect();
        Ok(PyAssembly::new(&found, &names))
    }
}
