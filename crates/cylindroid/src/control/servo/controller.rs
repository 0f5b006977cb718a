//! The servo: one step from joint positions and a target pose to joint velocities.
//!
//! Formula  x = s gain * error + feed-forward, s of `approach.rs`, error = [p_d - p; log(R_d R^T)]
//!          (world axes), saturated at the speed limits, then projected (`projection.rs`);
//!          joint velocities = J+ x + P z: J+ the chosen inverse of the task Jacobian with linear
//!          rows divided by L, z the velocities of the secondary tasks, P the null-space projector;
//!          then position, velocity and acceleration limits (`limits.rs`, `solver/saturation.rs`)
//! Shapes   task m <= 6 components, n joints that move the end effector; velocities of all joints
//! Units    m, rad, s
//! Loops    closed chains are constrained by `coupled.rs`: the unknowns are the actuated motions
//! Valid    gain * dt < 2; any rank. No allocation, at most 4 n + 1 decompositions per step, and three of
//!          n x n for a target beyond reach; closed chains allocate
//! Fails    on non-finite input, and when the twist or the joint velocities overflow; on error the
//!          servo's state is unchanged
//! Source   course notes on Cartesian control, 7.1 to 7.5; limits: see the two files
//! Checked  tests/it/servo/, tests/allocation/main.rs

mod behind_plant;
pub(super) mod condition;
mod edge_aim;
mod escaping;
mod generic_rank;
mod moving_target;
mod stages;
mod tool_speed;
mod tracking;
mod turning_back;
mod velocity_mode;
mod verdict;

use super::coupled::Coupled;
use super::elsewhere::Elsewhere;
use super::escape::Escape;
use super::following::TargetFollower;
use super::inertia_weights::InertiaWeights;
use super::limits::{BrakingMargin, DefaultLimits, limits_of_servo};
use super::loop_edge::LoopEdge;
use super::loop_motions::nothing_actuated;
use super::nearest_pose::{EdgeAim, NearestPose};
use super::options::ServoOptions;
use super::plant::Predictor;
use super::projection::{StepProjection, TaskFrame};
use super::sensor_fit::SensorFit;
use super::stall::{Remainder, StallDetector};
use super::step::{Aim, Status, Step, Target};
use super::task_space::TaskSpace;
use super::twist_step::TwistFollower;
use crate::closure::check_coordinates;
use crate::control::solver::bounds::{LimitKind, VelocityBounds};
use crate::control::solver::saturation::{Saturation, Saturator};
use crate::error::{Error, Result};
use crate::inverse::{Method, is_kept};
use crate::kinematics::Chain;
use crate::linalg::{Matrix, Svd};
use crate::model::{Limits, Mechanism};
use crate::screws::NoInverse;
use crate::spatial::Pose;

/// A Cartesian controller for one end effector.
#[derive(Debug, Clone)]
pub struct Servo {
    mechanism: Mechanism,
    options: ServoOptions,
    /// The inverse used in this step.
    method: Method,
    chain: Chain,
    space: TaskSpace,
    limits: Vec<Limits>,
    braking_margins: Vec<BrakingMargin>,
    /// True if any joint has an acceleration or a jerk limit.
    accelerates: bool,
    /// Length of the chain after its first joint (m).
    length: f64,
    /// Rank of the task Jacobian at non-singular configurations.
    generic_rank: usize,

    task: Matrix,
    svd: Svd,
    gains: Vec<f64>,
    /// Directions with a gain times singular value of at least one half.
    kept: Vec<bool>,
    x: Vec<f64>,
    /// J times the joint velocities: the realised part of x.
    achieved_twist: Vec<f64>,
    error: Vec<f64>,
    /// The error after projection.
    projected_error: Vec<f64>,
    step_projection: StepProjection,
    primary: Vec<f64>,
    secondary: Vec<f64>,
    /// Bounds of the joint velocities, and the same in scaled coordinates.
    own_bounds: Vec<VelocityBounds>,
    bounds: Vec<VelocityBounds>,
    saturator: Saturator,
    /// Velocities of the last step, scaled.
    last: Vec<f64>,
    /// Derivatives of the Jacobian; trees only.
    hessian: Vec<Matrix>,
    /// Where targets may be beyond reach; trees of joints with one coordinate only.
    nearest_pose: Option<Box<NearestPose>>,
    elsewhere: Option<Box<Elsewhere>>,
    /// The same of closed chains.
    loop_edge: Option<Box<LoopEdge>>,
    /// The pose towards which the motion of this step ends, and its error.
    edge_aim: Option<EdgeAim>,
    edge_error: Vec<f64>,
    /// A target or twist at whose end the joints must rest, where they do, with the Jacobian, and a
    /// workspace.
    ending: Option<Aim>,
    rest_q: Vec<f64>,
    rest: Chain,
    rest_task: Matrix,
    trial: Vec<f64>,
    /// Closed chains only.
    coupled: Option<Box<Coupled>>,
    inertia: Option<Box<InertiaWeights>>,
    /// Trees only.
    escape: Option<Box<Escape>>,
    /// True if the last step stopped before a type II singularity.
    approaches_type_ii: bool,

    rates: Vec<f64>,
    /// Changes of the velocities in the last step, divided by its duration.
    accelerations: Vec<f64>,
    /// Of the last step, its loops closed; and a workspace.
    configuration: Vec<f64>,
    predicted: Vec<f64>,
    active: Vec<Option<LimitKind>>,
    at_limit: Vec<usize>,
    stall_detector: StallDetector,
    twist_follower: TwistFollower,
    last_target: Option<Pose>,
    follower: TargetFollower,
    distance: f64,
    /// Of a robot that is not ideal.
    predictor: Option<Box<Predictor>>,
    sensor_fit: Option<Box<SensorFit>>,
}

impl Servo {
    /// A servo at rest.
    ///
    /// # Errors
    /// Options that do not define a controller, see [`ServoOptions::check`]; a closed chain that
    /// cannot be assembled near its home configuration, or whose actuated joints do not control
    /// every motion of the end effector.
    pub fn new(mechanism: &Mechanism, options: ServoOptions) -> Result<Self> {
        options.check(mechanism)?;
        let chain = if mechanism.is_closed() {
            Chain::whole(mechanism, options.end_effector)
        } else {
            Chain::of(mechanism, options.end_effector)
        };
        let n = chain.n();
        if n == 0 {
            return Err(Error::Model {
                model: mechanism.name().to_owned(),
                culprit: mechanism.frame_of(options.end_effector.frame).name.clone(),
                message: format!(
                    "no joint moves frame '{}'; name another frame",
                    mechanism.frame_of(options.end_effector.frame).name
                ),
            });
        }
        check_coordinates("mechanism of a servo", n)?;
        let ServoOptions { acceleration, jerk, gain, ref plant, .. } = options;
        let (default, gain) =
            (DefaultLimits { acceleration, jerk }, gain.position.max(gain.orientation));
        let coordinates = chain.coordinates().iter().copied();
        let limits = limits_of_servo(mechanism, coordinates, plant, default, gain);
        let joint_weights = options.weights(mechanism);
        let space = TaskSpace::new(options.scaling(&joint_weights), &chain, &limits);
        let margin =
            |(i, l): (usize, &Limits)| BrakingMargin::new(l, options.dt, space.is_locked(i));
        let m = space.rows.len();
        let coupled = if mechanism.is_closed() {
            let locked = (0..n).filter(|&i| space.is_locked(i)).collect();
            Some(Box::new(Coupled::new(mechanism, &joint_weights, locked, m)?))
        } else {
            None
        };
        let weights = options.inertia_weights.then(|| InertiaWeights::new(mechanism));
        let inertia = weights.transpose()?.map(Box::new);
        let rates = limits.len();
        // The unknowns: joint velocities, or actuated motions.
        let unknowns = coupled.as_ref().map_or(n, |c| c.actuated_joints());
        if unknowns == 0 {
            return Err(nothing_actuated(mechanism));
        }
        let hessian = match coupled {
            Some(_) => Vec::new(),
            None => vec![Matrix::zeros(6, n); n],
        };
        let predictor = Predictor::new(mechanism, options.plant, options.dt).map(Box::new);
        let mut servo = Self {
            length: chain.length_after_first_joint(mechanism),
            generic_rank: 0,
            braking_margins: limits.iter().enumerate().map(margin).collect(),
            accelerates: limits.iter().any(|l| l.acceleration.min(l.jerk) < f64::INFINITY),
            mechanism: mechanism.clone(),
            method: options.method,
            options,
            space,
            limits,
            task: Matrix::zeros(m, unknowns),
            svd: Svd::workspace(m, unknowns),
            gains: vec![0.0; m.min(unknowns)],
            kept: vec![false; m.min(unknowns)],
            x: vec![0.0; m],
            achieved_twist: vec![0.0; m],
            error: vec![0.0; m],
            projected_error: vec![0.0; m],
            step_projection: StepProjection::new(),
            primary: vec![0.0; rates],
            secondary: vec![0.0; rates],
            own_bounds: vec![VelocityBounds::NONE; rates],
            bounds: vec![VelocityBounds::NONE; rates],
            saturator: Saturator::new(m, unknowns, coupled.is_some().then_some(rates)),
            hessian,
            last: vec![0.0; rates],
            nearest_pose: None,
            elsewhere: None,
            loop_edge: None,
            edge_aim: None,
            edge_error: vec![0.0; m],
            ending: None,
            rest_q: mechanism.home().to_vec(),
            rest: chain.clone(),
            rest_task: Matrix::zeros(m, n),
            trial: vec![0.0; rates],
            rates: vec![0.0; mechanism.n().max(rates)],
            accelerations: vec![0.0; mechanism.n().max(rates)],
            configuration: mechanism.home().to_vec(),
            predicted: mechanism.home().to_vec(),
            active: vec![None; rates],
            escape: coupled.is_none().then(|| Box::new(Escape::new(m, unknowns))),
            coupled,
            inertia,
            approaches_type_ii: false,
            at_limit: Vec::with_capacity(n),
            stall_detector: StallDetector::new(),
            twist_follower: TwistFollower::new(m),
            last_target: None,
            follower: TargetFollower::new(m),
            distance: 0.0,
            predictor,
            sensor_fit: None,
            chain,
        };
        servo.generic_rank = if let Some(coupled) = &servo.coupled {
            if !servo.options.inertia_weights && !servo.has_turning_axes() {
                let (chain, space) = (servo.chain.clone(), servo.space.clone());
                let edge = LoopEdge::new(mechanism, coupled.loops().loaded_copy()?, chain, space)?;
                servo.loop_edge = Some(Box::new(edge));
            }
            servo.find_actuated_rank()?
        } else {
            let length = servo.options.length;
            let nearest_pose = NearestPose::new(mechanism, &servo.chain, m, length);
            servo.elsewhere = nearest_pose.as_ref().and_then(Elsewhere::new).map(Box::new);
            servo.nearest_pose = nearest_pose.map(Box::new);
            servo.find_generic_rank()
        };
        Ok(servo)
    }

    /// One step: [`Servo::joint_velocities`] are to be commanded until the next step.
    ///
    /// ```
    /// use cylindroid::{Servo, ServoOptions, Vec3};
    ///
    /// let robot = cylindroid::load("panda")?;
    /// let mut servo = Servo::new(&robot, ServoOptions::new(&robot))?;
    /// let mut q = vec![0.3, -0.4, 0.1, -2.0, 0.2, 1.7, 0.5];
    /// let mut target = robot.state(&q)?.pose(robot.tool())?;
    /// target.translation = target.translation + Vec3::Z * 0.05;
    /// for _ in 0..1000 {
    ///     servo.step(&q, target)?; // command servo.joint_velocities() to the robot
    ///     servo.advance(&mut q); // in a simulation
    /// }
    /// let error = robot.state(&q)?.pose(robot.tool())?.error_to(target);
    /// assert!(error.linear.norm() < 0.05 * (-4.5_f64).exp()); // 1 s at a gain of 5/s
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A `q` of the wrong size or non-finite input; the servo is unchanged.
    pub fn step(&mut self, q: &[f64], target: impl Into<Target>) -> Result<Step> {
        self.step_with(q, target, &[])
    }

    /// [`Servo::step`] with additional joint velocities (all n, or empty), projected onto the null
    /// space like the secondary tasks: to move an elbow by hand, for example.
    ///
    /// # Errors
    /// As [`Servo::step`].
    pub fn step_with(
        &mut self,
        q: &[f64],
        target: impl Into<Target>,
        secondary_velocities: &[f64],
    ) -> Result<Step> {
        let target = target.into();
        self.mechanism.check_q("q", q)?;
        if !secondary_velocities.is_empty() {
            self.mechanism.check_q("secondary joint velocities", secondary_velocities)?;
        }
        target.check()?;
        self.step_towards(q, Aim::Target(target), secondary_velocities)
    }

    /// A step of a robot that does as it is told.
    fn step_ideal(&mut self, q: &[f64], aim: Aim, secondary_velocities: &[f64]) -> Result<Step> {
        let pose = self.load_configuration(q)?;
        let target = aim.target(pose);
        let desired = target.desired(pose, &self.options)?;
        self.load_jacobian(q)?;
        self.svd.decompose_warm(&self.task);
        if self.svd.values().any(f64::is_nan) {
            Error::check_finite("Jacobian of the task", self.task.as_slice())?;
        }
        let (axes, length) = (self.options.task.axes, self.options.length);
        self.step_projection.load(
            self.options.projection_choice(),
            &self.svd,
            TaskFrame { pose, axes, length },
        );
        self.distance = (target.pose.translation - self.chain.first_origin()).norm();
        self.load_task(&desired);
        for ((kept, gain), s) in self.kept.iter_mut().zip(&self.gains).zip(self.svd.values()) {
            *kept = is_kept(gain * s);
        }
        let rank = self.kept.iter().filter(|kept| **kept).count();
        self.load_secondary(secondary_velocities);
        self.load_edge_aim(&target, pose);
        self.search_edge(q)?;
        self.load_ending(aim);

        let (saturation, braking) = match self.store_unlimited_rates(q, rank) {
            Some(braking) => (Saturation::NONE, braking),
            None => self.store_limited_rates(q, aim.is_rest())?,
        };

        self.note_configuration(q);
        let is_left_behind = self.follow(&target, &desired, pose, braking);
        let (position_error, orientation_error) =
            (desired.error.linear.norm(), desired.error.angular.norm());
        let left = Remainder {
            position: position_error,
            orientation: orientation_error,
            length: self.options.length,
            gain: self.options.gain,
            is_out_of_reach: self.is_out_of_reach(),
        };
        let rests = self.stall_detector.stalled(left, braking, self.options.dt);
        let stalled = rests || is_left_behind;
        let mut step = Step {
            status: Status::Moving,
            pose,
            position_error,
            orientation_error,
            lag: self.follower.lag,
            singular_ratio: self.svd.singular_ratio(),
            rank,
            saturation,
        };
        if self.is_near(step) && self.settled(desired.feed_forward) {
            step.status = Status::Reached;
        } else if stalled || self.is_stopped() {
            step.status = Status::Stalled;
        }
        Ok(step)
    }

    /// Joint velocities of the last step, of all n coordinates [rad/s or m/s]: actuated and passive
    /// ones in a closed chain.
    #[doc(alias = "rates")]
    #[must_use]
    pub fn joint_velocities(&self) -> &[f64] {
        &self.rates[..self.mechanism.n()]
    }

    /// Velocities of actuated loop-closure joints, in the order of `Mechanism::loops` [rad/s or
    /// m/s].
    #[must_use]
    pub fn loop_closure_velocities(&self) -> &[f64] {
        &self.rates[self.mechanism.n()..]
    }

    /// The limits that bounded a joint velocity in the last step: index in `q` and kind.
    pub fn active_limits(&self) -> impl Iterator<Item = (usize, LimitKind)> + '_ {
        self.chain
            .coordinates()
            .iter()
            .zip(&self.active)
            .filter_map(|(&c, kind)| kind.map(|k| (c, k)))
    }

    /// The reason why the requested projection was not used in the last step, but its fallback, or
    /// why the arm was stopped.
    #[must_use]
    pub fn no_inverse(&self) -> Option<NoInverse> {
        self.step_projection.reason()
    }

    /// True if the last step stopped the arm because neither the projection nor a fallback exists,
    /// or before a type II singularity, where the object would gain an uncontrolled motion.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.step_projection.is_stopped() || self.approaches_type_ii
    }

    /// The options.
    #[must_use]
    pub fn options(&self) -> &ServoOptions {
        &self.options
    }

    /// The mechanism.
    #[must_use]
    pub fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// Resets the servo to rest: clears the last joint velocities and the target.
    pub fn reset(&mut self) {
        self.rates.fill(0.0);
        self.accelerations.fill(0.0);
        self.stall_detector = StallDetector::new();
        self.last_target = None;
        self.follower.reset();
        self.twist_follower.reset();
        self.approaches_type_ii = false;
        if let Some(predictor) = &mut self.predictor {
            predictor.reset();
        }
        if let Some(escape) = &mut self.escape {
            escape.reset();
        }
        if let Some(nearest_pose) = &mut self.nearest_pose {
            nearest_pose.reset();
        }
        if let Some(elsewhere) = &mut self.elsewhere {
            elsewhere.reset();
        }
        if let Some(edge) = &mut self.loop_edge {
            edge.reset();
        }
    }

    /// Integrates `q` by the joint velocities of the last step, for the simulation of an ideal robot;
    /// the passive joints of a closed chain are assembled.
    ///
    /// # Panics
    /// If `q` is shorter than the mechanism's number of coordinates.
    pub fn advance(&self, q: &mut [f64]) {
        self.mechanism.integrate_in_place(q, self.joint_velocities(), self.options.dt);
        self.close(q);
    }

    /// Assembles the loops near `q`.
    pub(in crate::control) fn close(&self, q: &mut [f64]) {
        if let Some(coupled) = &self.coupled {
            coupled.close(q);
        }
    }

    /// The coordinates that move the end effector: indices in `q`, ascending.
    #[must_use]
    pub fn coordinates(&self) -> &[usize] {
        self.chain.coordinates()
    }

    /// Those of them that are not locked by their limits.
    pub(in crate::control) fn free_coordinates(&self) -> impl Iterator<Item = usize> + '_ {
        let free = |(i, _): &(usize, &usize)| !self.space.is_locked(*i);
        self.coordinates().iter().enumerate().filter(free).map(|(_, &c)| c)
    }
}
