"""Inverses against numpy, their laws, their reports."""

import numpy as np
import pytest

import cylindroid as cy

rng = np.random.default_rng(5)


def of_rank(rank, m=6, n=7):
    return rng.normal(size=(m, rank)) @ rng.normal(size=(rank, n))


@pytest.mark.parametrize("shape", [(6, 7), (6, 6), (6, 5), (3, 7), (1, 4), (4, 1)])
def test_pinv_is_numpys(shape):
    for eps in (1e-3, 1e-9, 0.3):
        stack = rng.normal(size=(50, *shape))
        expected = np.linalg.pinv(stack, eps)
        found = cy.pinv(stack, eps)
        np.testing.assert_allclose(found.matrix, expected, atol=1e-11 / eps**0.5)
        values = np.linalg.svd(stack, compute_uv=False)
        np.testing.assert_allclose(found.singular_values, values, atol=1e-13)
        np.testing.assert_array_equal(found.rank, (values > eps * values[:, :1]).sum(1))
        np.testing.assert_allclose(found.threshold, eps * values[:, 0], rtol=1e-13)
        assert found.exists.all() and found.reason == [None] * 50


@pytest.mark.parametrize("rank", range(6))
def test_pinv_of_lost_rank_is_numpys(rank):
    for _ in range(20):
        J = of_rank(rank)
        found = cy.pinv(J, 1e-9)
        np.testing.assert_allclose(found.matrix, np.linalg.pinv(J, 1e-9), atol=1e-9)
        assert found.rank == rank and len(found.dropped) == 6 - rank
        for dropped in found.dropped:
            assert abs(np.linalg.norm(dropped.direction) - 1) < 1e-12
            np.testing.assert_allclose(J.T @ dropped.direction, 0, atol=1e-10)
            assert dropped.filter_factor == 0.0
    ones = cy.pinv(np.ones((3, 5)))
    np.testing.assert_allclose(ones.matrix, np.full((5, 3), 1 / 15), atol=1e-16)


def test_damped_is_its_formula():
    for J in (of_rank(6), of_rank(3), of_rank(2, 6, 5)):
        expected = J.T @ np.linalg.inv(J @ J.T + 0.3**2 * np.eye(6))
        np.testing.assert_allclose(cy.damped(J, 0.3).matrix, expected, atol=1e-13)


def test_weights_are_metrics():
    J = of_rank(6)
    W = np.diag(rng.uniform(0.5, 2, 7))
    expected = np.linalg.inv(W) @ J.T @ np.linalg.inv(J @ np.linalg.inv(W) @ J.T)
    for weights in (W, np.diag(W)):
        found = cy.inverse(J, "truncated", joint_weights=weights, eps=1e-9)
        np.testing.assert_allclose(found.matrix, expected, atol=1e-11)


def test_long_stacks_are_the_single_inverses():
    rng = np.random.default_rng(31)
    stack = rng.normal(size=(2000, 6, 7))
    stack[77, 5] = stack[77, 4]
    found = cy.pinv(stack)
    np.testing.assert_allclose(found.matrix, np.linalg.pinv(stack, 1e-3), atol=1e-11)
    assert found.rank[77] == 5 and len(found.dropped[77]) == 1
    one = cy.pinv(stack[77])
    assert (one.matrix == found.matrix[77]).all()
    assert (one.dropped[0].direction == found.dropped[77][0].direction).all()
    assert "2000 Jacobians of 6 x 7" in repr(found)
    with pytest.raises(cy.NotFiniteError, match=r"J\[3\]"):
        cy.pinv(np.where(np.arange(10 * 42).reshape(10, 6, 7) == 150, np.nan, 1.0))


@pytest.mark.parametrize(
    "method",
    [
        "truncated",
        "damped",
        "variable-damping",
        "numerical-filtering",
        "selectively-damped",
        "singular-value-filtering",
    ],
)
def test_every_method_stays_bounded_and_stacks(method):
    stack = np.array([of_rank(r) for r in (6, 5, 4, 3)])
    found = cy.inverse(stack, method)
    assert found.matrix.shape == (4, 7, 6) and np.isfinite(found.matrix).all()
    for i, J in enumerate(stack):
        one = cy.inverse(J, method)
        # Truncated ones of full rank are batched: equal to rounding.
        rounding = 1e-13 * np.abs(one.matrix).max() if (method, i) == ("truncated", 0) else 0.0
        np.testing.assert_allclose(found.matrix[i], one.matrix, rtol=0, atol=rounding)
        assert one.rank == found.rank[i] and len(one.dropped) == len(found.dropped[i])
        assert "rank" in repr(one) and "<table>" in one._repr_html_()
    assert repr(found)
    assert cy.inverse(np.zeros((0, 6, 7)), method).matrix.shape == (0, 7, 6)


def test_selectively_damped_keeps_its_rate():
    J = of_rank(6) * [[1], [1], [1], [1], [1], [1e-4]]
    task = rng.normal(size=6)
    assert np.abs(cy.selectively_damped(J, task, 0.5).matrix @ task).max() <= 0.5 + 1e-12


def adjoint(R, p):
    S = np.array([[0, -p[2], p[1]], [p[2], 0, -p[0]], [-p[1], p[0], 0]])
    return np.block([[R, S @ R], [np.zeros((3, 3)), R]])


def test_hyperbolic_rates_do_not_change_with_the_frame():
    r = cy.load("youbot")
    q = r.home + 0.3
    J = r.jacobian(q, reference="world")
    twist = rng.normal(size=6)
    rates = cy.hyperbolic(J, 0.1).matrix @ twist
    A = adjoint(r.fk(q)[:3, :3], rng.normal(size=3))
    np.testing.assert_allclose(cy.hyperbolic(A @ J, 0.1).matrix @ (A @ twist), rates, atol=1e-9)
    P = J @ cy.hyperbolic(J, 0.1).matrix
    np.testing.assert_allclose(P @ P, P, atol=1e-10)


def test_hyperbolic_says_why_not():
    J = np.array([[0.0], [-1], [0], [0], [0], [1]])
    found = cy.hyperbolic(J, 0.0)
    assert not found.exists and "principal pitch" in found.reason
    assert np.isnan(found.matrix).all() and found.matrix.shape == (1, 6)
    assert "reason" in repr(found)
    stack = cy.hyperbolic(np.array([J, J + 0]), 0.0)
    assert stack.exists.tolist() == [False, False] and "pitch" in stack.reason[0]
    assert cy.hyperbolic(J, 0.0, mu=0.1).exists
    assert np.isfinite(cy.hyperbolic(J, 0.0, mu=0.1).matrix).all()


def test_oblique_gives_up_what_was_named():
    J = cy.load("youbot").jacobian([0.1, 0.4, -0.8, 0.6, 0.2], reference="local")
    given_up = np.zeros((6, 1))
    given_up[3] = 1
    found = cy.oblique(J, given_up)
    assert found.exists
    P = J @ found.matrix
    np.testing.assert_allclose(P @ J, J, atol=1e-10)
    np.testing.assert_allclose(P @ given_up, 0, atol=1e-10)


def test_point_direction():
    r = cy.load("youbot")
    q = [0.1, 0.4, -0.8, 0.6, 0.2]
    J = r.jacobian(q, reference="world")
    p = r.fk(q)[:3, 3]
    found = cy.point_direction(J, p, [0, 0, 2.0])
    v = J[:3] + np.cross(J[3:].T, p).T
    np.testing.assert_allclose(v @ found.along, [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(v @ found.still, 0, atol=1e-12)
    assert found.still.shape == (5, 2)


def test_methods_are_documented():
    """What the table of methods lists is in the docstrings and is taken as keywords."""
    J = of_rank(6)
    robot = cy.load("panda")
    for method in cy.inverse_methods():
        name, rows = method["name"], method["parameters"]
        assert method["description"] and name in cy.Servo.__doc__ + cy.inverse.__doc__
        values = {row["name"]: row["default"] or 0.07 for row in rows}
        assert all(row["unit"] and row["domain"] and row["description"] for row in rows)
        servo = {"give_up": []} if name == "oblique" else values
        cy.Servo(robot, inverse=name, **servo)
        if name in ("hyperbolic", "hyperbolic-damped", "hyperbolic-gram", "oblique"):
            continue
        assert f"'{name}'" in cy.inverse.__doc__
        assert all(f"- {row['name']} [{row['unit']}]" in cy.inverse.__doc__ for row in rows)
        found = cy.inverse(J, name, **values)
        assert (found.matrix == cy.inverse(J, name).matrix).all()
    with pytest.raises(TypeError, match="unexpected keyword argument 'dmping'"):
        cy.inverse(J, "damped", dmping=0.1)
    with pytest.raises(cy.InvalidOptionError, match="no such parameter but damping"):
        cy.inverse(J, "damped", eps=0.1)
