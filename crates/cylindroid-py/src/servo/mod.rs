//! The class `Servo`: Cartesian control, one step at a time or a whole motion.

mod motion_result;
mod simulate;
mod stall;
mod status;
mod tracking;
mod trajectory;

use std::sync::{Mutex, MutexGuard, TryLockError};

use cylindroid::control::{InverseSelection, Step, Target, TwistStep};
use cylindroid::{Error, Servo, ServoOptions, Twist};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{self, Array, Numbers};
use crate::coordinates::Coordinates;
use crate::error::{Failure, Result, argument};
use crate::inverse::parameters_of;
use crate::mechanism::PyMechanism;
use crate::options;
use crate::parameter_tables::documented;
use crate::tasks::{PyCollisionAvoidance, PyMotionTask, PyTaskServo, TaskServoNumbers};

pub(crate) use motion_result::PyMotionResult;
pub(crate) use stall::PyStall;
pub(crate) use trajectory::PyTrajectory;

/// A Cartesian servo (resolved-rate control) of one frame: computes joint velocities from joint
/// positions and a target pose.
///
/// It never violates a position, velocity, acceleration or jerk limit, stays bounded at singularities,
/// and reports why it stalls. Closed chains are controlled at their reference through their actuated
/// joints.
///
/// Parameters
/// ----------
/// mechanism : Mechanism
/// frame : str, optional
///     The controlled frame. Default: the tool, or the reference of a closed chain.
/// tool : array_like, (4, 4), optional
///     `frame_from_tool`, a tool point fixed to the frame.
/// gain : float or (float, float), optional
///     Gain of position and orientation errors [1/s]; gain * dt must be below 2. Default: 5.
/// dt : float, optional
///     Time between steps (s). Default: 0.001.
/// tolerance_position, tolerance_orientation : float, optional
///     Errors at which the target counts as reached (m, rad). Default: 1e-6.
/// speed : float or (float, float), optional
///     Speed limits of the tool [m/s, rad/s]. Default: those of the joints.
/// acceleration : float, optional
///     Limit of joints that have none in the model [rad/s^2 or m/s^2]; `inf` for none. Default: the
///     default ramp, 20 rad/s^2 or characteristic lengths of the mechanism/s^2; none with `tasks`.
/// jerk : float, optional
///     Limit of joints that have none in the model [rad/s^3 or m/s^3]. Default: none.
/// delay, time_constant, noise : float, optional
///     The robot: time until a command arrives at its drives (s), the time constant with which they
///     follow it (s), and the largest error of its encoders [rad or m]. The servo steers the
///     configuration to which its commands lead, so that joints brake in time. Default: 0.
/// command_timeout : float, optional
///     Time for which a twist of `step_twist` holds without a new command (s). Default: 0.1.
/// limits : dict of str to dict of str to float, optional
///     Limits of joints in place of those of the model, see `Mechanism.with_limits`.
/// length : float, optional
///     Characteristic length that scales linear rows (m). Default: that of the mechanism, `reach`.
/// joint_weights : array_like, (n,), or 'inertia', optional
///     Weights of joint velocities; a large one keeps a joint almost at rest. Default: 1, and 1/L^2
///     for slides beside joints that turn, with the characteristic length L of the mechanism (not with
///     tasks). 'inertia': the diagonal of the mass matrix, at the configuration of every step.
/// secondary : str, list of str or dict, optional
///     Secondary tasks in the null space of the primary one, by name (see below), or 'none'; a dict
///     gives for each name a gain or a dict of parameters. Default: limit avoidance for redundant
///     arms and closed chains, otherwise none.
/// posture : array_like, (n,), optional
///     The configuration of the secondary task 'posture'. Default: home.
/// null_space : str
///     The null space of secondary tasks: 'exact' never disturbs the primary task, 'retained' also
///     contains the directions truncated by the inverse.
/// task : str, optional
///     'pose', 'position', 'orientation', 'pointing' (position and direction of the tool's z axis),
///     or components like 'x,y,rz'. Default: the pose, in the plane for planar closed chains.
/// task_axes : str, optional
///     'world' or 'local', the axes of the components.
/// inverse : str
///     The inverse of the Jacobian: a name of `inverse_methods`, which lists parameters, units and
///     defaults: 'truncated', ... (see `inverse`); for arms with fewer than six joints also
///     'hyperbolic' (h), 'hyperbolic-damped' (h, mu), 'hyperbolic-gram' (h, lam), 'oblique'
///     (give_up).
/// give_up : list of str or array_like, (k, 6), optional
///     Motions that 'oblique' may discard, in tool axes: names like 'rz', or twists as rows.
/// fallback : str, optional
///     The inverse used if the requested one does not exist or enlarges motions too much. Default:
///     none, the arm stops.
/// tasks : sequence of MotionTask, optional
///     Makes a `TaskServo` of these tasks instead, with `collisions`, `limits`, `dt`, `acceleration`, `jerk`,
///     `delay`, `time_constant`, `noise`, `length` and `joint_weights`; the other options belong to a single frame.
/// collisions : CollisionAvoidance, optional
///     The distances to keep, beside `tasks`.
/// **parameters : float
///     Parameters of the inverse: `damping=0.05`, `h=0.1`, `mu=0.01`, ...
///
/// Attributes
/// ----------
/// status : str or None
///     'moving', 'reached' or 'stalled' after the last step, None before the first.
///     In velocity mode (`step_twist`): 'following', 'stalled', 'braking' or 'at-rest'.
/// stall : Stall or None
///     The reason of a stall in the last step.
/// achieved_twist : ndarray, (6,), or None
///     In velocity mode, the twist of the joint velocities in the components of the task, linear
///     first, world axes, at the tool [m/s, rad/s].
/// timed_out : bool
///     True in velocity mode if the last command is older than `command_timeout`.
/// position_error, orientation_error : float
///     Before the last step, in the components of the task (m, rad).
/// lag : float
///     Time that the tool is behind a moving target (s); zero for fixed targets.
/// singular_ratio : float
///     Smallest singular value of the scaled task Jacobian over the largest.
/// rank : int
///     Directions realised by at least half.
/// joint_velocities : ndarray, (n,)
///     Of the last step; actuated and passive ones in a closed chain [rad/s or m/s].
/// configuration : ndarray, (n,)
///     Of the last step, its loops closed [rad or m].
/// closure_error : LoopClosureError or None
///     How far the loops are open there; None without loops.
/// loop_closure_velocities : ndarray
///     Velocities of actuated loop-closure joints.
/// active_limits : list of (str, str)
///     Joints whose limit bounded their velocity in the last step, and its kind.
/// scale : float
///     Scale of the desired motion that the limits permit.
/// direction_lost : bool
///     True if the limits changed its direction, since no scaled motion was feasible.
/// no_inverse : str or None
///     The reason why the requested inverse was not used in the last step.
/// pose : ndarray, (4, 4)
///     `world_from_tool` before the last step.
/// frame : str
/// dt : float
///
/// Raises
/// ------
/// UnknownNameError, InvalidOptionError, NotFiniteError, DimensionError
///     For options that do not define a controller.
/// ModelError
///     If no joint moves the frame, or the actuated joints of a closed chain do not control it.
///
/// Notes
/// -----
/// The secondary tasks and their parameters:
///
#[doc = cylindroid::secondary_tasks!(documented)]
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> robot = cy.load("panda")
/// >>> servo, q = cy.Servo(robot, gain=10.0, dt=0.002), robot.home
/// >>> target = robot.fk(q)
/// >>> target[2, 3] -= 0.1
/// >>> while servo.status not in ("reached", "stalled"):
/// ...     qd = servo.step(q, target)
/// ...     q = q + servo.dt * qd
/// >>> servo.status, bool(abs(robot.fk(q) - target).max() < 1e-5)
/// ('reached', True)
#[pyclass(frozen, name = "Servo", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyServo {
    running: Mutex<Running>,
}

#[derive(Debug)]
struct Running {
    servo: Servo,
    /// The result of the last step.
    last: Option<Step>,
    /// The same in velocity mode.
    twist: Option<TwistStep>,
}

/// Weights of joint velocities: numbers, or 'inertia'.
#[derive(Debug, FromPyObject)]
enum JointWeights<'py> {
    Name(String),
    Numbers(Numbers<'py>),
}

impl PyServo {
    /// The servo, for one call at a time.
    fn lock(&self) -> Result<MutexGuard<'_, Running>> {
        match self.running.try_lock() {
            Ok(running) => Ok(running),
            Err(TryLockError::Poisoned(error)) => Ok(error.into_inner()),
            Err(TryLockError::WouldBlock) => Err(Failure::InUse(
                "the servo is in use by a call in another thread; make a servo for each thread"
                    .to_owned(),
            )),
        }
    }

    /// The result of the last step.
    pub(crate) fn last(&self) -> Result<Option<Step>> {
        Ok(self.lock()?.last)
    }
}

#[pymethods]
impl PyServo {
    #[new]
    #[pyo3(signature = (mechanism, frame = None, gain = None, *, tool = None, dt = None,
        tolerance_position = None, tolerance_orientation = None, speed = None,
        acceleration = None, jerk = None, delay = None, time_constant = None, noise = None,
        command_timeout = None, limits = None, length = None, joint_weights = None, secondary = None,
        posture = None, null_space = "exact", task = None, task_axes = None,
        inverse = "truncated", give_up = None, fallback = None, tasks = None, collisions = None,
        **parameters))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    #[expect(clippy::new_ret_no_self, reason = "tasks make a TaskServo")]
    fn new<'py>(
        py: Python<'py>,
        #[pyo3(from_py_with = argument)] mechanism: PyRef<'_, PyMechanism>,
        #[pyo3(from_py_with = argument)] frame: Option<&str>,
        gain: Option<Numbers<'_>>,
        tool: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] dt: Option<f64>,
        #[pyo3(from_py_with = argument)] tolerance_position: Option<f64>,
        #[pyo3(from_py_with = argument)] tolerance_orientation: Option<f64>,
        speed: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] acceleration: Option<f64>,
        #[pyo3(from_py_with = argument)] jerk: Option<f64>,
        #[pyo3(from_py_with = argument)] delay: Option<f64>,
        #[pyo3(from_py_with = argument)] time_constant: Option<f64>,
        #[pyo3(from_py_with = argument)] noise: Option<f64>,
        #[pyo3(from_py_with = argument)] command_timeout: Option<f64>,
        limits: Option<Bound<'_, PyAny>>,
        #[pyo3(from_py_with = argument)] length: Option<f64>,
        #[pyo3(from_py_with = argument)] joint_weights: Option<JointWeights<'_>>,
        secondary: Option<Bound<'_, PyAny>>,
        posture: Option<Coordinates<'_>>,
        #[pyo3(from_py_with = argument)] null_space: &str,
        #[pyo3(from_py_with = argument)] task: Option<&str>,
        #[pyo3(from_py_with = argument)] task_axes: Option<&str>,
        #[pyo3(from_py_with = argument)] inverse: &str,
        give_up: Option<Bound<'_, PyAny>>,
        #[pyo3(from_py_with = argument)] fallback: Option<&str>,
        #[pyo3(from_py_with = argument)] tasks: Option<Vec<Py<PyMotionTask>>>,
        #[pyo3(from_py_with = argument)] collisions: Option<Py<PyCollisionAvoidance>>,
        parameters: Option<&Bound<'_, PyDict>>,
    ) -> Result<Bound<'py, PyAny>> {
        let limited = match &limits {
            None => mechanism.inner.clone(),
            Some(limits) => mechanism.inner.with_limits(&options::limits(limits)?)?,
        };
        let robot = &limited;
        let plant = options::plant(delay, time_constant, noise);
        if let Some(tasks) = tasks {
            let number = |x: Option<f64>| x.map(|x| x.to_string());
            let array = |is_given: bool| is_given.then(|| "...".to_owned());
            let object = |x: &Option<Bound<'_, PyAny>>| x.as_ref().map(ToString::to_string);
            let name = |x: &str| x.to_owned();
            let foreign = [
                ("frame", frame.map(name)),
                ("gain", array(gain.is_some())),
                ("tool", array(tool.is_some())),
                ("tolerance_position", number(tolerance_position)),
                ("tolerance_orientation", number(tolerance_orientation)),
                ("speed", array(speed.is_some())),
                ("command_timeout", number(command_timeout)),
                ("secondary", object(&secondary)),
                ("posture", array(posture.is_some())),
                ("null_space", (null_space != "exact").then(|| name(null_space))),
                ("task", task.map(name)),
                ("task_axes", task_axes.map(name)),
                ("inverse", (inverse != "truncated").then(|| name(inverse))),
                ("give_up", object(&give_up)),
                ("fallback", fallback.map(name)),
                ("parameters", parameters.filter(|p| !p.is_empty()).map(ToString::to_string)),
            ];
            for (option, value) in foreign {
                if let Some(value) = value {
                    let reason = "it belongs to a servo of one frame: omit it, or omit tasks, which \
                                  have frames, gains and tolerances of their own";
                    return Err(Failure::option(option, value, reason));
                }
            }
            let weights = match joint_weights {
                None => None,
                Some(JointWeights::Numbers(weights)) => Some(weights),
                Some(JointWeights::Name(name)) => {
                    let reason = "weights of a servo of many tasks are numbers";
                    return Err(Failure::option("joint_weights", name, reason));
                }
            };
            let (eps, keep_directions) = (None, None);
            let numbers =
                TaskServoNumbers { dt, length, acceleration, jerk, eps, keep_directions, plant };
            let collisions = collisions.as_ref().map(Py::get);
            let servo = PyTaskServo::make(py, robot, (&tasks, collisions), &[], weights, numbers)?;
            return Ok(Bound::new(py, servo)?.into_any());
        }
        if collisions.is_some() {
            return Err(Failure::option("collisions", "...", "it needs tasks, as in TaskServo"));
        }
        let mut options = ServoOptions::new(robot);
        if let Some(name) = frame {
            options.end_effector.frame = robot.frame(name)?;
        }
        if let Some(tool) = &tool {
            options.end_effector.frame_from_tool = tool.pose("tool")?;
        }
        if let Some(gain) = &gain {
            options.gain = options::gain(gain)?;
        }
        if let Some(speed) = &speed {
            options.speed = options::speed(speed)?;
        }
        let set = |to: &mut f64, value: Option<f64>| *to = value.unwrap_or(*to);
        set(&mut options.dt, dt);
        set(&mut options.tolerance.position, tolerance_position);
        set(&mut options.tolerance.orientation, tolerance_orientation);
        options.acceleration = acceleration;
        set(&mut options.jerk, jerk);
        set(&mut options.command_timeout, command_timeout);
        set(&mut options.length, length);
        options.plant = plant;
        match &joint_weights {
            None => {}
            Some(JointWeights::Name(name)) if name == "inertia" => options.inertia_weights = true,
            Some(JointWeights::Name(name)) => {
                return Err(Error::unknown("weights", name, ["inertia"]).into());
            }
            Some(JointWeights::Numbers(weights)) => {
                options.joint_weights = weights.vector("joint_weights")?.to_vec();
            }
        }
        options.null_space = options::null_space(null_space)?;
        options.task = options::task(robot, task, task_axes, options.task)?;
        let complement = give_up.map(|g| options::twists("give_up", &g)).transpose()?;
        let selection = InverseSelection {
            name: inverse,
            parameters: parameters_of("Servo", parameters)?,
            complement: complement.unwrap_or_default(),
            fallback,
        };
        selection.apply(&mut options)?;
        let posture = mechanism.or_home("posture", posture.as_ref())?;
        options.secondary = options::secondary(secondary.as_ref(), posture, robot, &options)?;
        let servo = Servo::new(robot, options)?;
        let new = Self { running: Mutex::new(Running { servo, last: None, twist: None }) };
        Ok(Bound::new(py, new)?.into_any())
    }

    /// One control step: the joint velocities to command until the next step.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,)
    ///     The measured configuration [rad or m].
    /// target : array_like, (4, 4)
    ///     The desired `world_from_tool` (m).
    /// secondary : array_like, (n,), optional
    ///     Secondary joint velocities, projected onto the null space of the task.
    /// feed_forward : array_like, (6,), optional
    ///     The twist of a moving target, linear first, world axes, at the tool [m/s, rad/s].
    ///
    /// Returns
    /// -------
    /// ndarray, (n,)
    ///     Joint velocities [rad/s or m/s].
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    ///     The state of the servo is unchanged.
    /// InvalidOptionError
    ///     For a target that is not a pose, or open loops.
    #[pyo3(signature = (q, target, secondary = None, feed_forward = None))]
    fn step<'py>(
        &self,
        py: Python<'py>,
        q: Coordinates<'py>,
        target: Numbers<'py>,
        secondary: Option<Numbers<'py>>,
        feed_forward: Option<Numbers<'py>>,
    ) -> Result<Array<'py>> {
        let target = moving_target(&target, feed_forward.as_ref())?;
        let running = &mut *self.lock()?;
        let q = q.vector(running.servo.mechanism(), "q")?;
        let desired = match &secondary {
            None => &[],
            Some(desired) => {
                let desired = desired.vector("secondary")?;
                running.servo.mechanism().check_q("secondary", desired)?;
                desired
            }
        };
        running.last = Some(running.servo.step_with(q, target, desired)?);
        running.twist = None;
        Ok(arrays::vector(py, running.servo.joint_velocities()))
    }

    /// One step of velocity mode: the tool follows a twist within all limits, without a target.
    ///
    /// Without a new command the last one holds for `command_timeout`, then the joints brake: a lost
    /// connection stops the arm. `status` is 'following', 'stalled' (`stall` gives the reason),
    /// 'braking' or 'at-rest'.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,)
    ///     The measured configuration [rad or m].
    /// twist : array_like, (6,), optional
    ///     The command that arrived since the last step, linear first, world axes, at the tool [m/s,
    ///     rad/s]. None: no command arrived.
    ///
    /// Returns
    /// -------
    /// ndarray, (n,)
    ///     Joint velocities [rad/s or m/s].
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    ///     The state of the servo is unchanged.
    #[pyo3(signature = (q, twist = None))]
    fn step_twist<'py>(
        &self,
        py: Python<'py>,
        q: Coordinates<'py>,
        twist: Option<Numbers<'py>>,
    ) -> Result<Array<'py>> {
        let twist = twist.as_ref().map(|twist| twist.twist("twist")).transpose()?;
        let running = &mut *self.lock()?;
        let q = q.vector(running.servo.mechanism(), "q")?;
        let step = running.servo.step_twist(q, twist)?;
        (running.last, running.twist) = (Some(step.step), Some(step));
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
    ///     The configuration after `dt` seconds; passive joints of a closed chain are corrected to
    ///     close the loops.
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

    /// Resets the servo: no last target, joints at rest.
    fn reset(&self) -> Result<()> {
        let running = &mut *self.lock()?;
        running.servo.reset();
        (running.last, running.twist) = (None, None);
        Ok(())
    }
}

/// A target pose with the twist at which it moves.
pub(super) fn moving_target(
    pose: &Numbers<'_>,
    feed_forward: Option<&Numbers<'_>>,
) -> Result<Target> {
    Ok(Target {
        pose: pose.pose("target")?,
        feed_forward: match feed_forward {
            None => Twist::ZERO,
            Some(twist) => twist.twist("feed_forward")?,
        },
    })
}
