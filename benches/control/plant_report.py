"""Prints and writes what plants.py measured."""

import json

import numpy as np

KINDS = {"circle": "circles", "eight": "figures of eight", "wrist": "wrist singularities",
         "edge": "beyond the workspace"}


def numbers(runs):
    pick = lambda name: np.array([r[name] for r in runs])
    return {"success": int(pick("success").sum()), "runs": len(runs),
            "distance": float(np.median(pick("distance"))), "most": float(pick("distance").max()),
            "angle": float(np.median(pick("angle"))), "limits": float(pick("limits").max()),
            "speed": float(pick("speed").max()),
            "refused": int((pick("refused") > 0).sum()), "rest": float(pick("rest").max())}


def show(robot, kind, who, runs):
    n = numbers(runs)
    print(f"{robot:10} {kind:7} {who:18} {n['success']}/{n['runs']}  "
          f"mm {n['distance'] * 1e3:8.3g} {n['most'] * 1e3:8.3g}  mrad {n['angle'] * 1e3:8.3g}  "
          f"limits {n['limits'] * 1e3:.3g}  speed {100 * n['speed']:.3g} %  rest {n['rest']:.2g}  "
          f"refused {n['refused']}",
          flush=True)


def small(x):
    return "0" if x < 1e-9 else f"{x:.3g}" if x < 1e4 else f"{x:.1e}"


def row(label, who, runs):
    n = numbers(runs)
    if n["refused"]:
        who += f" (refused steps in {n['refused']})"
    return (f"| {label} | {who} | {n['success']} of {n['runs']} | {small(n['distance'] * 1e3)} / "
            f"{small(n['most'] * 1e3)} | {small(n['angle'] * 1e3)} | {small(n['limits'] * 1e3)} | "
            f"{small(100 * n['speed'])} |")


HEAD = ["| | | success | mm, median / max | mrad, median | beyond position limits (mrad or mm) | "
        "beyond speeds (%) |", "|---|---|---|---|---|---|---|"]


def write(folder, facts, results):
    short = {robot: {kind: {who: [{k: v if isinstance(v, int) else float(f"{v:.4g}")
                                   for k, v in run.items()} for run in runs]
                            for who, runs in rows.items()} for kind, rows in kinds.items()}
             for robot, kinds in results.items()}
    (folder / "plants.json").write_text(
        json.dumps({"facts": facts, "results": short}, separators=(",", ":")) + "\n")
    versions = ", ".join(f"{n} {v}" for n, v in facts["versions"].items())
    lines = [f"""# Simulated robots

`cargo xtask plants --targets {facts['targets']}` drives robots that MuJoCo simulates, and writes this page and
`plants.json`. This run: commit {facts['commit']}; {versions}; {facts['targets']} targets in each row.

The physics take steps of 1 ms. A drive follows the commanded velocity, or the position to which the
commands add up, with a lag of {facts['lag'] * 1e3:.0f} ms beside its own stiffness; gravity is compensated. Encoders have
noise of {facts['noise']:g} rad or m, {100 * facts['dropped']:g} % of all cycles are lost, and only the actuated joints are measured.
The four drives take turns: velocities at 500 Hz with a delay of 1 ms and at 100 Hz with 20 ms,
positions likewise. Position limits are not stops here: the robot can be driven beyond them.

mink, with its own damping (1e-12) and with 0.01, follows the same targets with the same gain (5/s)
and the same limits of positions and speeds; this library has limits of acceleration too (10 rad/s²
or m/s²) and knows delay and time constant of the drives and three standard deviations of the noise
(`ServoOptions::plant`), except in the rows "ideal robot". Both know the twist of the target. Parallel robots are driven beside it by a loop on the
measured drives, with their inverse kinematics in closed form.

A moving target is followed if the median error of the second half is below 10 mm and 50 mrad, a
wrist singularity is reached within 1 mm and 5 mrad. At a target beyond the workspace the robot must
come to rest (0.02 rad/s or m/s), and the distance that remains tells how near it came: targets of
arms are 0.3 m beyond a pose with a stretched elbow. A row says in how many motions a controller
refused a step.
"""]
    for kind, title in KINDS.items():
        chosen = {n: r[kind] for n, r in results.items() if kind in r}
        if not chosen:
            continue
        lines += [f"## {title[0].upper()}{title[1:]}", *HEAD]
        for robot, rows in chosen.items():
            lines += [row(robot, who, runs) for who, runs in rows.items()]
        lines.append("")
    lines += ["## By drive, targets within reach", *HEAD]
    for i, (mode, rate, delay) in enumerate(facts["drives"]):
        by = {}
        for kinds in results.values():
            for kind, rows in kinds.items():
                for who, runs in rows.items() if kind != "edge" else ():
                    by.setdefault(who, []).extend(r for r in runs if r["drive"] == i)
        label = f"{mode}, {rate} Hz, {delay * 1e3:.0f} ms"
        lines += [row(label, who, runs) for who, runs in by.items() if runs]
    (folder / "plants.md").write_text("\n".join(lines).rstrip() + "\n")
