"""Grasps from Python: force closure, immobilisation."""

import numpy as np
import pytest

import cylindroid as cy


def test_grasps():
    def finger(angle, mu=0.5, **more):
        n = np.array([np.cos(angle), np.sin(angle), 0])
        return cy.FingerContact(n, -n, mu, **more)

    three = [finger(a) for a in (0.3, 0.3 + 2 * np.pi / 3, 0.3 + 4 * np.pi / 3)]
    good = cy.grasp_quality(three, planar=True)
    assert good.closed and 0 < good.epsilon[0] <= good.epsilon[1] and good.weakest.shape == (3,)
    smooth = [finger(a, mu=0.0) for a in (0.3, 0.3 + 2 * np.pi / 3, 0.3 + 4 * np.pi / 3)]
    assert not cy.grasp_quality(smooth, planar=True).closed
    assert not cy.grasp_quality(three[:1], planar=True).closed
    space = cy.grasp_quality(three, metric="linf")
    assert space.closed and "force closure" in repr(space)
    with pytest.raises(cy.InvalidOptionError, match="normal"):
        cy.grasp_quality([cy.FingerContact([0, 0, 0], [2, 0, 0])])
    with pytest.raises(cy.UnknownNameError):
        cy.grasp_quality(three, metric="all")


def test_immobilisation():
    def fingers(degrees, **curvature):
        out = [np.array([np.cos(a), np.sin(a), 0]) for a in np.radians(degrees)]
        return [cy.FingerContact(p, -p, **curvature) for p in out]

    triangle = cy.grasp_mobility(fingers([30, 150, 270]), planar=True)
    assert triangle.immobile is True and triangle.immobilisation == "immobile to second order"
    assert (triangle.first_order_mobility, triangle.second_order_mobility) == (1, 0)
    assert triangle.equilibria.shape == (3, 1) and triangle.free_motions.shape == (3, 1)
    np.testing.assert_allclose(triangle.forces, 1 / 3)
    np.testing.assert_allclose(triangle.curvatures, [-1])
    assert triangle.escape is None and not triangle.ambiguous
    assert "definite" in triangle.explanation and "second order" in repr(triangle)
    disc = cy.grasp_mobility(fingers([30, 150, 270], object_curvature=1), planar=True)
    assert disc.immobile is None and disc.second_order_mobility == 1
    ellipse = cy.grasp_mobility(fingers([90, 270], object_curvature=0.25), planar=True)
    assert ellipse.immobile is False
    velocity, acceleration = ellipse.escape
    assert velocity.shape == acceleration.shape == (3,)
    side = cy.grasp_mobility(fingers([90]), point=[0, 1, 0])
    assert side.second_order_mobility is None and len(side.forces) == 0
    # A cylinder about z between two fingers slides along z, to second order.
    tube = fingers([0, 180], object_curvature=([1.0, 0.0], [0, 1, 0]), finger_curvature=10)
    assert cy.grasp_mobility(tube).first_order_mobility == 5
    for bad in (float("nan"), ([1.0, 0.0], [1, 0, 0])):
        with pytest.raises(cy.InvalidOptionError, match="curvature"):
            cy.grasp_mobility(fingers([0, 180], object_curvature=bad))


def test_the_grasp_of_a_mechanism():
    r = cy.parse(HAND, "toml")
    rough = r.grasp_quality(mu=0.6)
    assert rough.closed and rough.epsilon[0] > 0
    assert r.grasp_quality().epsilon == pytest.approx(r.grasp_quality(mu=0.5).epsilon)
    assert not r.grasp_quality(mu=0.0).closed
    assert r.grasp_quality(metric="linf", strength=2.0).closed
    assert r.grasp_mobility().equilibria.shape[1] >= 1


HAND = """
name = "hand"
dimension = 2
reference = "object"
reference_point = [0, 1]

[[joint]]
name = "left"
type = "revolute"
between = ["ground", "finger 1"]
origin = [-1, 0]
actuated = true

[[joint]]
name = "right"
type = "revolute"
between = ["ground", "finger 2"]
origin = [1, 0]
actuated = true

[[contact]]
name = "c1"
type = "hard_finger"
between = ["finger 1", "object"]
point = [-1, 1]
normal = [1, 0]
friction = 0.5

[[contact]]
name = "c2"
type = "hard_finger"
between = ["finger 2", "object"]
point = [1, 1]
normal = [-1, 0]
friction = 0.5
"""
