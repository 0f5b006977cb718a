"""Figures of the book that the command line does not draw: `cargo xtask figures`."""

import pathlib
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import MaxNLocator

import cylindroid as cy
from cylindroid import plot

OUT = pathlib.Path(sys.argv[1])
GRASP = pathlib.Path(sys.argv[2])
plt.rcParams |= {
    "svg.fonttype": "none",
    "svg.hashsalt": "cylindroid",  # the same file for the same figure
    "font.family": "sans-serif",
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.facecolor": "white",
}
BLUE, ORANGE, GREEN, GREY = "#0072b2", "#d55e00", "#009e73", "#888888"


def save(figure, name):
    figure.savefig(OUT / name, dpi=200, bbox_inches="tight", metadata={"Date": None})
    plt.close(figure)


def space(figure, place=111):
    ax = figure.add_subplot(place, projection="3d")
    ax.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
    ax.view_init(elev=18, azim=-60)
    return ax


def chain(robot, q):
    """Positions of the links' frames, from the base to the tool."""
    poses = dict(zip(robot.frames, robot.fk_all(q)))
    points = [poses[joint.child][:3, 3] for joint in robot.joints if joint.child in poses]
    return np.array([np.zeros(3), *points, robot.fk(q)[:3, 3]])


def arm(ax, robot, q, colour, width=3.0, **more):
    ax.plot(*chain(robot, q).T, "-", color=colour, lw=width, solid_capstyle="round", **more)
    ax.plot(*chain(robot, q)[:-1].T, "o", color=colour, ms=1.6 * width, mec="white", mew=0.5)


def equal(ax, low, high):
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    ax.set_box_aspect(np.subtract(high, low))


def panda():
    robot = cy.load("panda")
    figure = plt.figure(figsize=(6, 5))
    ax = space(figure)
    arm(ax, robot, robot.home, GREY)
    tool = robot.fk(robot.home)
    plot.frame(np.eye(4), ax, size=0.2)
    plot.frame(tool, ax, size=0.12)
    ax.text(-0.2, 0, 0.02, "world")
    ax.text(*tool[:3, 3] + [0.16, 0, -0.03], "tool")
    report = robot.manipulability(robot.home, task="x,y,z")
    plot.ellipsoid(report.kinematic, tool[:3, 3], ax, scale=0.25)
    equal(ax, (-0.25, -0.35, 0), (0.65, 0.35, 0.75))
    ax.set(xlabel="x [m]", zlabel="z [m]")
    ax.set_ylabel("y [m]", labelpad=10)
    for surface in ax.collections:
        surface.set_rasterized(True)
    for axis in (ax.xaxis, ax.yaxis, ax.zaxis):
        axis.set_major_locator(MaxNLocator(4))
    save(figure, "panda.svg")


def ik():
    robot = cy.load("ur5e")
    target = np.eye(4)
    target[:3, :3] = np.diag([1.0, -1.0, -1.0])
    target[:3, 3] = 0.3, 0.4, 0.5
    every = robot.ik_all(target, count=8, q0=robot.home)
    figure = plt.figure(figsize=(9, 4.6))
    for i, q in enumerate(every):
        ax = figure.add_subplot(2, 4, i + 1, projection="3d")
        ax.view_init(elev=18, azim=-60)
        arm(ax, robot, q, [BLUE, ORANGE][i % 2], 2.2)
        plot.frame(target, ax, size=0.18)
        equal(ax, (-0.3, -0.3, 0), (0.8, 0.8, 0.95))
        ax.set(xticklabels=[], yticklabels=[], zticklabels=[], xlabel="", ylabel="", zlabel="")
        ax.set_title(f"{i + 1}", fontsize=9, pad=-4)
    figure.subplots_adjust(wspace=0, hspace=0.05)
    save(figure, "ik-ur5e.svg")


# Joints of the five-bar at home: on the ground, between the links, on the ground.
FIVE_BAR = np.array([[0, 0], [0, 2], [1, 2], [2, 1], [2, 0]], float)


def five_bar_points(q):
    """Where q takes the joints: each rotates all that follow it."""
    points, angle = [FIVE_BAR[0]], 0.0
    for k in range(4):
        angle += q[k]
        c, s = np.cos(angle), np.sin(angle)
        points.append(points[-1] + np.array([[c, -s], [s, c]]) @ (FIVE_BAR[k + 1] - FIVE_BAR[k]))
    return np.array(points)


def five_bar():
    linkage = cy.load("five-bar")
    modes = linkage.assembly_modes(hold=["q1", "q2"]).modes
    figure, axes = plt.subplots(1, len(modes), figsize=(3.6 * len(modes), 3.6), sharey=True)
    for i, (ax, mode) in enumerate(zip(axes, modes)):
        points = five_bar_points(mode.q)
        assert np.abs(points[-1] - FIVE_BAR[-1]).max() < 1e-8, "the loop closes"
        for k, colour in enumerate([ORANGE, ORANGE, BLUE, BLUE]):
            ax.plot(*points[k : k + 2].T, "-", color=colour, lw=4, solid_capstyle="round")
        ax.plot(*points.T, "o", color="white", mec="black", ms=7)
        for k, (x, y) in enumerate(points):
            ax.annotate(f"q{k + 1}", (x, y), (7, 5), textcoords="offset points")
        ax.plot([-0.3, 2.3], [-0.08, -0.08], color=GREY, lw=1)
        ax.set(aspect="equal", xlabel="x [m]")
        ax.set_title(f"assembly mode {i + 1}", pad=14)
    axes[0].set_ylabel("y [m]")
    save(figure, "five-bar.svg")


def statics():
    linkage = cy.load("five-bar")
    points = five_bar_points(linkage.home)
    wrench = np.array([3.0, -1.0, 0.2])
    torques = linkage.constraint(linkage.home).joint_torques(wrench).torques
    figure, ax = plt.subplots(figsize=(5, 4))
    for k, colour in enumerate([ORANGE, ORANGE, BLUE, BLUE]):
        ax.plot(*points[k : k + 2].T, "-", color=colour, lw=4, solid_capstyle="round")
    ax.plot(*points.T, "o", color="white", mec="black", ms=7)
    at = linkage.fk(linkage.home, linkage.reference)[:2, 3]
    ax.annotate("", at + 0.3 * wrench[:2], at, arrowprops={"arrowstyle": "-|>", "color": GREEN, "lw": 2})
    ax.annotate("f = (3, -1) N, m = 0.2 N m", at + [0.35, 0.32], color=GREEN)
    for k, torque in enumerate(torques):
        ax.annotate(f"torque of q{k + 1}: {torque:.2g} N m", points[k], (-8, 14) if k else (12, 10),
                    textcoords="offset points")
    ax.plot([-0.3, 2.3], [-0.08, -0.08], color=GREY, lw=1)
    ax.set(aspect="equal", xlim=(-0.4, 2.7), ylim=(-0.2, 2.5), xlabel="x [m]", ylabel="y [m]")
    save(figure, "statics.svg")


def grasp():
    hand = cy.load(str(GRASP))
    q = hand.home
    figure, ax = plt.subplots(figsize=(4.2, 4))
    ax.add_patch(plt.Circle((0, 0), 0.05, color="#dddddd"))
    half = np.arctan(0.5)
    for degrees, name in zip((0, 120, 240), hand.contacts):
        out = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
        point = 0.05 * out
        edges = []
        for side in (-half, half):
            c, s = np.cos(side), np.sin(side)
            edges.append(point + 0.035 * (np.array([[c, -s], [s, c]]) @ -out))
        ax.add_patch(plt.Polygon([point, *edges], color=BLUE, alpha=0.35))
        ax.annotate("", point, point + 0.03 * out, arrowprops={"arrowstyle": "-|>", "color": ORANGE, "lw": 2})
        ax.annotate(name, point + 0.036 * out, ha="left" if out[0] > 0.9 else "center", va="center")
    ax.set(aspect="equal", xlim=(-0.08, 0.11), ylim=(-0.09, 0.09), xlabel="x [m]", ylabel="y [m]")
    closed = hand.grasp_quality(q, torsion=0.01)
    closure = "force closure" if closed.closed else "no force closure"
    ax.set_title(f"{closure}, friction cones of half angle arctan 0.5", fontsize=10)
    save(figure, "grasp.svg")


def gains():
    sigma = np.geomspace(1e-3, 1, 200)
    figure, ax = plt.subplots(figsize=(6.4, 3.4))
    styles = {
        "truncated": {"eps": 0.03},
        "damped": {"damping": 0.05},
        "variable-damping": {"onset": 0.1, "damping": 0.05},
        "singular-value-filtering": {"shape": 10.0, "floor": 0.05},
    }
    ax.plot(sigma, 1 / sigma, color=GREY, lw=1, ls="--", label="1/σ")
    for (method, options), colour in zip(styles.items(), (ORANGE, BLUE, GREEN, "#cc79a7")):
        J = np.array([np.diag([1.0, s]) for s in sigma])
        inverse = cy.inverse(J, method, **options)
        label = method + ", " + ", ".join(f"{k} {v:g}" for k, v in options.items())
        ax.plot(sigma, inverse.matrix[:, 1, 1], color=colour, label=label)
    ax.set(xscale="log", ylim=(0, 40), xlabel="singular value σ (the largest is 1)", ylabel="gain")
    ax.legend(frameon=False, fontsize=9, ncols=2, loc="upper center", bbox_to_anchor=(0.5, -0.2))
    save(figure, "gains.svg")


for draw in (panda, ik, five_bar, statics, grasp, gains):
    draw()
