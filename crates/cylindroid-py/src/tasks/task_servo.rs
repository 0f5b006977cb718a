//! The class `TaskServo`.

use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

use cylindroid::Mechanism;
use cylindroid::control::{CollisionAvoidance, Plant, TaskServo, TaskServoOptions};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::custom::Raised;
use super::description::retarget;
use super::{PyCollisionAvoidance, PyHalfSpace, PyMotionTask, PyTaskReport};
use crate::arrays::{self, Array, Numbers};
use crate::collision::{PyCollisionModel, PyDistances, in_use};
use crate::coordinates::Coordinates;
use crate::error::{Failure, Result, argument, entry};
use crate::mechanism::PyMechanism;
use crate::options;

/// A servo of many tasks with priorities, inside the limits of all joints and outside of collisions.
///
/// Tasks of level 0 come first; a level moves on what the levels before it leave free, and tasks of
/// one level share it by their weights. Position, velocity, acceleration and jerk limits and distances to
/// other bodies stand above all levels. A task that they stop is scaled along its direction first; its
/// direction changes only if no scale is feasible, or at once with `keep_directions=False`. For arms, hands, several arms, mobile and
/// floating bases, and closed chains, of which the actuated joints are the unknowns.
///
/// Parameters
/// ----------
/// mechanism : Mechanism
/// tasks : sequence of MotionTask
///     With different names.
/// collisions : CollisionAvoidance, optional
///     The distances to keep. Default: none.
/// half_spaces : sequence of HalfSpace, optional
///     Half-spaces that tool points do not leave, see also `HalfSpace.inside_box`. Default: none.
/// limits : dict of str to dict of str to float, optional
///     Limits of joints in place of those of the model, see `Mechanism.with_limits`.
/// dt : float, optional
///     Time between steps (s). Default: 0.001.
/// length : float, optional
///     Characteristic length that scales linear rows (m). Default: that of the mechanism, `reach`.
/// joint_weights : array_like, (n,), optional
///     Weights of joint velocities; a large one keeps a joint almost at rest. Default: 1.
/// acceleration : float, optional
///     Limit of joints that have none in the model [rad/s^2 or m/s^2]. Default: none.
/// jerk : float, optional
///     Limit of joints that have none in the model [rad/s^3 or m/s^3]. Default: none.
/// delay, time_constant, noise : float, optional
///     Of the robot, see `Servo` (s, s, rad or m). Default: 0.
/// keep_directions : bool, optional
///     Where limits and distances stop a task: True shortens its velocity as long as a share of it is
///     feasible, so that the tool stays on its line; False takes the least squares of what the tasks
///     of the level miss, which leaves smaller errors. Default: True.
/// eps : float, optional
///     Directions of a level with singular values below this share of its norm are left out.
///     Default: 1e-3.
///
/// Attributes
/// ----------
/// status : str or None
///     After the last step 'reached' if all tasks are, otherwise the status of the first that is not;
///     postures and joint velocities count only where there are no other tasks. None before the first
///     step.
/// reports : dict of str to TaskReport
///     The tasks after the last step, by name.
/// joint_velocities : ndarray, (n,)
///     Of the last step [rad/s or m/s].
/// active_limits : list of (str, str)
///     Joints whose limit bounded their velocity in the last step, and its kind.
/// near : Distances or None
///     The pairs nearer than the margin at the configuration of the last step, with the obstacles
///     where they are now.
/// tasks : list of str
///     The names of the tasks.
/// dt : float
///
/// Raises
/// ------
/// UnknownNameError, InvalidOptionError, NotFiniteError, DimensionError
///     For tasks or options that define no controller.
/// ModelError
///     If a centre of mass is asked for and a link has no mass; for a closed chain without actuated
///     joints.
///
/// Examples
/// --------
/// The hand first, the elbow as far as the hand permits:
///
/// >>> import cylindroid as cy
/// >>> robot = cy.load("panda")
/// >>> q = robot.home
/// >>> hand, elbow = robot.fk(q), robot.fk(q, frame="link4")
/// >>> hand[0, 3] += 0.05
/// >>> elbow[1, 3] += 0.2
/// >>> servo = cy.TaskServo(robot, [
/// ...     cy.FrameTask("hand_tcp", hand, name="hand"),
/// ...     cy.FrameTask("link4", elbow, components="position", level=1, name="elbow"),
/// ... ])
/// >>> for _ in range(3000):
/// ...     qd = servo.step(q)
/// ...     q = servo.advance(q)
/// >>> servo.reports["hand"].status, servo.reports["elbow"].status
/// ('reached', 'stalled')
#[pyclass(frozen, name = "TaskServo", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyTaskServo {
    running: Mutex<Running>,
}

#[derive(Debug)]
struct Running {
    servo: TaskServo,
    raised: Raised,
    /// The model of Python, which the servo holds during a step, and the margin.
    collisions: Option<(Py<PyCollisionModel>, f64)>,
    /// The configuration of the last step, and its reports.
    last: Option<(Vec<f64>, Vec<PyTaskReport>)>,
}

impl Running {
    /// A step with the collision model as it is in Python.
    fn step(&mut self, py: Python<'_>, q: &[f64]) -> Result<Vec<PyTaskReport>> {
        let Self { servo, raised, collisions, .. } = self;
        let mut model = match collisions {
            None => None,
            Some((model, _)) => Some(model.try_borrow_mut(py).map_err(in_use)?),
        };
        let mut exchange = |servo: &mut TaskServo| {
            if let (Some(own), Some(model)) = (servo.collision_model_mut(), &mut model) {
                std::mem::swap(own, &mut model.inner);
            }
        };
        exchange(servo);
        let result = servo.step(q);
        exchange(servo);
        if let Err(error) = result {
            let exception = raised.lock().unwrap_or_else(PoisonError::into_inner).take();
            return Err(exception.map_or(Failure::Core(error), Failure::Python));
        }
        let pair = |i: usize| {
            let names = model.as_ref().map_or(["", ""], |m| m.inner.names(i));
            (names[0].to_owned(), names[1].to_owned())
        };
        let all = servo.tasks().iter().zip(servo.reports());
        Ok(all.map(|(task, report)| PyTaskReport::new(&task.name, report, servo, pair)).collect())
    }
}

/// Options that are numbers or flags; those that are not given have the library's defaults.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TaskServoNumbers {
    pub(crate) dt: Option<f64>,
    pub(crate) length: Option<f64>,
    pub(crate) acceleration: Option<f64>,
    pub(crate) jerk: Option<f64>,
    pub(crate) eps: Option<f64>,
    pub(crate) keep_directions: Option<bool>,
    pub(crate) plant: Plant,
}

impl PyTaskServo {
    pub(crate) fn make(
        py: Python<'_>,
        robot: &Mechanism,
        (tasks, collisions): (&[Py<PyMotionTask>], Option<&PyCollisionAvoidance>),
        half_spaces: &[Py<PyHalfSpace>],
        joint_weights: Option<Numbers<'_>>,
        numbers: TaskServoNumbers,
    ) -> Result<Self> {
        let mut chosen = TaskServoOptions::new(robot);
        let set = |to: &mut f64, value: Option<f64>| *to = value.unwrap_or(*to);
        set(&mut chosen.dt, numbers.dt);
        set(&mut chosen.length, numbers.length);
        set(&mut chosen.acceleration, numbers.acceleration);
        set(&mut chosen.jerk, numbers.jerk);
        set(&mut chosen.eps, numbers.eps);
        chosen.keep_directions = numbers.keep_directions.unwrap_or(chosen.keep_directions);
        chosen.plant = numbers.plant;
        if let Some(weights) = &joint_weights {
            chosen.joint_weights = weights.vector("joint_weights")?.to_vec();
        }
        if let Some(PyCollisionAvoidance { model, gap, margin }) = collisions {
            let model = model.try_borrow(py).map_err(in_use)?.inner.clone();
            chosen.collisions = Some(CollisionAvoidance { model, gap: *gap, margin: *margin });
        }
        chosen.half_spaces = super::half_spaces(robot, half_spaces)?;
        let raised = Raised::default();
        let tasks = tasks.iter().map(|task| task.get().of(robot, &raised));
        let tasks = tasks.collect::<Result<Vec<_>>>()?;
        let servo = TaskServo::new(robot, tasks, chosen)?;
        let collisions = collisions.map(|c| (c.model.clone_ref(py), c.margin));
        Ok(Self { running: Mutex::new(Running { servo, raised, collisions, last: None }) })
    }

    /// The servo, for one call at a time.
    fn lock(&self) -> Result<MutexGuard<'_, Running>> {
        match self.running.try_lock() {
            Ok(running) => Ok(running),
            Err(TryLockError::Poisoned(error)) => Ok(error.into_inner()),
            Err(TryLockError::WouldBlock) => Err(Failure::InUse(
                "the servo is in use by a call in another thread, or around this one; make a servo \
                 for each"
                    .to_owned(),
            )),
        }
    }
}

#[pymethods]
impl PyTaskServo {
    #[new]
    #[pyo3(signature = (mechanism, tasks, collisions = None, *, half_spaces = None, limits = None,
        dt = None, length = None, joint_weights = None, acceleration = None, jerk = None, delay = None,
        time_constant = None, noise = None, keep_directions = None, eps = None))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn new(
        py: Python<'_>,
        #[pyo3(from_py_with = argument)] mechanism: PyRef<'_, PyMechanism>,
        #[pyo3(from_py_with = argument)] tasks: Vec<Py<PyMotionTask>>,
        #[pyo3(from_py_with = argument)] collisions: Option<Py<PyCollisionAvoidance>>,
        #[pyo3(from_py_with = argument)] half_spaces: Option<Vec<Py<PyHalfSpace>>>,
        limits: Option<Bound<'_, PyAny>>,
        #[pyo3(from_py_with = argument)] dt: Option<f64>,
        #[pyo3(from_py_with = argument)] length: Option<f64>,
        joint_weights: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] acceleration: Option<f64>,
        #[pyo3(from_py_with = argument)] jerk: Option<f64>,
        #[pyo3(from_py_with = argument)] delay: Option<f64>,
        #[pyo3(from_py_with = argument)] time_constant: Option<f64>,
        #[pyo3(from_py_with = argument)] noise: Option<f64>,
        #[pyo3(from_py_with = argument)] keep_directions: Option<bool>,
        #[pyo3(from_py_with = argument)] eps: Option<f64>,
    ) -> Result<Self> {
        let plant = options::plant(delay, time_constant, noise);
        let numbers =
            TaskServoNumbers { dt, length, acceleration, jerk, eps, keep_directions, plant };
        let limited = match &limits {
            None => mechanism.inner.clone(),
            Some(limits) => mechanism.inner.with_limits(&options::limits(limits)?)?,
        };
        let collisions = collisions.as_ref().map(Py::get);
        let walls = half_spaces.unwrap_or_default();
        Self::make(py, &limited, (&tasks, collisions), &walls, joint_weights, numbers)
    }

    /// One control step: the joint velocities to command until the next step.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,)
    ///     The measured configuration [rad or m].
    /// targets : dict, optional
    ///     New targets by the names of their tasks, kept for the next steps: a pose (4, 4), or for a
    ///     `FrameTask` also `(pose, twist)` as of `CartesianMove.target`; a point (3,); a posture or
    ///     velocities (n,).
    ///
    /// Returns
    /// -------
    /// ndarray, (n,)
    ///     Joint velocities [rad/s or m/s].
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, InvalidOptionError, UnknownNameError
    ///     Also for what the function of a `CustomTask` returns. The servo and its targets are
    ///     unchanged.
    /// InUseError
    ///     Inside the function of a `CustomTask`.
    #[pyo3(signature = (q, targets = None))]
    fn step<'py>(
        &self,
        py: Python<'py>,
        q: Coordinates<'py>,
        #[pyo3(from_py_with = argument)] targets: Option<Bound<'py, PyDict>>,
    ) -> Result<Array<'py>> {
        let running = &mut *self.lock()?;
        let mut others = Vec::new();
        for (name, value) in targets.into_iter().flatten() {
            let name: String = entry("targets", &name)?;
            let mut objective = running.servo.objective_mut(&name)?.clone();
            retarget(&name, &mut objective, &value)?;
            others.push((name, objective));
        }
        let mut exchange = |running: &mut Running| -> Result<()> {
            for (name, objective) in &mut others {
                std::mem::swap(running.servo.objective_mut(name)?, objective);
            }
            Ok(())
        };
        let q = q.vector(running.servo.mechanism(), "q")?;
        exchange(running)?;
        match running.step(py, q) {
            Ok(reports) => running.last = Some((q.to_vec(), reports)),
            Err(error) => {
                exchange(running)?;
                return Err(error);
            }
        }
        Ok(arrays::vector(py, running.servo.joint_velocities()))
    }

    /// Integrates the joint velocities of the last step over `dt`, for simulation.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,)
    ///     The configuration before the step [rad or m].
    ///
    /// Returns
    /// -------
    /// ndarray, (n,)
    ///     The configuration after `dt` seconds.
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    #[pyo3(signature = (q))]
    fn advance<'py>(&self, py: Python<'py>, q: Coordinates<'py>) -> Result<Array<'py>> {
        let servo = &self.lock()?.servo;
        let q = q.vector(servo.mechanism(), "q")?;
        servo.mechanism().check_q("q", q)?;
        let mut next = q.to_vec();
        servo.advance(&mut next);
        Ok(arrays::vector(py, &next))
    }

    /// Lets the frame of a task follow a twist from the next step on, instead of its target; the other
    /// tasks go on. Without a new command it holds for `timeout`, then the frame comes to rest: a lost
    /// connection stops it. A target for the task in `step` ends it, `reset` that of all tasks.
    ///
    /// Parameters
    /// ----------
    /// task : str
    ///     The name of a `FrameTask`.
    /// twist : array_like, (6,)
    ///     Linear first, world axes, at the tool of the task [m/s, rad/s].
    /// timeout : float, optional
    ///     Time for which the command holds (s); infinite: always. Default: 0.1.
    ///
    /// Raises
    /// ------
    /// UnknownNameError, DimensionError, NotFiniteError
    /// InvalidOptionError
    ///     For a task of another class, and a timeout that is not positive.
    #[pyo3(signature = (task, twist, timeout = 0.1))]
    fn command_twist(
        &self,
        #[pyo3(from_py_with = argument)] task: &str,
        twist: Numbers<'_>,
        #[pyo3(from_py_with = argument)] timeout: f64,
    ) -> Result<()> {
        let twist = twist.twist("twist")?;
        Ok(self.lock()?.servo.command_twist(task, twist, timeout)?)
    }

    /// The twist that the next step of a task follows.
    ///
    /// Parameters
    /// ----------
    /// task : str
    ///     The name of a task.
    ///
    /// Returns
    /// -------
    /// ndarray, (6,), or None
    ///     Linear first, world axes, at the tool [m/s, rad/s]: zero after the timeout, None without a
    ///     command.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    #[pyo3(signature = (task))]
    fn commanded_twist<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = argument)] task: &str,
    ) -> Result<Option<Array<'py>>> {
        let twist = self.lock()?.servo.commanded_twist(task)?;
        Ok(twist.map(|twist| arrays::vector(py, &twist.to_array())))
    }

    /// Resets the servo: joints at rest; targets stay.
    fn reset(&self) -> Result<()> {
        let running = &mut *self.lock()?;
        running.servo.reset();
        running.last = None;
        Ok(())
    }

    #[getter]
    fn status(&self) -> Result<Option<&'static str>> {
        let running = self.lock()?;
        Ok(running.last.as_ref().map(|_| running.servo.status().name()))
    }

    #[getter]
    fn reports<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyDict>> {
        let by_name = PyDict::new(py);
        if let Some((_, reports)) = &self.lock()?.last {
            for report in reports {
                by_name.set_item(&report.name, report.clone())?;
            }
        }
        Ok(by_name)
    }

    #[getter]
    fn joint_velocities<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        Ok(arrays::vector(py, self.lock()?.servo.joint_velocities()))
    }

    #[getter]
    fn active_limits(&self) -> Result<Vec<(String, &'static str)>> {
        let running = self.lock()?;
        let mechanism = running.servo.mechanism();
        let limits = running.servo.active_limits().filter(|_| running.last.is_some());
        Ok(limits.map(|(i, kind)| (mechanism.velocity_name(i).to_owned(), kind.name())).collect())
    }

    #[getter]
    fn near(&self, py: Python<'_>) -> Result<Option<PyDistances>> {
        let running = self.lock()?;
        let (Some((model, margin)), Some((q, _))) = (&running.collisions, &running.last) else {
            return Ok(None);
        };
        let mut model = model.try_borrow_mut(py).map_err(in_use)?;
        model.near_at(q, *margin).map(Some)
    }

    #[getter]
    fn tasks(&self) -> Result<Vec<String>> {
        Ok(self.lock()?.servo.tasks().iter().map(|task| task.name.clone()).collect())
    }

    #[getter]
    fn dt(&self) -> Result<f64> {
        Ok(self.lock()?.servo.dt())
    }

    fn __repr__(&self) -> Result<String> {
        let Running { servo, last, .. } = &*self.lock()?;
        let names: Vec<String> = servo.tasks().iter().map(|t| format!("'{}'", t.name)).collect();
        let mut text = format!(
            "<TaskServo of '{}', tasks {}, dt {} s",
            servo.mechanism().name(),
            names.join(", "),
            servo.dt()
        );
        if last.is_some() {
            text.push_str(&format!(", {}", servo.status().name()));
        }
        text.push('>');
        Ok(text)
    }
}
