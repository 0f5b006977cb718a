"""Hybrid and shared control, internal forces: the laws, and arms that obey them."""

import numpy as np
import pytest

import cylindroid as cy

rng = np.random.default_rng(12)
PLANE = np.eye(6)[:, [0, 1, 3, 4, 5]]


def pose(rotation_vector, translation):
    angle = np.linalg.norm(rotation_vector)
    x, y, z = np.asarray(rotation_vector) / angle
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    T = np.eye(4)
    T[:3, :3] += np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
    T[:3, 3] = translation
    return T


def test_a_projector_and_its_parts():
    motions = rng.normal(size=(6, 3))
    for along in (0.3, rng.normal(size=(6, 3))):
        P = cy.Projector(motions, along)
        np.testing.assert_array_equal(P.matrix, cy.projector(motions, along))
        np.testing.assert_allclose(P.matrix @ motions, motions, atol=1e-10)
        twist, wrench = rng.normal(size=(2, 6))
        np.testing.assert_allclose(P.motion(twist), P.matrix @ twist, atol=1e-10)
        np.testing.assert_allclose(P.motion(twist) + P.rest(twist), twist, atol=1e-12)
        np.testing.assert_allclose(P.constraint(wrench), wrench - P.matrix.T @ wrench, atol=1e-10)
        np.testing.assert_allclose(P.constraint(wrench) @ motions, 0, atol=1e-10)
        assert P.norm >= 1 - 1e-12
    with pytest.raises(cy.InvalidOptionError, match="no projector"):
        cy.Projector(motions, motions)


def test_the_twist_between_poses():
    start, screw = pose([0.1, 0.2, 0.3], [1, 2, 3]), np.array([0.3, -0.2, 0.1, 0.0, 0.0, 0.7])
    assert not cy.screw_to(start, start).any()
    turned = pose([0, 0, 0.7], [0, 0, 0])
    end = start.copy()
    end[:3, :3] = turned[:3, :3] @ start[:3, :3]
    np.testing.assert_allclose(cy.screw_to(start, end), [0, 0, 0, 0, 0, 0.7], atol=1e-14)
    # Small steps along the twist, which is constant in axes that move with the body's origin.
    at, steps = start.copy(), 20_000
    for _ in range(steps):
        lever = at[:3, 3] - start[:3, 3]
        at[:3, 3] += (screw[:3] + np.cross(screw[3:], lever)) / steps
        at[:3, :3] = pose(screw[3:] / steps, [0, 0, 0])[:3, :3] @ at[:3, :3]
    np.testing.assert_allclose(cy.screw_to(start, at), screw, atol=1e-4)


def test_admittances():
    C = cy.Admittance(0.01, 0.2, point=[0, 0, 1.0]).matrix
    # A force at the point moves the point along it and turns nothing.
    wrench = np.array([1, 0, 0, 0, 1.0, 0])
    np.testing.assert_allclose(C @ wrench, [0.01, 0, 0, 0, 0, 0], atol=1e-15)
    np.testing.assert_allclose(C, C.T, atol=1e-15)
    same = cy.Admittance.from_matrix(C)
    np.testing.assert_array_equal(same.matrix, C)
    T = pose([0.4, -1.0, 2.0], [9, 0, 0])
    A = cy.adjoint(T)
    np.testing.assert_allclose(same.seen_from(T).matrix, A @ C @ A.T, atol=1e-12)
    for bad in (-np.eye(6), np.eye(5), np.nan * np.eye(6)):
        with pytest.raises(cy.CylindroidError):
            cy.Admittance.from_matrix(bad)
    with pytest.raises(cy.InvalidOptionError):
        cy.Admittance(-0.1)


def test_hybrid_control_is_its_formula_in_every_frame():
    motions, along = rng.normal(size=(6, 4)), 0.4
    P = cy.Projector(motions, along)
    C = cy.Admittance(0.02, 0.3)
    law = cy.HybridController(3.0, C)
    error, forward, desired, measured = rng.normal(size=(4, 6))
    found = law.command(P, error, desired, measured, forward)
    M, one = P.matrix, np.eye(6)
    expected = M @ (3 * error + forward) + (one - M) @ C.matrix @ (one - M.T) @ (desired - measured)
    np.testing.assert_allclose(found.twist, expected, atol=1e-10)
    np.testing.assert_allclose(found.position_part + found.force_part, found.twist, atol=1e-12)
    np.testing.assert_allclose(found.wrench_error @ motions, 0, atol=1e-10)
    T = pose([0.4, -1.0, 2.0], [0.9, 0.2, 0])
    A = cy.adjoint(T)
    B = np.linalg.inv(A).T
    there = law.seen_from(T).command(
        cy.Projector(A @ motions, along), A @ error, B @ desired, B @ measured, A @ forward
    )
    np.testing.assert_allclose(there.twist, A @ found.twist, atol=1e-9)
    assert "twist" in repr(found)
    with pytest.raises(cy.NotFiniteError):
        law.command(P, error * np.nan, desired, measured)
    with pytest.raises(cy.DimensionError, match="desired"):
        law.command(P, error, [1, 2], measured)
    with pytest.raises(cy.InvalidOptionError, match="gain"):
        cy.HybridController(0.0, C)


def test_an_arm_presses_on_a_table():
    r = cy.load("panda")
    dt, stiffness, force = 1e-3, 1e4, 10.0
    servo = cy.Servo(r, dt=dt)
    P = cy.Projector(PLANE, np.inf, length=r.reach)
    law = cy.HybridController(10.0, cy.Admittance(0.01))
    q = r.home
    start = r.fk(q)
    target = start.copy()
    target[:3, 3] += [0.02, 0.01, 0.3]  # the height is no matter: the table is
    for _ in range(2000):
        T = r.fk(q)
        depth = max(start[2, 3] - T[2, 3], 0.0)
        measured = [0, 0, -stiffness * depth, 0, 0, 0]
        command = law.command(P, cy.screw_to(T, target), [0, 0, -force, 0, 0, 0], measured)
        servo.step(q, T, feed_forward=command.twist)
        q = servo.advance(q)
    T = r.fk(q)
    assert abs(stiffness * (start[2, 3] - T[2, 3]) - force) < 1e-3
    np.testing.assert_allclose(T[:2, 3], target[:2, 3], atol=1e-6)


def test_shared_control_is_its_formula():
    motions = rng.normal(size=(6, 3))
    P = cy.Projector(motions, rng.normal(size=(6, 3)))
    error, forward, operator = rng.normal(size=(3, 6))
    found = cy.SharedController(2.0).command(P, error, operator, forward)
    M = P.matrix
    np.testing.assert_allclose(found.operator_part, M @ operator, atol=1e-10)
    np.testing.assert_allclose(found.robot_part, (np.eye(6) - M) @ (2 * error + forward), atol=1e-10)
    np.testing.assert_allclose(found.robot_part + found.operator_part, found.twist, atol=1e-12)
    with pytest.raises(cy.NotFiniteError, match="operator"):
        cy.SharedController(2.0).command(P, error, operator * np.inf)


def test_the_share_of_an_operator():
    r = cy.load("panda")
    servo, share = cy.Servo(r, dt=0.001), cy.OperatorAuthority(0.001, fall=0.1, rise=0.01)
    assert share.value == 0.0
    with pytest.raises(cy.InvalidOptionError, match="first step"):
        share.update(servo)
    T = r.fk(r.home)
    for i in range(20):
        servo.step(r.home, T)
        share.update(servo)
        assert abs(share.value - min(1.0, 0.1 * (i + 1))) < 1e-12
    # Faster than any joint: limits slow or bend the motion, and the share falls.
    servo.step(r.home, T, feed_forward=[0, 0, 50.0, 0, 0, 0])
    assert servo.scale < 1 or servo.direction_lost
    share.update(servo)
    assert abs(share.value - np.exp(-0.01)) < 1e-12
    with pytest.raises(cy.InvalidOptionError, match="fall"):
        cy.OperatorAuthority(0.001, 0.0, 1.0)


def test_a_squeeze_moves_nothing_in_the_stiffness():
    r = cy.load("two-arm")
    c = r.constraint(r.assemble().q)
    a = len(c.actuated)
    stiffness = rng.uniform(1e3, 5e3, a)
    desired, measured = rng.normal(size=(2, a))
    found = cy.InternalForceController(10.0, stiffness).command(c, desired, measured)
    m = c.mobility()
    motions = m.dof_basis[:a]
    # Internal torques do no work; the rates lie across all motions in the metric of the springs.
    np.testing.assert_allclose(motions.T @ found.internal, 0, atol=1e-9)
    np.testing.assert_allclose(motions.T @ (stiffness * found.joint_velocities), 0, atol=1e-9)
    np.testing.assert_allclose(stiffness * found.joint_velocities, 10.0 * found.error, atol=1e-9)
    # Exactly the internal part: what remains of the torques is a spring's answer to a motion.
    rest = (measured - found.internal) / stiffness
    along = motions @ np.linalg.lstsq(motions, rest, rcond=None)[0]
    np.testing.assert_allclose(along, rest, atol=1e-9)
    squeeze = -c.Ja.T @ c.internal_forces()[:, 0]
    again = cy.InternalForceController(1.0, stiffness).command(c, squeeze, squeeze)
    np.testing.assert_allclose(again.error, 0, atol=1e-9)
    with pytest.raises(cy.DimensionError, match="stiffness"):
        cy.InternalForceController(1.0, [1.0]).command(c, desired, measured)
