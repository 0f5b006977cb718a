//! The class `Admittance`: admittance control, a twist from a wrench.

use cylindroid::control::{Admittance, AdmittanceGain};
use cylindroid::{Error, Matrix, Vec3};
use pyo3::prelude::*;

use crate::arrays::{self, Array, Numbers, entries_of};
use crate::error::{Failure, Result, argument};

/// Admittance of a tool: twist = matrix @ wrench.
///
/// Parameters
/// ----------
/// force : float
///     Gain from forces to linear velocities, in all directions [m/s/N].
/// moment : float
///     Gain from moments to angular velocities [rad/s/(N m)]; zero for a tool that does not rotate.
/// point : array_like, (3,), optional
///     Reference point of moments (m). Default: the origin of the frame.
///
/// Attributes
/// ----------
/// matrix : ndarray, (6, 6)
///     The twist (linear first) per wrench (force first).
///
/// Raises
/// ------
/// InvalidOptionError, NotFiniteError
///     For negative gains: an admittance must be passive.
///
/// Notes
/// -----
/// Hogan 1985.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> cy.Admittance(0.01).matrix.diagonal()
/// array([0.01, 0.01, 0.01, 0.  , 0.  , 0.  ])
#[pyclass(frozen, name = "Admittance", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyAdmittance {
    pub(super) inner: Admittance,
}

#[pymethods]
impl PyAdmittance {
    #[new]
    #[pyo3(signature = (force, moment = 0.0, point = None))]
    fn new(
        #[pyo3(from_py_with = argument)] force: f64,
        #[pyo3(from_py_with = argument)] moment: f64,
        point: Option<Numbers<'_>>,
    ) -> Result<Self> {
        let point = point.map_or(Ok(Vec3::ZERO), |p| p.entries("point").map(Vec3::from_array))?;
        Ok(Self { inner: Admittance::at(point, AdmittanceGain { force, moment })? })
    }

    /// The admittance with a given matrix.
    ///
    /// Parameters
    /// ----------
    /// matrix : array_like, (6, 6)
    ///     The twist (linear first) per wrench (force first); its symmetric part must be positive
    ///     semidefinite.
    ///
    /// Returns
    /// -------
    /// Admittance
    ///
    /// Raises
    /// ------
    /// InvalidOptionError, NotFiniteError
    ///     For a matrix of the wrong shape, and one that is not passive.
    #[staticmethod]
    #[pyo3(signature = (matrix))]
    fn from_matrix(matrix: Numbers<'_>) -> Result<Self> {
        let m = matrix.matrix("matrix")?;
        if (m.rows(), m.cols()) != (6, 6) {
            let shape = format!("{} x {}", m.rows(), m.cols());
            return Err(Failure::option("matrix", shape, "it is 6 x 6, linear part first"));
        }
        let rows = std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)]));
        let inner = Admittance::from_rows(rows).map_err(|error| match error {
            Error::InvalidOption { value, reason, .. } => Failure::option("matrix", value, reason),
            other => entries_of("matrix", other),
        })?;
        Ok(Self { inner })
    }

    #[getter]
    fn matrix<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let rows = self.inner.rows();
        arrays::matrix(py, &Matrix::from_fn(6, 6, |i, j| rows[i][j]))
    }

    /// The same admittance expressed in another frame.
    ///
    /// Parameters
    /// ----------
    /// a_from_b : array_like, (4, 4)
    ///     Pose of frame b, in which this admittance is expressed, in frame a (m).
    ///
    /// Returns
    /// -------
    /// Admittance
    ///     In frame a.
    ///
    /// Raises
    /// ------
    /// InvalidOptionError, NotFiniteError
    #[pyo3(signature = (a_from_b))]
    fn seen_from(&self, a_from_b: Numbers<'_>) -> Result<Self> {
        Ok(Self { inner: self.inner.seen_from(a_from_b.pose("a_from_b")?) })
    }

    fn __repr__(&self) -> String {
        format!("<Admittance, {} m/s/N along x>", self.inner.rows()[0][0])
    }
}
