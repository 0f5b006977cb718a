//! Assembly modes: all configurations in which the loops close.

use cylindroid::closure::{ModeOptions, assembly_modes};
use pyo3::prelude::*;

use super::PyAssembly;
use crate::coordinates::Coordinates;
use crate::error::{Result, argument, count};
use crate::mechanism::PyMechanism;
use crate::table;

/// The assembly modes that were found; there may be others.
///
/// Attributes
/// ----------
/// modes : list of Assembly
///     Nearest to the guess first.
/// found : list of int
///     Number of initial guesses that led to each.
/// self_motion_dof : list of int
///     Degrees of freedom left by the prescribed coordinates at each: 0 for an isolated assembly.
/// starts, closed : int
///     Number of initial guesses, and of those from which the loops closed.
/// unseen_probability : float
///     Estimated probability that the next closing initial guess finds a new mode.
#[pyclass(frozen, name = "AssemblyModes", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyAssemblyModes {
    inner: cylindroid::closure::AssemblyModes,
    names: Vec<String>,
}

#[pymethods]
impl PyAssemblyModes {
    #[getter]
    fn modes(&self) -> Vec<PyAssembly> {
        self.inner.modes.iter().map(|m| PyAssembly::new(&m.assembly, &self.names)).collect()
    }

    #[getter]
    fn found(&self) -> Vec<usize> {
        self.inner.modes.iter().map(|m| m.found).collect()
    }

    #[getter]
    fn self_motion_dof(&self) -> Vec<usize> {
        self.inner.modes.iter().map(|m| m.self_motion_dof).collect()
    }

    #[getter]
    fn starts(&self) -> usize {
        self.inner.starts
    }

    #[getter]
    fn closed(&self) -> usize {
        self.inner.closed
    }

    #[getter]
    fn unseen_probability(&self) -> f64 {
        self.inner.unseen_probability()
    }

    fn __len__(&self) -> usize {
        self.inner.modes.len()
    }

    fn __repr__(&self) -> String {
        format!(
            "<AssemblyModes: {} found from {} starts, chance of more {}>",
            self.inner.modes.len(),
            self.inner.starts,
            table::number(self.inner.unseen_probability())
        )
    }
}

#[pymethods]
impl PyMechanism {
    /// Assembly modes for some prescribed coordinates, from many initial guesses.
    ///
    /// Parameters
    /// ----------
    /// guess : array_like, (n,), optional
    ///     Default: home.
    /// hold : list of str, optional
    ///     Coordinates that keep the values of the guess.
    /// starts : int
    /// seed : int
    ///     The same seed gives the same initial guesses.
    ///
    /// Returns
    /// -------
    /// AssemblyModes
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError, InvalidOptionError
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> linkage = cy.load("four-bar")
    /// >>> len(linkage.assembly_modes([0.3, 0, 0], hold=linkage.joint_names[:1]))
    /// 2
    #[pyo3(signature = (guess = None, hold = None, starts = 64, seed = 0))]
    fn assembly_modes(
        &self,
        py: Python<'_>,
        guess: Option<Coordinates<'_>>,
        #[pyo3(from_py_with = argument)] hold: Option<Vec<String>>,
        #[pyo3(from_py_with = count)] starts: usize,
        #[pyo3(from_py_with = argument)] seed: u64,
    ) -> Result<PyAssemblyModes> {
        let m = &self.inner;
        let guess = self.or_home("guess", guess.as_ref())?;
        let prescribed = self.places(&hold.unwrap_or_default())?;
        let options = ModeOptions { starts, seed };
        let inner = py.detach(|| assembly_modes(m, guess, &prescribed, options))?;
        let names = m.coordinates().iter().map(|c| c.name.clone()).collect();
        Ok(PyAssemblyModes { inner, names })
    }
}
