"""Against Pinocchio: every URDF of example-robot-data and rtb-data that it loads, every frame."""

import pathlib
import xml.etree.ElementTree as ElementTree

import numpy as np
import pinocchio as pin
import rtbdata

import cylindroid as cy

# What Pinocchio accepts and we refuse, with the reason.
REFUSED = {
    "alex_psyonic_hands.urdf": "mimic joint 'Left_index_q2' follows: no joint named 'index_q1'",
}


def files(robot_files):
    folders = robot_files, pathlib.Path(rtbdata.__file__).parent
    return [path for folder in folders for path in sorted(folder.rglob("*.urdf"))]


def loaded(path):
    """The model of Pinocchio, or None."""
    try:
        return pin.buildModelFromUrdf(str(path))
    except (ValueError, RuntimeError):
        return None


class Joints:
    """Values and columns of Pinocchio's joints, of which mimic joints are free ones."""

    def __init__(self, path, robot):
        self.place = {name: i for i, name in enumerate(robot.joint_names)}
        self.follows = {}
        for joint in ElementTree.parse(path).getroot().iter("joint"):
            mimic = joint.find("mimic")
            if mimic is not None and joint.get("type") not in (None, "fixed"):
                numbers = [float(mimic.get(k, d)) for k, d in (("multiplier", 1), ("offset", 0))]
                self.follows[joint.get("name")] = (mimic.get("joint"), *numbers)

    def of(self, name):
        """Coordinate, factor and offset of a joint."""
        factor, offset = 1.0, 0.0
        while name in self.follows:
            name, more, less = self.follows[name]
            offset += factor * less
            factor *= more
        return self.place[name], factor, offset


def compare(path, robot, model, count=3):
    joints = Joints(path, robot)
    data = model.createData()
    rng = np.random.default_rng(7)
    frames = [f.name for f in model.frames if f.type == pin.BODY]
    assert set(frames) <= set(robot.frames)
    lower, upper = np.maximum(robot.lower, -3), np.minimum(robot.upper, 3)
    Q = rng.uniform(np.minimum(lower, upper), upper, (count, robot.n))
    references = {
        "local": pin.LOCAL,
        "world": pin.WORLD,
        "local_world_aligned": pin.LOCAL_WORLD_ALIGNED,
    }
    poses = {f: robot.fk(Q, f) for f in frames}
    jacobians = {
        (f, r): robot.jacobian(Q, f, reference=r) for f in frames for r in references
    }
    scale = max(1.0, robot.reach)
    try:
        masses = robot.mass_matrix(Q)
    except cy.ModelError as error:
        assert "without mass" in str(error)
        masses = None
    worst = 0.0
    for i, q in enumerate(Q):
        theirs = pin.neutral(model)
        columns = np.zeros((model.nv, robot.n))
        for j in range(1, model.njoints):
            name, joint = model.names[j], model.joints[j]
            if joint.nv == 6:
                places = [robot.joint_names.index(f"{name}.{x}") for x in ("x", "y", "z", "rx", "ry", "rz")]
                rotation = pin.Quaternion(pin.exp3(q[places[3:]]))
                theirs[joint.idx_q : joint.idx_q + 7] = [*q[places[:3]], *rotation.coeffs()]
                columns[range(joint.idx_v, joint.idx_v + 6), places] = 1
                continue
            assert joint.nv == 1, f"{path.name}: {name} has {joint.nv} coordinates"
            place, factor, offset = joints.of(name)
            value = factor * q[place] + offset
            theirs[joint.idx_q : joint.idx_q + joint.nq] = (
                value if joint.nq == 1 else [np.cos(value), np.sin(value)]
            )
            columns[joint.idx_v, place] = factor
        if masses is not None and model.nv > 0:
            upper = np.triu(pin.crba(model, model.createData(), theirs))
            mass = columns.T @ (upper + upper.T - np.diag(np.diag(upper))) @ columns
            size = max(1.0, np.abs(mass).max())
            worst = max(worst, np.abs(masses[i] - mass).max() / size)
        pin.computeJointJacobians(model, data, theirs)
        pin.updateFramePlacements(model, data)
        for f in frames:
            frame = model.getFrameId(f, pin.BODY)
            expected = data.oMf[frame].homogeneous
            worst = max(worst, np.abs(poses[f][i] - expected).max() / scale)
            if model.nv == 0:  # Pinocchio crashes there
                assert robot.n == 0 and jacobians[f, "local"].shape == (count, 6, 0)
                continue
            for name, reference in references.items():
                J = pin.getFrameJacobian(model, data, frame, reference) @ columns
                worst = max(worst, np.abs(jacobians[f, name][i] - J).max() / scale)
    return worst, len(frames)


def test_every_robot_that_pinocchio_loads(robot_files, report):
    compared, frames, refused = 0, 0, {}
    for path in files(robot_files):
        model = loaded(path)
        if model is None:
            continue
        try:
            robot = cy.load(path)
        except cy.CylindroidError as error:
            refused[path.name] = str(error)
            continue
        worst, count = compare(path, robot, model)
        assert worst < 1e-10, f"{path.name}: {worst}"
        compared += 1
        frames += count
    assert compared >= 70 and frames > 2000, (compared, frames)
    assert refused.keys() == REFUSED.keys()
    for name, reason in REFUSED.items():
        assert reason in refused[name]
    report(f"Pinocchio: {compared} robots, {frames} frames")
