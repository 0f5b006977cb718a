"""Pictures with matplotlib (``pip install .[plot]``).

Every function draws into the axes that it is given, or makes new ones, and returns them; nothing
is shown or saved. It computes nothing: what it draws, the library has computed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import Mechanism, Screw, ScrewSystem, Spectrum, Trajectory

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["cylindroid", "ellipsoid", "frame", "mechanism", "screws", "trajectory"]


def _pyplot() -> Any:
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise ImportError(
            "plots need matplotlib: pip install matplotlib, or this package with [plot]"
        ) from error
    return pyplot


def _axes(ax: Any, space: bool) -> Any:
    """New axes where none are given; of given ones the dimension is checked."""
    if ax is None:
        figure = _pyplot().figure()
        ax = figure.add_subplot(projection="3d" if space else None)
    elif space and not hasattr(ax, "plot_surface"):
        raise ValueError("this picture is spatial: give axes made with projection='3d'")
    ax.set_aspect("equal", adjustable="datalim") if not space else None
    return ax


def _equal(ax: Any) -> None:
    """The same scale on all three axes."""
    limits = np.array([ax.get_xlim(), ax.get_ylim(), ax.get_zlim()])
    middle, half = limits.mean(1), 0.5 * np.ptp(limits, axis=1).max()
    ax.set(
        xlim=(middle[0] - half, middle[0] + half),
        ylim=(middle[1] - half, middle[1] + half),
        zlim=(middle[2] - half, middle[2] + half),
        xlabel="x (m)",
        ylabel="y (m)",
        zlabel="z (m)",
    )
    ax.set_box_aspect((1, 1, 1))


def frame(pose: ArrayLike, ax: Any = None, size: float = 0.1, name: str | None = None) -> Any:
    """The axes of a pose: x red, y green, z blue.

    Parameters
    ----------
    pose : array_like, (4, 4)
        (m)
    ax : matplotlib 3-D axes, optional
    size : float
        Length of the arrows (m).
    name : str, optional
        Written at the origin.

    Returns
    -------
    The axes.
    """
    T = np.asarray(pose, dtype=float)
    ax = _axes(ax, space=True)
    for i, colour in enumerate(("tab:red", "tab:green", "tab:blue")):
        ax.quiver(*T[:3, 3], *(size * T[:3, i]), color=colour)
    if name is not None:
        ax.text(*T[:3, 3], name)
    _equal(ax)
    return ax


def mechanism(robot: Mechanism, q: ArrayLike | None = None, ax: Any = None) -> Any:
    """Links as lines between the frames of joints, and the tool.

    Parameters
    ----------
    robot : Mechanism
    q : array_like, (n,), optional
        Default: home.
    ax : matplotlib 3-D axes, optional

    Returns
    -------
    The axes.
    """
    ax = _axes(ax, space=True)
    poses = robot.fk_all(robot.home if q is None else q)
    at = dict(zip(robot.frames, poses[:, :3, 3]))
    for joint in robot.joints:
        ends = np.array([at[joint.parent], at[joint.child]])
        ax.plot(*ends.T, color="0.3", lw=3, solid_capstyle="round")
    moving = np.array([at[joint.child] for joint in robot.joints if joint.coordinates])
    if len(moving):
        ax.scatter(*moving.T, color="tab:orange", depthshade=False)
    return frame(poses[robot.frames.index(robot.tool)], ax, 0.1 * robot.reach)


def ellipsoid(
    spectrum: Spectrum,
    centre: ArrayLike | None = None,
    ax: Any = None,
    *,
    scale: float = 1.0,
    components: str = "linear",
    **style: Any,
) -> Any:
    """The ellipsoid of what comes out for an input of length one: of velocity, or of force.

    Take the spectrum of a task (``robot.manipulability(q, task="x,y,z").kinematic`` or
    ``.active_force``): an ellipse for two components, an ellipsoid for three. The axes are those of
    the world (the twist is taken at the reference frame's origin). Directions of zero efficiency
    make it flat; infinite ones are drawn as dashed lines.

    Parameters
    ----------
    spectrum : Spectrum
    centre : array_like, (2,) or (3,), optional
        Where it is drawn, mostly ``robot.fk(q)[:3, 3]`` (m).
    ax : matplotlib axes, optional
        3-D ones for three components.
    scale : float
        Metres in the picture for a unit of velocity or force.
    components : str
        'linear' or 'angular': which three of a whole twist or wrench are drawn.
    **style
        For matplotlib, as ``color``.

    Returns
    -------
    The axes.
    """
    axes = spectrum.semi_axes
    infinite = spectrum.infinite_directions.T
    d = axes.shape[0]
    if d == 6:
        rows = {"linear": slice(0, 3), "angular": slice(3, 6)}.get(components)
        if rows is None:
            raise ValueError(f"components = {components!r}: 'linear' or 'angular'")
        # The shadow of the ellipsoid in these components has the semi-axes of their block.
        u, s, _ = np.linalg.svd(axes[rows], full_matrices=False)
        axes, infinite, d = u * s, infinite[rows], 3
    if d not in (2, 3):
        raise ValueError(f"an ellipsoid of {d} components cannot be drawn: name two or three as task")
    ax = _axes(ax, space=d == 3)
    middle = np.zeros(d) if centre is None else np.asarray(centre, dtype=float)[:d]
    style = {"color": "tab:blue"} | style
    turn = np.linspace(0, 2 * np.pi, 73)
    if d == 2:
        ball = np.array([np.cos(turn), np.sin(turn)])
        outline = middle[:, None] + scale * axes @ ball[: axes.shape[1]]
        ax.plot(*outline, **style)
        ax.set(xlabel="x", ylabel="y")
    else:
        rise = np.linspace(0, np.pi, 37)[:, None]
        ball = np.array(
            [np.sin(rise) * np.cos(turn), np.sin(rise) * np.sin(turn), np.cos(rise) + 0 * turn]
        )
        surface = np.tensordot(scale * axes, ball[: axes.shape[1]], 1)
        ax.plot_surface(*(middle[:, None, None] + surface), **({"alpha": 0.3, "lw": 0} | style))
    for axis in axes.T:
        ends = middle[:, None] + scale * np.outer(axis, [-1, 1])
        ax.plot(*ends, color="0.2", lw=1)
    reach = 2 * scale * (np.linalg.norm(axes, axis=0).max() if axes.size else 1.0)
    for direction in infinite.T:
        size = np.linalg.norm(direction)
        if size > 0:
            ends = middle[:, None] + reach * np.outer(direction / size, [-1, 1])
            ax.plot(*ends, color="tab:red", lw=1, ls="--")
    if d == 3:
        _equal(ax)
    return ax


def screws(
    screws: list[Screw], ax: Any = None, *, length: float = 0.5, names: list[str] | None = None
) -> Any:
    """Screw axes, each with its pitch; translations as arrows at the origin.

    Parameters
    ----------
    screws : list of Screw
        Or of twists: ``[cy.Screw(t) for t in J.T]``.
    ax : matplotlib 3-D axes, optional
    length : float
        Of the lines (m).
    names : list of str, optional

    Returns
    -------
    The axes.
    """
    ax = _axes(ax, space=True)
    for i, screw in enumerate(screws):
        label = names[i] if names else f"{i + 1}"
        if screw.is_translation:
            ax.quiver(0, 0, 0, *(length * screw.direction), color="tab:green")
            ax.text(*(length * screw.direction), f"{label}: slides")
            continue
        ends = screw.point + np.outer([-0.5, 0.5], length * screw.direction)
        ax.plot(*ends.T, color="tab:blue")
        ax.text(*ends[1], f"{label}: h = {screw.pitch:.3g}")
    _equal(ax)
    return ax


def cylindroid(
    system: ScrewSystem, ax: Any = None, *, length: float | None = None, count: int = 60
) -> Any:
    """The ruled surface that carries the screws of a two-system, coloured by their pitch.

    Parameters
    ----------
    system : ScrewSystem
        Of order 2 with two principal screws (class IA).
    ax : matplotlib 3-D axes, optional
    length : float, optional
        Of the rulings (m). Default: three times the width of the surface.
    count : int
        Screws drawn.

    Returns
    -------
    The axes.
    """
    if system.gibson_hunt != "IA" or system.rank != 2:
        raise ValueError(
            f"a cylindroid carries the screws of a two-system of class IA; this one is of order "
            f"{system.rank} and class {system.gibson_hunt}"
        )
    ax = _axes(ax, space=True)
    first, second = (np.asarray(s.twist) for s in system.principal_screws)
    members = [
        Screw(np.cos(t) * first + np.sin(t) * second) for t in np.linspace(0, np.pi, count)
    ]
    high, low = system.principal_pitches
    length = 3 * (high - low) if length is None else length
    origin = system.canonical_pose[:3, 3]
    pyplot = _pyplot()
    for screw in members:
        foot = screw.point + screw.direction * (screw.direction @ (origin - screw.point))
        ends = foot + np.outer([-0.5, 0.5], length * screw.direction)
        share = (screw.pitch - low) / (high - low)
        ax.plot(*ends.T, color=pyplot.cm.viridis(share), lw=1)
    ax.set_title(f"pitches {low:.3g} to {high:.3g} m/rad")
    _equal(ax)
    return ax


def trajectory(
    way: Trajectory, names: list[str] | None = None, figure: Figure | None = None
) -> NDArray[Any]:
    """Joints, errors and singular value ratio over time.

    Parameters
    ----------
    way : Trajectory
        From ``servo.simulate(q, target, record=True).trajectory``.
    names : list of str, optional
        Of the joints.
    figure : matplotlib Figure, optional

    Returns
    -------
    ndarray of axes, (4,)
    """
    if figure is None:
        figure = _pyplot().figure(figsize=(7, 9), layout="constrained")
    ax: NDArray[Any] = figure.subplots(4, 1, sharex=True)
    ax[0].plot(way.time, way.q, label=names)
    ax[0].set_ylabel("q (rad or m)")
    ax[1].plot(way.time, way.joint_velocities)
    ax[1].set_ylabel("joint velocities (1/s)")
    ax[2].semilogy(way.time, np.maximum(way.position_error, 1e-16), label="position (m)")
    ax[2].semilogy(way.time, np.maximum(way.orientation_error, 1e-16), label="orientation (rad)")
    ax[2].set_ylabel("error")
    ax[2].legend()
    ax[3].plot(way.time, way.singular_ratio)
    ax[3].set(ylabel="singular ratio", xlabel="time (s)", ylim=(0, None))
    if names:
        ax[0].legend(fontsize="small", ncols=2)
    return ax
