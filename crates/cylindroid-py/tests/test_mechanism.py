"""Models and kinematics: shapes, laws, batches."""

import copy
import pathlib
import pickle

import numpy as np
import pytest

import cylindroid as cy

REFERENCES = ["local", "world", "local_world_aligned"]
ROBOTS = ["panda", "ur5e", "youbot", "3r", "stewart"]


def random_q(robot, count, seed=1):
    rng = np.random.default_rng(seed)
    lower = np.maximum(robot.lower, -2.0)
    upper = np.minimum(robot.upper, 2.0)
    return rng.uniform(lower, upper, (count, robot.n))


def test_what_a_mechanism_tells():
    r = cy.load("panda")
    assert (r.name, r.n, r.tool, r.dimension, r.is_closed) == ("panda", 7, "hand_tcp", 3, False)
    assert r.tool_choice == "named by the model"
    assert len(r.joint_names) == 7 and r.tool in r.frames and set(r.units) == {"rad"}
    for limit in (r.lower, r.upper, r.velocity_limit, r.acceleration_limit, r.effort_limit):
        assert limit.shape == (7,) and limit.dtype == np.float64
    assert (r.lower < r.home).all() and (r.home < r.upper).all()
    assert r.actuated == r.joint_names
    moving = [j for j in r.joints if j.coordinates]
    assert [j.coordinates[0] for j in moving] == r.joint_names
    assert {j.kind for j in moving} == {"revolute"}
    assert r.report.format == "catalogue" and r.report.source


def test_the_catalogue_loads():
    names = [name for name, what, source in cy.catalogue()]
    assert {"panda", "ur5e", "youbot", "five-bar", "stewart"} <= set(names)
    for name in names:
        r = cy.load(name)
        assert f"'{r.name}'" in repr(r) and f"{r.n} coordinates" in repr(r)
        assert str(r) and "<table>" in r._repr_html_()
        assert r.fk(r.home).shape == (4, 4)


# The kernel of poses and Jacobians of many is another one than that of one; what they may differ by
# is stated in the library, for 1 m and 1 rad.
ROUNDING = 16 * np.finfo(float).eps


@pytest.mark.parametrize("name", ROBOTS)
def test_batches_are_their_rows(name):
    r = cy.load(name)
    Q = random_q(r, 20)
    QD = random_q(r, 20, seed=2)
    T, all_poses = r.fk(Q), r.fk_all(Q)
    assert T.shape == (20, 4, 4) and all_poses.shape == (20, len(r.frames), 4, 4)
    for reference in REFERENCES:
        J = r.jacobian(Q, reference=reference)
        H = r.hessian(Q, reference=reference)
        D = r.jacobian_dot(Q, QD, reference=reference)
        assert J.shape == (20, 6, r.n) and H.shape == (20, r.n, 6, r.n)
        for i in range(20):
            np.testing.assert_allclose(J[i], r.jacobian(Q[i], reference=reference), 0, ROUNDING)
            np.testing.assert_array_equal(H[i], r.hessian(Q[i], reference=reference))
            np.testing.assert_array_equal(D[i], r.jacobian_dot(Q[i], QD[i], reference=reference))
    for i in range(20):
        np.testing.assert_allclose(T[i], r.fk(Q[i]), 0, ROUNDING)
        np.testing.assert_array_equal(all_poses[i], r.fk_all(Q[i]))
        np.testing.assert_allclose(all_poses[i, r.frames.index(r.tool)], T[i], atol=1e-14)
    assert r.analytical_jacobian(Q).shape == (20, 6, r.n)
    # Seen from a frame at rest the Jacobian is the ordinary one in its axes, from itself zero.
    base = r.frames[0]
    axes = np.kron(np.eye(2), r.fk(Q[0], base)[:3, :3].T)
    for relative, q in zip(r.relative_jacobian(Q, base), Q):
        np.testing.assert_allclose(relative, axes @ r.jacobian(q), atol=1e-13)
    assert not r.relative_jacobian(Q, r.tool).any()


@pytest.mark.parametrize("name", ["panda", "ur5e", "youbot", "3r"])
def test_jacobians_against_differences(name):
    r = cy.load(name)
    step = 1e-6
    for q in random_q(r, 5):
        J, H, T = r.jacobian(q), r.hessian(q), r.fk(q)
        for k in range(r.n):
            d = np.zeros(r.n)
            d[k] = step
            up, down = r.fk(q + d), r.fk(q - d)
            np.testing.assert_allclose((up - down)[:3, 3] / (2 * step), J[:3, k], atol=1e-8)
            W = (up - down)[:3, :3] / (2 * step) @ T[:3, :3].T
            np.testing.assert_allclose([W[2, 1], W[0, 2], W[1, 0]], J[3:, k], atol=1e-8)
            dJ = (r.jacobian(q + d) - r.jacobian(q - d)) / (2 * step)
            np.testing.assert_allclose(dJ, H[k], atol=1e-8)
        qd = np.linspace(-1, 1, r.n)
        np.testing.assert_allclose(r.jacobian_dot(q, qd), np.tensordot(qd, H, 1), atol=1e-12)


def test_references_and_tools_fit_together():
    r = cy.load("panda")
    q = random_q(r, 1)[0]
    T = r.fk(q)
    R, p = T[:3, :3], T[:3, 3]
    local, world, aligned = (r.jacobian(q, reference=ref) for ref in REFERENCES)
    np.testing.assert_allclose(aligned, np.kron(np.eye(2), R) @ local, atol=1e-14)
    np.testing.assert_allclose(world[:3], aligned[:3] - np.cross(world[3:].T, p).T, atol=1e-14)
    tool = np.eye(4)
    tool[:3, 3] = 0.1, 0.2, 0.3
    np.testing.assert_allclose(r.fk(q, tool=tool), T @ tool, atol=1e-14)
    moved = r.jacobian(q, tool=tool)
    np.testing.assert_allclose(
        moved[:3], aligned[:3] + np.cross(aligned[3:].T, R @ tool[:3, 3]).T, atol=1e-14
    )


def test_what_counts_as_numbers():
    r = cy.load("panda")
    q = random_q(r, 6)
    expected = r.jacobian(q)
    strided = np.zeros((12, 14))
    strided[::2, ::2] = q
    backward = np.ascontiguousarray(q[::-1])[::-1]
    raw = np.frombuffer(b"\0" + q.tobytes(), dtype=np.uint8)[1:].view(np.float64).reshape(q.shape)
    assert not raw.flags.aligned
    readonly = q.copy()
    readonly.flags.writeable = False
    for same in (
        q.tolist(),
        tuple(map(tuple, q)),
        np.asfortranarray(q),
        strided[::2, ::2],
        backward,
        q.astype(">f8"),
        raw,
        readonly,
        q.view(np.matrix),
    ):
        np.testing.assert_array_equal(r.jacobian(same), expected)
    np.testing.assert_allclose(r.jacobian(q.astype(np.float32)), expected, atol=1e-6)
    np.testing.assert_array_equal(r.fk([0, 0, 0, -1, 0, 1, 0]), r.fk([0.0, 0, 0, -1, 0, 1, 0]))
    assert r.fk(np.zeros((0, 7))).shape == (0, 4, 4)
    assert r.jacobian(np.zeros((0, 7))).shape == (0, 6, 7)
    assert r.hessian(np.zeros((0, 7))).shape == (0, 7, 6, 7)


def test_results_are_owned():
    r = cy.load("panda")
    q = r.home
    T = r.fk(q)
    T[:] = 0
    assert r.fk(q)[3, 3] == 1
    home = r.home
    home[:] = 9
    assert (r.home != 9).all()


def test_integrate_and_limits():
    r = cy.load("panda")
    np.testing.assert_allclose(r.integrate(r.home, np.ones(7), 0.1), r.home + 0.1, atol=1e-15)
    assert r.outside_limits(r.home) == []
    q = r.home
    q[3] = 1.0
    assert r.outside_limits(q) == [r.joint_names[3]]


def test_text_paths_and_copies(tmp_path):
    text = """<robot name="two"><link name="a"/><link name="b"/><link name="c"/>
    <joint name="j1" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
    <joint name="j2" type="prismatic"><parent link="b"/><child link="c"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="2" effort="1" velocity="1"/></joint></robot>"""
    path = tmp_path / "two.urdf"
    path.write_text(text)
    for r in (cy.parse(text), cy.load(path), cy.load(str(path)), cy.load(pathlib.Path(path))):
        assert r.joint_names == ["j1", "j2"] and r.units == ["rad", "m"]
        np.testing.assert_allclose(r.fk([np.pi / 2, 2.0])[:3, 3], [0, 2, 0], atol=1e-15)
    for clone in (copy.copy(r), copy.deepcopy(r)):
        np.testing.assert_array_equal(clone.fk([1, 1]), r.fk([1, 1]))


def test_pickling(tmp_path, monkeypatch):
    """A mechanism is read again from what it was read from; a file is found from any folder."""
    text = '<robot name="one"><link name="a"/><link name="b"/><joint name="j" type="continuous">\
    <parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>'
    (tmp_path / "one.urdf").write_text(text)
    monkeypatch.chdir(tmp_path)
    read = [cy.load("panda"), cy.load("five-bar"), cy.load("one.urdf"), cy.parse(text, "urdf")]
    kept = [pickle.dumps(r) for r in read]
    monkeypatch.chdir("/")
    for r, data in zip(read, kept):
        again = pickle.loads(data)
        assert again.joint_names == r.joint_names and again.report.format == r.report.format
        np.testing.assert_array_equal(again.fk(r.home), r.fk(r.home))
    driven = read[1].with_actuated(["q1", "q3"])
    assert pickle.loads(pickle.dumps(driven)).actuated == driven.actuated == ["q1", "q3"]
    slow = driven.with_limits({"q1": {"velocity": 0.5, "lower": -1.0}, "q5": {"effort": 2.0}})
    assert slow.velocity_limit[0] == 0.5 and slow.lower[0] == -1.0
    again = pickle.loads(pickle.dumps(slow))
    np.testing.assert_array_equal(again.velocity_limit, slow.velocity_limit)
    assert again.actuated == ["q1", "q3"]
    with pytest.raises(cy.UnknownNameError, match="nearest: velocity"):
        driven.with_limits({"q1": {"velocty": 0.5}})
    with pytest.raises(cy.InvalidOptionError, match="narrowed"):
        slow.with_limits({"q1": {"lower": -2.0}})
    with pytest.raises(cy.ArgumentTypeError, match="limits is a dict"):
        driven.with_limits([1.0])
    (tmp_path / "one.urdf").unlink()
    with pytest.raises(cy.CylindroidError, match="one.urdf"):
        pickle.loads(kept[2])


def test_a_mechanism_without_joints():
    r = cy.parse('<robot name="stone"><link name="a"/></robot>')
    assert r.n == 0
    np.testing.assert_array_equal(r.fk([]), np.eye(4))
    assert r.jacobian([]).shape == (6, 0)
    assert r.jacobian(np.zeros((3, 0))).shape == (3, 6, 0)
    assert r.fk(np.zeros((3, 0))).shape == (3, 4, 4)


FIVE_BAR = pathlib.Path(__file__).parents[2] / "cylindroid/tests/data/five_bar_parameters.toml"


def test_parameters_of_a_mechanism_file():
    r = cy.load(FIVE_BAR, parameters={"crank": 0.4, "width": 0.0})
    own = {p.name: p for p in r.parameters}
    assert list(own) == ["crank", "rod", "width", "height"]
    assert (own["crank"].value, own["crank"].lower, own["crank"].upper) == (0.4, 0.2, 1.0)
    assert (own["crank"].unit, own["crank"].description) == ("m", "both cranks")
    assert own["height"].expression.startswith("crank + sqrt") and own["height"].upper == np.inf
    assert r.fk(r.home)[1, 3] == own["height"].value == 1.0
    assert repr(own["crank"]) == "Parameter(crank = 0.4 m)"
    text = cy.parse(FIVE_BAR.read_text(), "toml", FIVE_BAR, {"crank": 0.4, "width": 0.0})
    for same in (pickle.loads(pickle.dumps(r)), pickle.loads(pickle.dumps(text)), copy.copy(r)):
        assert [p.value for p in same.parameters] == [p.value for p in r.parameters]
    assert cy.load("panda").parameters == []


def test_wrong_parameters_are_refused():
    with pytest.raises(cy.UnknownNameError, match="nearest: crank"):
        cy.load(FIVE_BAR, parameters={"cranck": 0.4})
    with pytest.raises(cy.InvalidOptionError, match="its range is 0.2 to 1"):
        cy.load(FIVE_BAR, {"crank": 1.5})
    with pytest.raises(cy.NotFiniteError):
        cy.load(FIVE_BAR, {"crank": np.nan})
    with pytest.raises(cy.ArgumentTypeError, match="parameters"):
        cy.load(FIVE_BAR, {"crank": "long"})
    with pytest.raises(cy.ModelFileError, match="is not a number"):
        cy.load(FIVE_BAR, {"rod": 0.25})
    with pytest.raises(cy.InvalidOptionError, match="has no parameters"):
        cy.load("panda", {"crank": 0.4})
    with pytest.raises(cy.InvalidOptionError, match="only mechanism files"):
        cy.parse("<robot name='r'><link name='a'/></robot>", parameters={"a": 1})
