"""Plots and the Toolbox's names: what is drawn is what was computed."""

import matplotlib
import numpy as np
import pytest
from matplotlib.transforms import Bbox
from mpl_toolkits.mplot3d.proj3d import proj_transform

import cylindroid as cy
from cylindroid.rtb import Robot


@pytest.fixture
def plot():
    matplotlib.use("Agg")
    from cylindroid import plot

    yield plot
    matplotlib.pyplot.close("all")


def test_ellipsoids(plot, tmp_path):
    r = cy.load("panda")
    q = r.home
    for report in (r.manipulability(q, task="x,y,z"), r.manipulability(q)):
        for spectrum in (report.kinematic, report.active_force, report.passive_force):
            ax = plot.ellipsoid(spectrum, r.fk(q)[:3, 3], scale=0.1)
    ax.figure.savefig(tmp_path / "ellipsoid.png")
    flat = plot.ellipsoid(r.manipulability(q, task="x,z").kinematic)
    outline = np.array(flat.lines[0].get_data())
    k = r.manipulability(q, task="x,z").kinematic
    sizes = np.linalg.norm(outline, axis=0)
    assert abs(sizes.max() ** 2 / k.finite[0] - 1) < 1e-2
    assert abs(sizes.min() ** 2 / k.finite[1] - 1) < 1e-2
    with pytest.raises(ValueError, match="cannot be drawn"):
        plot.ellipsoid(r.manipulability(q, task="x").kinematic)
    with pytest.raises(ValueError, match="3d"):
        plot.ellipsoid(r.manipulability(q).kinematic, ax=flat)


def test_the_rest_is_drawn(plot, tmp_path):
    r = cy.load("youbot")
    ax = plot.mechanism(r)
    J = r.jacobian(r.home, reference="world")
    plot.screws([cy.Screw(t) for t in J.T], ax, names=r.joint_names)
    plot.screws([cy.Screw([1, 0, 0, 0, 0, 0])])
    plot.frame(r.fk(r.home), name="tool")
    two = cy.ScrewSystem(J[:, :2])
    drawn = plot.cylindroid(two, count=10)
    assert len(drawn.lines) == 10 and "pitches" in drawn.get_title()
    drawn.figure.savefig(tmp_path / "cylindroid.png")
    with pytest.raises(ValueError, match="order 5"):
        plot.cylindroid(cy.ScrewSystem(J))
    panda = cy.load("panda")
    target = panda.fk(panda.home)
    target[2, 3] -= 0.05
    way = cy.Servo(panda).simulate(panda.home, target, record=True).trajectory
    axes = plot.trajectory(way, panda.joint_names)
    assert len(axes) == 4 and len(axes[0].lines) == 7
    axes[0].figure.savefig(tmp_path / "way.png")


def box_of(ax, text):
    """A label of 3-D axes as drawn: its extent, where it is projected to."""
    extent = text.get_window_extent()
    x, y, _ = proj_transform(*text.get_position_3d(), ax.get_proj())
    x, y = ax.transData.transform((x, y))
    return Bbox.from_bounds(x, y, extent.width, extent.height)


def test_labels_of_screws_do_not_overlap(plot):
    for model in ("panda", "ur5e", "youbot"):
        r = cy.load(model)
        ax = plot.screws([cy.Screw(t) for t in r.jacobian(r.home, reference="world").T])
        ax.figure.canvas.draw()
        boxes = [box_of(ax, text) for text in ax.texts]
        assert len(boxes) == r.n
        for i, a in enumerate(boxes):
            for b in boxes[:i]:
                assert not a.overlaps(b), (model, ax.texts[i].get_text())
        assert not any("e-" in text.get_text() for text in ax.texts)


def test_planar_mechanisms_are_drawn_in_the_plane(plot, tmp_path):
    r = cy.load("five-bar")
    q = r.home
    ax = plot.mechanism(r)
    assert r.dimension == 2 and not hasattr(ax, "plot_surface")
    J = r.jacobian(q, reference="world")
    twists = [t for t in J.T if t.any()]
    plot.screws([cy.Screw(t) for t in twists], ax)
    points = [line.get_xydata()[0] for line in ax.lines if line.get_marker() == "o"]
    centres = [np.array([-t[1], t[0]]) / t[5] for t in twists]
    np.testing.assert_allclose(points, centres, atol=1e-12)
    plot.screws([cy.Screw([0, 2, 0, 0, 0, 0])], ax, names=["slide"])
    assert ax.texts[-1].get_text() == "slide: translation"
    plot.ellipsoid(r.manipulability(q, task="x,y").kinematic, r.fk(q)[:2, 3], ax, scale=0.1)
    ax.figure.savefig(tmp_path / "plane.png")
    with pytest.raises(ValueError, match="leaves the plane"):
        plot.screws([cy.Screw([0, 0, 0, 1, 0, 0])], ax)
    assert hasattr(plot.mechanism(r, ax=plot.frame(np.eye(4))), "plot_surface")


def test_toolbox_names():
    r = cy.load("panda")
    robot = Robot(r)
    q = r.home + 0.2
    assert (robot.n, robot.name, robot.qlim.shape) == (7, "panda", (2, 7))
    np.testing.assert_array_equal(robot.fkine(q), r.fk(q))
    np.testing.assert_array_equal(robot.jacob0(q), r.jacobian(q))
    R = r.fk(q)[:3, :3]
    np.testing.assert_allclose(robot.jacobe(q), np.kron(np.eye(2), R.T) @ robot.jacob0(q), atol=1e-14)
    np.testing.assert_array_equal(robot.hessian0(q), r.hessian(q))
    J = robot.jacob0(q)
    for axes, rows in [("all", slice(0, 6)), ("trans", slice(0, 3)), ("rot", slice(3, 6)),
                       ([1, 0, 1, 0, 0, 0], [0, 2])]:
        s = np.linalg.svd(J[rows], compute_uv=False)
        assert abs(robot.manipulability(q, axes=axes) - s.prod()) < 1e-9
        assert abs(robot.manipulability(q, method="invcondition", axes=axes) - s[-1] / s[0]) < 1e-9
    many = robot.manipulability(np.array([q, q + 0.1]))
    assert many.shape == (2,) and abs(many[0] - robot.manipulability(q)) < 1e-12
    singular = Robot("ur5e")
    assert singular.manipulability([0.0, -0.6, 0.0, 0.4, 1.0, 0.0]) == 0.0
    assert Robot("3r").manipulability([0.1, 0.4, 0.5]) > 0
    for bad in ({"axes": "none"}, {"axes": [1, 2]}, {"method": "other"}):
        with pytest.raises(ValueError):
            robot.manipulability(q, **bad)


def test_toolbox_inverse_kinematics():
    robot = Robot("panda")
    target = robot.fkine(robot.qr + 0.2)
    found = robot.ikine_LM(target, q0=robot.qr, tol=1e-12)
    assert found.success and found.reason == "" and found.searches >= 1
    np.testing.assert_allclose(robot.fkine(found.q), target, atol=1e-5)
    assert found.residual <= 1e-12
    point = robot.ikine_LM(target, mask=[1, 1, 1, 0, 0, 0])
    assert point.success
    far = np.eye(4)
    far[0, 3] = 5
    lost = robot.ikine_LM(far, slimit=3)
    assert not lost.success and "out of reach" in lost.reason
