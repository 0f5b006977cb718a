"""The robots of the comparison, the same for everybody, and what is asked about them.

Each URDF is reduced to the joints that are compared and fixed joints are folded into placements,
so that nobody is charged for fingers, meshes or links that do not move. The result is written as
`NAME.chain` (plain numbers), `NAME.urdf` and `NAME.xml` (MJCF).
"""

import pathlib
import sys
import xml.etree.ElementTree as ET

import numpy as np

# name: (URDF, root link, tips); a tree has several tips.
ROBOTS = {
    "panda": ("{robots}/panda_description/urdf/panda.urdf", "panda_link0", ["panda_hand_tcp"]),
    "ur5": ("{robots}/ur_description/urdf/ur5_robot.urdf", "base_link", ["tool0"]),
    "iiwa14": (
        "{rtb}/xacro/kuka_description/kuka_lbr_iiwa/urdf/lbr_iiwa_14_r820.urdf",
        "base_link",
        ["tool0"],
    ),
    "g1_arm": (
        "{robots}/g1_description/urdf/g1_29dof_rev_1_0.urdf",
        "pelvis",
        ["left_rubber_hand"],
    ),
    "g1": (
        "{robots}/g1_description/urdf/g1_29dof_rev_1_0.urdf",
        "pelvis",
        [
            "left_ankle_roll_link",
            "right_ankle_roll_link",
            "left_rubber_hand",
            "right_rubber_hand",
            "head_link",
        ],
    ),
}
ARMS = ["panda", "ur5", "iiwa14", "g1_arm"]
TREE = "g1"
BATCH = 100_000
SINGLES = 256


def rotation(rpy):
    (r, p, y) = rpy
    (cr, sr), (cp, sp), (cy, sy) = ((np.cos(a), np.sin(a)) for a in (r, p, y))
    return np.array([
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ])


def placement(element):
    numbers = lambda name: [float(x) for x in (origin.get(name) or "0 0 0").split()]
    origin = element.find("origin")
    pose = np.eye(4)
    if origin is not None:
        pose[:3, :3], pose[:3, 3] = rotation(numbers("rpy")), numbers("xyz")
    return pose


class Robot:
    """Joints, parents first: name, parent (-1: ground), placement, axis, limits; tips likewise."""

    def __init__(self, name, urdf, root, tips):
        self.name = name
        above = {j.find("child").get("link"): j for j in ET.parse(urdf).getroot().iter("joint")
                 if j.find("child") is not None}
        self.joints, self.tips, place = [], [], {}

        def link(name):
            """The last joint on the way to a link, and where the link sits in it."""
            if name == root:
                return -1, np.eye(4)
            joint = above[name]
            parent, pose = link(joint.find("parent").get("link"))
            pose = pose @ placement(joint)
            if joint.get("type") == "fixed":
                return parent, pose
            if name not in place:
                limit = joint.find("limit")
                bounded = joint.get("type") == "revolute"
                assert bounded or joint.get("type") == "continuous", joint.get("type")
                self.joints.append({
                    "name": joint.get("name"), "parent": parent, "pose": pose,
                    "axis": np.array([float(x) for x in joint.find("axis").get("xyz").split()]),
                    "lower": float(limit.get("lower")) if bounded else -np.pi,
                    "upper": float(limit.get("upper")) if bounded else np.pi,
                    "velocity": float(limit.get("velocity")),
                })
                place[name] = len(self.joints) - 1
            return place[name], np.eye(4)

        self.tips = [(tip, *link(tip)) for tip in tips]
        self.n = len(self.joints)
        self.lower = np.array([j["lower"] for j in self.joints])
        self.upper = np.array([j["upper"] for j in self.joints])

    def forward(self, q):
        """The referee: world_from_joint (after the turn) of every joint, for many q (m x n)."""
        poses = []
        for i, joint in enumerate(self.joints):
            x, (s, c) = joint["axis"], (np.sin(q[:, i]), np.cos(q[:, i]))
            cross = np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])
            turn = np.zeros((len(q), 4, 4))
            turn[:, 3, 3] = 1
            turn[:, :3, :3] = (np.eye(3) + s[:, None, None] * cross
                               + (1 - c)[:, None, None] * (cross @ cross))
            base = joint["pose"] @ turn
            poses.append(base if joint["parent"] < 0 else poses[joint["parent"]] @ base)
        return poses

    def tip_poses(self, q, tip=0):
        _, parent, pose = self.tips[tip]
        return self.forward(q)[parent] @ pose

    def jacobians(self, q):
        """Of the first tip: linear rows first, its origin, world axes (m x 6 x n)."""
        poses, tip = self.forward(q), self.tip_poses(q)
        out = np.zeros((len(q), 6, self.n))
        i = self.tips[0][1]
        while i >= 0:
            axis = poses[i][:, :3, :3] @ self.joints[i]["axis"]
            out[:, :3, i] = np.cross(axis, tip[:, :3, 3] - poses[i][:, :3, 3])
            out[:, 3:, i] = axis
            i = self.joints[i]["parent"]
        return out

    def columns(self, q):
        """Of all joints: the twists of unit rates, at the world's origin and in its axes."""
        out = np.zeros((len(q), 6, self.n))
        for i, pose in enumerate(self.forward(q)):
            axis = pose[:, :3, :3] @ self.joints[i]["axis"]
            out[:, :3, i], out[:, 3:, i] = np.cross(pose[:, :3, 3], axis), axis
        return out

    def write(self, folder):
        text = lambda numbers: " ".join(f"{x:.17g}" for x in np.asarray(numbers).ravel())
        lines = [f"{self.n} {len(self.tips)}"]
        for j in self.joints:
            numbers = [*j["axis"], j["lower"], j["upper"], j["velocity"]]
            lines.append(f"{j['name']} {j['parent']} {text(j['pose'][:3])} {text(numbers)}")
        lines += [f"{name} {parent} {text(pose[:3])}" for name, parent, pose in self.tips]
        (folder / f"{self.name}.chain").write_text("\n".join(lines) + "\n")

        mass = ('<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0"'
                ' iyz="0"/></inertial>')
        origin = lambda pose: (f'<origin xyz="{text(pose[:3, 3])}" rpy="{text(rpy(pose))}"/>')
        out = [f'<robot name="{self.name}">', '<link name="base"/>']
        for i, j in enumerate(self.joints):
            parent = "base" if j["parent"] < 0 else f"link{j['parent']}"
            out.append(f'<link name="link{i}">{mass}</link>')
            out.append(
                f'<joint name="{j["name"]}" type="revolute"><parent link="{parent}"/>'
                f'<child link="link{i}"/>{origin(j["pose"])}<axis xyz="{text(j["axis"])}"/>'
                f'<limit lower="{j["lower"]:.17g}" upper="{j["upper"]:.17g}"'
                f' velocity="{j["velocity"]:.17g}" effort="100"/></joint>')
        for k, (_, parent, pose) in enumerate(self.tips):
            out.append(f'<link name="tip{k}"/>')
            out.append(f'<joint name="to_tip{k}" type="fixed"><parent link="link{parent}"/>'
                       f'<child link="tip{k}"/>{origin(pose)}</joint>')
        (folder / f"{self.name}.urdf").write_text("\n".join([*out, "</robot>"]) + "\n")

        def at(pose):
            x = f'pos="{text(pose[:3, 3])}"'
            # MuJoCo takes the first two columns of a rotation.
            return f'{x} xyaxes="{text(pose[:3, :2].T)}"'

        def body(i):
            j = self.joints[i]
            inner = "".join(body(k) for k, c in enumerate(self.joints) if c["parent"] == i)
            sites = "".join(f'<site name="tip{k}" {at(pose)}/>'
                            for k, (_, parent, pose) in enumerate(self.tips) if parent == i)
            return (f'<body {at(j["pose"])}><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
                    f'<joint axis="{text(j["axis"])}"/>{sites}{inner}</body>')

        roots = "".join(body(i) for i, j in enumerate(self.joints) if j["parent"] < 0)
        (folder / f"{self.name}.xml").write_text(
            f'<mujoco><compiler autolimits="true"/><worldbody>{roots}</worldbody></mujoco>\n')


def rpy(pose):
    m = pose[:3, :3]
    pitch = np.arctan2(-m[2, 0], np.hypot(m[0, 0], m[1, 0]))
    if np.hypot(m[0, 0], m[1, 0]) > 1e-12:
        return [np.arctan2(m[2, 1], m[2, 2]), pitch, np.arctan2(m[1, 0], m[0, 0])]
    return [np.arctan2(-m[1, 2], m[1, 1]), pitch, 0.0]


def load(robots, rtb):
    return {name: Robot(name, urdf.format(robots=robots, rtb=rtb), root, tips)
            for name, (urdf, root, tips) in ROBOTS.items()}


def write(all_robots, folder, targets, far):
    """Files of doubles: configurations `.q`, targets `.targets` (R by rows, p), and such that no
    configuration reaches, `.far`. Drawn evenly within the limits, the same on every run."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for robot in all_robots.values():
        random = np.random.default_rng(6)
        draw = lambda count: random.uniform(robot.lower, robot.upper, (count, robot.n))
        robot.write(folder)
        draw(BATCH).tofile(folder / f"{robot.name}.q")
        if robot.name not in ARMS:
            continue
        flat = lambda pose: np.hstack([pose[:, :3, :3].reshape(-1, 9), pose[:, :3, 3]])
        flat(robot.tip_poses(draw(targets))).tofile(folder / f"{robot.name}.targets")
        pose = robot.tip_poses(draw(far))
        # Farther from the first joint than all placements laid end to end.
        first = robot.joints[0]["pose"][:3, 3]
        length = (sum(np.linalg.norm(j["pose"][:3, 3]) for j in robot.joints[1:])
                  + np.linalg.norm(robot.tips[0][2][:3, 3]))
        away = pose[:, :3, 3] - first
        away /= np.linalg.norm(away, axis=1)[:, None]
        pose[:, :3, 3] = first + away * (length * random.uniform(1.05, 1.5, (far, 1)))
        flat(pose).tofile(folder / f"{robot.name}.far")


if __name__ == "__main__":
    write(load(*sys.argv[1:3]), sys.argv[3], 20, 20)
