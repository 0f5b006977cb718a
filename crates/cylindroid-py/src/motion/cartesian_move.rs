//! The class `CartesianMove`: a Cartesian trajectory, time-scaled within bounds.

use cylindroid::control::{CartesianBounds, CartesianMove};
use pyo3::prelude::*;

use super::{PyCartesianPath, bounds, check_instant, times};
use crate::arrays::{self, Array, Numbers};
use crate::error::{Result, argument};
use crate::table;

/// A Cartesian trajectory: a path with the fastest time law within bounds of speed, acceleration
/// and jerk.
///
/// Parameters
/// ----------
/// path : CartesianPath
/// speed, acceleration, jerk : float or (float, float), optional
///     Bounds of translation and rotation [m/s, rad/s; m/s^2, rad/s^2; m/s^3, rad/s^3]; a single
///     number bounds translations. Defaults: (0.25, 1), (1, 4), and no bound on the jerk, which
///     gives a trapezoidal velocity profile.
/// duration : float, optional
///     Slows the move down to this duration (s). Default: the shortest.
///
/// Attributes
/// ----------
/// duration : float
///     Time from rest to rest (s).
/// path : CartesianPath
///
/// Raises
/// ------
/// InvalidOptionError
///     For bounds that are NaN, zero or negative, and a duration shorter than the shortest.
///
/// Notes
/// -----
/// `Servo.simulate(q, move)` simulates a servo that tracks the move.
#[pyclass(frozen, name = "CartesianMove", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyCartesianMove {
    pub(crate) inner: CartesianMove,
}

#[pymethods]
impl PyCartesianMove {
    #[new]
    #[pyo3(signature = (path, speed = None, acceleration = None, jerk = None, duration = None))]
    fn new(
        #[pyo3(from_py_with = argument)] path: PyRef<'_, PyCartesianPath>,
        speed: Option<Numbers<'_>>,
        acceleration: Option<Numbers<'_>>,
        jerk: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] duration: Option<f64>,
    ) -> Result<Self> {
        let (linear, angular) = bounds([&speed, &acceleration, &jerk], false)?;
        let bounds = CartesianBounds { linear, angular };
        let mut inner = CartesianMove::new(path.inner, bounds)?;
        if let Some(duration) = duration {
            inner = inner.scaled_to_duration(duration)?;
        }
        Ok(Self { inner })
    }

    #[getter]
    fn duration(&self) -> f64 {
        self.inner.law().duration()
    }

    #[getter]
    fn path(&self) -> PyCartesianPath {
        PyCartesianPath { inner: *self.inner.path() }
    }

    /// Pose and twist of the trajectory at a time; at rest before 0 and after the duration.
    ///
    /// Parameters
    /// ----------
    /// t : array_like, () or (N,)
    ///     Time (s).
    ///
    /// Returns
    /// -------
    /// (ndarray, ndarray)
    ///     Poses `world_from_tool`, (4, 4) or (N, 4, 4) (m), and twists, (6,) or (N, 6): linear
    ///     first, world axes, at the moving origin [m/s, rad/s].
    ///
    /// Raises
    /// ------
    /// NotFiniteError
    ///     For a NaN time.
    #[pyo3(signature = (t))]
    fn at<'py>(&self, py: Python<'py>, t: Numbers<'py>) -> Result<(Array<'py>, Array<'py>)> {
        let (t, count) = times("t", &t)?;
        let poses = arrays::written(py, count, &[4, 4], |out| {
            for (t, out) in t.iter().zip(out.chunks_exact_mut(16)) {
                arrays::put_pose(self.inner.at(*t).pose, out);
            }
        })?;
        let twists = arrays::written(py, count, &[6], |out| {
            for (t, out) in t.iter().zip(out.chunks_exact_mut(6)) {
                out.copy_from_slice(&self.inner.at(*t).twist.to_array());
            }
        })?;
        Ok((poses, twists))
    }

    /// Target pose and feed-forward twist of a servo with period `dt`, for `Servo.step`.
    ///
    /// Parameters
    /// ----------
    /// t, dt : float
    ///     Time and period (s).
    ///
    /// Returns
    /// -------
    /// (ndarray, ndarray)
    ///     The pose at `t`, (4, 4) (m), and the constant twist to the pose at `t + dt`, (6,):
    ///     linear first, world axes, at the moving origin [m/s, rad/s].
    ///
    /// Raises
    /// ------
    /// NotFiniteError
    ///     For a NaN time.
    /// InvalidOptionError
    ///     For a period that is not positive and finite.
    #[pyo3(signature = (t, dt))]
    fn target<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = argument)] t: f64,
        #[pyo3(from_py_with = argument)] dt: f64,
    ) -> Result<(Array<'py>, Array<'py>)> {
        check_instant(t, dt)?;
        let target = self.inner.target(t, dt);
        Ok((arrays::pose(py, target.pose)?, arrays::vector(py, &target.feed_forward.to_array())))
    }

    fn __repr__(&self) -> String {
        format!("<CartesianMove of {} s>", table::number(self.duration()))
    }
}
