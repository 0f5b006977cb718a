"""Runs all peers on the same configurations and targets, checks that they agree, and writes the
tables and the picture. `cargo xtask bench-peers` installs the peers and calls this.

Every peer is a process that waits for commands (common.hpp lists them). Peers take turns: in each
round each of them runs one slice, on one core, so that what disturbs the machine disturbs all.
"""

import argparse
import os
import pathlib
import subprocess

import numpy as np

import report
import robots

# What a peer can do, and how many targets it is given; `from Python` where calls pass through it.
SINGLE, BATCH, TREE, SERVO, IK = "single", "batch", "tree", "servo", "ik"
PEERS = {
    "cylindroid": {"tasks": {SINGLE, BATCH, TREE, SERVO, IK}, "targets": 100_000, "far": 1000},
    "pinocchio": {"tasks": {SINGLE, BATCH, TREE, SERVO, IK}, "targets": 100_000, "far": 50},
    "generated": {"tasks": {SINGLE, BATCH}},
    "mujoco": {"tasks": {SINGLE, TREE}},
    "kdl": {"tasks": {SINGLE, IK}, "targets": 5_000, "far": 20},
    "dynibo": {"tasks": {SINGLE}},
    "k": {"tasks": {SINGLE}},
    "optik": {"tasks": {SINGLE, IK}, "targets": 10_000, "far": 20},
    "rtb": {"tasks": {SINGLE, IK}, "targets": 10_000, "far": 20},
    "tracik": {"tasks": {IK}, "targets": 2_000, "far": 20},
    "eaik": {"tasks": {IK}, "targets": 10_000, "far": 20, "robots": ["ur5"]},
}
TOLERANCES = [1e-5, 1e-9]
# By how much an answer may pass a limit (rad): some keep limits in single precision.
OUTSIDE = 1e-7
CHUNKS = [robots.BATCH, 256]


class Process:
    """A peer that waits for commands."""

    def __init__(self, command, out):
        self.out = str(out)
        self.log = open(f"{self.out}.log", "w")
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=self.log, text=True)

    def ask(self, *words):
        """The numbers of its answer; what it wrote is in `self.out`."""
        try:
            self.process.stdin.write(" ".join([self.out, *map(str, words)]) + "\n")
            self.process.stdin.flush()
            answer = self.process.stdout.readline()
        except BrokenPipeError:
            answer = ""
        if answer == "":
            raise RuntimeError(f"ended with status {self.process.wait()}")
        if answer.startswith("error"):
            raise RuntimeError(answer[6:].strip())
        return [] if answer.strip() == "ok" else [float(x) for x in answer.split()]

    def written(self):
        return np.fromfile(self.out)


class Comparison:
    def __init__(self, arguments, installed):
        self.arguments, self.installed = arguments, installed
        self.folder = pathlib.Path(arguments.folder)
        self.data, out = self.folder / "data", self.folder / "out"
        out.mkdir(parents=True, exist_ok=True)
        self.robots = robots.load(arguments.robots, arguments.rtb)
        robots.write(self.robots, self.data, self.count(100_000), 1000)
        self.peers = {name: Process([*peer["command"], str(self.data)], out / name)
                      for name, peer in installed.items() if peer["command"]}
        self.failures = []

    def count(self, most):
        return max(20, most // 50) if self.arguments.quick else most

    def able(self, task, robot):
        for name, peer in self.peers.items():
            if task in PEERS[name]["tasks"] and robot in PEERS[name].get("robots", [robot]):
                yield name, peer

    def attempt(self, name, what, work):
        """`work()`, or a failure that the tables show."""
        try:
            return work()
        except RuntimeError as error:
            self.failures.append({"peer": name, "what": what, "reason": str(error)})
            print(f"  {name}, {what}: {error}", flush=True)
            return None

    def check(self):
        """Largest difference of poses and Jacobians from the referee of robots.py."""
        rows = []
        for robot in robots.ARMS:
            model = self.robots[robot]
            q = np.fromfile(self.data / f"{robot}.q").reshape(-1, model.n)[:robots.SINGLES]
            pose = model.tip_poses(q)
            truth = np.hstack([pose[:, :3, :3].reshape(-1, 9), pose[:, :3, 3],
                               model.jacobians(q).reshape(len(q), -1)])
            rows += self.differences("single", "check", robot, truth)
        model = self.robots[robots.TREE]
        q = np.fromfile(self.data / f"{robots.TREE}.q").reshape(-1, model.n)[:robots.SINGLES]
        truth = model.columns(q).reshape(len(q), -1)
        return rows + self.differences("tree", "treecheck", robots.TREE, truth)

    def differences(self, task, command, robot, truth):
        rows = []
        for name, peer in self.able(task, robot):
            if self.attempt(name, f"{task} {robot}", lambda: peer.ask(command, robot)) is None:
                continue
            worst = float(np.abs(peer.written().reshape(truth.shape) - truth).max())
            rows.append({"peer": name, "task": task, "robot": robot, "difference": worst})
            if not worst <= report.AGREE:
                reason = f"differs by {worst:.1e} from the referee"
                self.failures.append({"peer": name, "what": f"{task} {robot}", "reason": reason})
                print(f"  {name}, {task} {robot}: {reason}", flush=True)
        return rows

    def rounds(self, task, robot, command, count):
        """Least and median ns of a call, by peer."""
        seen = {}
        for _ in range(count):
            for name, peer in self.able(task, robot):
                numbers = self.attempt(name, f"{task} {robot}", lambda: peer.ask(*command))
                if numbers:
                    seen.setdefault(name, []).append(numbers)
        return [{"peer": name, "robot": robot, "min": min(x[0] for x in numbers),
                 "median": float(np.median([x[-1] for x in numbers]))}
                for name, numbers in seen.items()]

    def kinematics(self):
        rounds = 2 if self.arguments.quick else 9
        singles, batches = [], []
        for robot in robots.ARMS:
            print(f"pose and Jacobian, {robot}", flush=True)
            singles += self.rounds(SINGLE, robot, [SINGLE, robot, 100], rounds)
            for chunk in CHUNKS:
                rows = self.rounds(BATCH, robot, [BATCH, robot, chunk], rounds)
                batches += [row | {"chunk": chunk} for row in rows]
        print("whole tree", flush=True)
        trees = self.rounds(TREE, robots.TREE, [TREE, robots.TREE, 100], rounds)
        return singles, batches, trees

    def servo(self):
        print("servo", flush=True)
        seen = {}
        for _ in range(1 if self.arguments.quick else 10):
            for name, peer in self.able(SERVO, "panda"):
                done = self.attempt(name, "servo", lambda: peer.ask(SERVO, "panda", 100_000))
                if done is not None:
                    seen.setdefault(name, []).append(peer.written())
        rows, reference = [], None
        for name, runs in seen.items():
            reference = runs[0][-7:] if reference is None else reference
            ns = np.concatenate([run[:-7] for run in runs])
            p50, p999 = np.percentile(ns, [50, 99.9])
            rows.append({"peer": name, "steps": len(ns), "p50": p50, "p99.9": p999,
                         "max": ns.max(),
                         "difference": float(np.abs(runs[0][-7:] - reference).max())})
        return rows

    def inverse(self, kind):
        """Targets in slices, each peer in turn; answers are judged by the referee."""
        rows = []
        for robot in robots.ARMS:
            model = self.robots[robot]
            suffix = "targets" if kind == "ik" else "far"
            targets = np.fromfile(self.data / f"{robot}.{suffix}").reshape(-1, 12)
            for tolerance in TOLERANCES if kind == "ik" else TOLERANCES[:1]:
                print(f"inverse kinematics, {robot}, {suffix}, {tolerance:g}", flush=True)
                answers, slices = {}, 5
                for part in range(slices):
                    for name, peer in self.able(IK, robot):
                        key = "targets" if kind == "ik" else "far"
                        share = max(1, self.count(PEERS[name][key]) // slices)
                        command = [kind, robot, tolerance, part * share, (part + 1) * share]
                        what = f"{kind} {robot}"
                        if self.attempt(name, what, lambda: peer.ask(*command)) is not None:
                            table = peer.written().reshape(share, -1)
                            answers.setdefault(name, []).append(table)
                for name, parts in answers.items():
                    table = np.vstack(parts)
                    judged = judge(model, table, targets[:len(table)], tolerance)
                    rows.append({"peer": name, "robot": robot, "tolerance": tolerance} | judged)
        return rows


def judge(model, table, targets, tolerance):
    us, success, q = table[:, 0] / 1e3, table[:, 1] != 0, table[:, 2:]
    pose = model.tip_poses(q)
    position = np.linalg.norm(pose[:, :3, 3] - targets[:, 9:], axis=1)
    turn = pose[:, :3, :3].transpose(0, 2, 1) @ targets[:, :9].reshape(-1, 3, 3)
    skew = np.stack([turn[:, i, j] - turn[:, j, i] for i, j in [(2, 1), (0, 2), (1, 0)]], axis=1)
    cos = (np.trace(turn, axis1=1, axis2=2) - 1) / 2
    angle = np.arctan2(0.5 * np.linalg.norm(skew, axis=1), cos)
    # Rounding of the referee.
    right = (position <= tolerance + 1e-13) & (angle <= tolerance + 1e-13)
    inside = np.all((q >= model.lower - OUTSIDE) & (q <= model.upper + OUTSIDE), axis=1)
    p50, p99 = np.percentile(us, [50, 99])
    return {"targets": len(us), "solved": int(np.sum(success & right & inside)),
            "wrong": int(np.sum(success & ~right)), "outside": int(np.sum(success & ~inside)),
            "p50": p50, "mean": us.mean(), "p99": p99, "max": us.max()}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", help="where the peers are installed: installed.tsv")
    parser.add_argument("--robots", required=True, help="folder of example-robot-data's robots")
    parser.add_argument("--rtb", required=True, help="folder of rtb-data")
    parser.add_argument("--out", required=True, help="where benchmarks.{md,json,svg} go")
    parser.add_argument("--commit", default="unknown")
    parser.add_argument("--compilers", default="unknown")
    parser.add_argument("--quick", action="store_true", help="a fiftieth of the work")
    parser.add_argument("--only", help="these peers alone, separated by commas")
    arguments = parser.parse_args()

    # All on one core, the last: the first serves interrupts.
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    installed = {}
    for line in (pathlib.Path(arguments.folder) / "installed.tsv").read_text().splitlines():
        name, label, version, reason, *command = line.split("\t")
        skip = arguments.only and name not in arguments.only.split(",")
        installed[name] = {"label": label, "version": version, "reason": reason,
                           "command": [] if skip else command}

    comparison = Comparison(arguments, installed)
    results = {"machine": report.machine(arguments.commit, arguments.compilers), "peers": installed,
               "agreement": comparison.check()}
    singles, batches, trees = comparison.kinematics()
    results |= {"single": singles, "batch": batches, "tree": trees, "servo": comparison.servo(),
                "ik": comparison.inverse("ik"), "far": comparison.inverse("far"),
                "failures": comparison.failures}
    for peer in installed.values():
        del peer["command"]  # paths of this machine
    report.write(results, pathlib.Path(arguments.out))
    ours = [f for f in comparison.failures if f["peer"] == "cylindroid"]
    if ours:
        raise SystemExit(f"cylindroid failed: {ours}")


if __name__ == "__main__":
    main()
