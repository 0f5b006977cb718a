"""Stiffness, internal forces, blocks of motions and inertia from Python, against numpy."""

import numpy as np
import pytest

import cylindroid as cy


def test_stiffness_of_a_platform_is_the_textbook_formula():
    """Gosselin 1990: K = J^T k J, J from twists of the platform to velocities of the legs."""
    m = cy.load("stewart")
    c = m.constraint()
    k = 1e6 * np.arange(1, 7)
    found = m.stiffness(stiffness={f"leg{i + 1}": float(k[i]) for i in range(6)})
    motions = m.mobility().dof_basis
    joints, twists = motions[:6], motions[-6:]
    inverse = joints @ np.linalg.inv(twists)
    order = [c.actuated.index(f"leg{i + 1}") for i in range(6)]
    expected = inverse[order].T @ np.diag(k) @ inverse[order]
    np.testing.assert_allclose(found.matrix, expected, rtol=0, atol=1e-9 * abs(expected).max())
    np.testing.assert_allclose(found.matrix @ found.compliance, np.eye(6), atol=1e-9)
    np.testing.assert_allclose(found.cholesky @ found.cholesky.T, expected, atol=1e-3)
    frame = np.eye(4)
    frame[:3, 3] = m.fk([0.0] * m.n)[:3, 3]
    np.testing.assert_allclose(found.at(frame), found.matrix, rtol=1e-9, atol=1e-3)
    wrench = np.array([10.0, -20, 100, 1, 2, 3])
    bent = found.deflection(wrench)
    np.testing.assert_allclose(bent.twist, np.linalg.solve(expected, wrench), atol=1e-12)
    np.testing.assert_allclose(bent.energy, 0.5 * wrench @ bent.twist, rtol=1e-9)
    # Eigenscrews: eigenvalues of the stiffness with linear and angular parts exchanged.
    swapped = np.roll(np.eye(6), 3, axis=0) @ expected
    values = np.sort(np.linalg.eigvals(swapped).real)[::-1]
    found_values = sorted((x for x, _ in found.eigenscrews), reverse=True)
    np.testing.assert_allclose(found_values, values, rtol=1e-6)
    assert all(np.sign(x) == np.sign(s.pitch) for x, s in found.eigenscrews)


def test_compliance_of_a_serial_arm_is_the_sum_of_its_joints_and_links():
    m = cy.load("panda")
    q = m.home
    J = m.jacobian(q)
    k = np.linspace(1e4, 4e4, m.n)
    link = m.links[3] if hasattr(m, "links") else "panda_link3"
    beam = np.diag([1e-9, 2e-7, 2e-7, 1e-6, 3e-6, 3e-6])
    found = m.stiffness(
        q, stiffness=dict(zip(m.joint_names, k.tolist())), compliance={link: beam}
    )
    pose = m.fk(q, frame=link)
    arm = m.fk(q)[:3, 3] - pose[:3, 3]
    R, x = pose[:3, :3], np.array(
        [[0, -arm[2], arm[1]], [arm[2], 0, -arm[0]], [-arm[1], arm[0], 0]]
    )
    A = np.block([[R, -x @ R], [np.zeros((3, 3)), R]])
    expected = J @ np.diag(1 / k) @ J.T + A @ beam @ A.T
    np.testing.assert_allclose(found.compliance, expected, rtol=0, atol=1e-9 * abs(expected).max())


def test_internal_forces_have_efficiencies():
    """Two arms squeeze a box: the generalised eigenvalues of t^T t over tau^T tau."""
    m = cy.load("two-arm")
    c = m.constraint(m.home)
    found = c.manipulability().internal_force
    A = np.vstack([c.G, c.Jp.T])
    _, s, vt = np.linalg.svd(A)
    t = vt[np.sum(s > 1e-9 * s[0]) :].T
    torque = -c.Ja.T @ t
    values = np.linalg.eigvals(np.linalg.solve(torque.T @ torque, t.T @ t)).real
    np.testing.assert_allclose(found.finite, np.sort(values)[::-1], rtol=1e-6)
    assert found.infinite == 0 and len(found.finite) == m.mobility(m.home).internal
    for direction in found.directions:
        np.testing.assert_allclose(direction.joint, -c.Ja.T @ direction.object, atol=1e-9)
    halved = c.manipulability(Wt=np.full(c.matrix.shape[0], 0.5)).internal_force
    np.testing.assert_allclose(halved.finite, 0.5 * found.finite, rtol=1e-9)


def test_blocks_of_the_motions_add_up():
    for name in ["five-bar", "stewart", "delta", "two-arm"]:
        m = cy.load(name)
        report = m.mobility(m.home)
        counts = {block: basis.shape[1] for block, basis in report.blocks.items()}
        assert sum(counts.values()) == report.dof + report.coordinate_overlap
        assert counts["idle"] == report.idle
        matrix = m.constraint(m.home).matrix
        for basis in report.blocks.values():
            np.testing.assert_allclose(matrix @ basis, 0, atol=1e-9)
        np.testing.assert_allclose(
            m.constraint(m.home).G @ report.internal_forces_basis, 0, atol=1e-9
        )


def test_inertia_is_a_metric_of_joint_velocities(robot_files):
    """One option and the matrix of its own give the same, and so does the formula by numpy."""
    m = cy.load(str(robot_files / "ur_description/urdf/ur5_robot.urdf"))
    q = np.array([0.3, -1.1, 1.4, 0.2, 1.0, 0.4])
    M = m.mass_matrix(q)
    np.testing.assert_allclose(M, M.T)
    np.testing.assert_allclose(m.actuated_inertia(q), M, atol=1e-12)
    assert m.mass_matrix(np.stack([q, 0 * q])).shape == (2, m.n, m.n)
    found = m.manipulability(q, Wq="inertia").kinematic.finite
    np.testing.assert_allclose(found, m.manipulability(q, Wq=M).kinematic.finite, rtol=1e-9)
    J = m.jacobian(q)
    expected = np.sort(np.linalg.eigvals(J @ np.linalg.solve(M, J.T)).real)[::-1]
    np.testing.assert_allclose(found, expected, rtol=1e-6)
    with pytest.raises(cy.ModelError, match="without mass"):
        cy.load("ur5e").manipulability(Wq="inertia")
    with pytest.raises(cy.UnknownNameError):
        m.manipulability(q, Wq="mass")


def test_inertia_weighted_hyperbolic_inverse(robot_files):
    """Four joints: of all joint velocities with the projected twist, those of least energy."""
    m = cy.load(str(robot_files / "ur_description/urdf/ur5_robot.urdf"))
    q = np.array([0.3, -1.1, 1.4, 0.2, 1.0, 0.4])
    M, J = m.mass_matrix(q), m.jacobian(q, reference="world")
    inverse = cy.hyperbolic(J, 0.1, joint_metric=M)
    assert inverse.exists
    np.testing.assert_allclose(inverse.matrix @ J, np.eye(m.n), atol=1e-7)
    redundant = np.hstack([J[:, :4], J[:, :1] + J[:, 1:2]])
    W = np.eye(5) + np.ones((5, 5))
    inverse = cy.hyperbolic(redundant, 0.1, joint_metric=W)
    if inverse.exists:
        null = np.array([1, 1, 0, 0, -1.0])
        np.testing.assert_allclose(null @ W @ inverse.matrix, 0, atol=1e-8)
