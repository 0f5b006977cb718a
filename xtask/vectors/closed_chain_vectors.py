#!/usr/bin/env python3
"""Write reference vectors of closed chains in files that nobody here wrote.

    VENV/bin/python xtask/vectors/closed_chain_vectors.py \
        --out crates/cylindroid/tests/vectors/closed_chains

Cassie (SDF of the example-robot-data package). The links are taken one by one: unknown are the
twist of every link but the root and the rate of every joint, and each joint, wherever it is in
the graph, says that the twist of its child is that of its parent and its own. No tree, no loop.
`smallest` and `dropped` are the singular values between which the rank is cut at 1e-9 of the
largest. `motions` is an orthonormal basis of the kernel's rates of hinges and slides, in the order
of `joints`, a column each; `redundant` the rows too many. Gearboxes are left out. Every motion is
checked at position level: the links moved by exp(+-h twist) keep every joint to order h^3.

Two arms and an object (URDF of the same package, the files two_*.toml of tests/data). The arms'
Jacobians are Pinocchio's. The least |rates|^2 of an arm that holds the object by the rows H of its
wrench at the contact is u^T A^T (H J J^T H^T)^-1 A u with A u = H (twist of the object at the
contact), so the efficiencies |u|^2 / |rates|^2 are the inverses of the eigenvalues of the sum of
these matrices. Units are metres and radians as they are (characteristic length 1 m).
"""

import argparse
import json
import sysconfig
import tomllib
import xml.etree.ElementTree as ElementTree
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pinocchio as pin

PACKAGE = Path(sysconfig.get_path("purelib"), "cmeel.prefix/share/example-robot-data/robots")
CASSIE = ["cassie", "cassie_reduced", "cassie_simple", "cassie_v2", "cassie_wo_gearbox_spring"]
CELLS = ["two_ur5", "two_arms"]
RANK = 1e-9


def rotation(rpy):
    """About the fixed axes x, y, z in this order."""
    (sr, sp, sy), (cr, cp, cy) = np.sin(rpy), np.cos(rpy)
    return np.array([
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr]])


def placement(node):
    numbers = np.array([float(x) for x in (node.findtext("pose") or "0 0 0 0 0 0").split()])
    return rotation(numbers[3:]), numbers[:3]


class Joint:
    """A joint of the SDF in the axes of the model: where it is and the twists it allows."""

    def __init__(self, node, links):
        self.name, self.kind = node.get("name"), node.get("type")
        self.parent, self.child = (node.findtext(end).strip() for end in ("parent", "child"))
        turn, at = links[self.child]
        own_turn, own_at = placement(node)
        self.point = at + turn @ own_at
        if self.kind == "ball":
            self.twists = [np.r_[np.cross(self.point, e), e] for e in np.eye(3)]
            return
        axis = node.find("axis")
        z = np.array([float(x) for x in axis.findtext("xyz").split()])
        if (axis.findtext("use_parent_model_frame") or "0").strip() not in ("1", "true"):
            z = turn @ own_turn @ z
        self.axis = z / np.linalg.norm(z)
        turns = np.r_[np.cross(self.point, self.axis), self.axis]
        slides = np.r_[self.axis, np.zeros(3)]
        self.twists = [{"revolute": turns, "prismatic": slides}[self.kind]]

    def opened(self, parent, child):
        """How far from closed the joint is after the two links moved (poses in the world)."""
        relative = np.linalg.solve(parent, child)
        moved = (relative @ np.r_[self.point, 1.0])[:3] - self.point
        if self.kind == "ball":
            return np.abs(moved).max()
        turned = relative[:3, :3] @ self.axis - self.axis
        if self.kind == "revolute":
            return max(np.abs(moved).max(), np.abs(turned).max())
        across = moved - self.axis * (self.axis @ moved)
        return max(np.abs(across).max(), np.abs(relative[:3, :3] - np.eye(3)).max())


def cassie(name):
    model = ElementTree.parse(PACKAGE / f"cassie_description/robots/{name}.sdf").find(".//model")
    links = {link.get("name"): placement(link) for link in model.findall("link")}
    known = [node for node in model.findall("joint") if node.get("type") != "gearbox"]
    joints = [Joint(node, links) for node in known]
    root = "world" if any(j.parent == "world" for j in joints) else next(iter(links))
    moving = [link for link in links if link != root]
    column = {link: 6 * i for i, link in enumerate(moving)}
    rates = sum(len(j.twists) for j in joints)
    matrix = np.zeros((6 * len(joints), 6 * len(moving) + rates))
    at, one = 6 * len(moving), {}
    for i, joint in enumerate(joints):
        rows = slice(6 * i, 6 * i + 6)
        for link, sign in ((joint.child, 1.0), (joint.parent, -1.0)):
            if link != root:
                matrix[rows, column[link] : column[link] + 6] = sign * np.eye(6)
        for twist in joint.twists:
            matrix[rows, at] = -twist
            if len(joint.twists) == 1:
                one[joint.name] = at
            at += 1
    values, right = np.linalg.svd(matrix)[1:]
    rank = int((values > RANK * values[0]).sum())
    kernel = right[rank:].T
    # At position level: central differences, so that what is left is of third order.
    h = 1e-4
    for motion in kernel.T:
        motion = motion / np.abs(motion).max()

        def pose(link, step):
            if link == root:
                return np.eye(4)
            return pin.exp6(step * motion[column[link] : column[link] + 6]).homogeneous

        for joint in joints:
            gap = max(joint.opened(pose(joint.parent, s), pose(joint.child, s)) for s in (h, -h))
            assert gap < 20 * h * h, f"{name} {joint.name}: opens by {gap}"
    span, weights, _ = np.linalg.svd(kernel[list(one.values())], full_matrices=False)
    motions = span[:, weights > 1e-6]
    dropped = values[rank] if rank < len(values) else 0.0
    print(name, f"{len(moving)} links, {len(joints)} joints, {matrix.shape[1] - rank} motions,",
          f"rank between {values[rank - 1]:.1e} and {dropped:.1e}, {motions.shape[1]} of hinges")
    return {"file": f"{name}.sdf", "dof": matrix.shape[1] - rank,
            "redundant": matrix.shape[0] - rank, "smallest": values[rank - 1] / values[0],
            "dropped": dropped / values[0], "joints": list(one), "motions": motions.tolist()}


def cell(name, folder):
    text = (folder / f"{name}.toml").read_text().replace("ROBOTS", str(PACKAGE))
    file = tomllib.loads(text)
    point = np.array(file["reference_point"])
    effort, held, joints = np.zeros((6, 6)), 0, 0
    for robot, contact in zip(file["robot"], file["contact"]):
        model = pin.buildModelFromUrdf(robot["model"], mimic=True)
        start = np.zeros(model.nq)
        for joint, angle in robot["start"].items():
            start[model.joints[model.getJointId(joint)].idx_q] = angle
        data = model.createData()
        pin.computeJointJacobians(model, data, start)
        pin.updateFramePlacements(model, data)
        link = contact["between"][0].split("/")[1]
        frame = model.getFrameId(link, pin.FrameType.BODY)
        jacobian = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
        base = robot["base"]
        turn = rotation(np.array(base.get("rpy", [0.0, 0.0, 0.0])))
        tip = turn @ data.oMf[frame].translation + np.array(base["xyz"])
        print(name, robot["name"], "tip at", tip.round(4).tolist())
        linear, angular = turn @ jacobian[:3], turn @ jacobian[3:]
        at = np.array(contact["point"])
        jacobian = np.vstack([linear - np.cross(at - tip, angular.T).T, angular])
        cross = pin.skew(at - point)
        object_at = np.block([[np.eye(3), -cross], [np.zeros((3, 3)), np.eye(3)]])
        normal = np.array(contact.get("normal", [0, 0, 1]), dtype=float)
        normal /= np.linalg.norm(normal)
        rows = {"complete": np.eye(6),
                "soft_finger": np.vstack([np.eye(6)[:3], np.r_[np.zeros(3), normal]])}
        rows = rows[contact["type"]]
        a, b = rows @ object_at, rows @ jacobian
        assert np.linalg.matrix_rank(b) == len(rows)
        effort += a.T @ np.linalg.solve(b @ b.T, a)
        held += len(rows)
        joints += model.nv
    efficiencies = np.sort(1.0 / np.linalg.eigvalsh(effort))[::-1]
    # Every arm reaches all its rows: counts follow.
    counts = {"dof": joints + 6 - held, "redundancy": joints - held, "indeterminacy": 0,
              "internal": held - 6, "zero_torque": 0, "hyperstatic": 0}
    print(name, counts, efficiencies)
    return {"file": f"{name}.toml", "counts": counts, "kinematic": efficiencies.tolist()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    out = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    folder = Path(__file__).parents[2] / "crates/cylindroid/tests/data"
    source = {"generator": "xtask/vectors/closed_chain_vectors.py", "pinocchio": pin.__version__,
              "numpy": np.__version__, "example_robot_data": version("example-robot-data")}
    for name, records in (("cassie", [cassie(name) for name in CASSIE]),
                          ("two_arms", [cell(name, folder) for name in CELLS])):
        text = json.dumps(source | {"cases": records}, separators=(",", ":")) + "\n"
        (out / f"{name}.json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
