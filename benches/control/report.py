"""Prints and writes what compare.py measured."""

import json
import pathlib

KINDS = {"within": "Within reach", "beyond": "Beyond speeds and reach"}


def show(name, kind, rows):
    for who, r in rows.items():
        print(f"{name:12} {kind:7} {who:22} {r['solver']:9} "
              f"mm {r['distance']['median'] * 1e3:9.2g} {r['distance']['max'] * 1e3:9.3g}  "
              f"mrad {r['angle']['median'] * 1e3:9.2g} {r['angle']['max'] * 1e3:9.3g}  "
              f"mean norm {r['norm']['mean'] * 1e3:9.3g}  "
              f"limits {r['position']:.1e} {r['velocity']:.1e} {r['joint']}  "
              f"us {r['time']['median']:8.1f} {r['time']['p99']:8.1f} x{r['times']:.1f}  "
              f"failures {r['failures']}", flush=True)


def processor():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return "unknown processor"


def small(x):
    """Three digits, or two with an exponent."""
    if x == 0:
        return "0"
    return f"{x:.3g}" if 1e-3 <= x < 1e4 else f"{x:.1e}"


def above(x):
    """An excess; what rounding makes of a bound is none."""
    return "0" if x < 1e-9 else small(x)


def table(rows):
    turned = any(r["angle"]["max"] for r in rows.values())
    lines = ["| | solver | mm, median / max | " + ("mrad, median / max | " if turned else "") +
             "mean norm | beyond position limits | beyond speeds (%) | us a step, median / 99 % | "
             "time |"]
    lines.append("|---" * (lines[0].count("|") - 1) + "|")
    for who, r in rows.items():
        cells = [who, r["solver"] or "its own",
                 f"{small(r['distance']['median'] * 1e3)} / {small(r['distance']['max'] * 1e3)}"]
        if turned:
            cells.append(f"{small(r['angle']['median'] * 1e3)} / {small(r['angle']['max'] * 1e3)}")
        cells += [small(r["norm"]["mean"]), above(r["position"]),
                  above(100 * r["velocity"]),
                  f"{r['time']['median']:.0f} / {r['time']['p99']:.0f}", f"{r['times']:.2f} x"]
        if r["failures"]:
            cells[0] += f" ({r['failures']} steps without a solution)"
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def summary(results):
    """How many times slower and worse than this library the others are."""
    others = [n for n in next(iter(results.values()))["within"] if not n.startswith("cylindroid")]
    lines = ["| | time within / beyond: " + " | ".join(others) + " | mean norm within / beyond: " +
             " | ".join(others) + " |", "|---" * (1 + 2 * len(others)) + "|"]
    for name, scenario in results.items():
        cells = [name]
        for of in (lambda r: r["time"]["median"], lambda r: r["norm"]["mean"]):
            ours = {kind: of(scenario[kind]["cylindroid"]) for kind in KINDS}
            cells += [" / ".join(f"{of(scenario[kind][n]) / ours[kind]:.2f}" for kind in KINDS)
                      for n in others]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def write(folder, facts, results):
    (folder / "control-benchmarks.json").write_text(
        json.dumps({"facts": facts, "results": results}, indent=1) + "\n")
    versions = ", ".join(f"{n} {v}" for n, v in facts["versions"].items())
    lines = [f"""# Many tasks beside other libraries

`cargo xtask bench-control` installs mink, pink and PlaCo in `target/bench-control`, lets them and
the `TaskServo` of this library follow the same targets in one process, and writes this page and
`control-benchmarks.json`. This run: {facts['machine']}; commit {facts['commit']}; {versions}. TSID
has no wheel on PyPI.

All read the same URDF, made by `benches/control/models.py` from example-robot-data (PR2, G1),
robosuite (iiwa 14) and gymnasium-robotics (Shadow hand), and are called from Python, every
{facts['dt'] * 1e3:.0f} ms of simulated time, on an ideal robot: the velocities of a step are
integrated by the library itself. Every task takes its whole error away in one step (gain 1 of mink
and pink, 1/dt here), in one level with weight 1 for metres and radians; a posture has the cost 1e-3
beside them, here it is the lowest level. Limits are positions and speeds of the joints; none has
acceleration limits. mink and pink use the solver that fails least and is fastest, of daqp, quadprog
and proxqp, for each robot. A second row of this library takes least squares where limits stop a task
(`keep_directions=False`), a third puts the feet first, then the centre of
mass, then each frame on a level of its own; the last row, where all targets are poses, jumps to a
solution of the inverse kinematics in every step, without a servo.

Targets are figures of eight in random planes with rotations about random axes, {facts['motions']}
motions of {facts['seconds']:.0f} s for each robot, first within reach and speeds, then with
{facts['bigger']:g} times the amplitude in {facts['quicker']:g} times the period. Poses are those of
MuJoCo at the configurations of each library. A row lists the largest error of all controlled points
after each step, the largest rotation error, and the mean of the root of the sum of all squares; the
largest excess over a position limit (rad or m) and over a speed, as a share of it; and the
processor time of a step, with new targets and the integration. Libraries take turns every 50 steps.
The last column is the median beside that of the first row.
"""]
    lines += ["""## In brief
Each figure is that of the other library divided by that of the first row of this one; above 1 this
library is faster or nearer. Where limits stop a task, this library shortens its motion before it
changes the direction; the others minimise the sum of squares, which leaves smaller errors.
""", *summary(results), ""]
    for name, scenario in results.items():
        lines.append(f"## {name}\n{scenario['text'][0].upper()}{scenario['text'][1:]}.\n")
        for kind, title in KINDS.items():
            lines += [f"### {name}: {title[0].lower()}{title[1:]}", *table(scenario[kind]), ""]
    (folder / "control-benchmarks.md").write_text("\n".join(lines).rstrip() + "\n")
