"""Closed chains from Python: reports, statics, assembly."""

import copy

import numpy as np
import pytest

import cylindroid as cy

rng = np.random.default_rng(4)
CLOSED = ["four-bar", "five-bar", "3rrr", "3rps", "stewart", "delta", "watt", "two-arm"]


@pytest.mark.parametrize("name", [*CLOSED, "panda"])
def test_counts_are_dimensions(name):
    r = cy.load(name)
    c = r.constraint()
    m = r.mobility()
    a, p, d = len(m.actuated), len(m.passive), len(m.components)
    t = c.G.shape[1]
    assert c.matrix.shape == (t, a + p + d) and c.Ja.shape == (t, a) and c.Jp.shape == (t, p)
    np.testing.assert_allclose(c.matrix, np.hstack([c.Ja, c.Jp, -c.G.T]))
    assert m.dof == a + p + d - np.linalg.matrix_rank(c.matrix, 1e-9)
    assert m.hyperstatic == t - np.linalg.matrix_rank(c.matrix, 1e-9)
    assert m.dof - m.hyperstatic == m.gruebler_kutzbach
    np.testing.assert_allclose(c.matrix @ m.dof_basis, 0, atol=1e-9)
    for space, count in [
        (m.dof_basis, m.dof),
        (m.idle_basis, m.idle),
        (m.internal_basis, m.internal),
        (m.zero_torque_basis, m.zero_torque),
        (m.hyperstatic_basis, m.hyperstatic),
    ]:
        assert space.shape[1] == count and np.linalg.matrix_rank(space) == count
    relation = m.dof_basis[: a], m.dof_basis[a + p :]
    np.testing.assert_allclose(m.internal_basis.T @ relation[0], 0, atol=1e-9)
    np.testing.assert_allclose(m.zero_torque_basis.T @ relation[1], 0, atol=1e-9)
    assert [j.name for j in m.joints] == m.actuated + m.passive
    assert m.closure_error.distance < 1e-9 and m.length > 0 and m.ambiguous_ranks == []
    assert "dof" in repr(m) and "<table>" in m._repr_html_() and repr(c)


def test_a_singular_posture_is_named():
    arm = cy.load("ur5e")
    m = arm.mobility([0.0, -0.6, 0.0, 0.4, 1.0, 0.0])
    s = m.singularity
    assert s and not s.regular and s.kinds == ["type-i"] and len(s.blocked) == len(s.lost) == 1
    assert s.distances["type_i"] == 0.0 and s.generic["rank"] == 6 and s.compared_with > 0
    assert "type I" in repr(s) and "lost motion" in repr(s) and "<table>" in s._repr_html_()
    J = arm.jacobian([0.0, -0.6, 0.0, 0.4, 1.0, 0.0], reference="world")
    wrench = np.concatenate([s.blocked[0].twist[3:], s.blocked[0].twist[:3]])
    np.testing.assert_allclose(J.T @ wrench, 0, atol=1e-9)
    regular = arm.mobility([0.0, -0.6, 1.0, 0.4, 1.0, 0.0]).singularity
    assert regular.regular and not regular and regular.kinds == []


def test_finite_motion():
    m = cy.load("delta").mobility()
    assert m.finite_dof == 3 and m.finite.certain and m.finite.branches[0].dimension == 3
    assert m.finite.infinitesimal == m.dof and m.finite.shaky.shape[1] == 0


def test_bare_matrices():
    Ja, Jp, G = rng.normal(size=(4, 2)), rng.normal(size=(4, 3)), rng.normal(size=(2, 4))
    c = cy.Constraint(Ja, Jp, G)
    m = c.mobility()
    assert m.dof == 3 and m.singularity is None and m.finite is None and m.closure_error is None
    assert c.actuated == ["qa1", "qa2"] and c.components == ["u1", "u2"]
    scaled = cy.Constraint(Ja, Jp, G, length=0.5, units=("mmrr", "rr", "rmr", "mr"))
    assert scaled.length == 0.5 and scaled.mobility().dof == 3
    with pytest.raises(cy.InvalidOptionError, match="units"):
        cy.Constraint(Ja, length=2.0)
    with pytest.raises(cy.InvalidOptionError, match="letters"):
        cy.Constraint(Ja, Jp, G, units=("mmrx", "rr", "rmr", "mr"))
    with pytest.raises(cy.DimensionError):
        cy.Constraint(Ja, Jp[:3], G)
    with pytest.raises(cy.NotFiniteError):
        cy.Constraint(Ja * np.inf)


def test_serial_efficiencies_are_singular_values():
    r = cy.load("panda")
    q = r.home + 0.2
    J = r.jacobian(q)
    k = r.manipulability(q)
    values = np.linalg.svd(J, compute_uv=False)
    np.testing.assert_allclose(k.kinematic.finite, values**2, rtol=1e-10)
    assert k.kinematic.zeros == 1 and k.kinematic.infinite == 0
    np.testing.assert_allclose(J @ k.kinematic.zero_directions[0], 0, atol=1e-12)
    assert abs(k.kinematic.volume - np.sqrt(np.linalg.det(J @ J.T))) < 1e-12
    assert abs(k.kinematic.anisotropy - (values[0] / values[-1]) ** 2) < 1e-8
    for d in k.kinematic.directions:
        np.testing.assert_allclose(J @ d.joint, d.object, atol=1e-12)
        size = d.object @ d.object / (d.joint @ d.joint)
        assert abs(size / d.efficiency - 1) < 1e-9
    axes = k.kinematic.semi_axes
    np.testing.assert_allclose(np.linalg.norm(axes, axis=0), values, rtol=1e-10)
    np.testing.assert_allclose(k.active_force.finite[::-1], 1 / values**2, rtol=1e-9)
    # Every joint velocity is possible, so no torques balance each other; every twist, so nothing is
    # held without torque.
    assert k.active_force.zeros == 0 and k.passive_force.infinite == 0
    np.testing.assert_allclose(k.index("active-kinematic"), [*values**2, 0], rtol=1e-10)
    assert "kinematic" in repr(k) and "<table>" in k._repr_html_()
    position = r.manipulability(q, task="x,y,z")
    np.testing.assert_allclose(
        position.kinematic.finite, np.linalg.svd(J[:3], compute_uv=False) ** 2, rtol=1e-10
    )
    same = r.manipulability(q, task=np.eye(6)[:3])
    np.testing.assert_allclose(same.kinematic.finite, position.kinematic.finite, rtol=1e-12)


def test_metrics():
    r = cy.load("panda")
    q = r.home + 0.2
    J = r.jacobian(q)
    Wq, Wu = np.diag(rng.uniform(0.5, 2, 7)), np.diag(rng.uniform(0.5, 2, 6))
    expected = np.linalg.svd(np.sqrt(Wu) @ J @ np.linalg.inv(np.sqrt(Wq)), compute_uv=False) ** 2
    for given in ({"Wq": Wq, "Wu": Wu}, {"Wq": np.diag(Wq), "Wu": np.diag(Wu)}):
        np.testing.assert_allclose(r.manipulability(q, **given).kinematic.finite, expected, rtol=1e-9)
    scaled = J / np.array([[r.reach]] * 3 + [[1]] * 3)
    np.testing.assert_allclose(
        r.manipulability(q, metric="length").kinematic.finite,
        np.linalg.svd(scaled, compute_uv=False) ** 2,
        rtol=1e-9,
    )
    np.testing.assert_allclose(
        r.manipulability(q, metric="limits").kinematic.finite,
        np.linalg.svd(scaled * r.velocity_limit, compute_uv=False) ** 2,
        rtol=1e-9,
    )
    with pytest.raises(cy.UnknownNameError):
        r.manipulability(q, metric="si")
    with pytest.raises(cy.DimensionError):
        r.manipulability(q, Wq=np.eye(3))
    with pytest.raises(cy.InvalidOptionError, match="Wq"):
        r.manipulability(q, Wq=-np.eye(7))


def test_measures_are_the_numbers_of_reports():
    r = cy.load("five-bar")
    Q = np.array([r.assemble(r.home + rng.uniform(-0.3, 0.3, r.n)).q for _ in range(9)])
    asked = []
    for given in ({}, {"actuated": ["q1", "q5"], "Wu": [1, 2, 3]}, {"metric": "length", "length": 2.0}):
        found = r.measures(Q, **given)
        asked.append((given, found))
        drives = {k: v for k, v in given.items() if k in ("actuated", "length")}
        for i, q in enumerate(Q):
            m, k = r.mobility(q, **drives), r.manipulability(q, **given)
            for name in (
                "dof coordinate redundancy indeterminacy internal zero_torque hyperstatic idle"
            ).split():
                assert found[name][i] == getattr(m, name), name
            for name in ("volume", "anisotropy"):
                np.testing.assert_allclose(found[name][i], getattr(k.kinematic, name), rtol=1e-10)
            ends = [found["largest"][i], found["smallest"][i]]
            np.testing.assert_allclose(ends, np.array(k.kinematic.finite)[[0, -1]], rtol=1e-10)
            for name in "type_i type_ii configuration_space passive".split():
                np.testing.assert_allclose(found[name][i], m.singularity.distances[name], atol=1e-12)
            assert found["closed"][i] and abs(found["closure_distance"][i] - m.closure_error.distance) < 1e-13
    for given, found in asked:
        again = r.measures(Q, **given)
        assert all(np.array_equal(again[name], found[name]) for name in found), given
    assert found["dof"].dtype.kind == "i" and found["closed"].dtype == bool
    of_task = r.measures(Q, task="x,y", metric="length")
    for i, q in enumerate(Q):
        k = r.manipulability(q, task="x,y", metric="length").kinematic
        np.testing.assert_allclose(of_task["volume"][i], k.volume, rtol=1e-10)
    np.testing.assert_array_equal(r.measures(Q, task=[[1, 0, 0], [0, 1, 0]])["type_i"], of_task["type_i"])
    with pytest.raises(cy.UnknownNameError, match="component"):
        r.measures(Q, task="x,q")
    one = r.measures(Q[0])
    assert one["dof"] == 2 and isinstance(one["volume"], float)
    assert all(len(x) == 0 for x in r.measures(np.zeros((0, 4))).values())
    many = r.measures(np.repeat(Q, 50, axis=0))
    np.testing.assert_array_equal(many["volume"][::50], r.measures(Q)["volume"])
    with pytest.raises(cy.DimensionError):
        r.measures([0.0, 0.0])
    with pytest.raises(cy.NotFiniteError, match="q2"):
        r.measures([[0, 0, 0, 0], [0, np.nan, 0, 0]])


def test_batches_of_reports():
    r = cy.load("panda")
    Q = rng.uniform(r.lower, r.upper, (4, 7))
    for many, one in [
        (r.manipulability(Q), r.manipulability),
        (r.mobility(Q), r.mobility),
        (r.constraint(Q), r.constraint),
    ]:
        assert isinstance(many, list) and len(many) == 4
        assert repr(many[2]) == repr(one(Q[2]))


def test_actuated_joints_can_be_chosen():
    r = cy.load("five-bar")
    names = r.mobility().actuated
    other = r.mobility(actuated=names[:1])
    assert other.actuated == names[:1] and other.indeterminacy >= 1
    assert r.with_actuated(names[:1]).mobility().indeterminacy == other.indeterminacy
    with pytest.raises(cy.UnknownNameError):
        r.mobility(actuated=["nothing"])
    with pytest.raises(cy.UnknownNameError):
        r.mobility(reference="nothing")


@pytest.mark.parametrize("name", CLOSED)
def test_statics_is_virtual_work(name):
    r = cy.load(name)
    c, m = r.constraint(), r.mobility()
    a, p, d = len(m.actuated), len(m.passive), len(m.components)
    wrench = rng.normal(size=d)
    found = c.joint_torques(wrench)
    balanced = wrench - found.unbalanced
    work = m.dof_basis[:a].T @ found.torques + m.dof_basis[a + p :].T @ balanced
    np.testing.assert_allclose(work, 0, atol=1e-9)
    forces = c.contact_forces(found.torques, balanced)
    assert forces.unbalanced < 1e-9
    np.testing.assert_allclose(c.G @ forces.forces, balanced, atol=1e-9)
    np.testing.assert_allclose(-c.Ja.T @ forces.forces, found.torques, atol=1e-9)
    np.testing.assert_allclose(c.G @ c.internal_forces(), 0, atol=1e-9)
    np.testing.assert_allclose(np.hstack([c.Ja, c.Jp]).T @ c.structural_forces(), 0, atol=1e-9)


def test_polytopes():
    r = cy.load("ur5e")
    c = r.constraint(r.home + 0.3)
    J = r.jacobian(r.home + 0.3)[:3]
    box = c.velocity_polytope(task="x,y,z")
    assert box.complete and box.unbounded.shape == (3, 0) and box.span.shape[1] == 3
    signs = np.array(np.meshgrid(*[[-1, 1]] * 6)).reshape(6, -1) * r.velocity_limit[:, None]
    corners = (J @ signs).T
    for normal, offset in zip(box.normals, box.offsets):
        assert abs((corners @ normal).max() - offset) < 1e-9
    reached = box.vertices @ box.normals.T - box.offsets
    assert len(box.facets) == len(box.offsets) and reached.max() < 1e-9
    for facet, at in zip(box.facets, reached.T):
        assert np.abs(at[facet]).max() < 1e-9
    limits = np.full(6, 2.0)
    force = c.force_polytope(limits, task="x,y,z")
    full = r.jacobian(r.home + 0.3)
    for vertex in force.vertices:
        assert np.abs(full.T @ np.concatenate([vertex, np.zeros(3)])).max() <= 2 + 1e-9
    with pytest.raises(cy.InvalidOptionError, match="limits"):
        cy.Constraint(np.eye(2)).velocity_polytope()


@pytest.mark.parametrize("name", CLOSED)
def test_assembly(name):
    r = cy.load(name)
    guess = r.home + rng.uniform(-0.05, 0.05, r.n)
    found = r.assemble(guess)
    assert found and found.closed and found.closure_error.distance < 1e-9 and found.steps > 0
    assert r.constraint(found.q).closure_error.distance < 1e-9 and repr(found)
    assert found.at_limit == []


def test_held_coordinates_stay():
    r = cy.load("five-bar")
    found = r.assemble([-0.2, 0.1, 0.0, 0.0], hold=r.joint_names[:2])
    assert found.closed and found.q[:2].tolist() == [-0.2, 0.1]
    with pytest.raises(cy.UnknownNameError, match="coordinate"):
        r.assemble(hold=["x"])


def test_reports_are_kept_apart_from_copies():
    r = cy.load("five-bar")
    assert copy.deepcopy(r).mobility().dof == r.mobility().dof


def test_modes_and_ways():
    r = cy.load("four-bar")
    crank = r.joint_names[0]
    found = r.assembly_modes([0.3, 0.0, 0.0], hold=[crank])
    assert len(found) == 2 == len(found.modes) and found.self_motion_dof == [0, 0]
    assert sum(found.found) == found.closed <= found.starts and found.unseen_probability < 0.5
    for mode in found.modes:
        assert mode.closed and mode.q[0] == 0.3
        assert r.constraint(mode.q).closure_error.distance < 1e-9
    way = r.track_path(r.home, {crank: 0.2})
    assert way.reached and way.end == "reached" and way.fraction == 1.0 and way.screw is None
    assert way.path.shape == (len(way.fractions), 3) and (np.diff(way.fractions) > 0).all()
    np.testing.assert_array_equal(way.path[-1], way.q)
    assert abs(way.q[0] - 0.2) < 1e-12 and (way.distances > 0).all()
    with pytest.raises(cy.UnknownNameError):
        r.track_path(r.home, {"x": 0.2})


def test_limits_that_are_not_symmetric():
    c = cy.load("ur5e").constraint()
    one = c.velocity_polytope(np.ones(6), task="x,y")
    pairs = c.velocity_polytope(np.tile([-1.0, 1.0], (6, 1)), task="x,y")
    np.testing.assert_allclose(np.sort(one.offsets), np.sort(pairs.offsets), atol=1e-12)
    half = c.velocity_polytope(np.tile([0.0, 1.0], (6, 1)), task="x,y")
    assert half.offsets.min() < one.offsets.min()
    with pytest.raises(cy.InvalidOptionError):
        c.velocity_polytope(-np.ones(6), task="x,y")


def test_gradient_of_manipulability():
    r = cy.load("panda")
    q = r.home + 0.2
    for measure in ("volume", "smallest", "anisotropy"):
        found = r.manipulability_gradient(q, measure, task="x,y,z")
        assert found.exists and found.multiplicity == 1 and found.error == 0.0

        def value(q):
            k = r.manipulability(q, task="x,y,z").kinematic
            return {"volume": k.volume, "smallest": k.finite[-1], "anisotropy": k.anisotropy}[measure]

        step = 1e-6 * np.eye(7)
        slopes = [(value(q + s) - value(q - s)) / 2e-6 for s in step]
        np.testing.assert_allclose(found.gradient, slopes, atol=1e-6 * max(1, found.value))
        assert abs(found.value - value(q)) < 1e-12 and repr(found)
    with pytest.raises(cy.UnknownNameError, match="volume"):
        r.manipulability_gradient(q, "yoshikawa")


LEG = """
<robot name="leg">
  <link name="base"/> <link name="thigh"/> <link name="shank"/> <link name="foot"/>
  <joint name="hip" type="continuous">
    <parent link="base"/> <child link="thigh"/> <axis xyz="0 0 1"/>
  </joint>
  <joint name="knee" type="continuous">
    <parent link="thigh"/> <child link="shank"/> <origin xyz="0.3 0 0"/> <axis xyz="0 0 1"/>
  </joint>
  <joint name="ankle" type="fixed">
    <parent link="shank"/> <child link="foot"/> <origin xyz="0.3 0 0"/>
  </joint>
</robot>
"""
TWO_LEGS = """
[[robot]]
name = "a"
model = "leg.urdf"
start = [1.2, 0.5]

[[robot]]
name = "b"
model = "leg.urdf"
base = { xyz = [0.4, 0, 0] }
start = [1.9, -0.5]

[[closure]]
name = "feet"
type = "point"
between = ["a/foot", "b/foot"]
"""


def test_frames_of_a_urdf_close_a_loop(tmp_path):
    (tmp_path / "leg.urdf").write_text(LEG)
    path = tmp_path / "legs.toml"
    path.write_text(TWO_LEGS)
    for m in [cy.load(path), cy.parse(TWO_LEGS, "toml", path)]:
        feet = [m.fk(m.home, f"{leg}/foot")[:3, 3] for leg in "ab"]
        np.testing.assert_allclose(feet[0], feet[1], atol=1e-12)
        assert m.mobility().dof == 2
        assert [j.name for j in m.joints if j.closes_loop] == ["feet"]
        copy.deepcopy(m)
        # The feet translate in a plane: the screws of one leg are others.
        assert m.screw_system(frame="a/foot").rank == 2
    far = TWO_LEGS.replace("0.4, 0, 0", "1.4, 0, 0")
    with pytest.raises(cy.ModelFileError, match="'feet' cannot be closed.*0.200 m apart"):
        cy.parse(far, "toml", path)


def test_screw_systems_of_closed_chains():
    for name, rank in [("delta", 3), ("3rps", 3), ("stewart", 6), ("five-bar", 2), ("3rrr", 3)]:
        assert cy.load(name).screw_system().rank == rank
    arm = cy.load("ur5e")
    q = arm.home + 0.1
    system, columns = arm.screw_system(q), cy.ScrewSystem(arm.jacobian(q, reference="world"))
    assert system.rank == columns.rank == 6
    with pytest.raises(cy.DimensionError):
        arm.screw_system([0.0])


def test_joints_from_either_link_have_one_meaning():
    joint = """
    [[joint]]
    name = "ball"
    type = "spherical"
    between = ["{}", "{}"]
    origin = [0, 0, 0]
    """
    q = [0.3, -0.2, 0.9]
    forward = cy.parse(joint.format("ground", "a"), "toml")
    reversed = cy.parse(joint.format("a", "ground"), "toml")
    pose = forward.fk(q, "a")
    np.testing.assert_allclose(reversed.fk(q, "a"), np.linalg.inv(pose), atol=1e-15)
    assert [j.reversed for m in (forward, reversed) for j in m.joints] == [False, True]


def test_operation_modes():
    found = cy.load("five-bar").operation_modes(starts=6)
    assert len(found) == 1 and (found.starts, found.closed, found.undecided) == (6, 6, 0)
    mode = found.modes[0]
    assert (mode.dimension, mode.dof, mode.order, mode.found) == (2, 2, 2, 6)
    assert mode.through and mode.q.shape == (4,) and mode.counts["idle"] == 0
    assert found.meetings == [] and mode.screw_class == "IIB"
