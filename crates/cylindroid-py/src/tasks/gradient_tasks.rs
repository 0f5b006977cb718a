//! The classes `ManipulabilityTask` and `LimitAvoidanceTask`: gradients of the lowest level.

use pyo3::prelude::*;

use super::PyMotionTask;
use super::description::{Description, Named};
use super::motion_task::Common;
use crate::arrays::Numbers;
use crate::error::{Result, argument};

/// Towards larger manipulability (Yoshikawa) of a frame, on what all other tasks leave free. Trees
/// only.
///
/// Parameters
/// ----------
/// frame : str
///     The frame.
/// components : str
///     The components of its Jacobian, as for `FrameTask`.
/// tool : array_like, (4, 4), optional
///     `frame_from_tool`, a tool point fixed to the frame.
/// name : str, optional
///     The name in reports. Default: 'manipulability'.
/// weight : float, optional
///     Weight among the tasks of the lowest level, of which the mean counts. Default: 1.
/// gain : float
///     Velocity for each unit of the gradient [rad/s].
///
/// Raises
/// ------
/// InvalidOptionError
///     For a tool that is not a pose.
#[pyclass(frozen, extends = PyMotionTask, name = "ManipulabilityTask", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyManipulabilityTask;

#[pymethods]
impl PyManipulabilityTask {
    #[new]
    #[pyo3(signature = (frame, *, components = "pose", tool = None, name = None, weight = None,
        gain = 1.0))]
    fn new(
        #[pyo3(from_py_with = argument)] frame: &str,
        #[pyo3(from_py_with = argument)] components: &str,
        tool: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] name: Option<String>,
        #[pyo3(from_py_with = argument)] weight: Option<f64>,
        #[pyo3(from_py_with = argument)] gain: f64,
    ) -> Result<PyClassInitializer<Self>> {
        let frame = Named::new("tool", frame, tool.as_ref())?;
        let description = Description::Manipulability { frame, components: components.to_owned() };
        let common = Common { name, weight, gain: Some(gain), ..Common::default() };
        let base = PyMotionTask::new(description, "manipulability", common);
        Ok(PyClassInitializer::from(base).add_subclass(Self))
    }
}

/// Away from joint limits that are near, on what all other tasks leave free.
///
/// Parameters
/// ----------
/// margin : float
///     Distance at which it sets in, as a share of the range.
/// name : str, optional
///     The name in reports. Default: 'limit_avoidance'.
/// weight : float, optional
///     Weight among the tasks of the lowest level, of which the mean counts. Default: 1.
/// gain : float
///     Velocity at the limit [rad/s or m/s].
#[pyclass(frozen, extends = PyMotionTask, name = "LimitAvoidanceTask", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyLimitAvoidanceTask;

#[pymethods]
impl PyLimitAvoidanceTask {
    #[new]
    #[pyo3(signature = (*, margin = 0.1, name = None, weight = None, gain = 1.0))]
    fn new(
        #[pyo3(from_py_with = argument)] margin: f64,
        #[pyo3(from_py_with = argument)] name: Option<String>,
        #[pyo3(from_py_with = argument)] weight: Option<f64>,
        #[pyo3(from_py_with = argument)] gain: f64,
    ) -> PyClassInitializer<Self> {
        let description = Description::LimitAvoidance { margin };
        let common = Common { name, weight, gain: Some(gain), ..Common::default() };
        let base = PyMotionTask::new(description, "limit_avoidance", common);
        PyClassInitializer::from(base).add_subclass(Self)
    }
}
