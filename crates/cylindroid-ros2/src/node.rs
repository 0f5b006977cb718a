//! The node: it joins the domain, finds its robot, and runs the controller at a fixed rate.
#![allow(clippy::print_stderr)] // it talks to a person

use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use cylindroid::Mechanism;
use ros2_client::dds::Node;
use ros2_client::{NodeName, NodeOptions, ParameterValue};

use crate::controller::Controller;
use crate::messages;
use crate::network::Network;
use crate::parameters::Config;
use crate::report::{Report, State};
use crate::signals::Signals;
use crate::topics::{Opener, Topics, latched};
use crate::transforms::Frames;

/// Time within which a robot comes to rest after Ctrl-C; then the node ends all the same.
const LONGEST_STOP: Duration = Duration::from_secs(5);
/// The status is repeated, and diagnostics are published, after so long (s).
const REPEAT: f64 = 0.1;
const DIAGNOSTICS: f64 = 1.0;
/// Time that the last messages have to leave.
const FAREWELL: Duration = Duration::from_millis(100);

/// Runs the node until Ctrl-C or SIGTERM.
///
/// # Errors
/// Parameters or a robot that cannot be used, a network that is not there.
pub fn run(config: &Config) -> Result<()> {
    let network = Network::new(config, |name| std::env::var(name).ok())?;
    let controller = |robot: &Mechanism| Controller::new(config, robot);
    // What is wrong with a file is said before the network is touched.
    let from_file = config.robot.as_deref().map(cylindroid::load).transpose()?;
    let from_file = from_file.map(|robot| controller(&robot)).transpose()?;
    let signals = Signals::new()?;
    let mut node = open(config, &network)?;
    let controller = match from_file {
        Some(controller) => controller,
        None => match described(&mut node, config, &signals)? {
            Some(robot) => controller(&robot)?,
            None => return Ok(()),
        },
    };
    let servo = controller.servo();
    let robot = servo.mechanism();
    eprintln!(
        "{}: {} at {} Hz, {}",
        robot.name(),
        robot.frame_of(servo.options().end_effector.frame).name,
        config.rate,
        network.described()
    );
    let names = controller.joint_names().map(str::to_owned).collect();
    let topics = Topics::open(&mut Opener { node: &mut node, config }, names)?;
    let lost = Cycle::new(config, controller, topics).run(&signals)?;
    if lost > 0 {
        eprintln!("warning: {lost} messages are not in the record, the disk was too slow");
    }
    Ok(())
}

/// The node, its parameters declared, and a thread that answers questions about them.
fn open(config: &Config, network: &Network) -> Result<Node> {
    let context = network.join()?;
    let name = NodeName::new(&config.namespace, &config.node);
    let name = name.with_context(|| format!("node '{}' in '{}'", config.node, config.namespace))?;
    let mut options = NodeOptions::new().enable_rosout(false);
    let declared = config.declared()?;
    for (name, value) in &declared {
        options = options.declare_parameter(name, value.clone());
    }
    options = options.parameter_validator(Box::new(move |name, value| {
        let is_declared = declared.iter().any(|(n, v)| n == name && v == value);
        // The client declares one of its own.
        if is_declared || (name, value) == ("use_sim_time", &ParameterValue::Boolean(false)) {
            return Ok(());
        }
        Err(format!("{name} is set at the start of the node: restart it with another value"))
    }));
    let mut node = context.new_node(name, options).map_err(|e| anyhow::anyhow!("{e}"))?;
    let spinner = node.spinner()?;
    let runtime = tokio::runtime::Builder::new_current_thread().build()?;
    // It ends with the node.
    thread::Builder::new().name("parameters".to_owned()).spawn(move || {
        let _ = runtime.block_on(spinner.spin());
    })?;
    Ok(node)
}

/// The robot of the description's topic; nothing after a signal.
fn described(node: &mut Node, config: &Config, signals: &Signals) -> Result<Option<Mechanism>> {
    let topic = &config.robot_description;
    eprintln!("waiting for a robot on {topic}");
    let mut opener = Opener { node, config };
    let subscription = opener.subscribe::<messages::String>(topic, &latched())?;
    while !signals.came() {
        if let Some(text) = subscription.take() {
            return Ok(Some(cylindroid::model::formats::urdf::parse(
                &text.data,
                Path::new(topic),
            )?));
        }
        thread::sleep(Duration::from_millis(20));
    }
    Ok(None)
}

/// The loop and its figures.
struct Cycle {
    controller: Controller,
    topics: Topics,
    frames: Frames,
    node: String,
    period: Duration,
    tf_period: f64,
    /// Times on the clock of the loop (s).
    next_status: f64,
    next_diagnostics: f64,
    next_tf: f64,
    last_status: String,
    /// Since the last diagnostics: cycles, the longest of them (s), and those that were too late.
    cycles: u32,
    longest: f64,
    late: u32,
}

impl Cycle {
    fn new(config: &Config, controller: Controller, topics: Topics) -> Self {
        Self {
            frames: Frames::new(controller.servo().mechanism()),
            controller,
            topics,
            node: config.node.clone(),
            period: Duration::from_secs_f64(1.0 / config.rate),
            tf_period: 1.0 / config.tf_rate,
            next_status: 0.0,
            next_diagnostics: DIAGNOSTICS,
            next_tf: 0.0,
            last_status: String::new(),
            cycles: 0,
            longest: 0.0,
            late: 0,
        }
    }

    /// Until a signal, and then until the robot is at rest. Returns the number of messages that are
    /// not in the record.
    fn run(mut self, signals: &Signals) -> Result<u64> {
        let start = Instant::now();
        let mut next = start;
        let mut end = None;
        loop {
            if end.is_none() && signals.came() {
                self.controller.shut_down();
                end = Some(Instant::now() + LONGEST_STOP);
            }
            let began = Instant::now();
            self.once(began.duration_since(start).as_secs_f64());
            self.longest = self.longest.max(began.elapsed().as_secs_f64());
            self.cycles += 1;
            if end.is_some_and(|end| self.controller.is_idle() || Instant::now() > end) {
                break;
            }
            next += self.period;
            match next.checked_duration_since(Instant::now()) {
                Some(left) => thread::sleep(left),
                // Cycles that were missed are not made up for.
                None => (next, self.late) = (Instant::now(), self.late + 1),
            }
        }
        thread::sleep(FAREWELL);
        self.topics.finish()
    }

    fn once(&mut self, now: f64) {
        self.topics.receive(&mut self.controller, now);
        let output = self.controller.step(now);
        if let Some(command) = output.command {
            self.topics.command(command);
        }
        if let Some(state) = self.controller.state().filter(|_| now >= self.next_tf) {
            self.topics.tf(|stamp| self.frames.at(state, stamp));
            self.next_tf = now + self.tf_period;
        }
        self.report(&output.report, now);
    }

    /// The status when it changes, and now and then; diagnostics once a second.
    fn report(&mut self, report: &Report, now: f64) {
        let text = report.text();
        let state = |text: &str| text.split(':').next().map(str::to_owned);
        let changed = state(&text) != state(&self.last_status);
        if changed
            || now >= self.next_status
            || report.state == State::Stopped && text != self.last_status
        {
            self.topics.status(text.clone());
            self.next_status = now + REPEAT;
            self.last_status = text;
        }
        if now >= self.next_diagnostics {
            let since = now - (self.next_diagnostics - DIAGNOSTICS);
            let figures = [
                ("rate [Hz]", f64::from(self.cycles) / since),
                ("longest_cycle [s]", self.longest),
                ("late_cycles", f64::from(self.late)),
                ("lost_commands", self.topics.lost as f64),
            ];
            let robot = self.controller.servo().mechanism().name();
            self.topics.diagnostics(report.diagnostic(&self.node, robot, &figures));
            self.next_diagnostics = now + DIAGNOSTICS;
            (self.cycles, self.longest, self.late) = (0, 0.0, 0);
        }
    }
}
