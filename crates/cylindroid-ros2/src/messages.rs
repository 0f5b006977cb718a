//! The messages, field by field as in their `.msg` files: their order is the wire format.

use ros2_client::MessageTypeName;
use serde::{Deserialize, Serialize};

/// A message with the name of its type.
pub trait Named {
    /// Package and type.
    const TYPE: (&'static str, &'static str);

    /// The name as DDS knows it.
    #[must_use]
    fn type_name() -> MessageTypeName {
        MessageTypeName::new(Self::TYPE.0, Self::TYPE.1)
    }

    /// The name as in records, and the definition with those of all messages in it.
    #[must_use]
    fn schema() -> [std::string::String; 2]
    where
        Self: Field,
    {
        let mut all = Vec::new();
        Self::define(&mut all);
        let line = "=".repeat(80);
        let each = all.iter().enumerate().map(|(i, (name, text))| match i {
            0 => text.clone(),
            _ => format!("{line}\nMSG: {name}\n{text}"),
        });
        let (package, name) = Self::TYPE;
        [format!("{package}/msg/{name}"), each.collect()]
    }
}

/// A type of fields.
pub trait Field {
    /// Its name in `.msg` files.
    fn name() -> std::string::String;

    /// Adds the names and definitions of the messages in it, each once.
    fn define(_: &mut Vec<(std::string::String, std::string::String)>) {}
}

macro_rules! primitive {
    ($($kind:ty = $name:literal)+) => {$(
        impl Field for $kind {
            fn name() -> std::string::String {
                $name.to_owned()
            }
        }
    )+};
}

primitive! { u8 = "uint8" u32 = "uint32" i32 = "int32" f64 = "float64" std::string::String = "string" }

impl<T: Field> Field for Vec<T> {
    fn name() -> std::string::String {
        format!("{}[]", T::name())
    }

    fn define(all: &mut Vec<(std::string::String, std::string::String)>) {
        T::define(all);
    }
}

macro_rules! messages {
    ($($(#[doc = $doc:literal])+ $package:ident / $name:ident { $($field:ident: $kind:ty),* $(,)? })+) => {$(
        $(#[doc = $doc])+
        #[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
        #[allow(missing_docs)] // the fields are documented in their .msg files
        pub struct $name { $(pub $field: $kind),* }

        impl Named for $name {
            const TYPE: (&'static str, &'static str) = (stringify!($package), stringify!($name));
        }

        impl Field for $name {
            fn name() -> std::string::String {
                concat!(stringify!($package), "/", stringify!($name)).to_owned()
            }

            fn define(all: &mut Vec<(std::string::String, std::string::String)>) {
                if all.iter().any(|(name, _)| *name == Self::name()) {
                    return;
                }
                let fields = [$(format!("{} {}\n", <$kind as Field>::name(), stringify!($field))),*];
                all.push((Self::name(), fields.concat()));
                $(<$kind as Field>::define(all);)*
            }
        }
    )+};
}

messages! {
    /// A time.
    builtin_interfaces / Time { sec: i32, nanosec: u32 }
    /// A duration.
    builtin_interfaces / Duration { sec: i32, nanosec: u32 }
    /// Time and frame.
    std_msgs / Header { stamp: Time, frame_id: std::string::String }
    /// A text.
    std_msgs / String { data: std::string::String }
    /// The layout of an array: empty for lists.
    std_msgs / MultiArrayLayout { dim: Vec<MultiArrayDimension>, data_offset: u32 }
    /// One dimension of an array.
    std_msgs / MultiArrayDimension { label: std::string::String, size: u32, stride: u32 }
    /// Commands of the controllers forward_position_controller and forward_velocity_controller.
    std_msgs / Float64MultiArray { layout: MultiArrayLayout, data: Vec<f64> }
    /// A vector.
    geometry_msgs / Vector3 { x: f64, y: f64, z: f64 }
    /// A point.
    geometry_msgs / Point { x: f64, y: f64, z: f64 }
    /// A rotation; zero by default, which is none.
    geometry_msgs / Quaternion { x: f64, y: f64, z: f64, w: f64 }
    /// Position and rotation.
    geometry_msgs / Pose { position: Point, orientation: Quaternion }
    /// A target of the tool.
    geometry_msgs / PoseStamped { header: Header, pose: Pose }
    /// Velocities.
    geometry_msgs / Twist { linear: Vector3, angular: Vector3 }
    /// A commanded velocity of the tool.
    geometry_msgs / TwistStamped { header: Header, twist: Twist }
    /// Translation and rotation of a frame.
    geometry_msgs / Transform { translation: Vector3, rotation: Quaternion }
    /// The pose of a frame in its parent.
    geometry_msgs / TransformStamped {
        header: Header,
        child_frame_id: std::string::String,
        transform: Transform,
    }
    /// Poses of frames.
    tf2_msgs / TFMessage { transforms: Vec<TransformStamped> }
    /// Measured joints.
    sensor_msgs / JointState {
        header: Header,
        name: Vec<std::string::String>,
        position: Vec<f64>,
        velocity: Vec<f64>,
        effort: Vec<f64>,
    }
    /// A point of a trajectory.
    trajectory_msgs / JointTrajectoryPoint {
        positions: Vec<f64>,
        velocities: Vec<f64>,
        accelerations: Vec<f64>,
        effort: Vec<f64>,
        time_from_start: Duration,
    }
    /// Commands of the controller joint_trajectory_controller.
    trajectory_msgs / JointTrajectory {
        header: Header,
        joint_names: Vec<std::string::String>,
        points: Vec<JointTrajectoryPoint>,
    }
    /// A key with its value.
    diagnostic_msgs / KeyValue { key: std::string::String, value: std::string::String }
    /// State of a part of the robot.
    diagnostic_msgs / DiagnosticStatus {
        level: u8,
        name: std::string::String,
        message: std::string::String,
        hardware_id: std::string::String,
        values: Vec<KeyValue>,
    }
    /// States of parts of the robot.
    diagnostic_msgs / DiagnosticArray { header: Header, status: Vec<DiagnosticStatus> }
}

impl Duration {
    /// Of so many seconds.
    #[must_use]
    pub fn seconds(seconds: f64) -> Self {
        let sec = seconds.floor();
        // Conversions saturate.
        Self { sec: sec as i32, nanosec: ((seconds - sec) * 1e9) as u32 }
    }
}

impl Time {
    /// The time of the system's clock.
    #[must_use]
    pub fn now() -> Self {
        let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
        let since = since.unwrap_or_default();
        Self { sec: since.as_secs() as i32, nanosec: since.subsec_nanos() }
    }
}
