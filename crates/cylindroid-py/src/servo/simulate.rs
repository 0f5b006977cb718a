//! Complete motions: simulation of a servo with its robot, and reconfiguration.

use cylindroid::control::{Target, TrajectorySample, find_reachable_configuration, simulate};
use cylindroid::{Error, Pose};
use pyo3::prelude::*;

use super::{PyMotionResult, PyServo, PyTrajectory};
use crate::arrays::{self, Array, Numbers};
use crate::coordinates::Coordinates;
use crate::error::{Result, argument, count, entry};
use crate::motion::{PyCartesianMove, PyWaypointMove};

/// The goal of a motion.
enum Goal {
    Pose(Pose),
    Along(Box<cylindroid::control::CartesianMove>),
    Waypoints(Box<cylindroid::control::WaypointMove>),
}

#[pymethods]
impl PyServo {
    /// Simulates the servo with its robot (`delay`, `time_constant` and `noise` of the servo; an
    /// ideal one by default) until it reaches the target or stalls.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,)
    ///     The initial configuration [rad or m].
    /// target : array_like, (4, 4), or CartesianMove or WaypointMove
    ///     The pose `world_from_tool` (m), or a moving target.
    /// duration : float
    ///     Time limit (s).
    /// record : bool
    ///     Whether to keep every step in `MotionResult.trajectory`.
    ///
    /// Returns
    /// -------
    /// MotionResult
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, InvalidOptionError
    #[pyo3(signature = (q, target, duration = 60.0, record = false))]
    fn simulate(
        &self,
        py: Python<'_>,
        q: Coordinates<'_>,
        target: Bound<'_, PyAny>,
        #[pyo3(from_py_with = argument)] duration: f64,
        #[pyo3(from_py_with = argument)] record: bool,
    ) -> Result<PyMotionResult> {
        Error::check_positive("duration", duration)?;
        let goal = match target.extract::<PyRef<'_, PyCartesianMove>>() {
            Ok(motion) => Goal::Along(Box::new(motion.inner)),
            Err(_) => match target.extract::<PyRef<'_, PyWaypointMove>>() {
                Ok(motion) => Goal::Waypoints(Box::new(motion.inner.clone())),
                Err(_) => Goal::Pose(entry::<Numbers<'_>>("target", &target)?.pose("target")?),
            },
        };
        let running = &mut *self.lock()?;
        let q = q.vector(running.servo.mechanism(), "q")?;
        let servo = &mut running.servo;
        servo.reset();
        let dt = servo.options().dt;
        let mut trajectory = record.then(|| PyTrajectory::of(servo.mechanism()));
        let outcome = py.detach(|| {
            let observe = |sample: TrajectorySample<'_>| {
                if let Some(trajectory) = &mut trajectory {
                    trajectory.push(&sample);
                }
            };
            let aim = |time: f64| match &goal {
                Goal::Pose(pose) => (Target::from(*pose), true),
                Goal::Along(motion) => (motion.target(time, dt), time >= motion.law().duration()),
                Goal::Waypoints(motion) => (motion.target(time, dt), time >= motion.duration()),
            };
            simulate(servo, q, duration, aim, observe)
        })?;
        (running.last, running.twist) = (Some(outcome.last), None);
        let trajectory = trajectory.map(|t| Py::new(py, t)).transpose()?;
        let mechanism = running.servo.mechanism().clone();
        Ok(PyMotionResult { outcome, trajectory, mechanism })
    }

    /// Searches for a configuration within the limits that reaches a target, for reconfiguration
    /// when the servo stalls on its straight path.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,)
    ///     Coordinates that do not move the frame keep these values.
    /// target : array_like, (4, 4)
    ///     `world_from_tool` (m).
    /// max_restarts : int
    ///     Largest number of random restarts.
    ///
    /// Returns
    /// -------
    /// ndarray, (n,), or None
    ///     None means that no restart reached the target: probably, but not provably, no
    ///     configuration does.
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, InvalidOptionError
    #[pyo3(signature = (q, target, max_restarts = 200))]
    fn find_reachable_configuration<'py>(
        &self,
        py: Python<'py>,
        q: Coordinates<'py>,
        target: Numbers<'py>,
        #[pyo3(from_py_with = count)] max_restarts: usize,
    ) -> Result<Option<Array<'py>>> {
        let target = target.pose("target")?;
        let servo = &self.lock()?.servo;
        let q = q.vector(servo.mechanism(), "q")?;
        let found = py.detach(|| find_reachable_configuration(servo, q, target, max_restarts))?;
        Ok(found.map(|found| arrays::vector(py, &found.q)))
    }
}
