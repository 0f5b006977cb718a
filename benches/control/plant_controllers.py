"""What drives the plants: `start(motion, dt, plant)`, then joint velocities of the actuated coordinates
from their measured positions, `step(measured, target, twist)`."""

import logging

import mujoco
import numpy as np

import cylindroid as cy

logging.disable(logging.WARNING)
GAIN = 5.0
ACCELERATION = 10.0


class Cylindroid:
    name, is_told = "cylindroid", True
    inverse = "truncated"

    def __init__(self, robot):
        self.robot = robot

    def start(self, motion, dt, plant):
        robot = self.robot
        options = {"gain": GAIN, "dt": dt, "acceleration": ACCELERATION, "inverse": self.inverse}
        if self.is_told:
            options |= plant
        if robot.planar:
            options["task"] = "position"
        self.dt = dt
        self.servo = cy.Servo(robot.mechanism, robot.frame, **options)
        if robot.parallel:
            self.servo.start_from(robot.mechanism.home)
        self.refused = 0
        self.index = [robot.mechanism.joint_names.index(n) for n in robot.actuated]

    def step(self, measured, target, twist):
        step = self.servo.step_actuated if self.robot.parallel else self.servo.step
        try:
            return step(measured, target, feed_forward=twist)[self.index]
        except cy.CylindroidError:
            self.refused += 1
            return np.zeros(len(measured))


class Untold(Cylindroid):
    """Takes the robot for an ideal one, as the others do."""

    name, is_told = "cylindroid, ideal robot", False


class Mink:
    """mink; it takes no twist: the target is moved ahead by twist / gain, which does the same."""

    name, damping = "mink", 1e-12  # mink's own default

    def __init__(self, robot):
        import mink

        self.robot, self.mink = robot, mink

    def start(self, motion, dt, plant):
        mink = self.mink
        robot, self.dt, self.refused = self.robot, dt, 0
        model = mujoco.MjModel.from_xml_path(robot.urdf)
        self.state = mink.Configuration(model, motion.start)
        self.frame = mink.FrameTask(robot.frame, "body", position_cost=1.0, orientation_cost=1.0,
                                    gain=GAIN * dt, lm_damping=1e-3)
        posture = mink.PostureTask(model, 1e-3, gain=GAIN * dt)
        posture.set_target(motion.start)
        self.tasks = [self.frame, posture]
        names = [model.joint(j).name for j in range(model.njnt)]
        speeds = dict(zip(names, robot.limits[2]))
        self.limits = [mink.ConfigurationLimit(model), mink.VelocityLimit(model, speeds)]

    def step(self, measured, target, twist):
        mink = self.mink
        self.state.update(measured)
        ahead = target.copy()
        ahead[:3, 3] += twist[:3] / GAIN
        turn = np.concatenate([np.zeros(3), twist[3:] / GAIN])
        ahead[:3, :3] = cy.exp(turn)[:3, :3] @ target[:3, :3]
        self.frame.set_target(mink.SE3.from_matrix(ahead))
        try:
            return mink.solve_ik(self.state, self.tasks, self.dt, "daqp", self.damping,
                                 limits=self.limits)
        except mink.exceptions.MinkError:
            self.refused += 1
            return np.zeros(len(measured))


class DampedMink(Mink):
    """Less exact, but at rest where a target is out of reach."""

    name, damping = "mink, damping 0.01", 1e-2


class Legs:
    """Inverse kinematics of the legs in closed form, a gain on each of them and its speed: what a
    parallel robot is driven with in practice."""

    name = "loop on the drives"

    def __init__(self, robot):
        self.robot = robot

    def start(self, motion, dt, plant):
        self.dt, self.last, self.refused = dt, None, 0

    def step(self, measured, target, twist):
        desired = self.robot.inverse(target)
        ahead = np.zeros(len(measured)) if self.last is None else (desired - self.last) / self.dt
        self.last = desired
        lower, upper, fastest = self.robot.limits
        v = GAIN * (np.clip(desired, lower, upper) - measured) + ahead
        return np.clip(v, -fastest, fastest)


def of(robot):
    return [Cylindroid, Untold, Legs] if robot.parallel else [Cylindroid, Untold, Mink, DampedMink]
