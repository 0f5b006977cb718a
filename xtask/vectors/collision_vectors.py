#!/usr/bin/env python3
"""Write reference vectors of distances between links with Pinocchio and Coal.

    VENV/bin/python xtask/vectors/collision_vectors.py \
        --out crates/cylindroid/tests/vectors/collision

One JSON file per robot of the example-robot-data package, with random configurations within the
limits (seeded). `pairs` holds for each configuration the nearest pairs of collision shapes and
some at random, of links that no joint connects: the two links, the number of the shape among
those of its link, the signed distance (m, negative: penetration depth) and, where it is positive
and above 1e-3, the unit normal from the first to the second. Meshes are replaced by their convex
hulls; a mimic joint is put where its leader wants it and has no entry in `q`. The tolerance of Coal's GJK and EPA is set to 1e-10; pairs for which
Coal 3.0.3 gives -1.8e308 (some cylinders that overlap) are left out.
"""

import argparse
import json
import math
import os
import sysconfig
import xml.etree.ElementTree as ElementTree
from importlib.metadata import version
from pathlib import Path

import coal
import numpy as np
import pinocchio as pin

ROBOTS = {
    "a1": "a1_description/urdf/a1.urdf",
    "allegro_right_hand": "allegro_hand_description/urdf/allegro_right_hand.urdf",
    "anymal_c": "anymal_c_simple_description/urdf/anymal.urdf",
    "iris": "iris_description/robots/iris.urdf",
    "panda": "panda_description/urdf/panda.urdf",
    "panda_collision": "panda_description/urdf/panda_collision.urdf",
    "romeo_laas_small": "romeo_description/urdf/romeo_laas_small.urdf",
}
CONFIGURATIONS = 20
NEAREST = 8
OTHERS = 6


def convex(geometry):
    """The shape, or the convex hull of a mesh."""
    if isinstance(geometry, coal.BVHModelBase):
        geometry.buildConvexHull(True, "Qt")
        return geometry.convex
    return geometry


def separation(a, at_a, b, at_b):
    request = coal.DistanceRequest()
    request.enable_signed_distance = True
    request.gjk_tolerance = request.epa_tolerance = 1e-10
    request.gjk_max_iterations = request.epa_max_iterations = 500
    result = coal.DistanceResult()
    placed = [coal.Transform3s(p.rotation, p.translation) for p in (at_a, at_b)]
    distance = coal.distance(a, placed[0], b, placed[1], request, result)
    gap = result.getNearestPoint2() - result.getNearestPoint1()
    return distance, gap / distance if distance > 1e-3 else None


def vectors(urdf, seed):
    model = pin.buildModelFromUrdf(str(urdf))
    shapes = pin.buildGeomFromUrdf(model, str(urdf), pin.GeometryType.COLLISION,
                                   package_dirs=[str(urdf.parents[2]), str(urdf.parents[1])])
    data, placed = model.createData(), shapes.createData()
    objects = list(shapes.geometryObjects)
    cores = [convex(o.geometry) for o in objects]
    neighbours = {(i, model.parents[i]) for i in range(1, model.njoints)}
    pairs = []
    for i, a in enumerate(objects):
        for j in range(i + 1, len(objects)):
            ends = (a.parentJoint, objects[j].parentJoint)
            if ends[0] != ends[1] and not neighbours & {ends, ends[::-1]}:
                pairs.append((i, j))

    def name(i):
        link, number = objects[i].name.rsplit("_", 1)
        return [link, int(number)]

    random = np.random.default_rng(seed)
    mimics = {}
    for joint in ElementTree.parse(urdf).getroot().iter("joint"):
        mimic = joint.find("mimic")
        if mimic is not None and model.existJointName(joint.get("name")):
            mimics[joint.get("name")] = (
                mimic.get("joint"), float(mimic.get("multiplier", 1)), float(mimic.get("offset", 0)))
    names = [n for n in list(model.names)[1:] if n not in mimics]
    configurations = []
    for _ in range(CONFIGURATIONS):
        q, values = pin.neutral(model), []
        for i in range(1, model.njoints):
            joint = model.joints[i]
            if model.names[i] in mimics:
                continue
            if joint.nq == 2:  # a continuous joint: cosine and sine
                angle = random.uniform(-math.pi, math.pi)
                q[joint.idx_q], q[joint.idx_q + 1] = math.cos(angle), math.sin(angle)
                values.append(angle)
                continue
            low = max(model.lowerPositionLimit[joint.idx_q], -math.pi)
            high = min(model.upperPositionLimit[joint.idx_q], math.pi)
            q[joint.idx_q] = random.uniform(low, high)
            values.append(float(q[joint.idx_q]))
        for mimic, (leader, multiplier, offset) in mimics.items():
            of, to = (model.joints[model.getJointId(n)].idx_q for n in (leader, mimic))
            q[to] = multiplier * q[of] + offset
        pin.updateGeometryPlacements(model, data, shapes, placed, q)
        found = []
        for i, j in pairs:
            d, normal = separation(cores[i], placed.oMg[i], cores[j], placed.oMg[j])
            if abs(d) < 1e3:
                found.append((d, i, j, normal))
        found.sort(key=lambda f: f[0])
        rest = found[NEAREST:]
        chosen = found[:NEAREST]
        if rest:
            some = sorted(random.choice(len(rest), min(OTHERS, len(rest)), replace=False))
            chosen += [rest[k] for k in some]
        configurations.append({"q": values, "pairs": [
            {"a": name(i), "b": name(j), "distance": d,
             "normal": None if normal is None else normal.tolist()}
            for d, i, j, normal in chosen]})
    return {"joints": names, "shapes": len(objects), "pairs": len(pairs),
            "configurations": configurations}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--robots", type=Path, help="folder of the robots; the package's if omitted")
    arguments = parser.parse_args()
    share = Path(sysconfig.get_paths()["purelib"]) / "cmeel.prefix/share"
    folder = arguments.robots or share / "example-robot-data/robots"
    # package://example-robot-data/robots/...
    os.environ["ROS_PACKAGE_PATH"] = str(folder.parents[1])
    arguments.out.mkdir(parents=True, exist_ok=True)
    made_with = {p: version(p) for p in ("pin", "coal")}
    for seed, (robot, urdf) in enumerate(ROBOTS.items()):
        found = vectors(folder / urdf, seed)
        text = json.dumps({"robot": robot, "urdf": urdf, "made_with": made_with, **found})
        (arguments.out / f"{robot}.json").write_text(text.replace('{"q"', '\n{"q"') + "\n")
        print(robot, found["shapes"], "shapes", found["pairs"], "pairs")


if __name__ == "__main__":
    main()
