//! The class `HalfSpace`: a half-space that a tool point does not leave.

use cylindroid::control::HalfSpace;
use cylindroid::{Mechanism, Pose, Vec3};
use pyo3::prelude::*;

use super::description::Named;
use crate::arrays::Numbers;
use crate::error::{Failure, Result, argument};

/// A half-space of the world that a tool point of a `TaskServo` or a solution of `Mechanism.ik` does
/// not leave.
///
/// Parameters
/// ----------
/// frame : str
///     The frame.
/// point : array_like, (3,)
///     A point of the bounding plane [m].
/// normal : array_like, (3,)
///     A normal of that plane, of any length, towards the inside.
/// tool : array_like, (4, 4), optional
///     `frame_from_tool`, a tool point fixed to the frame.
/// name : str, optional
///     The name in reports. Default: 'half-space of ' and the frame.
///
/// Attributes
/// ----------
/// name : str
/// frame : str
/// point, normal : tuple of float
///
/// Raises
/// ------
/// DimensionError, InvalidOptionError
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> walls = cy.HalfSpace.inside_box("hand_tcp", center=[0.5, 0, 0.4], size=[0.4, 0.6, 0.5])
/// >>> [wall.name for wall in walls[:2]]
/// ['box of hand_tcp -x', 'box of hand_tcp +x']
#[pyclass(frozen, name = "HalfSpace", module = "cylindroid")]
#[derive(Debug, Clone)]
pub(crate) struct PyHalfSpace {
    #[pyo3(get)]
    name: String,
    #[pyo3(get)]
    frame: String,
    frame_from_tool: Pose,
    point: Vec3,
    normal: Vec3,
}

impl PyHalfSpace {
    /// The half-space for a mechanism.
    pub(super) fn of(&self, robot: &Mechanism) -> Result<HalfSpace> {
        let named = Named { frame: self.frame.clone(), frame_from_tool: self.frame_from_tool };
        let end_effector = named.of(robot)?;
        Ok(HalfSpace {
            name: self.name.clone(),
            end_effector,
            point: self.point,
            normal: self.normal,
        })
    }
}

#[pymethods]
impl PyHalfSpace {
    #[new]
    #[pyo3(signature = (frame, point, normal, *, tool = None, name = None))]
    fn new(
        #[pyo3(from_py_with = argument)] frame: &str,
        point: Numbers<'_>,
        normal: Numbers<'_>,
        tool: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] name: Option<String>,
    ) -> Result<Self> {
        let named = Named::new("tool", frame, tool.as_ref())?;
        let normal = Vec3::from_array(normal.entries("normal")?);
        if !(normal.norm() > 0.0) {
            let reason = "give a direction towards the inside";
            return Err(Failure::option("normal", "0", reason));
        }
        Ok(Self {
            name: name.unwrap_or_else(|| format!("half-space of {frame}")),
            frame: named.frame,
            frame_from_tool: named.frame_from_tool,
            point: Vec3::from_array(point.entries("point")?),
            normal,
        })
    }

    /// The six half-spaces of a box in which a tool point stays.
    ///
    /// Parameters
    /// ----------
    /// frame : str
    ///     The frame.
    /// center : array_like, (3,) or (4, 4)
    ///     The centre of the box in the world [m], or its pose.
    /// size : array_like, (3,)
    ///     Lengths of its sides [m].
    /// tool : array_like, (4, 4), optional
    ///     `frame_from_tool`, a tool point fixed to the frame.
    /// name : str, optional
    ///     The name in reports, followed by the side. Default: 'box of ' and the frame.
    ///
    /// Returns
    /// -------
    /// list of HalfSpace
    ///
    /// Raises
    /// ------
    /// DimensionError, InvalidOptionError
    #[staticmethod]
    #[pyo3(signature = (frame, center, size, *, tool = None, name = None))]
    fn inside_box(
        #[pyo3(from_py_with = argument)] frame: &str,
        center: Numbers<'_>,
        size: Numbers<'_>,
        tool: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] name: Option<String>,
    ) -> Result<Vec<Self>> {
        let named = Named::new("tool", frame, tool.as_ref())?;
        let size: [f64; 3] = size.entries("size")?;
        for side in size {
            cylindroid::Error::check_positive("size", side)?;
        }
        let name = name.unwrap_or_else(|| format!("box of {frame}"));
        let center = match center.entries::<3>("center") {
            Ok(point) => Pose::from_translation(Vec3::from_array(point)),
            Err(_) => center.pose("center")?,
        };
        let walls = HalfSpace::sides_of_box(&name, center, Vec3::from_array(size));
        Ok(walls
            .into_iter()
            .map(|(name, point, normal)| Self {
                name,
                frame: frame.to_owned(),
                frame_from_tool: named.frame_from_tool,
                point,
                normal,
            })
            .collect())
    }

    #[getter]
    fn point(&self) -> (f64, f64, f64) {
        (self.point.x, self.point.y, self.point.z)
    }

    #[getter]
    fn normal(&self) -> (f64, f64, f64) {
        (self.normal.x, self.normal.y, self.normal.z)
    }

    fn __repr__(&self) -> String {
        format!("<HalfSpace '{}'>", self.name)
    }
}
