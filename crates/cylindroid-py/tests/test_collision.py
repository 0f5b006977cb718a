"""Distances between links and to obstacles: numbers of the library as arrays, obstacles, errors."""

import numpy as np
import pytest

import cylindroid as cy

ARM = """
name = "arm"
[[joint]]
name = "a"
type = "revolute"
between = ["ground", "upper"]
origin = [0, 0, 0]
axis = [0, 0, 1]
limits = { lower = -3, upper = 3 }
[[joint]]
name = "b"
type = "revolute"
between = ["upper", "fore"]
origin = [1, 0, 0]
axis = [0, 0, 1]
limits = { lower = -3, upper = 3 }
[[collision]]
link = "ground"
shape = "sphere"
radius = 0.1
[[collision]]
link = "fore"
name = "tip"
shape = "capsule"
radius = 0.05
length = 0.4
xyz = [0.5, 0, 0]
rpy = [0, 1.5707963267948966, 0]
"""


@pytest.fixture
def arm():
    return cy.parse(ARM, format="toml")


def test_distances(arm):
    near = arm.distances([0.3, 0.5])
    assert near.pairs == [("ground", "fore")] and len(near) == 1
    assert near.distances.shape == (1,) and near.gradients.shape == (1, 2)
    for array in (near.points_a, near.points_b, near.normals):
        assert array.shape == (1, 3)
    gap = near.points_b - near.points_a
    assert np.allclose(gap, near.distances[:, None] * near.normals, atol=1e-12)
    # Joint a turns both about the centre of the sphere.
    assert abs(near.gradients[0, 0]) < 1e-12
    step = 1e-6
    low, high = (arm.distances([0.3, 0.5 + s]).distances[0] for s in (-step, step))
    assert near.gradients[0, 1] == pytest.approx((high - low) / (2 * step), abs=1e-8)
    none = arm.distances([0.3, 0.5], margin=0.01)
    assert len(none) == 0 and none.gradients.shape == (0, 2) and none.normals.shape == (0, 3)
    assert "fore" in repr(near) and "no pairs" in repr(none)


def test_obstacles_come_move_and_go(arm):
    model = cy.CollisionModel(arm, disabled=[("fore", "ground"), ("fore", "none")], samples=0)
    assert model.pairs == [] and "none" in model.ignored[0][1]
    model.add_obstacle("ball", "sphere", [3, 0, 0], radius=0.2)
    assert model.pairs == [("fore", "ball")] and model.obstacles == ["ball"]
    assert model.near([0, 0], margin=5).distances == pytest.approx([3 - 1.75 - 0.2])
    pose = np.eye(4)
    pose[0, 3] = 2
    model.move_obstacle("ball", pose)
    assert model.near([0, 0]).distances == pytest.approx([0.05])
    model.remove_obstacle("ball")
    assert model.pairs == [] and len(model.near([0, 0], margin=np.inf)) == 0
    shapes = {
        "capsule": {"radius": 0.1, "length": 0.5},
        "cylinder": {"radius": 0.1, "length": 0.5},
        "box": {"size": [1, 1, 1]},
        "ellipsoid": {"size": [0.1, 0.2, 0.3]},
        "half_space": {},
        "convex_hull": {"points": np.eye(3)},
    }
    for name, sizes in shapes.items():
        model.add_obstacle(name, name, [0, 0, -3], **sizes)
    assert len(model.near([0, 0], margin=np.inf)) == len(shapes)
    assert "6 obstacles" in repr(model)


def test_errors(arm, tmp_path):
    model = cy.CollisionModel(arm)
    with pytest.raises(cy.UnknownNameError, match="sphere"):
        model.add_obstacle("a", "spere", radius=1)
    with pytest.raises(cy.InvalidOptionError, match="radius"):
        model.add_obstacle("a", "sphere")
    with pytest.raises(cy.InvalidOptionError, match="no sizes"):
        model.add_obstacle("a", "half_space", radius=1)
    with pytest.raises(cy.InvalidOptionError):
        model.add_obstacle("a", "sphere", radius=-1)
    with pytest.raises(cy.UnknownNameError):
        model.move_obstacle("a", [0, 0, 0])
    with pytest.raises(cy.InvalidOptionError, match="none.stl"):
        model.add_obstacle("a", "mesh", file=tmp_path / "none.stl")
    with pytest.raises(cy.DimensionError):
        model.near([0, 0, 0])
    with pytest.raises(cy.UnknownNameError, match="capsule"):
        cy.CollisionModel(arm, meshes="capsul")
    with pytest.raises(cy.MissingFileError):
        cy.CollisionModel(arm, srdf=tmp_path / "none.srdf")


def test_srdf(arm, tmp_path):
    file = tmp_path / "arm.srdf"
    file.write_text('<robot name="arm"><disable_collisions link1="ground" link2="fore"/></robot>')
    assert cy.CollisionModel(arm, srdf=file).pairs == []
    assert len(arm.distances([0, 0], srdf=file)) == 0
