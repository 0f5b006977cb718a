//! Parameters: options of the command line, keys of a TOML file, and ROS parameters that can be
//! read, under the same names.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use cylindroid::model::read_regular_file;
use ros2_client::ParameterValue;
use serde::{Deserialize, Serialize};

/// Largest file of parameters (bytes).
const LARGEST: u64 = 1 << 20;

/// What is published as a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum CommandKind {
    /// `trajectory_msgs/JointTrajectory` with one point: positions and velocities.
    Trajectory,
    /// `std_msgs/Float64MultiArray` of positions.
    Positions,
    /// `std_msgs/Float64MultiArray` of velocities.
    Velocities,
}

impl CommandKind {
    /// The topic that controllers of ros2_control listen to by default.
    const fn topic(self) -> &'static str {
        match self {
            Self::Trajectory => "joint_trajectory_controller/joint_trajectory",
            Self::Positions => "forward_position_controller/commands",
            Self::Velocities => "forward_velocity_controller/commands",
        }
    }
}

/// Parameters as given: what is missing has a default, see [`Config`].
#[derive(Debug, Clone, Default, PartialEq, clap::Args, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Parameters {
    /// A file (.urdf, .xml of MuJoCo, .sdf, .toml) or a catalogue name [default: the robot is read
    /// from the topic of --robot-description]
    pub robot: Option<String>,
    /// Topic of the robot's description, which is waited for if no robot is given [default:
    /// /robot_description]
    #[arg(long, value_name = "TOPIC")]
    pub robot_description: Option<String>,

    /// Name of the node, which `~` stands for in topics [default: servo_node]
    #[arg(long, value_name = "NAME", help_heading = "Graph")]
    pub node: Option<String>,
    /// Namespace of the node and of relative topics [default: /]
    #[arg(long, value_name = "NAME", help_heading = "Graph")]
    pub namespace: Option<String>,
    /// DDS domain, 0 to 232 [default: ROS_DOMAIN_ID, otherwise 0]
    #[arg(long, value_name = "N", help_heading = "Graph")]
    pub domain: Option<u16>,
    /// Network interfaces, by name or address; others are not announced and send no multicast
    /// [default: `lo` if ROS_AUTOMATIC_DISCOVERY_RANGE is LOCALHOST or ROS_LOCALHOST_ONLY is 1,
    /// otherwise all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', help_heading = "Graph")]
    pub interface: Option<Vec<String>>,

    /// Cycles per second [default: 250]
    #[arg(long, value_name = "HZ", help_heading = "Control")]
    pub rate: Option<f64>,
    /// The controlled frame [default: the tool of the model]
    #[arg(long, value_name = "NAME", help_heading = "Control")]
    pub frame: Option<String>,
    /// Controlled components: pose, position, orientation, pointing, or a list like x,y,rz
    /// [default: pose]
    #[arg(long, value_name = "TASK", help_heading = "Control")]
    pub task: Option<String>,
    /// Velocity for each unit of error [1/s] [default: 5]
    #[arg(long, value_name = "GAIN", help_heading = "Control")]
    pub gain: Option<f64>,
    /// The inverse of the Jacobian, with its parameters: NAME or NAME,PARAMETER=VALUE [default:
    /// truncated]
    #[arg(long, value_name = "INVERSE", help_heading = "Control")]
    pub inverse: Option<String>,
    /// Secondary tasks in the null space: NAME or NAME,PARAMETER=VALUE, or none; may be given
    /// several times [default: limit-avoidance for redundant arms and closed chains]
    #[arg(long, value_name = "TASK", help_heading = "Control")]
    pub secondary: Option<Vec<String>>,
    /// Largest speed of the tool [m/s] [default: none]
    #[arg(long, value_name = "M/S", help_heading = "Control")]
    pub linear_speed: Option<f64>,
    /// Largest angular speed of the tool [rad/s] [default: none]
    #[arg(long, value_name = "RAD/S", help_heading = "Control")]
    pub angular_speed: Option<f64>,
    /// Acceleration limit of joints without one in the model [rad/s^2 or m/s^2] [default: 20 rad/s^2,
    /// or lengths of the robot/s^2]
    #[arg(long, value_name = "A", help_heading = "Control")]
    pub acceleration: Option<f64>,
    /// Jerk limit of joints without one in the model [rad/s^3 or m/s^3] [default: none]
    #[arg(long, value_name = "J", help_heading = "Control")]
    pub jerk: Option<f64>,
    /// With --command velocities: time from a measurement until the drives have the command [s]
    /// [default: 0]
    #[arg(long, value_name = "S", help_heading = "Control")]
    pub delay: Option<f64>,
    /// With --command velocities: time constant of the drives [s] [default: 0]
    #[arg(long, value_name = "S", help_heading = "Control")]
    pub time_constant: Option<f64>,
    /// With --command velocities: largest error of the encoders [rad or m] [default: 0]
    #[arg(long, value_name = "RAD", help_heading = "Control")]
    pub noise: Option<f64>,

    /// Message of the commands [default: trajectory]
    #[arg(long, value_name = "KIND", help_heading = "Commands")]
    pub command: Option<CommandKind>,
    /// Joints of the commands, in the order of the controller [default: those that move the frame,
    /// in the order of the model]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', help_heading = "Commands")]
    pub joints: Option<Vec<String>>,
    /// Metres per second for a linear velocity of 1 in a twist, as `scale.linear` of MoveIt Servo
    /// with unitless commands [default: 1]
    #[arg(long, value_name = "M/S", help_heading = "Commands")]
    pub linear_scale: Option<f64>,
    /// Radians per second for an angular velocity of 1 in a twist [default: 1]
    #[arg(long, value_name = "RAD/S", help_heading = "Commands")]
    pub angular_scale: Option<f64>,

    /// Age of the last twist or pose at which the robot brakes [s] [default: 0.1]
    #[arg(long, value_name = "S", help_heading = "Safety")]
    pub command_timeout: Option<f64>,
    /// Age of a joint's position at which the robot brakes [s] [default: 0.2]
    #[arg(long, value_name = "S", help_heading = "Safety")]
    pub joint_state_timeout: Option<f64>,
    /// Distance of a joint from its commanded position at which the robot brakes, with commanded
    /// positions [rad or m] [default: 0.2]
    #[arg(long, value_name = "RAD", help_heading = "Safety")]
    pub following_error: Option<f64>,

    /// Topic of the joint states [default: /joint_states]
    #[arg(long, value_name = "TOPIC", help_heading = "Topics")]
    pub joint_states: Option<String>,
    /// Topic of commanded twists [default: ~/delta_twist_cmds]
    #[arg(long, value_name = "TOPIC", help_heading = "Topics")]
    pub twists: Option<String>,
    /// Topic of target poses [default: ~/target_pose]
    #[arg(long, value_name = "TOPIC", help_heading = "Topics")]
    pub poses: Option<String>,
    /// Topic of the joint commands [default: that of the controller for --command]
    #[arg(long, value_name = "TOPIC", help_heading = "Topics")]
    pub commands: Option<String>,
    /// Topic of the status [default: ~/status]
    #[arg(long, value_name = "TOPIC", help_heading = "Topics")]
    pub status: Option<String>,
    /// Whether to publish the frames on /tf [default: true, but false if the robot is read from the
    /// topic, since its robot_state_publisher does so]
    #[arg(long, value_name = "BOOL", help_heading = "Topics")]
    pub tf: Option<bool>,
    /// Frames are published so many times per second at most [default: 50]
    #[arg(long, value_name = "HZ", help_heading = "Topics")]
    pub tf_rate: Option<f64>,

    /// Records all messages that the node takes and publishes: an MCAP file
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
}

/// All parameters, checked as far as that is possible without the robot.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs)] // as in `Parameters`
pub struct Config {
    pub robot: Option<String>,
    pub robot_description: String,
    pub node: String,
    pub namespace: String,
    pub domain: Option<u16>,
    pub interface: Option<Vec<String>>,
    pub rate: f64,
    pub frame: Option<String>,
    pub task: String,
    pub gain: f64,
    pub inverse: String,
    pub secondary: Option<Vec<String>>,
    pub linear_speed: f64,
    pub angular_speed: f64,
    pub acceleration: Option<f64>,
    pub jerk: f64,
    pub delay: f64,
    pub time_constant: f64,
    pub noise: f64,
    pub command: CommandKind,
    pub joints: Option<Vec<String>>,
    pub linear_scale: f64,
    pub angular_scale: f64,
    pub command_timeout: f64,
    pub joint_state_timeout: f64,
    pub following_error: f64,
    pub joint_states: String,
    pub twists: String,
    pub poses: String,
    pub commands: String,
    pub status: String,
    pub tf: bool,
    pub tf_rate: f64,
    pub record: Option<PathBuf>,
}

impl Parameters {
    /// These parameters, the others from a file.
    ///
    /// # Errors
    /// A file that cannot be read, with the line of an unknown key or a wrong type.
    pub fn over_file(self, file: Option<&Path>) -> Result<Self> {
        let Some(path) = file else { return Ok(self) };
        let bytes = read_regular_file(path, LARGEST)?;
        let text = String::from_utf8(bytes).with_context(|| path.display().to_string())?;
        let below: Self = toml::from_str(&text).with_context(|| path.display().to_string())?;
        let mut all = toml::Table::try_from(below)?;
        all.extend(toml::Table::try_from(self)?);
        Ok(all.try_into()?)
    }

    /// With defaults for all that is missing.
    ///
    /// # Errors
    /// A value outside its domain.
    pub fn config(self) -> Result<Config> {
        let command = self.command.unwrap_or(CommandKind::Trajectory);
        let text = |given: Option<String>, default: &str| given.unwrap_or_else(|| default.into());
        let config = Config {
            tf: self.tf.unwrap_or(self.robot.is_some()),
            robot: self.robot,
            robot_description: text(self.robot_description, "/robot_description"),
            node: text(self.node, "servo_node"),
            namespace: text(self.namespace, "/"),
            domain: self.domain,
            interface: self.interface,
            rate: self.rate.unwrap_or(250.0),
            frame: self.frame,
            task: text(self.task, "pose"),
            gain: self.gain.unwrap_or(5.0),
            inverse: text(self.inverse, "truncated"),
            secondary: self.secondary,
            linear_speed: self.linear_speed.unwrap_or(f64::INFINITY),
            angular_speed: self.angular_speed.unwrap_or(f64::INFINITY),
            acceleration: self.acceleration,
            jerk: self.jerk.unwrap_or(f64::INFINITY),
            delay: self.delay.unwrap_or(0.0),
            time_constant: self.time_constant.unwrap_or(0.0),
            noise: self.noise.unwrap_or(0.0),
            command,
            joints: self.joints,
            linear_scale: self.linear_scale.unwrap_or(1.0),
            angular_scale: self.angular_scale.unwrap_or(1.0),
            command_timeout: self.command_timeout.unwrap_or(0.1),
            joint_state_timeout: self.joint_state_timeout.unwrap_or(0.2),
            following_error: self.following_error.unwrap_or(0.2),
            joint_states: text(self.joint_states, "/joint_states"),
            twists: text(self.twists, "~/delta_twist_cmds"),
            poses: text(self.poses, "~/target_pose"),
            commands: text(self.commands, command.topic()),
            status: text(self.status, "~/status"),
            tf_rate: self.tf_rate.unwrap_or(50.0),
            record: self.record,
        };
        config.check()?;
        Ok(config)
    }
}

impl Config {
    fn check(&self) -> Result<()> {
        for (name, value) in [
            ("rate", self.rate),
            ("linear_scale", self.linear_scale),
            ("angular_scale", self.angular_scale),
            ("command_timeout", self.command_timeout),
            ("joint_state_timeout", self.joint_state_timeout),
            ("following_error", self.following_error),
            ("tf_rate", self.tf_rate),
        ] {
            ensure!(
                value > 0.0 && value.is_finite(),
                "{name} = {value}: it must be positive and finite"
            );
        }
        ensure!(self.rate <= 1e4, "rate = {}: at most 10000 Hz", self.rate);
        if self.command != CommandKind::Velocities
            && [self.delay, self.time_constant, self.noise] != [0.0; 3]
        {
            bail!(
                "delay, time_constant and noise are of robots that are commanded velocities \
                 (--command velocities): the drives close the loop of positions"
            );
        }
        Ok(())
    }

    /// The parameters for the services of the node: those that have a value.
    ///
    /// # Errors
    /// Never, unless a parameter has a type that TOML lacks.
    pub fn declared(&self) -> Result<Vec<(String, ParameterValue)>> {
        let table = toml::Table::try_from(self)?;
        Ok(table.into_iter().filter_map(|(name, value)| Some((name, ros(value)?))).collect())
    }
}

fn ros(value: toml::Value) -> Option<ParameterValue> {
    Some(match value {
        toml::Value::String(text) => ParameterValue::String(text),
        toml::Value::Integer(number) => ParameterValue::Integer(number),
        toml::Value::Float(number) => ParameterValue::Double(number),
        toml::Value::Boolean(flag) => ParameterValue::Boolean(flag),
        toml::Value::Array(texts) => {
            let text = |t: toml::Value| t.as_str().map(str::to_owned);
            ParameterValue::StringArray(texts.into_iter().filter_map(text).collect())
        }
        _ => return None,
    })
}
