//! A session: configuration, target and servo.
//!
//! Independent of sockets and real time: messages change it, and steps move it.

mod collisions;
mod elsewhere;
mod followed;
mod reloaded;
mod twist_command;
mod velocity_mode;

use std::sync::Arc;

use cylindroid::closure::frame_twists;
use cylindroid::control::{LimitKind, Status, Target};
use cylindroid::ik::Task;
use cylindroid::model::FrameId;
use cylindroid::screws::{ScrewOptions, ScrewSystem};
use cylindroid::{Error, Mechanism, Pose, Result, Servo, ServoOptions, State};

use super::assets::Folders;
use super::avoidance::{Avoidance, GAP, LastStep, MARGIN};
use super::beside::ModelBeside;
use super::bodies::Bodies;
use super::inverse_parameters::Chosen;
use super::messages::{Complaint, NullSpace, TargetPose};
use super::start::Start;
use twist_command::Driven;

/// Servo steps per second of its clock.
pub(super) const STEPS: u32 = 120;
/// A servo that reached its target or stalled is at rest below this speed [rad/s or m/s].
const REST: f64 = 1e-7;

#[derive(Debug)]
pub(super) struct Session {
    start: Arc<Start>,
    mechanism: Mechanism,
    state: State,
    options: ServoOptions,
    task: String,
    method: Chosen,
    /// Or the reason why there is none.
    servo: Result<Servo>,
    /// The error of the last step.
    trouble: Option<Error>,
    target: Pose,
    /// True if somebody put it there; otherwise it moves with the tool of a program.
    is_target_placed: bool,
    is_playing: bool,
    /// True if a program set the configuration last.
    is_followed: bool,
    /// True if another step would change nothing.
    is_resting: bool,
    last: Option<LastStep>,
    self_motion: Option<SelfMotion>,
    /// In velocity mode.
    driven: Option<Driven>,
    bodies: Bodies,
    /// The models that are shown beside its own.
    beside: Vec<ModelBeside>,
    /// Least distance and margin (m), if collisions are avoided, and the servo that does, or the
    /// reason why there is none.
    avoidance: Option<((f64, f64), Result<Avoidance>)>,
    /// Clock of the servo, in steps.
    steps: u64,
}

#[derive(Debug)]
struct SelfMotion {
    rate: f64,
    index: usize,
    /// Joint velocities at full speed.
    motion: Vec<f64>,
}

impl Session {
    /// # Errors
    /// A start with non-finite values.
    pub(super) fn new(start: Arc<Start>) -> Result<Self> {
        let mechanism = start.mechanism.clone();
        let mut options = ServoOptions::new(&mechanism);
        options.end_effector = start.end_effector;
        options.dt = 1.0 / f64::from(STEPS);
        options.command_timeout = twist_command::COMMAND_TIMEOUT;
        options.secondary = options.default_secondary(&mechanism)?;
        let state = mechanism.state(&start.q)?;
        let method = Chosen::plain(options.method);
        let mut session = Self {
            target: state.pose(options.end_effector)?,
            servo: Servo::new(&mechanism, options.clone()),
            trouble: None,
            task: "pose".to_owned(),
            is_target_placed: false,
            is_playing: true,
            is_followed: false,
            // The target is at the tool until a message moves it.
            is_resting: true,
            last: None,
            self_motion: None,
            driven: None,
            bodies: Bodies::new(&start),
            beside: Vec::new(),
            avoidance: None,
            steps: 0,
            method,
            options,
            state,
            mechanism,
            start,
        };
        if session.start.bodies.avoid {
            session.avoid(Some((GAP, MARGIN)))?;
            session.is_resting = true;
        }
        Ok(session)
    }

    pub(super) fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    pub(super) fn state(&self) -> &State {
        &self.state
    }

    pub(super) fn options(&self) -> &ServoOptions {
        &self.options
    }

    pub(super) fn folders(&self) -> &Folders {
        &self.start.folders
    }

    pub(super) fn home(&self) -> &[f64] {
        &self.start.q
    }

    pub(super) fn frame(&self) -> &str {
        &self.mechanism.frame_of(self.options.end_effector.frame).name
    }

    pub(super) fn task_name(&self) -> &str {
        &self.task
    }

    pub(super) fn servo(&self) -> Option<&Servo> {
        self.servo.as_ref().ok()
    }

    pub(super) fn servo_mut(&mut self) -> Option<&mut Servo> {
        self.servo.as_mut().ok()
    }

    /// Why there is no servo, or why it cannot continue.
    pub(super) fn fault(&self) -> Option<&Error> {
        let avoidance = self.avoidance.as_ref().and_then(|(_, servo)| servo.as_ref().err());
        self.servo.as_ref().err().or(avoidance).or(self.trouble.as_ref())
    }

    pub(super) fn target(&self) -> Pose {
        self.target
    }

    pub(super) fn is_playing(&self) -> bool {
        self.is_playing
    }

    pub(super) fn last(&self) -> Option<&LastStep> {
        self.last.as_ref()
    }

    /// The limits that bounded a joint velocity in the last step.
    pub(super) fn active_limits(&self) -> Vec<(usize, LimitKind)> {
        match (&self.servo, &self.avoidance) {
            // A servo that has not stepped since it was stopped has no joint velocities.
            _ if self.last.is_none() => Vec::new(),
            (_, Some((_, Ok(avoidance)))) => avoidance.active_limits().collect(),
            (Ok(servo), None) => servo.active_limits().collect(),
            _ => Vec::new(),
        }
    }

    /// Speed of the self-motion relative to the joint velocity limits.
    pub(super) fn self_motion(&self) -> f64 {
        self.self_motion.as_ref().map_or(0.0, |s| s.rate)
    }

    /// Clock of the servo [s].
    pub(super) fn time(&self) -> f64 {
        self.steps as f64 / f64::from(STEPS)
    }

    pub(super) fn method(&self) -> &Chosen {
        &self.method
    }

    pub(super) fn beside(&self) -> &[ModelBeside] {
        &self.beside
    }

    /// Shows these models beside its own, in place of those before.
    pub(super) fn show_beside(&mut self, models: Vec<ModelBeside>) {
        self.beside = models;
    }

    /// True if another step would change nothing.
    pub(super) fn is_resting(&self) -> bool {
        self.is_resting
    }

    /// True while steps change the state.
    pub(super) fn is_moving(&self) -> bool {
        let avoids = self.avoidance.as_ref().is_none_or(|(_, servo)| servo.is_ok());
        self.is_playing && self.servo.is_ok() && avoids && !self.is_resting
    }

    /// Executes this many servo steps, fewer if it comes to rest; false if nothing visible changed.
    pub(super) fn advance(&mut self, steps: u64) -> bool {
        let before = self.state.q().to_vec();
        let first = self.last.is_none();
        let is_driven = self.driven.is_some();
        let mut q = before.clone();
        let mut moved = Ok(());
        for _ in 0..steps {
            if !self.is_moving() || moved.is_err() {
                break;
            }
            moved = match self.driven {
                Some(_) => self.step_driven(&mut q),
                None => self.step(&mut q),
            };
        }
        // Non-finite configurations are rejected.
        if let Err(error) = moved.and_then(|()| self.state.set(&q)) {
            (self.trouble, self.is_resting) = (Some(error), true);
        }
        if is_driven && let Ok(tool) = self.state.pose(self.options.end_effector) {
            self.target = tool;
        }
        self.state.q() != before || self.is_resting || first
    }

    fn step(&mut self, q: &mut [f64]) -> Result<()> {
        let Ok(servo) = &mut self.servo else { return Ok(()) };
        let mut desired = Vec::new();
        if let Some(own) = &mut self.self_motion {
            if let Some(next) = servo.next_self_motion(q, &own.motion)? {
                own.motion = next;
            }
            desired = own.motion.iter().map(|x| own.rate * x).collect();
        }
        let (last, still) = match &mut self.avoidance {
            Some((_, Ok(avoidance))) => {
                let last = avoidance.step(servo, q, self.target, &desired)?;
                (last, avoidance.joint_velocities().iter().all(|rate| rate.abs() < REST))
            }
            _ => {
                let status = servo.step_with(q, Target::from(self.target), &desired)?.status;
                let stall = (status == Status::Stalled).then(|| servo.stall());
                servo.advance(q);
                let still = servo.joint_velocities().iter().all(|rate| rate.abs() < REST);
                (LastStep { status, stall, pair: None }, still)
            }
        };
        self.steps += 1;
        let ended = match last.status {
            Status::Moving => false,
            Status::Reached => still,
            Status::Stalled => true,
        };
        if ended && self.self_motion.is_none() {
            self.is_resting = true;
            self.rest();
        }
        self.last = Some(last);
        Ok(())
    }

    /// Sets the velocities of the servo to zero.
    fn rest(&mut self) {
        self.driven = None;
        if let Ok(servo) = &mut self.servo {
            servo.reset();
        }
        if let Some((_, Ok(avoidance))) = &mut self.avoidance {
            avoidance.reset();
        }
    }

    /// Controls this frame; the target is its current pose.
    pub(super) fn choose_frame(&mut self, frame: FrameId) -> Result<()> {
        let options = ServoOptions { end_effector: frame.into(), ..self.options.clone() };
        self.take(options)?;
        (self.target, self.is_target_placed) = (self.state.pose(frame)?, false);
        Ok(())
    }

    pub(super) fn choose_task(&mut self, name: String) -> Result<()> {
        let task = Task::named(&name, &self.mechanism)?;
        self.take(ServoOptions { task, ..self.options.clone() })?;
        self.task = name;
        Ok(())
    }

    pub(super) fn choose_method(&mut self, method: Chosen, options: ServoOptions) -> Result<()> {
        self.take(options)?;
        self.method = method;
        Ok(())
    }

    pub(super) fn play(&mut self) {
        (self.is_playing, self.is_followed) = (true, false);
        self.wake();
    }

    pub(super) fn pause(&mut self) {
        self.is_playing = false;
        self.rest();
    }

    /// Returns to the initial configuration.
    pub(super) fn reset(&mut self) -> Result<()> {
        let q = self.start.q.clone();
        self.stand(&q)
    }

    /// Sets the configuration, and the target to the tool.
    pub(super) fn stand(&mut self, q: &[f64]) -> Result<()> {
        self.state.set(q)?;
        self.target = self.state.pose(self.options.end_effector)?;
        self.is_target_placed = false;
        self.self_motion = None;
        self.wake();
        // The target is reached, and joints stay at the given values.
        self.is_resting = true;
        Ok(())
    }

    /// Restarts the servo from rest.
    fn wake(&mut self) {
        (self.last, self.trouble) = (None, None);
        self.is_resting = false;
        self.rest();
    }

    pub(super) fn aim(&mut self, desired: &TargetPose) -> std::result::Result<(), Complaint> {
        self.aim_at(desired.pose("target")?);
        Ok(())
    }

    pub(super) fn aim_at(&mut self, target: Pose) {
        (self.target, self.is_target_placed) = (target, true);
        // Velocities are kept, so that a dragged target is followed smoothly.
        self.driven = None;
        (self.last, self.trouble) = (None, None);
        self.is_resting = false;
    }

    /// Sets new options; there is no servo if the actuated joints do not control the tool.
    fn take(&mut self, mut options: ServoOptions) -> Result<()> {
        options.secondary = options.default_secondary(&self.mechanism)?;
        options.check(&self.mechanism)?;
        self.servo = Servo::new(&self.mechanism, options.clone());
        self.options = options;
        self.self_motion = None;
        self.avoid(self.avoided())
    }

    pub(super) fn turn(&mut self, desired: &NullSpace) -> std::result::Result<(), Complaint> {
        let refuse = |field: &str, value: String, what: &str, way_out: &str| {
            Complaint::new(&format!("null_space.{field}"), &value, what, way_out)
        };
        if !(-1.0..=1.0).contains(&desired.rate) {
            let what = format!(
                "rate = {} is outside the range -1 to 1 (share of the joint velocity limits)",
                desired.rate
            );
            return Err(refuse(
                "rate",
                desired.rate.to_string(),
                &what,
                "give a value from -1 to 1",
            ));
        }
        if desired.rate == 0.0 {
            self.self_motion = None;
            self.wake();
            return Ok(());
        }
        let q = self.state.q().to_vec();
        let motions = match &mut self.servo {
            Ok(servo) => servo.self_motions(&q).map_err(|e| Complaint::of("null_space", &e))?,
            Err(error) => return Err(Complaint::of("null_space", error)),
        };
        let count = motions.len();
        let Some(motion) = motions.into_iter().nth(desired.index) else {
            let what = match count {
                0 => "there is no self-motion here: every joint motion moves the tool".to_owned(),
                _ => format!("there are {count} self-motions, counted from 0"),
            };
            let way_out = "leave components of the pose free (task), or choose another index";
            return Err(refuse("index", desired.index.to_string(), &what, way_out));
        };
        let (rate, index) = (desired.rate, desired.index);
        match &mut self.self_motion {
            // While a slider is dragged, the direction is kept.
            Some(own) if own.index == index => own.rate = rate,
            _ => self.self_motion = Some(SelfMotion { rate, index, motion }),
        }
        self.is_resting = false;
        Ok(())
    }

    pub(super) fn drive_by(&mut self, names: &[String]) -> std::result::Result<(), Complaint> {
        if !self.mechanism.is_closed() {
            let name = self.mechanism.name();
            let what = format!("'{name}' has no loops or contacts, so all joints are actuated");
            let way_out = "actuated joints can be chosen for closed chains only";
            return Err(Complaint::new("actuated.names", name, &what, way_out));
        }
        let at = |error| Complaint::of("actuated.names", &error);
        let mechanism = self.mechanism.with_actuated(names).map_err(at)?;
        let state = mechanism.state(self.state.q()).map_err(at)?;
        let servo = Servo::new(&mechanism, self.options.clone());
        (self.mechanism, self.state, self.servo) = (mechanism, state, servo);
        self.self_motion = None;
        self.avoid(self.avoided()).map_err(at)
    }

    /// The screw system of the tool: of the joints of a tree, or of the motions of the object of a
    /// closed chain.
    pub(super) fn screw_system(&self) -> Result<ScrewSystem> {
        let (mechanism, state) = (self.mechanism(), self.state());
        let of = self.options().end_effector;
        let twists = frame_twists(state, of)?;
        ScrewSystem::of(&twists, &ScrewOptions::with_length(mechanism.reach()))
    }

    /// The pitch with the smallest projector norm here; may be infinite.
    pub(super) fn best_pitch(&self) -> Result<f64> {
        self.screw_system()?.choose_pitch().pitch.ok_or_else(|| Error::InvalidOption {
            option: "h",
            value: "null".to_owned(),
            reason: "no hyperbolic inverse exists here for any pitch; choose another inverse"
                .to_owned(),
        })
    }
}
