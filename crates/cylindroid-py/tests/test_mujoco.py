"""Two arms in MuJoCo under the servo at 500 Hz: targets reached, limits kept, stalls reported."""

import numpy as np
import physics
import pytest

import cylindroid as cy

ARMS = {
    "panda": (
        "panda_description/urdf/panda.urdf",
        "panda_link8",
        ("panda_finger_joint1", "panda_finger_joint2"),
    ),
    "ur5": ("ur_description/urdf/ur5_robot.urdf", "ee_link", ()),
}
TARGETS = 50
POSITION, ORIENTATION = 1e-3, np.radians(0.5)


def arm_of(name, robot_files):
    file, frame, locked = ARMS[name]
    arm = physics.Arm(robot_files / file, frame, locked)
    arm.start(arm.robot.home)
    servo = cy.Servo(
        arm.robot,
        frame,
        dt=physics.PERIOD,
        acceleration=4.0,
        tolerance_position=0.2 * POSITION,
        tolerance_orientation=0.2 * ORIENTATION,
    )
    return arm, servo, frame


def follow(arm, servo, target, duration=20.0):
    """Runs the servo until it reports the end."""
    for _ in range(int(duration / physics.PERIOD)):
        rates = servo.step(arm.q, target)
        arm.run(rates)
        if servo.status != "moving":
            break
    return servo.status


def stop(arm, servo):
    """Brakes at the acceleration that the servo counts on."""
    rates = servo.joint_velocities
    while np.abs(rates).max() > 0:
        change = 4.0 * physics.PERIOD
        rates = rates - np.clip(rates, -change, change)
        arm.run(rates)
    for _ in range(50):
        arm.run(0 * rates)


def go_round(arm, servo, target):
    """Through joint space to another configuration that reaches the target."""
    stop(arm, servo)
    configuration = servo.find_reachable_configuration(arm.q, target)
    assert configuration is not None
    start = np.clip(arm.q, arm.robot.lower, arm.robot.upper)
    move = cy.JointMove(arm.robot, start, configuration, acceleration=4.0)
    for i in range(int(move.duration / physics.PERIOD) + 100):
        q, qd = move.at(i * physics.PERIOD)
        arm.run(qd + 10 * (q - arm.q))
    servo.reset()
    return follow(arm, servo, target)


def errors(arm, target):
    pose = arm.pose
    turn = pose[:3, :3].T @ target[:3, :3]
    angle = np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1))
    return np.linalg.norm(pose[:3, 3] - target[:3, 3]), angle


@pytest.mark.parametrize("name", ARMS)
def test_random_targets_are_reached(name, robot_files, report):
    arm, servo, frame = arm_of(name, robot_files)
    rng = np.random.default_rng(2026)
    rounds, worst = 0, np.zeros(2)
    for _ in range(TARGETS):
        target = arm.robot.fk(rng.uniform(arm.robot.lower, arm.robot.upper), frame)
        if follow(arm, servo, target) != "reached":
            rounds += 1
            assert go_round(arm, servo, target) == "reached", servo.stall
        found = errors(arm, target)
        assert found[0] < POSITION and found[1] < ORIENTATION
        worst = np.maximum(worst, found)
        assert np.isfinite(arm.q).all()
    assert arm.beyond < 0, f"a joint went {arm.beyond} rad beyond its limit"
    report(
        f"{name} in MuJoCo: {TARGETS} targets, {rounds} through joint space; worst {worst[0]:.1e} m, "
        f"{np.degrees(worst[1]):.3f} deg; {-arm.beyond:.4f} rad from the nearest limit"
    )


@pytest.mark.parametrize("name", ARMS)
def test_a_target_out_of_reach_ends_in_a_report(name, robot_files):
    arm, servo, frame = arm_of(name, robot_files)
    target = arm.robot.fk(arm.robot.home, frame)
    target[:3, 3] = 3.0, 0.5, 0.8
    assert follow(arm, servo, target) == "stalled"
    assert servo.stall.name == "out-of-reach" and servo.stall.distance > servo.stall.length
    stop(arm, servo)
    here = arm.pose
    for _ in range(500):
        arm.run(np.zeros(arm.size))
    np.testing.assert_allclose(arm.pose, here, atol=1e-6)
    assert arm.beyond < 0


@pytest.mark.parametrize("name", ARMS)
def test_an_inverse_that_bounds_rates_does_not_oscillate_out_of_reach(name, robot_files):
    """Also after the report, for a caller who goes on: the tool creeps one way."""
    arm, _, frame = arm_of(name, robot_files)
    servo = cy.Servo(
        arm.robot,
        frame,
        dt=physics.PERIOD,
        acceleration=4.0,
        speed=(0.25, 1.0),
        inverse="selectively-damped",
    )
    target = arm.robot.fk(arm.robot.home, frame)
    target[:3, 3] = 3.0, 0.5, 0.8
    assert follow(arm, servo, target) == "stalled" and servo.stall.name == "out-of-reach"
    way = []
    for _ in range(1000):
        arm.run(servo.step(arm.q, target))
        way.append(arm.pose[:3, 3])
    path = np.linalg.norm(np.diff(way, axis=0), axis=1).sum()
    assert path < 1.05 * np.linalg.norm(way[-1] - way[0]) + 1e-4
    assert servo.status == "stalled" and np.abs(arm.data.qvel).max() < 0.1
    assert arm.beyond < 0
