//! The servo of a session while it avoids collisions: the same task with distances to keep.

use cylindroid::collision::CollisionModel;
use cylindroid::control::{
    CollisionAvoidance, LimitKind, MotionTask, SecondaryTask, Stall, Status, StoppedBy,
    TaskObjective, TaskServo, TaskServoOptions,
};
use cylindroid::{Mechanism, Pose, Result, Servo, ServoOptions, Twist};

/// Distances that are kept where none are given (m).
pub(super) const GAP: f64 = 0.01;
pub(super) const MARGIN: f64 = 0.3;

/// Without progress for this long (s), a motion has stalled.
const WINDOW: f64 = 1.0;
/// Smallest share by which an error must fall to count as progress.
const SHARE: f64 = 1e-3;

/// Slower joints stand [rad/s or m/s].
const AT_REST: f64 = 1e-4;

/// Names of the tasks.
const TOOL: &str = "tool";
const SELF_MOTION: &str = "self-motion";

/// The last step of a servo.
#[derive(Debug)]
pub(super) struct LastStep {
    pub(super) status: Status,
    pub(super) stall: Option<Stall>,
    /// The bodies whose distance stops the motion.
    pub(super) pair: Option<[String; 2]>,
}

/// A servo that avoids collisions.
#[derive(Debug)]
pub(super) struct Avoidance {
    servo: TaskServo,
    /// Number of tasks of the lowest level, whose mean counts.
    lowest: f64,
    target: Pose,
    /// Smallest error since the target or an obstacle moved, and the time since then (s).
    best: f64,
    since: f64,
    /// The pair that stops the motion. At rest its row in the servo is now and then inactive.
    pair: Option<usize>,
}

impl Avoidance {
    /// For the task of `options`; keeps `gap` (m) between bodies that are closer than `margin` (m).
    ///
    /// # Errors
    /// Distances that are not in order; a closed chain without actuated joints.
    pub(super) fn new(
        mechanism: &Mechanism,
        options: &ServoOptions,
        target: Pose,
        model: CollisionModel,
        (gap, margin): (f64, f64),
    ) -> Result<Self> {
        CollisionAvoidance::check_distances(gap, margin)?;
        let tool = TaskObjective::Frame {
            end_effector: options.end_effector,
            components: options.task,
            target: target.into(),
        };
        let at_rest = TaskObjective::JointVelocities { velocities: vec![0.0; mechanism.n()] };
        let mut tasks = vec![MotionTask {
            gain: options.gain.position,
            tolerance: options.tolerance,
            ..MotionTask::new(TOOL, tool)
        }];
        let mut lowest = vec![MotionTask::new(SELF_MOTION, at_rest)];
        for secondary in &options.secondary {
            if let SecondaryTask::LimitAvoidance { gain, margin } = *secondary {
                let objective = TaskObjective::LimitAvoidance { margin };
                lowest.push(MotionTask { gain, ..MotionTask::new(secondary.name(), objective) });
            }
        }
        let count = lowest.len() as f64;
        // The mean counts, but their sum is desired.
        lowest.iter_mut().for_each(|task| task.gain *= count);
        tasks.extend(lowest);
        let own = TaskServoOptions {
            dt: options.dt,
            length: options.length,
            acceleration: options.acceleration.unwrap_or(f64::INFINITY),
            jerk: options.jerk,
            collisions: Some(CollisionAvoidance { model, gap, margin }),
            ..TaskServoOptions::new(mechanism)
        };
        let servo = TaskServo::new(mechanism, tasks, own)?;
        Ok(Self { servo, lowest: count, target, best: f64::INFINITY, since: 0.0, pair: None })
    }

    /// The bodies and the obstacles; the motion is judged anew.
    pub(super) fn model_mut(&mut self) -> Option<&mut CollisionModel> {
        self.renew();
        self.servo.collision_model_mut()
    }

    pub(super) fn active_limits(&self) -> impl Iterator<Item = (usize, LimitKind)> + '_ {
        self.servo.active_limits()
    }

    pub(super) fn joint_velocities(&self) -> &[f64] {
        self.servo.joint_velocities()
    }

    /// To rest.
    pub(super) fn reset(&mut self) {
        self.servo.reset();
        self.renew();
    }

    fn renew(&mut self) {
        (self.best, self.since, self.pair) = (f64::INFINITY, 0.0, None);
    }

    /// One step to the target, with the joint velocities of a self-motion (all or none); moves `q`.
    /// `without` is the servo without distances, which explains a stall that no distance causes.
    ///
    /// # Errors
    /// As [`TaskServo::step`].
    pub(super) fn step(
        &mut self,
        without: &mut Servo,
        q: &mut [f64],
        target: Pose,
        self_motion: &[f64],
    ) -> Result<LastStep> {
        if target != self.target {
            self.target = target;
            self.renew();
        }
        if let TaskObjective::Frame { target: of, .. } = self.servo.objective_mut(TOOL)? {
            *of = target.into();
        }
        self.set_self_motion(self_motion)?;
        self.servo.step(q)?;
        let report = self.servo.reports()[0];
        let error = report.position_error + report.orientation_error;
        if error < self.best * (1.0 - SHARE) {
            (self.best, self.since, self.pair) = (error, 0.0, None);
        } else {
            self.since += self.servo.dt();
        }
        match report.stopped_by {
            Some(StoppedBy::Distance { pair }) => self.pair = Some(pair),
            Some(_) => self.pair = None,
            None => {}
        }
        let status = match report.status {
            Status::Reached => Status::Reached,
            _ if self.since > WINDOW => Status::Stalled,
            _ => Status::Moving,
        };
        let stops = self.pair.filter(|_| status != Status::Reached);
        let model = self.servo.collision_model();
        let pair = stops.zip(model).map(|(pair, model)| model.names(pair).map(str::to_owned));
        let mut stall = None;
        if status == Status::Stalled && pair.is_none() {
            without.step(q, target)?;
            stall = Some(without.stall());
            without.reset();
        }
        self.servo.advance(q);
        Ok(LastStep { status, stall, pair })
    }

    /// One step along a twist (world axes, at the tool), without a target; moves `q`.
    ///
    /// # Errors
    /// As [`TaskServo::step`].
    pub(super) fn follow(&mut self, q: &mut [f64], twist: Twist) -> Result<LastStep> {
        let mut tool = None;
        if let TaskObjective::Frame { target, end_effector, .. } = self.servo.objective_mut(TOOL)? {
            tool = Some(*end_effector);
            target.feed_forward = twist;
        }
        // From where the tool is.
        if let Some(tool) = tool {
            let pose = self.servo.mechanism().state(q)?.pose(tool)?;
            if let TaskObjective::Frame { target, .. } = self.servo.objective_mut(TOOL)? {
                target.pose = pose;
            }
        }
        self.set_self_motion(&[])?;
        self.servo.step(q)?;
        let stopped_by = self.servo.reports()[0].stopped_by;
        let mut last = LastStep { status: Status::Moving, stall: None, pair: None };
        if let (Some(StoppedBy::Distance { pair }), Some(model)) =
            (stopped_by, self.servo.collision_model())
        {
            last.pair = Some(model.names(pair).map(str::to_owned));
            if self.servo.joint_velocities().iter().all(|rate| rate.abs() < AT_REST) {
                last.status = Status::Stalled;
            }
        }
        self.servo.advance(q);
        // The next target begins anew.
        self.renew();
        Ok(last)
    }

    fn set_self_motion(&mut self, rates: &[f64]) -> Result<()> {
        let share = self.lowest;
        if let TaskObjective::JointVelocities { velocities } =
            self.servo.objective_mut(SELF_MOTION)?
        {
            velocities.fill(0.0);
            velocities.iter_mut().zip(rates).for_each(|(v, own)| *v = share * own);
        }
        Ok(())
    }
}
