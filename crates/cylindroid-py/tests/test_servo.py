"""The servo, motions and time laws from Python."""

import numpy as np
import pytest

import cylindroid as cy


def angle_between(A, B):
    return np.arccos(np.clip((np.trace(A[:3, :3].T @ B[:3, :3]) - 1) / 2, -1, 1))


def lowered(robot, by=0.1):
    target = robot.fk(robot.home)
    target[2, 3] -= by
    return target


@pytest.mark.parametrize("name", ["panda", "ur5e"])
@pytest.mark.parametrize("inverse", ["truncated", "damped", "singular-value-filtering"])
def test_a_loop_reaches(name, inverse):
    r = cy.load(name)
    q = r.home + 0.05
    c = cy.Servo(r, gain=10.0, dt=0.002, inverse=inverse, tolerance_position=1e-5,
                 tolerance_orientation=1e-5)
    assert c.status is None and c.stall is None and np.isnan(c.position_error)
    target = lowered(r)
    for _ in range(20000):
        qd = c.step(q, target)
        assert qd.shape == (r.n,) and (np.abs(qd) <= r.velocity_limit * (1 + 1e-12)).all()
        np.testing.assert_array_equal(qd, c.joint_velocities)
        if c.status != "moving":
            break
        q = c.advance(q)
    assert c.status == "reached" and c.stall is None
    T = r.fk(q)
    np.testing.assert_allclose(c.pose, T, atol=1e-14)
    assert np.linalg.norm(T[:3, 3] - target[:3, 3]) <= 1e-5
    assert abs(c.position_error - np.linalg.norm(T[:3, 3] - target[:3, 3])) < 1e-12
    assert angle_between(T, target) <= 1.1e-5
    assert 0 < c.singular_ratio < 1 and c.rank == 6 and c.scale == 1.0 and c.lag == 0


def test_drive_does_the_same_as_steps():
    r = cy.load("panda")
    c = cy.Servo(r)
    target = lowered(r)
    outcome = c.simulate(r.home, target, record=True)
    assert outcome.reached and outcome.reason == "reached" and outcome.stall is None
    way = outcome.trajectory
    assert len(way) == outcome.steps + 1 == len(way.time)
    assert way.q.shape == way.joint_velocities.shape == (len(way), 7) and way.pose.shape == (len(way), 4, 4)
    np.testing.assert_array_equal(way.q[-1], outcome.q)
    np.testing.assert_allclose(way.pose, r.fk(way.q), atol=1e-14)
    assert way.position_error[-1] == outcome.position_error <= 1e-6
    q, again = r.home, cy.Servo(r)
    for i in range(len(way)):
        np.testing.assert_array_equal(again.step(q, target), way.joint_velocities[i])
        q = again.advance(q)
    assert "reached" in repr(outcome) and "<table>" in outcome._repr_html_()
    assert c.simulate(r.home, target).trajectory is None


def test_stalls_say_why():
    r = cy.load("panda")
    far = lowered(r)
    far[0, 3] = 3.0
    c = cy.Servo(r)
    outcome = c.simulate(r.home, far)
    assert not outcome.reached and outcome.reason == "out-of-reach"
    assert outcome.stall.distance > outcome.stall.length > 0.5
    assert "stretched arm" in outcome.stall.message and "out-of-reach" in repr(outcome.stall)
    assert c.status == "stalled" and c.stall.name == "out-of-reach"
    three = cy.load("3r")
    target = three.fk(three.home + 0.3)
    target[:3, :3] = target[:3, :3] @ [[1, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]]
    outcome = cy.Servo(three).simulate(three.home + 0.3, target)
    assert outcome.reason == "too-few-joints" and not outcome.reached
    assert abs(np.linalg.norm(outcome.stall.direction) - 1) < 1e-12
    wiper = cy.parse(
        """<robot name="wiper"><link name="a"/><link name="b"/><link name="c"/>
        <joint name="j1" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
        <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
        <joint name="j2" type="fixed"><parent link="b"/><child link="c"/><origin xyz="1 0 0"/></joint>
        </robot>"""
    )
    beyond = np.eye(4)
    beyond[:2, 3] = np.cos(1.5), np.sin(1.5)
    outcome = cy.Servo(wiper, task="position").simulate([0.9], beyond)
    assert outcome.reason == "limits" and outcome.stall.joints == ["j1"] and abs(outcome.q - 1.0) < 1e-12
    assert "limit of j1" in outcome.stall.message and ("j1", "position") in outcome.limits_hit


def test_options_are_the_command_lines():
    r = cy.load("panda")
    c = cy.Servo(r, "link5", (5.0, 2.0), dt=0.01, speed=(0.1, 0.5), task="position")
    assert c.frame == "link5" and c.dt == 0.01
    T = r.fk(r.home, "link5")
    T[2, 3] += 0.3
    q, speeds = r.home, []
    for _ in range(50):
        rates = c.step(q, T)
        speeds.append(np.linalg.norm(r.jacobian(q, "link5")[:3] @ rates))
        q = c.advance(q)
    assert abs(max(speeds) - 0.1) < 1e-9
    assert c.orientation_error == 0.0
    ur = cy.load("ur5e")
    assert np.isinf(ur.acceleration_limit).all()
    slow = cy.Servo(ur, acceleration=1.0, dt=0.001)
    assert np.abs(slow.step(ur.home, lowered(ur))).max() <= 1e-3 * (1 + 1e-12)
    assert "acceleration" in {kind for _, kind in slow.active_limits}
    limits = {name: {"velocity": 0.1, "acceleration": 2.0} for name in ur.joint_names}
    limited = cy.Servo(ur, limits=limits, dt=0.001)
    assert np.abs(limited.step(ur.home, lowered(ur))).max() <= 2e-3 * (1 + 1e-12)
    with pytest.raises(cy.UnknownNameError, match="nearest: wrist_1_joint"):
        cy.Servo(ur, limits={"wrist_1": {"velocity": 1.0}})
    offset = np.eye(4)
    offset[2, 3] = 0.2
    tool = cy.Servo(r, tool=offset)
    tool.step(r.home, r.fk(r.home, tool=offset))
    assert tool.status == "reached"


def test_secondary_tasks_do_not_disturb_the_task():
    r = cy.load("panda")
    q = r.home + 0.2
    target, J = r.fk(q), r.jacobian(q)
    for options in (
        {"secondary": "manipulability"},
        {"secondary": ["centring", "limit-avoidance"]},
        {"secondary": {"posture": 2.0}, "posture": q + 0.3},
    ):
        rates = cy.Servo(r, **options).step(q, target)
        assert np.linalg.norm(rates) > 1e-6
        np.testing.assert_allclose(J @ rates, 0, atol=1e-12)
    velocities = np.ones(7)
    rates = cy.Servo(r, secondary="none").step(q, target, velocities)
    assert np.linalg.norm(rates) > 0.01
    np.testing.assert_allclose(J @ rates, 0, atol=1e-12)
    # Trees and chains have kernels of their own: a rounding of the pose, times the gain, over the
    # smallest singular value.
    np.testing.assert_allclose(cy.Servo(r, secondary="none").step(q, target), 0, atol=1e-13)


def test_hyperbolic_servo_of_five_joints():
    r = cy.load("youbot")
    q = r.home + 0.3
    J = r.jacobian(q, reference="local_world_aligned")
    twist = np.array([1, 2, -1, 3, 1, 2]) * 1e-3
    c = cy.Servo(r, inverse="hyperbolic", h=0.1, secondary="none", acceleration=np.inf)
    rates = c.step(q, r.fk(q), feed_forward=twist)
    np.testing.assert_allclose(rates, cy.hyperbolic(J, 0.1).matrix @ twist, atol=1e-10)
    assert c.no_inverse is None
    given_up = cy.Servo(r, inverse="oblique", give_up=["rx"], secondary="none")
    given_up.step(q, r.fk(q), feed_forward=twist)
    assert given_up.no_inverse is None
    same = cy.Servo(r, inverse="oblique", give_up=[[0, 0, 0, 1, 0, 0]], secondary="none")
    same.step(q, r.fk(q), feed_forward=twist)
    np.testing.assert_array_equal(same.joint_velocities, given_up.joint_velocities)


def test_closed_chains_are_controlled():
    r = cy.load("five-bar")
    start = r.assemble().q
    target = r.fk(start, r.reference)
    target[:2, 3] += [0.05, -0.05]
    c = cy.Servo(r, task="position")
    outcome = c.simulate(start, target)
    assert outcome.reached, outcome
    assert r.constraint(outcome.q).closure_error.distance < 1e-9
    np.testing.assert_allclose(r.fk(outcome.q, r.reference)[:2, 3], target[:2, 3], atol=1e-6)


def test_a_way_round():
    r = cy.load("panda")
    c = cy.Servo(r)
    rng = np.random.default_rng(3)
    for _ in range(3):
        target = r.fk(rng.uniform(r.lower, r.upper))
        q = c.find_reachable_configuration(r.home, target)
        np.testing.assert_allclose(r.fk(q), target, atol=3e-6)
        assert r.outside_limits(q) == []
        move = cy.JointMove(r, r.home, q)
        positions, rates = move.at(np.linspace(-1, move.duration + 1, 50))
        np.testing.assert_array_equal(positions[0], r.home)
        np.testing.assert_allclose(positions[-1], q, atol=1e-14)
        assert (np.abs(rates) <= r.velocity_limit * (1 + 1e-9)).all()
    far = np.eye(4)
    far[0, 3] = 5
    assert c.find_reachable_configuration(r.home, far, max_restarts=3) is None


def test_paths_and_moves():
    r = cy.load("panda")
    start, end = r.fk(r.home), lowered(r)
    end[:3, 3] += [0.05, 0.1, 0]
    line = cy.CartesianPath.line(start, end)
    assert abs(line.length - np.linalg.norm(end[:3, 3] - start[:3, 3])) < 1e-15
    assert line.radius == np.inf and line.angle < 1e-7
    np.testing.assert_allclose(line.pose([0, 1, 2]), [start, end, end], atol=1e-15)
    assert line.deviation(start)[0] < 1e-15
    move = cy.CartesianMove(line, speed=0.1, jerk=(10.0, 40.0))
    slow = cy.CartesianMove(line, speed=0.1, duration=9.0)
    assert move.duration < 9.0 == slow.duration
    poses, twists = move.at(np.linspace(0, move.duration, 101))
    assert poses.shape == (101, 4, 4) and twists.shape == (101, 6)
    assert np.linalg.norm(twists[:, :3], axis=1).max() <= 0.1 + 1e-12
    outcome = cy.Servo(r).simulate(r.home, move, record=True)
    assert outcome.reached and outcome.time >= move.duration - 1e-3
    off = max(line.deviation(T)[0] for T in outcome.trajectory.pose)
    assert off < 1e-5
    way = np.array([start, end, end, end])
    way[2, :3, 3] += [0, 0, 0.1]
    way[3, :3, 3] += [0.1, 0, 0.1]
    through = cy.WaypointMove(way, speed=0.1)
    outcome = cy.Servo(r).simulate(r.home, through, record=True)
    assert outcome.reached and outcome.time >= through.duration - 1e-3
    off = [np.linalg.norm(outcome.trajectory.pose[:, :3, 3] - T[:3, 3], axis=1).min() for T in way]
    assert max(off) <= through.largest_deviation + 1e-4
    timed = cy.WaypointMove(way, times=[0, 3, 5, 7])
    assert abs(timed.duration - 7) < 1e-12 and timed.at(3.0)[1].shape == (6,)
    with pytest.raises(cy.InvalidOptionError, match="5 s to 5.01 s"):
        cy.WaypointMove(way, times=[0, 3, 5, 5.01])
    with pytest.raises(cy.InvalidOptionError, match="speeds follow from them"):
        cy.WaypointMove(way, times=[0, 3, 5, 7], speed=0.1)
    with pytest.raises(cy.InvalidOptionError, match="speeds follow from them"):
        cy.WaypointMove(way, times=[0, 3, 5, 7], speeds=[0.1, 0.1, 0.1])
    # One speed for each segment; the bound of all counts only if it is given.
    same = cy.WaypointMove(way, speeds=[0.1, 0.1, 0.1])
    assert abs(same.duration - through.duration) < 1e-12
    fast, slow = (cy.WaypointMove(way, speeds=[0.4, v, 0.4]).duration for v in (0.4, 0.02))
    assert slow > fast + 2
    bounded = cy.WaypointMove(way, speeds=[0.4, 0.4, 0.4], speed=0.1)
    assert abs(bounded.duration - through.duration) < 1e-12
    with pytest.raises(cy.DimensionError, match="speeds of the waypoints"):
        cy.WaypointMove(way, speeds=[0.1, 0.1])
    with pytest.raises(cy.InvalidOptionError, match="0 m/s from waypoint 1 to 2"):
        cy.WaypointMove(way, speeds=[0.1, 0, 0.1])
    assert np.isfinite(cy.WaypointMove(way, times=[0, 1e300, 2e300, 3e300]).duration)
    free = cy.WaypointMove(way, speed=np.inf).duration
    assert abs(free / cy.WaypointMove(way, speed=1e300).duration - 1) < 0.2
    for moving in (through, move):
        with pytest.raises(cy.InvalidOptionError, match="dt"):
            moving.target(0, 0)
        with pytest.raises(cy.NotFiniteError, match="t is not finite"):
            moving.target(np.nan, 0.001)
    with pytest.raises(cy.InvalidOptionError, match="poses"):
        cy.WaypointMove(way[0])
    turn = cy.CartesianPath.rotation(start, start[:3, 3] + [0, 0, 0.1], [1, 0, 0], np.pi)
    assert abs(turn.length - 0.1 * np.pi) < 1e-12 and abs(turn.radius - 0.1) < 1e-12
    circle = cy.CartesianPath.circle(start, start[:3, 3] + [0.1, 0.1, 0], end)
    assert circle.length > line.length
    pose, twist = move.target(0.5, 0.001)
    assert pose.shape == (4, 4) and twist.shape == (6,)


@pytest.mark.parametrize("times", [np.nan, [0.0, np.nan, 0.2]])
def test_a_time_that_is_no_number_is_refused(times):
    r = cy.load("panda")
    line = cy.CartesianPath.line(r.fk(r.home), lowered(r))
    for at in (
        line.pose,
        cy.CartesianMove(line).at,
        cy.JointMove(r, r.home, r.home + 0.1).at,
        cy.TimeLaw(3.0, 1.0, 2.0).at,
    ):
        with pytest.raises(cy.NotFiniteError, match=r"\b[ts]\b"):
            at(times)
        assert np.isfinite(at([-np.inf, np.inf])[0]).all()


def test_time_law():
    law = cy.TimeLaw(3.0, 1.0, 2.0)
    t = np.linspace(-1, 5, 601)
    s = law.at(t)
    assert s.shape == (601, 4) and law.duration == 3.5 and law.distance == 3.0
    np.testing.assert_allclose(np.gradient(s[:, 0], t)[5:-5], s[5:-5, 1], atol=0.02)
    assert s[0, 0] == 0 and s[-1, 0] == 3.0 and np.abs(s[:, 1]).max() <= 1.0


@pytest.mark.parametrize(
    ("options", "kind", "words"),
    [
        ({"gain": 3000.0}, cy.InvalidOptionError, "gain"),
        ({"gain": [1, 2, 3]}, cy.InvalidOptionError, "one number"),
        ({"dt": 0.0}, cy.InvalidOptionError, "dt"),
        ({"inverse": "damp"}, cy.UnknownNameError, "damped"),
        ({"damping": 0.1}, cy.InvalidOptionError, "eps"),
        ({"inverse": "hyperbolic"}, cy.InvalidOptionError, "needs this parameter"),
        ({"h": 0.1}, cy.InvalidOptionError, "hyperbolic"),
        ({"dampnig": 0.1}, TypeError, "unexpected keyword argument 'dampnig'"),
        ({"fallback": "truncated"}, cy.InvalidOptionError, "always exists"),
        ({"secondary": "posing"}, cy.UnknownNameError, "posture"),
        ({"null_space": "null"}, cy.UnknownNameError, "exact"),
        ({"task": "x,w"}, cy.UnknownNameError, "task"),
        ({"task_axes": "tool"}, cy.UnknownNameError, "reference"),
        ({"frame": "hand"}, cy.UnknownNameError, "frame"),
        ({"frame": "base"}, cy.ModelError, "no joint moves"),
        ({"joint_weights": [1, 2]}, cy.DimensionError, "joint weights"),
        ({"posture": [1, 2], "secondary": "posture"}, cy.DimensionError, "posture"),
        ({"length": -1}, cy.InvalidOptionError, "length"),
    ],
)
def test_options_are_checked(options, kind, words):
    with pytest.raises(kind, match=words):
        cy.Servo(cy.load("panda"), **options)


def test_input_is_checked():
    r = cy.load("panda")
    c = cy.Servo(r)
    T = r.fk(r.home)
    c.step(r.home, T)
    before = c.joint_velocities
    for q, target, kind in [
        (r.home[:3], T, cy.DimensionError),
        (r.home * np.nan, T, cy.NotFiniteError),
        (r.home, T * np.nan, cy.NotFiniteError),
        (r.home, T[:3], cy.InvalidOptionError),
        (r.home, T.T + 1, cy.InvalidOptionError),
        ([r.home], T, cy.InvalidOptionError),
    ]:
        with pytest.raises(kind):
            c.step(q, target)
        np.testing.assert_array_equal(c.joint_velocities, before)
    with pytest.raises(cy.DimensionError, match="secondary"):
        c.step(r.home, T, [1.0])
    with pytest.raises(cy.InvalidOptionError, match="duration"):
        c.simulate(r.home, T, duration=np.nan)
    with pytest.raises(TypeError):
        c.simulate(r.home, "there")
    with pytest.raises(TypeError):
        cy.Servo("panda")


def test_secondary_tasks_are_documented():
    """What the table of tasks lists is in the docstring and is taken by name."""
    robot = cy.load("panda")
    target = robot.fk(robot.home)
    for task in cy.secondary_tasks():
        name, rows = task["name"], task["parameters"]
        assert task["description"] and f"'{name}'" in cy.Servo.__doc__
        values = {row["name"]: row["default"] for row in rows}
        assert all(f"- {row['name']} [{row['unit']}]" in cy.Servo.__doc__ for row in rows)
        q = robot.home + 0.05
        steps = [cy.Servo(robot, secondary=s).step(q, target) for s in (name, [name], {name: values})]
        assert (steps[0] == steps[1]).all() and (steps[0] == steps[2]).all()
    with pytest.raises(cy.UnknownNameError, match="margin"):
        cy.Servo(robot, secondary={"limit-avoidance": {"margn": 0.2}})
    with pytest.raises(TypeError, match="dict of parameters"):
        cy.Servo(robot, secondary={"limit-avoidance": "fast"})


def test_velocities_of_actuated_loop_joints_are_those_between_their_links():
    robot = cy.load("five-bar").with_actuated(["q1", "q5"])
    servo = cy.Servo(robot)
    target = robot.fk(robot.home, frame=robot.reference)
    target[:2, 3] += [0.05, -0.02]
    qd = servo.step(robot.home, target)
    joint = robot.joints[-1]
    parent, child = (robot.jacobian(robot.home, frame=link)[5] @ qd for link in (joint.parent, joint.child))
    assert joint.closes_loop and abs(child - parent) > 0.01
    np.testing.assert_allclose(servo.loop_closure_velocities, [child - parent], rtol=1e-9)
    assert cy.Servo(cy.load("panda")).loop_closure_velocities.shape == (0,)


def test_a_servo_in_use_by_another_thread_is_an_error():
    import threading

    robot = cy.load("panda")
    servo = cy.Servo(robot, dt=1e-5, tolerance_position=1e-300)
    target = robot.fk(robot.home + 0.2)
    thread = threading.Thread(target=lambda: servo.simulate(robot.home, target, duration=3.0))
    thread.start()
    refused = 0
    while thread.is_alive():
        try:
            servo.status
        except cy.InUseError as error:
            assert isinstance(error, RuntimeError) and "another thread" in str(error)
            refused += 1
    thread.join()
    assert refused > 0
    assert servo.status is not None


def test_a_twist_is_followed_until_the_commands_cease():
    r = cy.load("panda")
    c = cy.Servo(r, dt=0.002, command_timeout=0.02)
    q, twist = r.home, np.array([0.0, 0.05, -0.1, 0.0, 0.0, 0.2])
    assert c.achieved_twist is None and not c.timed_out
    for _ in range(200):
        c.step_twist(q, twist)
        q = c.advance(q)
    assert c.status == "following" and c.stall is None
    np.testing.assert_allclose(c.achieved_twist, twist, atol=1e-9)
    for step in range(200):
        rates = c.step_twist(q)
        assert c.timed_out == (step >= 10)
        q = c.advance(q)
    assert c.status == "at-rest" and not rates.any()
    with pytest.raises(cy.NotFiniteError, match="twist"):
        c.step_twist(q, twist * np.nan)
    # Pushed outwards, it stalls and says why.
    ur, out = cy.load("ur5e"), np.zeros(6)
    q = np.array([0.0, -1.0, 1.2, -0.4, 1.3, 0.2])
    out[:3] = 0.4 * ur.fk(q)[:3, 3]
    c = cy.Servo(ur, dt=0.002)
    for _ in range(4000):
        c.step_twist(q, out)
        q = c.advance(q)
    assert c.status == "stalled" and c.stall.name == "singular"


def test_a_servo_that_lags_keeps_limits():
    panda = cy.load("panda")
    target = panda.fk(panda.home)
    target[:3, 3] += [0.0, 0.2, -0.6]
    beyond = {}
    for known in (0.0, 0.06):
        servo = cy.Servo(panda, dt=0.002, acceleration=10, time_constant=known)
        q, v, worst = panda.home, np.zeros(7), 0.0
        for _ in range(2000):
            u = servo.step(q, target)
            before, v = v, u + np.exp(-0.002 / 0.06) * (v - u)
            q = q + 0.002 * u + 0.06 * (before - v)
            worst = max(worst, (q - panda.upper).max(), (panda.lower - q).max())
        beyond[known] = worst
    assert beyond[0.0] > 0.01 and beyond[0.06] < 1e-9, beyond
    with pytest.raises(cy.InvalidOptionError, match="delay"):
        cy.Servo(panda, delay=-1.0)
    many = cy.TaskServo(panda, [cy.FrameTask("hand_tcp", target)], delay=0.02, noise=1e-4)
    many.step(panda.home)


def test_encoder_noise_does_not_stop_a_closed_chain():
    five_bar = cy.load("five-bar")
    servo = cy.Servo(five_bar, task="position", dt=0.002, acceleration=5.0, tolerance_position=1e-3)
    goal = five_bar.fk(five_bar.home, servo.frame)
    goal[0, 3] += 0.2
    q, noise = five_bar.home.copy(), np.random.default_rng(0)
    for _ in range(1500):
        servo.step(q + 1e-4 * noise.standard_normal(five_bar.n), goal)
        q = servo.advance(q)
    assert np.linalg.norm(five_bar.fk(q, servo.frame)[:3, 3] - goal[:3, 3]) < 1e-3


def test_limits_of_the_jerk():
    panda = cy.load("panda").with_limits({"panda_joint2": {"jerk": 80.0}})
    assert panda.jerk_limit[1] == 80.0 and np.isinf(panda.jerk_limit[0])
    goal = panda.fk(panda.home)
    goal[:3, 3] += [0.1, 0.15, -0.1]
    task = cy.FrameTask("hand_tcp", goal)
    dt, most = 0.002, np.full(7, 120.0)
    most[1] = 80.0
    for servo in cy.Servo(panda, dt=dt, jerk=120.0), cy.TaskServo(panda, [task], dt=dt, jerk=120.0):
        q, velocities = panda.home, [np.zeros(7), np.zeros(7)]
        for _ in range(2000):
            step = servo.step(q, goal) if isinstance(servo, cy.Servo) else servo.step(q)
            velocities.append(np.array(step))
            q = servo.advance(q)
        jerks = np.abs(np.diff(velocities, 2, axis=0)).max(axis=0) / dt**2
        assert (jerks <= most * (1 + 1e-6)).all() and (jerks > 0.5 * most).any(), jerks
        assert np.linalg.norm(panda.fk(q)[:3, 3] - goal[:3, 3]) < 1e-5
    with pytest.raises(cy.InvalidOptionError, match="jerk"):
        cy.Servo(panda, jerk=0.0)
    with pytest.raises(cy.InvalidOptionError, match="jerk"):
        panda.with_limits({"panda_joint2": {"jerk": 0.0}})
