"""Many tasks: two arms, relative poses, gaze, posture, avoidance, functions of Python, errors."""

import threading

import numpy as np
import pytest

import cylindroid as cy

SHAPES = """<inertial><origin xyz="0.05 0 0"/><mass value="2"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><origin xyz="0.06 0 0"/><geometry><sphere radius="0.04"/></geometry></collision>"""


def urdf():
    """A torso with two arms of seven joints and a head."""
    parts = ['<robot name="two-armed"><link name="base"/>']

    def add(name, parent, axis, xyz):
        parts.append(
            f'<link name="{name}">{SHAPES}</link>'
            f'<joint name="{name}_joint" type="revolute"><parent link="{parent}"/>'
            f'<child link="{name}"/><origin xyz="{xyz}"/><axis xyz="{axis}"/>'
            '<limit lower="-2.6" upper="2.6" velocity="2" effort="1"/></joint>'
        )
        return name

    x, y, z = "1 0 0", "0 1 0", "0 0 1"
    torso = add("torso", "base", z, "0 0 0.5")
    for side, sign in (("left", 1), ("right", -1)):
        parent = torso
        for i, axis in enumerate([y, x, z, y, z, y, x]):
            place = f"0 {0.2 * sign} 0.4" if i == 0 else "0.12 0 0"
            parent = add(f"{side}{i}", parent, axis, place)
    add("head", add("neck", torso, y, "0 0 0.6"), x, "0 0 0.1")
    return "".join(parts) + "</robot>"


ROBOT = cy.parse(urdf(), "urdf")
BENT = np.array([0.6 * (-1) ** i for i in range(ROBOT.n)])


def run(servo, q, steps=4000, targets=None):
    for _ in range(steps):
        servo.step(q, targets)
        q, targets = servo.advance(q), None
    return q


def moved(frame, by, q=BENT):
    pose = ROBOT.fk(q, frame=frame)
    pose[:3, 3] += by
    return pose


def test_two_hands_and_a_gaze():
    goals = {"left6": moved("left6", [0.03, 0.02, 0]), "right6": moved("right6", [0.02, 0, 0.04])}
    point = np.array([2.0, 0.3, 1.0])
    servo = cy.TaskServo(
        ROBOT,
        [*(cy.FrameTask(frame, goal) for frame, goal in goals.items()), cy.GazeTask("head", point, level=1)],
        acceleration=20.0,
    )
    assert servo.status is None and servo.reports == {} and servo.near is None
    assert servo.tasks == ["left6", "right6", "gaze"]
    q = run(servo, BENT)
    for frame, goal in goals.items():
        assert servo.reports[frame].status == "reached"
        np.testing.assert_allclose(ROBOT.fk(q, frame=frame), goal, atol=1e-5)
    eye = ROBOT.fk(q, frame="head")
    way = (point - eye[:3, 3]) / np.linalg.norm(point - eye[:3, 3])
    np.testing.assert_allclose(eye[:3, 2], way, atol=1e-5)
    assert servo.status == "reached" and "two-armed" in repr(servo) and "reached" in repr(servo)


def test_targets_of_a_step_are_kept():
    first, then = moved("left6", [0.02, 0, 0]), moved("left6", [0, 0.02, 0.01])
    servo = cy.TaskServo(ROBOT, [cy.FrameTask("left6", first), cy.PostureTask(BENT)])
    q = run(servo, BENT, targets={"left6": then, "posture": BENT + 0.01})
    np.testing.assert_allclose(ROBOT.fk(q, frame="left6"), then, atol=1e-5)
    # A moving target is followed without a lag.
    twist = np.array([0.05, 0, 0, 0, 0, 0])
    pose = ROBOT.fk(q, frame="left6")
    for _ in range(200):
        pose[:3, 3] += twist[:3] * servo.dt
        servo.step(q, {"left6": (pose, twist)})
        q = servo.advance(q)
    assert servo.reports["left6"].position_error < 2e-4


def test_a_relative_pose_and_the_centre_of_mass():
    goal = np.linalg.inv(ROBOT.fk(BENT, frame="right6")) @ ROBOT.fk(BENT, frame="left6")
    goal[:3, 3] += [0.02, -0.03, 0.01]
    links = [frame for frame in ROBOT.frames if frame != "base"]

    def center(q):
        return np.mean([ROBOT.fk(q, frame=f) @ [0.05, 0, 0, 1] for f in links], axis=0)[:3]

    target = center(BENT) + [0.01, -0.01, 0]
    tasks = [
        cy.RelativeFrameTask("left6", "right6", goal),
        cy.CenterOfMassTask(target, axes="xy", level=1),
    ]
    servo = cy.TaskServo(ROBOT, tasks, acceleration=20.0)
    q = run(servo, BENT)
    found = np.linalg.inv(ROBOT.fk(q, frame="right6")) @ ROBOT.fk(q, frame="left6")
    np.testing.assert_allclose(found, goal, atol=1e-5)
    np.testing.assert_allclose(center(q)[:2], target[:2], atol=1e-5)
    assert servo.reports["left6 from right6"].status == "reached"


def test_a_posture_below_a_pose():
    panda = cy.load("panda")
    q = panda.home
    goal = panda.fk(q)
    wish = q + [0.4, 0, 0, 0, 0, 0, 0]
    servo = cy.TaskServo(panda, [cy.PostureTask(wish), cy.FrameTask("hand_tcp", goal)])
    before = abs(q - wish)[0]
    for _ in range(4000):
        servo.step(q)
        q = servo.advance(q)
    np.testing.assert_allclose(panda.fk(q), goal, atol=1e-5)
    report = servo.reports["posture"]
    assert servo.status == "reached" and report.status == "stalled"
    # Nearer to the posture, as far as the pose permits.
    assert report.orientation_error == pytest.approx(np.linalg.norm(q - wish), rel=1e-3)
    assert report.orientation_error < before - 0.01 and report.left_out > 0.9


def test_velocities_and_limits_are_reported():
    panda = cy.load("panda")
    desired = np.zeros(7)
    desired[0] = 99.0
    servo = cy.TaskServo(panda, [cy.JointVelocitiesTask(desired)])
    for _ in range(1000):
        qd = servo.step(panda.home)
    report = servo.reports["joint_velocities"]
    joint = panda.joint_names[0]
    assert report.limit == (joint, "velocity") and report.pair is None
    assert report.stopped_by == f"velocity limit of '{joint}'"
    assert qd[0] == pytest.approx(panda.velocity_limit[0], rel=1e-12)
    assert (joint, "velocity") in servo.active_limits
    assert report.orientation_error == pytest.approx(99.0 - qd[0])
    np.testing.assert_array_equal(servo.joint_velocities, qd)


def test_gradients_move_on_what_the_hand_leaves_free():
    panda = cy.load("panda")
    start = np.array([0.4, -0.4, 0.3, -2.0, 0.9, 1.2, 2.7])
    goal = panda.fk(start)

    def volume(q):
        return np.prod(np.linalg.svd(panda.jacobian(q), compute_uv=False))

    def room(q):
        return np.min(np.minimum(q - panda.lower, panda.upper - q) / (panda.upper - panda.lower))

    for task, measure in [
        (cy.ManipulabilityTask("hand_tcp", gain=2.0), volume),
        (cy.LimitAvoidanceTask(margin=0.2), room),
    ]:
        servo, q = cy.TaskServo(panda, [cy.FrameTask("hand_tcp", goal), task]), start
        for _ in range(3000):
            servo.step(q)
            q = servo.advance(q)
        np.testing.assert_allclose(panda.fk(q), goal, atol=1e-5)
        assert measure(q) > 1.03 * measure(start)


def test_a_velocity_of_the_centre_of_mass_and_half_spaces():
    links = [frame for frame in ROBOT.frames if frame != "base"]

    def center(q):
        return np.mean([ROBOT.fk(q, frame=f) @ [0.05, 0, 0, 1] for f in links], axis=0)[:3]

    velocity = np.array([0.02, 0.01, 0.0])
    task = cy.CenterOfMassTask([9.0, 0, 0], velocity=velocity, gain=0.0, name="center")
    servo, q = cy.TaskServo(ROBOT, [task]), BENT
    for _ in range(400):
        servo.step(q)
        q = servo.advance(q)
    np.testing.assert_allclose(center(q) - center(BENT), 0.4 * velocity, atol=1e-4)
    servo.step(q, {"center": (center(q), -velocity)})
    np.testing.assert_allclose(center(servo.advance(q)) - center(q), -1e-3 * velocity, atol=1e-6)

    panda = cy.load("panda")
    goal = panda.fk(panda.home)
    goal[2, 3] -= 0.4
    table = cy.HalfSpace("hand_tcp", [0, 0, goal[2, 3] + 0.3], [0, 0, 2], name="table")
    task = cy.FrameTask("hand_tcp", goal, components="position", name="hand")
    servo = cy.TaskServo(panda, [task], half_spaces=[table], acceleration=20.0)
    q = panda.home
    for _ in range(4000):
        servo.step(q)
        q = servo.advance(q)
    report = servo.reports["hand"]
    assert report.half_space == "table" and report.stopped_by == "half-space 'table'"
    assert panda.fk(q)[2, 3] == pytest.approx(goal[2, 3] + 0.3, abs=1e-6)
    assert panda.fk(q)[2, 3] >= goal[2, 3] + 0.3 - 1e-12
    walls = cy.HalfSpace.inside_box("hand_tcp", goal[:3, 3], [1, 2, 3], name="cell")
    assert [wall.name for wall in walls] == [f"cell {s}{a}" for a in "xyz" for s in "-+"]
    np.testing.assert_allclose(walls[3].point, goal[:3, 3] + [0, 1, 0])
    with pytest.raises(cy.InvalidOptionError, match="normal"):
        cy.HalfSpace("hand_tcp", [0, 0, 0], [0, 0, 0])


def test_tasks_of_a_closed_chain():
    stewart = cy.load("stewart")
    q = stewart.home
    goal = stewart.fk(q, frame="platform")
    goal[:3, 3] += [0.02, 0.01, 0.03]
    task = cy.FrameTask("platform", goal, components="position")
    servo = cy.TaskServo(stewart, [task], dt=0.002)
    for _ in range(2000):
        servo.step(q)
        q = servo.advance(q)
    assert servo.reports["platform"].status == "reached"
    np.testing.assert_allclose(stewart.fk(q, frame="platform")[:3, 3], goal[:3, 3], atol=1e-5)


def test_an_obstacle_is_avoided_and_may_move():
    model = cy.CollisionModel(ROBOT)
    start = ROBOT.fk(BENT, frame="left6")
    center = start[:3, 3] + [0.06, 0, 0] + [0, 0, 0.3]
    model.add_obstacle("ball", "sphere", center, radius=0.1)
    goal = start.copy()
    goal[2, 3] += 0.3  # into the ball
    task = cy.FrameTask("left6", goal, components="position", name="hand")
    avoidance = cy.CollisionAvoidance(model, gap=0.02, margin=0.3)
    assert (avoidance.model is model, avoidance.gap, avoidance.margin) == (True, 0.02, 0.3)
    servo = cy.TaskServo(ROBOT, [task], avoidance, acceleration=20.0)
    q, nearest, stops = BENT, np.inf, []
    for step in range(6000):
        servo.step(q)
        q = servo.advance(q)
        if servo.reports["hand"].pair:
            stops.append(servo.reports["hand"])
        if step % 10 == 0:
            near = model.near(q, margin=0.3)
            nearest = min([nearest, *near.distances])
    assert nearest >= 0.02 - 1e-4
    assert servo.reports["hand"].status == "stalled" and len(stops) > 3000
    assert "ball" in stops[-1].pair and "'ball'" in stops[-1].stopped_by
    assert servo.near.distances.min() == pytest.approx(nearest, abs=5e-3)
    # The obstacle goes, and the hand arrives; another one comes, and the hand gives way.
    model.move_obstacle("ball", [9, 9, 9])
    q = run(servo, q)
    assert servo.reports["hand"].status == "reached"
    model.remove_obstacle("ball")
    servo.step(q)
    assert servo.reports["hand"].pair is None
    model.add_obstacle("wall", "half_space", [0, 0, -9])
    servo.step(q)
    assert all("wall" not in pair for pair in servo.near.pairs)


def test_functions_of_python():
    seen = []

    def elbow(q):
        seen.append(q.shape)
        return [0.2 - q[3]], np.eye(ROBOT.n)[3:4]

    servo = cy.TaskServo(ROBOT, [cy.CustomTask(elbow, 1)], acceleration=20.0)
    q = run(servo, BENT, 4000)
    assert seen[0] == (ROBOT.n,) and q[3] == pytest.approx(0.2, abs=1e-6)
    assert servo.reports["elbow"].status == "reached"


@pytest.mark.parametrize(
    ("returned", "kind", "words"),
    [
        (None, cy.ArgumentTypeError, r"NoneType.*not \(error, jacobian\)"),
        (([0.0],), cy.ArgumentTypeError, "not "),
        (([0.0, 1.0], np.ones((1, 17))), cy.InvalidOptionError, r"error of shape \(1,\)"),
        ((0.0, np.ones((1, 17))), cy.InvalidOptionError, r"error of shape \(1,\)"),
        (([0.0], np.ones(17)), cy.InvalidOptionError, r"Jacobian of shape \(1, 17\)"),
        (([0.0], np.ones((1, 3))), cy.InvalidOptionError, "Jacobian of shape"),
        ((["a"], np.ones((1, 17))), cy.ArgumentTypeError, "error"),
        (([np.nan], np.ones((1, 17))), cy.NotFiniteError, "error of the task 'wrong'"),
        (([0.0], np.full((1, 17), np.inf)), cy.NotFiniteError, "Jacobian of the task 'wrong'"),
    ],
)
def test_wrong_functions_are_errors(returned, kind, words):
    servo = cy.TaskServo(ROBOT, [cy.CustomTask(lambda q: returned, 1, name="wrong")])
    with pytest.raises(kind, match=words):
        servo.step(BENT)
    assert servo.status is None and not servo.joint_velocities.any()


def test_exceptions_of_functions_reach_the_caller():
    class Own(Exception):
        pass

    def fails(q):
        if q[0] > 0.7:
            raise Own("too far")
        return [1.0], np.eye(ROBOT.n)[:1]

    start = moved("left6", [0, 0, 0])
    tasks = [cy.CustomTask(fails, 1), cy.FrameTask("left6", start, level=1)]
    servo = cy.TaskServo(ROBOT, tasks)
    qd = servo.step(BENT)
    far = BENT + 0.2
    with pytest.raises(Own, match="too far"):
        servo.step(far, {"left6": moved("left6", [0.1, 0, 0])})
    # Velocities and targets are those of before.
    np.testing.assert_array_equal(servo.joint_velocities, qd)
    undisturbed = cy.TaskServo(ROBOT, tasks)
    undisturbed.step(BENT)
    np.testing.assert_array_equal(servo.step(BENT), undisturbed.step(BENT))


def test_a_function_may_not_use_the_servo_of_its_step():
    model = cy.CollisionModel(ROBOT)
    errors = []

    def around(q):
        for call in (
            lambda: servo.step(q),
            lambda: servo.status,
            lambda: model.near(q),
            lambda: model.pairs,
            lambda: model.remove_obstacle("none"),
            lambda: repr(model),
        ):
            try:
                call()
            except cy.InUseError as error:
                errors.append(str(error))
        return [0.0], np.zeros((1, ROBOT.n))

    servo = cy.TaskServo(ROBOT, [cy.CustomTask(around, 1)], cy.CollisionAvoidance(model))
    servo.step(BENT)
    assert len(errors) == 6 and all("around this one" in error for error in errors), errors


def test_what_defines_no_controller_is_refused():
    hand = cy.FrameTask("left6", ROBOT.fk(BENT, frame="left6"))
    for arguments, kind, words in [
        ((ROBOT, [hand, hand]), cy.InvalidOptionError, "two tasks have this name"),
        ((cy.load("panda"), [hand]), cy.UnknownNameError, "left6"),
        ((ROBOT, [cy.FrameTask("left6", np.eye(4), gain=-1.0)]), cy.InvalidOptionError, "negative"),
        ((cy.load("ur5e"), [cy.CenterOfMassTask([0, 0, 0])]), cy.CylindroidError, "mass"),
        ((ROBOT, [cy.PostureTask([0.0])]), cy.DimensionError, "posture"),
        ((ROBOT, [cy.CustomTask(print, 0)]), cy.InvalidOptionError, "no rows"),
        ((ROBOT, [cy.CustomTask(print, 10**9)]), cy.InvalidOptionError, "at most 1000"),
        ((ROBOT, [cy.FrameTask("left6", np.eye(4), gain=3e3)]), cy.InvalidOptionError, "below 2"),
        ((ROBOT, [cy.FrameTask("left6", np.eye(4), components="q")]), cy.UnknownNameError, "q"),
        ((ROBOT, "left6"), cy.ArgumentTypeError, "tasks"),
        ((ROBOT, [hand], cy.CollisionModel(ROBOT)), cy.ArgumentTypeError, "collisions"),
    ]:
        with pytest.raises(kind, match=words):
            cy.TaskServo(*arguments)
    other = cy.CollisionAvoidance(cy.CollisionModel(cy.load("panda")))
    with pytest.raises(cy.InvalidOptionError, match="is of 'panda'"):
        cy.TaskServo(ROBOT, [hand], other)
    with pytest.raises(cy.InvalidOptionError, match="margin"):
        cy.CollisionAvoidance(cy.CollisionModel(ROBOT), gap=0.2, margin=0.1)
    still = cy.parse('<robot name="still"><link name="a"/></robot>', "urdf")
    with pytest.raises(cy.InvalidOptionError, match="no joint moves"):
        cy.TaskServo(still, [cy.FrameTask("a", np.eye(4))])
    with pytest.raises(TypeError):
        cy.MotionTask()
    servo = cy.TaskServo(ROBOT, [hand, cy.CustomTask(print, 1, name="own", level=1)])
    for targets, kind, words in [
        ({"hand": np.eye(4)}, cy.UnknownNameError, "left6"),
        ({"left6": [0, 0, 0]}, cy.InvalidOptionError, "targets"),
        ({"left6": np.full((4, 4), np.nan)}, cy.NotFiniteError, "finite"),
        ({"own": [0.0]}, cy.InvalidOptionError, "no target"),
        ([("left6", np.eye(4))], cy.ArgumentTypeError, "targets"),
    ]:
        with pytest.raises(kind, match=words):
            servo.step(BENT, targets)


def test_servo_with_tasks_is_one_of_many():
    hand = cy.FrameTask("left6", moved("left6", [0.02, 0, 0]))
    model, limits = cy.CollisionModel(ROBOT), {"left0_joint": {"velocity": 1e-3}}
    more = {"collisions": cy.CollisionAvoidance(model), "limits": limits, "dt": 0.01, "acceleration": 20.0}
    servo = cy.Servo(ROBOT, tasks=[hand], **more)
    assert isinstance(servo, cy.TaskServo) and servo.dt == 0.01
    same = cy.TaskServo(ROBOT, [hand], **more)
    assert abs(same.step(BENT)[ROBOT.joint_names.index("left0_joint")]) <= 1e-3
    same.reset()
    np.testing.assert_array_equal(servo.step(BENT), same.step(BENT))
    for foreign, words in [
        ({"gain": 2.0}, "gain = "),
        ({"inverse": "damped"}, "inverse = damped"),
        ({"damping": 0.1}, "damping"),
        ({"task": "pose"}, "task = pose"),
        ({"command_timeout": 0.2}, "command_timeout = 0.2"),
    ]:
        with pytest.raises(cy.InvalidOptionError, match=f"{words}.*servo of one frame"):
            cy.Servo(ROBOT, tasks=[hand], **foreign)
    with pytest.raises(cy.InvalidOptionError, match="collisions = .*needs tasks"):
        cy.Servo(ROBOT, collisions=cy.CollisionAvoidance(model))


def test_least_squares_come_nearer_than_a_kept_direction():
    slow = {f"left{i}_joint": {"velocity": 0.01} for i in range(3)}
    goal = moved("left6", [0.1, 0.1, 0.1])
    errors = []
    for keep in (True, False):
        servo = cy.TaskServo(ROBOT, [cy.FrameTask("left6", goal, components="position")], limits=slow,
                             keep_directions=keep)
        q = BENT
        for _ in range(200):
            servo.step(q)
            q = servo.advance(q)
        errors.append(next(iter(servo.reports.values())).position_error)
    assert errors[1] < 0.95 * errors[0]
    with pytest.raises(cy.ArgumentTypeError, match="keep_directions"):
        cy.TaskServo(ROBOT, [], keep_directions="yes")


def test_no_tasks_are_rest():
    servo = cy.TaskServo(ROBOT, [])
    assert not servo.step(BENT).any() and servo.status == "reached"
    servo.reset()
    assert servo.status is None


def test_a_frame_follows_a_twist_beside_other_tasks():
    left, right = moved("left6", [0, 0, 0]), moved("right6", [0, 0, 0])
    tasks = [cy.FrameTask("right6", right), cy.FrameTask("left6", left, level=1)]
    servo = cy.TaskServo(ROBOT, tasks, dt=0.002)
    twist, q = np.array([0.02, -0.01, 0.03, 0.0, 0.05, 0.1]), BENT
    assert servo.commanded_twist("left6") is None
    for _ in range(200):
        servo.command_twist("left6", twist, timeout=0.05)
        servo.step(q)
        q = servo.advance(q)
    assert servo.status == "moving"
    np.testing.assert_array_equal(servo.commanded_twist("left6"), twist)
    way = ROBOT.fk(q, frame="left6")[:3, 3] - left[:3, 3] - 0.4 * twist[:3]
    assert np.linalg.norm(way) < 1e-3
    assert np.linalg.norm(ROBOT.fk(q, frame="right6") - right) < 1e-5
    for _ in range(200):
        velocities = servo.step(q)
        q = servo.advance(q)
    assert servo.status == "reached" and np.abs(velocities).max() < 1e-6
    assert not servo.commanded_twist("left6").any()
    servo.command_twist("left6", twist)
    servo.reset()
    assert servo.commanded_twist("left6") is None
    with pytest.raises(cy.UnknownNameError, match="left6"):
        servo.command_twist("left5", twist)
    with pytest.raises(cy.InvalidOptionError, match="timeout"):
        servo.command_twist("left6", twist, timeout=0)


def test_attributes_of_tasks():
    task = cy.FrameTask("left6", np.eye(4), name="hand", level=2, weight=3.0, gain=4.0)
    assert isinstance(task, cy.MotionTask)
    assert (task.name, task.level, task.weight, task.gain) == ("hand", 2, 3.0, 4.0)
    assert (task.tolerance_position, task.tolerance_orientation) == (1e-6, 1e-6)
    assert repr(task) == "<FrameTask 'hand', level 2>"
    assert repr(cy.PostureTask([0.0])) == "<PostureTask 'posture'>"
    assert cy.GazeTask("head", [0, 0, 0]).name == "gaze"


def test_servos_run_in_threads():
    goal = moved("left6", [0.02, 0, 0])
    found = []

    def work():
        servo = cy.TaskServo(ROBOT, [cy.CustomTask(lambda q: ([0.2 - q[3]], np.eye(ROBOT.n)[3:4]), 1),
                                     cy.FrameTask("left6", goal, level=1)])
        found.append(run(servo, BENT, 300))

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4 and all((q == found[0]).all() for q in found)
