//! The class `MotionTask`, and one class for each objective.

use std::sync::Arc;

use cylindroid::control::{MotionTask, PoseTolerance, Target};
use cylindroid::{Mechanism, Vec3};
use pyo3::prelude::*;

use super::custom::Raised;
use super::description::{Description, Named, moving_target};
use crate::arrays::Numbers;
use crate::coordinates::Coordinates;
use crate::error::{Failure, Result, argument};

/// A task of a `TaskServo` or a goal of `Mechanism.ik`: `FrameTask`, `RelativeFrameTask`, `CenterOfMassTask`, `GazeTask`,
/// `PostureTask`, `JointVelocitiesTask`, `ManipulabilityTask`, `LimitAvoidanceTask` or `CustomTask`.
///
/// Attributes
/// ----------
/// name : str
///     The name in reports and targets.
/// level : int
///     Priority: 0 first. Postures, joint velocities and gradients are of the lowest level in any
///     case.
/// weight : float
///     Weight among the tasks of its level.
/// gain : float
///     Proportional gain [1/s].
/// tolerance_position, tolerance_orientation : float
///     Errors at which it counts as reached (m, rad).
#[pyclass(frozen, subclass, name = "MotionTask", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyMotionTask {
    description: Description,
    #[pyo3(get)]
    name: String,
    #[pyo3(get)]
    level: usize,
    #[pyo3(get)]
    weight: f64,
    #[pyo3(get)]
    gain: f64,
    #[pyo3(get)]
    tolerance_position: f64,
    #[pyo3(get)]
    tolerance_orientation: f64,
}

#[pymethods]
impl PyMotionTask {
    fn __repr__(&self) -> String {
        let class = self.description.class();
        match self.description {
            Description::Posture { .. }
            | Description::JointVelocities { .. }
            | Description::Manipulability { .. }
            | Description::LimitAvoidance { .. } => {
                format!("<{class} '{}'>", self.name)
            }
            _ => format!("<{class} '{}', level {}>", self.name, self.level),
        }
    }
}

/// Options that all tasks have.
#[derive(Debug, Clone, Default)]
pub(super) struct Common {
    pub(super) name: Option<String>,
    pub(super) level: usize,
    pub(super) weight: Option<f64>,
    pub(super) gain: Option<f64>,
    pub(super) tolerance: (Option<f64>, Option<f64>),
}

impl PyMotionTask {
    pub(super) fn new(description: Description, usual_name: &str, common: Common) -> Self {
        // Defaults are those of the library; the objective is not looked at.
        let usual = MotionTask::new(
            usual_name,
            cylindroid::control::TaskObjective::Posture { q: Vec::new() },
        );
        let PoseTolerance { position, orientation } = usual.tolerance;
        Self {
            description,
            name: common.name.unwrap_or(usual.name),
            level: common.level,
            weight: common.weight.unwrap_or(usual.weight),
            gain: common.gain.unwrap_or(usual.gain),
            tolerance_position: common.tolerance.0.unwrap_or(position),
            tolerance_orientation: common.tolerance.1.unwrap_or(orientation),
        }
    }

    /// The task for a mechanism; `raised` receives exceptions of its function.
    pub(super) fn of(&self, robot: &Mechanism, raised: &Raised) -> Result<MotionTask> {
        let objective = self.description.objective(robot, &self.name, raised)?;
        Ok(MotionTask {
            level: self.level,
            weight: self.weight,
            gain: self.gain,
            tolerance: PoseTolerance {
                position: self.tolerance_position,
                orientation: self.tolerance_orientation,
            },
            ..MotionTask::new(&self.name, objective)
        })
    }
}

/// A frame at a pose in the world.
///
/// Parameters
/// ----------
/// frame : str
///     The frame.
/// target : array_like, (4, 4), or tuple
///     The desired `world_from_tool` (m); with the twist of a moving target, linear first, world
///     axes, at the tool [m/s, rad/s], as the tuple `(pose, twist)`.
/// tool : array_like, (4, 4), optional
///     `frame_from_tool`, a tool point fixed to the frame.
/// components : str
///     'pose', 'position', 'orientation', 'pointing' (position and direction of the tool's z axis),
///     or components like 'x,y,rz'.
/// axes : str, optional
///     'world' or 'local', the axes of the components.
/// name : str, optional
///     The name in reports. Default: the frame.
/// level : int
///     Priority: 0 first. A level never disturbs one before it.
/// weight : float, optional
///     Weight among the tasks of its level. Default: 1.
/// gain : float, optional
///     Proportional gain [1/s]; gain * dt must be below 2. With 0 the task is the twist of its target
///     alone. Default: 5.
/// tolerance_position, tolerance_orientation : float, optional
///     Errors at which it counts as reached (m, rad). Default: 1e-6.
///
/// Raises
/// ------
/// InvalidOptionError
///     For a target or a tool that is not a pose.
#[pyclass(frozen, extends = PyMotionTask, name = "FrameTask", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyFrameTask;

#[pymethods]
impl PyFrameTask {
    #[new]
    #[pyo3(signature = (frame, target, *, tool = None, components = "pose", axes = None,
        name = None, level = 0, weight = None, gain = None, tolerance_position = None,
        tolerance_orientation = None))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn new(
        #[pyo3(from_py_with = argument)] frame: &str,
        target: Bound<'_, PyAny>,
        tool: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] components: &str,
        #[pyo3(from_py_with = argument)] axes: Option<String>,
        #[pyo3(from_py_with = argument)] name: Option<String>,
        #[pyo3(from_py_with = argument)] level: usize,
        #[pyo3(from_py_with = argument)] weight: Option<f64>,
        #[pyo3(from_py_with = argument)] gain: Option<f64>,
        #[pyo3(from_py_with = argument)] tolerance_position: Option<f64>,
        #[pyo3(from_py_with = argument)] tolerance_orientation: Option<f64>,
    ) -> Result<PyClassInitializer<Self>> {
        let target: Target = moving_target("target", &target)?;
        let description = Description::Frame {
            frame: Named::new("tool", frame, tool.as_ref())?,
            components: components.to_owned(),
            axes,
            target,
        };
        let tolerance = (tolerance_position, tolerance_orientation);
        let common = Common { name, level, weight, gain, tolerance };
        let base = PyMotionTask::new(description, frame, common);
        Ok(PyClassInitializer::from(base).add_subclass(Self))
    }
}

/// A frame at a pose relative to another frame: two hands on one object, a tool beside a tool.
///
/// Parameters
/// ----------
/// frame : str
///     The frame.
/// reference : str
///     The frame from which its pose is seen.
/// target : array_like, (4, 4)
///     The desired `reference_from_tool` (m).
/// tool, reference_tool : array_like, (4, 4), optional
///     Tool points fixed to the two frames.
/// components : str
///     'pose', 'position', 'orientation', 'pointing' or components like 'x,y,rz', in the axes of the
///     reference.
/// name : str, optional
///     The name in reports. Default: '<frame> from <reference>'.
/// level, weight, gain, tolerance_position, tolerance_orientation : optional
///     As for `FrameTask`.
///
/// Raises
/// ------
/// InvalidOptionError
///     For a target or a tool that is not a pose.
#[pyclass(frozen, extends = PyMotionTask, name = "RelativeFrameTask", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyRelativeFrameTask;

#[pymethods]
impl PyRelativeFrameTask {
    #[new]
    #[pyo3(signature = (frame, reference, target, *, tool = None, reference_tool = None,
        components = "pose", name = None, level = 0, weight = None, gain = None,
        tolerance_position = None, tolerance_orientation = None))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn new(
        #[pyo3(from_py_with = argument)] frame: &str,
        #[pyo3(from_py_with = argument)] reference: &str,
        target: Numbers<'_>,
        tool: Option<Numbers<'_>>,
        reference_tool: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] components: &str,
        #[pyo3(from_py_with = argument)] name: Option<String>,
        #[pyo3(from_py_with = argument)] level: usize,
        #[pyo3(from_py_with = argument)] weight: Option<f64>,
        #[pyo3(from_py_with = argument)] gain: Option<f64>,
        #[pyo3(from_py_with = argument)] tolerance_position: Option<f64>,
        #[pyo3(from_py_with = argument)] tolerance_orientation: Option<f64>,
    ) -> Result<PyClassInitializer<Self>> {
        let description = Description::RelativeFrame {
            frame: Named::new("tool", frame, tool.as_ref())?,
            reference: Named::new("reference_tool", reference, reference_tool.as_ref())?,
            components: components.to_owned(),
            target: target.pose("target")?,
        };
        let tolerance = (tolerance_position, tolerance_orientation);
        let common = Common { name, level, weight, gain, tolerance };
        let base = PyMotionTask::new(description, &format!("{frame} from {reference}"), common);
        Ok(PyClassInitializer::from(base).add_subclass(Self))
    }
}

/// The centre of mass of the moving links at a point of the world.
///
/// Parameters
/// ----------
/// target : array_like, (3,)
///     The point (m).
/// velocity : array_like, (3,), optional
///     The velocity of a moving point [m/s], a feed-forward; with a gain of 0 the task is this velocity
///     alone.
/// axes : str
///     The world axes that count: 'xyz', 'xy', ...
/// name : str, optional
///     The name in reports. Default: 'center_of_mass'.
/// level, weight, gain, tolerance_position : optional
///     As for `FrameTask`.
///
/// Raises
/// ------
/// InvalidOptionError
///     For other axes.
/// DimensionError
#[pyclass(frozen, extends = PyMotionTask, name = "CenterOfMassTask", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyCenterOfMassTask;

#[pymethods]
impl PyCenterOfMassTask {
    #[new]
    #[pyo3(signature = (target, *, velocity = None, axes = "xyz", name = None, level = 0,
        weight = None, gain = None, tolerance_position = None))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn new(
        target: Numbers<'_>,
        velocity: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] axes: &str,
        #[pyo3(from_py_with = argument)] name: Option<String>,
        #[pyo3(from_py_with = argument)] level: usize,
        #[pyo3(from_py_with = argument)] weight: Option<f64>,
        #[pyo3(from_py_with = argument)] gain: Option<f64>,
        #[pyo3(from_py_with = argument)] tolerance_position: Option<f64>,
    ) -> Result<PyClassInitializer<Self>> {
        let target = Vec3::from_array(target.entries("target")?);
        let known = ['x', 'y', 'z'];
        if axes.is_empty() || axes.chars().any(|axis| !known.contains(&axis)) {
            return Err(Failure::option("axes", axes, "give some of 'xyz'"));
        }
        let velocity = velocity.map_or(Ok([0.0; 3]), |velocity| velocity.entries("velocity"))?;
        let (axes, velocity) = (known.map(|axis| axes.contains(axis)), Vec3::from_array(velocity));
        let description = Description::CenterOfMass { axes, target, velocity };
        let tolerance = (tolerance_position, None);
        let common = Common { name, level, weight, gain, tolerance };
        let base = PyMotionTask::new(description, "center_of_mass", common);
        Ok(PyClassInitializer::from(base).add_subclass(Self))
    }
}

/// The z axis of a frame towards a point of the world.
///
/// Parameters
/// ----------
/// frame : str
///     The frame that looks along its z axis.
/// point : array_like, (3,)
///     The point (m).
/// tool : array_like, (4, 4), optional
///     `frame_from_tool`, if a tool fixed to the frame looks along its z axis.
/// name : str, optional
///     The name in reports. Default: 'gaze'.
/// level, weight, gain, tolerance_orientation : optional
///     As for `FrameTask`.
///
/// Raises
/// ------
/// DimensionError
/// InvalidOptionError
///     For a tool that is not a pose.
#[pyclass(frozen, extends = PyMotionTask, name = "GazeTask", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyGazeTask;

#[pymethods]
impl PyGazeTask {
    #[new]
    #[pyo3(signature = (frame, point, *, tool = None, name = None, level = 0, weight = None,
        gain = None, tolerance_orientation = None))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn new(
        #[pyo3(from_py_with = argument)] frame: &str,
        point: Numbers<'_>,
        tool: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] name: Option<String>,
        #[pyo3(from_py_with = argument)] level: usize,
        #[pyo3(from_py_with = argument)] weight: Option<f64>,
        #[pyo3(from_py_with = argument)] gain: Option<f64>,
        #[pyo3(from_py_with = argument)] tolerance_orientation: Option<f64>,
    ) -> Result<PyClassInitializer<Self>> {
        let description = Description::Gaze {
            frame: Named::new("tool", frame, tool.as_ref())?,
            point: Vec3::from_array(point.entries("point")?),
        };
        let tolerance = (None, tolerance_orientation);
        let common = Common { name, level, weight, gain, tolerance };
        let base = PyMotionTask::new(description, "gaze", common);
        Ok(PyClassInitializer::from(base).add_subclass(Self))
    }
}

/// A preferred configuration, on what all other tasks leave free.
///
/// Parameters
/// ----------
/// q : array_like, (n,)
///     The configuration [rad or m].
/// name : str, optional
///     The name in reports. Default: 'posture'.
/// weight : float, optional
///     Weight among postures and joint velocities, of which the mean counts. Default: 1.
/// gain : float, optional
///     Proportional gain [1/s]. Default: 5.
/// tolerance_position, tolerance_orientation : float, optional
///     Norms of the errors of slides and hinges at which it counts as reached (m, rad). Default: 1e-6.
///
/// Raises
/// ------
/// InvalidOptionError
///     For an array with several axes.
#[pyclass(frozen, extends = PyMotionTask, name = "PostureTask", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyPostureTask;

#[pymethods]
impl PyPostureTask {
    #[new]
    #[pyo3(signature = (q, *, name = None, weight = None, gain = None, tolerance_position = None,
        tolerance_orientation = None))]
    fn new(
        q: Coordinates<'_>,
        #[pyo3(from_py_with = argument)] name: Option<String>,
        #[pyo3(from_py_with = argument)] weight: Option<f64>,
        #[pyo3(from_py_with = argument)] gain: Option<f64>,
        #[pyo3(from_py_with = argument)] tolerance_position: Option<f64>,
        #[pyo3(from_py_with = argument)] tolerance_orientation: Option<f64>,
    ) -> Result<PyClassInitializer<Self>> {
        let description = Description::Posture { q: q.places("q")?.to_vec() };
        let tolerance = (tolerance_position, tolerance_orientation);
        let common = Common { name, weight, gain, tolerance, ..Common::default() };
        let base = PyMotionTask::new(description, "posture", common);
        Ok(PyClassInitializer::from(base).add_subclass(Self))
    }
}

/// Desired velocities of all joints, on what all other tasks leave free.
///
/// Parameters
/// ----------
/// velocities : array_like, (n,)
///     The velocities [rad/s or m/s].
/// name : str, optional
///     The name in reports. Default: 'joint_velocities'.
/// weight : float, optional
///     Weight among postures and joint velocities, of which the mean counts. Default: 1.
/// tolerance_position, tolerance_orientation : float, optional
///     Norms of the velocities that are not realised at which it counts as reached (m/s, rad/s).
///     Default: 1e-6.
///
/// Raises
/// ------
/// InvalidOptionError
///     For an array with several axes.
#[pyclass(frozen, extends = PyMotionTask, name = "JointVelocitiesTask", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyJointVelocitiesTask;

#[pymethods]
impl PyJointVelocitiesTask {
    #[new]
    #[pyo3(signature = (velocities, *, name = None, weight = None, tolerance_position = None,
        tolerance_orientation = None))]
    fn new(
        velocities: Numbers<'_>,
        #[pyo3(from_py_with = argument)] name: Option<String>,
        #[pyo3(from_py_with = argument)] weight: Option<f64>,
        #[pyo3(from_py_with = argument)] tolerance_position: Option<f64>,
        #[pyo3(from_py_with = argument)] tolerance_orientation: Option<f64>,
    ) -> Result<PyClassInitializer<Self>> {
        let velocities = velocities.vector("velocities")?.to_vec();
        let description = Description::JointVelocities { velocities };
        let tolerance = (tolerance_position, tolerance_orientation);
        let common = Common { name, weight, tolerance, ..Common::default() };
        let base = PyMotionTask::new(description, "joint_velocities", common);
        Ok(PyClassInitializer::from(base).add_subclass(Self))
    }
}

/// A task of one's own: an error and its Jacobian from one call.
///
/// Parameters
/// ----------
/// function : callable
///     `function(q)` with q (n,) returns the tuple `(error, jacobian)`, (rows,) and (rows, n), such
///     that joint velocities qd change the error by `-jacobian @ qd`: the servo makes
///     `jacobian @ qd = gain * error`. Its exceptions reach the caller of `TaskServo.step`.
/// rows : int
///     Number of rows.
/// name : str, optional
///     The name in reports. Default: that of the function.
/// level, weight, gain, tolerance_orientation : optional
///     As for `FrameTask`; the tolerance is the norm of the error at which it counts as reached.
///
/// Raises
/// ------
/// ArgumentTypeError
///     For a function that cannot be called.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> import numpy as np
/// >>> robot = cy.load("panda")
/// >>> elbow = cy.CustomTask(lambda q: ([-1.5 - q[3]], np.eye(7)[3:4]), rows=1, name="elbow")
/// >>> servo, q = cy.TaskServo(robot, [elbow]), robot.home
/// >>> for _ in range(4000):
/// ...     qd = servo.step(q)
/// ...     q = servo.advance(q)
/// >>> servo.reports["elbow"].status, bool(abs(q[3] + 1.5) < 1e-6)
/// ('reached', True)
#[pyclass(frozen, extends = PyMotionTask, name = "CustomTask", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyCustomTask;

#[pymethods]
impl PyCustomTask {
    #[new]
    #[pyo3(signature = (function, rows, *, name = None, level = 0, weight = None, gain = None,
        tolerance_orientation = None))]
    fn new(
        function: Bound<'_, PyAny>,
        #[pyo3(from_py_with = argument)] rows: usize,
        #[pyo3(from_py_with = argument)] name: Option<String>,
        #[pyo3(from_py_with = argument)] level: usize,
        #[pyo3(from_py_with = argument)] weight: Option<f64>,
        #[pyo3(from_py_with = argument)] gain: Option<f64>,
        #[pyo3(from_py_with = argument)] tolerance_orientation: Option<f64>,
    ) -> Result<PyClassInitializer<Self>> {
        if !function.is_callable() {
            let kind = function.get_type();
            return Err(Failure::kind(format!("function: {kind} cannot be called")));
        }
        let own = function.getattr("__name__").and_then(|name| name.extract::<String>());
        let usual = own.unwrap_or_else(|_| "custom".to_owned());
        let description = Description::Custom { function: Arc::new(function.unbind()), rows };
        let tolerance = (None, tolerance_orientation);
        let common = Common { name, level, weight, gain, tolerance };
        let base = PyMotionTask::new(description, &usual, common);
        Ok(PyClassInitializer::from(base).add_subclass(Self))
    }
}
