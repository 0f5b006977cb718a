"""The tables and the picture of the comparison: `report.py RESULTS.json` writes them again."""

import datetime
import json
import math
import pathlib
import platform
import sys

import robots

# Largest difference of poses and Jacobians that counts as agreement.
AGREE = 1e-9


def machine(commit, compilers):
    info = pathlib.Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    field = lambda name: next((line.split(":", 1)[1].strip() for line in lines
                               if line.startswith(name)), "")
    flags = field("flags").split()
    wide = "AVX-512" if "avx512f" in flags else "AVX2" if "avx2" in flags else "baseline"
    name = f"{field('model name') or platform.machine()} (family {field('cpu family')}, model " \
           f"{field('model')}; {wide})"
    return {"processor": name, "system": f"{platform.system()} {platform.release().split('-')[0]}", "commit": commit,
            "compilers": compilers,
            "date": datetime.date.today().isoformat()}


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(map(str, row)) + " |" for row in rows])


def number(x):
    return f"{x:,.0f}".replace(",", " ") if x >= 10 else f"{x:.1f}"


class Report:
    def __init__(self, results):
        self.results = results
        self.label = {name: peer["label"] for name, peer in results["peers"].items()}

    def of(self, rows, **keys):
        return {r["peer"]: r for r in rows if all(r[k] == v for k, v in keys.items())}

    def names(self, rows):
        """In the order of the list of peers."""
        seen = {row["peer"] for row in rows}
        return [name for name in self.label if name in seen]

    def peers(self):
        rows = [[p["label"], p["version"] or "", f"not installed: {p['reason']}" if p["reason"]
                 else "measured"] for p in self.results["peers"].values()]
        return table(["library", "version", "here"], rows)

    def grid(self, rows, keys, heads):
        """Peers by robots: least / median ns, and how many times ours."""
        out = []
        for name in self.names(rows):
            cells = []
            for key in keys:
                found = self.of(rows, **key)
                if name not in found:
                    cells.append("")
                    continue
                row, ours = found[name], found.get("cylindroid")
                ratio = f" ({row['median'] / ours['median']:.1f} x)" if ours else ""
                cells.append(f"{number(row['min'])} / {number(row['median'])}{ratio}")
            out.append([self.label[name], *cells])
        return table(["ns, least / median", *heads], out)

    def servo(self):
        rows = [[self.label[r["peer"]], number(r["p50"]), number(r["p99.9"]), number(r["max"]),
                 f"{r['difference']:.0e}"] for r in self.results["servo"]]
        return table(["ns a step", "median", "99.9 %", "max", "difference of q at the end"], rows)

    def inverse(self, kind, robot, tolerance):
        rows = [r for r in self.results[kind]
                if r["robot"] == robot and r["tolerance"] == tolerance]
        found = self.of(rows)
        out = []
        for name in self.names(rows):
            r = found[name]
            solved = [f"{100 * r['solved'] / r['targets']:.3f}"] if kind == "ik" else []
            out.append([self.label[name], number(r["targets"]), *solved, number(r["p50"]),
                        number(r["mean"]), number(r["p99"]), number(r["max"]), r["outside"],
                        r["wrong"]])
        solved = ["solved (%)"] if kind == "ik" else []
        return table(["us a target", "targets", *solved, "median", "mean", "99 %", "max",
                      "outside limits", "wrong"], out)

    def markdown(self):
        r, m = self.results, self.results["machine"]
        differences = [x["difference"] for x in r["agreement"] if x["difference"] <= AGREE]
        text = f"""# Benchmarks

`cargo xtask bench-peers` installs the peers in `target/bench-peers`, runs everything below and
writes this file, `benchmarks.json` and `benchmarks.svg`. This run: one core of {m['processor']};
{m['system']}; {m['compilers']}; commit {m['commit']}; {m['date']}.

The robots are the URDFs of `example-robot-data` and `rtb-data`, reduced to the joints in question
(`benches/peers/robots.py`): the same numbers for everybody. Peers take turns in slices of 0.1 s
on one core, so that what disturbs the machine disturbs all. Peers in C++ and `k` and `dynibo` are
compiled for this processor (`-march=native`, KDL as Debian ships it), this library is not: it
chooses at run time. Peers that are called from Python pay for that call and say so.

{self.peers()}

Before anything is timed, poses and Jacobians (origin of the tip, axes of the world) of 256
configurations are compared with a referee in numpy; the largest difference of all is
{max(differences, default=0):.0e}.

## Pose and Jacobian, one call
{self.grid(r['single'], [{'robot': x} for x in robots.ARMS], robots.ARMS)}

In brackets: how many times the median of cylindroid. MuJoCo computes its whole model, with
inertias' frames.

## Whole tree of a humanoid with 29 joints
All poses, and the columns of all joints' Jacobians at the world's origin.

{self.grid(r['tree'], [{}], [robots.TREE])}

## Batches of 100 000 configurations
ns a configuration; poses and Jacobians are written row by row, all kept ({robots.BATCH} rows) or
256 at a time, which stay in the cache.

{self.grid(r['batch'], [{'robot': x, 'chunk': c} for x in ('panda', 'ur5')
                        for c in (robots.BATCH, 256)],
           [f'{x}, {c}' for x in ('panda', 'ur5') for c in ('all kept', '256 at a time')])}

## Servo step, panda
Pose, Jacobian, truncated inverse, posture in the null space, limits, along a circle of 10 cm in
4 s; Pinocchio with Eigen's JacobiSVD. Both follow the same joint path. What else runs on the
machine shows in the last two figures.

{self.servo()}

## Inverse kinematics
Targets are poses of configurations drawn evenly within the limits. Everybody starts at the middle
of the limits (EAIK needs no start). A target is solved if the answer is within the limits and within
tolerance, in metres and radians, by the referee; outside and wrong are answers that were claimed.
Time is processor time, of all threads: nobody is charged for interruptions, but everybody for
reading that clock, about 0.6 us. `Pinocchio, C++` is a damped loop of 20 lines with restarts;
KDL's solver is restarted until an answer is within the limits; KDL takes turns below 1e-6 rad for
none, which makes its answers at 1e-9 wrong, and some of TRAC-IK's, which is built on it.
"""
        for tolerance in sorted({x["tolerance"] for x in r["ik"]}, reverse=True):
            for robot in robots.ARMS:
                text += f"\n### {robot}, {tolerance:g}\n"
                text += self.inverse("ik", robot, tolerance) + "\n"
        text += "\n## Targets out of reach\nFarther from the first joint than the arm is long.\n"
        for robot in robots.ARMS:
            text += f"\n### {robot}, out of reach\n" + self.inverse("far", robot, 1e-5) + "\n"
        if r["failures"]:
            seen = dict.fromkeys((self.label[f["peer"]], f["what"], f["reason"])
                                 for f in r["failures"])
            text += "\n## What did not work\n" + table(["library", "what", "why"], seen) + "\n"
        return text

    def picture(self):
        """Two panels of bars on log scales: ns of pose and Jacobian, us of inverse kinematics."""
        single = self.of(self.results["single"], robot="panda")
        inverse = self.of(self.results["ik"], robot="panda", tolerance=1e-5)
        panels = [
            ("Pose and Jacobian, panda: ns a call", [(n, r["median"], None)
                                                      for n, r in single.items()]),
            ("Inverse kinematics to 1e-5, panda: us a target, median and 99 %",
             [(n, r["p50"], r["p99"]) for n, r in inverse.items()]),
        ]
        width, left, right, step, out, y = 760, 210, 660, 24, [], 16
        for title, bars in panels:
            if not bars:
                continue
            bars.sort(key=lambda bar: bar[1])
            low = 10 ** int(len(str(int(min(b[1] for b in bars)))) - 1)
            high = 10 ** len(str(int(max(max(b[1], b[2] or 0) for b in bars))))
            decades = len(str(high)) - len(str(low))
            x = lambda v: left + (right - left) * max(0.0, math.log10(v / low)) / decades
            out.append(f'<text x="16" y="{y + 14}" class="title">{title}</text>')
            top, y = y + 26, y + 32
            bottom = y + step * len(bars)
            for d in range(decades + 1):
                at = x(low * 10**d)
                out.append(f'<line x1="{at:.1f}" y1="{top}" x2="{at:.1f}" y2="{bottom}"/>')
                out.append(f'<text x="{at:.1f}" y="{bottom + 15}" class="axis" '
                           f'text-anchor="middle">{low * 10**d:,}</text>'.replace(',', ' '))
            for name, value, tail in bars:
                kind = "ours" if name == "cylindroid" else "peer"
                end = x(value)
                out.append(f'<text x="{left - 8}" y="{y + 14}" text-anchor="end" '
                           f'class="{kind}-name">{self.label[name]}</text>')
                out.append(f'<rect x="{left}" y="{y + 3}" width="{max(end - left, 1):.1f}" '
                           f'height="15" class="{kind}"/>')
                text = number(value)
                if tail:
                    out.append(f'<path d="M{end:.1f} {y + 10.5}H{x(tail):.1f}m0 -5v10" '
                               f'class="{kind}-tail"/>')
                    text, end = f"{text} / {number(tail)}", x(tail)
                out.append(f'<text x="{end + 6:.1f}" y="{y + 15}" class="value">{text}</text>')
                y += step
            y += 44
        m = self.results["machine"]
        caption = f"One core of {m['processor']}; commit {m['commit']}, {m['date']}; log scale."
        out.append(f'<text x="16" y="{y}" class="axis">{caption}</text>')
        style = """text{font:13px sans-serif;fill:#24292f}.title{font-weight:bold;font-size:14px}
.axis{font-size:11px;fill:#57606a}.value{font-size:12px}.ours-name{font-weight:bold}
line{stroke:#d0d7de}.ours{fill:#0a7d55}.peer{fill:#8c96a0}
.ours-tail{stroke:#0a7d55;fill:none;stroke-width:1.5}
.peer-tail{stroke:#8c96a0;fill:none;stroke-width:1.5}"""
        head = (f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{y + 14}" '
                f'viewBox="0 0 {width} {y + 14}"><style>{style}</style>'
                f'<rect width="100%" height="100%" fill="#fff"/>')
        return head + "\n" + "\n".join(out) + "\n</svg>\n"


def write(results, folder):
    (folder / "benchmarks.json").write_text(json.dumps(results, indent=1) + "\n")
    report = Report(results)
    (folder / "benchmarks.md").write_text(report.markdown())
    (folder / "benchmarks.svg").write_text(report.picture())


if __name__ == "__main__":
    path = pathlib.Path(sys.argv[1])
    write(json.loads(path.read_text()), path.parent)
