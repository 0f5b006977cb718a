"""The libraries behind one face: `Servo(scenario, dt, solver)`, `prepare(motion)` converts the
targets to the library's own types, `start(q)`, `step(k)` is what is timed, and `configuration()`
is the state as positions of a MuJoCo model that judges all."""

import logging
import math

import mink
import mujoco
import numpy as np
import pink
import pinocchio as pin
import placo
from mink.exceptions import MinkError
from pink.exceptions import PinkError

import cylindroid as cy

logging.disable(logging.WARNING)
POSTURE_COST, POSTURE_GAIN = 1e-3, 5.0


class Servo:
    """`joints` are the joints of the judge (without a base) in its order, `home` its positions."""

    solvers = ("",)

    def __init__(self, scenario, dt, judge, solver):
        self.scenario, self.dt, self.judge, self.solver = scenario, dt, judge, solver
        self.frames = scenario.poses + scenario.points
        self.failures = 0
        self.build()

    def moving(self, motion):
        """`(frame, targets)` of the frames whose targets move, poses or points."""
        return [(f, motion.targets[f]) for f in self.frames if f not in self.scenario.still]


class Cylindroid(Servo):
    name = "cylindroid"
    keep_directions = True

    def build(self):
        self.robot = cy.load(self.scenario.urdf)
        at = {n: i for i, n in enumerate(self.robot.joint_names)}
        self.index = [at[n] for n in self.judge.names]
        self.base = [at[f"base.{c}"] for c in ("x", "y", "z", "rx", "ry", "rz")] \
            if self.scenario.base else None

    def prepare(self, motion):
        self.q = np.zeros(self.robot.n)
        self.q[self.index] = self.judge.home
        if self.base:
            self.q[self.base[2]] = self.scenario.base
        start, gain, level = motion.start, 1 / self.dt, self.levels()
        tasks = [cy.FrameTask(f, start[f], gain=gain, name=f, level=level[f])
                 for f in self.scenario.poses]
        for f in self.scenario.points:
            pose = np.eye(4)
            pose[:3, 3] = start[f]
            tasks.append(cy.FrameTask(f, pose, gain=gain, name=f, components="position",
                                      level=level[f]))
        if self.scenario.com:
            com = cy.CenterOfMassTask(motion.com[0], gain=gain, name="com", level=level["com"])
            tasks.append(com)
        tasks.append(cy.PostureTask(self.q.copy(), gain=POSTURE_GAIN))
        self.servo = cy.TaskServo(self.robot, tasks, dt=self.dt, length=1.0,
                                  keep_directions=self.keep_directions)
        self.targets = [{} for _ in motion.times]
        for f, targets in self.moving(motion):
            for k, target in enumerate(targets):
                if target.shape == (3,):
                    pose = np.eye(4)
                    pose[:3, 3] = target
                    target = pose
                self.targets[k][f] = target
        if self.scenario.com:
            for k, target in enumerate(motion.com):
                self.targets[k]["com"] = target

    def levels(self):
        return dict.fromkeys([*self.frames, "com"], 0)

    def step(self, k):
        self.servo.step(self.q, self.targets[k])
        self.q = self.servo.advance(self.q)

    def configuration(self):
        base = self.robot.fk(self.q, frame="pelvis") if self.base else None
        return self.judge.positions(self.q[self.index], base)


class Levels(Cylindroid):
    """Feet that stay first, then the centre of mass, then each frame on a level of its own."""

    name = "cylindroid, by levels"

    def levels(self):
        order = [[f for f in self.frames if f in self.scenario.still], ["com"]]
        order += [[f] for f in self.frames if f not in self.scenario.still]
        return {f: i for i, together in enumerate(order) for f in together}


class LeastSquares(Cylindroid):
    """What limits stop is bent at once, as the others do."""

    name = "cylindroid, least squares"
    keep_directions = False


class Solutions(Cylindroid):
    """No servo: the robot jumps to a solution of the inverse kinematics near the last."""

    name = "cylindroid, ik each cycle"

    def step(self, k):
        answer = self.robot.ik(self.targets[k], q0=self.q, iterations=200)
        if answer.success:
            self.q = answer.q
        else:
            self.failures += 1


class Mink(Servo):
    name, solvers = "mink", ("daqp", "quadprog", "proxqp")

    def build(self):
        self.model = mujoco.MjModel.from_xml_path(self.scenario.urdf)

    def prepare(self, motion):
        self.state = mink.Configuration(self.model, self.judge.start)
        self.tasks, self.targets = [], []
        by = {}
        for f in self.frames:
            turn = 1.0 if f in self.scenario.poses else 0.0
            by[f] = mink.FrameTask(f, "body", position_cost=1.0, orientation_cost=turn)
            by[f].set_target_from_configuration(self.state)
            self.tasks.append(by[f])
        for f, targets in self.moving(motion):
            se3 = [mink.SE3.from_matrix(t) if t.shape == (4, 4) else mink.SE3.from_translation(t)
                   for t in targets]
            self.targets.append((by[f], se3))
        if self.scenario.com:
            com = mink.ComTask(cost=1.0)
            self.tasks.append(com)
            self.targets.append((com, motion.com))
        posture = mink.PostureTask(self.model, POSTURE_COST, gain=POSTURE_GAIN * self.dt)
        posture.set_target(self.judge.start)
        self.tasks.append(posture)
        speeds = dict(zip(self.judge.names, self.judge.speeds))
        self.limits = [mink.ConfigurationLimit(self.model), mink.VelocityLimit(self.model, speeds)]

    def step(self, k):
        for task, targets in self.targets:
            task.set_target(targets[k])
        try:
            v = mink.solve_ik(self.state, self.tasks, self.dt, self.solver, limits=self.limits)
        except MinkError:
            self.failures += 1
            return
        self.state.integrate_inplace(v, self.dt)

    def configuration(self):
        return self.state.q.copy()


class Pink(Servo):
    name, solvers = "pink", ("daqp", "quadprog", "proxqp")

    def build(self):
        self.model = pin.buildModelFromUrdf(self.scenario.urdf)
        self.ids = [self.model.getJointId(n) for n in self.judge.names]

    def prepare(self, motion):
        q = pin.neutral(self.model)
        for i, x in zip(self.ids, self.judge.home):
            at, wide = self.model.idx_qs[i], self.model.nqs[i] == 2
            q[at:at + 1 + wide] = [math.cos(x), math.sin(x)] if wide else [x]
        if self.scenario.base:
            q[2] = self.scenario.base
        self.state = pink.Configuration(self.model, self.model.createData(), q)
        self.tasks, self.targets, by = [], [], {}
        for f in self.frames:
            turn = 1.0 if f in self.scenario.poses else 0.0
            by[f] = pink.tasks.FrameTask(f, position_cost=1.0, orientation_cost=turn)
            by[f].set_target_from_configuration(self.state)
            self.tasks.append(by[f])
        for f, targets in self.moving(motion):
            se3 = [pin.SE3(t) if t.shape == (4, 4) else pin.SE3(np.eye(3), t) for t in targets]
            self.targets.append((by[f], se3))
        if self.scenario.com:
            com = pink.tasks.ComTask(cost=1.0)
            com.set_target(motion.com[0])
            self.tasks.append(com)
            self.targets.append((com, motion.com))
        posture = pink.tasks.PostureTask(cost=POSTURE_COST, gain=POSTURE_GAIN * self.dt)
        posture.set_target(q)
        self.tasks.append(posture)

    def step(self, k):
        for task, targets in self.targets:
            # ComTask.set_target is for moving targets too, it copies its argument.
            task.set_target(targets[k])
        try:
            v = pink.solve_ik(self.state, self.tasks, self.dt, self.solver, safety_break=False)
        except PinkError:
            self.failures += 1
            return
        self.state.integrate_inplace(v, self.dt)

    def configuration(self):
        q, out = self.state.q, []
        for i in self.ids:
            at = self.model.idx_qs[i]
            out.append(math.atan2(q[at + 1], q[at]) if self.model.nqs[i] == 2 else q[at])
        base = None
        if self.scenario.base:
            base = pin.XYZQUATToSE3(q[:7]).homogeneous
        return self.judge.positions(out, base)


class Placo(Servo):
    name = "PlaCo"

    def build(self):
        urdf = self.scenario.urdf
        self.urdf = urdf.replace("g1.urdf", "g1_fixed.urdf")

    def prepare(self, motion):
        self.robot = placo.RobotWrapper(self.urdf, placo.Flags.ignore_collisions)
        for name, x in zip(self.judge.names, self.judge.home):
            self.robot.set_joint(name, x)
        base = np.eye(4)
        base[2, 3] = self.scenario.base or 0.0
        self.robot.set_T_world_fbase(base)
        self.robot.update_kinematics()
        self.servo = placo.KinematicsSolver(self.robot)
        self.servo.dt = self.dt
        self.servo.enable_joint_limits(True)
        self.servo.enable_velocity_limits(True)
        self.servo.mask_fbase(self.scenario.base is None)
        by = {}
        for f in self.scenario.poses:
            by[f] = self.servo.add_frame_task(f, self.robot.get_T_world_frame(f))
            by[f].configure(f, "soft", 1.0, 1.0)
        for f in self.scenario.points:
            by[f] = self.servo.add_position_task(f, self.robot.get_T_world_frame(f)[:3, 3])
            by[f].configure(f, "soft", 1.0)
        self.targets = []
        for f, targets in self.moving(motion):
            field = "T_world_frame" if f in self.scenario.poses else "target_world"
            self.targets.append((by[f], field, targets))
        if self.scenario.com:
            com = self.servo.add_com_task(motion.com[0])
            com.configure("com", "soft", 1.0)
            self.targets.append((com, "target_world", motion.com))
        # It knows no gain; the weight makes what is left of the posture's pull as strong.
        posture = self.servo.add_joints_task()
        posture.set_joints(dict(zip(self.judge.names, self.judge.home)))
        posture.configure("posture", "soft", (POSTURE_COST * POSTURE_GAIN * self.dt) ** 2)
        self.servo.add_regularization_task(1e-12)

    def step(self, k):
        for task, field, targets in self.targets:
            setattr(task, field, targets[k])
        try:
            self.servo.solve(True)
        except RuntimeError:
            self.failures += 1
            return
        self.robot.update_kinematics()

    def configuration(self):
        base = self.robot.get_T_world_fbase() if self.scenario.base else None
        return self.judge.positions([self.robot.get_joint(n) for n in self.judge.names], base)


ALL = [Cylindroid, LeastSquares, Levels, Mink, Pink, Placo, Solutions]


def can(kind, scenario):
    """The inverse kinematics take poses of frames."""
    return kind is not Solutions or not (scenario.points or scenario.com)
