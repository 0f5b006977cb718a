"""Pictures: what is drawn has the numbers of the reports, in the plane and in space."""

import matplotlib
import numpy as np
import pytest

import cylindroid as cy


@pytest.fixture
def plot():
    matplotlib.use("Agg")
    from cylindroid import plot

    yield plot
    matplotlib.pyplot.close("all")


def drawn_axes(ax):
    """The semi-axes and the centre of the last ellipsoid, from its thin lines."""
    lines = [line for line in ax.lines if line.get_linewidth() == 1 and line.get_color() == "0.2"]
    ends = [np.array(line.get_data_3d() if hasattr(line, "get_data_3d") else line.get_data()) for line in lines]
    return np.array([0.5 * (e[:, 1] - e[:, 0]) for e in ends]).T, np.array([e.mean(1) for e in ends])


def faces_of(surface):
    """The corners of the faces of a surface in space."""
    return np.asarray(surface._faces)


def square(axes):
    return axes @ axes.T


def test_loop_joints_are_drawn_where_they_stand(plot):
    r = cy.load("five-bar")
    ax = plot.mechanism(r)
    links = {line.get_label(): line.get_xydata() for line in ax.lines if line.get_label()[0] == "_"}
    ends = sorted(sorted(map(tuple, xy.round(12))) for xy in links.values() if len(xy) == 2)
    assert [(2.0, 0.0), (2.0, 1.0)] in ends and [(1.0, 2.0), (2.0, 1.0)] in ends
    assert not any((0.0, 0.0) in e and (2.0, 1.0) in e for e in ends)
    points = {c.get_label(): np.asarray(c.get_offsets()) for c in ax.collections}
    np.testing.assert_allclose(points["_actuated"], [[0, 0], [0, 2]], atol=1e-12)
    assert (np.abs(points["_passive"] - [2, 0]).max(1) < 1e-12).any()
    # In other assemblies too, and in batches.
    found = r.assemble(r.home + 0.2)
    axes = r.joint_axes(np.array([r.home, found.q]))
    assert axes.shape == (2, 5, 2, 3)
    np.testing.assert_allclose(axes[:, -1, 0], [[2, 0, 0]] * 2, atol=1e-9)
    np.testing.assert_allclose(axes[:, :, 1], np.broadcast_to([0, 0, 1], (2, 5, 3)), atol=1e-12)
    with pytest.raises(cy.UnknownNameError, match="parent"):
        r.joint_axes(r.home, side="left")


@pytest.mark.parametrize("model", ["stewart", "delta", "two-arm", "watt", "panda"])
def test_mechanisms_of_all_kinds_are_drawn(plot, model, tmp_path):
    r = cy.load(model)
    ax = plot.mechanism(r)
    ax.figure.savefig(tmp_path / "mechanism.png")
    for joint, parent, child in zip(
        r.joints, r.joint_axes(r.home), r.joint_axes(r.home, side="child")
    ):
        if joint.kind == "revolute":
            np.testing.assert_allclose(parent, child, atol=1e-9)


@pytest.mark.parametrize("view", ["projection", "section"])
def test_ellipses_have_the_numbers_of_the_report(plot, view):
    r = cy.load("five-bar")
    report = r.manipulability(actuated=["q2", "q4"])
    centre = r.fk(r.home, frame=r.reference)[:2, 3]
    for spectrum in (report.kinematic, report.active_force, report.passive_force):
        ax = plot.ellipsoid(spectrum, centre, scale=0.1, view=view)
        expected = spectrum.ellipsoid("x,y", view)
        axes, centres = drawn_axes(ax)
        if axes.size:
            np.testing.assert_allclose(square(axes), 0.01 * square(expected.semi_axes), atol=1e-14)
            np.testing.assert_allclose(centres, [centre] * len(centres), atol=1e-12)
        state = "rz free" if view == "projection" else "rz zero"
        assert f"{spectrum.quantity} ({view}: {state})" in [
            text.get_text() for text in ax.get_legend().get_texts()
        ]
    # The projection of the velocities is the task, with the numbers of its table.
    task = r.manipulability(actuated=["q2", "q4"], task="x,y")
    sizes = np.linalg.norm(report.kinematic.ellipsoid("x,y").semi_axes, axis=0)
    np.testing.assert_allclose(sizes**2, task.kinematic.finite, rtol=1e-12)
    forces = np.linalg.norm(report.passive_force.ellipsoid("x,y", "section").semi_axes, axis=0)
    np.testing.assert_allclose(forces**2, task.passive_force.finite, rtol=1e-12)


@pytest.mark.parametrize("view", ["projection", "section"])
def test_ellipsoids_in_space(plot, view):
    r = cy.load("panda")
    q = r.home + 0.2
    J = r.jacobian(q)
    # J J^T and its Schur complement.
    whole = J @ J.T
    expected = {
        "projection": whole[:3, :3],
        "section": whole[:3, :3] - whole[:3, 3:] @ np.linalg.solve(whole[3:, 3:], whole[3:, :3]),
    }[view]
    centre = r.fk(q)[:3, 3]
    ax = plot.ellipsoid(r.manipulability(q).kinematic, centre, scale=0.5, view=view)
    axes, centres = drawn_axes(ax)
    np.testing.assert_allclose(square(axes), 0.25 * expected, atol=1e-12)
    np.testing.assert_allclose(centres, [centre] * 3, atol=1e-12)
    surface = faces_of(ax.collections[-1]).reshape(-1, 3).T - centre[:, None]
    levels = np.einsum("in,ij,jn->n", surface, np.linalg.inv(0.25 * expected), surface)
    np.testing.assert_allclose(levels, 1, atol=1e-9)
    angular = plot.ellipsoid(r.manipulability(q).kinematic, components="angular")
    assert angular.get_xlabel() == "rx (rad/s)" and angular.get_zlabel() == "rz (rad/s)"


def test_unbounded_directions_are_strips(plot, tmp_path):
    r = cy.load("five-bar")
    spectrum = r.manipulability(actuated=["q1"]).kinematic
    assert spectrum.infinite == 1
    ax = plot.ellipsoid(spectrum)
    seen = spectrum.ellipsoid("x,y")
    (strip,) = ax.patches
    corners = strip.get_xy()[:4]
    across = seen.semi_axes[:, 0]
    assert abs(across @ seen.unbounded[0]) < 1e-12
    np.testing.assert_allclose(
        sorted(corners @ across), np.array([-1, -1, 1, 1]) * (across @ across), atol=1e-9
    )
    ax.figure.savefig(tmp_path / "strip.png")
    bar = cy.load("stewart").manipulability(actuated=["leg1", "leg2", "leg3", "leg4"])
    for view in ("projection", "section"):
        plot.ellipsoid(bar.kinematic, view=view).figure.savefig(tmp_path / "tube.png")


def test_angles_are_labelled_as_angles(plot):
    r = cy.load("five-bar")
    ax = plot.ellipsoid(r.manipulability(task="x,rz").kinematic)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x (m/s)", "rz (rad/s)")
    ax = plot.ellipsoid(r.manipulability(task="y,rz").passive_force)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("y (N)", "rz (N m)")
    for wrong in ({"components": "x"}, {"components": "x,y,rz,x"}):
        with pytest.raises(ValueError, match="two or three"):
            plot.ellipsoid(r.manipulability().kinematic, **wrong)
    with pytest.raises(cy.UnknownNameError, match="section"):
        plot.ellipsoid(r.manipulability().kinematic, view="sections")
    with pytest.raises(cy.UnknownNameError, match="rz"):
        r.manipulability().kinematic.ellipsoid("x,ry")


def test_conics_of_a_three_system(plot, tmp_path):
    pitches = [0.3, 0.1, -0.2]
    twists = np.vstack([np.diag(pitches), np.eye(3)])
    system = cy.ScrewSystem(twists)
    lines = np.array([[0.0, 0, 0, 0, 0, 1], [0, 0.5, 0, 1, 0, 0], [0, 0, -0.5, 0, 1, 0]]).T
    ax = plot.conics(system, twists=twists @ [[1, 1], [0.5, -0.2], [0.4, 0.7]], names=["a", "b"])
    ax.figure.savefig(tmp_path / "conics.png")
    conics = system.pitch_conics()
    corners = np.array([[0, 1], [-np.sqrt(0.75), -0.5], [np.sqrt(0.75), -0.5]])
    seen = set()
    for line in ax.lines:
        label = line.get_label()
        if "h = " not in label:
            continue
        h = float(label.split("h = ")[1])
        points = line.get_xydata()
        points = points[np.isfinite(points).all(1)]
        # Barycentric coordinates back to homogeneous ones, and to their pitch.
        x = np.linalg.solve(np.vstack([corners.T, np.ones(3)]), np.vstack([points.T, np.ones(len(points))]))
        pitch = np.einsum("in,ij,jn->n", x, conics.klein, x) / np.einsum("in,ij,jn->n", x, conics.angular, x)
        np.testing.assert_allclose(pitch, h, atol=1e-6)
        seen.add((round(h, 6), "principal" in label))
    assert {(h, True) for h in pitches} <= seen and len(seen) > 10
    assert {"a", "b", "h = 0.3", "h = 0.1", "h = -0.2"} == {text.get_text() for text in ax.texts}
    assert "three" in plot.conics.__doc__ and cy.ScrewSystem(lines).rank == 3
    with pytest.raises(ValueError, match="order 2"):
        plot.conics(cy.ScrewSystem(twists[:, :2]))
    for other in (np.eye(6)[:, :3], np.eye(6)[:, 3:], np.eye(6)[:, [0, 1, 5]], np.eye(6)[:, [0, 3, 4]]):
        plot.conics(cy.ScrewSystem(other))


def test_contacts_and_held_bodies_are_drawn(plot):
    r = cy.load("two-arm")
    assert r.contact_links == [("left/flange", "box"), ("right/flange", "box")]
    points = r.contact_points(r.home)
    assert r.contact_points([r.home] * 3).shape == (3, 2, 2, 3)
    np.testing.assert_allclose(points[:, 0], points[:, 1], atol=1e-9)
    assert cy.load("five-bar").contact_points(cy.load("five-bar").home).shape == (0, 2, 3)
    ax = plot.mechanism(r)
    (diamonds,) = (c for c in ax.collections if c.get_label() == "_contacts")
    np.testing.assert_allclose(np.transpose(diamonds._offsets3d), points[:, 1], atol=1e-12)
    (body,) = (line for line in ax.lines if line.get_label() == "_box")
    np.testing.assert_allclose(np.transpose(body.get_data_3d()), points[:, 1], atol=1e-12)


def three_fingers(dimension):
    text = f'name = "hand"\ndimension = {dimension}\nreference = "disc"\n'
    for i, turn in enumerate(np.deg2rad([90, 210, 330])):
        at = [float(np.cos(turn)), float(np.sin(turn)), 0.0][:dimension]
        text += f"""
[[joint]]
name = "push{i}"
type = "prismatic"
between = ["ground", "finger{i}"]
origin = {[2 * x for x in at]}
axis = {[-x for x in at]}
actuated = true
[[contact]]
name = "tip{i}"
type = "hard_finger"
between = ["finger{i}", "disc"]
point = {at}
normal = {[-x for x in at]}
"""
    return cy.parse(text, "toml")


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_held_body_is_filled_between_its_contacts(plot, dimension):
    r = three_fingers(dimension)
    ax = plot.mechanism(r)
    if dimension == 2:
        (polygon,) = ax.patches
        corners = polygon.get_xy()
    else:
        (body,) = (c for c in ax.collections if type(c).__name__ == "Poly3DCollection")
        corners = np.squeeze(faces_of(body))
    expected = r.contact_points(r.home)[:, 1, :dimension]
    assert {tuple(c) for c in corners.round(12)} == {tuple(c) for c in expected.round(12)}
    assert not [line for line in ax.lines if line.get_label() == "_disc" and line.get_linewidth() < 5]
    # Each finger reaches from its joint to its contact.
    for i, contact in enumerate(expected):
        (finger,) = (line for line in ax.lines if line.get_label() == f"_finger{i}")
        ends = np.transpose(finger.get_data_3d() if dimension == 3 else finger.get_data())
        np.testing.assert_allclose(ends, [2 * contact, contact], atol=1e-12)


def test_maps_are_slices_clouds_and_histograms(plot, tmp_path):
    across, up = np.meshgrid(np.linspace(-1, 1, 7), np.linspace(0, 2, 5))
    order = np.random.default_rng(3).permutation(across.size)
    columns = {"q1": across.ravel()[order], "q2": up.ravel()[order]}
    columns["w"] = columns["q1"] + 0.25
    columns["w"][0] = np.inf
    ax = plot.map(columns, "w", "q1", "q2")
    mesh = ax.collections[0]
    drawn = np.asarray(mesh.get_array()).reshape(5, 7)
    expected = np.tile(np.linspace(-1, 1, 7) + 0.25, (5, 1))
    finite = ~np.ma.getmaskarray(mesh.get_array()).reshape(5, 7)
    assert finite.sum() == 34
    np.testing.assert_allclose(drawn[finite], expected[finite], atol=1e-15)
    # The line on which it is zero, at q1 = -0.25.
    line = np.concatenate([p.vertices for p in ax.collections[-1].get_paths()])
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("q1", "q2")
    assert len(line) and np.abs(line[:, 0] + 0.25).max() < 1e-12

    found = cy.sweep(cy.load("panda"), samples=500, quantities=["pose", "yoshikawa"])
    cloud = plot.map(found, "yoshikawa", z="z")
    assert cloud.get_zlabel() == "z (m)"
    points = np.column_stack(cloud.collections[0]._offsets3d)
    np.testing.assert_array_equal(points, np.column_stack([found[c] for c in "xyz"]))
    flat = plot.map(found, "yoshikawa", log=True)
    np.testing.assert_array_equal(flat.collections[0].get_array(), found["yoshikawa"])
    bars = plot.map(found, x="yoshikawa", y=None)
    assert sum(bar.get_height() for bar in bars.patches) == 500
    cloud.figure.savefig(tmp_path / "cloud.png")

    for more, message in [
        (("volume",), "no column 'volume'; the columns are index"),
        (("yoshikawa", "x", None, "z"), "z needs y"),
        (("yoshikawa", "x", "y", "z", flat), "projection='3d'"),
        (("yoshikawa", "x", "y", None, cloud), "of a plane"),
    ]:
        with pytest.raises(ValueError, match=message):
            plot.map(found, *more)
    with pytest.raises(ValueError, match="one length"):
        plot.map({"x": [1.0], "y": [1.0, 2.0]})
