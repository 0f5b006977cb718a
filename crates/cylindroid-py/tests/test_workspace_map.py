"""Maps: columns of working modes, loci, what is held, bad input."""

import signal
import threading
import time

import numpy as np
import pytest

import cylindroid as cy

OVER = {"x": (-1.03, 3.01, 15), "y": (-0.51, 3.07, 15)}


@pytest.fixture(scope="module")
def found():
    return cy.workspace_map(cy.load("five-bar"), OVER, starts=32)


def test_columns_and_loci(found):
    robot = cy.load("five-bar")
    assert list(found.axes) == ["x", "y"] and found.held == {} and found.free_motions == 0
    assert found.signed == (True, True) and len(found.modes) == 4
    for mode in found.modes:
        reached = np.isfinite(mode["q1"])
        assert reached.sum() > 20 and len(mode["x"]) == 225
        q = np.stack([mode[name] for name in robot.joint_names], axis=1)[reached]
        at = robot.fk(q, "reference")[:, :2, 3]
        assert np.abs(at - np.stack([mode["x"], mode["y"]], axis=1)[reached]).max() < 1e-9
    assert {"type I", "passive"} <= {locus["kind"] for locus in found.loci}
    for locus in found.loci:
        count = len(locus["points"])
        assert locus["points"].shape == (count, 2) and locus["q"].shape == (count, 4)
        # Crank 2 and coupler 1, rocker 1 and rod sqrt(2).
        x, y = locus["points"].T
        left, right = np.hypot(x, y), np.hypot(x - 2, y)
        root = 2**0.5
        near = [abs(left - 1), abs(left - 3), abs(right - root + 1), abs(right - root - 1)]
        assert np.min(near, axis=0).max() < 1e-8
    assert "4 modes" in repr(found)


def test_threads_change_nothing(found):
    for threads in (1, 3):
        again = cy.workspace_map(cy.load("five-bar"), OVER, starts=32, threads=threads)
        assert len(again.modes) == len(found.modes) and len(again.loci) == len(found.loci)
        for mode, other in zip(again.modes, found.modes):
            assert all(np.array_equal(mode[name], other[name], equal_nan=True) for name in other)
        for locus, other in zip(again.loci, found.loci):
            assert np.array_equal(locus["q"], other["q"]) and locus["modes"] == other["modes"]


def test_interrupts_end_a_map():
    """Soon, not after a minute."""
    over = {"x": (-1.03, 3.01, 900), "y": (-2.51, 2.57, 900)}
    timer = threading.Timer(1.0, signal.raise_signal, [signal.SIGINT])
    began = time.monotonic()
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            cy.workspace_map(cy.load("five-bar"), over, threads=1)
    finally:
        timer.cancel()
    assert time.monotonic() - began < 30


def test_workspaces_have_sizes_and_holes(found):
    assert found.size_unit == "m^2"
    whole, cell = found.workspace(), 4.04 / 14 * 3.58 / 14
    reached = np.any([np.isfinite(mode["q1"]) for mode in found.modes], axis=0)
    assert whole["cells"] == reached.sum() and abs(whole["size"] - reached.sum() * cell) < 1e-12
    assert whole["is_cut"] and all(found.workspace(i)["cells"] <= whole["cells"] for i in range(4))
    # The disc about the second pivot, of radius sqrt(2) - 1.
    wide = cy.workspace_map(
        cy.load("five-bar"), {"x": (-1.03, 3.51, 61), "y": (-2.61, 2.57, 61)}, loci=False
    ).workspace()
    (hole,) = wide["holes"]
    assert np.hypot(*(hole["center"] - [2, 0])) < 0.03 and not wide["is_cut"]
    assert abs(hole["size"] / (np.pi * (2**0.5 - 1) ** 2) - 1) < 0.05
    with pytest.raises(cy.InvalidOptionError, match="mode = 4 .*the map has 4 modes, from 0 on"):
        found.workspace(4)


def test_surfaces_of_three_axes():
    robot = cy.load("3rrr")
    over = {"x": (-0.31, 0.29, 7), "y": (-0.29, 0.33, 7), "rz": (-1.57, 1.53, 9)}
    found = cy.workspace_map(robot, over, starts=16)
    assert found.loci == [] and found.surfaces
    assert repr(found).endswith(f"{len(found.modes)} modes, {len(found.surfaces)} surfaces)")
    for surface in found.surfaces:
        assert surface["kind"] in ("type II", "passive") and surface["mode"] < len(found.modes)
        vertices, triangles, q = surface["vertices"], surface["triangles"], surface["q"]
        assert vertices.shape == (len(q), 3) and q.shape[1] == robot.n
        assert triangles.shape[1] == 3 and set(triangles.ravel()) == set(range(len(q)))
        pose = robot.fk(q, robot.reference)
        assert np.abs(pose[:, :2, 3] - vertices[:, :2]).max() < 1e-9
        # A side has two triangles, which have it in reverse directions, or it is at the end.
        sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
        once = {(int(a), int(b)) for a, b in sides}
        assert len(once) == len(sides)
        assert surface["closed"] == all((b, a) in once for a, b in once)
    again = cy.workspace_map(robot, over, starts=16, threads=1)
    for a, b in zip(found.surfaces, again.surfaces, strict=True):
        assert all(np.array_equal(a[name], b[name]) for name in ("vertices", "triangles", "q"))
    assert cy.workspace_map(robot, over, starts=2, loci=False).surfaces == []


def test_components_are_held_or_free():
    stewart = cy.load("stewart")
    over = {"x": (-0.1, 0.1, 3), "y": (-0.1, 0.1, 3)}
    found = cy.workspace_map(stewart, over, at={"z": 1.05}, free=["yaw"], loci=False, starts=4)
    assert found.free_motions == 1 and found.held["z"] == 1.05 and "yaw" not in found.held
    assert found.loci == []
    found = cy.workspace_map(stewart, over, frame="platform", q=stewart.home, starts=1, seed=3)
    assert found.free_motions == 0 and list(found.held)[0] == "z"


def test_input_is_checked():
    robot = cy.load("five-bar")
    good = {"x": (0, 1, 3)}
    for call, kind in [
        (lambda: cy.workspace_map(robot, {}), cy.InvalidOptionError),
        (lambda: cy.workspace_map(robot, {"w": (0, 1, 3)}), cy.UnknownNameError),
        (lambda: cy.workspace_map(robot, {"x": (1, 0, 3)}), cy.InvalidOptionError),
        (lambda: cy.workspace_map(robot, {"x": (0, np.nan, 3)}), cy.NotFiniteError),
        (lambda: cy.workspace_map(robot, good, at={"x": 1.0}), cy.InvalidOptionError),
        (lambda: cy.workspace_map(robot, good, free=["x"]), cy.InvalidOptionError),
        (lambda: cy.workspace_map(robot, good, q=[0.0]), cy.DimensionError),
        (lambda: cy.workspace_map(robot, good, starts=0), cy.InvalidOptionError),
        (lambda: cy.workspace_map(robot, good, threads=0), cy.InvalidOptionError),
    ]:
        with pytest.raises(kind):
            call()


def test_a_mode_is_drawn(found):
    pytest.importorskip("matplotlib")
    from cylindroid import plot

    ax = plot.map(found, mode=1)
    assert ax.get_xlabel() == "x (m)" and len(ax.get_lines()) >= 1
    with pytest.raises(ValueError, match="mode"):
        plot.map(found, mode=9)
    line = cy.workspace_map(cy.load("five-bar"), {"x": (0.5, 1.5, 3)}, at={"y": 1.5})
    with pytest.raises(ValueError, match="axes"):
        plot.map(line)


def test_slices_of_three_axes():
    pytest.importorskip("matplotlib")
    from cylindroid import plot

    over = {"x": (-0.31, 0.29, 7), "y": (-0.29, 0.33, 7), "rz": (-1.57, 1.53, 9)}
    found = cy.workspace_map(cy.load("3rrr"), over, starts=16)
    drawn = 0
    for mode in range(len(found.modes)):
        for place in range(9):
            sections = found.section(mode, place)
            assert all(segments.shape[1:] == (2, 2) for segments in sections.values())
            drawn += sum(len(segments) for segments in sections.values())
    assert drawn > 20
    mode = found.surfaces[0]["mode"]
    place = next(place for place in range(9) if found.section(mode, place))
    ax = plot.map(found, mode=mode, place=place)
    value = np.linspace(-1.57, 1.53, 9)[place]
    assert ax.get_title() == f"rz = {value:.4g}" and ax.get_legend() is not None
    assert plot.map(found).get_title() == f"rz = {-0.02:.4g}"
    with pytest.raises(ValueError, match="place is 9"):
        plot.map(found, place=9)
    with pytest.raises(cy.InvalidOptionError, match="'rz' has 9 values"):
        found.section(0, 9)
    with pytest.raises(cy.InvalidOptionError, match="modes"):
        found.section(99, 0)
