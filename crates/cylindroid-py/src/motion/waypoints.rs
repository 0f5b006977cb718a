//! The class `WaypointMove`: a trajectory through waypoints, without stopping at them.

use cylindroid::control::{CartesianBounds, WaypointMove};
use pyo3::prelude::*;

use super::{bounds, check_instant, times};
use crate::arrays::{self, Array, Numbers};
use crate::error::{Failure, Result, argument};
use crate::table;

/// A trajectory through waypoints: straight lines, joined by blends of constant acceleration, from
/// rest to rest.
///
/// Parameters
/// ----------
/// poses : array_like, (N, 4, 4)
///     `world_from_tool` of the waypoints, the start included (m).
/// times : array_like, (N,), optional
///     Times of the waypoints (s), increasing. Default: as fast as the bounds permit.
/// speed, acceleration : float or (float, float), optional
///     Bounds of translation and rotation [m/s, rad/s; m/s^2, rad/s^2]; a single number bounds
///     translations. Defaults: (0.25, 1), (1, 4). With `times`, speeds follow from them, and
///     `speed` is refused; with `speeds`, it bounds translations only if it is given.
/// speeds : array_like, (N - 1,), optional
///     Largest speed of the translation between each waypoint and the next (m/s). Where only the
///     orientation changes, `speed` bounds the rotation.
///
/// Attributes
/// ----------
/// duration : float
///     Time from rest to rest (s).
/// largest_deviation : float
///     The largest distance at which a waypoint is passed (m).
///
/// Raises
/// ------
/// InvalidOptionError
///     For fewer than two poses, times that do not increase or are too short, both times and a
///     speed or speeds, and speeds and bounds that are not positive.
/// DimensionError, NotFiniteError
///
/// Notes
/// -----
/// `Servo.simulate(q, move)` simulates a servo that tracks the move.
#[pyclass(frozen, name = "WaypointMove", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyWaypointMove {
    pub(crate) inner: WaypointMove,
}

#[pymethods]
impl PyWaypointMove {
    #[new]
    #[pyo3(signature = (poses, times = None, speed = None, acceleration = None, speeds = None))]
    fn new(
        poses: Numbers<'_>,
        times: Option<Numbers<'_>>,
        speed: Option<Numbers<'_>>,
        acceleration: Option<Numbers<'_>>,
        speeds: Option<Numbers<'_>>,
    ) -> Result<Self> {
        let (mut linear, angular) = bounds([&speed, &acceleration, &None], false)?;
        if speeds.is_some() && speed.is_none() {
            linear.velocity = f64::INFINITY;
        }
        let bounds = CartesianBounds { linear, angular };
        let given = [("speed", &speed), ("speeds", &speeds)];
        let given = given.into_iter().find_map(|(name, values)| Some((name, values.as_ref()?)));
        if let (Some(_), Some((name, values))) = (&times, given) {
            let values: Vec<String> = values.values().iter().map(f64::to_string).collect();
            let reason = "with times, speeds follow from them; leave one of the two out";
            return Err(Failure::option(name, values.join(", "), reason));
        }
        let poses = poses.poses("poses")?;
        let inner = match (&times, &speeds) {
            (Some(times), _) => WaypointMove::timed(&poses, times.vector("times")?, bounds)?,
            (None, Some(speeds)) => {
                WaypointMove::with_speeds(&poses, speeds.vector("speeds")?, bounds)?
            }
            (None, None) => WaypointMove::new(&poses, bounds)?,
        };
        Ok(Self { inner })
    }

    #[getter]
    fn duration(&self) -> f64 {
        self.inner.duration()
    }

    #[getter]
    fn largest_deviation(&self) -> f64 {
        self.inner.largest_deviation()
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
                arrays::put_pose(self.inner.at(*t).0, out);
            }
        })?;
        let twists = arrays::written(py, count, &[6], |out| {
            for (t, out) in t.iter().zip(out.chunks_exact_mut(6)) {
                out.copy_from_slice(&self.inner.at(*t).1.to_array());
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
        format!("<WaypointMove of {} s>", table::number(self.duration()))
    }
}
