//! Subscriptions and publications of the node, with the QoS of their counterparts in ROS 2.

use anyhow::{Context, Result, bail};
use ros2_client::dds::{Node, Publisher, Subscription};
use ros2_client::qos::{Durability, History, WhenFull};
use ros2_client::{Name, QosProfile};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::controller::{Command, Controller};
use crate::messages::{
    self, DiagnosticArray, Duration, Field, Float64MultiArray, Header, JointState, JointTrajectory,
    JointTrajectoryPoint, Named, PoseStamped, TFMessage, Time, TwistStamped,
};
use crate::parameters::{CommandKind, Config};
use crate::record::Recorder;

/// The full name of a topic: `~` stands for the node, relative names are in its namespace.
pub(crate) fn full_name(topic: &str, namespace: &str, node: &str) -> Result<Name> {
    let space = namespace.trim_end_matches('/');
    let full = match topic.strip_prefix('~') {
        Some(rest) if rest.starts_with('/') => format!("{space}/{node}{rest}"),
        Some(_) => bail!("topic '{topic}': write ~/NAME"),
        None if topic.starts_with('/') => topic.to_owned(),
        None => format!("{space}/{topic}"),
    };
    Name::parse(&full).with_context(|| format!("topic '{topic}'"))
}

/// Latched: late subscribers get the last message.
pub(crate) fn latched() -> QosProfile {
    reliable(1).durability(Durability::TransientLocal)
}

/// Full queues lose messages: a subscriber that is stuck must not stop the loop.
fn reliable(depth: usize) -> QosProfile {
    QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Fail)
        .history(History::KeepLast { depth })
}

/// Creates subscriptions and publications of a node.
pub(crate) struct Opener<'a> {
    pub(crate) node: &'a mut Node,
    pub(crate) config: &'a Config,
}

impl Opener<'_> {
    pub(crate) fn subscribe<M: Named + DeserializeOwned + 'static>(
        &mut self,
        topic: &str,
        qos: &QosProfile,
    ) -> Result<Input<M>> {
        let name = full_name(topic, &self.config.namespace, &self.config.node)?;
        let topic = self.node.create_topic(&name, M::type_name(), qos)?;
        let subscription = self.node.create_subscription(&topic, None)?;
        Ok(Input { name: name.to_string(), subscription })
    }

    fn publish<M: Named + Serialize>(
        &mut self,
        topic: &str,
        qos: &QosProfile,
    ) -> Result<Output<M>> {
        let name = full_name(topic, &self.config.namespace, &self.config.node)?;
        let topic = self.node.create_topic(&name, M::type_name(), qos)?;
        let publisher = self.node.create_publisher(&topic, None)?;
        Ok(Output { name: name.to_string(), publisher })
    }
}

/// A subscription, with the full name of its topic.
pub(crate) struct Input<M> {
    name: String,
    subscription: Subscription<M>,
}

impl<M: DeserializeOwned + 'static> Input<M> {
    /// The next message, if one came. One that cannot be read is skipped, as if it was lost.
    pub(crate) fn take(&self) -> Option<M> {
        self.subscription.take().ok().flatten().map(|(message, _)| message)
    }
}

/// A publication, with the full name of its topic.
struct Output<M: Serialize> {
    name: String,
    publisher: Publisher<M>,
}

/// The message of the commands.
enum Commands {
    Trajectory(Output<JointTrajectory>),
    Positions(Output<Float64MultiArray>),
    Velocities(Output<Float64MultiArray>),
}

/// The topics of a running node.
pub(crate) struct Topics {
    joint_states: Input<JointState>,
    poses: Input<PoseStamped>,
    twists: Input<TwistStamped>,
    commands: Commands,
    status: Output<messages::String>,
    diagnostics: Output<DiagnosticArray>,
    tf: Option<Output<TFMessage>>,
    record: Record,
    joint_names: Vec<String>,
    period: f64,
    /// Commands that a full queue refused.
    pub(crate) lost: u64,
}

impl Topics {
    pub(crate) fn open(opener: &mut Opener<'_>, joint_names: Vec<String>) -> Result<Self> {
        let config = opener.config;
        // Those of others may be of best effort, and of several nodes.
        let of_sensors =
            QosProfile::subscription_default().history(History::KeepLast { depth: 16 });
        let (commands, one) = (&config.commands, reliable(1));
        Ok(Self {
            joint_states: opener.subscribe(&config.joint_states, &of_sensors)?,
            poses: opener.subscribe(&config.poses, &one)?,
            twists: opener.subscribe(&config.twists, &one)?,
            commands: match config.command {
                CommandKind::Trajectory => Commands::Trajectory(opener.publish(commands, &one)?),
                CommandKind::Positions => Commands::Positions(opener.publish(commands, &one)?),
                CommandKind::Velocities => Commands::Velocities(opener.publish(commands, &one)?),
            },
            status: opener.publish(&config.status, &latched())?,
            diagnostics: opener.publish("/diagnostics", &one)?,
            tf: if config.tf { Some(opener.publish("/tf", &reliable(100))?) } else { None },
            record: Record(config.record.as_deref().map(Recorder::new).transpose()?),
            joint_names,
            period: 1.0 / config.rate,
            lost: 0,
        })
    }

    /// Hands all messages that came to the controller, joint states first.
    pub(crate) fn receive(&mut self, controller: &mut Controller, now: f64) {
        while let Some(message) = self.record.taken(&self.joint_states) {
            controller.joint_state(&message, now);
        }
        while let Some(message) = self.record.taken(&self.poses) {
            controller.pose(&message, now);
        }
        while let Some(message) = self.record.taken(&self.twists) {
            controller.twist(&message, now);
        }
    }

    pub(crate) fn command(&mut self, command: Command) {
        let array = |data| Float64MultiArray { data, ..Default::default() };
        let sent = match &self.commands {
            Commands::Positions(topic) => self.record.sent(topic, array(command.positions)),
            Commands::Velocities(topic) => self.record.sent(topic, array(command.velocities)),
            Commands::Trajectory(topic) => {
                let point = JointTrajectoryPoint {
                    positions: command.positions,
                    velocities: command.velocities,
                    time_from_start: Duration::seconds(self.period),
                    ..Default::default()
                };
                // Without a stamp it begins when it is received.
                let message = JointTrajectory {
                    header: Header::default(),
                    joint_names: self.joint_names.clone(),
                    points: vec![point],
                };
                self.record.sent(topic, message)
            }
        };
        self.lost += u64::from(!sent);
    }

    // What a person or a log reads may be lost.

    pub(crate) fn status(&mut self, data: String) {
        self.record.sent(&self.status, messages::String { data });
    }

    pub(crate) fn diagnostics(&mut self, status: messages::DiagnosticStatus) {
        let header = Header { stamp: Time::now(), frame_id: String::new() };
        self.record.sent(&self.diagnostics, DiagnosticArray { header, status: vec![status] });
    }

    /// Sends the transforms of a time, unless they cannot be computed.
    pub(crate) fn tf(&mut self, frames: impl FnOnce(&Time) -> cylindroid::Result<TFMessage>) {
        if let Some(tf) = &self.tf
            && let Ok(transforms) = frames(&Time::now())
        {
            self.record.sent(tf, transforms);
        }
    }

    /// Closes the record, if there is one; the messages that are not in it.
    pub(crate) fn finish(&mut self) -> Result<u64> {
        self.record.0.as_mut().map_or(Ok(0), Recorder::finish)
    }
}

/// Messages pass through it on their way.
struct Record(Option<Recorder>);

impl Record {
    fn taken<M>(&mut self, topic: &Input<M>) -> Option<M>
    where
        M: Named + Field + Serialize + DeserializeOwned + 'static,
    {
        let message = topic.take()?;
        if let Some(recorder) = &mut self.0 {
            recorder.record(&topic.name, &message);
        }
        Some(message)
    }

    /// True if it is on its way.
    fn sent<M: Named + Field + Serialize>(&mut self, topic: &Output<M>, message: M) -> bool {
        if let Some(recorder) = &mut self.0 {
            recorder.record(&topic.name, &message);
        }
        topic.publisher.publish(message).is_ok()
    }
}
