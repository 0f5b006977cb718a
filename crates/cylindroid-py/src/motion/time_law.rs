//! The class `TimeLaw`.

use cylindroid::control::{KinematicBounds, TimeLaw};
use pyo3::prelude::*;

use super::times;
use crate::arrays::{self, Array, Numbers};
use crate::error::Result;

/// A motion of one coordinate from rest at 0 to rest at a distance, as fast as bounds allow.
///
/// Parameters
/// ----------
/// distance : float
///     Of either sign, in the unit u of the coordinate.
/// velocity, acceleration : float
///     Bounds [u/s, u/s^2].
/// jerk : float, optional
///     [u/s^3]. Default: no bound, which gives a trapezoidal velocity.
/// duration : float, optional
///     Slows the motion down to end then (s).
///
/// Attributes
/// ----------
/// duration, distance : float
///
/// Raises
/// ------
/// InvalidOptionError, NotFiniteError
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
        distance: f64,
        velocity: f64,
        acceleration: f64,
        jerk: Option<f64>,
        duration: Option<f64>,
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

    /// Position, velocity, acceleration and jerk at a time.
    ///
    /// Parameters
    /// ----------
    /// t : array_like, () or (N,)
    ///     (s).
    ///
    /// Returns
    /// -------
    /// ndarray, (4,) or (N, 4)
    ///
    /// Raises
    /// ------
    /// NotFiniteError
    ///     For a time that is NaN.
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
