"""An arm in MuJoCo, velocity-controlled: an engine that knows nothing of us."""

import xml.etree.ElementTree as ElementTree

import mujoco
import numpy as np

import cylindroid as cy

PERIOD = 0.002  # 500 Hz
SUBSTEPS = 2
# How fast the velocity loop of a joint is [1/s]: a drive lags by a millisecond.
BANDWIDTH = 1000.0
# A joint that brakes before its limit goes beyond by its speed times the lag of its drive, so the
# controller's limits are inside those of the arm, as on a real one (rad).
MARGIN = 0.02


class Arm:
    """The arm of a URDF under gravity that its drives compensate, with velocity drives.

    MuJoCo's own joint limits are off: nothing but the controller keeps a joint within them.
    `robot` is the arm as the controller knows it.
    """

    def __init__(self, urdf, frame, locked=()):
        root = ElementTree.parse(urdf).getroot()
        for link in root.iter("link"):
            for part in link.findall("visual") + link.findall("collision"):
                link.remove(part)
        for joint in root.iter("joint"):
            if joint.get("name") in locked:
                joint.set("type", "fixed")
                for part in joint.findall("mimic"):
                    joint.remove(part)
        limits = {}
        for joint in root.iter("joint"):
            limit = joint.find("limit")
            if joint.get("type") == "revolute":
                lower, upper = float(limit.get("lower")), float(limit.get("upper"))
                limits[joint.get("name")] = lower, upper
                limit.set("lower", repr(lower + MARGIN))
                limit.set("upper", repr(upper - MARGIN))
        self.robot = cy.parse(ElementTree.tostring(root, encoding="unicode"))
        spec = mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"))
        spec.compiler.fusestatic = False
        spec.option.timestep = PERIOD / SUBSTEPS
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        for body in spec.bodies:
            body.gravcomp = 1.0
        self.joints = [joint.name for joint in spec.joints]
        for joint in spec.joints:
            joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
            actuator = spec.add_actuator(name=joint.name, target=joint.name)
            actuator.trntype = mujoco.mjtTrn.mjTRN_JOINT
            actuator.set_to_velocity(kv=1.0)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.body = self.model.body(frame).id
        self.size = len(self.joints)
        assert self.joints == self.robot.joint_names
        self.lower, self.upper = np.array([limits[name] for name in self.joints]).T
        # The farthest that any joint went beyond its limits; negative while none did.
        self.beyond = -np.inf

    def start(self, q):
        """At rest, the drives as stiff as the inertia that each joint feels there."""
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:] = q
        mujoco.mj_forward(self.model, self.data)
        inertia = np.zeros((self.size, self.size))
        mujoco.mj_fullM(self.model, self.data, inertia)
        kv = np.maximum(np.diag(inertia) * BANDWIDTH, 1e-3)
        self.model.actuator_gainprm[:, 0] = kv
        self.model.actuator_biasprm[:, 2] = -kv

    @property
    def q(self):
        return self.data.qpos.copy()

    @property
    def pose(self):
        """world_from_frame as the engine has it."""
        T = np.eye(4)
        T[:3, :3] = self.data.xmat[self.body].reshape(3, 3)
        T[:3, 3] = self.data.xpos[self.body]
        return T

    def run(self, rates):
        self.data.ctrl[:] = rates
        for _ in range(SUBSTEPS):
            mujoco.mj_step(self.model, self.data)
        beyond = np.maximum(self.data.qpos - self.upper, self.lower - self.data.qpos).max()
        self.beyond = max(self.beyond, beyond)
