//! A session: one client's configuration, target and servo.
//!
//! It knows nothing of sockets and time. Messages change it, steps move it, and it can be shown.

use std::sync::Arc;

use cylindroid::control::{Stall, Status, Step, Target};
use cylindroid::ik::Task;
use cylindroid::spatial::Quaternion;
use cylindroid::{EndEffector, Error, Mechanism, Pose, Result, Servo, ServoOptions, State, Vec3};
use serde_json::Value;

use super::assets::Folders;
use super::compare::compare;
use super::inverting::{Chosen, invert_by};
use super::messages::{Complaint, Message, NullSpace, Request, TargetPose};
use super::overlays::Overlay;
use super::reaching::{Reached, assembled, reach};
use super::reports::Report;

/// Steps of the servo in a second of its clock.
pub(super) const STEPS: u32 = 120;
/// A servo that is at its target, or stalled, and slower than this is at rest [rad/s or m/s].
const REST: f64 = 1e-7;

/// What all sessions of a server begin with.
#[derive(Debug)]
pub(crate) struct Start {
    pub(crate) mechanism: Mechanism,
    pub(crate) q: Vec<f64>,
    pub(crate) end_effector: EndEffector,
    pub(super) folders: Folders,
}

/// What a message is answered with.
#[derive(Debug)]
pub(super) enum Reply {
    /// The next state shows it.
    Nothing,
    /// The scene has changed.
    Scene,
    /// This text.
    Text(String),
    /// What this finds, which takes a while.
    Report(Report),
    /// A state has been drawn.
    Seen(u64),
}

#[derive(Debug)]
pub(super) struct Session {
    start: Arc<Start>,
    mechanism: Mechanism,
    state: State,
    options: ServoOptions,
    task: String,
    method: Chosen,
    /// Or why there is none.
    servo: Result<Servo>,
    /// What ended the last step.
    trouble: Option<Error>,
    target: Pose,
    is_playing: bool,
    /// True where another step would change nothing.
    is_resting: bool,
    last: Option<(Step, Option<Stall>)>,
    self_motion: Option<SelfMotion>,
    overlays: Vec<Overlay>,
    /// Clock of the servo, in steps.
    steps: u64,
    ack: Option<Value>,
}

#[derive(Debug)]
struct SelfMotion {
    rate: f64,
    index: usize,
    /// Rates at full speed.
    motion: Vec<f64>,
}

impl Session {
    /// # Errors
    /// A start that is not finite.
    pub(super) fn new(start: Arc<Start>) -> Result<Self> {
        let mechanism = start.mechanism.clone();
        let mut options = ServoOptions::new(&mechanism);
        options.end_effector = start.end_effector;
        options.dt = 1.0 / f64::from(STEPS);
        options.secondary = options.default_secondary(&mechanism)?;
        let state = mechanism.state(&start.q)?;
        let method = Chosen::plain(options.method);
        Ok(Self {
            target: state.pose(options.end_effector),
            servo: Servo::new(&mechanism, options.clone()),
            trouble: None,
            task: "pose".to_owned(),
            is_playing: true,
            // The target is at the tool: there is nothing to do until somebody wants something.
            is_resting: true,
            last: None,
            self_motion: None,
            overlays: Vec::new(),
            steps: 0,
            ack: None,
            method,
            options,
            state,
            mechanism,
            start,
        })
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

    /// Why there is no servo, or why it cannot go on from here.
    pub(super) fn fault(&self) -> Option<&Error> {
        self.servo.as_ref().err().or(self.trouble.as_ref())
    }

    pub(super) fn target(&self) -> Pose {
        self.target
    }

    pub(super) fn is_playing(&self) -> bool {
        self.is_playing
    }

    pub(super) fn last(&self) -> Option<&(Step, Option<Stall>)> {
        self.last.as_ref()
    }

    /// Share of the joints' speeds that the self-motion has.
    pub(super) fn self_motion(&self) -> f64 {
        self.self_motion.as_ref().map_or(0.0, |s| s.rate)
    }

    pub(super) fn overlays(&self) -> &[Overlay] {
        &self.overlays
    }

    /// Clock of the servo [s].
    pub(super) fn time(&self) -> f64 {
        self.steps as f64 / f64::from(STEPS)
    }

    pub(super) fn ack(&self) -> Option<&Value> {
        self.ack.as_ref()
    }

    pub(super) fn method(&self) -> &Chosen {
        &self.method
    }

    /// True where another step would change nothing.
    pub(super) fn is_resting(&self) -> bool {
        self.is_resting
    }

    /// True while steps change something.
    pub(super) fn is_moving(&self) -> bool {
        self.is_playing && self.servo.is_ok() && !self.is_resting
    }

    /// Moves by this many steps of the servo, fewer if it comes to rest; false where that has
    /// changed nothing that is seen.
    pub(super) fn advance(&mut self, steps: u64) -> bool {
        let before = self.state.q().to_vec();
        let first = self.last.is_none();
        let mut q = before.clone();
        let mut moved = Ok(());
        for _ in 0..steps {
            if !self.is_moving() || moved.is_err() {
                break;
            }
            moved = self.step(&mut q);
        }
        // A configuration that is not finite is no place to go.
        if let Err(error) = moved.and_then(|()| self.state.set(&q)) {
            (self.trouble, self.is_resting) = (Some(error), true);
        }
        self.state.q() != before || self.is_resting || first
    }

    fn step(&mut self, q: &mut [f64]) -> Result<()> {
        let Ok(servo) = &mut self.servo else { return Ok(()) };
        let mut wanted = Vec::new();
        if let Some(own) = &mut self.self_motion {
            if let Some(next) = servo.next_self_motion(q, &own.motion)? {
                own.motion = next;
            }
            wanted = own.motion.iter().map(|x| own.rate * x).collect();
        }
        let step = servo.step_with(q, Target::from(self.target), &wanted)?;
        let stall = (step.status == Status::Stalled).then(|| servo.stall());
        servo.advance(q);
        self.steps += 1;
        let still = servo.joint_velocities().iter().all(|rate| rate.abs() < REST);
        let ended = match step.status {
            Status::Moving => false,
            Status::Reached => still,
            Status::Stalled => true,
        };
        if ended && self.self_motion.is_none() {
            self.is_resting = true;
            servo.reset();
        }
        self.last = Some((step, stall));
        Ok(())
    }

    /// Does as a client says; on a complaint nothing has changed, but for `joint`, which goes as
    /// far as it can.
    pub(super) fn handle(&mut self, request: Request) -> std::result::Result<Reply, Complaint> {
        let Request { id, message } = request;
        if let Message::Seen(seen) = message {
            return Ok(Reply::Seen(seen.seq));
        }
        self.ack.clone_from(&id);
        self.obey(message, id.as_ref()).map_err(|c| Complaint { reply_to: id, ..c })
    }

    fn obey(
        &mut self,
        message: Message,
        id: Option<&Value>,
    ) -> std::result::Result<Reply, Complaint> {
        let at = |place: &'static str| move |error: Error| Complaint::of(place, &error);
        match message {
            Message::Joint(joint) => {
                let Reached { q, complaint } = reach(&self.state, &joint.name, joint.value)?;
                self.stand(&q).map_err(at("joint.value"))?;
                complaint.map_or(Ok(()), Err)?;
            }
            Message::Configuration(wanted) => {
                let q = assembled(&self.mechanism, &wanted.q).map_err(at("configuration.q"))?;
                self.stand(&q).map_err(at("configuration.q"))?;
            }
            Message::Target(target) => self.aim(&target)?,
            Message::Frame(frame) => {
                let frame = self.mechanism.frame(&frame.name).map_err(at("frame.name"))?;
                let options = ServoOptions { end_effector: frame.into(), ..self.options.clone() };
                self.take(options).map_err(at("frame.name"))?;
                self.target = self.state.pose(frame);
                return Ok(Reply::Scene);
            }
            Message::Task(task) => {
                let found = Task::named(&task.name, &self.mechanism).map_err(at("task.name"))?;
                let options = ServoOptions { task: found, ..self.options.clone() };
                self.take(options).map_err(at("task.name"))?;
                self.task = task.name;
                return Ok(Reply::Scene);
            }
            Message::Play(_) => {
                self.is_playing = true;
                self.wake();
            }
            Message::Pause(_) => {
                self.is_playing = false;
                if let Ok(servo) = &mut self.servo {
                    servo.reset();
                }
            }
            Message::Reset(_) => {
                let q = self.start.q.clone();
                self.stand(&q).map_err(at("reset"))?;
            }
            Message::NullSpace(wanted) => self.turn(&wanted)?,
            Message::Actuated(drives) => {
                self.drive_by(&drives.names)?;
                return Ok(Reply::Scene);
            }
            Message::Method(choice) => {
                let options = self.options.clone();
                let best_pitch = || self.best_pitch();
                let (chosen, options) = invert_by(choice, &self.state, options, best_pitch)?;
                self.take(options).map_err(at("method"))?;
                self.method = chosen;
                return Ok(Reply::Scene);
            }
            Message::Overlays(wanted) => {
                let names = wanted.names.iter().map(|name| Overlay::named(name));
                let mut all: Vec<Overlay> =
                    names.collect::<Result<_>>().map_err(at("overlays.names"))?;
                all.sort_unstable();
                all.dedup();
                self.overlays = all;
            }
            Message::Compare(wanted) => return compare(self, &wanted, id).map(Reply::Text),
            Message::Report(wanted) => {
                return Report::new(self, &wanted.name, id).map(Reply::Report);
            }
            Message::Seen(seen) => return Ok(Reply::Seen(seen.seq)),
        }
        Ok(Reply::Nothing)
    }

    /// Stands at `q`, the target at the tool.
    fn stand(&mut self, q: &[f64]) -> Result<()> {
        self.state.set(q)?;
        self.target = self.state.pose(self.options.end_effector);
        self.self_motion = None;
        self.wake();
        // Nothing to do; above all, joints stay where they were put.
        self.is_resting = true;
        Ok(())
    }

    /// Begins anew from rest.
    fn wake(&mut self) {
        (self.last, self.trouble) = (None, None);
        self.is_resting = false;
        if let Ok(servo) = &mut self.servo {
            servo.reset();
        }
    }

    fn aim(&mut self, wanted: &TargetPose) -> std::result::Result<(), Complaint> {
        let [w, x, y, z] = wanted.quaternion;
        let rotation = Quaternion { w, x, y, z }
            .rotation()
            .map_err(|error| Complaint::of("target.quaternion", &error))?;
        let translation = Vec3::from_array(wanted.position);
        // A distance that overflows is no distance.
        Error::check_finite("target position", &[translation.norm()])
            .map_err(|error| Complaint::of("target.position", &error))?;
        self.target = Pose { rotation, translation };
        // Speeds stay: a target that is dragged is followed smoothly.
        (self.last, self.trouble) = (None, None);
        self.is_resting = false;
        Ok(())
    }

    /// Another servo, if the options make one; drives that do not steer the tool leave none.
    fn take(&mut self, mut options: ServoOptions) -> Result<()> {
        options.secondary = options.default_secondary(&self.mechanism)?;
        options.check(&self.mechanism)?;
        self.servo = Servo::new(&self.mechanism, options.clone());
        self.options = options;
        self.self_motion = None;
        self.wake();
        Ok(())
    }

    fn turn(&mut self, wanted: &NullSpace) -> std::result::Result<(), Complaint> {
        let refuse = |field: &str, value: String, what: &str, way_out: &str| {
            Complaint::new(&format!("null_space.{field}"), &value, what, way_out)
        };
        if !(-1.0..=1.0).contains(&wanted.rate) {
            let what = format!("rate = {} is no share of the joints' speeds", wanted.rate);
            return Err(refuse("rate", wanted.rate.to_string(), &what, "give -1 to 1"));
        }
        if wanted.rate == 0.0 {
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
        let Some(motion) = motions.into_iter().nth(wanted.index) else {
            let what = match count {
                0 => "no motion of the joints leaves the tool at rest here".to_owned(),
                _ => format!("there are {count} such motions, counted from 0"),
            };
            let way_out = "leave components of the pose free (task), or choose another index";
            return Err(refuse("index", wanted.index.to_string(), &what, way_out));
        };
        let (rate, index) = (wanted.rate, wanted.index);
        match &mut self.self_motion {
            // A slider that is dragged keeps its motion.
            Some(own) if own.index == index => own.rate = rate,
            _ => self.self_motion = Some(SelfMotion { rate, index, motion }),
        }
        self.is_resting = false;
        Ok(())
    }

    fn drive_by(&mut self, names: &[String]) -> std::result::Result<(), Complaint> {
        if !self.mechanism.is_closed() {
            let name = self.mechanism.name();
            let what = format!("'{name}' has no loops or contacts, so all joints are driven");
            let way_out = "drives are chosen on closed chains";
            return Err(Complaint::new("actuated.names", name, &what, way_out));
        }
        let at = |error| Complaint::of("actuated.names", &error);
        let mechanism = self.mechanism.with_actuated(names).map_err(at)?;
        let state = mechanism.state(self.state.q()).map_err(at)?;
        let servo = Servo::new(&mechanism, self.options.clone());
        (self.mechanism, self.state, self.servo) = (mechanism, state, servo);
        self.self_motion = None;
        self.wake();
        Ok(())
    }

    /// The pitch whose projector is smallest here; it may be infinite.
    pub(super) fn best_pitch(&self) -> Result<f64> {
        let system = super::overlays::system(self)?;
        system.choose_pitch().pitch.ok_or_else(|| Error::InvalidOption {
            option: "h",
            value: "null".to_owned(),
            reason: "the joints have no hyperbolic inverse here, whatever the pitch; take another"
                .to_owned(),
        })
    }
}
