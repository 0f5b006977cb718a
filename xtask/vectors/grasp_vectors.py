#!/usr/bin/env python3
"""Write reference qualities of grasps by solvers that nobody here wrote.

    VENV/bin/python xtask/vectors/grasp_vectors.py --out crates/cylindroid/tests/vectors/grasps

The set W of wrenches of the bounded contact forces is never built. The wrench of most length r(d)
along a unit vector d that the contacts resist is a second-order cone program, which Clarabel
solves; the normal n of W at its end is the dual solution. The support of W along n/|n| is at most
r(d), and r(n/|n|) at most that: the iteration d <- n/|n| descends to a local minimum of r, and the
quality `epsilon` is the least of many starts.

Where `inner` and `outer` are given, they bound the quality by Qhull: cones replaced by pyramids
inside and outside, whose hulls have the nearest facet at these distances. The starts then include
the nearest facets. Grasps in the plane have no curved cones: `inner` is exact, without Clarabel.

Wrenches are about the origin, in newton and newton metre over a length of 1 m; `bound` is "l1"
(normal forces sum to 1) or "linf" (each is at most its strength); `torsion` is null for a hard
finger.
"""

import argparse
import itertools
import json
from importlib.metadata import version
from pathlib import Path

import clarabel
import numpy as np
import scipy
from scipy import sparse
from scipy.spatial import ConvexHull

SEED = 916
STARTS = 20
EDGES = 48
SPHERE = 240


def columns(contact):
    """6 x k: normal, two tangents, moment about the normal, scaled so that |rest| <= first."""
    point, normal = np.array(contact["point"]), np.array(contact["normal"])
    first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    first /= np.linalg.norm(first)
    forces = [normal, contact["mu"] * first, contact["mu"] * np.cross(normal, first)]
    found = [np.r_[f, np.cross(point, f)] for f in forces]
    if contact["torsion"] is not None:
        found.append(np.r_[np.zeros(3), contact["torsion"] * normal])
    return np.array(found).T


def farthest(contacts, bound, direction):
    """The largest r with r * direction resisted, and the normal of W there."""
    blocks = [columns(c) for c in contacts]
    k = sum(b.shape[1] for b in blocks)
    starts = np.cumsum([0] + [b.shape[1] for b in blocks])
    # Variables: r, then the forces.
    rows, right, cones = [np.hstack([direction[:, None], -np.hstack(blocks)])], [np.zeros(6)], []
    cones.append(clarabel.ZeroConeT(6))
    normals = np.zeros((len(blocks), 1 + k))
    for i, start in enumerate(starts[:-1]):
        normals[i, 1 + start] = 1.0
    if bound == "l1":
        rows.append(normals.sum(axis=0)[None, :])
        right.append([1.0])
        cones.append(clarabel.NonnegativeConeT(1))
    else:
        rows.append(normals)
        right.append([c["strength"] for c in contacts])
        cones.append(clarabel.NonnegativeConeT(len(blocks)))
    for start, block in zip(starts, blocks):
        size = block.shape[1]
        cone = np.zeros((size, 1 + k))
        cone[:, 1 + start:1 + start + size] = -np.eye(size)
        rows.append(cone)
        right.append(np.zeros(size))
        cones.append(clarabel.SecondOrderConeT(size))
    cost = np.r_[-1.0, np.zeros(k)]
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-11
    quadratic = sparse.csc_matrix((1 + k, 1 + k))
    solver = clarabel.DefaultSolver(
        quadratic, cost, sparse.csc_matrix(np.vstack(rows)), np.concatenate(right), cones, settings)
    solution = solver.solve()
    dual = np.array(solution.z[:6])
    return solution.x[0], dual / np.linalg.norm(dual)


def smallest(contacts, bound, starts):
    best = np.inf
    for direction in starts:
        reach = np.inf
        for _ in range(200):
            now, normal = farthest(contacts, bound, direction)
            if not now < reach - 1e-11:
                break
            reach = now
            direction = normal if normal @ direction > 0 else -normal
        best = min(best, reach)
    return best


def sphere(count, dimension, random):
    """Directions of a pyramid's edges: a regular polygon, or points on a sphere."""
    if dimension == 2:
        angles = 2 * np.pi * np.arange(count) / count
        return np.c_[np.cos(angles), np.sin(angles)]
    points = random.normal(size=(count, dimension))
    for _ in range(200):
        points /= np.linalg.norm(points, axis=1)[:, None]
        apart = points[:, None] - points[None]
        far = np.linalg.norm(apart, axis=2) + np.eye(count)
        points += (apart / far[..., None] ** 3).sum(axis=1) / count ** 1.5
    return points / np.linalg.norm(points, axis=1)[:, None]


def pyramids(contacts, random):
    """Distance of the nearest facet of the hull of pyramids inside and outside, and the normals."""
    found, shapes = [], []
    for c in contacts:
        size = columns(c).shape[1] - 1
        edges = sphere(EDGES if size == 2 else SPHERE // len(contacts), size, random)
        turn = np.linalg.qr(random.normal(size=(size, size)))[0]
        shapes.append((edges @ turn, -ConvexHull(edges).equations[:, -1].max()))
    for outside in (False, True):
        points = []
        for c, (edges, inner) in zip(contacts, shapes):
            g = columns(c)
            edges = edges / inner if outside else edges
            points.append(g[:, 0] + edges @ g[:, 1:].T)
        # Opposite fingers have degenerate facets: Qhull moves points by rounding errors.
        hull = ConvexHull(np.vstack(points), qhull_options="QJ")
        offsets = -hull.equations[:, -1]
        nearest = np.argsort(offsets)[:STARTS]
        found.append((offsets.min(), hull.equations[nearest, :-1]))
    return found


def unit(v):
    return v / np.linalg.norm(v)


def grasp(random, count, soft):
    first = unit(random.normal(size=3))
    contacts = []
    for i in range(count):
        about = (np.zeros(3), -first, np.zeros(3), np.zeros(3))[i]
        point = first if i == 0 else unit(about + (0.2 if i == 1 else 1.0) * random.normal(size=3))
        normal = unit(-point + 0.15 * random.normal(size=3))
        contacts.append({
            "point": point.tolist(), "normal": normal.tolist(),
            "mu": random.uniform(0.3, 0.9),
            "torsion": random.uniform(0.1, 0.8) if soft else None,
            "strength": random.uniform(0.5, 2.0)})
    return contacts


def planar(random):
    contacts = []
    for i in range(3):
        angle = 2 * np.pi * i / 3 + random.uniform(-0.4, 0.4)
        point = np.array([np.cos(angle), np.sin(angle)])
        turn = random.uniform(-0.3, 0.3)
        normal = -np.array([np.cos(angle + turn), np.sin(angle + turn)])
        contacts.append({
            "point": [*point.tolist(), 0.0], "normal": [*normal.tolist(), 0.0],
            "mu": random.uniform(0.2, 0.8), "torsion": None,
            "strength": random.uniform(0.5, 2.0)})
    return contacts


def exact_in_the_plane(contacts, bound):
    edges = []
    for c in contacts:
        (x, y, _), (a, b, _), mu = c["point"], c["normal"], c["mu"]
        forces = [(a - mu * b * s, b + mu * a * s) for s in (1, -1)]
        edges.append([np.array([f, g, x * g - y * f]) for f, g in forces])
    if bound == "l1":
        points = [w for pair in edges for w in pair]
    else:
        each = [[0 * p[0], *(c["strength"] * w for w in p)] for p, c in zip(edges, contacts)]
        points = [sum(choice) for choice in itertools.product(*each)]
    return -ConvexHull(np.array(points)).equations[:, -1].max()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    out = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    random = np.random.default_rng(SEED)
    cases = []
    opposite = [[{"point": [s, 0.0, 0.0], "normal": [-s, 0.0, 0.0], "mu": 0.5, "torsion": t,
                  "strength": 1.0} for s in (1.0, -1.0)] for t in (0.2, 0.4, 0.7)]
    shapes = [(2, True)] * 4 + [(3, True)] * 3 + [(3, False)] * 3 + [(4, False)] * 2
    closed = [(shape, True) for shape in opposite + shapes]
    opened = [(shape, False) for shape in [(2, True), (3, True), (3, False), (4, False)]]
    for shape, resists in closed + opened:
        # Of random grasps those whose verdict the pyramids settle.
        while True:
            contacts = grasp(random, *shape) if isinstance(shape, tuple) else shape
            if not resists:
                for contact in contacts:
                    contact["mu"] *= 0.3
            (inner, below), (outer, above) = pyramids(contacts, random)
            if (inner > 1e-3) if resists else (outer < -1e-3):
                break
        for bound in ("l1", "linf"):
            case = {"planar": False, "bound": bound, "closed": bool(inner > 0),
                    "contacts": contacts}
            if bound == "l1":
                case |= {"inner": inner, "outer": outer}
            if inner > 0:
                starts = [*below, *above, *map(unit, random.normal(size=(STARTS, 6)))]
                case["epsilon"] = smallest(contacts, bound, starts)
            print(bound, len(contacts), *(case.get(k) for k in ("inner", "epsilon", "outer")))
            cases.append(case)
    for _ in range(6):
        contacts = planar(random)
        for bound in ("l1", "linf"):
            epsilon = exact_in_the_plane(contacts, bound)
            case = {"planar": True, "bound": bound, "closed": bool(epsilon > 1e-9)}
            cases.append(case | {"contacts": contacts, "epsilon": epsilon})
            print(bound, "planar", epsilon)
    source = {"generator": "xtask/vectors/grasp_vectors.py", "clarabel": version("clarabel"),
              "scipy": scipy.__version__, "numpy": np.__version__}
    text = json.dumps(source | {"cases": cases}, separators=(",", ":")) + "\n"
    (out / "quality.json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
