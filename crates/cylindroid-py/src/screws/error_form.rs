//! The error form of a twist, and the pitches at which it vanishes.

use cylindroid::screws::ErrorFormZeros;
use pyo3::prelude::*;

use super::PyScrewSystem;
use super::forms::finite_twist;
use super::pitch::check_pitch;
use crate::arrays::{self, Array, Numbers};
use crate::error::{Result, argument};
use crate::table;

/// The pitches at which the error form of a twist vanishes.
///
/// Attributes
/// ----------
/// pitches : ndarray
///     Zeros [m/rad], largest first; empty if `everywhere` or not `defined`.
/// everywhere : bool
///     True if the form vanishes at every pitch at which the inverse exists.
/// defined : bool
///     False if the screw system has no hyperbolic pseudoinverse for any pitch.
#[pyclass(frozen, name = "ErrorFormZeros", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyErrorFormZeros {
    inner: ErrorFormZeros,
}

impl PyErrorFormZeros {
    fn at(&self) -> &[f64] {
        match &self.inner {
            ErrorFormZeros::At(pitches) => pitches,
            _ => &[],
        }
    }
}

#[pymethods]
impl PyErrorFormZeros {
    #[getter]
    fn pitches<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, self.at())
    }

    #[getter]
    fn everywhere(&self) -> bool {
        self.inner == ErrorFormZeros::Everywhere
    }

    #[getter]
    fn defined(&self) -> bool {
        self.inner != ErrorFormZeros::Undefined
    }

    fn __repr__(&self) -> String {
        match &self.inner {
            ErrorFormZeros::At(pitches) => format!("ErrorFormZeros({})", table::list(pitches)),
            ErrorFormZeros::Everywhere => "ErrorFormZeros(everywhere)".to_owned(),
            ErrorFormZeros::Undefined => "ErrorFormZeros(undefined)".to_owned(),
        }
    }
}

#[pymethods]
impl PyScrewSystem {
    /// The error form Phi_h of a twist: the pitch form of the part that the hyperbolic
    /// pseudoinverse of pitch h discards.
    ///
    /// Parameters
    /// ----------
    /// twist : array_like, (6,)
    ///     s, linear part first, in the frame of the system [m/s, rad/s].
    /// h : float
    ///     [m/rad], or infinite for the limit.
    ///
    /// Returns
    /// -------
    /// float or None
    ///     `(s - P s).T @ Q_h @ (s - P s)` [m rad/s^2], of either sign and the same in every frame;
    ///     None if the inverse does not exist, see `existence(h)`.
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    ///
    /// Notes
    /// -----
    /// Donelan and Selig, eq. 24; the value of their example 4 is for 2 Q_h.
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> revolute = cy.ScrewSystem([[0], [0], [0], [0], [0], [1]])
    /// >>> round(revolute.error_form([0.3, 0, 0, 1, 0, 0], 0.1), 12)
    /// 0.2
    #[pyo3(signature = (twist, h))]
    fn error_form(
        &self,
        twist: Numbers<'_>,
        #[pyo3(from_py_with = argument)] h: f64,
    ) -> Result<Option<f64>> {
        check_pitch(h)?;
        Ok(self.inner.error_form(finite_twist(&twist, "twist")?, h))
    }

    /// The pitches at which the error form of a twist vanishes.
    ///
    /// Parameters
    /// ----------
    /// twist : array_like, (6,)
    ///     Linear part first, in the frame of the system [m/s, rad/s].
    ///
    /// Returns
    /// -------
    /// ErrorFormZeros
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> revolute = cy.ScrewSystem([[0], [0], [0], [0], [0], [1]])
    /// >>> revolute.error_form_zeros([0.3, 0, 0, 1, 0, 0]).pitches.round(12)
    /// array([0.3])
    #[pyo3(signature = (twist))]
    fn error_form_zeros(&self, twist: Numbers<'_>) -> Result<PyErrorFormZeros> {
        let twist = finite_twist(&twist, "twist")?;
        Ok(PyErrorFormZeros { inner: self.inner.error_form_zeros(twist)? })
    }
}
