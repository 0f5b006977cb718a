//! The class `CartesianPath`: lines, arcs and rotations of a frame.

use cylindroid::Vec3;
use cylindroid::control::{AxisRotation, CartesianPath};
use pyo3::prelude::*;

use super::times;
use crate::arrays::{self, Array, Numbers};
use crate::error::{Result, argument};
use crate::table;

/// A Cartesian path of a frame, over s from 0 to 1; created by `line`, `circle` or `rotation`.
///
/// Attributes
/// ----------
/// length : float
///     Length of the path of the origin (m).
/// angle : float
///     Total angle of rotation (rad).
/// radius : float
///     Radius of the arc (m); infinite for a line.
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
    pub(super) inner: CartesianPath,
}

#[pymethods]
impl PyCartesianPath {
    /// A straight line between two poses, with a rotation about a constant axis by at most pi.
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
    ///     For matrices that are not poses.
    #[staticmethod]
    #[pyo3(signature = (start, end))]
    fn line(start: Numbers<'_>, end: Numbers<'_>) -> Result<Self> {
        Ok(Self { inner: CartesianPath::line(start.pose("start")?, end.pose("end")?)? })
    }

    /// A circular arc between two poses through an intermediate point.
    ///
    /// Parameters
    /// ----------
    /// start : array_like, (4, 4)
    ///     `world_from_tool` (m).
    /// via : array_like, (3,)
    ///     A point on the arc, world axes (m).
    /// end : array_like, (4, 4)
    ///     `world_from_tool` (m).
    ///
    /// Returns
    /// -------
    /// CartesianPath
    ///
    /// Raises
    /// ------
    /// NotFiniteError, InvalidOptionError
    ///     For matrices that are not poses, and for three collinear points.
    #[staticmethod]
    #[pyo3(signature = (start, via, end))]
    fn circle(start: Numbers<'_>, via: Numbers<'_>, end: Numbers<'_>) -> Result<Self> {
        let via = Vec3::from_array(via.entries("via")?);
        Ok(Self { inner: CartesianPath::circle(start.pose("start")?, via, end.pose("end")?)? })
    }

    /// A rotation of position and orientation about a fixed axis.
    ///
    /// Parameters
    /// ----------
    /// start : array_like, (4, 4)
    ///     `world_from_tool` (m).
    /// centre, axis : array_like, (3,)
    ///     A point of the axis (m) and its direction, world axes.
    /// angle : float
    ///     Angle, right-handed; more than one revolution is allowed (rad).
    ///
    /// Returns
    /// -------
    /// CartesianPath
    ///
    /// Raises
    /// ------
    /// NotFiniteError, InvalidOptionError
    ///     For a matrix that is not a pose, and for a zero axis.
    #[staticmethod]
    #[pyo3(signature = (start, centre, axis, angle))]
    fn rotation(
        start: Numbers<'_>,
        centre: Numbers<'_>,
        axis: Numbers<'_>,
        #[pyo3(from_py_with = argument)] angle: f64,
    ) -> Result<Self> {
        let rotation = AxisRotation {
            centre: Vec3::from_array(centre.entries("centre")?),
            axis: Vec3::from_array(axis.entries("axis")?),
            angle,
        };
        Ok(Self { inner: CartesianPath::rotation(start.pose("start")?, rotation)? })
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

    /// The pose at the path coordinate s.
    ///
    /// Parameters
    /// ----------
    /// s : array_like, () or (N,)
    ///     Path coordinate, clamped to [0, 1].
    ///
    /// Returns
    /// -------
    /// ndarray, (4, 4) or (N, 4, 4)
    ///     `world_from_tool` (m).
    ///
    /// Raises
    /// ------
    /// NotFiniteError
    ///     For a NaN coordinate.
    #[pyo3(signature = (s))]
    fn pose<'py>(&self, py: Python<'py>, s: Numbers<'py>) -> Result<Array<'py>> {
        let (s, count) = times("s", &s)?;
        arrays::written(py, count, &[4, 4], |out| {
            for (s, out) in s.iter().zip(out.chunks_exact_mut(16)) {
                arrays::put_pose(self.inner.pose(*s), out);
            }
        })
    }

    /// Deviation of a measured pose from this path.
    ///
    /// Parameters
    /// ----------
    /// pose : array_like, (4, 4)
    ///     `world_from_tool` (m).
    ///
    /// Returns
    /// -------
    /// (float, float, float)
    ///     Distance to the nearest point of the path (m), angle to the orientation there (rad), and
    ///     the path coordinate s of that point.
    ///
    /// Raises
    /// ------
    /// NotFiniteError, InvalidOptionError
    ///     For a matrix that is not a pose.
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
