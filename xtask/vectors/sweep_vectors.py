#!/usr/bin/env python3
"""Write statistics of samples of two arms with Pinocchio and NumPy.

    VENV/bin/python xtask/vectors/sweep_vectors.py --out crates/cylindroid/tests/vectors/sweep

One JSON file per robot of the example-robot-data package. The samples are computed here a second
time, from the direction numbers in crates/cylindroid/src/sweep/direction_numbers.rs: Sobol's
sequence with the scrambling by a hash of Burley 2020 and Vegdahl 2021, within the position limits.
`statistics` has the smallest value, the mean and the largest over all samples: position of the
frame (m), Yoshikawa's measure as the product of the singular values of the Jacobian (m, rad), the
smallest singular value and the condition with the linear rows divided by `length` (m).
"""

import argparse
import json
import math
import re
import sysconfig
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pinocchio as pin

ROBOTS = {
    "ur5": ("ur_description/urdf/ur5_robot.urdf", "tool0", 0.5),
    "panda": ("panda_description/urdf/panda.urdf", "panda_link8", 0.4),
}
COUNT, SEED = 10_000, 5
ROOT = Path(__file__).parents[2]
U32, U64 = (1 << 32) - 1, (1 << 64) - 1


def direction_vectors(dimensions):
    """v_dk as 32-bit numbers, by the recurrence of Joe and Kuo."""
    source = (ROOT / "crates/cylindroid/src/sweep/direction_numbers.rs").read_text()
    table = re.findall(r"\((\d+), &\[([\d, ]+)\]\)", source)
    all_vectors = [[1 << (31 - k) for k in range(32)]]
    for a, numbers in table[: dimensions - 1]:
        a, m = int(a), [int(x) for x in numbers.split(",")]
        s, v = len(m), []
        for k in range(32):
            if k < s:
                v.append(m[k] << (31 - k))
                continue
            x = v[k - s] ^ (v[k - s] >> s)
            for j in range(1, s):
                if (a >> (s - 1 - j)) & 1:
                    x ^= v[k - j]
            v.append(x)
        all_vectors.append(v)
    return all_vectors


def reverse(x):
    return int(f"{x:032b}"[::-1], 2)


def scrambled(x, by):
    x = reverse(x)
    x ^= x * 0x3D20ADEA & U32
    x = x + by & U32
    x = x * (by >> 16 | 1) & U32
    x ^= x * 0x05526C56 & U32
    x ^= x * 0x53A22864 & U32
    return reverse(x)


def hashed(seed, dimension):
    z = seed + (dimension + 1) * 0x9E3779B97F4A7C15 & U64
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9 & U64
    z = (z ^ z >> 27) * 0x94D049BB133111EB & U64
    return (z ^ z >> 31) >> 32


def samples(dimensions):
    """Points of the unit cube, (COUNT, dimensions)."""
    vectors = direction_vectors(dimensions)
    points = np.empty((COUNT, dimensions))
    for d, v in enumerate(vectors):
        by = hashed(SEED, d)
        for i in range(COUNT):
            x = 0
            for k in range(i.bit_length()):
                if i >> k & 1:
                    x ^= v[k]
            points[i, d] = (scrambled(x, by) + 0.5) / (1 << 32)
    return points


def mimics(urdf):
    """The names of mimic joints."""
    text = urdf.read_text()
    return re.findall(r'<joint name="([^"]+)"[^>]*>(?:(?!</joint>).)*<mimic', text, re.S)


def statistics(values):
    return {
        "smallest": float(values.min()),
        "mean": math.fsum(values) / len(values),
        "largest": float(values.max()),
    }


def report(urdf, frame_name, length):
    model = pin.buildModelFromUrdf(str(urdf))
    data, frame = model.createData(), model.getFrameId(frame_name)
    followers = mimics(urdf)
    joints = [j for j in range(1, model.njoints) if model.names[j] not in followers]
    assert all(model.joints[j].nq == 1 for j in joints), "joints with limits"
    places = [model.joints[j].idx_q for j in joints]
    lower, upper = model.lowerPositionLimit[places], model.upperPositionLimit[places]
    points = samples(len(joints))
    positions, jacobians = np.empty((COUNT, 3)), np.empty((COUNT, 6, model.nv))
    q = pin.neutral(model)
    for i, point in enumerate(points):
        q[places] = lower + point * (upper - lower)
        jacobians[i] = pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)
        positions[i] = pin.updateFramePlacement(model, data, frame).translation
    volume = np.linalg.svd(jacobians, compute_uv=False).prod(-1)
    scaled = jacobians.copy()
    scaled[:, :3] /= length
    values = np.linalg.svd(scaled, compute_uv=False)
    found = {name: positions[:, k] for k, name in enumerate("xyz")}
    found |= {
        "yoshikawa": volume,
        "smallest_singular_value": values[:, -1],
        "condition": values[:, 0] / values[:, -1],
    }
    return {
        "by": {name: version(name) for name in ("pin", "numpy")},
        "joints": [model.names[j] for j in joints],
        "frame": frame_name,
        "length": length,
        "count": COUNT,
        "seed": SEED,
        "statistics": {name: statistics(values) for name, values in found.items()},
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--robots", type=Path, help="default: those of example-robot-data")
    arguments = parser.parse_args()
    installed = Path(sysconfig.get_path("purelib"))
    robots = arguments.robots or (
        installed / "cmeel.prefix/share/example-robot-data/robots"
    )
    arguments.out.mkdir(parents=True, exist_ok=True)
    for name, (urdf, frame, length) in ROBOTS.items():
        found = report(robots / urdf, frame, length)
        found = {"urdf": urdf} | found
        (arguments.out / f"{name}.json").write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
