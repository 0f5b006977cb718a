"""Many tasks at once, beside mink, pink and PlaCo: the same URDF, targets, limits and step for all,
in one process. `cargo xtask bench-control` runs it and writes docs/control-benchmarks.*."""

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import gc
import importlib.metadata
import pathlib
import platform
import sys
import time
import warnings

import mujoco
import numpy as np

import models
import report
import servos

DT = 0.005
SLICE = 50  # steps of one library before the next has its turn
KINDS = {"within": (1.0, 1.0), "beyond": (2.5, 0.4)}  # amplitude and period, times the scenario's


class Judge:
    """A MuJoCo model of the robot: it evaluates the frames of every library."""

    def __init__(self, scenario):
        self.scenario = scenario
        self.model = mujoco.MjModel.from_xml_path(scenario.urdf)
        self.data = mujoco.MjData(self.model)
        hinges = [j for j in range(self.model.njnt)
                  if self.model.jnt_type[j] != mujoco.mjtJoint.mjJNT_FREE]
        self.names = [self.model.joint(j).name for j in hinges]
        self.at = self.model.jnt_qposadr[hinges]
        limited = self.model.jnt_limited[hinges].astype(bool)
        self.lower = np.where(limited, self.model.jnt_range[hinges, 0], -np.inf)
        self.upper = np.where(limited, self.model.jnt_range[hinges, 1], np.inf)
        self.speeds = models.speeds(scenario.urdf, self.names)
        self.home = np.array([scenario.home.get(n, 0.0) for n in self.names])
        assert (self.lower <= self.home).all() and (self.home <= self.upper).all(), scenario.name
        base = np.eye(4)
        base[2, 3] = scenario.base or 0.0
        self.start = self.positions(self.home, base)

    def positions(self, joints, base):
        q = np.zeros(self.model.nq)
        q[self.at] = joints
        if self.scenario.base:
            q[:3] = base[:3, 3]
            mujoco.mju_mat2Quat(q[3:7], np.ascontiguousarray(base[:3, :3]).ravel())
        return q

    def look(self, q):
        """Poses of the frames, and the centre of mass."""
        self.data.qpos[:] = q
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        poses = {}
        for f in self.scenario.poses + self.scenario.points:
            body = self.data.body(f)
            poses[f] = np.eye(4)
            poses[f][:3, :3], poses[f][:3, 3] = body.xmat.reshape(3, 3), body.xpos
        return poses, self.data.subtree_com[0].copy()


class Motion:
    """Figures of eight in random planes about the start, with rotations about random axes."""

    def __init__(self, judge, kind, seed, seconds):
        s, rng = judge.scenario, np.random.default_rng([seed, *judge.scenario.name.encode()])
        bigger, quicker = KINDS[kind]
        self.times = DT * np.arange(1, round(seconds / DT) + 1)
        ramp = np.minimum(self.times, 1.0)
        ramp = bigger * ramp * ramp * (3 - 2 * ramp)
        phase = 2 * np.pi * self.times / (s.period * quicker)
        eight = np.stack([np.sin(phase), np.sin(2 * phase) / 2], axis=1) * ramp[:, None]
        poses, com = judge.look(judge.start)
        self.targets, self.start = {}, {}
        for f in s.poses + s.points:
            plane = np.linalg.qr(rng.normal(size=(3, 3)))[0][:, :2]
            axis = rng.normal(size=3)
            axis /= np.linalg.norm(axis)
            self.start[f] = poses[f] if f in s.poses else poses[f][:3, 3]
            if f in s.still:
                self.targets[f] = np.repeat(poses[f][None], len(phase), axis=0)
                continue
            points = poses[f][:3, 3] + s.amplitude * eight @ plane.T
            if f in s.points:
                self.targets[f] = np.ascontiguousarray(points)
                continue
            targets = np.tile(np.eye(4), (len(phase), 1, 1))
            targets[:, :3, 3] = points
            for k, angle in enumerate(s.turn * np.sin(phase) * ramp):
                targets[k, :3, :3] = rotation(axis, angle) @ poses[f][:3, :3]
            self.targets[f] = targets
        plane = np.eye(3)[:, :2]
        self.com = com + s.com_amplitude * eight @ plane.T


def rotation(axis, angle):
    quaternion = np.zeros(4)
    mujoco.mju_axisAngle2Quat(quaternion, axis, angle)
    return models.matrix(quaternion)


def errors(judge, motion, path):
    """The largest error of a frame or the centre of mass [m] and of an orientation [rad], and the
    root of the sum of all squares, of each step."""
    out = np.zeros((len(path), 3))
    for k, q in enumerate(path):
        poses, com = judge.look(q)
        far, turned = [], [0.0]
        for f, targets in motion.targets.items():
            target = targets[k]
            if target.shape == (3,):
                far.append(np.linalg.norm(target - poses[f][:3, 3]))
                continue
            far.append(np.linalg.norm(target[:3, 3] - poses[f][:3, 3]))
            R = target[:3, :3] @ poses[f][:3, :3].T
            sine = 0.5 * np.linalg.norm([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
            turned.append(np.arctan2(sine, 0.5 * (np.trace(R) - 1)))
        if judge.scenario.com:
            far.append(np.linalg.norm(com - motion.com[k]))
        out[k] = max(far), max(turned), np.sqrt(np.sum(np.square(far)) + np.sum(np.square(turned)))
    return out


def excess(judge, path):
    """The largest excess over a position limit [rad or m] and over a speed, as a share of it."""
    joints = path[:, judge.at]
    beyond = max(0.0, (judge.lower - joints).max(), (joints - judge.upper).max())
    moved = np.diff(np.vstack([judge.start[judge.at], joints]), axis=0)
    turning = np.isinf(judge.lower)
    moved[:, turning] = (moved[:, turning] + np.pi) % (2 * np.pi) - np.pi
    share = np.abs(moved / DT) / judge.speeds
    worst = np.unravel_index(share.argmax(), share.shape)
    return beyond, max(0.0, share[worst] - 1), judge.names[worst[1]]


def play(judge, motion, entrants):
    """Lets all follow a motion in turns; returns paths and times of steps by name."""
    steps = len(motion.times)
    paths = {e.name: np.zeros((steps, judge.model.nq)) for e in entrants}
    times = {e.name: np.zeros(steps) for e in entrants}
    for e in entrants:
        e.failures = 0
        e.prepare(motion)
    gc.collect()
    gc.disable()
    for first in range(0, steps, SLICE):
        for e in entrants:
            path, spent = paths[e.name], times[e.name]
            for k in range(first, min(first + SLICE, steps)):
                begin = time.process_time_ns()
                e.step(k)
                spent[k] = time.process_time_ns() - begin
                path[k] = e.configuration()
    gc.enable()
    return paths, times


def entrants(scenario, judge):
    """Each library, with the fastest of the solvers that it can use and that fails least."""
    chosen = []
    for kind in (k for k in servos.ALL if servos.can(k, scenario)):
        trials = []
        for solver in kind.solvers:
            servo = kind(scenario, DT, judge, solver)
            if len(kind.solvers) > 1:
                _, times = play(judge, Motion(judge, "beyond", 0, 1.0), [servo])
                trials.append((servo.failures, np.median(times[kind.name]), solver))
        solver = min(trials)[2] if trials else ""
        chosen.append(kind(scenario, DT, judge, solver))
    return chosen


def measure(scenario, kind, motions, seconds):
    judge = Judge(scenario)
    taking_part = entrants(scenario, judge)
    rows = {e.name: {"solver": e.solver, "failures": 0, "errors": [], "times": [], "position": 0.0,
                     "velocity": 0.0, "joint": ""} for e in taking_part}
    for seed in range(motions):
        motion = Motion(judge, kind, seed, seconds)
        paths, times = play(judge, motion, taking_part)
        for e in taking_part:
            row = rows[e.name]
            row["failures"] += e.failures
            row["errors"].append(errors(judge, motion, paths[e.name]))
            row["times"].append(times[e.name] / 1e3)
            position, velocity, joint = excess(judge, paths[e.name])
            row["position"] = max(row["position"], position)
            if velocity > row["velocity"]:
                row["velocity"], row["joint"] = velocity, joint
    for row in rows.values():
        e, t = np.vstack(row.pop("errors")), np.concatenate(row.pop("times"))
        row["steps"] = len(t)
        for i, name in enumerate(("distance", "angle", "norm")):
            row[name] = {"median": float(np.median(e[:, i])), "mean": float(e[:, i].mean()),
                         "max": float(e[:, i].max())}
        row["time"] = {"median": float(np.median(t)), "p99": float(np.percentile(t, 99))}
        row["position"], row["velocity"] = float(row["position"]), float(row["velocity"])
    ours = rows["cylindroid"]["time"]["median"]
    for row in rows.values():
        row["times"] = row["time"]["median"] / ours
    return rows


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=pathlib.Path, help="for the models")
    for name in ("robots", "hand", "arms"):
        parser.add_argument(f"--{name}", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--commit", default="")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    options.folder.mkdir(parents=True, exist_ok=True)
    options.out.mkdir(parents=True, exist_ok=True)
    motions, seconds = (1, 4.0) if options.quick else (5, 12.0)
    results = {}
    for scenario in models.write(options.folder, options.robots, options.hand, options.arms):
        if options.only and options.only not in scenario.name:
            continue
        results[scenario.name] = {"text": scenario.text}
        for kind in KINDS:
            print(scenario.name, kind, file=sys.stderr, flush=True)
            results[scenario.name][kind] = measure(scenario, kind, motions, seconds)
            report.show(scenario.name, kind, results[scenario.name][kind])
    packages = {"cylindroid": "cylindroid", "mink": "mink", "pink": "pin-pink", "PlaCo": "placo",
                "MuJoCo": "mujoco", "Pinocchio": "pin", "qpsolvers": "qpsolvers",
                "daqp": "daqp", "quadprog": "quadprog", "proxqp": "proxsuite"}
    facts = {"versions": {n: importlib.metadata.version(p) for n, p in packages.items()},
             "machine": f"{report.processor()}; {platform.system()} {platform.release()}; "
                        f"Python {platform.python_version()}",
             "commit": options.commit, "dt": DT, "motions": motions, "seconds": seconds,
             "bigger": KINDS["beyond"][0], "quicker": KINDS["beyond"][1]}
    report.write(options.out, facts, results)


if __name__ == "__main__":
    main()
