"""The names of the Robotics Toolbox, and its robots: classes with the attributes of its own."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest

import cylindroid as cy
from cylindroid.rtb import Robot


def rotation(axis, angle):
    T = np.eye(4)
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    T[[i, j, i, j], [i, j, j, i]] = np.cos(angle), np.cos(angle), -np.sin(angle), np.sin(angle)
    return T


def translation(axis, length):
    T = np.eye(4)
    T["xyz".index(axis), 3] = length
    return T


@dataclass
class DHLink:
    theta: float = 0.0
    d: float = 0.0
    a: float = 0.0
    alpha: float = 0.0
    offset: float = 0.0
    isflip: bool = False
    isrevolute: bool = True
    mdh: int = 0
    qlim: object = None

    def A(self, q):
        q = (-q if self.isflip else q) + self.offset
        theta, d = (q, self.d) if self.isrevolute else (self.theta, q)
        along_z = rotation("z", theta) @ translation("z", d)
        along_x = rotation("x", self.alpha) @ translation("x", self.a)
        return along_x @ along_z if self.mdh else along_z @ along_x


def pose(matrix):
    """As an SE3: the matrix is its A."""
    return SimpleNamespace(A=matrix)


@dataclass
class Table:
    """A robot of a Denavit-Hartenberg table."""

    links: list
    name: str = "table & co"
    base: object = None
    tool: object = None
    configs: dict = field(default_factory=dict)

    def fkine(self, q):
        T = np.eye(4) if self.base is None else self.base.A
        for link, x in zip(self.links, q):
            T = T @ link.A(x)
        return T if self.tool is None else T @ self.tool.A


@dataclass
class Link:
    """A link of elementary transforms: a constant one and at most one joint."""

    name: str
    parent: object
    constant: np.ndarray
    v: object = None
    jindex: object = None
    qlim: object = None

    @property
    def isjoint(self):
        return self.v is not None

    def A(self, q=0.0):
        T = self.constant.copy()
        if self.isjoint:
            q = -q if self.v.isflip else q
            of = rotation if self.v.kind[0] == "R" else translation
            T = T @ of(self.v.kind[1], q)
        return pose(T)


def agrees(ours, theirs):
    rng = np.random.default_rng(4)
    for _ in range(10):
        q = rng.uniform(-1, 1, ours.n)
        np.testing.assert_allclose(ours.fkine(q), theirs(q), atol=1e-14)


@pytest.mark.parametrize("mdh", [0, 1])
def test_tables(mdh):
    rng = np.random.default_rng(1)
    links = []
    for i in range(7):
        theta, d, a, offset = rng.uniform(-1, 1, 4)
        links.append(
            DHLink(theta, d, a, [np.pi / 2, -np.pi / 2, 0.3, 0.0][i % 4], offset, i % 3 == 1,
                   i % 4 != 2, mdh, (-2.0, 1.5) if i != 3 else None)
        )
    base = rotation("y", 0.4) @ translation("x", 0.3)
    # A pitch of a right angle.
    tool = rotation("y", np.pi / 2) @ rotation("x", 0.7) @ translation("z", 0.2)
    table = Table(links, base=pose(base), tool=pose(tool), configs={"qr": np.arange(7) / 10})
    robot = Robot(table)
    agrees(robot, table.fkine)
    assert (robot.n, robot.structure) == (7, "RRPRRRP")
    assert robot.name == "table & co"
    assert robot.qlim[:, 0].tolist() == [-2.0, 1.5] and robot.qlim[:, 3].tolist() == [-np.pi, np.pi]
    assert robot.qr.tolist() == (np.arange(7) / 10).tolist()
    plain = Robot(Table(links))
    agrees(plain, Table(links).fkine)


def tree():
    """Two branches; the links are in another order than the joints; an arm with a gripper."""
    et = lambda kind, flip=False: SimpleNamespace(kind=kind, isflip=flip)  # noqa: E731
    body = Link("body", None, translation("z", 0.3))
    lift = Link("lift", body, rotation("x", 0.5), et("tz"), 0, (0.0, 0.4))
    left = Link("left", lift, translation("y", 0.2), et("Rx", True), 1, (-1.0, 2.0))
    right = Link("right", lift, translation("y", -0.2), et("Ry"), 2)
    hand = Link("hand", left, rotation("z", 0.25))
    gripper = SimpleNamespace(links=[hand], tool=pose(translation("z", 0.1)))
    links = [right, body, lift, left]
    robot = SimpleNamespace(
        name="tree", links=links, base=pose(np.eye(4)), tool=None, grippers=[], ee_links=[right]
    )
    return robot, gripper, hand


def test_trees():
    robot, gripper, hand = tree()
    right, body, lift, left = robot.links
    ours = Robot(robot)
    path = lambda *links: lambda q: np.linalg.multi_dot(  # noqa: E731
        [np.eye(4)] + [link.A(q[link.jindex] if link.isjoint else 0.0).A for link in links]
    )
    agrees(ours, path(body, lift, right))
    assert ours.mechanism.joint_names == ["lift", "left", "right"]
    assert ours.qlim[:, 1].tolist() == [-1.0, 2.0] and ours.qlim[:, 0].tolist() == [0.0, 0.4]
    q = np.array([0.3, -0.4, 0.1])
    np.testing.assert_allclose(ours.fkine(q, "left"), path(body, lift, left)(q), atol=1e-14)
    robot.grippers = [gripper]
    to_tip = lambda q: path(body, lift, left, hand)(q) @ gripper.tool.A  # noqa: E731
    agrees(Robot(robot), to_tip)
    lift.jindex, left.jindex = 1, 0
    with pytest.raises(cy.InvalidOptionError, match="from the base to the tips"):
        Robot(robot)


def test_names_and_results():
    robot = Robot("panda")
    q = np.array([0.1, -0.3, 0.2, -1.8, 0.3, 1.9, 0.5])
    qd = np.linspace(-1, 1, 7)
    step = 1e-6
    moved = robot.mechanism.integrate(q, qd, step)
    slope = (robot.jacob0(moved) - robot.jacob0(q)) / step
    np.testing.assert_allclose(robot.jacob0_dot(q, qd), slope, atol=1e-5)
    # The Hessian in the axes of the end effector is the one in world axes, turned.
    R = robot.fkine(q)[:3, :3].T
    for own, world in zip(robot.hessiane(q), robot.hessian0(q)):
        np.testing.assert_allclose(own, np.kron(np.eye(2), R) @ world, atol=1e-14)
    assert robot.hessiane(np.stack([q, q + 0.1])).shape == (2, 7, 6, 7)
    gradient = robot.jacobm(q)[:, 0]
    for i in range(7):
        ahead, behind = (robot.manipulability(q + s * np.eye(7)[i] * 1e-5) for s in (1, -1))
        assert abs((ahead - behind) / 2e-5 - gradient[i]) < 1e-7
    assert robot.jacob0_analytical(q, "eul").shape == (6, 7)
    assert robot.fkine_all(q).shape == (robot.nlinks + 1, 4, 4)
    found = robot.ik_LM(robot.fkine(q), q0=q)
    assert found[1] == 1 and found[4] < 1e-12
    np.testing.assert_allclose(robot.fkine(found[0]), robot.fkine(q), atol=1e-6)
    assert robot.ikine_NR(robot.fkine(q)).success and robot.ik_GN(robot.fkine(q))[1] == 1
    for seed in range(20):
        assert not robot.mechanism.outside_limits(robot.random_q(seed))
    assert robot.islimit(robot.qlim[0]) == [True] * 7 and not any(robot.islimit(q))


def angles_of(T, representation):
    """Roll, pitch and yaw by the Toolbox's definitions."""
    R = T[:3, :3]
    if representation == "rpy/xyz":  # Rx(yaw) Ry(pitch) Rz(roll)
        return np.array([np.arctan2(-R[0, 1], R[0, 0]), np.arcsin(R[0, 2]),
                         np.arctan2(-R[1, 2], R[2, 2])])
    return np.array([np.arctan2(R[2, 1], R[2, 2]), -np.arcsin(R[2, 0]), np.arctan2(R[1, 0], R[0, 0])])


@pytest.mark.parametrize("representation", ["rpy/xyz", "rpy/zyx"])
def test_rates_of_roll_pitch_yaw(representation):
    robot = Robot("panda")
    q = np.array([0.1, -0.3, 0.2, -1.8, 0.3, 1.6, 0.5])
    found = robot.jacob0_analytical(q, representation)
    for i, step in enumerate(1e-6 * np.eye(7)):
        ends = [angles_of(robot.fkine(q + s * step), representation) for s in (1, -1)]
        np.testing.assert_allclose(found[3:, i], (ends[0] - ends[1]) / 2e-6, atol=1e-8)
    np.testing.assert_array_equal(robot.jacob0_analytical(q)[:3], robot.jacob0(q)[:3])


def test_frames_at_rest_and_options_of_searches():
    robot = Robot("panda")
    q, base = robot.qr, robot.mechanism.frames[0]
    T = robot.fkine(q, None, "link4")
    np.testing.assert_allclose(robot.fkine(q, "link4") @ T, robot.fkine(q), atol=1e-15)
    np.testing.assert_allclose(robot.jacob0(q, None, base), robot.jacob0(q), atol=1e-15)
    found = robot.ikine_LM(T := robot.fkine(q), None, base, q, 30, 100, 1e-6, None, True, 0, k=0.1,
                           method="sugihara")
    assert found.success
    np.testing.assert_allclose(robot.fkine(found.q), T, atol=1e-5)
    assert robot.ik_NR(T, None, base, q, 30, 100, 1e-6, None, True, pinv=True)[1] == 1
    # The same by place: k and method, and those of a Newton-Raphson search.
    assert robot.ik_LM(T, None, base, q, 30, 100, 1e-6, None, True, 0.1, "sugihara")[1] == 1
    assert robot.ik_NR(T, None, base, q, 30, 100, 1e-6, None, True, True, 0.0)[1] == 1
    assert robot.ikine_LM(T, None, base, q, 30, 100, 1e-6, None, True, 0, 1.0, "chan", 0.0).success


def test_frames_that_move():
    """Relative to a link of the arm, in its axes: the derivative of the pose as seen from it."""
    robot = Robot("panda")
    q, step = robot.qr, 1e-6
    found = robot.jacob0(q, None, "link3")
    assert not found[:, :3].any() and found[:, 3:].any(axis=0).all()
    here = robot.fkine(q, None, "link3")
    for i in range(7):
        ends = [robot.fkine(q + s * step * np.eye(7)[i], None, "link3") for s in (1, -1)]
        slope = (ends[0] - ends[1]) / (2 * step)
        turn = slope[:3, :3] @ here[:3, :3].T
        expected = [*slope[:3, 3], turn[2, 1], turn[0, 2], turn[1, 0]]
        np.testing.assert_allclose(found[:, i], expected, atol=1e-8)
    own = np.kron(np.eye(2), here[:3, :3].T) @ found
    np.testing.assert_allclose(robot.jacobe(q, None, "link3"), own, atol=1e-15)
    # Rows of a batch, and a tool point.
    Q, tool = np.stack([q, q + 0.1]), translation("z", 0.1)
    for jacobian in (robot.jacob0, robot.jacobe):
        for row, at in zip(jacobian(Q, None, "link3", tool), Q):
            np.testing.assert_allclose(row, jacobian(at, None, "link3", tool), atol=1e-14)
        assert np.abs(jacobian(q, None, "link3", tool) - jacobian(q, None, "link3")).max() > 1e-3


def test_measures_and_derivatives_take_the_arguments_of_the_toolbox():
    robot = Robot("panda")
    q, tool = robot.qr, translation("z", 0.1)
    values = np.linalg.svd(robot.jacob0(q), compute_uv=False)
    assert abs(robot.manipulability(q, None, None, None, "minsingular") - values[-1]) < 1e-14
    inverse = robot.manipulability(q, method="invcondition")
    assert abs(inverse - values[-1] / values[0]) < 1e-14
    H = robot.hessian0(q, None, None, robot.jacob0(q, tool=tool), tool)
    np.testing.assert_array_equal(H, robot.hessian0(q, tool=tool))
    assert np.abs(H - robot.hessian0(q)).max() > 1e-3
    R = robot.fkine(q)[:3, :3].T
    for own, world in zip(robot.hessiane(q, tool=tool), H):
        np.testing.assert_allclose(own, np.kron(np.eye(2), R) @ world, atol=1e-14)
    gradient = robot.jacobm(q, robot.jacob0(q), robot.hessian0(q), None, None, "trans")
    for i, step in enumerate(1e-5 * np.eye(7)):
        ahead, behind = (robot.manipulability(q + s * step, axes="trans") for s in (1, -1))
        assert abs((ahead - behind) / 2e-5 - gradient[i, 0]) < 1e-7
    # Matrices of another configuration, and what stood in these places before.
    with pytest.raises(NotImplementedError, match="^J is another one than that of q"):
        robot.manipulability(q, robot.jacob0(q + 0.1))
    with pytest.raises(NotImplementedError, match="^Je is another one"):
        robot.hessiane(q, Je=robot.jacob0(q))
    for call in (
        lambda: robot.manipulability(q, "invcondition"),
        lambda: robot.jacobm(q, "trans"),
        lambda: robot.jacob0_dot(q, q, "link4"),
    ):
        with pytest.raises(cy.InvalidOptionError, match="^J0? = .*a matrix of numbers is needed"):
            call()
    with pytest.raises(cy.InvalidOptionError, match=r"^J has the shape \(3, 7\): \(6, 7\)"):
        robot.manipulability(q, np.zeros((3, 7)))


def test_poses_without_the_base():
    base = rotation("y", 0.4) @ translation("x", 0.3)
    links = [DHLink(0.0, 0.1, 0.3, 0.2), DHLink(0.0, 0.1, 0.3, 0.2)]
    robot, table = Robot(Table(links, base=pose(base))), Table(links)
    q = np.array([0.3, -0.5])
    np.testing.assert_allclose(robot.fkine(q, include_base=False), table.fkine(q), atol=1e-14)
    np.testing.assert_allclose(robot.fkine(q), base @ table.fkine(q), atol=1e-14)
    panda = Robot("panda")
    np.testing.assert_array_equal(panda.fkine(panda.qr, include_base=False), panda.fkine(panda.qr))


def test_joints_from_pose_to_pose():
    robot = Robot("panda")
    lower, upper = robot.qlim
    ends = [robot.fkine(lower + share * (upper - lower)) for share in (0.4, 0.6)]
    times = np.array([0.0, 0.5, 1.2, 2.0, 3.0])
    found = robot.jtraj(*ends, times, seed=3)
    assert (len(found), found.naxes) == (5, 7)
    np.testing.assert_array_equal(found.t, times)
    # Half the squared error is 1e-6 at most.
    for end, q in zip(ends, found.q[[0, -1]]):
        np.testing.assert_allclose(robot.fkine(q), end, rtol=0.0, atol=np.sqrt(2e-6))
    # The second configuration is that which the search finds from the first.
    second = robot.ikine_LM(ends[1], q0=found.q[0], seed=3).q
    np.testing.assert_allclose(found.q[-1], second, rtol=0.0, atol=1e-15)
    # The six conditions of a polynomial of fifth order, and its values by them alone.
    T = times[-1]
    powers = [[np.prod(range(k - d + 1, k + 1)) * (t ** max(k - d, 0)) * (k >= d) for k in range(6)]
              for t in (0.0, T) for d in range(3)]
    way = found.q[-1] - found.q[0]
    zero = np.zeros_like(way)
    c = np.linalg.solve(powers, [found.q[0], zero, zero, found.q[-1], zero, zero])
    for t, q, qd, qdd in zip(times, found.q, found.qd, found.qdd):
        rates = (c[1:].T * np.arange(1, 6)).T
        for got, of in ((q, c), (qd, rates), (qdd, (rates[1:].T * np.arange(1, 5)).T)):
            np.testing.assert_allclose(got, t ** np.arange(len(of)) @ of, rtol=0.0, atol=1e-12)
    # A number of times lies between 0 and 1 s.
    few = robot.jtraj(*ends, 3, seed=3)
    np.testing.assert_array_equal(few.t, [0.0, 0.5, 1.0])
    np.testing.assert_allclose(few.q[1], few.q[[0, 2]].mean(axis=0), atol=1e-14)
    np.testing.assert_allclose(few.qd[1], 1.875 * (few.q[2] - few.q[0]), atol=1e-14)
    for bad in (1, 0, [0.0], [0.0, 0.0], [1.0, 2.0], [0.0, np.nan], [0.0, np.inf], [0.0, 1e-200], "soon",
                None, 10**6 + 1, 10**30, np.array([0.0, 1 + 1j]), [[0.0, 1.0]], [0.0, 10**400], True):
        with pytest.raises(cy.InvalidOptionError, match="^t: ") as told:
            robot.jtraj(*ends, bad)
        assert told.value.option == "t"
    with pytest.raises(cy.InvalidOptionError, match="^T2: out of reach"):
        robot.jtraj(ends[0], translation("x", 9.0), 5)
    with pytest.raises(cy.InvalidOptionError, match=r"^T1: .*not \(2, 4, 4\)"):
        robot.jtraj(np.stack(ends), ends[1], 5)
    with pytest.raises(cy.InvalidOptionError, match="^T2: .*several lengths"):
        robot.jtraj(ends[0], [[1.0], [2.0, 3.0]], 5)


def test_pictures():
    plt = pytest.importorskip("matplotlib.pyplot")
    robot = Robot("panda")
    robot.q = robot.qr
    for draw in (robot.plot, robot.vellipse, robot.plot_vellipse, robot.fellipse):
        assert draw().has_data() and draw(robot.qr).has_data()
        plt.close("all")
    assert robot.vellipse(opt="rot").has_data()
    with pytest.raises(ValueError, match="opt = 'all'"):
        robot.vellipse(opt="all")


def test_what_is_missing_says_what_to_use():
    robot = Robot("panda")
    with pytest.raises(NotImplementedError, match="'rne' of the Robotics Toolbox is not in"):
        robot.rne
    with pytest.raises(NotImplementedError, match="joints have limits; use Robot of"):
        robot.ikine_LM(robot.fkine(robot.qr), joint_limits=False)
    with pytest.raises(TypeError, match="no argument 'speed'"):
        robot.ik_LM(robot.fkine(robot.qr), speed=2)
    with pytest.raises(NotImplementedError, match="link4' moves"):
        robot.jacob0_analytical(robot.qr, start="link4")
    with pytest.raises(NotImplementedError, match="pass q"):
        robot.hessian0(J0=np.zeros((6, 7)))
    with pytest.raises(NotImplementedError, match="link4' moves: targets"):
        robot.ikine_LM(robot.fkine(robot.qr), start="link4")
    with pytest.raises(NotImplementedError, match="pass q"):
        robot.manipulability(J=np.zeros((6, 7)))
    with pytest.raises(NotImplementedError, match="pass q"):
        robot.jacobm(J=np.zeros((6, 7)))
    with pytest.raises(NotImplementedError, match="without representation"):
        robot.jacob0_dot(robot.qr, robot.qz, representation="eul")
    with pytest.raises(TypeError, match="six options"):
        robot.ik_NR(robot.fkine(robot.qr), None, None, None, 30, 100, 1e-6, None, True, *range(7))
    with pytest.raises(ValueError, match="'xyz': one of rpy/xyz, rpy/zyx, eul, exp"):
        robot.jacob0_analytical(robot.qr, "xyz")
    assert not hasattr(robot, "rne") and not hasattr(robot, "other")
    with pytest.raises(AttributeError, match="no attribute 'other'"):
        robot.other
    with pytest.raises(cy.InvalidOptionError, match="no links"):
        Robot(Table([]))


def test_a_robot_keeps_a_state():
    robot = Robot("panda")
    for name in ("q", "qd", "qdd"):
        assert not getattr(robot, name).any()
        setattr(robot, name, range(7))
        kept = getattr(robot, name)
        assert kept.tolist() == list(range(7))
        kept[0] = 9.0  # a copy
        assert getattr(robot, name)[0] == 0.0
        for bad in ([0.0], [np.nan] * 7, "abc", None):
            with pytest.raises(cy.InvalidOptionError, match=f"^{name}: 7"):
                setattr(robot, name, bad)
    assert robot.isrevolute(2) and not robot.isprismatic(2)
