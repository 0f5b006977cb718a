//! The class `Servo`: Cartesian control, one step at a time or a whole motion.

use cylindroid::control::{
    Outcome, Sample, Stall, Status, Step, Target, drive as drive_servo, find_posture,
};
use cylindroid::{Error, Mechanism, Pose, Servo, ServoOptions, Twist};
use pyo3::prelude::*;

use crate::arrays::{self, Array, Numbers};
use crate::error::Result;
use crate::inverse::MethodNumbers;
use crate::mechanism::PyMechanism;
use crate::motion::PyCartesianMove;
use crate::options::{self, InverseChoice};
use crate::table::{self, Table};

/// A Cartesian controller of one frame: from joint positions and a target pose to joint rates.
///
/// It never leaves a position, velocity or acceleration limit, stays bounded at singular poses,
/// and says why it gets no nearer. Closed chains are driven at their reference through their
/// driven joints.
///
/// Parameters
/// ----------
/// mechanism : Mechanism
/// frame : str, optional
///     What is driven. Default: the tool, or the reference of a closed chain.
/// tool : array_like, (4, 4), optional
///     `frame_from_tool`, a tool point fixed to the frame.
/// gain : float or (float, float), optional
///     Of position and orientation error [1/s]; gain * dt below 2. Default: 5.
/// dt : float, optional
///     Time between steps (s). Default: 0.001.
/// tolerance_position, tolerance_orientation : float, optional
///     Errors at which the target counts as reached (m, rad). Default: 1e-6.
/// speed : float or (float, float), optional
///     Largest speeds of the tool [m/s, rad/s]. Default: what the joints allow.
/// acceleration : float, optional
///     Limit of joints that have none in the model [rad/s^2 or m/s^2]. Default: none.
/// length : float, optional
///     Characteristic length that scales linear rows (m). Default: the reach.
/// joint_weights : array_like, (n,), optional
///     A large weight keeps a joint still.
/// secondary : str, list of str or dict of gains by name, optional
///     What joints do where the tool does not care: 'posture', 'centring', 'limit-avoidance',
///     'manipulability', or 'none'. Default: limit avoidance where there are more joints than task
///     components.
/// posture : array_like, (n,), optional
///     Where 'posture' goes. Default: home.
/// projector : str
///     The null space they may use: 'exact' never disturbs the task, 'retained' also lets them
///     through directions that the inverse cut.
/// task : str, optional
///     'pose', 'position', 'orientation', 'pointing' (position and direction of the tool's z axis),
///     or components like 'x,y,rz'. Default: the pose, in the plane for planar closed chains.
/// task_axes : str, optional
///     'world' or 'local', the axes of the components.
/// inverse : str
///     How the Jacobian is inverted: 'truncated', 'damped', 'variable-damping',
///     'numerical-filtering', 'selectively-damped', 'singular-value-filtering'; for arms that
///     cannot do all of a motion 'hyperbolic' (h), 'hyperbolic-damped' (h, mu), 'hyperbolic-gram'
///     (h, lam), 'oblique' (give_up).
/// eps, damping, onset, filter, max_rate, shape, floor : float, optional
///     Numbers of the inverse, see `inverse`.
/// h, mu, lam : float, optional
///     Pitch and dampings of the hyperbolic inverses [m/rad].
/// give_up : list of str or array_like, (k, 6), optional
///     Motions of the tool, in its axes, that may be given up: names like 'rz', or twists as rows.
/// fallback : str, optional
///     What takes over where that inverse does not exist. Default: none, the arm stops.
///
/// Attributes
/// ----------
/// status : str or None
///     'moving', 'reached' or 'stalled' after the last step, None before the first.
/// stall : Stall or None
///     Why the last step got no nearer, where it stalled.
/// position_error, orientation_error : float
///     Before the last step, of the components that matter (m, rad).
/// singular_ratio : float
///     Smallest singular value of the scaled task Jacobian over the largest.
/// rank : int
///     Directions realised by at least half.
/// rates : ndarray, (n,)
///     Of the last step; in a closed chain driven and passive ones [rad/s or m/s].
/// closing_rates : ndarray
///     Of driven joints that close loops.
/// active_limits : list of (str, str)
///     Joints whose limit set a rate in the last step, and its kind.
/// scale : float
///     The share of the wanted motion that the limits left.
/// no_inverse : str or None
///     Why the inverse that was asked for was not used in the last step.
/// pose : ndarray, (4, 4)
///     `world_from_tool` before the last step.
/// frame : str
/// dt : float
///
/// Raises
/// ------
/// UnknownNameError, InvalidOptionError, NotFiniteError, DimensionError
///     For options that make no controller.
/// ModelError
///     Where no joint moves the frame, or the drives of a closed chain do not hold it.
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
#[pyclass(name = "Servo", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyServo {
    inner: Servo,
    last: Option<Step>,
}

/// Why a servo gets no nearer to its target.
///
/// Attributes
/// ----------
/// name : str
///     'out-of-reach', 'limits', 'singular', 'too-few-joints', 'no-inverse', 'given-up',
///     'uncontrolled' or 'slow'.
/// message : str
///     What it means, with the numbers.
/// joints : list of str
///     The joints that stand at their limits.
/// direction : ndarray or None
///     The remaining error (or the motion that escapes) as a unit vector in the task.
/// distance, length : float or None
///     Out of reach: from the first joint to the target, and the stretched chain from there (m).
#[pyclass(frozen, name = "Stall", module = "cylindroid")]
#[derive(Debug, Clone)]
pub(crate) struct PyStall {
    #[pyo3(get)]
    name: &'static str,
    #[pyo3(get)]
    message: String,
    #[pyo3(get)]
    joints: Vec<String>,
    direction: Option<Vec<f64>>,
    #[pyo3(get)]
    distance: Option<f64>,
    #[pyo3(get)]
    length: Option<f64>,
}

#[pymethods]
impl PyStall {
    #[getter]
    fn direction<'py>(&self, py: Python<'py>) -> Option<Array<'py>> {
        self.direction.as_ref().map(|d| arrays::vector(py, d))
    }

    fn __repr__(&self) -> String {
        format!("Stall('{}': {})", self.name, self.message)
    }
}

impl PyStall {
    fn new(stall: &Stall, mechanism: &Mechanism) -> Self {
        let mut new = Self {
            name: stall.name(),
            message: String::new(),
            joints: Vec::new(),
            direction: None,
            distance: None,
            length: None,
        };
        let number = table::number;
        new.message = match stall {
            Stall::OutOfReach { distance, length } => {
                (new.distance, new.length) = (Some(*distance), Some(*length));
                format!(
                    "the target is {} m from the first joint, the stretched arm {} m long",
                    number(*distance),
                    number(*length)
                )
            }
            Stall::Limits { coordinates } => {
                let name = |i: &usize| mechanism.coordinates()[*i].name.clone();
                new.joints = coordinates.iter().map(name).collect();
                format!("at the limit of {}", new.joints.join(", "))
            }
            Stall::Singular { ratio, direction } => {
                new.direction = Some(direction.clone());
                format!(
                    "a singular pose: smallest singular value {} of the largest",
                    number(*ratio)
                )
            }
            Stall::TooFewJoints { rank, task, direction } => {
                new.direction = Some(direction.clone());
                format!("{rank} independent motions for a task of {task} components")
            }
            Stall::NoInverse(reason) => format!("the inverse does not exist here: {reason}"),
            Stall::GivenUp { direction } => {
                new.direction = Some(direction.clone());
                "what remains is what the inverse gives up, although the arm could lessen it".into()
            }
            Stall::Uncontrolled { share, direction } => {
                new.direction = Some(direction.clone());
                format!(
                    "a motion is about to escape the drives (type II singularity): {} of it is \
                     still theirs",
                    number(*share)
                )
            }
            Stall::Slow => "no progress for a second, with neither limits nor a singular pose: \
                            less damping, a higher gain or speed"
                .into(),
        };
        new
    }
}

fn status_name(status: Status) -> &'static str {
    match status {
        Status::Moving => "moving",
        Status::Reached => "reached",
        Status::Stalled => "stalled",
    }
}

#[pymethods]
impl PyServo {
    #[new]
    #[pyo3(signature = (mechanism, frame = None, gain = None, *, tool = None, dt = None,
        tolerance_position = None, tolerance_orientation = None, speed = None,
        acceleration = None, length = None, joint_weights = None, secondary = None,
        posture = None, projector = "exact", task = None, task_axes = None,
        inverse = "truncated", eps = None, damping = None, onset = None, filter = None,
        max_rate = None, shape = None, floor = None, h = None, mu = None, lam = None,
        give_up = None, fallback = None))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn new(
        mechanism: PyRef<'_, PyMechanism>,
        frame: Option<&str>,
        gain: Option<Numbers<'_>>,
        tool: Option<Numbers<'_>>,
        dt: Option<f64>,
        tolerance_position: Option<f64>,
        tolerance_orientation: Option<f64>,
        speed: Option<Numbers<'_>>,
        acceleration: Option<f64>,
        length: Option<f64>,
        joint_weights: Option<Numbers<'_>>,
        secondary: Option<Bound<'_, PyAny>>,
        posture: Option<Numbers<'_>>,
        projector: &str,
        task: Option<&str>,
        task_axes: Option<&str>,
        inverse: &str,
        eps: Option<f64>,
        damping: Option<f64>,
        onset: Option<f64>,
        filter: Option<f64>,
        max_rate: Option<f64>,
        shape: Option<f64>,
        floor: Option<f64>,
        h: Option<f64>,
        mu: Option<f64>,
        lam: Option<f64>,
        give_up: Option<Bound<'_, PyAny>>,
        fallback: Option<&str>,
    ) -> Result<Self> {
        let robot = &mechanism.inner;
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
        set(&mut options.acceleration, acceleration);
        set(&mut options.length, length);
        if let Some(weights) = &joint_weights {
            options.joint_weights = weights.vector("joint_weights")?.to_vec();
        }
        options.projector = options::projector(projector)?;
        options.task = options::task(robot, task, task_axes, options.task)?;
        let give_up = give_up.map(|g| options::twists("give_up", &g)).transpose()?;
        let numbers = MethodNumbers { eps, damping, onset, filter, max_rate, shape, floor };
        InverseChoice { name: inverse, numbers, h, mu, lam, give_up, fallback }
            .apply(&mut options)?;
        let posture = match &posture {
            Some(posture) => posture.vector("posture")?,
            None => robot.home(),
        };
        options.secondary = options::secondary(secondary.as_ref(), posture, robot, &options)?;
        Ok(Self { inner: Servo::new(robot, options)?, last: None })
    }

    /// One step: the rates to command from now until the next step.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,)
    ///     Where the joints are [rad or m].
    /// target : array_like, (4, 4)
    ///     `world_from_tool` as it should be (m).
    /// secondary : array_like, (n,), optional
    ///     Wanted joint rates, carried out as far as the task allows.
    /// feed_forward : array_like, (6,), optional
    ///     The twist of a moving target, linear first, world axes, at the tool [m/s, rad/s].
    ///
    /// Returns
    /// -------
    /// ndarray, (n,)
    ///     Rates [rad/s or m/s].
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    ///     The servo stays as it was.
    /// InvalidOptionError
    ///     For a target that is no pose, or open loops.
    #[pyo3(signature = (q, target, secondary = None, feed_forward = None))]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        q: Numbers<'py>,
        target: Numbers<'py>,
        secondary: Option<Numbers<'py>>,
        feed_forward: Option<Numbers<'py>>,
    ) -> Result<Array<'py>> {
        let target = Target {
            pose: target.pose("target")?,
            feed_forward: match &feed_forward {
                None => Twist::ZERO,
                Some(twist) => Twist::from_array(twist.entries("feed_forward")?),
            },
        };
        let wanted = match &secondary {
            None => &[],
            Some(wanted) => {
                let wanted = wanted.vector("secondary")?;
                self.inner.mechanism().check_q("secondary", wanted)?;
                wanted
            }
        };
        self.last = Some(self.inner.step_with(q.vector("q")?, target, wanted)?);
        Ok(arrays::vector(py, self.inner.rates()))
    }

    /// `q` moved by the rates of the last step, for simulation.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,)
    ///
    /// Returns
    /// -------
    /// ndarray, (n,)
    ///     After `dt` seconds; passive joints of a closed chain go where the loops are closed.
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    #[pyo3(signature = (q))]
    fn advance<'py>(&self, py: Python<'py>, q: Numbers<'py>) -> Result<Array<'py>> {
        let q = q.vector("q")?;
        self.inner.mechanism().check_q("q", q)?;
        let mut next = q.to_vec();
        self.inner.advance(&mut next);
        Ok(arrays::vector(py, &next))
    }

    /// Forgets the last rates and target: the joints stand still.
    fn reset(&mut self) {
        self.inner.reset();
        self.last = None;
    }

    /// Drives an ideal robot, which does as it is told, until the motion ends.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,)
    ///     The start.
    /// target : array_like, (4, 4), or CartesianMove
    ///     A pose, or a motion of the target.
    /// duration : float
    ///     Longest time (s).
    /// record : bool
    ///     Whether to keep every step in `Outcome.trajectory`.
    ///
    /// Returns
    /// -------
    /// Outcome
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, InvalidOptionError
    #[pyo3(signature = (q, target, duration = 60.0, record = false))]
    fn drive(
        &mut self,
        py: Python<'_>,
        q: Numbers<'_>,
        target: Bound<'_, PyAny>,
        duration: f64,
        record: bool,
    ) -> Result<PyOutcome> {
        Error::check_positive("duration", duration)?;
        let goal = match target.extract::<PyRef<'_, PyCartesianMove>>() {
            Ok(motion) => Goal::Along(Box::new(motion.inner)),
            Err(_) => Goal::Pose(target.extract::<Numbers<'_>>()?.pose("target")?),
        };
        let q = q.vector("q")?;
        let servo = &mut self.inner;
        servo.reset();
        let (n, dt) = (servo.mechanism().n(), servo.options().dt);
        let mut trajectory = record.then(|| PyTrajectory { n, ..PyTrajectory::default() });
        let outcome = py.detach(|| {
            let observe = |sample: Sample<'_>| {
                if let Some(trajectory) = &mut trajectory {
                    trajectory.push(&sample);
                }
            };
            let aim = |time: f64| match &goal {
                Goal::Pose(pose) => (Target::from(*pose), true),
                Goal::Along(motion) => (motion.target(time, dt), time >= motion.law().duration()),
            };
            drive_servo(servo, q, duration, aim, observe)
        })?;
        self.last = Some(outcome.last);
        let mechanism = self.inner.mechanism().clone();
        Ok(PyOutcome { outcome, trajectory, mechanism })
    }

    /// A posture within the limits that reaches a target, where one can be found: a way round
    /// where the servo, going straight at it, stalls.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,)
    ///     Coordinates that do not move the frame keep these values.
    /// target : array_like, (4, 4)
    ///     `world_from_tool` (m).
    /// runs : int
    ///     Attempts at most.
    ///
    /// Returns
    /// -------
    /// ndarray, (n,), or None
    ///     None says that no run reached it: likely, not proved, that no posture does.
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, InvalidOptionError
    #[pyo3(signature = (q, target, runs = 200))]
    fn find_posture<'py>(
        &self,
        py: Python<'py>,
        q: Numbers<'py>,
        target: Numbers<'py>,
        runs: usize,
    ) -> Result<Option<Array<'py>>> {
        let (q, target) = (q.vector("q")?, target.pose("target")?);
        let found = py.detach(|| find_posture(&self.inner, q, target, runs))?;
        Ok(found.map(|detour| arrays::vector(py, &detour.q)))
    }

    #[getter]
    fn status(&self) -> Option<&'static str> {
        self.last.map(|s| status_name(s.status))
    }

    #[getter]
    fn stall(&self) -> Option<PyStall> {
        let stalled = self.last.is_some_and(|s| s.status == Status::Stalled);
        stalled.then(|| PyStall::new(&self.inner.stall(), self.inner.mechanism()))
    }

    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> Result<Option<Array<'py>>> {
        self.last.map(|s| arrays::pose(py, s.pose)).transpose()
    }

    #[getter]
    fn position_error(&self) -> f64 {
        self.last.map_or(f64::NAN, |s| s.position_error)
    }

    #[getter]
    fn orientation_error(&self) -> f64 {
        self.last.map_or(f64::NAN, |s| s.orientation_error)
    }

    #[getter]
    fn singular_ratio(&self) -> f64 {
        self.last.map_or(f64::NAN, |s| s.singular_ratio)
    }

    #[getter]
    fn rank(&self) -> usize {
        self.last.map_or(0, |s| s.rank)
    }

    #[getter]
    fn scale(&self) -> f64 {
        self.last.map_or(f64::NAN, |s| s.saturation.scale)
    }

    #[getter]
    fn rates<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, self.inner.rates())
    }

    #[getter]
    fn closing_rates<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, self.inner.closing_rates())
    }

    #[getter]
    fn active_limits(&self) -> Vec<(String, &'static str)> {
        let coordinates = self.inner.mechanism().coordinates();
        let named = |(i, kind): (usize, cylindroid::control::LimitKind)| {
            (coordinates[i].name.clone(), kind.name())
        };
        self.inner.active_limits().map(named).collect()
    }

    #[getter]
    fn no_inverse(&self) -> Option<String> {
        self.inner.no_inverse().map(|r| r.to_string())
    }

    #[getter]
    fn frame(&self) -> &str {
        &self.inner.mechanism().frame_of(self.inner.options().end_effector.frame).name
    }

    #[getter]
    fn dt(&self) -> f64 {
        self.inner.options().dt
    }

    fn __repr__(&self) -> String {
        let options = self.inner.options();
        let mut text = format!(
            "<Servo of '{}', frame '{}', inverse {}, dt {} s",
            self.inner.mechanism().name(),
            self.frame(),
            match options.projection {
                cylindroid::control::Projection::Orthogonal => options.method.name(),
                ref projection => projection.name(),
            },
            options.dt
        );
        if let Some(status) = self.status() {
            text.push_str(&format!(", {status}"));
        }
        text.push('>');
        text
    }
}

/// Where a motion goes.
enum Goal {
    Pose(Pose),
    Along(Box<cylindroid::control::CartesianMove>),
}

/// How a motion ended.
///
/// Attributes
/// ----------
/// reached : bool
/// reason : str
///     'reached', the name of the stall, or 'time-limit'.
/// stall : Stall or None
/// q : ndarray, (n,)
///     The last configuration.
/// position_error, orientation_error : float
///     At the end (m, rad).
/// steps : int
/// time : float
///     Duration (s).
/// min_singular_ratio : float
///     Smallest ratio of singular values on the way.
/// limits_hit : list of (str, str)
///     Joints whose limits set a rate on the way, and their kinds.
/// no_inverse : str or None
///     Why the inverse that was asked for did not exist, where that happened first.
/// steps_without_inverse : int
/// trajectory : Trajectory or None
#[pyclass(frozen, name = "Outcome", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyOutcome {
    outcome: Outcome,
    trajectory: Option<PyTrajectory>,
    mechanism: Mechanism,
}

#[pymethods]
impl PyOutcome {
    #[getter]
    fn reached(&self) -> bool {
        self.outcome.reached
    }

    #[getter]
    fn reason(&self) -> &'static str {
        match &self.outcome.stall {
            _ if self.outcome.reached => "reached",
            Some(stall) => stall.name(),
            None => "time-limit",
        }
    }

    #[getter]
    fn stall(&self) -> Option<PyStall> {
        self.outcome.stall.as_ref().map(|s| PyStall::new(s, &self.mechanism))
    }

    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.outcome.q)
    }

    #[getter]
    fn position_error(&self) -> f64 {
        self.outcome.last.position_error
    }

    #[getter]
    fn orientation_error(&self) -> f64 {
        self.outcome.last.orientation_error
    }

    #[getter]
    fn steps(&self) -> usize {
        self.outcome.steps
    }

    #[getter]
    fn time(&self) -> f64 {
        self.outcome.time
    }

    #[getter]
    fn min_singular_ratio(&self) -> f64 {
        self.outcome.min_singular_ratio
    }

    #[getter]
    fn limits_hit(&self) -> Vec<(String, &'static str)> {
        let name = |i: usize| self.mechanism.coordinates()[i].name.clone();
        self.outcome.limits_hit.iter().map(|(i, kind)| (name(*i), kind.name())).collect()
    }

    #[getter]
    fn no_inverse(&self) -> Option<String> {
        self.outcome.no_inverse.map(|r| r.to_string())
    }

    #[getter]
    fn steps_without_inverse(&self) -> usize {
        self.outcome.steps_without_inverse
    }

    #[getter]
    fn trajectory(&self) -> Option<PyTrajectory> {
        self.trajectory.clone()
    }

    fn __repr__(&self) -> String {
        self.table().text()
    }

    fn _repr_html_(&self) -> String {
        self.table().html()
    }
}

impl PyOutcome {
    fn table(&self) -> Table {
        let o = &self.outcome;
        let mut table = Table::new(&format!("Motion of '{}'", self.mechanism.name()));
        table.row("reached", if o.reached { "yes" } else { "no" });
        if let Some(stall) = self.stall() {
            table.row("stall", format!("{}: {}", stall.name, stall.message));
        } else if !o.reached {
            table.row("reason", "time-limit");
        }
        let number = table::number;
        table.row(
            "errors",
            format!(
                "{} m, {} rad",
                number(o.last.position_error),
                number(o.last.orientation_error)
            ),
        );
        table.row("time", format!("{} s, {} steps", number(o.time), o.steps));
        table.row("singular ratio", format!("{} at the least", number(o.min_singular_ratio)));
        let limits: Vec<String> =
            self.limits_hit().iter().map(|(joint, kind)| format!("{joint} ({kind})")).collect();
        table.row("limits", table::names(&limits));
        if let Some(reason) = self.no_inverse() {
            table.row("no inverse", format!("{} steps: {reason}", o.steps_without_inverse));
        }
        table.row("q", table::list(&o.q));
        table
    }
}

/// Every step of a motion.
///
/// Attributes
/// ----------
/// time : ndarray, (S,)
///     Since the start (s).
/// q, rates : ndarray, (S, n)
///     Before each step, and as commanded by it.
/// pose : ndarray, (S, 4, 4)
///     `world_from_tool` (m).
/// position_error, orientation_error, singular_ratio : ndarray, (S,)
#[pyclass(frozen, name = "Trajectory", module = "cylindroid")]
#[derive(Debug, Clone, Default)]
pub(crate) struct PyTrajectory {
    n: usize,
    time: Vec<f64>,
    q: Vec<f64>,
    rates: Vec<f64>,
    pose: Vec<f64>,
    errors: [Vec<f64>; 3],
}

impl PyTrajectory {
    fn push(&mut self, sample: &Sample<'_>) {
        self.time.push(sample.time);
        self.q.extend(sample.q);
        self.rates.extend(sample.rates);
        self.pose.extend(sample.step.pose.to_matrix().as_flattened());
        let s = sample.step;
        let values = [s.position_error, s.orientation_error, s.singular_ratio];
        self.errors.iter_mut().zip(values).for_each(|(all, x)| all.push(x));
    }

    fn table<'py>(&self, py: Python<'py>, values: &[f64], shape: &[usize]) -> Result<Array<'py>> {
        arrays::written(py, Some(self.time.len()), shape, |out| out.copy_from_slice(values))
    }
}

#[pymethods]
impl PyTrajectory {
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.time)
    }

    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        self.table(py, &self.q, &[self.n])
    }

    #[getter]
    fn rates<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        self.table(py, &self.rates, &[self.n])
    }

    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        self.table(py, &self.pose, &[4, 4])
    }

    #[getter]
    fn position_error<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.errors[0])
    }

    #[getter]
    fn orientation_error<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.errors[1])
    }

    #[getter]
    fn singular_ratio<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.errors[2])
    }

    fn __len__(&self) -> usize {
        self.time.len()
    }

    fn __repr__(&self) -> String {
        let end = self.time.last().copied().unwrap_or(0.0);
        format!("<Trajectory of {} steps, {} s>", self.time.len(), table::number(end))
    }
}
