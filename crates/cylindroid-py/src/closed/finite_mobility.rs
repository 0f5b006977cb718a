//! The classes `FiniteMobility` and `Branch`: motion beyond first order.

use cylindroid::Matrix;
use cylindroid::closure::{Branch, FiniteMobility};
use pyo3::prelude::*;

use crate::arrays::{self, Array};
use crate::error::Result;

/// Finite mobility: the motions of a mechanism at a configuration beyond first order.
///
/// Attributes
/// ----------
/// dof : int or None
///     Degrees of freedom of finite motion: those of the largest branch; None if unknown.
/// infinitesimal : int
///     Motions to first order.
/// branches : list of Branch
///     Two or more: the mechanism can choose between motions at this configuration.
/// shaky : ndarray, (n, k)
///     Rates of q that exist to first order only.
/// evidence : str
/// certain : bool
///     False if branches may have been missed.
/// tracked : float
///     Distance to which the motions were tracked [rad, or characteristic lengths].
/// contact_order : int or None
///     Power of the distance with which the loops open (2 for most shaky structures); None where
///     they stay closed, or where it differs between directions.
/// second_order : str or None
///     "prestress stable" (some self-stress stabilises all first-order motions, so that none is
///     finite), "second-order rigid" (no motion that extends to second order was found) or
///     "second-order flexible"; None where all first-order motions are finite.
#[pyclass(frozen, name = "FiniteMobility", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyFiniteMobility {
    inner: FiniteMobility,
}

impl From<&FiniteMobility> for PyFiniteMobility {
    fn from(inner: &FiniteMobility) -> Self {
        Self { inner: inner.clone() }
    }
}

#[pymethods]
impl PyFiniteMobility {
    #[getter]
    fn dof(&self) -> Option<usize> {
        self.inner.finite
    }

    #[getter]
    fn infinitesimal(&self) -> usize {
        self.inner.infinitesimal
    }

    #[getter]
    fn branches(&self) -> Vec<PyBranch> {
        self.inner.branches.iter().map(PyBranch::from).collect()
    }

    #[getter]
    fn shaky<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.shaky)
    }

    #[getter]
    fn evidence(&self) -> String {
        self.inner.evidence.to_string()
    }

    #[getter]
    fn certain(&self) -> bool {
        self.inner.certain
    }

    #[getter]
    fn tracked(&self) -> f64 {
        self.inner.tracked
    }

    #[getter]
    fn contact_order(&self) -> Option<u32> {
        self.inner.contact_order
    }

    #[getter]
    fn second_order(&self) -> Option<&'static str> {
        self.inner.second_order.as_ref().map(|s| s.rigidity.name())
    }

    fn __repr__(&self) -> String {
        let dof = self.inner.finite.map_or_else(|| "unknown".to_owned(), |f| f.to_string());
        format!("<FiniteMobility: {dof} of {}, {}>", self.inner.infinitesimal, self.inner.evidence)
    }
}

/// A set of closed configurations through the configuration in question.
///
/// Attributes
/// ----------
/// dimension : int
///     Its finite degrees of freedom.
/// motions : ndarray, (n, k)
///     Rates of q along it.
/// tracked : float
///     Distance to which it was tracked [rad, or characteristic lengths].
/// configurations : ndarray, (N, n)
///     Configurations on it, as far from this one as it was tracked.
#[pyclass(frozen, name = "Branch", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyBranch {
    #[pyo3(get)]
    dimension: usize,
    motions: Matrix,
    #[pyo3(get)]
    tracked: f64,
    configurations: Vec<Vec<f64>>,
}

impl From<&Branch> for PyBranch {
    fn from(branch: &Branch) -> Self {
        Self {
            dimension: branch.dimension,
            motions: branch.motions.clone(),
            tracked: branch.tracked,
            configurations: branch.configurations.clone(),
        }
    }
}

#[pymethods]
impl PyBranch {
    #[getter]
    fn motions<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.motions)
    }

    #[getter]
    fn configurations<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let rows = Matrix::from_fn(self.configurations.len(), self.motions.rows(), |i, j| {
            self.configurations[i][j]
        });
        arrays::matrix(py, &rows)
    }

    fn __repr__(&self) -> String {
        format!("<Branch of dimension {}>", self.dimension)
    }
}
