//! From joint states and targets to commands: one step of the servo in each cycle. It knows
//! nothing of DDS.
//!
//! Position  with commanded positions the servo steers the reference, which starts at the measured
//!           configuration and moves by the commanded velocities: the drives close the loop. With
//!           commanded velocities it steers the measured configuration
//! Watchdog  the robot brakes within the limits of its joints if the last target, or the position of
//!           a joint, is too old, if a joint does not follow, or if a step fails; in all cases
//!           commands go on until it is at rest, and `HOLD` seconds longer
//! Units     m, rad, s; times are those of one monotonic clock
//! Checked   tests/controller.rs, tests/dds.py

use anyhow::{Result, bail, ensure};
use cylindroid::control::{Status, TwistStatus};
use cylindroid::{Error, Mechanism, Servo, Twist};

use crate::joints::MeasuredJoints;
use crate::messages::{JointState, PoseStamped, TwistStamped};
use crate::parameters::{CommandKind, Config};
use crate::report::{Report, State, stall_reason};
use crate::servo_options::servo_options;
use crate::targets::{self, Aim, Root};

/// Time for which a robot at rest is still commanded (s): a lost message does not keep it moving.
const HOLD: f64 = 0.1;
/// Time for which the status shows a refused message (s).
const SHOWN: f64 = 1.0;

/// The next positions and velocities of the commanded joints.
#[derive(Debug, Clone, PartialEq)]
pub struct Command {
    /// [rad or m]
    pub positions: Vec<f64>,
    /// [rad/s or m/s]
    pub velocities: Vec<f64>,
}

/// Result of a cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// To be published; none while the robot is at rest and has nothing to follow.
    pub command: Option<Command>,
    /// The status.
    pub report: Report,
}

/// The newest target.
#[derive(Debug, Clone, Copy)]
struct Latest {
    aim: Aim,
    received: f64,
    is_new: bool,
}

/// The controller of a robot.
#[derive(Debug, Clone)]
pub struct Controller {
    servo: Servo,
    state: cylindroid::State,
    joints: MeasuredJoints,
    is_velocity: bool,
    /// Commanded coordinates: indices in `q`.
    commanded: Vec<usize>,
    scale: [f64; 2],
    command_timeout: f64,
    joint_state_timeout: f64,
    largest_following_error: f64,
    latest: Option<Latest>,
    /// The configuration that the commands lead to.
    reference: Vec<f64>,
    /// Time for which commands go on although the joints are at rest (s); `None`: no commands.
    hold: Option<f64>,
    fault: Option<String>,
    refused: Option<(String, f64)>,
    is_shut_down: bool,
}

impl Controller {
    /// Of a robot at rest.
    ///
    /// # Errors
    /// Parameters that do not fit the robot.
    pub fn new(config: &Config, robot: &Mechanism) -> Result<Self> {
        let servo = Servo::new(robot, servo_options(config, robot)?)?;
        if let Some(joint) = robot.loops().iter().find(|l| l.actuated) {
            bail!(
                "loop joint '{}' is actuated and has no coordinate to be measured and commanded; cut \
                 the loop at a passive joint",
                joint.name
            );
        }
        let coordinates = robot.coordinates();
        let required = servo.coordinates();
        let commanded: Vec<usize> = match &config.joints {
            None => required.iter().copied().filter(|&i| coordinates[i].actuated).collect(),
            Some(names) => {
                let mut found = Vec::new();
                for name in names {
                    let place = coordinates.iter().position(|c| c.name == *name);
                    let unknown =
                        || Error::unknown("joint", name, coordinates.iter().map(|c| &c.name));
                    found.push(place.ok_or_else(unknown)?);
                }
                for &i in required.iter().filter(|&&i| coordinates[i].actuated) {
                    let name = &coordinates[i].name;
                    ensure!(found.contains(&i), "joints: '{name}' moves the frame and is missing");
                }
                found
            }
        };
        let mut measured = required.to_vec();
        measured.extend(commanded.iter().filter(|i| !required.contains(i)));
        Ok(Self {
            state: robot.state(robot.home())?,
            joints: MeasuredJoints::new(robot, &measured),
            is_velocity: config.command == CommandKind::Velocities,
            commanded,
            scale: [config.linear_scale, config.angular_scale],
            command_timeout: config.command_timeout,
            joint_state_timeout: config.joint_state_timeout,
            largest_following_error: config.following_error,
            latest: None,
            reference: robot.home().to_vec(),
            hold: None,
            fault: None,
            refused: None,
            is_shut_down: false,
            servo,
        })
    }

    /// The servo, with its robot and options.
    #[must_use]
    pub fn servo(&self) -> &Servo {
        &self.servo
    }

    /// Names of the commanded joints, in the order of the commands.
    pub fn joint_names(&self) -> impl Iterator<Item = &str> {
        self.commanded.iter().map(|&i| self.servo.mechanism().coordinates()[i].name.as_str())
    }

    /// The measured state; nothing while joints are missing.
    #[must_use]
    pub fn state(&self) -> Option<&cylindroid::State> {
        self.joints.missing().next().is_none().then_some(&self.state)
    }

    /// Takes a joint state. A broken one is refused, and shown in the status.
    pub fn joint_state(&mut self, message: &JointState, now: f64) {
        let taken = self.joints.update(message, now);
        let set = |()| self.state.set(self.joints.q()).map_err(|e| e.to_string());
        if let Err(reason) = taken.and_then(set) {
            self.refused = Some((reason, now));
        }
    }

    /// Takes a target pose.
    pub fn pose(&mut self, message: &PoseStamped, now: f64) {
        let aim = targets::pose(message, self.state(), &Root(self.servo.mechanism()));
        self.take(aim, now);
    }

    /// Takes a twist.
    pub fn twist(&mut self, message: &TwistStamped, now: f64) {
        let root = Root(self.servo.mechanism());
        let aim = targets::twist(message, self.scale, self.state(), &root);
        self.take(aim, now);
    }

    fn take(&mut self, aim: Result<Aim, String>, received: f64) {
        match aim {
            Ok(aim) => self.latest = Some(Latest { aim, received, is_new: true }),
            Err(reason) => self.refused = Some((reason, received)),
        }
    }

    /// From now on the robot brakes and stays at rest.
    pub fn shut_down(&mut self) {
        self.is_shut_down = true;
    }

    /// True if nothing is commanded.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        self.hold.is_none()
    }

    /// One cycle.
    pub fn step(&mut self, now: f64) -> Output {
        let age = self.joints.oldest(now);
        let mut report = Report {
            age: age.map(|(_, age)| age),
            refused: match &self.refused {
                Some((reason, since)) if now - since <= SHOWN => reason.clone(),
                _ => String::new(),
            },
            ..Report::default()
        };
        let Some((name, age)) = age else {
            let missing: Vec<&str> = self.joints.missing().collect();
            report.reason = format!("no position of {} yet", missing.join(", "));
            return Output { command: None, report };
        };
        let stale = (age > self.joint_state_timeout)
            .then(|| format!("the position of {name} is {age:.2} s old"));
        let target = self.latest.filter(|l| now - l.received <= self.command_timeout);
        if target.is_none() && self.hold.is_none() {
            self.fault = None; // the client lets go
        }
        if self.hold.is_some() && !self.is_velocity {
            self.watch_following();
        }
        let ended = self.is_shut_down.then(|| "the node is shut down".to_owned());
        let refusal = ended.or_else(|| self.fault.clone()).or_else(|| stale.clone());
        if self.hold.is_none() {
            self.start(refusal.is_none() && target.is_some());
        }
        if self.hold.is_none() {
            report.state = if refusal.is_some() { State::Stopped } else { State::AtRest };
            report.reason = refusal.unwrap_or_default();
            return Output { command: None, report };
        }
        if self.is_velocity && stale.is_none() {
            self.reference.copy_from_slice(self.joints.q());
        }
        let aim = target.filter(|_| refusal.is_none());
        let command = self.command(aim, &mut report);
        if report.state == State::Braking {
            report.reason = refusal
                .or_else(|| self.fault.clone())
                .unwrap_or_else(|| format!("no command for {} s", self.command_timeout));
        }
        report.following_error = (!self.is_velocity).then(|| self.following_error().1);
        Output { command: Some(command), report }
    }

    /// Begins to command, from the measured configuration.
    fn start(&mut self, begins: bool) {
        if begins {
            self.servo.reset();
            self.reference.copy_from_slice(self.joints.q());
            self.hold = Some(HOLD);
        }
    }

    /// A step of the servo towards the aim, or one that brakes.
    fn command(&mut self, aim: Option<Latest>, report: &mut Report) -> Command {
        let q = std::mem::take(&mut self.reference);
        let stepped = match aim.map(|l| (l.aim, l.is_new)) {
            None => self.servo.step_twist(&q, Some(Twist::ZERO)).map(|_| (State::Braking, None)),
            Some((Aim::Pose(pose), _)) => self.servo.step(&q, pose).map(|step| {
                let state = match step.status {
                    Status::Moving => State::Moving,
                    Status::Reached => State::Reached,
                    Status::Stalled => State::Stalled,
                };
                report.errors = Some([step.position_error, step.orientation_error]);
                (state, Some(step.singular_ratio))
            }),
            Some((Aim::Twist(twist), is_new)) => {
                self.servo.step_twist(&q, is_new.then_some(twist)).map(|step| {
                    let state = match step.status {
                        TwistStatus::Following => State::Following,
                        TwistStatus::Stalled => State::Stalled,
                        TwistStatus::AtRest | TwistStatus::Braking => State::Following,
                    };
                    (state, Some(step.step.singular_ratio))
                })
            }
        };
        self.reference = q;
        if let Some(latest) = &mut self.latest {
            latest.is_new = false;
        }
        match stepped {
            Ok((state, ratio)) => {
                (report.state, report.singular_ratio) = (state, ratio);
                self.servo.advance(&mut self.reference);
            }
            Err(error) => {
                // Without a step there is no ramp: the joints hold.
                report.state = State::Braking;
                self.fault = Some(error.to_string());
                self.servo.reset();
            }
        }
        if report.state == State::Stalled {
            report.reason = stall_reason(&self.servo.stall(), self.servo.mechanism());
        }
        let velocities = self.servo.joint_velocities();
        let at_rest = velocities.iter().all(|v| *v == 0.0);
        let left = self.hold.unwrap_or(HOLD) - self.servo.options().dt;
        self.hold = match (report.state, at_rest) {
            (State::Braking, true) => (left > 0.0).then_some(left),
            _ => Some(HOLD),
        };
        Command {
            positions: self.commanded.iter().map(|&i| self.reference[i]).collect(),
            velocities: self.commanded.iter().map(|&i| velocities[i]).collect(),
        }
    }

    /// The commanded joint that is farthest from its reference, and its distance.
    fn following_error(&self) -> (usize, f64) {
        let mut worst = (0, 0.0);
        for &i in &self.commanded {
            let distance = (self.joints.q()[i] - self.reference[i]).abs();
            if distance > worst.1 {
                worst = (i, distance);
            }
        }
        worst
    }

    fn watch_following(&mut self) {
        let (joint, distance) = self.following_error();
        if distance > self.largest_following_error && self.fault.is_none() {
            let c = &self.servo.mechanism().coordinates()[joint];
            let (name, unit) = (&c.name, c.kind.unit());
            let reason =
                format!("{name} is {distance:.3} {unit} from its command: it does not follow");
            self.fault = Some(reason);
        }
    }
}
