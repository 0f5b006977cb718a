"""Robots that MuJoCo simulates, with drives that lag, delays, noise and lost cycles, driven by the
servo and beside it by mink, or a loop on the lengths of the legs of parallel robots.
`cargo xtask plants` runs it and writes docs/plants.*."""

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import importlib.metadata
import json
import pathlib
import sys
import warnings

import mujoco
import numpy as np

import plant_controllers as controllers
import plant_models as models
import plant_report as report

PHYSICS = 0.001
NOISE = 1e-4  # of encoders [rad or m]
DROPPED = 0.01  # share of cycles that are lost
LAG = 0.01  # time constant of a drive [s]
# Time to half of which a position drive takes away an error, beside the lag [s].
STIFFNESS = 0.02

# Driven by, control rate [Hz], delay [s].
DRIVES = [("velocity", 500, 0.001), ("velocity", 100, 0.020),
          ("position", 500, 0.001), ("position", 100, 0.020)]
# At the end of a motion [m, rad, rad/s]; of a moving target, the median of the second half.
TOLERANCE = {"still": (1e-3, 5e-3), "moving": (1e-2, 5e-2)}
REST = 0.02


class Plant:
    """A robot in MuJoCo behind drives: `cycle(command)` lets a control period pass."""

    def __init__(self, robot, drive, rng):
        self.robot, self.rng = robot, rng
        self.mode, rate, delay = drive
        self.period = round(1 / (rate * PHYSICS))
        self.delay = round(delay / PHYSICS)
        self.model, self.data = robot.compile(self.mode, LAG, STIFFNESS)
        self.actuated = robot.actuated_of(self.model)
        self.at = self.model.jnt_qposadr[self.actuated]
        self.speed_at = self.model.jnt_dofadr[self.actuated]
        self.waiting = []
        self.now = 0
        self.positions, self.speeds = [], []

    def start(self, q):
        self.robot.place(self.model, self.data, q)
        measured = self.data.qpos[self.at].copy()
        command = measured if self.mode == "position" else np.zeros(len(measured))
        self.data.ctrl[:] = command
        self.data.act[:] = command
        mujoco.mj_forward(self.model, self.data)

    def measure(self):
        return self.data.qpos[self.at] + NOISE * self.rng.standard_normal(len(self.at))

    def drop(self):
        return self.rng.random() < DROPPED

    def cycle(self, command):
        """`command` is None in a cycle that is lost."""
        if command is not None:
            self.waiting.append((self.now + self.delay, command))
        end = self.now + self.period
        while self.now < end:
            while self.waiting and self.waiting[0][0] <= self.now:
                self.data.ctrl[:] = self.waiting.pop(0)[1]
            until = min([end] + [t for t, _ in self.waiting])
            mujoco.mj_step(self.model, self.data, nstep=until - self.now)
            self.now = until
        self.positions.append(self.data.qpos[self.at].copy())
        self.speeds.append(self.data.qvel[self.speed_at].copy())

    def pose(self):
        return self.robot.pose(self.model, self.data)


def behind(drive):
    """What a controller may know of a drive: delay and time constant [s], largest error of the
    encoders (three standard deviations) [rad or m]."""
    mode, _, delay = drive
    stiffness = STIFFNESS / np.log(2) if mode == "position" else 0.0
    return {"delay": delay, "time_constant": LAG + stiffness, "noise": 3 * NOISE}


def errors(pose, target, planar):
    """Distance and angle between two poses; of the position alone in the plane."""
    far = np.linalg.norm(pose[:3, 3] - target[:3, 3])
    if planar:
        return far, 0.0
    R = target[:3, :3] @ pose[:3, :3].T
    sine = 0.5 * np.linalg.norm([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return far, np.arctan2(sine, 0.5 * (np.trace(R) - 1))


def follow(robot, kind, motion, drive, controller, seed):
    """Drives a plant along a motion; returns what counts."""
    rng = np.random.default_rng(seed)
    plant = Plant(robot, drive, rng)
    plant.start(motion.start)
    dt = plant.period * PHYSICS
    controller.start(motion, dt, behind(drive))
    integrated = plant.data.qpos[plant.at].copy()
    rows = []
    for k in range(round(motion.seconds / dt)):
        target, twist = motion.at((k + 1) * dt)
        velocities = None if plant.drop() else controller.step(plant.measure(), target, twist)
        command = None
        if velocities is not None:
            integrated = integrated + dt * velocities
            command = integrated if plant.mode == "position" else velocities
        plant.cycle(command)
        rows.append(errors(plant.pose(), target, robot.planar))
    rows = np.array(rows)
    late = rows[len(rows) // 2:] if motion.moves else rows[-max(1, round(0.2 / dt)):]
    distance, angle = np.median(late, axis=0)
    final = np.array(plant.speeds[-max(1, round(0.2 / dt)):])
    rest = np.median(np.abs(final), axis=0).max()
    positions, speeds = np.array(plant.positions), np.abs(plant.speeds)
    lower, upper, fastest = robot.limits
    limits = max(0.0, (lower - positions).max(), (positions - upper).max())
    over = max(0.0, (speeds / fastest).max() - 1)
    tolerance = TOLERANCE["moving" if motion.moves else "still"]
    arrived = distance <= tolerance[0] and angle <= tolerance[1]
    # Out of reach it has to come to rest.
    success = rest <= REST if kind == "edge" else arrived
    return {"success": bool(success and np.isfinite(rows).all()), "distance": float(distance),
            "angle": float(angle), "rest": float(rest), "limits": float(limits),
            "speed": float(over), "drive": DRIVES.index(drive), "refused": controller.refused}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=pathlib.Path, help="for the models")
    for name in ("robots", "hand", "arms"):
        parser.add_argument(f"--{name}", type=pathlib.Path, required=name == "arms")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--commit", default="")
    parser.add_argument("--quick", action="store_true", help="4 targets of each kind")
    parser.add_argument("--targets", type=int, default=50)
    parser.add_argument("--only", default="")
    parser.add_argument("--inverse", default="truncated", help="that of the servo")
    options = parser.parse_args()
    controllers.Cylindroid.inverse = options.inverse
    warnings.simplefilter("ignore")
    options.folder.mkdir(parents=True, exist_ok=True)
    options.out.mkdir(parents=True, exist_ok=True)
    targets = 4 if options.quick else options.targets
    packages = ("cylindroid", "mink", "mujoco")
    facts = {"versions": {p: importlib.metadata.version(p) for p in packages},
             "commit": options.commit, "targets": targets, "noise": NOISE, "dropped": DROPPED,
             "lag": LAG, "drives": DRIVES}
    results = {}
    for robot in models.robots(options.folder, options.arms):
        if options.only and options.only not in robot.name:
            continue
        results[robot.name] = {}
        for kind in robot.kinds:
            rows = results[robot.name][kind] = {}
            for make in controllers.of(robot):
                runs = []
                for i in range(targets):
                    seed = [i, *robot.name.encode(), *kind.encode()]
                    motion = robot.motion(kind, np.random.default_rng(seed))
                    drive = DRIVES[i % len(DRIVES)]
                    runs.append(follow(robot, kind, motion, drive, make(robot), seed))
                rows[make.name] = runs
                report.show(robot.name, kind, make.name, runs)
            report.write(options.out, facts, results)


if __name__ == "__main__":
    sys.exit(main())
