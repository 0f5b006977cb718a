//! The servo of many tasks: one step from joint positions to joint velocities.
//!
//! Formula  level by level min |W (J q' - K e - feed-forward)|, each on what the levels before leave
//!          free, its tasks scaled along their directions before they are bent (`solver/hierarchy.rs`); last the
//!          joint velocities nearest to the postures. Inequalities stand above all levels:
//!          position, velocity and acceleration limits (`limits.rs`), and for every near pair of
//!          bodies  g q' >= -v(d - gap),  v the velocity from which the pair stops in that distance;
//!          and braking from any velocity ends without contact (`braking.rs`) and before a task
//!          turns back (`braking_in_time.rs`)
//! Shapes   n joint velocities, the sum of the tasks' rows
//! Units    rows of lengths are divided by the characteristic length
//! Valid    trees and closed chains: arms, hands, several arms, mobile and floating bases, objects
//! Cost     a level of m rows that can be performed orthogonalises m x n once, any other once for each
//!          round of its active set, and again for each level whose direction changes. No
//!          allocation, in closed chains away from type II singularities
//! Fails    on non-finite input. Where limits and distances contradict one another, distances give way as
//!          little as possible; where limits do (closed chains), all joints brake
//! Source   Escande, Mansard & Wieber 2014; Faverjon & Tournassoud 1987 (velocity dampers)
//! Checked  tests/it/servo/tasks.rs, tests/allocation/main.rs

use super::braking_path::BrakingPath;
use super::escape::Escape;
use super::frame_curvature::FrameCurvature;
use super::gradient::Gradient;
use super::levels::{Stack, TaskRows};
use super::motions::{JerkBounds, Motions};
use super::objective::{Rows, Scratch, TaskObjective};
use super::options::{MOST_PAIRS, MotionTask, StoppedBy, TaskReport, TaskServoOptions, check};
use super::turning_back::TurningBack;
use super::twist_command::TwistCommand;
use crate::collision::{CollisionModel, NearPair};
use crate::control::servo::{
    BrakingState, DefaultLimits, Plant, Predictor, Remainder, ServoGains, StallDetector, Status,
    acceleration_of, limits_of_servo,
};
use crate::control::solver::active_set::ActiveSet;
use crate::control::solver::bounds::{LimitKind, VelocityBounds};
use crate::control::solver::inequalities::Inequalities;
use crate::error::{Error, Result};
use crate::kinematics::State;
use crate::linalg::{Matrix, norm};
use crate::model::{Limits, Mechanism};
use crate::spatial::Twist;
use crate::task::HalfSpace;

/// Share of its gain at which the error of a task falls while it follows its target, and of a twist that
/// is followed [-].
const FOLLOWED: f64 = 0.1;

/// A controller of any number of tasks with priorities, inside limits and outside of collisions.
///
/// ```text
/// for each level:  min |W (J q' - K e - feed-forward)|  on what the levels before leave free
/// always:          position, velocity and acceleration limits,  g q' >= -v(d - gap)
/// ```
///
/// J and e are the stacked Jacobians and errors of the level's tasks, K their gains, W the roots of
/// their weights; d the distance of a near pair of bodies, g its gradient.
///
/// ```
/// use cylindroid::control::{MotionTask, TaskObjective, TaskServo, TaskServoOptions, Target};
/// use cylindroid::ik::Task;
/// use cylindroid::{FrameId, Pose, Vec3};
///
/// // The hand first, the elbow as far as the hand permits.
/// let panda = cylindroid::load("panda")?;
/// let mut q = panda.home().to_vec();
/// let state = panda.state(&q)?;
/// let elbow = panda.frame("link4")?;
/// let frame = |of: FrameId, components, way| {
///     let pose = state.pose(of)?;
///     let target = Target::from(Pose { translation: pose.translation + way, ..pose });
///     cylindroid::Result::Ok(TaskObjective::Frame { end_effector: of.into(), components, target })
/// };
/// let tasks = vec![
///     MotionTask::new("hand", frame(panda.tool(), Task::POSE, Vec3::X * 0.05)?),
///     MotionTask::new("elbow", frame(elbow, Task::POSITION, Vec3::Y * 0.2)?).at_level(1),
/// ];
/// let mut servo = TaskServo::new(&panda, tasks, TaskServoOptions::new(&panda))?;
/// for _ in 0..3000 {
///     servo.step(&q)?;
///     servo.advance(&mut q);
/// }
/// assert!(servo.reports()[0].position_error < 1e-5 && servo.reports()[1].position_error > 0.01);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// Source: Escande, Mansard & Wieber 2014; Faverjon & Tournassoud 1987.
#[doc(alias = "whole-body control")]
#[doc(alias = "stack of tasks")]
#[derive(Debug, Clone)]
pub struct TaskServo {
    pub(super) options: TaskServoOptions,
    pub(super) tasks: Vec<MotionTask>,
    /// Of tasks that follow one instead of their target.
    pub(super) twists: Vec<Option<TwistCommand>>,
    pub(super) state: State,
    scratch: Scratch,
    pub(super) rows: Vec<TaskRows>,
    pub(super) stacks: Vec<Stack>,
    pub(super) set: ActiveSet,
    /// Memory for the gradients of tasks.
    pub(super) gradients: Vec<Option<Gradient>>,
    pub(super) motions: Motions,
    /// Of the coordinates, then of actuated loop joints.
    pub(super) limits: Vec<Limits>,
    pub(super) bounds: Vec<VelocityBounds>,
    pub(super) near: Vec<NearPair>,
    /// Of a distance, over the coordinates and over the unknowns; the Jacobian of a half-space.
    pub(super) gradient: Vec<f64>,
    /// The coordinates that move what a distance measures.
    pub(super) moving: Vec<bool>,
    pub(super) entries: Vec<f64>,
    pub(super) jacobian: Matrix,
    pub(super) last: Vec<f64>,
    /// Bounds of the distances before they give way; unknowns at rest.
    pub(super) strict: Vec<f64>,
    pub(super) rest: Vec<f64>,
    /// Inequalities that stop the tasks of a level, with the signs of their bounds.
    pub(super) stops: Vec<(usize, f64)>,
    pub(super) desired: Vec<f64>,
    /// The inequality that stops postures and desired velocities.
    pub(super) lowest_stopped_by: Option<StoppedBy>,
    pub(super) rates: Vec<f64>,
    /// Of the step before, and those that tasks of the lowest level ask for.
    pub(super) before: Vec<f64>,
    /// Changes of the velocities in the last step, divided by its duration.
    pub(super) accelerations: Vec<f64>,
    /// With limits of the jerk, the velocities that the tasks ask for.
    pub(super) desired_rates: Option<Vec<f64>>,
    pub(super) braking: BrakingPath,
    pub(super) lowest_velocities: Vec<f64>,
    /// From configurations in which the first level is lost, where it can.
    pub(super) escape: Option<Box<Escape>>,
    /// Of joints with acceleration limits.
    pub(super) turning_back: Option<Box<TurningBack>>,
    /// Unknowns that `solve_aim` approaches.
    pub(super) aim: Vec<f64>,
    reports: Vec<TaskReport>,
    detectors: Vec<StallDetector>,
    last_targets: Vec<Vec<f64>>,
    /// Of a robot that is not ideal.
    predictor: Option<Predictor>,
}

impl TaskServo {
    /// A servo at rest.
    ///
    /// # Errors
    /// Tasks or options that define no controller, named; a closed chain without actuated joints.
    pub fn new(
        mechanism: &Mechanism,
        tasks: Vec<MotionTask>,
        options: TaskServoOptions,
    ) -> Result<Self> {
        check(mechanism, &tasks, &options)?;
        let n = mechanism.n();
        let TaskServoOptions { acceleration, jerk, ref plant, .. } = options;
        let default = DefaultLimits { acceleration: Some(acceleration), jerk };
        let gain = tasks.iter().map(|task| task.gain).fold(0.0, f64::max);
        let limits = limits_of_servo(mechanism, 0..n, plant, default, gain);
        let has_jerks = limits.iter().any(|l| l.jerk < f64::INFINITY);
        let desired_rates = has_jerks.then(|| vec![0.0; limits.len()]);
        let motions = Motions::new(mechanism, &options, &limits)?;
        let (u, v) = (motions.unknowns(), limits.len());
        let rows = tasks.iter().map(|task| TaskRows::new(&task.objective, n)).collect();
        // Directions that are kept are damped alike.
        let is_bent = !options.keep_directions;
        let stacks = Stack::of_levels(&tasks, u, |objective| {
            is_bent.then(|| FrameCurvature::of(objective, mechanism, &limits, &options)).flatten()
        });
        let pairs = if options.collisions.is_some() { MOST_PAIRS } else { 0 };
        let distances = options.half_spaces.len() + pairs;
        let limit_rows = motions.limit_rows();
        let inequalities = Inequalities::new(u, limit_rows == 0, limit_rows + distances);
        let length = options.length;
        let capacity = options.collisions.as_ref().map_or(0, |c| c.model.pairs().len());
        let mut last_targets = vec![Vec::new(); tasks.len()];
        for (task, last) in tasks.iter().zip(&mut last_targets) {
            task.objective.has_moved(last);
        }
        let report = TaskReport {
            status: Status::Moving,
            position_error: 0.0,
            orientation_error: 0.0,
            scale: 1.0,
            left_out: 0.0,
            stopped_by: None,
        };
        Ok(Self {
            state: mechanism.state(mechanism.home())?,
            scratch: Scratch::new(mechanism, tasks.iter().any(|t| t.objective.needs_masses())),
            rows,
            set: ActiveSet::new(u, inequalities),
            gradients: tasks.iter().map(|t| t.objective.gradient(mechanism, length)).collect(),
            turning_back: TurningBack::new(mechanism, &motions, &limits, &tasks)?.map(Box::new),
            limits,
            bounds: vec![VelocityBounds::NONE; v],
            near: Vec::with_capacity(capacity + MOST_PAIRS),
            gradient: vec![0.0; n],
            moving: vec![false; n],
            entries: vec![0.0; u],
            jacobian: Matrix::zeros(6, n),
            last: vec![0.0; u],
            strict: vec![0.0; distances],
            rest: vec![0.0; u],
            stops: Vec::with_capacity(u),
            desired: vec![0.0; u],
            lowest_stopped_by: None,
            rates: vec![0.0; v],
            before: vec![0.0; v],
            accelerations: vec![0.0; v],
            desired_rates,
            braking: BrakingPath::new(mechanism, &motions, capacity)?,
            lowest_velocities: vec![0.0; n],
            escape: Escape::new(mechanism, &motions, &tasks, &stacks).map(Box::new),
            aim: vec![0.0; u],
            reports: vec![report; tasks.len()],
            detectors: vec![StallDetector::new(); tasks.len()],
            last_targets,
            twists: vec![None; tasks.len()],
            predictor: Predictor::new(mechanism, options.plant, options.dt),
            stacks,
            motions,
            tasks,
            options,
        })
    }

    /// The tasks, in the order of the reports.
    #[must_use]
    pub fn tasks(&self) -> &[MotionTask] {
        &self.tasks
    }

    /// The objective of the task of this name, to move its target. The number of its rows must stay. A
    /// twist that it follows ends.
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest names.
    pub fn objective_mut(&mut self, name: &str) -> Result<&mut TaskObjective> {
        let place = self.place(name)?;
        self.twists[place] = None;
        Ok(&mut self.tasks[place].objective)
    }

    /// The collision model, if distances are kept.
    #[must_use]
    pub fn collision_model(&self) -> Option<&CollisionModel> {
        self.options.collisions.as_ref().map(|c| &c.model)
    }

    /// The collision model, to add, move and remove obstacles while the servo runs.
    pub fn collision_model_mut(&mut self) -> Option<&mut CollisionModel> {
        self.options.collisions.as_mut().map(|c| &mut c.model)
    }

    /// The half-spaces that tool points do not leave.
    #[must_use]
    pub fn half_spaces(&self) -> &[HalfSpace] {
        &self.options.half_spaces
    }

    /// Joint velocities of the last step, of all n coordinates [rad/s or m/s]: actuated and passive
    /// ones in a closed chain.
    #[must_use]
    pub fn joint_velocities(&self) -> &[f64] {
        &self.rates[..self.mechanism().n()]
    }

    /// The tasks after the last step.
    #[must_use]
    pub fn reports(&self) -> &[TaskReport] {
        &self.reports
    }

    /// Time between steps (s).
    #[must_use]
    pub const fn dt(&self) -> f64 {
        self.options.dt
    }

    /// The mechanism.
    #[must_use]
    pub fn mechanism(&self) -> &Mechanism {
        self.state.mechanism()
    }

    /// Integrates `q` by the joint velocities of the last step, for simulation; the loops of a closed
    /// chain are assembled again.
    ///
    /// # Panics
    /// If `q` is shorter than the mechanism's number of coordinates.
    pub fn advance(&self, q: &mut [f64]) {
        self.mechanism().integrate_in_place(q, self.joint_velocities(), self.options.dt);
        self.motions.close(q);
    }

    pub(super) fn close(&self, q: &mut [f64]) {
        self.motions.close(q);
    }

    pub(super) const fn plant(&self) -> Plant {
        self.options.plant
    }

    /// Resets the servo to rest: it is as a new one with the present tasks.
    pub fn reset(&mut self) {
        self.rates.fill(0.0);
        self.accelerations.fill(0.0);
        self.braking.reset();
        self.escape.iter_mut().for_each(|escape| escape.reset());
        self.predictor.iter_mut().for_each(Predictor::reset);
        self.detectors.fill(StallDetector::new());
        self.twists.fill(None);
        self.set.reset();
        for stack in &mut self.stacks {
            stack.level.reset();
            stack.turned.reset();
        }
    }

    /// One step: [`TaskServo::joint_velocities`] are to be commanded until the next step. Reached if
    /// all tasks are, otherwise the status of the first that is not. Postures and desired velocities
    /// count only where there are no other tasks.
    ///
    /// # Errors
    /// A `q` of the wrong size or non-finite input, or with loops that are open; targets of another mechanism or with another
    /// number of rows than at the start; errors of custom tasks. The joint velocities are unchanged.
    pub fn step(&mut self, q: &[f64]) -> Result<Status> {
        for (task, rows) in self.tasks.iter().zip(&self.rows) {
            task.objective.check(self.state.mechanism())?;
            if task.objective.rows() != rows.error.len() {
                let what = format!("rows of the task '{}'", task.name);
                Error::check_len(&what, rows.error.len(), task.objective.rows())?;
            }
        }
        self.state.set(self.motions.close_measured(q)?)?;
        self.load_twists();
        self.evaluate()?;
        for rows in &mut self.rows {
            rows.measured_error.copy_from_slice(&rows.error);
        }
        if let Some(predictor) = &mut self.predictor {
            predictor.note(self.state.q());
            let (lag, mechanism) = (predictor.plant().lag(), self.state.mechanism());
            predictor.predict(mechanism, |q, from| self.motions.close_ahead(q, from))?;
            predictor.keep_off(mechanism, 0.., &mut self.limits);
            self.state.set(self.motions.close_measured(predictor.q())?)?;
            self.evaluate()?;
            // To the target after that time.
            for rows in &mut self.rows {
                let places = rows.error.iter_mut().zip(&rows.feed_forward);
                places.for_each(|(error, forward)| *error += lag * forward);
            }
        }
        self.motions.load(&self.rows, self.options.length, self.options.dt)?;
        self.load_bounds(JerkBounds::None);
        self.load_distances()?;
        self.load_desired();
        self.solve_within_limits(Self::solve);
        let achieved = self.escape()?;
        let slows = !self.leaves() && self.brake_in_time()?;
        Error::check_finite("joint velocities", &self.last)?;
        let braking = self.store()?;
        self.record_progress(achieved, braking.accelerating || slows);
        if let Some(predictor) = &mut self.predictor {
            let mechanism = self.state.mechanism();
            predictor.record(mechanism, &self.rates[..mechanism.n()]);
        }
        self.report(braking);
        self.age_twists();
        Ok(self.status())
    }

    /// Error, feed-forward velocity and Jacobian of all tasks at the configuration of the state.
    pub(super) fn evaluate(&mut self) -> Result<()> {
        for (task, rows) in self.tasks.iter_mut().zip(&mut self.rows) {
            let mut rows = Rows {
                error: &mut rows.error,
                feed_forward: &mut rows.feed_forward,
                jacobian: &mut rows.jacobian,
            };
            task.objective.evaluate(&task.name, &self.state, &mut self.scratch, &mut rows)?;
        }
        Ok(())
    }

    /// The status of all tasks after the last step, as [`TaskServo::step`] returns it.
    #[must_use]
    pub fn status(&self) -> Status {
        let counts = |task: &MotionTask| self.stacks.is_empty() || task.objective.rows() > 0;
        let pairs = self.tasks.iter().zip(&self.reports).filter(|(task, _)| counts(task));
        let open = pairs.map(|(_, report)| report.status).find(|s| *s != Status::Reached);
        open.unwrap_or(Status::Reached)
    }

    /// The limits that bounded a joint velocity in the last step: index in `q` and kind.
    pub fn active_limits(&self) -> impl Iterator<Item = (usize, LimitKind)> + '_ {
        let all = self.bounds.iter().zip(&self.rates).enumerate();
        all.filter_map(|(i, (bound, rate))| Some((i, bound.met(*rate)?)))
    }

    /// The pairs of bodies that counted in the last step, at the configuration before it: nearer than
    /// the margin, at most 64. Indices are those of the collision model before later changes.
    #[must_use]
    pub fn near(&self) -> &[NearPair] {
        &self.near
    }

    /// Stores the joint velocities, within the limits to the last bit.
    fn store(&mut self) -> Result<BrakingState> {
        let before = &mut self.before;
        before.copy_from_slice(&self.rates);
        self.motions.velocities(&self.last, &self.bounds, &mut self.rates);
        let (length, dt) = (self.options.length, self.options.dt);
        if self.motions.approaches_type_ii(&self.rates, &self.rows, length, dt)? {
            // Towards rest.
            self.last.fill(0.0);
            if self.set.start(&self.last) {
                self.last.copy_from_slice(self.set.point());
            }
            self.motions.velocities(&self.last, &self.bounds, &mut self.rates);
            for member in self.stacks.iter_mut().flat_map(|s| &mut s.members) {
                (member.scale, member.stopped_by) = (0.0, Some(StoppedBy::TypeII));
            }
            self.lowest_stopped_by = Some(StoppedBy::TypeII);
        }
        self.keep_braking_clear()?;
        let mut braking = BrakingState::default();
        for (i, rate) in self.rates.iter().enumerate() {
            let (acceleration, limits) = (&mut self.accelerations[i], &self.limits[i]);
            *acceleration = acceleration_of(limits, *acceleration, rate - self.before[i], dt);
            braking.add(limits, self.bounds[i].met(*rate), [self.before[i], *rate]);
        }
        Ok(braking)
    }

    fn report(&mut self, braking: BrakingState) {
        let size = norm(&self.desired);
        let missing = self.desired.iter().zip(self.set.point()).map(|(d, y)| (d - y) * (d - y));
        let missing = missing.sum::<f64>().sqrt();
        let lowest_left_out = if size > 0.0 { (missing / size).min(1.0) } else { 0.0 };
        for (i, task) in self.tasks.iter().enumerate() {
            let rows = &self.rows[i];
            let mut parts = [0.0_f64; 2];
            let mut add = |is_length: bool, x: f64| parts[usize::from(!is_length)] += x * x;
            let (gradient, rates) = (self.gradients[i].as_ref(), &self.rates);
            let out = &mut self.gradient;
            let is_lowest = task.objective.remainder(&self.state, gradient, rates, out);
            if is_lowest {
                let coordinates = self.state.mechanism().coordinates();
                let all = self.gradient.iter().zip(coordinates);
                all.for_each(|(x, coordinate)| add(coordinate.kind.is_length(), *x));
            }
            let own = rows.measured_error.iter().enumerate();
            own.for_each(|(r, x)| add(task.objective.is_length(r), *x));
            let [position_error, orientation_error] = parts.map(f64::sqrt);
            let own = |stack: &Stack| stack.members.iter().position(|m| m.task == i);
            let member = self.stacks.iter().find_map(|s| Some((s, &s.members[own(s)?])));
            let follows = self.twists[i].is_some_and(|twist| twist.desired() != Twist::ZERO);
            let reached = !follows
                && position_error <= task.tolerance.position
                && orientation_error <= task.tolerance.orientation;
            // Towards a target that moves the error may grow although the task is followed; along a
            // twist there is none.
            let has_moved = task.objective.has_moved(&mut self.last_targets[i]);
            let length = self.options.length;
            let is_followed = if follows {
                rows.followed(&self.rates, length) >= FOLLOWED
            } else {
                has_moved && rows.progress(&self.rates, length) >= FOLLOWED * task.gain
            };
            if is_followed {
                self.detectors[i] = StallDetector::new();
            }
            let left = Remainder {
                position: position_error,
                orientation: orientation_error,
                length,
                gain: ServoGains { position: task.gain, orientation: task.gain },
                is_out_of_reach: false,
            };
            let stalled = self.detectors[i].stalled(left, braking, self.options.dt);
            let status = match (reached, stalled) {
                (true, _) => Status::Reached,
                (false, true) => Status::Stalled,
                (false, false) => Status::Moving,
            };
            self.reports[i] = TaskReport {
                status,
                position_error,
                orientation_error,
                scale: member.map_or(1.0, |(_, m)| m.scale),
                left_out: member.map_or(lowest_left_out, |(stack, _)| stack.left_out),
                stopped_by: member.map_or(self.lowest_stopped_by, |(_, m)| m.stopped_by),
            };
        }
    }
}
