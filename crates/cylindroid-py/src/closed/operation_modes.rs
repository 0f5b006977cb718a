//! Operation modes: the components of the set of closed configurations, with their counts.

use cylindroid::closure::{
    ModeMeeting, ModeOptions, OperationMode, OperationModes, operation_modes,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::singularity::counts_of;
use crate::arrays::{self, Array};
use crate::coordinates::Coordinates;
use crate::error::{Result, argument, count};
use crate::mechanism::PyMechanism;
use crate::table;

/// An operation mode: closed configurations of one dimension with equal counts.
///
/// Attributes
/// ----------
/// dimension : int
///     Degrees of freedom of finite motion; 0 for an isolated assembly.
/// dof : int
///     To first order at its configurations; more than `dimension` if all of them are singular.
/// counts : dict of str to int
///     Generic `rank`, `idle`, `redundancy`, `indeterminacy` and `zero_torque`.
/// order : int
///     Dimension of the motions of the reference frame.
/// screw_class : str
///     Gibson-Hunt class of these motions.
/// q : ndarray, (n,)
///     A configuration of it.
/// found : int
///     Number of starts that led to it; 0 if only a meeting did.
/// through : bool
///     True if the given configuration lies on it.
#[pyclass(frozen, name = "OperationMode", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyOperationMode {
    inner: OperationMode,
}

#[pymethods]
impl PyOperationMode {
    #[getter]
    fn dimension(&self) -> usize {
        self.inner.dimension
    }

    #[getter]
    fn dof(&self) -> usize {
        self.inner.dof
    }

    #[getter]
    fn counts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        counts_of(py, self.inner.counts)
    }

    #[getter]
    fn order(&self) -> usize {
        self.inner.order
    }

    #[getter]
    fn screw_class(&self) -> &'static str {
        self.inner.class.name()
    }

    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.configuration)
    }

    #[getter]
    fn found(&self) -> usize {
        self.inner.found
    }

    #[getter]
    fn through(&self) -> bool {
        self.inner.through
    }

    fn __repr__(&self) -> String {
        let m = &self.inner;
        format!("<OperationMode of dimension {}, {}-system {}>", m.dimension, m.order, m.class)
    }
}

/// A configuration in which branches meet.
///
/// Attributes
/// ----------
/// q : ndarray, (n,)
/// modes : list of int
///     The mode of each branch: indices into `OperationModes.modes`.
/// dof : int
///     Degrees of freedom to first order.
/// counts : dict of str to int
///     As those of `OperationMode`; what exceeds them is gained.
/// others : list of ndarray, (n,)
///     Other configurations found in which branches of the same modes meet with the same counts.
#[pyclass(frozen, name = "ModeMeeting", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyModeMeeting {
    inner: ModeMeeting,
}

#[pymethods]
impl PyModeMeeting {
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.configuration)
    }

    #[getter]
    fn modes(&self) -> Vec<usize> {
        self.inner.modes.clone()
    }

    #[getter]
    fn dof(&self) -> usize {
        self.inner.dof
    }

    #[getter]
    fn counts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        counts_of(py, self.inner.counts)
    }

    #[getter]
    fn others<'py>(&self, py: Python<'py>) -> Vec<Array<'py>> {
        self.inner.others.iter().map(|q| arrays::vector(py, q)).collect()
    }

    fn __repr__(&self) -> String {
        format!("<ModeMeeting of modes {:?}>", self.inner.modes)
    }
}

/// The operation modes that were found; there may be others.
///
/// Attributes
/// ----------
/// modes : list of OperationMode
///     Those of largest dimension first.
/// meetings : list of ModeMeeting
/// starts, closed, undecided : int
///     Number of starts, of those from which the loops closed, and of those whose mode could not be
///     decided.
/// unseen_probability : float
///     Estimated probability that the next closing start finds a new mode.
#[pyclass(frozen, name = "OperationModes", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyOperationModes {
    inner: OperationModes,
}

#[pymethods]
impl PyOperationModes {
    #[getter]
    fn modes(&self) -> Vec<PyOperationMode> {
        self.inner.modes.iter().map(|m| PyOperationMode { inner: m.clone() }).collect()
    }

    #[getter]
    fn meetings(&self) -> Vec<PyModeMeeting> {
        self.inner.meetings.iter().map(|m| PyModeMeeting { inner: m.clone() }).collect()
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
    fn undecided(&self) -> usize {
        self.inner.undecided
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
            "<OperationModes: {} found from {} starts, chance of more {}>",
            self.inner.modes.len(),
            self.inner.starts,
            table::number(self.inner.unseen_probability())
        )
    }
}

#[pymethods]
impl PyMechanism {
    /// Operation modes: the components of the set of closed configurations, with their counts.
    ///
    /// Configurations belong to one mode if dimension, generic counts and the class of the motions
    /// of the reference frame agree. Modes may be missed, and one mode may comprise several
    /// components.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,), optional
    ///     The first start, whose branches are followed. Default: home.
    /// starts : int
    /// seed : int
    ///     The same seed gives the same random restarts.
    /// reference : str, optional
    ///     Frame whose motions are classified.
    ///
    /// Returns
    /// -------
    /// OperationModes
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError, InvalidOptionError
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> linkage = cy.load("five-bar")
    /// >>> [mode.dimension for mode in linkage.operation_modes(starts=8).modes]
    /// [2]
    #[pyo3(signature = (q = None, starts = 64, seed = 0, reference = None))]
    fn operation_modes(
        &self,
        py: Python<'_>,
        q: Option<Coordinates<'_>>,
        #[pyo3(from_py_with = count)] starts: usize,
        #[pyo3(from_py_with = argument)] seed: u64,
        #[pyo3(from_py_with = argument)] reference: Option<&str>,
    ) -> Result<PyOperationModes> {
        let m = &self.inner;
        let q = self.or_home("q", q.as_ref())?;
        let reference = reference.map(|name| m.frame(name)).transpose()?;
        let options = ModeOptions { starts, seed };
        let inner = py.detach(|| operation_modes(m, q, reference, options))?;
        Ok(PyOperationModes { inner })
    }
}
