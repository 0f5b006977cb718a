"""Sweeps of two arms together: one hand as seen from the other."""

import json
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pyarrow.parquet as parquet
import pytest

import cylindroid as cy

TORSO = """
tool = "left/hand_tcp"
[[joint]]
name = "torso"
type = "revolute"
between = ["ground", "chest"]
origin = [0, 0, 0.5]
axis = [0, 0, 1]
limits = { lower = -1.5, upper = 1.5 }
[[robot]]
name = "left"
model = "panda"
link = "chest"
base = { xyz = [0, 0.15, 0.8], rpy = [-1.2, 0, 0] }
[[robot]]
name = "right"
model = "panda"
link = "chest"
base = { xyz = [0, -0.15, 0.8], rpy = [1.2, 0, 0] }
"""


def test_one_hand_as_seen_from_the_other(tmp_path):
    robot = cy.parse(TORSO, format="toml")
    hands = {"frame": "left/hand_tcp", "relative_to": "right/hand_tcp"}
    quantities = ["pose", "jacobian", "singular_values", "yoshikawa"]
    found = cy.sweep(robot, samples=50, quantities=quantities, length=0.5, **hands)
    q = np.stack([found[name] for name in robot.joint_names], axis=1)
    jacobians = robot.relative_jacobian(q, "right/hand_tcp", "left/hand_tcp")
    for row, name in enumerate(["vx", "vy", "vz", "wx", "wy", "wz"]):
        for column, joint in enumerate(robot.joint_names):
            assert np.array_equal(found[f"jacobian_{name}_{joint}"], jacobians[:, row, column])
    assert not found["jacobian_wz_torso"].any()
    seen = np.linalg.inv(robot.fk(q, "right/hand_tcp")) @ robot.fk(q, "left/hand_tcp")
    assert np.allclose(np.stack([found[c] for c in "xyz"], 1), seen[:, :3, 3], atol=1e-12)
    scaled = jacobians / np.array([0.5, 0.5, 0.5, 1, 1, 1])[:, None]
    values = np.linalg.svd(scaled, compute_uv=False)
    own = np.stack([found[f"singular_value_{i + 1}"] for i in range(6)], 1)
    assert np.allclose(own, values, atol=1e-12)
    assert np.allclose(found["yoshikawa"], np.linalg.svd(jacobians, compute_uv=False).prod(1))

    same = {"samples": 50, "quantities": quantities, "length": 0.5}
    folder = cy.sweep(robot, **same, out=tmp_path / "own", **hands)
    metadata = parquet.read_metadata(folder.folder / "part-000000.parquet").metadata
    about = json.loads(metadata[b"cylindroid"])
    assert (about["frame"], about["relative_to"]) == (hands["frame"], hands["relative_to"])
    difference = 'relative_to is "right/hand_tcp" there and null now'
    with pytest.raises(cy.InvalidOptionError, match=difference):
        cy.sweep(robot, **same, frame="left/hand_tcp", out=tmp_path / "own", resume=True)
    with ThreadPoolExecutor(2) as workers:
        again = cy.sweep(robot, **same, engine=workers, **hands)
    assert all(np.array_equal(found[name], again[name]) for name in found)
    for refused in (["measures"], ["payload"]):
        with pytest.raises(cy.InvalidOptionError, match="relative_to"):
            cy.sweep(robot, samples=2, quantities=refused, **hands)
    with pytest.raises(cy.InvalidOptionError, match="relative_to"):
        cy.sweep(robot, reach={"x": (0.0, 1.0, 2)}, **hands)
    with pytest.raises(cy.UnknownNameError, match="right/hand_tcp"):
        cy.sweep(robot, samples=2, relative_to="right/hand")
