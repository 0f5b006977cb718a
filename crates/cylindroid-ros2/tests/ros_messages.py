"""The ROS 2 messages of the test as types of Cyclone DDS, and readers and writers of topics."""

from dataclasses import dataclass, field

from cyclonedds.core import Policy, Qos
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.annotations import final
from cyclonedds.idl.types import float64, int32, sequence, uint8, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration


def message(package):
    """A class as a message of this package."""

    def declare(cls):
        name, bases = f"{package}::msg::dds_::{cls.__name__}_", (IdlStruct,)
        namespace = type(IdlStruct).__prepare__(cls.__name__, bases, typename=name)
        namespace["__annotations__"] = cls.__annotations__
        for key in cls.__annotations__:
            if hasattr(cls, key):
                namespace[key] = getattr(cls, key)
        return final(dataclass(type(IdlStruct)(cls.__name__, bases, namespace)))

    return declare


def empty(kind):
    return field(default_factory=kind)


@message("builtin_interfaces")
class Time:
    sec: int32 = 0
    nanosec: uint32 = 0


@message("builtin_interfaces")
class Duration:
    sec: int32 = 0
    nanosec: uint32 = 0


@message("std_msgs")
class Header:
    stamp: Time = empty(Time)
    frame_id: str = ""


@message("std_msgs")
class String:
    data: str = ""


@message("std_msgs")
class MultiArrayDimension:
    label: str = ""
    size: uint32 = 0
    stride: uint32 = 0


@message("std_msgs")
class MultiArrayLayout:
    dim: sequence[MultiArrayDimension] = empty(list)
    data_offset: uint32 = 0


@message("std_msgs")
class Float64MultiArray:
    layout: MultiArrayLayout = empty(MultiArrayLayout)
    data: sequence[float64] = empty(list)


@message("geometry_msgs")
class Vector3:
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0


@message("geometry_msgs")
class Point:
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0


@message("geometry_msgs")
class Quaternion:
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0
    w: float64 = 1.0


@message("geometry_msgs")
class Pose:
    position: Point = empty(Point)
    orientation: Quaternion = empty(Quaternion)


@message("geometry_msgs")
class PoseStamped:
    header: Header = empty(Header)
    pose: Pose = empty(Pose)


@message("geometry_msgs")
class Twist:
    linear: Vector3 = empty(Vector3)
    angular: Vector3 = empty(Vector3)


@message("geometry_msgs")
class TwistStamped:
    header: Header = empty(Header)
    twist: Twist = empty(Twist)


@message("geometry_msgs")
class Transform:
    translation: Vector3 = empty(Vector3)
    rotation: Quaternion = empty(Quaternion)


@message("geometry_msgs")
class TransformStamped:
    header: Header = empty(Header)
    child_frame_id: str = ""
    transform: Transform = empty(Transform)


@message("tf2_msgs")
class TFMessage:
    transforms: sequence[TransformStamped] = empty(list)


@message("sensor_msgs")
class JointState:
    header: Header = empty(Header)
    name: sequence[str] = empty(list)
    position: sequence[float64] = empty(list)
    velocity: sequence[float64] = empty(list)
    effort: sequence[float64] = empty(list)


@message("trajectory_msgs")
class JointTrajectoryPoint:
    positions: sequence[float64] = empty(list)
    velocities: sequence[float64] = empty(list)
    accelerations: sequence[float64] = empty(list)
    effort: sequence[float64] = empty(list)
    time_from_start: Duration = empty(Duration)


@message("trajectory_msgs")
class JointTrajectory:
    header: Header = empty(Header)
    joint_names: sequence[str] = empty(list)
    points: sequence[JointTrajectoryPoint] = empty(list)


@message("diagnostic_msgs")
class KeyValue:
    key: str = ""
    value: str = ""


@message("diagnostic_msgs")
class DiagnosticStatus:
    level: uint8 = 0
    name: str = ""
    message: str = ""
    hardware_id: str = ""
    values: sequence[KeyValue] = empty(list)


@message("diagnostic_msgs")
class DiagnosticArray:
    header: Header = empty(Header)
    status: sequence[DiagnosticStatus] = empty(list)


def reliable(depth=10, latched=False):
    """The QoS of ROS 2's publishers and subscribers."""
    durability = Policy.Durability.TransientLocal if latched else Policy.Durability.Volatile
    return Qos(
        Policy.Reliability.Reliable(duration(milliseconds=100)),
        Policy.History.KeepLast(depth),
        durability,
        Policy.DataRepresentation(use_cdrv0_representation=True),
    )


def topic(participant, name, kind):
    return Topic(participant, f"rt/{name.lstrip('/')}", kind)


def reader(participant, name, kind, listener=None, **qos):
    return DataReader(participant, topic(participant, name, kind), reliable(**qos), listener)


def writer(participant, name, kind, **qos):
    return DataWriter(participant, topic(participant, name, kind), reliable(**qos))
