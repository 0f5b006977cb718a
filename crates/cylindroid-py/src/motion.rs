//! Paths, moves and time laws.

use cylindroid::Vec3;
use cylindroid::control::{
    Bounds, CartesianBounds, CartesianMove, CartesianPath, JointDefaults, JointMove, JointSample,
    TimeLaw, Turn,
};
use pyo3::prelude::*;

use crate::arrays::{self, Array, Numbers};
use crate::error::{Failure, Result};
use crate::mechanism::PyMechanism;
use crate::options::pair;
use crate::table;

/// Speeds and accelerations on a path where none are given, as on the command line.
const SPEED: (f64, f64) = (0.25, 1.0);
const ACCELERATION: (f64, f64) = (1.0, 4.0);

/// Numbers of an argument that may be one number or a vector of them.
fn times<'a>(name: &'static str, of: &'a Numbers<'_>) -> Result<(&'a [f64], Option<usize>)> {
    match *of.shape() {
        [] => Ok((of.values(), None)),
        [count] => Ok((of.values(), Some(count))),
        _ => Err(Failure::option(name, "an array of several axes", "give a number or a vector")),
    }
}

/// A path of a frame in space, over s from 0 to 1; from `line`, `circle` or `turn`.
///
/// Attributes
/// ----------
/// length : float
///     Of the path of the origin (m).
/// angle : float
///     Of the whole rotation (rad).
/// radius : float
///     Of the arc (m); infinite for a line.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import cylindroid as cy
/// >>> start, end = np.eye(4), np.eye(4)
/// >>> end[2, 3] = 0.5
/// >>> cy.CartesianPath.line(start, end).pose(0.5)[:3, 3]
/// array([0.  , 0.  , 0.25])
#[pyclass(frozen, name = "CartesianPath", module = "cylindroid")]
#[derive(Debug, Clone, Copy)]
pub(crate) struct PyCartesianPath {
    inner: CartesianPath,
}

#[pymethods]
impl PyCartesianPath {
    /// Along the straight line between two poses, turning about the constant axis by at most pi.
    ///
    /// Parameters
    /// ----------
    /// start, end : array_like, (4, 4)
    ///     `world_from_tool` (m).
    ///
    /// Returns
    /// -------
    /// CartesianPath
    ///
    /// Raises
    /// ------
    /// NotFiniteError, InvalidOptionError
    #[staticmethod]
    #[pyo3(signature = (start, end))]
    fn line(start: Numbers<'_>, end: Numbers<'_>) -> Result<Self> {
        Ok(Self { inner: CartesianPath::line(start.pose("start")?, end.pose("end")?)? })
    }

    /// Along the arc through a point.
    ///
    /// Parameters
    /// ----------
    /// start : array_like, (4, 4)
    /// via : array_like, (3,)
    ///     A point on the arc (m).
    /// end : array_like, (4, 4)
    ///
    /// Returns
    /// -------
    /// CartesianPath
    ///
    /// Raises
    /// ------
    /// NotFiniteError, InvalidOptionError
    ///     Also for three points on one line.
    #[staticmethod]
    #[pyo3(signature = (start, via, end))]
    fn circle(start: Numbers<'_>, via: Numbers<'_>, end: Numbers<'_>) -> Result<Self> {
        let via = Vec3::from_array(via.entries("via")?);
        Ok(Self { inner: CartesianPath::circle(start.pose("start")?, via, end.pose("end")?)? })
    }

    /// Along the arc of a turn about a fixed line, the orientation carried along.
    ///
    /// Parameters
    /// ----------
    /// start : array_like, (4, 4)
    /// centre, axis : array_like, (3,)
    ///     A point of the line (m) and its direction, world axes.
    /// angle : float
    ///     How far, right-handed; more than one turn is allowed (rad).
    ///
    /// Returns
    /// -------
    /// CartesianPath
    ///
    /// Raises
    /// ------
    /// NotFiniteError, InvalidOptionError
    #[staticmethod]
    #[pyo3(signature = (start, centre, axis, angle))]
    fn turn(
        start: Numbers<'_>,
        centre: Numbers<'_>,
        axis: Numbers<'_>,
        angle: f64,
    ) -> Result<Self> {
        let turn = Turn {
            centre: Vec3::from_array(centre.entries("centre")?),
            axis: Vec3::from_array(axis.entries("axis")?),
            angle,
        };
        Ok(Self { inner: CartesianPath::turn(start.pose("start")?, turn)? })
    }

    #[getter]
    fn length(&self) -> f64 {
        self.inner.length()
    }

    #[getter]
    fn angle(&self) -> f64 {
        self.inner.angle()
    }

    #[getter]
    fn radius(&self) -> f64 {
        self.inner.radius()
    }

    /// The pose at s.
    ///
    /// Parameters
    /// ----------
    /// s : array_like, () or (N,)
    ///     Clamped to [0, 1].
    ///
    /// Returns
    /// -------
    /// ndarray, (4, 4) or (N, 4, 4)
    #[pyo3(signature = (s))]
    fn pose<'py>(&self, py: Python<'py>, s: Numbers<'py>) -> Result<Array<'py>> {
        let (s, count) = times("s", &s)?;
        arrays::written(py, count, &[4, 4], |out| {
            for (s, out) in s.iter().zip(out.chunks_exact_mut(16)) {
                arrays::put_pose(self.inner.pose(*s), out);
            }
        })
    }

    /// How far a measured pose is off this path.
    ///
    /// Parameters
    /// ----------
    /// pose : array_like, (4, 4)
    ///
    /// Returns
    /// -------
    /// (float, float, float)
    ///     Distance to the path (m), angle to its orientation there (rad), and the nearest s.
    #[pyo3(signature = (pose))]
    fn deviation(&self, pose: Numbers<'_>) -> Result<(f64, f64, f64)> {
        let d = self.inner.deviation(pose.pose("pose")?);
        Ok((d.position, d.orientation, d.s))
    }

    fn __repr__(&self) -> String {
        format!(
            "<CartesianPath of {} m, {} rad>",
            table::number(self.inner.length()),
            table::number(self.inner.angle())
        )
    }
}

/// A frame moving along a path by the fastest time law that keeps every bound.
///
/// Parameters
/// ----------
/// path : CartesianPath
/// speed, acceleration, jerk : float or (float, float), optional
///     Bounds of translation and rotation [m/s, rad/s; /s^2; /s^3]. Defaults: (0.25, 1), (1, 4),
///     no bound on the jerk: a trapezoidal velocity.
/// duration : float, optional
///     Slows the move down to end then (s).
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
///     For bounds that are NaN, zero or negative, a duration that is too short.
///
/// Notes
/// -----
/// Drive a servo along it with `Servo.drive(q, move)`.
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
        path: PyRef<'_, PyCartesianPath>,
        speed: Option<Numbers<'_>>,
        acceleration: Option<Numbers<'_>>,
        jerk: Option<Numbers<'_>>,
        duration: Option<f64>,
    ) -> Result<Self> {
        let of = |name, given: &Option<Numbers<'_>>, default: (f64, f64)| match given {
            None => Ok(default),
            Some(given) => pair(name, given, default.1),
        };
        let v = of("speed", &speed, SPEED)?;
        let a = of("acceleration", &acceleration, ACCELERATION)?;
        let j = of("jerk", &jerk, (f64::INFINITY, f64::INFINITY))?;
        let bounds = CartesianBounds {
            linear: Bounds { velocity: v.0, acceleration: a.0, jerk: j.0 },
            angular: Bounds { velocity: v.1, acceleration: a.1, jerk: j.1 },
        };
        let mut inner = CartesianMove::new(path.inner, bounds)?;
        if let Some(duration) = duration {
            inner = inner.stretched_to(duration)?;
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

    /// Pose and twist at a time; at rest before 0 and after the duration.
    ///
    /// Parameters
    /// ----------
    /// t : array_like, () or (N,)
    ///     (s).
    ///
    /// Returns
    /// -------
    /// (ndarray, ndarray)
    ///     Poses, (4, 4) or (N, 4, 4), and twists, (6,) or (N, 6): linear first, world axes, at
    ///     the moving origin.
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

    /// Target and feed-forward of a servo of period `dt` at time `t`, for `Servo.step`.
    ///
    /// Parameters
    /// ----------
    /// t, dt : float
    ///     (s).
    ///
    /// Returns
    /// -------
    /// (ndarray, ndarray)
    ///     The pose now, (4, 4), and the constant twist that leads to that of the next step, (6,).
    #[pyo3(signature = (t, dt))]
    fn target<'py>(&self, py: Python<'py>, t: f64, dt: f64) -> Result<(Array<'py>, Array<'py>)> {
        let target = self.inner.target(t, dt);
        Ok((arrays::pose(py, target.pose)?, arrays::vector(py, &target.feed_forward.to_array())))
    }

    fn __repr__(&self) -> String {
        format!("<CartesianMove of {} s>", table::number(self.duration()))
    }
}

/// All joints moving straight to another configuration, starting and stopping together.
///
/// Parameters
/// ----------
/// mechanism : Mechanism
///     Its velocity and acceleration limits are kept, and its position limits.
/// q, to : array_like, (n,)
///     From and to [rad or m].
/// speed, acceleration, jerk : float or (float, float), optional
///     Of joints without limits of their own: those that slide and those that turn [m/s, rad/s;
///     /s^2; /s^3]. Defaults: (0.25, 1), (1, 4), no bound on the jerk, which is that of all.
/// duration : float, optional
///     Slows the move down to end then (s).
///
/// Attributes
/// ----------
/// duration : float
///     (s)
///
/// Raises
/// ------
/// DimensionError, NotFiniteError
/// InvalidOptionError
///     For ends outside limits, and spherical or free joints that have no straight way.
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
        mechanism: PyRef<'_, PyMechanism>,
        q: Numbers<'_>,
        to: Numbers<'_>,
        speed: Option<Numbers<'_>>,
        acceleration: Option<Numbers<'_>>,
        jerk: Option<Numbers<'_>>,
        duration: Option<f64>,
    ) -> Result<Self> {
        let of = |name, given: &Option<Numbers<'_>>, default: (f64, f64)| match given {
            None => Ok(default),
            Some(given) => pair(name, given, f64::NAN),
        };
        let v = of("speed", &speed, SPEED)?;
        let a = of("acceleration", &acceleration, ACCELERATION)?;
        let j = of("jerk", &jerk, (f64::INFINITY, f64::INFINITY))?;
        let defaults = JointDefaults {
            length: Bounds { velocity: v.0, acceleration: a.0, jerk: j.0 },
            angle: Bounds { velocity: v.1, acceleration: a.1, jerk: j.1 },
        };
        let (q, to) = (q.vector("q")?, to.vector("to")?);
        let mut inner = JointMove::within_limits(&mechanism.inner, q, to, &defaults)?;
        if let Some(duration) = duration {
            inner = inner.stretched_to(duration)?;
        }
        Ok(Self { inner })
    }

    #[getter]
    fn duration(&self) -> f64 {
        self.inner.law().duration()
    }

    /// Positions and velocities at a time; at rest before 0 and after the duration.
    ///
    /// Parameters
    /// ----------
    /// t : array_like, () or (N,)
    ///     (s).
    ///
    /// Returns
    /// -------
    /// (ndarray, ndarray)
    ///     q and qd, (n,) or (N, n).
    #[pyo3(signature = (t))]
    fn at<'py>(&self, py: Python<'py>, t: Numbers<'py>) -> Result<(Array<'py>, Array<'py>)> {
        let (t, count) = times("t", &t)?;
        let n = self.inner.path().dof();
        let mut velocities = vec![0.0; n * t.len()];
        let mut result = Ok(());
        let q = arrays::written(py, count, &[n], |out| {
            let rows = out.chunks_exact_mut(n.max(1)).zip(velocities.chunks_exact_mut(n.max(1)));
            for (t, (positions, velocities)) in t.iter().zip(rows) {
                let sample = JointSample { positions, velocities };
                result = self.inner.sample_into(*t, sample).map(|_| ());
            }
        })?;
        result?;
        let qd = arrays::written(py, count, &[n], |out| out.copy_from_slice(&velocities))?;
        Ok((q, qd))
    }

    fn __repr__(&self) -> String {
        format!("<JointMove of {} s>", table::number(self.duration()))
    }
}

/// A motion of one coordinate from rest at 0 to rest at a distance, as fast as bounds allow.
///
/// Parameters
/// ----------
/// distance : float
///     Of either sign, in the unit u of the coordinate.
/// velocity, acceleration, jerk : float
///     Bounds [u/s, u/s^2, u/s^3]; an infinite jerk gives a trapezoidal velocity.
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
    #[pyo3(signature = (distance, velocity, acceleration, jerk = f64::INFINITY, duration = None))]
    #[pyo3(text_signature = "(distance, velocity, acceleration, jerk=float('inf'), duration=None)")]
    fn new(
        distance: f64,
        velocity: f64,
        acceleration: f64,
        jerk: f64,
        duration: Option<f64>,
    ) -> Result<Self> {
        let mut inner = TimeLaw::new(distance, Bounds { velocity, acceleration, jerk })?;
        if let Some(duration) = duration {
            inner = inner.stretched_to(duration)?;
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
