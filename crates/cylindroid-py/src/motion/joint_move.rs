//! The class `JointMove`: a joint-space trajectory.

use cylindroid::control::{JointDefaults, JointMove, JointSample};
use pyo3::prelude::*;

use super::{bounds, times};
use crate::arrays::{self, Array, Numbers};
use crate::coordinates::Coordinates;
use crate::error::{Result, argument};
use crate::mechanism::PyMechanism;
use crate::table;

/// A joint-space trajectory: all joints move straight to another configuration, starting and
/// stopping together.
///
/// Parameters
/// ----------
/// mechanism : Mechanism
///     Its position, velocity and acceleration limits are respected.
/// q, to : array_like, (n,)
///     Initial and final configuration [rad or m].
/// speed, acceleration, jerk : float or (float, float), optional
///     Bounds of prismatic and revolute joints [m/s, rad/s; m/s^2, rad/s^2; m/s^3, rad/s^3]: of
///     speed and acceleration for joints without limits of their own, of the jerk for all joints.
///     Defaults: (0.25, 1), (1, 4), and no bound on the jerk.
/// duration : float, optional
///     Slows the move down to this duration (s). Default: the shortest.
///
/// Attributes
/// ----------
/// duration : float
///     Time from rest to rest (s).
///
/// Raises
/// ------
/// DimensionError, NotFiniteError
/// InvalidOptionError
///     For configurations outside the limits, and for motions of spherical or free joints without
///     a straight joint-space path.
#[pyclass(frozen, name = "JointMove", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyJointMove {
    inner: JointMove,
}

#[pymethods]
impl PyJointMove {
    #[new]
    #[pyo3(signature = (mechanism, q, to, speed = None, acceleration = None, jerk = None,
        duration = None))]
    fn new(
        #[pyo3(from_py_with = argument)] mechanism: PyRef<'_, PyMechanism>,
        q: Coordinates<'_>,
        to: Coordinates<'_>,
        speed: Option<Numbers<'_>>,
        acceleration: Option<Numbers<'_>>,
        jerk: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] duration: Option<f64>,
    ) -> Result<Self> {
        let (length, angle) = bounds([&speed, &acceleration, &jerk], true)?;
        let defaults = JointDefaults { length, angle };
        let (q, to) = (q.vector(&mechanism.inner, "q")?, to.vector(&mechanism.inner, "to")?);
        mechanism.inner.check_q("q", q)?;
        mechanism.inner.check_q("to", to)?;
        let mut inner = JointMove::within_limits(&mechanism.inner, q, to, &defaults)?;
        if let Some(duration) = duration {
            inner = inner.scaled_to_duration(duration)?;
        }
        Ok(Self { inner })
    }

    #[getter]
    fn duration(&self) -> f64 {
        self.inner.law().duration()
    }

    /// Configuration and joint velocities at a time; at rest before 0 and after the duration.
    ///
    /// Parameters
    /// ----------
    /// t : array_like, () or (N,)
    ///     Time (s).
    ///
    /// Returns
    /// -------
    /// (ndarray, ndarray)
    ///     q [rad or m] and joint velocities [rad/s or m/s], (n,) or (N, n).
    ///
    /// Raises
    /// ------
    /// NotFiniteError
    ///     For a NaN time.
    #[pyo3(signature = (t))]
    fn at<'py>(&self, py: Python<'py>, t: Numbers<'py>) -> Result<(Array<'py>, Array<'py>)> {
        let (t, count) = times("t", &t)?;
        let n = self.inner.path().dof();
        let mut velocities = vec![0.0; n * t.len()];
        let mut result = Ok(());
        let q = arrays::written(py, count, &[n], |out| {
            let rows = out.chunks_exact_mut(n.max(1)).zip(velocities.chunks_exact_mut(n.max(1)));
            result = t.iter().zip(rows).try_for_each(|(t, (positions, velocities))| {
                self.inner.sample_into(*t, JointSample { positions, velocities }).map(|_| ())
            });
        })?;
        result?;
        let qd = arrays::written(py, count, &[n], |out| out.copy_from_slice(&velocities))?;
        Ok((q, qd))
    }

    fn __repr__(&self) -> String {
        format!("<JointMove of {} s>", table::number(self.duration()))
    }
}
