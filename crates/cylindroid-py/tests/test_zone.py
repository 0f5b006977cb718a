"""Singularity-free zones: attributes, shapes, bad input."""

import numpy as np
import pytest

import cylindroid as cy


def test_a_ball_in_joint_space():
    arm = cy.load("3r")
    found = cy.singularity_free_zone(arm, ["joint2", "joint3"], q=[0.0, 1.2, -1.2], rays=32)
    # cos q2 + cos(q2 + q3) = 0: the point is above the first axis.
    expected = (np.pi / 2 - 0.6) / np.hypot(1, 0.5)
    assert found.size == pytest.approx(expected, abs=1e-9) and found.shape == "ball"
    assert found.centre == {"joint2": 1.2, "joint3": -1.2}
    assert found.scales == {"joint2": 1.0, "joint3": 1.0} and found.held == {}
    first = found.bounds[0]
    assert first["kind"] == "type I" and first["limit"] is None
    assert first["distance"] == found.size
    np.testing.assert_allclose(first["q"][1:], first["point"], atol=1e-12)
    q2, q3 = first["point"]
    assert abs(np.cos(q2) + np.cos(q2 + q3)) < 1e-9
    assert found.confirmed >= found.certified > 16 and "type I" in repr(found)
    np.testing.assert_array_equal(found.q, [0.0, 1.2, -1.2])


def test_a_box_for_a_platform():
    robot = cy.load("five-bar")
    ball = cy.singularity_free_zone(robot, ["x", "y"], rays=32)
    box = cy.singularity_free_zone(robot, ["x", "y"], shape="box", rays=32)
    assert box.size <= ball.size + 1e-9 and box.size * 2**0.5 >= ball.size - 1e-9
    half = cy.singularity_free_zone(robot, ["x", "y"], scales=[0.5, 0.5], rays=32)
    assert half.size == pytest.approx(2 * ball.size, rel=1e-9)


def test_input_is_checked():
    robot = cy.load("five-bar")
    for call, kind in [
        (lambda: cy.singularity_free_zone(robot, []), cy.InvalidOptionError),
        (lambda: cy.singularity_free_zone(robot, ["w"]), cy.UnknownNameError),
        (lambda: cy.singularity_free_zone(robot, ["x"], free=["y", "rz"]), cy.InvalidOptionError),
        (lambda: cy.singularity_free_zone(robot, ["x", "y"], shape="cone"), cy.UnknownNameError),
        (lambda: cy.singularity_free_zone(robot, ["x", "y"], scales=[1.0]), cy.DimensionError),
        (lambda: cy.singularity_free_zone(robot, ["x", "y"], at={"x": np.inf}), cy.NotFiniteError),
        (lambda: cy.singularity_free_zone(robot, ["x", "y"], at={"x": 20.0}), cy.InvalidOptionError),
    ]:
        with pytest.raises(kind):
            call()


def test_the_configuration_is_named_as_in_the_call():
    robot = cy.load("five-bar")
    for call in (
        lambda q: cy.singularity_free_zone(robot, ["x", "y"], q=q),
        lambda q: cy.workspace_map(robot, {"x": (-1, 3, 5), "y": (0, 3, 5)}, q=q),
    ):
        with pytest.raises(cy.DimensionError, match=r"^q has 1 entries"):
            call([0.0])
