//! Tasks, options and reports of a servo of many tasks.
//!
//! Checked  tests/it/servo/tasks.rs

use super::objective::TaskObjective;
use crate::closure::check_coordinates;
use crate::collision::CollisionModel;
use crate::control::servo::{Plant, PoseTolerance, Status};
use crate::control::solver::bounds::LimitKind;
use crate::error::{Error, Result};
use crate::model::Mechanism;
use crate::task::HalfSpace;
use crate::tolerance;

/// A task with its gain, weight and priority.
#[derive(Debug, Clone)]
pub struct MotionTask {
    /// The name in reports.
    pub name: String,
    /// The motion that it asks for.
    pub objective: TaskObjective,
    /// Priority: 0 first. Tasks of one level share it by their weights; a level never disturbs one
    /// before it.
    pub level: usize,
    /// Weight beside the other tasks of its level [-]: of postures and velocities the mean counts.
    pub weight: f64,
    /// Proportional gain [1/s]; 0 for a task that is its feed-forward velocity alone.
    pub gain: f64,
    /// Errors below which it counts as reached.
    pub tolerance: PoseTolerance,
}

impl MotionTask {
    /// A task of the first level with weight 1, a gain of 5/s and the tolerances of a servo.
    #[must_use]
    pub fn new(name: &str, objective: TaskObjective) -> Self {
        Self {
            name: name.to_owned(),
            objective,
            level: 0,
            weight: 1.0,
            gain: 5.0,
            tolerance: PoseTolerance {
                position: tolerance::POSITION,
                orientation: tolerance::ORIENTATION,
            },
        }
    }

    /// The same task with another priority.
    #[must_use]
    pub fn at_level(self, level: usize) -> Self {
        Self { level, ..self }
    }
}

/// Distances to keep between bodies and to obstacles.
#[derive(Debug, Clone)]
pub struct CollisionAvoidance {
    /// The bodies, and the obstacles, which may move while the servo runs.
    pub model: CollisionModel,
    /// Least distance (m).
    pub gap: f64,
    /// Only pairs closer than this bend the motion (m), and of these the 64 closest. It should exceed
    /// the distance in which a pair stops: where joints are fast and accelerate slowly, a pair that
    /// comes into view at a smaller one leaves only braking, which in a tree ends before it touches;
    /// a closed chain may not brake in time.
    pub margin: f64,
}

impl CollisionAvoidance {
    /// Checks a least distance and a margin (m).
    ///
    /// # Errors
    /// [`Error::InvalidOption`] for a negative gap, or a margin that is infinite or not above it.
    pub fn check_distances(gap: f64, margin: f64) -> Result<()> {
        if gap >= 0.0 && margin > gap && margin.is_finite() {
            return Ok(());
        }
        Err(Error::InvalidOption {
            option: "collisions",
            value: format!("gap {gap} m, margin {margin} m"),
            reason: "the margin must be above the gap, and that not negative".to_owned(),
        })
    }
}

/// Most pairs of bodies that count at once: the nearest.
pub(super) const MOST_PAIRS: usize = 64;

/// Rows of a task at most: memory for all of them is reserved at the start.
const MAX_ROWS: usize = 1000;

/// Options of a servo of many tasks.
#[derive(Debug, Clone)]
pub struct TaskServoOptions {
    /// Time between steps (s).
    pub dt: f64,
    /// Characteristic length that scales the linear rows (m).
    pub length: f64,
    /// A weight for each coordinate (a large weight keeps it still) [-, or 1/m^2 of a length: 1/L^2
    /// weighs a slider as an angle]; empty for 1.
    pub joint_weights: Vec<f64>,
    /// Acceleration limit of coordinates without one in the model [rad/s^2 or m/s^2]; infinite, the
    /// default, for none: tasks with large gains do not brake for the default ramp of a servo.
    pub acceleration: f64,
    /// Jerk limit of coordinates without one in the model [rad/s^3 or m/s^3].
    pub jerk: f64,
    /// The lag, the delay and the noise of the robot.
    pub plant: Plant,
    /// Where limits and distances stop a task: true to shorten its velocity as long as a share of it
    /// is feasible, so that its tool stays on its line; false for the least squares of what all tasks
    /// of its level miss, which leaves smaller errors.
    pub keep_directions: bool,
    /// Directions of a level with singular values below this share of its norm are left out [-].
    pub eps: f64,
    /// Distances to keep.
    pub collisions: Option<CollisionAvoidance>,
    /// Half-spaces of the world that tool points must not leave.
    pub half_spaces: Vec<HalfSpace>,
}

impl TaskServoOptions {
    /// 1 kHz, the characteristic length of the mechanism, no weights, an ideal robot, directions kept, no
    /// collisions.
    #[must_use]
    pub fn new(mechanism: &Mechanism) -> Self {
        Self {
            dt: 1e-3,
            length: mechanism.reach(),
            joint_weights: Vec::new(),
            acceleration: f64::INFINITY,
            jerk: f64::INFINITY,
            plant: Plant::IDEAL,
            keep_directions: true,
            eps: tolerance::TRUNCATION,
            collisions: None,
            half_spaces: Vec::new(),
        }
    }
}

/// The inequality that stops a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StoppedBy {
    /// A limit of a joint.
    Limit {
        /// Its index in `q`; in closed chains actuated loop joints follow
        /// ([`Mechanism::velocity_name`]).
        coordinate: usize,
        /// The kind of the limit.
        kind: LimitKind,
    },
    /// A pair of bodies, by its index in [`CollisionModel::pairs`].
    Distance {
        /// The index.
        pair: usize,
    },
    /// A half-space, by its index in [`TaskServoOptions::half_spaces`].
    HalfSpace {
        /// The index.
        index: usize,
    },
    /// A type II singularity of a closed chain is near, and the motion approaches it.
    TypeII,
}

/// The state of a task after a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TaskReport {
    /// Reached, moving or stalled.
    pub status: Status,
    /// Norm of the error's lengths (m); of desired velocities, of the part that is not realised
    /// (m/s).
    pub position_error: f64,
    /// Norm of the error's angles, and of the errors of custom tasks (rad); of desired velocities, of
    /// the part that is not realised (rad/s).
    pub orientation_error: f64,
    /// Share of its velocity that is realised; 1 when nothing stops it, 0 if its direction is lost.
    /// Postures and velocities have no direction to keep: 1.
    pub scale: f64,
    /// Share of the level's velocity that higher levels or singular directions leave out [-]; of
    /// postures and velocities, the share that is not realised.
    pub left_out: f64,
    /// The inequality that stops it, if one does.
    pub stopped_by: Option<StoppedBy>,
}

/// Checks that tasks and options define a controller.
pub(super) fn check(
    mechanism: &Mechanism,
    tasks: &[MotionTask],
    options: &TaskServoOptions,
) -> Result<()> {
    let refuse = |option, value: String, reason: &str| {
        Err(Error::InvalidOption { option, value, reason: reason.to_owned() })
    };
    if mechanism.n() == 0 {
        return refuse("mechanism", mechanism.name().to_owned(), "no joint moves");
    }
    check_coordinates("mechanism of a servo", mechanism.n())?;
    let positive = Error::check_positive;
    positive("dt", options.dt)?;
    mechanism.length_or(Some(options.length))?;
    for (option, most) in [("acceleration", options.acceleration), ("jerk", options.jerk)] {
        if !(most > 0.0) {
            let reason = "it must be positive; infinity means no limit";
            return refuse(option, most.to_string(), reason);
        }
    }
    options.plant.check(options.dt)?;
    if !(options.eps >= 0.0 && options.eps < 1.0) {
        return refuse("eps", options.eps.to_string(), "it must be in [0, 1)");
    }
    if !options.joint_weights.is_empty() {
        mechanism.check_q("joint weights", &options.joint_weights)?;
        options.joint_weights.iter().try_for_each(|w| positive("joint weight", *w))?;
    }
    if let Some(c) = &options.collisions
        && !c.model.fits(mechanism)
    {
        let name = c.model.mechanism().name();
        let reason = format!("the collision model is of '{name}'; make one of this mechanism");
        return refuse("collisions", mechanism.name().to_owned(), &reason);
    }
    if let Some(c) = &options.collisions {
        CollisionAvoidance::check_distances(c.gap, c.margin)?;
    }
    options.half_spaces.iter().try_for_each(|h| h.check(mechanism))?;
    for (i, task) in tasks.iter().enumerate() {
        task.objective.check(mechanism)?;
        if task.objective.needs_masses() {
            mechanism.check_masses()?;
        }
        if !task.objective.is_of_lowest_level() && task.objective.rows() == 0 {
            return refuse("tasks", task.name.clone(), "it has no rows");
        }
        if task.objective.rows() > MAX_ROWS {
            let value = format!("{} rows of '{}'", task.objective.rows(), task.name);
            return refuse("tasks", value, "a task has at most 1000");
        }
        positive("weight of a task", task.weight)?;
        for tolerance in [task.tolerance.position, task.tolerance.orientation] {
            if !(tolerance > 0.0) {
                let value = tolerance.to_string();
                return refuse("tolerance of a task", value, "it must be positive");
            }
        }
        if !(task.gain >= 0.0) {
            let value = task.gain.to_string();
            return refuse("gain of a task", value, "it must not be negative");
        }
        if task.gain * options.dt >= 2.0 {
            return refuse(
                "gain of a task",
                format!("{} 1/s with dt = {} s", task.gain, options.dt),
                "gain * dt must be below 2, or the error grows with every step",
            );
        }
        if tasks[..i].iter().any(|t| t.name == task.name) {
            return refuse(
                "tasks",
                task.name.clone(),
                "two tasks have this name; give one of them another",
            );
        }
    }
    Ok(())
}
