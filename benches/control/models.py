"""The robots of the comparison, each as one URDF without geometry that all libraries read:
`write(folder, data, hand, arms)` writes them and returns the scenarios.

`data` is the folder `robots` of example-robot-data, `hand` that of the Shadow hand in
gymnasium-robotics, `arms` that of the robots in robosuite."""

import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass, field

import mujoco
import numpy as np

# Maximum speeds of the KUKA LBR iiwa 14 R820 (brochure, technical data), in deg/s.
IIWA_SPEEDS = np.radians([85, 85, 100, 75, 130, 135, 135])
# The model of the Shadow hand states no speeds; these are ours.
HAND_SPEED = 2.0


@dataclass
class Scenario:
    """A robot and the tasks that move: `poses` and `points` are frames of which the pose or the
    position is controlled, `still` those of them whose target does not move."""

    name: str
    text: str
    urdf: str
    home: dict
    poses: list = field(default_factory=list)
    points: list = field(default_factory=list)
    still: list = field(default_factory=list)
    com: bool = False
    base: float | None = None  # height of a floating base
    amplitude: float = 0.1  # of the motion of the frames [m]
    turn: float = 0.3  # of their rotation [rad]
    com_amplitude: float = 0.02
    period: float = 4.0


def numbers(values):
    return " ".join(f"{x:.17g}" for x in values)


def rpy(R):
    """Roll, pitch and yaw of a rotation matrix."""
    pitch = math.atan2(-R[2, 0], math.hypot(R[0, 0], R[1, 0]))
    if math.hypot(R[0, 0], R[1, 0]) < 1e-9:
        return 0.0, pitch, math.atan2(-R[0, 1], R[1, 1])
    return math.atan2(R[2, 1], R[2, 2]), pitch, math.atan2(R[1, 0], R[0, 0])


def matrix(quaternion):
    R = np.zeros(9)
    mujoco.mju_quat2Mat(R, np.asarray(quaternion, float))
    return R.reshape(3, 3)


class Urdf:
    """A URDF under construction."""

    def __init__(self, name):
        self.root = ET.Element("robot", name=name)
        settings = ET.SubElement(self.root, "mujoco")
        ET.SubElement(settings, "compiler", fusestatic="false", balanceinertia="true",
                      boundmass="1e-9", boundinertia="1e-12")

    def link(self, name, mass=0.0, at=(0, 0, 0), axes=np.eye(3), moments=(0, 0, 0)):
        link = ET.SubElement(self.root, "link", name=name)
        if mass > 0:
            inertial = ET.SubElement(link, "inertial")
            inertia = axes @ np.diag(moments) @ axes.T
            ET.SubElement(inertial, "origin", xyz=numbers(at), rpy="0 0 0")
            ET.SubElement(inertial, "mass", value=f"{mass:.17g}")
            entries = {f"i{'xyz'[i]}{'xyz'[j]}": f"{inertia[i, j]:.17g}"
                       for i in range(3) for j in range(i, 3)}
            ET.SubElement(inertial, "inertia", **entries)

    def joint(self, name, parent, child, at, R, axis=None, limits=None, speed=None, kind=None):
        kind = kind or ("fixed" if axis is None else "revolute")
        joint = ET.SubElement(self.root, "joint", name=name, type=kind)
        ET.SubElement(joint, "parent", link=parent)
        ET.SubElement(joint, "child", link=child)
        ET.SubElement(joint, "origin", xyz=numbers(at), rpy=numbers(rpy(R)))
        if axis is not None:
            ET.SubElement(joint, "axis", xyz=numbers(axis))
            ET.SubElement(joint, "limit", lower=f"{limits[0]:.17g}", upper=f"{limits[1]:.17g}",
                          velocity=f"{speed:.17g}", effort="1000")

    def mjcf(self, model, parent, prefix="", at=np.zeros(3), speeds=None, tips=()):
        """Adds the moving bodies of a MuJoCo model below `parent`, with sites as links."""
        name = lambda text: prefix + text.replace("robot0:", "")
        for b in range(1, model.nbody):
            body = model.body(b)
            above = body.parentid[0]
            origin, R = body.pos.copy(), matrix(body.quat)
            if above == 0:
                origin = origin + at
            holder = name(model.body(above).name) if above else parent
            anchor = np.zeros(3)
            first, count = body.jntadr[0], body.jntnum[0]
            label = name(body.name)
            for j in range(first, first + count):
                joint = model.jnt(j)
                assert joint.type[0] == mujoco.mjtJoint.mjJNT_HINGE and joint.qpos0[0] == 0
                last = j == first + count - 1 and not joint.pos.any()
                child = label if last else f"{label}_{j}"
                if not last:
                    self.link(child)
                speed = HAND_SPEED if speeds is None else speeds[j]
                self.joint(name(joint.name), holder, child, origin + R @ (joint.pos - anchor), R,
                           joint.axis, joint.range, speed)
                holder, origin, R, anchor = child, np.zeros(3), np.eye(3), joint.pos.copy()
            if holder != label:
                self.joint(f"{label}_fixed", holder, label, origin - R @ anchor, R)
            self.link(label, body.mass[0], body.ipos, matrix(body.iquat), body.inertia)
        for site in tips:
            site = model.site(site)
            label = name(site.name)
            self.link(label)
            self.joint(f"{label}_fixed", name(model.body(site.bodyid[0]).name), label, site.pos,
                       matrix(site.quat))

    def write(self, path):
        ET.indent(self.root)
        ET.ElementTree(self.root).write(path)
        return str(path)


def reduced(source, path, moving, floating=None):
    """Writes a URDF without geometry, where all joints but `moving` are fixed; `floating` is the
    link below a free joint."""
    root = ET.parse(source).getroot()
    for tag in ("gazebo", "transmission", "material", "mujoco"):
        for element in root.findall(tag):
            root.remove(element)
    for link in root.findall("link"):
        for tag in ("visual", "collision"):
            for element in link.findall(tag):
                link.remove(element)
    for joint in root.findall("joint"):
        for tag in ("mimic", "safety_controller", "calibration", "dynamics"):
            for element in joint.findall(tag):
                joint.remove(element)
        if moving is not None and joint.get("name") not in moving:
            joint.set("type", "fixed")
            for tag in ("limit", "axis"):
                for element in joint.findall(tag):
                    joint.remove(element)
    if floating:
        ET.SubElement(root, "link", name="world")
        joint = ET.SubElement(root, "joint", name="base", type="floating")
        ET.SubElement(joint, "parent", link="world")
        ET.SubElement(joint, "child", link=floating)
    settings = ET.SubElement(root, "mujoco")
    ET.SubElement(settings, "compiler", fusestatic="false", balanceinertia="true",
                  boundmass="1e-9", boundinertia="1e-12")
    ET.ElementTree(root).write(path)
    return str(path)


def dual_iiwa(folder, arms):
    model = mujoco.MjModel.from_xml_path(str(arms / "iiwa/robot.xml"))
    urdf = Urdf("dual_iiwa")
    urdf.link("table")
    home = {}
    for prefix, y in (("left_", 0.4), ("right_", -0.4)):
        urdf.mjcf(model, "table", prefix, np.array([0, y, 0]), IIWA_SPEEDS)
        bend = [0, 0.6, 0, -1.3, 0, 1.2, 0]
        home |= {f"{prefix}joint_{i + 1}": q for i, q in enumerate(bend)}
    return Scenario(
        "dual iiwa", "two iiwa 14 on a table, poses of both hands",
        urdf.write(folder / "dual_iiwa.urdf"), home,
        poses=["left_right_hand", "right_right_hand"])


def shadow(folder, hand):
    model = mujoco.MjModel.from_xml_path(str(hand / "reach.xml"))
    urdf = Urdf("shadow_hand")
    urdf.link("table")
    tips = [f"robot0:S_{finger}tip" for finger in ("ff", "mf", "rf", "lf", "th")]
    # The scene holds more than the hand: bodies without joints stay as fixed links.
    urdf.mjcf(model, "table", tips=tips)
    home = {model.jnt(j).name.replace("robot0:", ""):
            0.5 * (max(model.jnt_range[j][0], -1.0) + min(model.jnt_range[j][1], 1.0))
            for j in range(model.njnt)}
    return Scenario(
        "Shadow hand", "positions of five fingertips, 24 joints with the wrist",
        urdf.write(folder / "shadow.urdf"), home,
        points=[t.replace("robot0:", "") for t in tips], amplitude=0.003, period=4.0)


def pr2(folder, data):
    arm = ["shoulder_pan", "shoulder_lift", "upper_arm_roll", "elbow_flex", "forearm_roll",
           "wrist_flex", "wrist_roll"]
    bend = {"shoulder_pan": 0.3, "shoulder_lift": 0.3, "upper_arm_roll": 0.4, "elbow_flex": -1.4,
            "forearm_roll": 0.3, "wrist_flex": -0.9, "wrist_roll": 0.2}
    home = {"torso_lift_joint": 0.15}
    for side, sign in (("l", 1), ("r", -1)):
        for joint in arm:
            mirrored = sign if joint.endswith(("pan", "roll")) else 1
            home[f"{side}_{joint}_joint"] = bend[joint] * mirrored
    path = reduced(data / "pr2_description/urdf/pr2.urdf", folder / "pr2.urdf", set(home))
    return Scenario("PR2", "torso and two arms, poses of both grippers", path, home,
                    poses=["l_gripper_tool_frame", "r_gripper_tool_frame"], amplitude=0.1,
                    period=6.0)


def g1(folder, data):
    source = data / "g1_description/urdf/g1_29dof_rev_1_0.urdf"
    reduced(source, folder / "g1_fixed.urdf", None)  # PlaCo adds a base of its own
    path = reduced(source, folder / "g1.urdf", None, floating="pelvis")
    home = {}
    for side, sign in (("left", 1), ("right", -1)):
        home |= {f"{side}_hip_pitch_joint": -0.4, f"{side}_knee_joint": 0.8,
                 f"{side}_ankle_pitch_joint": -0.4, f"{side}_shoulder_pitch_joint": 0.2,
                 f"{side}_shoulder_roll_joint": 0.25 * sign, f"{side}_elbow_joint": 0.7}
    feet = ["left_ankle_roll_link", "right_ankle_roll_link"]
    hands = ["left_rubber_hand", "right_rubber_hand"]
    return Scenario("G1", "floating base, poses of hands and feet, centre of mass", path, home,
                    poses=feet + hands, still=feet, com=True, base=0.72, amplitude=0.06,
                    turn=0.2)


def write(folder, data, hand, arms):
    return [dual_iiwa(folder, arms), shadow(folder, hand), pr2(folder, data), g1(folder, data)]


def speeds(urdf, names):
    """The velocity limits of joints."""
    joints = {j.get("name"): j for j in ET.parse(urdf).getroot().findall("joint")}
    return np.array([float(joints[n].find("limit").get("velocity")) for n in names])
