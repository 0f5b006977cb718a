//! The class `TimeLaw`: trapezoidal and jerk-limited velocity profiles.

use cylindroid::control::{KinematicBounds, TimeLaw};
use pyo3::prelude::*;

use super::times;
use crate::arrays::{self, Array, Numbers};
use crate::error::{Result, argument};

/// A time law (trapezoidal or jerk-limited velocity profile): the fastest motion of one coordinate
/// from rest to rest within bounds.
///
/// Parameters
/// ----------
/// distance : float
///     Displacement, of either sign, in the unit u of the coordinate.
/// velocity, acceleration : float
///     Bounds [u/s, u/s^2].
/// jerk : float, optional
///     Bound [u/s^3]. Default: none, which gives a trapezoidal velocity profile.
/// duration : float, optional
///     Slows the motion down to this duration (s). Default: the shortest.
///
/// Attributes
/// ----------
/// duration : float
///     Time from rest to rest (s).
/// distance : float
///     Displacement [u].
///
/// Raises
/// ------
/// InvalidOptionError, NotFiniteError
///     For bounds that are not positive, and a duration shorter than the shortest.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> cy.TimeLaw(3.0, velocity=1.0, acceleration=2.0).duration
/// 3.5
#[pyclass(frozen, name = "TimeLaw", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyTimeLaw {
    inner: TimeLaw,
}

#[pymethods]
impl PyTimeLaw {
    #[new]
    #[pyo3(signature = (distance, velocity, acceleration, jerk = None, duration = None))]
    fn new(
        #[pyo3(from_py_with = argument)] distance: f64,
        #[pyo3(from_py_with = argument)] velocity: f64,
        #[pyo3(from_py_with = argument)] acceleration: f64,
        #[pyo3(from_py_with = argument)] jerk: Option<f64>,
        #[pyo3(from_py_with = argument)] duration: Option<f64>,
    ) -> Result<Self> {
        let jerk = jerk.unwrap_or(f64::INFINITY);
        let mut inner = TimeLaw::new(distance, KinematicBounds { velocity, acceleration, jerk })?;
        if let Some(duration) = duration {
            inner = inner.scaled_to_duration(duration)?;
        }
        Ok(Self { inner })
    }

    #[getter]
    fn duration(&self) -> f64 {
        self.inner.duration()
    }

    #[getter]
    fn distance(&self) -> f64 {
        self.inner.distance()
    }

    /// Position, velocity, acceleration and jerk of the time law at a time.
    ///
    /// Parameters
    /// ----------
    /// t : array_like, () or (N,)
    ///     Time (s).
    ///
    /// Returns
    /// -------
    /// ndarray, (4,) or (N, 4)
    ///     [u, u/s, u/s^2, u/s^3].
    ///
    /// Raises
    /// ------
    /// NotFiniteError
    ///     For a NaN time.
    #[pyo3(signature = (t))]
    fn at<'py>(&self, py: Python<'py>, t: Numbers<'py>) -> Result<Array<'py>> {
        let (t, count) = times("t", &t)?;
        arrays::written(py, count, &[4], |out| {
            for (t, out) in t.iter().zip(out.chunks_exact_mut(4)) {
                let s = self.inner.at(*t);
                out.copy_from_slice(&[s.position, s.velocity, s.acceleration, s.jerk]);
            }
        })
    }

    fn __repr__(&self) -> String {
        format!("<TimeLaw over {} in {} s>", self.inner.distance(), self.inner.duration())
    }
}
