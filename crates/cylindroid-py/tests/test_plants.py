"""The servo drives robots that MuJoCo simulates: drives that lag, delays of 1 and 20 ms, noise and
lost cycles. `cargo xtask plants` does it with more robots and targets, beside mink."""

import pathlib
import sys

import numpy as np
import pytest

sys.path.insert(0, str(pathlib.Path(__file__).parents[3] / "benches/control"))

import models  # noqa: E402
import plant_controllers  # noqa: E402
import plant_models  # noqa: E402
import plants  # noqa: E402


@pytest.fixture(scope="module")
def panda(robot_files, tmp_path_factory):
    source = robot_files / "panda_description/urdf/panda.urdf"
    names = [f"panda_joint{i}" for i in range(1, 8)]
    path = models.reduced(source, tmp_path_factory.mktemp("plants") / "panda.urdf", names)
    home, wrist, elbow, _ = plant_models.ARMS["panda"]
    return plant_models.Arm("panda", path, home, wrist, elbow, "panda_hand", "panda_link2")


def run(robot, kind, drive, seed=3):
    motion = robot.motion(kind, np.random.default_rng(seed))
    controller = plant_controllers.Cylindroid(robot)
    result = plants.follow(robot, kind, motion, drive, controller, seed)
    assert result["success"] and result["refused"] == 0, (robot.name, kind, drive, result)
    return result


@pytest.mark.parametrize("drive", plants.DRIVES, ids=str)
@pytest.mark.parametrize("kind", ["circle", "eight"])
@pytest.mark.parametrize("robot", [plant_models.FiveBar, plant_models.Stewart])
def test_parallel_robots_follow_by_their_drives_alone(robot, kind, drive):
    result = run(robot(), kind, drive)
    assert result["limits"] == 0 and result["speed"] < 0.02


@pytest.mark.parametrize("drive", plants.DRIVES, ids=str)
@pytest.mark.parametrize("kind", ["circle", "wrist", "edge"])
def test_an_arm_follows_ends_at_singularities_and_rests_at_the_edge(panda, kind, drive):
    result = run(panda, kind, drive)
    # The drives of MuJoCo resemble those that the servo knows: of the limits of speeds a twentieth is
    # exceeded at most, of positions a milliradian.
    assert result["speed"] < 0.05 and result["limits"] < 1e-3
