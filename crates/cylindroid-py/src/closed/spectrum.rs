//! The classes `Spectrum` and `Direction`: efficiencies of manipulability.

use cylindroid::manipulability::{Direction, Spectrum};
use pyo3::prelude::*;

use crate::arrays::{self, Array};
use crate::error::Result;
use crate::table;

/// The efficiencies of a kind.
///
/// Attributes
/// ----------
/// finite : ndarray, (k,)
///     Largest first: squares of output over input.
/// zeros, infinite : int
///     Number of zero and of infinite ones, decided by kind and not by size.
/// directions : list of Direction
///     Of the finite ones.
/// zero_directions : ndarray, (zeros, a)
///     Rates (torques) without effect on the object, as rows.
/// infinite_directions : ndarray, (infinite, d)
///     Twists (wrenches) without input, as rows.
/// semi_axes : ndarray, (d, k)
///     Of the ellipsoid of outputs for inputs of length one, longest first.
/// volume : float
///     Product of the roots of the finite efficiencies; of a serial arm Yoshikawa's index.
/// anisotropy : float or None
///     Largest over smallest finite efficiency.
/// components : list of str
///     Names of the entries of twists (wrenches), or of the task.
/// quantity : str
///     'velocity' or 'force'.
#[pyclass(frozen, name = "Spectrum", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PySpectrum {
    pub(super) inner: Spectrum,
    pub(super) what: &'static str,
    pub(super) components: Vec<String>,
}

#[pymethods]
impl PySpectrum {
    #[getter]
    fn finite<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.values())
    }

    #[getter]
    fn zeros(&self) -> usize {
        self.inner.zeros.cols()
    }

    #[getter]
    fn infinite(&self) -> usize {
        self.inner.infinite.cols()
    }

    #[getter]
    fn directions(&self) -> Vec<PyDirection> {
        self.inner.finite.iter().map(|d| PyDirection { inner: d.clone() }).collect()
    }

    #[getter]
    fn zero_directions<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::columns(py, &self.inner.zeros)
    }

    #[getter]
    fn infinite_directions<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::columns(py, &self.inner.infinite)
    }

    #[getter]
    fn semi_axes<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.semi_axes())
    }

    #[getter]
    fn volume(&self) -> f64 {
        self.inner.volume()
    }

    #[getter]
    fn anisotropy(&self) -> Option<f64> {
        self.inner.anisotropy()
    }

    #[getter]
    fn components(&self) -> Vec<String> {
        self.components.clone()
    }

    #[getter]
    pub(super) fn quantity(&self) -> &'static str {
        if self.what == "kinematic" { "velocity" } else { "force" }
    }

    fn __repr__(&self) -> String {
        format!("<{}: {}>", self.what, self.words())
    }
}

impl PySpectrum {
    pub(super) fn words(&self) -> String {
        format!(
            "finite {}, {} zero, {} infinite",
            table::list(&self.inner.values()),
            self.inner.zeros.cols(),
            self.inner.infinite.cols()
        )
    }
}

/// A principal direction: together its parts have length one in the metrics.
///
/// Attributes
/// ----------
/// efficiency : float
/// joint : ndarray, (a,)
///     Rates (torques) of the actuated joints.
/// object : ndarray, (d,)
///     The corresponding twist (wrench).
#[pyclass(frozen, name = "Direction", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyDirection {
    inner: Direction,
}

#[pymethods]
impl PyDirection {
    #[getter]
    fn efficiency(&self) -> f64 {
        self.inner.pair.efficiency()
    }

    #[getter]
    fn joint<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.joint)
    }

    #[getter]
    fn object<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.object)
    }

    fn __repr__(&self) -> String {
        format!(
            "Direction(efficiency={}, joint={}, object={})",
            table::number(self.inner.pair.efficiency()),
            table::list(&self.inner.joint),
            table::list(&self.inner.object)
        )
    }
}
