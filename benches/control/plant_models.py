"""The robots that plants.py simulates: arms of robosuite as URDFs, a mobile arm of one of them, and
the five-bar and the Stewart platform of the catalogue, closed by constraints of MuJoCo."""

import math
import pathlib
import tomllib
from types import SimpleNamespace

import mujoco
import numpy as np

import cylindroid as cy
from models import IIWA_SPEEDS, Urdf, speeds

CATALOGUE = pathlib.Path(__file__).parents[2] / "crates/cylindroid/src/model/catalogue"
PI = math.pi
BEYOND = 0.3  # from a stretched pose to a target out of reach [m]
# Home, joint of the wrist that is zero at its singularity, joint of the elbow, speeds: FCI
# documentation (panda), data sheets.
ARMS = {
    "panda": ([0, -0.3, 0, -2.2, 0, 2.0, 0.8], 5, 3, [2.175] * 4 + [2.61] * 3),
    "ur5e": ([0, -1.6, 1.8, -1.7, -1.57, 0], 4, 2, [PI] * 6),
    "iiwa": ([0, 0.6, 0, -1.5, 0, 1.0, 0], 5, 3, IIWA_SPEEDS),
    "xarm7": ([0, 0.2, 0, 1.2, 0, 1.0, 0], 5, 3, [PI] * 7),
}


def turned(axis, angle):
    return cy.exp(np.concatenate([np.zeros(3), angle * np.asarray(axis)]))[:3, :3]


class Motion:
    """A target pose over time with its twist; `path(t)` is its pose."""

    def __init__(self, start, path, seconds, moves):
        self.start, self.path, self.seconds, self.moves = start, path, seconds, moves

    def at(self, t):
        pose = self.path(t)
        if not self.moves:
            return pose, np.zeros(6)
        h = 1e-4
        after, before = self.path(t + h), self.path(t - h)
        R = after[:3, :3] @ before[:3, :3].T
        turn = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2
        return pose, np.concatenate([after[:3, 3] - before[:3, 3], turn]) / (2 * h)


class Robot:
    """Circles and figures of eight of a robot of which `home_pose` is known."""

    parallel = planar = False
    load = 0.0  # least mass or inertia for which drives are tuned
    kinds = ["circle", "eight", "wrist", "edge"]
    radius, period, turn = 0.1, 4.0, 0.2

    def curve(self, kind, pose, start, rng):
        plane = np.eye(3) if self.planar else np.linalg.qr(rng.normal(size=(3, 3)))[0]
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        turn = 0.0 if self.planar else self.turn
        begin = rng.uniform(0, 2 * PI)

        def path(t):
            share = min(t / 2, 1.0)
            ramp = self.radius * share * share * (3 - 2 * share)
            phase = begin + 2 * PI * t / self.period
            flat = [math.cos(phase), math.sin(phase)] if kind == "circle" else \
                [math.sin(phase), math.sin(2 * phase) / 2]
            out = pose.copy()
            out[:3, 3] += ramp * (plane[:, 0] * flat[0] + plane[:, 1] * flat[1])
            if turn:
                out[:3, :3] = turned(axis, turn * ramp / self.radius * math.sin(phase)) @ \
                    pose[:3, :3]
            return out

        return Motion(start, path, 2 + 1.5 * self.period, True)

    def beyond(self, pose, start, away):
        """A target that cannot be reached."""
        target = pose.copy()
        target[:3, 3] += away
        return Motion(start, lambda t: target, 10.0, False)

    def drives(self, spec, mode, lag, stiffness, names, inertia):
        """Adds drives with a lag to joints."""
        for name, m in zip(names, inertia):
            drive = spec.add_actuator(name=name, target=name)
            drive.trntype = mujoco.mjtTrn.mjTRN_JOINT
            drive.dyntype = mujoco.mjtDyn.mjDYN_FILTEREXACT
            drive.dynprm[0] = lag
            drive.gaintype = mujoco.mjtGain.mjGAIN_FIXED
            drive.biastype = mujoco.mjtBias.mjBIAS_AFFINE
            if mode == "velocity":
                drive.gainprm[0] = m / 0.004
                drive.biasprm[2] = -m / 0.004
            else:
                # Critically damped.
                omega = 2 / stiffness
                drive.gainprm[0] = m * omega ** 2
                drive.biasprm[1:3] = [-m * omega ** 2, -2 * m * omega]

    def finish(self, spec, mode, lag, stiffness, names):
        spec.option.gravity = [0, 0, 0]
        spec.option.timestep = 0.001
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        for joint in spec.joints:
            joint.limited = False
            joint.frictionloss = 0
        still = spec.copy().compile()
        data = mujoco.MjData(still)
        self.place(still, data, self.home)
        mujoco.mj_forward(still, data)
        M = np.zeros((still.nv, still.nv))
        mujoco.mj_fullM(still, data, M)
        inertia = [max(M[i, i], self.load) for i in (still.joint(n).dofadr[0] for n in names)]
        self.drives(spec, mode, lag, stiffness, names, inertia)
        model = spec.compile()
        return model, mujoco.MjData(model)

    def actuated_of(self, model):
        return np.array([model.joint(n).id for n in self.actuated])


class Arm(Robot):
    """An arm of a URDF without geometry: the names of its hand and of the second link that moves,
    and the joints of wrist and elbow."""

    def __init__(self, name, urdf, home, wrist, elbow, frame, second):
        self.name, self.urdf, self.frame, self.second = name, str(urdf), frame, second
        self.home, self.wrist, self.elbow = np.array(home, float), wrist, elbow
        self.mechanism = cy.load(self.urdf)
        model = mujoco.MjModel.from_xml_path(self.urdf)
        self.actuated = [model.joint(j).name for j in range(model.njnt)]
        assert self.actuated == self.mechanism.joint_names
        self.limits = model.jnt_range[:, 0], model.jnt_range[:, 1], speeds(self.urdf, self.actuated)

    @classmethod
    def of_robosuite(cls, folder, arms, name, mobile=False):
        home, wrist, elbow, fast = ARMS[name]
        arm = mujoco.MjModel.from_xml_path(str(arms / name / "robot.xml"))
        label = f"mobile {name}" if mobile else name
        urdf, parent = Urdf(label), "floor"
        urdf.link(parent)
        if mobile:
            moves = [("base_x", "prismatic", [1, 0, 0], (-5, 5), 0.5),
                     ("base_y", "prismatic", [0, 1, 0], (-5, 5), 0.5),
                     ("base_yaw", "revolute", [0, 0, 1], (-6, 6), 1.0)]
            for joint, kind, axis, limits, speed in moves:
                urdf.link(f"{joint}_link", 20.0, moments=(1, 1, 1))
                urdf.joint(joint, parent, f"{joint}_link", (0, 0, 0), np.eye(3), axis, limits,
                           speed, kind)
                parent = f"{joint}_link"
            home, wrist, elbow = [0, 0, 0, *home], wrist + 3, elbow + 3
        urdf.mjcf(arm, parent, speeds=fast)
        path = urdf.write(folder / f"{label.replace(' ', '_')}.urdf")
        robot = cls(label, path, home, wrist, elbow, "right_hand",
                    arm.body(arm.jnt_bodyid[1]).name)
        if mobile:
            robot.radius, robot.period = 0.4, 10.0
        return robot

    def compile(self, mode, lag, stiffness):
        spec = mujoco.MjSpec.from_file(self.urdf)
        for joint in spec.joints:
            joint.armature = 0.1
        return self.finish(spec, mode, lag, stiffness, self.actuated)

    def place(self, model, data, q):
        data.qpos[:] = q

    def pose(self, model, data):
        body = data.body(self.frame)
        pose = np.eye(4)
        # The frames of the last physics step belong to the state before it.
        mujoco.mj_kinematics(model, data)
        pose[:3, :3], pose[:3, 3] = body.xmat.reshape(3, 3), body.xpos
        return pose

    def motion(self, kind, rng):
        lower, upper, _ = self.limits
        near = np.clip(self.home + rng.uniform(-0.3, 0.3, len(self.home)), lower + 0.1, upper - 0.1)
        pose = self.mechanism.fk(near, self.frame)
        if kind in ("circle", "eight"):
            return self.curve(kind, pose, near, rng)
        if kind == "edge":
            if "base_x" in self.actuated:
                return self.beyond(pose, near, [*rng.uniform(-1, 1, 2), 2.0])
            shoulder = self.mechanism.fk(near, self.second)[:3, 3]
            poses = []
            for angle in np.linspace(lower[self.elbow], upper[self.elbow], 400):
                bent = near.copy()
                bent[self.elbow] = angle
                poses.append(self.mechanism.fk(bent, self.frame))
            farthest = max(poses, key=lambda p: np.linalg.norm(p[:3, 3] - shoulder))
            outward = farthest[:3, 3] - shoulder
            return self.beyond(farthest, near, BEYOND * outward / np.linalg.norm(outward))
        end = near + 0.2 * rng.standard_normal(len(near))
        end = np.clip(end, lower + 0.01, upper - 0.01)
        end[self.wrist] = 0.0
        target = self.mechanism.fk(end, self.frame)
        return Motion(near, lambda t: target, 8.0, False)


class Parallel(Robot):
    """A mechanism of the catalogue; in MuJoCo all positions are zero at home."""

    parallel = True
    kinds = ["circle", "eight", "edge"]

    def __init__(self, name):
        self.name, self.frame = name, "reference"
        self.mechanism = cy.load(name)
        tables = tomllib.loads((CATALOGUE / f"{name}.toml").read_text())["joint"]
        self.joints = {t["name"]: SimpleNamespace(**t) for t in tables}
        self.home = self.mechanism.home
        self.actuated = list(self.mechanism.actuated)
        limits = [self.joints[n].limits for n in self.actuated]
        self.limits = tuple(np.array([x.get(key, default) for x in limits])
                            for key, default in (("lower", -np.inf), ("upper", np.inf),
                                                 ("velocity", np.inf)))
        self.home_pose = self.mechanism.fk(self.home, self.frame)

    def place(self, model, data, q):
        mujoco.mj_resetData(model, data)

    def pose(self, model, data):
        mujoco.mj_kinematics(model, data)
        site, pose = data.site("reference"), np.eye(4)
        pose[:3, :3], pose[:3, 3] = site.xmat.reshape(3, 3), site.xpos
        pose[:3, :3] = pose[:3, :3] @ self.home_pose[:3, :3]
        return pose

    def motion(self, kind, rng):
        if kind == "edge":
            return self.beyond(self.home_pose, self.home, self.outward(rng))
        return self.curve(kind, self.home_pose, self.home, rng)


def link(parent, name, origin, mass, size):
    """A body whose frame is parallel to the world's at `origin` (of the parent's axes)."""
    body = parent.add_body(name=name, pos=origin)
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[size, 0, 0], mass=mass, contype=0,
                  conaffinity=0)
    return body


def connect(spec, one, other, anchor):
    equality = spec.add_equality(type=mujoco.mjtEq.mjEQ_CONNECT, name1=one, name2=other,
                                 objtype=mujoco.mjtObj.mjOBJ_BODY)
    equality.data[:3] = anchor
    equality.solref[:2] = [0.003, 1]
    equality.solimp[:3] = [0.99, 0.999, 0.001]


class FiveBar(Parallel):
    planar = True
    def __init__(self):
        super().__init__("five-bar")

    def compile(self, mode, lag, stiffness):
        spec, at = mujoco.MjSpec(), {n: np.array([*j.origin, 0.0]) for n, j in self.joints.items()}
        parent, origin = spec.worldbody, np.zeros(3)
        for name, body in (("q1", "crank"), ("q2", "coupler"), ("q3", "rod"), ("q4", "rocker")):
            child = link(parent, body, at[name] - origin, 1.0, 0.1)
            child.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
            if body == "coupler":
                child.add_site(name="reference", pos=np.array([1.0, 2.0, 0.0]) - at[name])
            parent, origin = child, at[name]
        connect(spec, "rocker", "world", at["q5"] - at["q4"])
        return self.finish(spec, mode, lag, stiffness, self.actuated)

    def outward(self, rng):
        """Away from the pivot of the rocker: the rod and the rocker are stretched after 0.18 m."""
        angle = math.atan2(2, -1) + rng.uniform(-1, 1)
        return [math.cos(angle), math.sin(angle), 0]

    def inverse(self, target):
        """Crank 2 and coupler 1 long, at 90 and 0 degrees at home."""
        x, y = target[:2, 3]
        bend = -math.acos(min(1.0, max(-1.0, (x * x + y * y - 5) / 4)))
        crank = math.atan2(y, x) - math.atan2(math.sin(bend), 2 + math.cos(bend))
        return np.array([crank - PI / 2, bend + PI / 2])


class Stewart(Parallel):
    load = 5.0

    def __init__(self):
        super().__init__("stewart")

    def compile(self, mode, lag, stiffness):
        spec = mujoco.MjSpec()
        middle = self.home_pose[:3, 3]
        platform = link(spec.worldbody, "platform", middle, 5.0, 0.2)
        platform.add_freejoint(name="platform")
        platform.add_site(name="reference")
        for i in range(1, 7):
            u, leg, s = (self.joints[f"{k}{i}"] for k in ("u", "leg", "s"))
            foot, top = np.array(u.origin), np.array(s.origin)
            cylinder = link(spec.worldbody, f"cylinder{i}", foot, 1.0, 0.05)
            for label, axis in (("first", u.axis), ("second", u.axis2)):
                cylinder.add_joint(name=f"u{i}.{label}", type=mujoco.mjtJoint.mjJNT_HINGE,
                                   axis=axis, armature=0.01)
            rod = link(cylinder, f"rod{i}", top - foot, 1.0, 0.05)
            rod.add_joint(name=f"leg{i}", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=leg.axis)
            connect(spec, f"rod{i}", "platform", [0, 0, 0])
        return self.finish(spec, mode, lag, stiffness, self.actuated)

    def outward(self, rng):
        direction = rng.normal(size=3)
        return 1.5 * direction / np.linalg.norm(direction)

    def inverse(self, target):
        lengths = []
        for i in range(1, 7):
            foot, top = (np.array(self.joints[f"{k}{i}"].origin) for k in ("u", "s"))
            corner = self.home_pose[:3, :3].T @ (top - self.home_pose[:3, 3])
            here = target[:3, :3] @ corner + target[:3, 3]
            lengths.append(np.linalg.norm(here - foot) - np.linalg.norm(top - foot))
        return np.array(lengths)


def robots(folder, arms):
    serial = [Arm.of_robosuite(folder, arms, name) for name in ARMS]
    mobile = Arm.of_robosuite(folder, arms, "ur5e", mobile=True)
    return [*serial, mobile, FiveBar(), Stewart()]
