"""The node in a loop over DDS: Cyclone DDS on the other side, in a network namespace that has nothing
but the loopback interface.

    unshare -rn python dds.py NODE [SECONDS]

Ten seconds, or with SECONDS a loop of that length with figures: rate, jitter, latency.
"""

import math
import os
import pathlib
import signal
import statistics
import subprocess
import sys
import tempfile
import time

DOMAIN = 87
#: The loopback interface alone, without multicast, which it does not have.
os.environ["CYCLONEDDS_URI"] = (
    f'<CycloneDDS><Domain Id="{DOMAIN}"><General><Interfaces><NetworkInterface name="lo"/>'
    "</Interfaces><AllowMulticast>false</AllowMulticast></General><Discovery>"
    "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>10</MaxAutoParticipantIndex>"
    '<Peers><Peer address="127.0.0.1"/></Peers></Discovery></Domain></CycloneDDS>'
)

sys.path.append(str(pathlib.Path(__file__).parents[2] / "cylindroid-py/tests"))

import ros_messages as ros  # noqa: E402
from cyclonedds.domain import DomainParticipant  # noqa: E402
from loopback import raise_loopback  # noqa: E402
from rosbags.highlevel import AnyReader  # noqa: E402
from simulated_robot import RATE, Robot  # noqa: E402

START = [0.0, -1.2, 1.6, -1.9, -1.5, 0.3]
NAMES = [
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
]
TIMEOUT = 0.1


def client(linear):
    """A process that commands a twist a hundred times per second, until it is killed."""
    twists = ros.writer(DomainParticipant(DOMAIN), "/servo_node/delta_twist_cmds", ros.TwistStamped)
    twist = ros.Twist(ros.Vector3(*linear), ros.Vector3())
    while True:
        twists.write(ros.TwistStamped(ros.Header(ros.Time(), "base"), twist))
        time.sleep(0.01)


def within(seconds, condition, what):
    """Waits for a condition."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"not within {seconds} s: {what}"
        time.sleep(0.005)


class Operator:
    """The topics of a person: targets out, status and frames in."""

    def __init__(self, participant, node="servo_node"):
        self.poses = ros.writer(participant, f"/{node}/target_pose", ros.PoseStamped)
        self.twists = ros.writer(participant, f"/{node}/delta_twist_cmds", ros.TwistStamped)
        self.statuses = ros.reader(participant, f"/{node}/status", ros.String, latched=True)
        self.frames = ros.reader(participant, "/tf", ros.TFMessage)
        self.diagnostics = ros.reader(participant, "/diagnostics", ros.DiagnosticArray)
        self.last, self.poses_of = "", {}

    def status(self):
        for message in self.statuses.take(N=10):
            self.last = message.data
        return self.last

    def tool(self):
        """Position of the tool at the root, from the tree of frames; nothing before it came."""
        for message in self.frames.take(N=10):
            for t in message.transforms:
                self.poses_of[t.child_frame_id] = (t.header.frame_id, t.transform)
        name, p = "tool0", (0.0, 0.0, 0.0)
        while name in self.poses_of:
            name, transform = self.poses_of[name]
            p = add(rotated(transform.rotation, p), transform.translation)
        return p if self.poses_of else None

    def at(self, p, q):
        pose = ros.Pose(ros.Point(*p), q)
        self.poses.write(ros.PoseStamped(ros.Header(ros.Time(), ""), pose))

    def orientation(self):
        """Of the tool at the root."""
        self.tool()
        name, q = "tool0", ros.Quaternion()
        while name in self.poses_of:
            name, transform = self.poses_of[name]
            q = product(transform.rotation, q)
        return q

    def towards(self, p, q, until, seconds, what):
        """Repeats a target pose."""
        end = time.monotonic() + seconds
        while not until(self.status()):
            assert time.monotonic() < end, f"{what}: {self.last}"
            self.at(p, q)
            time.sleep(0.02)


def product(a, b):
    return ros.Quaternion(
        a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
        a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
        a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
        a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
    )


def rotated(q, p):
    turned = product(product(q, ros.Quaternion(*p, 0.0)), ros.Quaternion(-q.x, -q.y, -q.z, q.w))
    return turned.x, turned.y, turned.z


def add(p, t):
    return p[0] + t.x, p[1] + t.y, p[2] + t.z


#: Processes of this test.
CHILDREN = []


def run(*words):
    CHILDREN.append(subprocess.Popen(words))
    return CHILDREN[-1]


def start(binary, *more):
    return run(binary, *more, "--domain", str(DOMAIN), "--interface", "lo")


def end(node):
    """Ctrl-C: a clean exit."""
    node.send_signal(signal.SIGINT)
    assert node.wait(timeout=10) == 0


def check(binary, participant, record):
    robot = Robot(participant, NAMES, START)
    operator = Operator(participant)
    node = start(binary, "ur5e", "--command-timeout", str(TIMEOUT), "--record", record)
    # Nothing is commanded before the joint states are complete.
    within(10, lambda: operator.status().startswith("waiting: no position of"), "waiting")
    assert all(name in operator.last for name in NAMES), operator.last
    for _ in range(10):
        operator.at((0.3, 0.2, 0.4), ros.Quaternion())
        time.sleep(0.02)
    assert not robot.taken() and operator.status().startswith("waiting")
    time.sleep(2.0 * TIMEOUT)
    robot.start()
    within(5, lambda: operator.status() == "at-rest", "at rest")
    within(5, operator.tool, "frames")
    assert not robot.taken()

    # A pose is reached: the frames say so.
    p, q = operator.tool(), operator.orientation()
    goal = (p[0] + 0.04, p[1] - 0.05, p[2] + 0.03)
    operator.towards(goal, q, lambda s: s == "reached", 5, "a pose")
    operator.towards(goal, q, lambda _: math.dist(operator.tool(), goal) < 1e-4, 2, "frames")
    assert robot.taken()
    within(2, lambda: operator.status() == "at-rest", "at rest after a pose")
    time.sleep(0.2)
    robot.taken()
    time.sleep(0.1)
    assert not robot.taken() and robot.speed() < 1e-6

    # A target out of reach, and one in a frame that is none of the robot.
    far = (3.0, 0.0, 0.5)
    operator.towards(far, q, lambda s: s.startswith("stalled: the target is"), 8, "out of reach")
    within(2, lambda: operator.status() == "at-rest", "at rest after a stall")
    operator.towards(goal, q, lambda s: s == "reached", 9, "the way back")
    within(2, lambda: operator.status() == "at-rest", "at rest again")
    header = ros.Header(ros.Time(), "camera")
    operator.poses.write(ros.PoseStamped(header, ros.Pose()))
    within(1, lambda: "no frame named 'camera'" in operator.status(), "a frame of others")

    # A client commands a twist and dies.
    before, robot.arrivals = operator.tool(), []
    child = run(sys.executable, __file__, "client", "-0.05", "0", "0.02")
    within(5, lambda: operator.status() == "following", "following a twist")
    within(5, lambda: operator.tool()[2] > before[2] + 0.01, "a motion up")
    assert operator.tool()[0] < before[0] - 0.02 and robot.speed() > 0.01
    child.kill()
    killed = time.monotonic()
    child.wait()
    within(2, lambda: operator.status() == "braking: no command for 0.1 s", "braking")
    within(2, lambda: robot.speed() < 1e-6, "rest after the client died")
    within(2, lambda: operator.status() == "at-rest", "silence after the client died")
    moving = [t for t, v in robot.taken() if v > 0.0]
    print(f"watchdog: the last moving command {moving[-1] - killed:.3f} s after the client died")
    stopped = operator.tool()
    time.sleep(0.2)
    assert math.dist(operator.tool(), stopped) < 1e-6 and not robot.taken()

    # Joint states cease: the robot brakes, although commands come.
    twist = ros.Twist(ros.Vector3(0.0, 0.05, 0.0), ros.Vector3())
    keep = lambda: operator.twists.write(ros.TwistStamped(ros.Header(), twist))  # noqa: E731
    within(3, lambda: keep() or operator.status() == "following", "following again")
    robot.is_silent = True
    within(3, lambda: keep() or operator.status().startswith("stopped: the position of"), "stale")
    assert robot.taken()[-1][1] == 0.0
    robot.is_silent = False
    within(3, lambda: keep() or operator.status() == "following", "following once more")

    # A drive that does not follow.
    robot.is_stuck = True
    does_not_follow = lambda s: s.startswith("stopped") and "does not follow" in s  # noqa: E731
    within(9, lambda: keep() or does_not_follow(operator.status()), "stuck drives")
    robot.is_stuck = False
    within(3, lambda: operator.status() == "at-rest", "at rest, let go")

    # Ctrl-C in the middle of a motion: it brakes first.
    # Let go, the joints jump to where they were sent: that is no motion of the node.
    within(2, lambda: robot.speed() < 1e-6, "rest, let go")
    robot.taken()
    follows = lambda: operator.status() == "following" and robot.speed() > 1e-3  # noqa: E731
    within(3, lambda: keep() or follows(), "a motion")
    end(node)
    within(2, lambda: robot.speed() < 1e-6, "rest after Ctrl-C")
    last = [v for _, v in robot.taken()]
    assert max(last) > 0.0 and last[-1] == 0.0, last
    robot.is_running = False
    robot.join()


def check_record(record):
    """What was recorded, read by rosbags with the definitions in the file."""
    with AnyReader([pathlib.Path(record)]) as bag:
        kinds = {c.topic: (c.msgtype, c.msgcount) for c in bag.connections}
        messages = {topic: [] for topic in kinds}
        for connection, _, raw in bag.messages():
            messages[connection.topic].append(bag.deserialize(raw, connection.msgtype))
    assert {topic: kind for topic, (kind, _) in kinds.items()} == {
        "/joint_states": "sensor_msgs/msg/JointState",
        "/servo_node/target_pose": "geometry_msgs/msg/PoseStamped",
        "/servo_node/delta_twist_cmds": "geometry_msgs/msg/TwistStamped",
        "/joint_trajectory_controller/joint_trajectory": "trajectory_msgs/msg/JointTrajectory",
        "/servo_node/status": "std_msgs/msg/String",
        "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
        "/tf": "tf2_msgs/msg/TFMessage",
    }, kinds
    assert all(count == len(messages[topic]) > 0 for topic, (_, count) in kinds.items()), kinds
    first = messages["/joint_states"][0]
    assert first.name == ["gripper", *reversed(NAMES)]
    assert list(first.position) == [0.04, *reversed(START)]
    commands = messages["/joint_trajectory_controller/joint_trajectory"]
    assert all(len(c.points) == 1 and c.joint_names == NAMES for c in commands)
    assert commands[0].points[0].time_from_start.nanosec == int(1e9 / RATE)
    assert not commands[-1].points[0].velocities.any()
    assert {"reached", "following", "at-rest"} < {s.data for s in messages["/servo_node/status"]}
    frames = {t.child_frame_id: t.header.frame_id for t in messages["/tf"][-1].transforms}
    assert frames["tool0"] == "flange", frames
    print(f"record: {sum(map(len, messages.values()))} messages of {len(messages)} topics")


URDF = """<robot name="lever"><link name="base"/><link name="arm"/><link name="hand"/>
<joint name="hinge" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" velocity="2" effort="9"/></joint>
<joint name="flange" type="fixed"><parent link="arm"/><child link="hand"/><origin xyz="0.5 0 0"/>
</joint></robot>"""


def check_description(binary, participant):
    """The robot from its topic, commanded velocities, an operator with a joystick."""
    description = ros.writer(participant, "/robot_description", ros.String, depth=1, latched=True)
    description.write(ros.String(URDF))
    robot = Robot(participant, ["hinge"], [0.2])
    robot.start()
    operator = Operator(participant, "lever")
    arguments = ["--command", "velocities", "--task", "x,y", "--node", "lever", "--frame", "hand"]
    plant = ["--time-constant", "0.01", "--delay", "0.008"]
    node = start(binary, *arguments, "--linear-scale", "0.2", *plant)
    within(10, lambda: operator.status() == "at-rest", "at rest")
    sideways = ros.Twist(ros.Vector3(0.0, 1.0, 0.0), ros.Vector3())
    stamped = ros.TwistStamped(ros.Header(ros.Time(), "hand"), sideways)
    move = lambda: operator.twists.write(stamped)  # noqa: E731
    within(5, lambda: move() or robot.q[0] > 0.6, "a turn of the lever")
    assert abs(robot.speed() - 0.4) < 0.02, robot.speed()
    at_limit = lambda: operator.status() == "stalled: at the limit of hinge"  # noqa: E731
    within(20, lambda: move() or at_limit(), "the limit")
    assert 0.97 < robot.q[0] < 1.005, robot.q  # a robot that is loaded may have longer delays
    assert not operator.frames.take(), "robot_state_publisher publishes them"
    end(node)
    robot.is_running = False
    robot.join()


def quantiles(values):
    values = sorted(values)
    last = len(values) - 1
    return [1e3 * values[round(share * last)] for share in (0.5, 0.99, 1.0)]


def measure(binary, participant, seconds):
    """Poses on a circle for so long: rate, jitter, tracking; then the latency of twists."""
    robot = Robot(participant, NAMES, START)
    robot.start()
    operator = Operator(participant)
    node = start(binary, "ur5e")
    within(10, lambda: operator.status() == "at-rest", "at rest")
    within(5, operator.tool, "frames")
    centre, q = operator.tool(), operator.orientation()
    began, targets, worst = time.monotonic(), 0, 0.0
    while time.monotonic() - began < seconds:
        angle = targets * 0.8
        goal = (centre[0], centre[1] + 0.08 * math.cos(angle), centre[2] + 0.08 * math.sin(angle))
        operator.towards(goal, q, lambda s: s == "moving", 5, "a new target of the circle")
        operator.towards(goal, q, lambda s: s == "reached", 5, "a target of the circle")
        settled = time.monotonic() + 0.06
        operator.towards(goal, q, lambda _: time.monotonic() > settled, 1, "rest")
        worst = max(worst, math.dist(operator.tool(), goal))
        targets += 1
    arrivals = [t for t, _ in robot.taken()]
    gaps = [b - a for a, b in zip(arrivals, arrivals[1:])]
    rate = (len(arrivals) - 1) / (arrivals[-1] - arrivals[0])
    print(f"{targets} targets reached in {seconds:.0f} s, within {1e3 * worst:.4f} mm")
    median, most, longest = quantiles(gaps)
    print(f"commands: {rate:.2f} Hz; gaps {median:.2f} ms, 99 % {most:.2f}, longest {longest:.2f}")

    latencies, stops = [], []
    for turn in range(40):
        within(3, lambda: operator.status() == "at-rest", "at rest")
        time.sleep(0.007 * (turn % 5))
        robot.taken()
        speed = 0.05 if turn % 2 else -0.05
        twist = ros.Twist(ros.Vector3(0.0, 0.0, speed), ros.Vector3())
        sent = time.monotonic()
        operator.twists.write(ros.TwistStamped(ros.Header(), twist))
        time.sleep(0.4)
        moving = [t for t, v in robot.taken() if v > 0.0]
        latencies.append(moving[0] - sent)
        stops.append(moving[-1] - sent)
    median, most, longest = quantiles(latencies)
    print(f"twist to command: {median:.2f} ms, 99 % {most:.2f}, longest {longest:.2f}")
    print(f"one twist moves for {statistics.median(stops) - statistics.median(latencies):.3f} s")
    figures = [s for m in operator.diagnostics.take(N=10) for s in m.status]
    print("last diagnostics:", {pair.key: pair.value for pair in figures[-1].values})
    assert worst < 1e-3, worst
    assert abs(rate - RATE) < 0.01 * RATE, f"{rate:.1f} Hz: is the machine busy?"
    end(node)
    robot.is_running = False
    robot.join()


if __name__ == "__main__":
    if sys.argv[1] == "client":
        client([float(x) for x in sys.argv[2:]] + [0.0] * (5 - len(sys.argv)))
    raise_loopback()
    sys.path.insert(0, str(pathlib.Path(__file__).parent))
    try:
        mine = DomainParticipant(DOMAIN)
        if len(sys.argv) > 2:
            measure(sys.argv[1], mine, float(sys.argv[2]))
        else:
            with tempfile.TemporaryDirectory() as folder:
                record = f"{folder}/loop.mcap"
                check(sys.argv[1], mine, record)
                check_record(record)
            check_description(sys.argv[1], mine)
    finally:
        for child in CHILDREN:
            child.kill()
    print("done")
