"""Inverse kinematics from Python."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import cylindroid as cy

rng = np.random.default_rng(8)


@pytest.mark.parametrize("name", ["panda", "ur5e", "puma560"])
def test_answers_reach_within_limits(name):
    r = cy.load(name)
    targets = r.fk(rng.uniform(np.maximum(r.lower, -3), np.minimum(r.upper, 3), (20, r.n)))
    found = r.ik(targets)
    assert found.q.shape == (20, r.n) and found.success.all() and not found.out_of_reach.any()
    np.testing.assert_allclose(r.fk(found.q), targets, atol=3e-6)
    assert ((r.lower <= found.q) & (found.q <= r.upper)).all()
    assert (found.position_error <= 1e-6).all() and (found.iterations > 0).all()
    assert found.analytic.all() or name == "panda"
    one = r.ik(targets[0])
    np.testing.assert_array_equal(one.q, found.q[0])
    assert one.success is True and one.iterations == found.iterations[0] and one.restarts >= 1
    assert "success" in repr(one) and "<table>" in one._repr_html_() and "20 targets" in repr(found)


def test_starts_tasks_and_tools():
    r = cy.load("panda")
    q = r.home + 0.1
    target = r.fk(q)
    np.testing.assert_allclose(r.ik(target, q0=q).q, q, atol=1e-6)
    near = r.ik(target, q0=q + 0.05, nearest=True)
    assert np.linalg.norm(near.q - q - 0.05) < 0.2
    starts = np.array([q, q + 0.02])
    both = r.ik(np.array([target, target]), q0=starts)
    np.testing.assert_allclose(both.q[0], q, atol=1e-6)
    point = r.ik(target, task="position", fixed=r.joint_names[4:])
    np.testing.assert_allclose(r.fk(point.q)[:3, 3], target[:3, 3], atol=2e-6)
    np.testing.assert_array_equal(point.q[4:], r.home[4:])
    tool = np.eye(4)
    tool[2, 3] = 0.2
    held = r.ik(target @ tool, tool=tool)
    np.testing.assert_allclose(r.fk(held.q, tool=tool), target @ tool, atol=3e-6)
    link = r.fk(q, "link5")
    np.testing.assert_allclose(r.fk(r.ik(link, "link5").q, "link5"), link, atol=3e-6)


def test_all_answers_of_six_joints():
    r = cy.load("ur5e")
    target = r.fk([0.3, -1.2, 1.1, -0.4, 0.9, 0.2])
    all_of_them = r.ik_all(target, 8)
    assert r.ik(target).analytic is True and "analytic" in repr(r.ik(target))
    assert r.ik(target, task="position").analytic is False
    assert all_of_them.shape[1] == 6 and len(all_of_them) >= 4
    np.testing.assert_allclose(r.fk(all_of_them), np.tile(target, (len(all_of_them), 1, 1)), atol=3e-6)
    assert len(np.unique(all_of_them.round(2), axis=0)) == len(all_of_them)


TWO_ARMS = """<robot name="two">
<link name="base"/><link name="torso"/><link name="l1"/><link name="l2"/><link name="r1"/><link name="r2"/>
<link name="l"/><link name="r"/>
<joint name="turn" type="continuous"><parent link="base"/><child link="torso"/><axis xyz="0 0 1"/></joint>
<joint name="l1" type="continuous"><parent link="torso"/><child link="l1"/>
<origin xyz="0 1 0"/><axis xyz="0 0 1"/></joint>
<joint name="l2" type="continuous"><parent link="l1"/><child link="l2"/>
<origin xyz="1 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="lf" type="fixed"><parent link="l2"/><child link="l"/><origin xyz="0.5 0 0"/></joint>
<joint name="r1" type="continuous"><parent link="torso"/><child link="r1"/>
<origin xyz="0 -1 0"/><axis xyz="0 0 1"/></joint>
<joint name="r2" type="continuous"><parent link="r1"/><child link="r2"/>
<origin xyz="1 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="rf" type="fixed"><parent link="r2"/><child link="r"/><origin xyz="0.5 0 0"/></joint>
</robot>"""


def test_several_frames_at_once():
    r = cy.parse(TWO_ARMS)
    Q = rng.uniform(-2, 2, (10, 5))
    targets = {"l": r.fk(Q, "l"), "r": r.fk(Q, "r")}
    found = r.ik(targets, task="x,y", task_axes="world")
    assert found.success.all() and found.q.shape == (10, 5)
    for frame, poses in targets.items():
        np.testing.assert_allclose(r.fk(found.q, frame)[:, :2, 3], poses[:, :2, 3], atol=2e-6)
    one = {frame: poses[0] for frame, poses in targets.items()}
    np.testing.assert_array_equal(r.ik(one, task="x,y", task_axes="world").q, found.q[0])
    ways = r.ik_all(one, 3, task="x,y", task_axes="world")
    assert len(ways) == 3
    for frame, pose in one.items():
        np.testing.assert_allclose(r.fk(ways, frame)[:, :2, 3], np.tile(pose[:2, 3], (3, 1)), atol=2e-6)
    # Each hand alone could be there; both cannot: shoulders are on opposite sides of the torso.
    apart = {"l": r.fk(Q[0], "l"), "r": r.fk(Q[0], "r")}
    apart["l"][:2, 3] = apart["r"][:2, 3] = 2.3, 0.0
    lone = [r.ik({f: T}, task="x,y", task_axes="world").success for f, T in apart.items()]
    assert lone == [True, True] and not r.ik(apart, task="x,y", task_axes="world", iterations=2000).success
    for call, kind, words in [
        (lambda: r.ik({}), cy.CylindroidError, "goal"),
        (lambda: r.ik({"hand": one["l"]}), cy.UnknownNameError, "frame"),
        (lambda: r.ik(one, "l"), cy.InvalidOptionError, "names the frames"),
        (lambda: r.ik(one, tool=np.eye(4)), cy.InvalidOptionError, "tool"),
        (lambda: r.ik({"l": targets["l"], "r": one["r"]}), cy.InvalidOptionError, "as many"),
        (lambda: r.ik_all(targets), cy.InvalidOptionError, "batch"),
        (lambda: r.ik({"l": "there"}), TypeError, "real numbers"),
    ]:
        with pytest.raises(kind, match=words):
            call()


def test_each_frame_has_its_components_and_weight():
    r = cy.load("panda")
    q = [0.3, -0.4, 0.2, -2.0, 0.1, 1.7, 0.5]
    both = {"link4": r.fk(q, "link4"), r.tool: r.fk(q)}
    task = {"link4": "z", r.tool: "position"}
    found = r.ik(both, task=task)
    assert found.success and found.reason is None
    assert abs(r.fk(found.q, "link4") - both["link4"])[2, 3] < 1e-5
    assert abs(r.fk(found.q)[:3, 3] - both[r.tool][:3, 3]).max() < 1e-5
    # Where both cannot be reached, the heavier one is nearer.
    apart = {"link4": both["link4"], r.tool: both[r.tool].copy()}
    apart[r.tool][:3, 3] += [0, 0, 2.0]
    errors = []
    for weight in [0.1, 10.0]:
        weights = {"link4": weight}
        found = r.ik(apart, task="position", weights=weights, iterations=200)
        assert not found.success and found.reason.startswith("out of reach")
        errors.append(abs(r.fk(found.q, "link4") - both["link4"])[:3, 3].max())
    assert errors[1] < 0.5 * errors[0]
    assert r.ik_all(both, 2, task=task, weights={"link4": 2.0}).shape[1] == 7
    for call, words in [
        (lambda: r.ik(r.fk(q), task={"link4": "z"}), "names frames"),
        (lambda: r.ik(both, task={"link3": "z"}), "no target"),
        (lambda: r.ik(both, weights={"link3": 1.0}), "no target"),
        (lambda: r.ik(r.fk(q), weights={"link3": 1.0}), "names frames"),
        (lambda: r.ik(both, weights={"link4": 0.0}), "weight"),
    ]:
        with pytest.raises(cy.InvalidOptionError, match=words):
            call()


BALLS = """
name = "panda"
[[robot]]
model = "panda"
[[collision]]
link = "link4"
shape = "sphere"
radius = 0.09
[[collision]]
link = "flange"
shape = "sphere"
radius = 0.06
"""


def test_solutions_keep_a_gap_and_misses_have_reasons():
    r = cy.parse(BALLS, format="toml")
    q = [0.3, -0.4, 0.2, -2.0, 0.1, 1.7, 0.5]
    model = cy.CollisionModel(r, samples=0)
    elbow = r.fk(q, "link4")[:3, 3] + [0.02, 0.03, 0.0]
    model.add_obstacle("ball", "sphere", elbow, radius=0.05)
    avoid = cy.CollisionAvoidance(model, gap=0.02)
    assert r.ik(r.fk(q), q0=q).success
    assert min(model.near(q, margin=0.02).distances) < 0.02
    for nearest in [False, True]:
        found = r.ik(r.fk(q), q0=q, nearest=nearest, collisions=avoid)
        assert found.success and len(model.near(found.q, margin=0.02).distances) == 0
    assert all(len(model.near(x, margin=0.02).distances) == 0
               for x in r.ik_all(r.fk(q), 4, collisions=avoid))
    model.add_obstacle("wall", "sphere", r.fk(q)[:3, 3], radius=0.2)
    found = r.ik(np.array([r.fk(q), r.fk(r.home)]), collisions=avoid, iterations=2000)
    assert found.reason[0].startswith("collision") and "wall" in found.reason[0]
    one = r.ik(r.fk(q), collisions=avoid, iterations=2000)
    assert not one.success and "wall" in repr(one)


def test_goals_beside_frames():
    r = cy.load("panda")
    q = [0.3, -0.4, 0.2, -2.0, 0.1, 1.7, 0.5]
    seen = np.linalg.inv(r.fk(q, "link4")) @ r.fk(q)
    point = np.array([0.6, 0.2, 0.0])
    tasks = [cy.GazeTask(r.tool, point), cy.RelativeFrameTask(r.tool, "link4", seen, weight=2.0)]
    found = r.ik(tasks=tasks)
    assert found.success and isinstance(found.position_error, float)
    hand = r.fk(found.q)
    way = point - hand[:3, 3]
    np.testing.assert_allclose(hand[:3, 2], way / np.linalg.norm(way), atol=1e-5)
    np.testing.assert_allclose(np.linalg.inv(r.fk(found.q, "link4")) @ hand, seen, atol=1e-5)
    # Beside targets, also many of them.
    heights = np.array([r.fk(q)] * 3)
    heights[:, 2, 3] += [0.0, 0.05, 0.1]
    found = r.ik(heights, task="z", tasks=tasks[:1])
    assert found.success.all()
    np.testing.assert_allclose(r.fk(found.q)[:, 2, 3], heights[:, 2, 3], atol=1e-5)
    assert r.ik_all(tasks=tasks, count=3).shape == (3, 7)
    # All goals must be reached.
    far = r.fk(q)
    far[2, 3] += 2.0
    found = r.ik(tasks=[*tasks, cy.FrameTask(r.tool, far)], iterations=500)
    assert not found.success and found.reason.startswith("out of reach")
    for call, words in [
        (lambda: r.ik(), "target"),
        (lambda: r.ik(tasks=[]), "tasks"),
        (lambda: r.ik(tasks=tasks, frame="link4"), "belongs to target"),
        (lambda: r.ik(tasks=[cy.LimitAvoidanceTask()]), "goals"),
        (lambda: r.ik(tasks=[*tasks, cy.LimitAvoidanceTask(), cy.LimitAvoidanceTask(margin=0.2)]),
         "one criterion"),
        (lambda: r.ik(tasks=[*tasks, cy.LimitAvoidanceTask()], maximise="manipulability"),
         "a task for a criterion"),
        (lambda: r.ik(tasks=tasks, maximise="manipulability", nearest=True), "nearest"),
        (lambda: r.ik(tasks=[cy.PostureTask(q), *tasks], posture=q), "PostureTask"),
        (lambda: r.ik(tasks=[cy.PostureTask(q)]), "goals"),
    ]:
        with pytest.raises(cy.InvalidOptionError, match=words):
            call()
    with pytest.raises(cy.ModelError, match="without mass"):
        r.ik(tasks=[cy.CenterOfMassTask([0, 0, 0.5])])


def test_half_spaces_and_postures():
    r = cy.load("panda")
    q = np.array([0.3, -0.4, 0.2, -2.0, 0.1, 1.7, 0.5])
    elbow = r.fk(q, "link4")[:3, 3]
    free = r.ik(r.fk(q), q0=q, nearest=True)
    assert np.allclose(free.q, q, atol=1e-4)
    beside = cy.HalfSpace("link4", elbow + [0, 0.05, 0], [0, 1, 0], name="beside")
    found = r.ik(r.fk(q), q0=q, nearest=True, half_spaces=[beside])
    assert found.success
    np.testing.assert_allclose(r.fk(found.q, "link4")[1, 3], elbow[1] + 0.05, atol=1e-5)
    wall = cy.HalfSpace(r.tool, [0.9, 0, 0], [1, 0, 0], name="wall")
    found = r.ik(r.fk(q), half_spaces=[wall])
    assert not found.success and found.reason.startswith("half-space") and "wall" in found.reason
    # The posture counts, whatever the start is.
    near = q + 0.05
    for tasks, posture in [(None, near), ([cy.PostureTask(near)], None)]:
        found = r.ik(r.fk(q), q0=r.home, tasks=tasks, posture=posture)
        best = r.ik(r.fk(q), q0=near, nearest=True)
        assert found.success and np.allclose(found.q, best.q, atol=1e-3)
    with pytest.raises(cy.DimensionError):
        r.ik(r.fk(q), posture=[0.0])


def test_criteria():
    r = cy.load("panda")
    q = np.array([0.3, -0.4, 0.2, -2.0, 0.1, 1.7, 0.5])
    target = r.fk(q)
    length = r.reach

    def volume(q):
        j = r.jacobian(q, reference="local_world_aligned")
        j[:3] /= r.reach
        return np.sqrt(np.linalg.det(j @ j.T))

    best = r.ik(target, maximise="manipulability")
    assert best.success and best.criterion == pytest.approx(volume(best.q), rel=1e-9)
    others = r.ik_all(target, 100)
    assert best.criterion >= max(volume(other) for other in others) * (1 - 1e-6)
    same = r.ik(target, tasks=[cy.ManipulabilityTask(r.tool)])
    assert same.criterion == pytest.approx(best.criterion, rel=1e-6)
    all_best = r.ik_all(target, 100, maximise="manipulability")
    np.testing.assert_allclose(all_best[0], best.q, atol=1e-9)
    away = r.ik([target, target], maximise="limit-avoidance")
    assert away.success.all() and away.criterion[0] <= 0
    assert away.criterion[0] >= r.ik(target, tasks=[cy.LimitAvoidanceTask(margin=0.5)]).criterion - 1e-6
    assert r.ik(target).criterion is None
    with pytest.raises(cy.UnknownNameError, match="manipulability"):
        r.ik(target, maximise="manipulabilty")
    stewart = cy.load("stewart")
    with pytest.raises(cy.InvalidOptionError, match="criterion"):
        stewart.ik(stewart.fk(stewart.home), maximise="limit-avoidance")


def test_what_cannot_be_reached():
    r = cy.load("panda")
    far = np.eye(4)
    far[0, 3] = 4.0
    found = r.ik(far, iterations=500)
    assert not found.success and found.out_of_reach and found.position_error > 2
    assert "out of reach" in repr(found)
    assert r.ik_all(far, iterations=100).shape == (0, 7)


def test_working_modes_of_closed_chains():
    m = cy.load("five-bar")
    target = np.eye(4)
    target[:2, 3] = 1.0, 1.5
    modes = m.ik_all(target, task="x,y")
    assert modes.shape == (4, 4)
    for q in modes:
        assert np.abs(m.fk(q, "coupler")[:2, 3] - m.fk(modes[0], "coupler")[:2, 3]).max() < 2.1
        assert m.assemble(q).closed
    targets = np.array([target, target])
    targets[1, 1, 3] = 9.0
    found = m.ik(targets, task="x,y")
    assert list(found.success) == [True, False] and found.reason[0] is None
    assert "out of reach" in found.reason[1]
    nearest = m.ik(target, task="x,y", q0=modes[2] + 0.01, nearest=True)
    assert np.abs(nearest.q - modes[2]).max() < 1e-6
    legs = cy.load("stewart")
    start = legs.ik(legs.fk(legs.home, "platform"), frame="platform")
    assert start.success and np.abs(start.q).max() < 1e-9
    bodies = cy.CollisionAvoidance(cy.CollisionModel(m), gap=0.01)
    with pytest.raises(cy.InvalidOptionError):
        m.ik(target, task="x,y", collisions=bodies)


def test_input_is_checked():
    r = cy.load("panda")
    T = r.fk(r.home)
    for call, kind in [
        (lambda: r.ik(T[:3]), cy.InvalidOptionError),
        (lambda: r.ik(T * np.nan), cy.NotFiniteError),
        (lambda: r.ik(T, "nothing"), cy.UnknownNameError),
        (lambda: r.ik(T, fixed=["x"]), cy.UnknownNameError),
        (lambda: r.ik(T, task="w"), cy.UnknownNameError),
        (lambda: r.ik(T, q0=[1.0]), cy.DimensionError),
        (lambda: r.ik(np.array([T, T]), q0=np.zeros((3, 7))), cy.InvalidOptionError),
        (lambda: r.ik(T, tolerance_position=-1), cy.InvalidOptionError),
        (lambda: cy.load("stewart").ik({"platform": T, "rod1": T}), cy.InvalidOptionError),
    ]:
        with pytest.raises(kind):
            call()
    assert r.ik(np.zeros((0, 4, 4))).q.shape == (0, 7)


QUESTIONS = [
    {},
    {"frame": "link4", "task": "position"},
    {"q0": [0.3] * 7},
    {"nearest": True, "q0": [0.2] * 7},
    {"posture": [0.1, 0.2, 0.3, -1.5, 0.1, 1.5, 0.4]},
    {"task": "x,y,z", "seed": 5},
    {"fixed": ["panda_joint3"], "q0": [0.1] * 7},
    {"tolerance_position": 1e-4},
    {"tool": np.diag([1.0, -1, -1, 1])},
    {"half_spaces": [cy.HalfSpace("link4", [0.0, 0, -1], [0.0, 0, 1])]},
]


def test_a_kept_solver_gives_the_answers_of_a_new_one():
    """Questions in turn, more than are kept; the same from several threads at once."""
    kept = cy.load("panda")
    targets = kept.fk(rng.uniform(kept.lower, kept.upper, (12, 7)))
    targets[5, 0, 3] += 3.0
    asked = [(i, rng.integers(len(QUESTIONS))) for i in rng.permutation(np.arange(60) % 12)]
    asked = [(i, k) for i, k in asked for _ in range(1 + (k == 0))]

    def answer(robot, i, k):
        found = robot.ik(targets[i], **QUESTIONS[k])
        return found.q.tobytes(), found.iterations, found.success

    expected = [answer(cy.load("panda"), i, k) for i, k in asked]
    assert [answer(kept, i, k) for i, k in asked] == expected
    with ThreadPoolExecutor(4) as threads:
        assert list(threads.map(lambda ask: answer(kept, *ask), asked)) == expected
    assert 20 < sum(success for *_, success in expected) < len(expected)


def test_an_error_leaves_no_solver_behind():
    kept = cy.load("panda")
    target = kept.fk(kept.home + 0.1)
    expected = cy.load("panda").ik(target).q
    np.testing.assert_array_equal(kept.ik(target).q, expected)
    with pytest.raises(cy.NotFiniteError):
        kept.ik(target, q0=[np.nan] * 7)
    with pytest.raises(cy.InvalidOptionError):
        kept.ik(np.zeros((4, 4)))
    np.testing.assert_array_equal(kept.ik(target).q, expected)
    other = cy.load("panda").with_tool("link4").ik(target).q
    np.testing.assert_array_equal(kept.with_tool("link4").ik(target).q, other)
