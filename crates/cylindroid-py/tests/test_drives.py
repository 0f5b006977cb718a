"""Parallel robots that measure their drives alone."""

import numpy as np
import pytest

import cylindroid as cy


def test_parallel_robots_are_driven_from_their_actuated_joints():
    stewart = cy.load("stewart")
    legs = [i for i, name in enumerate(stewart.joint_names) if name.startswith("leg")]
    servo = cy.Servo(stewart, dt=0.002, acceleration=5.0)
    servo.start_from(stewart.home)
    target = stewart.fk(stewart.home, servo.frame)
    target[:3, 3] += [0.02, -0.01, 0.03]
    measured = stewart.home[legs].copy()
    noise = np.random.default_rng(0)
    for _ in range(2000):
        velocities = servo.step_actuated(measured + 1e-6 * noise.standard_normal(6), target)
        measured += 0.002 * velocities[legs]
    here = stewart.fk(servo.configuration, servo.frame)
    assert np.linalg.norm(here[:3, 3] - target[:3, 3]) < 1e-4
    with pytest.raises(cy.DimensionError, match="actuated"):
        servo.step_actuated(measured[:3], target)
    assert servo.closure_error.distance < 1e-9 and servo.closure_error.angle < 1e-9
    assert cy.Servo(cy.load("panda")).closure_error is None
    with pytest.raises(cy.InvalidOptionError, match="actuated positions = 'leg.*loops open by"):
        servo.step_actuated(measured + [0.9, -0.9, 0.9, -0.9, 0.9, -0.9], target)


def test_drives_follow_twists():
    stewart = cy.load("stewart")
    legs = [i for i, name in enumerate(stewart.joint_names) if name in stewart.actuated]
    servo = cy.Servo(stewart, dt=0.002, acceleration=5.0, command_timeout=0.02)
    twist = np.array([0.02, -0.01, 0.03, 0.0, 0.0, 0.1])
    measured = stewart.home[legs].copy()
    for _ in range(200):
        velocities = servo.step_twist_actuated(measured, twist)
        measured += 0.002 * velocities[legs]
    assert servo.status == "following" and not servo.timed_out
    np.testing.assert_allclose(servo.achieved_twist, twist, atol=1e-6)
    for _ in range(200):
        velocities = servo.step_twist_actuated(measured)
        measured += 0.002 * velocities[legs]
    assert servo.status == "at-rest" and servo.timed_out
    name = stewart.joint_names[legs[0]]
    with pytest.raises(cy.InvalidOptionError, match="sensors"):
        servo.step_twist_actuated(measured, twist, sensors={name: 0.0})
    with pytest.raises(cy.UnknownNameError, match="elbow"):
        servo.step_twist_actuated(measured, twist, sensors={"elbow": 0.0})
    with pytest.raises(cy.DimensionError, match="actuated"):
        servo.step_twist_actuated(measured[:3], twist)
    with pytest.raises(cy.InvalidOptionError, match="actuated positions = 'leg.*loops open by"):
        servo.step_twist_actuated(measured + [0.9, -0.9, 0.9, -0.9, 0.9, -0.9], twist)
    # A step towards a target ends velocity mode.
    servo.step_actuated(measured, stewart.fk(servo.configuration, servo.frame))
    assert servo.status in ("moving", "reached") and servo.achieved_twist is None


def test_passive_joints_that_are_measured_too_count():
    five_bar = cy.load("five-bar")
    q = five_bar.home.copy()
    servo = cy.Servo(five_bar, dt=0.002, acceleration=5.0)
    servo.start_from(q)
    actuated = [i for i, name in enumerate(five_bar.joint_names) if name in five_bar.actuated]
    passive = [name for name in five_bar.joint_names if name not in five_bar.actuated]
    target = five_bar.fk(q, servo.frame)
    servo.step_actuated(q[actuated], target)
    alone = servo.configuration
    place = five_bar.joint_names.index(passive[0])
    servo.step_actuated(q[actuated], target, sensors={passive[0]: q[place] + 1e-3})
    assert 1e-5 < servo.configuration[place] - alone[place] < 1e-3
    with pytest.raises(cy.UnknownNameError, match=passive[0]):
        servo.step_actuated(q[actuated], target, sensors={passive[0] + "x": 0.0})
    driven = five_bar.joint_names[actuated[0]]
    with pytest.raises(cy.InvalidOptionError, match=f"sensors = '{driven}'.* it is actuated"):
        servo.step_actuated(q[actuated], target, sensors={driven: 0.0})
