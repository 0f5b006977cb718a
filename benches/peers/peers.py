"""Peers with a Python face, each a process of its own: `peers.py NAME FOLDER`, commands as in
common.hpp."""

import math
import sys
import time

import numpy as np

BLOCK = 256


class Peer:
    """Defaults: pose and Jacobian by `kinematics(q)`, inverse kinematics by `solve(target)`."""

    def __init__(self, folder, name):
        self.folder, self.name = folder, name
        self.urdf = f"{folder}/{name}.urdf"
        lines = open(f"{folder}/{name}.chain").read().splitlines()
        self.n = int(lines[0].split()[0])
        rows = [line.split() for line in lines[1:]]
        self.numbers = [[float(x) for x in row[2:]] for row in rows[:self.n]]
        self.tip = np.vstack([np.reshape([float(x) for x in rows[self.n][2:]], (3, 4)),
                              [0, 0, 0, 1]])
        self.lower, self.upper = (np.array([r[i] for r in self.numbers]) for i in (15, 16))
        self.limits = list(zip(self.lower.tolist(), self.upper.tolist()))
        self.middle = 0.5 * (self.lower + self.upper)
        self.q = np.fromfile(f"{folder}/{name}.q").reshape(-1, self.n)
        self.poses = {}

    def targets(self, kind):
        if kind not in self.poses:
            suffix = "targets" if kind == "ik" else "far"
            rows = np.fromfile(f"{self.folder}/{self.name}.{suffix}").reshape(-1, 12)
            pose = np.tile(np.eye(4), (len(rows), 1, 1))
            pose[:, :3, :3], pose[:, :3, 3] = rows[:, :9].reshape(-1, 3, 3), rows[:, 9:]
            self.poses[kind] = pose
        return self.poses[kind]

    def prepare(self, tolerance):
        self.tolerance = tolerance

    def within(self, q):
        """The answer with whole turns taken away where it is outside, if it is inside then."""
        out = []
        for x, (lower, upper) in zip(q, self.limits):
            if not lower <= x <= upper:
                x = math.remainder(x, 2 * math.pi)
                if not lower <= x <= upper:
                    return None
            out.append(x)
        return out

    def answer(self, path, task, words):
        if task == "check":
            out = []
            for q in self.q[:BLOCK]:
                pose, jacobian = self.kinematics(q)
                pose = np.asarray(pose)
                jacobian = self.in_our_order(np.asarray(jacobian), pose)
                out += [pose[:3, :3].ravel(), pose[:3, 3], jacobian.ravel()]
            np.concatenate(out).tofile(path)
            return "ok"
        if task == "single":
            blocks, end = [], time.perf_counter_ns() + float(words[0]) * 1e6
            while time.perf_counter_ns() < end:
                begin = time.perf_counter_ns()
                for i in range(BLOCK):
                    self.kinematics(self.q[i])
                blocks.append((time.perf_counter_ns() - begin) / BLOCK)
            return f"{min(blocks)} {np.median(blocks)}"
        self.prepare(float(words[0]))
        targets, out = self.targets(task), []
        for target in targets[int(words[1]):int(words[2])]:
            begin = time.process_time_ns()
            q = self.solve(target)
            out.append([time.process_time_ns() - begin, q is not None,
                        *(self.middle if q is None else q)])
        np.array(out).tofile(path)
        return "ok"

    def in_our_order(self, jacobian, pose):
        return jacobian


class Rtb(Peer):
    def __init__(self, folder, name):
        super().__init__(folder, name)
        import roboticstoolbox as rtb
        turns = [rtb.ET.Rx, rtb.ET.Ry, rtb.ET.Rz]
        ets = rtb.ETS()
        for row in self.numbers:
            pose = np.vstack([np.reshape(row[:12], (3, 4)), [0, 0, 0, 1]])
            axis = int(np.argmax(np.abs(row[12:15])))
            joint = turns[axis](qlim=[row[15], row[16]], flip=row[12 + axis] < 0)
            ets = ets * rtb.ET.SE3(pose) * joint
        self.ets = ets * rtb.ET.SE3(self.tip)

    def kinematics(self, q):
        return self.ets.eval(q), self.ets.jacob0(q)

    def solve(self, target):
        # Its residual is half the squared error.
        found = self.ets.ik_LM(target, q0=self.middle, tol=0.5 * self.tolerance**2, slimit=100)
        return np.asarray(found.q) if found.success else None


class Optik(Peer):
    def __init__(self, folder, name):
        super().__init__(folder, name)
        from optik import Robot, SolverConfig
        self.config = SolverConfig
        self.robot = Robot.from_urdf_file(self.urdf, "base", "tip0")
        self.robot.set_parallelism(1)

    def kinematics(self, q):
        return self.robot.fk(q), self.robot.joint_jacobian(q)

    def in_our_order(self, jacobian, pose):
        turn = np.kron(np.eye(2), pose[:3, :3])
        return turn @ jacobian  # it is seen from the tool

    def prepare(self, tolerance):
        super().prepare(tolerance)
        # Its objective is half the squared error.
        self.options = self.config(solution_mode="speed", max_time=0.1, max_restarts=100_000,
                                   tol_f=0.5 * tolerance**2)

    def solve(self, target):
        found = self.robot.ik(self.options, target, self.middle)
        return None if found is None else np.array(found[0])


class TracIk(Peer):
    def __init__(self, folder, name):
        super().__init__(folder, name)
        import pytracik
        self.trac = pytracik

    def prepare(self, tolerance):
        super().prepare(tolerance)
        # Its tolerance is that of each component.
        self.solver = self.trac.TRAC_IK("base", "tip0", open(self.urdf).read(), 0.05,
                                        tolerance / 3**0.5, self.trac.SolveType.Speed)

    def solve(self, target):
        x, y, z = target[:3, 3]
        found = self.trac.ik(self.solver, self.middle, x, y, z, *quaternion(target[:3, :3]))
        return np.array(found[1:]) if found[0] >= 0 else None


class Eaik(Peer):
    """Analytic; it knows no limits, so the first answer within them is taken."""

    def __init__(self, folder, name):
        super().__init__(folder, name)
        from eaik.IK_URDF import UrdfRobot
        self.robot = UrdfRobot(self.urdf)
        if not self.robot.hasKnownDecomposition():
            raise RuntimeError("no analytic decomposition of this arm")
        # Its answers are for the last joint's frame.
        zero = np.asarray(self.robot.fwdKin(np.zeros(self.n)))
        self.correction = np.linalg.inv(self.tip) @ np.linalg.inv(self.zero()) @ zero

    def solve(self, target):
        found = self.robot.IK(target @ self.correction)
        for q, approximate in zip(found.Q, found.is_LS):
            if not approximate:
                q = self.within(q)
                if q is not None:
                    return q
        return None

    def zero(self):
        """world_from_last_joint at zero."""
        pose = np.eye(4)
        for row in self.numbers:
            pose = pose @ np.vstack([np.reshape(row[:12], (3, 4)), [0, 0, 0, 1]])
        return pose


def quaternion(m):
    """x, y, z, w of a rotation matrix, by its largest component."""
    k = np.array([
        [m[0, 0] - m[1, 1] - m[2, 2], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[2, 1] - m[1, 2]],
        [0, m[1, 1] - m[0, 0] - m[2, 2], m[1, 2] + m[2, 1], m[0, 2] - m[2, 0]],
        [0, 0, m[2, 2] - m[0, 0] - m[1, 1], m[1, 0] - m[0, 1]],
        [0, 0, 0, m[0, 0] + m[1, 1] + m[2, 2]],
    ])
    k = k + np.triu(k, 1).T + np.eye(4)
    i = int(np.argmax(np.diag(k)))
    return k[i] / np.linalg.norm(k[i])


def main():
    kind = {"rtb": Rtb, "optik": Optik, "tracik": TracIk, "eaik": Eaik}[sys.argv[1]]
    known = {}
    for line in sys.stdin:
        path, task, robot, *words = line.split()
        try:
            if robot not in known:
                known[robot] = kind(sys.argv[2], robot)
            print(known[robot].answer(path, task, words), flush=True)
        except Exception as error:  # a row of the table, not the end of the comparison
            print("error", type(error).__name__, str(error).replace("\n", " ")[:200], flush=True)


if __name__ == "__main__":
    main()
