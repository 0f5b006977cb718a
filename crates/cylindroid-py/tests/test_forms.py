"""The forms of twists, exponential and logarithm, Gram matrices: their laws against numpy."""

import math

import numpy as np
import pytest

import cylindroid as cy

rng = np.random.default_rng(17)

# Donelan and Selig, examples 1 and 4, with the linear part first.
J4 = np.array([[0, 0, -2], [-1, 0, 1], [0.5, 0, 0], [1, 0, 0], [0, 0, 0], [0, 1, 1]], dtype=float)
S4 = np.array([1, -0.8, 0.6, 0, 0.6, 0.8])


def form(h):
    Z, E = np.zeros((3, 3)), np.eye(3)
    if math.isinf(h):
        return np.block([[Z, Z], [Z, -E]])
    return np.block([[Z, E / 2], [E / 2, -h * E]])


def hat(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def ad(t):
    return np.block([[hat(t[3:]), hat(t[:3])], [np.zeros((3, 3)), hat(t[3:])]])


def test_forms_are_their_matrices():
    for h in (0.0, 0.4, -2.0, np.inf):
        a, b, f, g = rng.normal(size=(4, 6))
        Q = form(h)
        assert abs(cy.pitch_form(a, b, h) - a @ Q @ b) < 1e-14
        np.testing.assert_allclose(cy.lowered(a, h), Q @ a, atol=1e-15)
        J = rng.normal(size=(6, 4))
        np.testing.assert_allclose(cy.gram(J, h), J.T @ Q @ J, atol=1e-14)
        assert abs(cy.gram_determinant(J, h) - np.linalg.det(J.T @ Q @ J)) < 1e-12
        if math.isfinite(h):
            np.testing.assert_allclose(cy.raised(f, h), np.linalg.inv(Q) @ f, atol=1e-13)
            assert abs(cy.wrench_pitch_form(f, g, h) - f @ np.linalg.inv(Q) @ g) < 1e-13
        assert abs(cy.klein(a, b) - a @ form(0) @ b) < 1e-14
        assert abs(cy.killing(a, b) - np.trace(ad(a) @ ad(b))) < 1e-13
        np.testing.assert_allclose(cy.bracket(a, b), ad(a) @ b, atol=1e-15)
    assert cy.gram(np.zeros((6, 0)), 0.3).shape == (0, 0)
    assert cy.gram_determinant(np.zeros((6, 0)), 0.3) == 1.0


def test_exponential_and_logarithm():
    for _ in range(20):
        x = rng.normal(size=6)
        T = cy.exp(x)
        np.testing.assert_allclose(cy.log(T), x, atol=1e-12)
        matrix = np.zeros((4, 4))
        matrix[:3, :3], matrix[:3, 3] = hat(x[3:]), x[:3]
        series, term = np.eye(4), np.eye(4)
        for k in range(1, 40):
            term = term @ matrix / k
            series = series + term
        np.testing.assert_allclose(T, series, atol=1e-13)
        d = 1e-6 * rng.normal(size=6)
        step = cy.log(cy.exp(x + d) @ np.linalg.inv(T))
        np.testing.assert_allclose(cy.exp_derivative(x) @ d, step, atol=1e-10)
        product = cy.log_derivative(x) @ cy.exp_derivative(x)
        np.testing.assert_allclose(product, np.eye(6), atol=1e-12)
        np.testing.assert_array_equal(cy.velocity_conversion(T), cy.adjoint(T))
    np.testing.assert_array_equal(cy.exp(np.zeros(6)), np.eye(4))


def test_derivatives_of_rotations_and_errors_of_poses():
    for _ in range(20):
        w, d = rng.normal(size=3), 1e-6 * rng.normal(size=3)
        R, near = cy.exp(np.r_[0, 0, 0, w]), cy.exp(np.r_[0, 0, 0, w + d])
        step = cy.log(near @ np.linalg.inv(R))[3:]
        np.testing.assert_allclose(cy.rotation_exp_derivative(w) @ d, step, atol=1e-10)
        product = cy.rotation_log_derivative(w) @ cy.rotation_exp_derivative(w)
        np.testing.assert_allclose(product, np.eye(3), atol=1e-12)
        a, b = cy.exp(rng.normal(size=6)), cy.exp(rng.normal(size=6))
        error = cy.error_to(a, b)
        np.testing.assert_allclose(error[:3], b[:3, 3] - a[:3, 3], atol=1e-14)
        np.testing.assert_allclose(error[3:], cy.screw_to(a, b)[3:], atol=1e-14)
        np.testing.assert_allclose(cy.coadjoint(a), np.linalg.inv(cy.adjoint(a)).T, atol=1e-12)


def test_pencils_and_angles_between_systems():
    two = cy.ScrewSystem(np.array([[0, 0], [0, 0], [0, -0.2], [0, 1], [0, 0], [1, 0]], dtype=float))
    screws = two.pencil(12)
    assert len(screws) == 12 and all(two.contains(s.twist) for s in screws)
    assert max(abs(s.pitch) for s in screws) <= 0.1 + 1e-12
    assert cy.ScrewSystem(J4).pencil(12) == []
    assert cy.ScrewSystem(J4[:, :2]).sine_to_system(cy.ScrewSystem(J4)) < 1e-12
    assert cy.ScrewSystem(J4).sine_to_system(cy.ScrewSystem(J4[:, :2])) > 0.1


def test_transmitted_wrenches():
    mechanism = cy.load("four-bar")
    constraint = mechanism.constraint()
    load = np.array([0.0, -10.0, 0.0])
    torques = constraint.joint_torques(load).torques
    forces = constraint.contact_forces(torques, load).forces
    found = constraint.transmitted_wrenches(forces)
    assert [w.name for w in found] == [j.name for j in mechanism.joints if j.closes_loop]
    assert np.linalg.norm(found[0].wrench[:3]) > 1 and found[0].point.shape == (3,)
    assert found[0].normal is None and found[0].tangential is None
    with pytest.raises(cy.DimensionError):
        constraint.transmitted_wrenches(forces[:-1])
    with pytest.raises(cy.InvalidOptionError, match="matrices"):
        cy.Constraint([[2.0]], G=[[1.0]]).transmitted_wrenches([1.0])


def test_arguments_are_checked():
    one = np.ones(6)
    bad = np.full(6, np.nan)
    for call in (lambda: cy.pitch_form(bad, one, 0.1), lambda: cy.klein(one, bad),
                 lambda: cy.killing(bad, one), lambda: cy.bracket(one, bad),
                 lambda: cy.exp(bad), lambda: cy.pitch_form(one, one, np.nan),
                 lambda: cy.gram(np.full((6, 2), np.inf), 0.1),
                 lambda: cy.gram_determinant(np.ones((6, 1)), np.nan),
                 lambda: cy.raised(one, np.inf), lambda: cy.wrench_pitch_form(bad, one, 0.0)):
        with pytest.raises(cy.NotFiniteError):
            call()
    for call in (lambda: cy.klein(np.ones(5), one), lambda: cy.exp(np.ones(3)),
                 lambda: cy.gram(np.ones((5, 2)), 0.1)):
        with pytest.raises(cy.DimensionError):
            call()
    for call in (lambda: cy.log(2 * np.eye(4)), lambda: cy.velocity_conversion(np.eye(3))):
        with pytest.raises(cy.InvalidOptionError):
            call()


def test_example_4():
    """Phi_h = -9 (80 h^2 + 64 h - 25) / (1600 h), with the 1/2 of Q_h."""
    system = cy.ScrewSystem(J4)
    for h in (1.0, -1.0, 0.3):
        phi = -9 * (80 * h * h + 64 * h - 25) / (1600 * h)
        assert abs(system.error_form(S4, h) - phi) < 1e-13
        assert abs(cy.gram_determinant(J4, h) - h) < 1e-14
        velocities = np.array([-48 * h, -48 * h * h + 160 * h - 45, 48 * h * h - 32 * h - 15])
        found = cy.hyperbolic(J4, h).matrix @ S4
        np.testing.assert_allclose(found, velocities / (160 * h), atol=1e-13)
    zeros = system.error_form_zeros(S4)
    roots = (-8 + np.array([3, -3]) * np.sqrt(21)) / 20
    np.testing.assert_allclose(zeros.pitches, roots, atol=1e-13)
    assert zeros.defined and not zeros.everywhere and "0.287" in repr(zeros)
    assert system.error_form(S4, 0.0) is None
    member = system.error_form_zeros(J4[:, 0])
    assert member.everywhere and member.pitches.size == 0
    planar = cy.ScrewSystem(np.eye(6)[:, [0, 1, 5]])
    assert not planar.error_form_zeros(S4).defined and planar.error_form(S4, 0.2) is None


def test_projector_of_wrenches():
    projector = cy.Projector(J4, 1.0)
    np.testing.assert_allclose(projector.constraint_matrix, np.eye(6) - projector.matrix.T, atol=1e-13)
    wrench = rng.normal(size=6)
    np.testing.assert_allclose(projector.constraint(wrench), projector.constraint_matrix @ wrench,
                               atol=1e-13)
    at_infinity = cy.ScrewSystem(J4).h_reciprocal(np.inf)
    np.testing.assert_allclose(at_infinity.basis.T @ form(np.inf) @ J4, 0, atol=1e-12)


def test_inverse_of_a_mechanism():
    robot = cy.load("youbot")
    q = robot.home + [0.1, 0.4, -0.8, 0.6, 0.2]
    twist = np.array([0.05, 0.02, 0.0, 0.2, 0.1, 0.1])
    J = robot.jacobian(q)
    scale = np.diag([1 / robot.reach] * 3 + [1] * 3)
    found = robot.inverse(q)
    np.testing.assert_allclose(found.matrix, np.linalg.pinv(scale @ J, 1e-3) @ scale, atol=1e-12)
    np.testing.assert_allclose(found.singular_values,
                               np.linalg.svd(scale @ J, compute_uv=False), atol=1e-13)
    bare = robot.inverse(q, "damped", damping=0.1, length=1.0).matrix
    np.testing.assert_allclose(bare, cy.damped(J, 0.1).matrix, atol=1e-13)
    hyperbolic = robot.inverse(q, "hyperbolic", h=0.1, twist=twist)
    np.testing.assert_allclose(hyperbolic.matrix, cy.hyperbolic(J, 0.1).matrix, atol=1e-10)
    assert robot.inverse(q, "hyperbolic", h=0.0).reason.startswith("h is the principal pitch")
    oblique = robot.inverse(q, "oblique", give_up=["ry"], reference="local")
    realised = robot.jacobian(q, reference="local") @ oblique.matrix @ twist - twist
    np.testing.assert_allclose(realised[[0, 1, 2, 3, 5]], 0, atol=1e-10)
    slow = robot.inverse(q, "selectively-damped", twist=twist, max_joint_velocity=0.1)
    assert np.abs(slow.matrix @ twist).max() <= 0.1 + 1e-12
    for bad in ({"method": "hyperbole"}, {"eps": 2.0}, {"length": 0.0}, {"frame": "none"},
                {"damping": 0.1}, {"twist": np.full(6, np.nan)}, {"method": "hyperbolic"}):
        with pytest.raises(cy.CylindroidError):
            robot.inverse(q, **bad)

    chain = cy.load("five-bar")
    inverse = chain.inverse(chain.home, frame=chain.reference)
    assert inverse.matrix.shape == (chain.n, 6) and inverse.rank == 2
    J = chain.jacobian(chain.home, frame=chain.reference)
    P = J @ inverse.matrix
    np.testing.assert_allclose(P @ P, P, atol=1e-10)
    moved = chain.integrate(chain.home, inverse.matrix @ np.eye(6)[:, 0], 1e-4)
    assert chain.constraint(moved).closure_error.distance < 1e-7
