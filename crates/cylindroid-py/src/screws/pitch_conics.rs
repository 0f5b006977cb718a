//! The class `PitchConics`: the screws of each pitch in a three-system.

use cylindroid::Error;
use cylindroid::screws::PitchConics;
use pyo3::prelude::*;

use super::system::PyScrewSystem;
use crate::arrays::{self, Array, Numbers};
use crate::error::{Result, argument, count};

/// The pencil of conics in which a three-system meets the pitch quadrics, in the projective plane of
/// its screws: created by `ScrewSystem.pitch_conics`.
///
/// Attributes
/// ----------
/// generators : ndarray, (6, 3)
///     The twists that the homogeneous coordinates refer to, linear part first.
/// klein, angular : ndarray, (3, 3)
///     K and W: a screw x has the pitch ``x @ K @ x / (x @ W @ x)`` [m/rad].
#[pyclass(frozen, name = "PitchConics", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyPitchConics {
    inner: PitchConics,
}

#[pymethods]
impl PyPitchConics {
    #[getter]
    fn generators<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::twists(py, &self.inner.generators)
    }

    #[getter]
    fn klein<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        three(py, &self.inner.klein)
    }

    #[getter]
    fn angular<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        three(py, &self.inner.angular)
    }

    /// What the conic of a pitch is.
    ///
    /// Parameters
    /// ----------
    /// h : float
    ///     [m/rad]; infinite: the translations.
    ///
    /// Returns
    /// -------
    /// str
    ///     'empty', 'point', 'regular conic', 'pair of lines', 'double line' or 'whole plane'.
    #[pyo3(signature = (h))]
    fn kind(&self, #[pyo3(from_py_with = argument)] h: f64) -> Result<&'static str> {
        check(h)?;
        Ok(self.inner.kind(h).name())
    }

    /// Points of the conic of a pitch.
    ///
    /// Parameters
    /// ----------
    /// h : float
    ///     [m/rad]
    /// count : int
    ///     Of a curve.
    ///
    /// Returns
    /// -------
    /// list of ndarray, (k, 3)
    ///     Homogeneous coordinates of length one: a closed curve for a regular conic, two lines for
    ///     a pair, a single point, nothing if there is none.
    #[pyo3(signature = (h, count = 400))]
    fn points<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = argument)] h: f64,
        #[pyo3(from_py_with = count)] count: usize,
    ) -> Result<Vec<Array<'py>>> {
        check(h)?;
        self.inner.points(h, count).iter().map(|curve| three(py, curve)).collect()
    }

    /// The homogeneous coordinates of a twist of the system.
    ///
    /// Parameters
    /// ----------
    /// twist : array_like, (6,)
    ///
    /// Returns
    /// -------
    /// ndarray, (3,), or None
    ///     Of length one; None for a twist outside the system.
    #[pyo3(signature = (twist))]
    fn coordinates<'py>(&self, py: Python<'py>, twist: Numbers<'py>) -> Result<Option<Array<'py>>> {
        let twist = twist.twist("twist")?;
        Error::check_finite("twist", &twist.to_array())?;
        Ok(self.inner.coordinates(twist).map(|x| arrays::vector(py, &x)))
    }

    fn __repr__(&self) -> String {
        "<PitchConics of a three-system>".to_owned()
    }
}

fn three<'py>(py: Python<'py>, rows: &[[f64; 3]]) -> Result<Array<'py>> {
    arrays::rows(py, Some(rows.len()), 3, rows.iter())
}

fn check(h: f64) -> Result<()> {
    if h.is_nan() {
        return Err(Error::NotFinite { what: "h".into(), value: h }.into());
    }
    Ok(())
}

#[pymethods]
impl PyScrewSystem {
    /// The screws of each pitch in a system of order three: a pencil of conics, of which those of
    /// the principal pitches are singular (Ball; Donelan and Selig, figure 1).
    ///
    /// Returns
    /// -------
    /// PitchConics or None
    ///     None for systems of other orders.
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> twists = [[0.3, 0, 0, 1, 0, 0], [0, 0.1, 0, 0, 1, 0], [0, 0, -0.2, 0, 0, 1]]
    /// >>> import numpy as np
    /// >>> conics = cy.ScrewSystem(np.transpose(twists)).pitch_conics()
    /// >>> [conics.kind(h) for h in (0.3, 0.1, 0.0, -0.2)]
    /// ['point', 'pair of lines', 'regular conic', 'point']
    fn pitch_conics(&self) -> Option<PyPitchConics> {
        self.inner.pitch_conics().map(|inner| PyPitchConics { inner })
    }
}
