#!/usr/bin/env python3
"""Write forward kinematics, Jacobian and mass matrix reference vectors with Pinocchio.

    python3 -m venv VENV
    VENV/bin/pip install -r xtask/vectors/requirements.txt
    VENV/bin/python xtask/vectors/pinocchio_vectors.py \
        --out crates/cylindroid/tests/vectors/pinocchio

One JSON file per robot of the example-robot-data package. Random numbers are seeded:
with the pinned versions a second run gives the same files, up to rounding.

Conventions: the root link's frame is the world (fixed base). `q` and `qd` hold one number
per independent joint (radians or metres) in the order of `joints`; a continuous joint is an
angle, where Pinocchio wants its cosine and sine; mimic joints are not coordinates. A pose is
the top three rows of world_from_frame, row by row. Jacobian rows are linear first, then
angular. `local`, `world` and `local_world_aligned` are Pinocchio's reference frames of these
names, and `dot_*` is the derivative of each along `qd`, given for the first frame of a
configuration. `reach` is the largest distance of a listed frame from the origin. At a
configuration labelled "singular" the smallest of six singular values of the tip's Jacobian is
below 1e-6 (checked here): not always zero to rounding, as URDFs write pi / 2 as 1.5708.

`mass_matrix` is the lower triangle, row by row, of the mass matrix (kg, kg m, kg m^2) at the
first configuration, by the composite-rigid-body algorithm; links without <inertial> have no mass.

Mimic joints: the numbers come from a model built without mimic, where every joint is free. A
mimic joint is put at multiplier * leader + offset, and its column times the multiplier is
added to its leader's. Where Pinocchio accepts mimic=True, its poses, Jacobians and WORLD
derivative are compared with these. Pinocchio 4.1.0 refuses a leader that comes after its mimic
joint in its joint order (Romeo, Talos). A mimic tag on a fixed joint has no effect.

Derivatives: all three are getFrameJacobianTimeVariation of the model without mimic, each the
plain d/dt of the Jacobian of the same name; finite differences check it for every link. With
mimic=True, Pinocchio 4.1.0 gives LOCAL and LOCAL_WORLD_ALIGNED derivatives that disagree with
the finite differences of its own Jacobians, so they are not used.
"""

import argparse
import hashlib
import json
import math
import sysconfig
import xml.etree.ElementTree as ElementTree
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pinocchio as pin

FRAMES = {"local": pin.LOCAL, "world": pin.WORLD,
          "local_world_aligned": pin.LOCAL_WORLD_ALIGNED}
ROBOTS = {
    "allegro_right_hand": "allegro_hand_description/urdf/allegro_right_hand.urdf",
    "anymal_b": "anymal_b_simple_description/robots/anymal.urdf",
    "baxter": "baxter_description/urdf/baxter.urdf",
    "centauro": "centauro_description/urdf/centauro.urdf",
    "double_pendulum": "double_pendulum_description/urdf/double_pendulum.urdf",
    "pendulum_continuous": "double_pendulum_description/urdf/double_pendulum_continuous.urdf",
    "g1_with_hand": "g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf",
    "go2": "go2_description/urdf/go2.urdf",
    "icub": "icub_description/robots/icub.urdf",
    "iris": "iris_description/robots/iris.urdf",
    "kinova": "kinova_description/robots/kinova.urdf",
    "panda": "panda_description/urdf/panda.urdf",
    "pr2": "pr2_description/urdf/pr2.urdf",
    "romeo": "romeo_description/urdf/romeo.urdf",
    "romeo_laas_small": "romeo_description/urdf/romeo_laas_small.urdf",
    "so101": "so_arm_description/urdf/so101.urdf",
    "solo12": "solo_description/robots/solo12.urdf",
    "talos_full": "talos_data/robots/talos_full_v2.urdf",
    "talos_left_arm": "talos_data/robots/talos_left_arm.urdf",
    "tiago_no_hand": "tiago_description/robots/tiago_no_hand.urdf",
    "tiago_pro": "tiago_pro_description/robots/tiago_pro.urdf",
    "ur3": "ur_description/urdf/ur3_robot.urdf",
    "ur5": "ur_description/urdf/ur5_robot.urdf",
    "ur10": "ur_description/urdf/ur10_robot.urdf",
    "xarm7": "xarm_description/urdf/xarm7.urdf",
    "z1": "z1_description/urdf/z1.urdf",
}

# robot: (tip link, [(label, {joint: value}, joint to solve for or None)]). The other joints
# are random; a solved joint is put at a zero of the determinant of the tip's last six columns.
UR = ("tool0", [
    ("singular: elbow stretched", {"elbow_joint": 0.0}, None),
    ("singular: wrist aligned", {"wrist_2_joint": 0.0}, None),
    ("singular: shoulder", {}, "shoulder_lift_joint")])
SPECIAL = {
    "ur3": UR, "ur5": UR, "ur10": UR,
    "panda": ("panda_link8", [
        ("aligned: elbow", {"panda_joint4": 0.0}, None),
        ("aligned: wrist", {"panda_joint6": 0.0}, None),
        ("singular: upright", {"panda_joint2": 0.0, "panda_joint4": 0.0}, None),
        ("singular: shoulder and wrist", {"panda_joint2": 0.0}, "panda_joint6")]),
    "kinova": ("j2s6s200_link_6", [
        ("singular: elbow stretched", {"j2s6s200_joint_3": math.pi}, None),
        ("singular: wrist aligned", {"j2s6s200_joint_5": math.pi}, None),
        ("singular: shoulder", {}, "j2s6s200_joint_2")]),
    "xarm7": ("link7", [("singular: shoulder and elbow", {"joint2": 0.0}, "joint4")]),
    "z1": ("link06", [
        ("singular: wrist aligned", {"joint5": math.pi / 2}, None),
        ("singular: solved elbow", {}, "joint3")]),
    "talos_left_arm": ("arm_left_7_link", [
        ("singular: upper arm aligned", {"arm_left_3_joint": 0.0}, None),
        ("singular: elbow stretched", {"arm_left_4_joint": 0.0}, None),
        ("singular: wrist aligned", {"arm_left_6_joint": math.pi / 2}, None)]),
}


def numbers(array):
    return (np.asarray(array) + 0.0).tolist()  # the sum turns -0.0 into 0.0


class Robot:
    """A fixed-base Pinocchio model seen through its independent joints."""

    def __init__(self, urdf, mimic=False):
        self.urdf = urdf
        self.model = pin.buildModelFromUrdf(str(urdf), mimic)
        self.data = self.model.createData()
        self.links = [f.name for f in self.model.frames if f.type == pin.FrameType.BODY]
        tags = ElementTree.parse(urdf).getroot().findall("joint")
        parents = {tag.find("parent").get("link") for tag in tags}
        self.leaves = [link for link in self.links if link not in parents]
        names = list(self.model.names)[1:]
        mimics = {tag.get("name"): tag.find("mimic") for tag in tags
                  if tag.find("mimic") is not None and tag.get("name") in names}
        self.mimics = len(mimics)
        self.joints = [name for name in names if name not in mimics]
        # The joints Pinocchio has a column for stand at the angles scale @ q + offset.
        self.columns = self.joints if mimic else names
        self.scale = np.zeros((self.model.nv, len(self.joints)))
        self.offset = np.zeros(self.model.nv)
        for row, leader in enumerate(self.columns):
            scale = 1.0
            while leader in mimics:
                tag = mimics[leader]
                self.offset[row] += scale * float(tag.get("offset", 0.0))
                scale *= float(tag.get("multiplier", 1.0))
                leader = tag.get("joint")
            self.scale[row, self.joints.index(leader)] = scale

    def joint(self, name):
        return self.model.joints[self.model.getJointId(name)]

    def frame(self, link):
        return self.model.getFrameId(link, pin.FrameType.BODY)

    def update(self, q, qd):
        full = np.zeros(self.model.nq)
        for name, angle in zip(self.columns, self.scale @ q + self.offset):
            joint = self.joint(name)
            values = [angle] if joint.nq == 1 else [math.cos(angle), math.sin(angle)]
            full[joint.idx_q : joint.idx_q + joint.nq] = values
        pin.computeJointJacobiansTimeVariation(self.model, self.data, full, self.scale @ qd)
        pin.updateFramePlacements(self.model, self.data)

    def pose(self, link):
        return self.data.oMf[self.frame(link)].homogeneous[:3]

    def mass_matrix(self, q):
        """In the independent joints, from the model without mimic."""
        full = np.zeros(self.model.nq)
        for name, angle in zip(self.columns, self.scale @ q + self.offset):
            joint = self.joint(name)
            values = [angle] if joint.nq == 1 else [math.cos(angle), math.sin(angle)]
            full[joint.idx_q : joint.idx_q + joint.nq] = values
        upper = np.triu(pin.crba(self.model, self.model.createData(), full))
        whole = upper + upper.T - np.diag(np.diag(upper))
        return self.scale.T @ whole @ self.scale

    def jacobian(self, link, reference, function=pin.getFrameJacobian):
        return function(self.model, self.data, self.frame(link), reference) @ self.scale

    def jacobian_dot(self, link, reference):
        return self.jacobian(link, reference, pin.getFrameJacobianTimeVariation)

    def moving(self, link):
        return np.flatnonzero(np.abs(self.jacobian(link, pin.LOCAL)).max(axis=0))

    def limits(self, name):
        """Bounds to draw from: those of the URDF, or a full turn for an unlimited joint."""
        joint, model = self.joint(name), self.model
        lower, upper = (b[joint.idx_q] for b in (model.lowerPositionLimit, model.upperPositionLimit))
        bounded = joint.nq == 1 and 0.0 < upper - lower <= 4.0 * math.pi + 1e-3
        return (lower, upper) if bounded else (-math.pi, math.pi)


def check_derivatives(robot, q, qd, step=1e-3):
    """Compare with fourth-order central differences; the largest error."""
    total = {}
    for times, weight in ((-2, 1), (-1, -8), (1, 8), (2, -1)):
        robot.update(q + times * step * qd, qd)
        for key in [(link, frame) for link in robot.links for frame in FRAMES.values()]:
            total[key] = total.get(key, 0.0) + weight / (12 * step) * robot.jacobian(*key)
    robot.update(q, qd)
    worst = max(np.abs(total[key] - robot.jacobian_dot(*key)).max() for key in total)
    assert worst < 1e-9, f"derivatives differ from finite differences by {worst}"
    return worst


def check_mimic(robot, q, qd):
    """Compare with Pinocchio's own mimic joints, where it accepts them."""
    try:
        other = Robot(robot.urdf, mimic=True)
    except ValueError as error:
        return f"mimic=True refused: {error}"
    other.update(q, qd)
    worst = 0.0
    for link in robot.links:
        errors = [robot.jacobian(link, f) - other.jacobian(link, f) for f in FRAMES.values()]
        errors.append(robot.jacobian_dot(link, pin.WORLD) - other.jacobian_dot(link, pin.WORLD))
        errors.append(robot.pose(link) - other.pose(link))
        worst = max([worst] + [np.abs(error).max() for error in errors])
    assert worst < 1e-12, f"mimic=True differs by {worst}"
    return f"mimic=True agrees to {worst:.0e}"


def solve_singular(robot, q, tip, name):
    """Put one joint where the determinant of the tip's last six columns changes sign."""
    def determinant(value):
        q[robot.joints.index(name)] = value
        robot.update(q, 0.0 * q)
        return np.linalg.det(robot.jacobian(tip, pin.LOCAL)[:, robot.moving(tip)[-6:]])

    grid = np.linspace(*robot.limits(name), 102)[1:-1]
    for low, high in zip(grid, grid[1:]):
        sign = determinant(low)
        if sign * determinant(high) < 0.0:
            while low < (middle := 0.5 * (low + high)) < high:
                low, high = (middle, high) if sign * determinant(middle) > 0.0 else (low, middle)
            determinant(low)
            return True
    return False


def configurations(name, robot, rng):
    def draw(fixed):
        q = {joint: rng.uniform(*robot.limits(joint)) for joint in robot.joints} | fixed
        return np.array(list(q.values()))

    for number in range(3 if len(robot.joints) <= 20 else 2):
        yield f"random {number}", draw({})
    yield "zero", np.zeros(len(robot.joints))
    tip, cases = SPECIAL.get(name, (None, []))
    for label, fixed, solved in cases:
        q = draw(fixed)
        while solved is not None and not solve_singular(robot, q, tip, solved):
            q = draw(fixed)
        robot.update(q, 0.0 * q)
        smallest = np.linalg.svd(robot.jacobian(tip, pin.LOCAL), compute_uv=False)[5]
        assert (smallest < 1e-6) == label.startswith("singular"), f"{name} {label}: {smallest}"
        yield label, q


def choose_frames(robot, rng):
    """The links to give poses for, and the leaves to give Jacobians for."""
    count = len(robot.joints)
    inner = [link for link in robot.links if link not in robot.leaves]
    room = max((60 if count <= 20 else 36) - len(robot.leaves), 8)
    spread = inner if len(inner) <= room else [inner[i * len(inner) // room] for i in range(room)]
    poses = [link for link in robot.links if link in robot.leaves or link in spread]
    robot.update(rng.uniform(-1.0, 1.0, count), np.zeros(count))
    tips = {}  # by the joint that carries the leaf: mimic joints, then those after most joints
    for link in sorted(robot.leaves, key=lambda link: -len(robot.moving(link))):
        if len(robot.moving(link)):
            tips.setdefault(robot.model.frames[robot.frame(link)].parentJoint, link)
    tips = sorted(tips.items(), key=lambda tip: robot.model.names[tip[0]] in robot.joints)
    return poses, [link for _, link in tips][: 3 if count <= 8 else 2 if count <= 20 else 1]


def vectors(name, urdf):
    robot, rng = Robot(urdf), np.random.default_rng(list(name.encode()))
    links, tips = choose_frames(robot, rng)
    reach, error, mimic, records = 0.0, 0.0, "", []
    for number, (label, q) in enumerate(configurations(name, robot, rng)):
        qd = rng.uniform(-1.0, 1.0, len(q))
        error = max(error, check_derivatives(robot, q, qd))
        mimic = check_mimic(robot, q, qd) if robot.mimics else ""
        poses = {link: numbers(robot.pose(link).ravel()) for link in links}
        reach = max([reach] + [math.hypot(*pose[3::4]) for pose in poses.values()])
        jacobians = []
        for tip in tips[number % len(tips) :] + tips[: number % len(tips)]:
            entry = {"frame": tip}
            for key, frame in FRAMES.items():
                entry[key] = numbers(robot.jacobian(tip, frame))
                if not jacobians:
                    entry[f"dot_{key}"] = numbers(robot.jacobian_dot(tip, frame))
            jacobians.append(entry)
        records.append({"label": label, "q": numbers(q), "qd": numbers(qd),
                        "poses": poses, "jacobians": jacobians})
        if number == 0:
            mass = robot.mass_matrix(q)
            assert not np.any(robot.model.armature), "rotor inertias are not in the vectors"
            records[-1]["mass_matrix"] = numbers(mass[np.tril_indices(len(q))])
    print(f"{name}: {len(robot.joints)} joints, {robot.mimics} mimic, {len(links)} of "
          f"{len(robot.links)} links, {len(records)} cases, derivatives to {error:.0e}", mimic)
    return {"reach": reach, "joints": robot.joints, "configurations": records}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    out = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    package = Path(sysconfig.get_path("purelib"), "cmeel.prefix/share/example-robot-data")
    for name, relative in ROBOTS.items():
        urdf = package / "robots" / relative
        record = {
            "generator": "xtask/vectors/pinocchio_vectors.py", "pinocchio": pin.__version__,
            "example_robot_data": version("example-robot-data"),
            "robot": name, "urdf": relative,
            "sha256": hashlib.sha256(urdf.read_bytes()).hexdigest(),
        } | vectors(name, urdf)
        text = json.dumps(record, separators=(",", ":"), allow_nan=False) + "\n"
        (out / f"{name}.json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
