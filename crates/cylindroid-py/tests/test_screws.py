"""Screw systems from Python: their laws, in columns that are linear first."""

import numpy as np
import pytest

import cylindroid as cy

rng = np.random.default_rng(11)


def pose():
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    T = np.eye(4)
    T[:3, :3] = Q * np.sign(np.linalg.det(Q))
    T[:3, 3] = rng.normal(size=3)
    return T


def form(h):
    Z, E = np.zeros((3, 3)), np.eye(3)
    return np.block([[Z, E / 2], [E / 2, -h * E]])


CYLINDROID = np.array([[0, 0], [0, 0], [0, -0.2], [0, 1], [0, 0], [1, 0]], dtype=float)


def test_adjoint_and_screws():
    T = pose()
    A = cy.adjoint(T)
    np.testing.assert_allclose(A[3:, 3:], T[:3, :3], atol=1e-15)
    np.testing.assert_allclose(A[3:, :3], 0)
    np.testing.assert_allclose(cy.adjoint(np.linalg.inv(T)) @ A, np.eye(6), atol=1e-14)
    twist = rng.normal(size=6)
    s = cy.Screw(twist)
    np.testing.assert_allclose(s.twist, twist, atol=1e-14)
    assert abs(s.pitch - twist[:3] @ twist[3:] / (twist[3:] @ twist[3:])) < 1e-14
    assert abs(np.linalg.norm(s.direction) - 1) < 1e-15 and abs(s.point @ s.direction) < 1e-12
    slide = cy.Screw([0, 0, 2, 0, 0, 0])
    assert slide.is_translation and slide.pitch == np.inf and slide.amplitude == 2


@pytest.mark.parametrize("rank", range(1, 7))
def test_systems_do_not_change_with_the_frame(rank):
    J = rng.normal(size=(6, rank)) @ rng.normal(size=(rank, 7))
    T = pose()
    here, there = cy.ScrewSystem(J), cy.ScrewSystem(cy.adjoint(T) @ J)
    assert here.rank == there.rank == rank and here.gibson_hunt == there.gibson_hunt
    np.testing.assert_allclose(here.principal_pitches, there.principal_pitches, atol=1e-9)
    assert here.basis.shape == (6, rank) and here.residual < 1e-9
    for h in (0.3, -1.0):
        P, Q = here.projector(h), there.projector(h)
        A = cy.adjoint(T)
        np.testing.assert_allclose(A @ P, Q @ A, atol=1e-7)
        np.testing.assert_allclose(P @ J, J, atol=1e-9)
        np.testing.assert_allclose(P @ P, P, atol=1e-8)
    reciprocal = here.reciprocal()
    assert reciprocal.rank == 6 - rank
    np.testing.assert_allclose(reciprocal.basis.T @ form(0) @ J, 0, atol=1e-10)
    assert here.sum(reciprocal).rank == 6
    assert here.intersection(here).rank == rank
    assert here.contains(J[:, 0]) and here.sine_to(J[:, 0]) < 1e-12


def test_the_cylindroid():
    s = cy.ScrewSystem(CYLINDROID)
    assert (s.rank, s.gibson_hunt, s.ambiguous) == (2, "IA", False)
    np.testing.assert_allclose(s.principal_pitches, [0.1, -0.1], atol=1e-15)
    np.testing.assert_allclose(s.canonical_pose[:3, 3], [0, 0.1, 0], atol=1e-15)
    assert [round(x.pitch, 12) for x in s.principal_screws] == [0.1, -0.1]
    assert s.margins and all(m.value > m.threshold for m in s.margins)
    assert "cylindroid" in s.meaning and "IA" in repr(s) and "<table>" in s._repr_html_()
    at = s.existence(0.1)
    assert not at.exists and not at and "principal pitch" in at.reason
    assert s.projector(0.1) is None and s.projector_norm(0.1) == np.inf
    assert s.existence(0.0) and s.projector_norm(0.0) >= 1
    pitch, norm = s.choose_pitch()
    assert norm >= 1 and s.existence(pitch)


def test_classes():
    translations = np.vstack([np.eye(3), np.zeros((3, 3))])
    assert cy.ScrewSystem(translations).gibson_hunt == "IID"
    assert cy.ScrewSystem(np.zeros((6, 2))).gibson_hunt == "0"
    assert cy.ScrewSystem(np.eye(6)).gibson_hunt == "6"
    assert cy.ScrewSystem(np.zeros((6, 0))).rank == 0
    wrist = np.vstack([np.zeros((3, 3)), np.eye(3)])
    assert cy.ScrewSystem(wrist).gibson_hunt == "IIA"
    assert cy.ScrewSystem(wrist).choose_pitch()[0] is not None


def test_hyperbolic_is_the_projector():
    r = cy.load("youbot")
    J = r.jacobian(r.home + 0.3, reference="world")
    s = cy.ScrewSystem(J, length=r.reach)
    P = J @ cy.hyperbolic(J, 0.1, length=r.reach).matrix
    np.testing.assert_allclose(P, s.projector(0.1), atol=1e-9)
    free = cy.ScrewSystem(np.array([[0, 0, 0, 1, 0, 0.0]]).T)
    along = s.projector_along(free)
    np.testing.assert_allclose(along @ free.basis, 0, atol=1e-9)
    np.testing.assert_allclose(cy.projector(J, 0.1, length=r.reach), s.projector(0.1), atol=1e-9)
    np.testing.assert_allclose(cy.projector(J, free.basis), along, atol=1e-9)
    with pytest.raises(cy.InvalidOptionError, match="principal pitch"):
        cy.projector(CYLINDROID, 0.1)


def test_involution():
    # Four lines and their two transversals, then two that cut the same two lines in one plane.
    points, directions = rng.normal(size=(4, 3)), rng.normal(size=(4, 3))
    lines = np.stack([points, directions], axis=1)
    found = cy.involution(lines)
    assert found.independent and not found.in_involution and found.null_twist is None
    twists = np.vstack([np.cross(points, directions).T, directions.T])
    assert cy.involution(twists).in_involution == found.in_involution
    for line in cy.transversals(lines).lines:
        crossing = np.concatenate([np.cross(line[0], line[1]), line[1]])
        np.testing.assert_allclose(twists.T @ (2 * form(0)) @ crossing, 0, atol=1e-9)
    # Five lines that meet one line let a force along it through.
    axis = np.array([0.0, 0, 1])
    five = [[[0, 0, z], d] for z, d in zip(range(5), rng.normal(size=(5, 3)))]
    found = cy.involution(five)
    assert found.in_involution and found.independent
    assert abs(found.null_screw.pitch) < 1e-9 and abs(abs(found.null_screw.direction @ axis) - 1) < 1e-9
    J = np.array([np.concatenate([np.cross(p, d), d]) for p, d in np.array(five)]).T
    np.testing.assert_allclose(found.wrench @ J, 0, atol=1e-9)
    assert found.transversals.lines.shape == (1, 2, 3) and found.system.rank == 5
    with pytest.raises(cy.InvalidOptionError, match="pitch zero"):
        cy.involution(np.array([[0, 0, 1, 0, 0, 1.0]]).T)
    with pytest.raises(cy.InvalidOptionError, match="points and directions"):
        cy.involution(np.zeros((2, 5)))


def test_hyperbolic_svd():
    robot = cy.load("youbot")
    J = robot.jacobian(robot.home)
    Q = np.block([[np.zeros((3, 3)), np.eye(3)], [np.eye(3), -0.2 * np.eye(3)]]) / 2
    metric = np.diag([1.0, 2.0, 3.0, 4.0, 5.0])
    svd = cy.hyperbolic_svd(J, 0.1, np.diag(metric))
    expected = np.sort(np.linalg.eigvals(np.linalg.solve(metric, J.T @ Q @ J)).real)[::-1]
    np.testing.assert_allclose(svd.squares, expected, atol=1e-12)
    np.testing.assert_allclose(svd.left @ np.diag(svd.values) @ svd.right.T @ metric, J, atol=1e-12)
    np.testing.assert_allclose(svd.isometry @ svd.stretch, J, atol=1e-12)
    np.testing.assert_allclose(svd.isometry.T @ Q @ svd.isometry, metric @ svd.signs, atol=1e-11)
    assert svd.polar == "signed" and svd.reason is None
    system = cy.ScrewSystem(J)
    assert svd.signature == system.signature(0.1)
    none = cy.hyperbolic_svd(np.eye(6)[:, :3], 0.1)
    assert none.polar == "none" and none.signature == (0, 0, 3) and none.isometry is None
    assert "never" in none.reason or "no hyperbolic" in none.reason
    with pytest.raises(cy.NotFiniteError):
        cy.hyperbolic_svd(J, np.inf)


def test_eigenscrews():
    rng = np.random.default_rng(3)
    R = rng.normal(size=(6, 6))
    K, h = R @ R.T, 0.3
    found = cy.eigenscrews(K, h)
    D = np.block([[np.zeros((3, 3)), np.eye(3)], [np.eye(3), -2 * h * np.eye(3)]])
    np.testing.assert_allclose(K @ found.twists, D @ found.twists * found.eigenvalues, atol=1e-9)
    springs = found.wrenches @ np.diag(np.abs(found.eigenvalues)) @ found.wrenches.T
    np.testing.assert_allclose(springs, K, atol=1e-9)
    assert found.kind == "definite" and sum(found.eigenvalues > 0) == 3
    assert np.isclose(found.spring_pitch, np.trace(K[:3, 3:]) / np.trace(K[:3, :3]))
    assert cy.eigenscrews(-K).kind == "indefinite"
