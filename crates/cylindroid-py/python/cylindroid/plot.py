"""Plots with matplotlib (``pip install .[plot]``).

Every function draws into the given axes, or creates new ones, and returns them; nothing is shown or
saved. All quantities are computed by the library. Planar mechanisms are drawn in their plane: in
axes without a third dimension, x and y of the world.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import Mechanism, Screw, ScrewSystem, Spectrum, Trajectory
from ._conics import conics
from ._figure import axes_of, equal_scales, is_spatial, pyplot, write_labels
from ._maps import map
from ._skeleton import drawn_joints, moving_links, points_of_links, polygon, slides

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Smaller pitches are written as zero (m/rad).
ROUNDING = 1e-9
# Larger components leave the plane: of a unit direction, or of a pitch (m/rad).
PLANAR = 1e-6

_BODY = "burlywood"

__all__ = ["conics", "cylindroid", "ellipsoid", "frame", "map", "mechanism", "screws", "trajectory"]


def frame(pose: ArrayLike, ax: Any = None, size: float = 0.1, name: str | None = None) -> Any:
    """The axes of a pose: x red, y green, z blue.

    Parameters
    ----------
    pose : array_like, (4, 4)
        (m)
    ax : matplotlib axes, optional
        Default: new 3-D axes. Axes of a plane show x and y.
    size : float
        Length of the arrows (m).
    name : str, optional
        Text at the origin.

    Returns
    -------
    The axes.
    """
    T = np.asarray(pose, dtype=float)
    ax = axes_of(ax, space=ax is None)
    d = 3 if is_spatial(ax) else 2
    for i, colour in zip(range(d), ("tab:red", "tab:green", "tab:blue")):
        arrow = size * T[:d, i]
        if d == 3:
            ax.quiver(*T[:3, 3], *arrow, color=colour)
        else:
            ax.quiver(
                *T[:2, 3], *arrow, color=colour, angles="xy", scale_units="xy", scale=1, zorder=3
            )
            ax.update_datalim([T[:2, 3] + arrow])
    if name is not None:
        ax.text(*T[:d, 3], name)
    equal_scales(ax)
    return ax


def _body(ax: Any, points: NDArray[Any], label: str) -> None:
    """A held body: filled between its points, with round corners."""
    style = {"color": _BODY, "solid_capstyle": "round", "solid_joinstyle": "round"}
    ax.plot(*points.T, lw=14, label=label, **style)
    if len(points) < 3:
        return
    if is_spatial(ax):
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

        ax.add_collection3d(Poly3DCollection([points], color=_BODY))
    else:
        ax.fill(*points.T, color=_BODY, lw=0)


def mechanism(robot: Mechanism, q: ArrayLike | None = None, ax: Any = None) -> Any:
    """Links as lines between their joints, loop joints included, contacts, held bodies, and the tool.

    Filled points are actuated joints, hollow ones passive; diamonds are contacts. A body that is
    touched by contacts and guided by no joint is filled between its contacts.

    Parameters
    ----------
    robot : Mechanism
    q : array_like, (n,), optional
        Default: home.
    ax : matplotlib axes, optional
        Default: new axes, of the plane x-y for a planar mechanism, otherwise 3-D.

    Returns
    -------
    The axes.
    """
    ax = axes_of(ax, space=ax is None and robot.dimension == 3)
    d = 3 if is_spatial(ax) else 2
    q = robot.home if q is None else q
    joints = drawn_joints(robot)
    on_parent, on_child = (robot.joint_axes(q, side)[:, 0, :d] for side in ("parent", "child"))
    moving = moving_links(robot)
    contacts = robot.contact_points(q)[:, :, :d]
    points = points_of_links(robot, on_parent, on_child, contacts)
    for line in slides(robot, on_parent, on_child):
        ax.plot(*line.T, color="0.5", lw=2)
    guided = {link for _, joint in joints for link in (joint.parent, joint.child)}
    touched = {link for links in robot.contact_links for link in links}
    for link, of_link in points.items():
        if link in touched - guided and link in moving:
            _body(ax, polygon(np.array(of_link)), f"_{link}")
        elif link in moving and len(of_link) > 1:
            line = polygon(np.array(of_link))
            ax.plot(*line.T, color="0.3", lw=3, solid_capstyle="round", label=f"_{link}")
    style = {"depthshade": False} if d == 3 else {"zorder": 3}
    shown = [(i, j) for i, j in joints if j.coordinates or j.mimic or j.closes_loop]
    for actuated, fill in ((True, "tab:orange"), (False, "white")):
        places = np.array([on_parent[i] for i, j in shown if j.actuated == actuated])
        if len(places):
            label = "_actuated" if actuated else "_passive"
            ax.scatter(*places.T, color=fill, edgecolors="tab:orange", label=label, **style)
    if len(contacts):
        ax.scatter(
            *contacts[:, 1].T, marker="D", color="white", edgecolors="0.3", label="_contacts", **style
        )
    return frame(robot.fk(q), ax, 0.1 * robot.reach)


_UNITS = {"velocity": ("m/s", "rad/s"), "force": ("N", "N m")}


def _unit(component: str, quantity: str) -> str:
    """The unit of a component; none for those of a task map."""
    if component in ("x", "y", "z"):
        return _UNITS[quantity][0]
    return _UNITS[quantity][1] if component in ("rx", "ry", "rz") else ""


def ellipsoid(
    spectrum: Spectrum,
    centre: ArrayLike | None = None,
    ax: Any = None,
    *,
    scale: float = 1.0,
    components: str | list[str] | None = None,
    view: str = "projection",
    **style: Any,
) -> Any:
    """The ellipsoid of velocities or forces for inputs of norm one.

    An ellipse for two components, an ellipsoid for three. The components that are not drawn are free
    or zero, which the legend says. The axes are those of the world (the twist is taken at the
    reference frame's origin). The ellipsoid is flat along directions of zero efficiency; along
    infinite ones it is a strip or a cylinder without end.

    Parameters
    ----------
    spectrum : Spectrum
        Of a task (``robot.manipulability(q, task="x,y,z").kinematic``) or of the whole twist.
    centre : array_like, (2,) or (3,), optional
        Usually ``robot.fk(q)[:3, 3]`` (m). Default: the origin.
    ax : matplotlib axes, optional
        3-D ones for three components.
    scale : float
        Metres per unit of velocity or force.
    components : str or list of str, optional
        Two or three of ``spectrum.components``: 'x,y'; 'linear' or 'angular' for all of a kind.
        Default: those of a task of two or three, otherwise the linear ones.
    view : str
        'projection' (the other components are free) or 'section' (they are zero).
    **style
        Passed to matplotlib, for example ``color``.

    Returns
    -------
    The axes.
    """
    known = spectrum.components
    linear = [c for c in known if c in ("x", "y", "z")]
    angular = [c for c in known if c in ("rx", "ry", "rz")]
    if components is None:
        pure = not (linear and angular)
        components = known if len(known) <= 3 and (pure or len(known) == 2) else linear
    elif isinstance(components, str):
        components = {"linear": linear, "angular": angular}.get(components, components.split(","))
    if len(components) not in (2, 3):
        raise ValueError(
            f"an ellipsoid of {len(components)} components cannot be drawn: choose two or three of "
            f"{', '.join(known)}"
        )
    seen = spectrum.ellipsoid(components, view)
    axes, d = scale * seen.semi_axes, len(components)
    ax = axes_of(ax, space=d == 3)
    middle = np.zeros(d) if centre is None else np.asarray(centre, dtype=float)[:d]
    state = "free" if view == "projection" else "zero"
    others = f" ({view}: {', '.join(seen.others)} {state})" if seen.others else ""
    style = {"color": "tab:blue", "label": seen.quantity + others} | style
    size = np.linalg.norm(axes, axis=0).max() if axes.size else scale
    if seen.unbounded.size:
        _unbounded(ax, middle, axes, 3 * size * seen.unbounded)
    ball = _ball(axes.shape[1])
    surface = middle.reshape(-1, *[1] * (ball.ndim - 1)) + np.tensordot(axes, ball, 1)
    if ball.ndim == 2:
        ax.plot(*surface, **style)
    else:
        ax.plot_surface(*surface, **({"alpha": 0.3, "lw": 0} | style))
    for axis in axes.T:
        ax.plot(*(middle[:, None] + np.outer(axis, [-1, 1])), color="0.2", lw=1)
    units = {_unit(c, seen.quantity) for c in components}
    if d == 3:
        equal_scales(ax)
    if centre is None or len(units) > 1 or not set(components) <= {"x", "y", "z"}:
        names = [f"{c} ({_unit(c, seen.quantity)})".removesuffix(" ()") for c in components]
        ax.set(**dict(zip(("xlabel", "ylabel", "zlabel"), names)))
    if d == 2 and len(units) > 1:
        ax.set_aspect("auto")
    ax.legend(fontsize="small")
    return ax


def _ball(k: int) -> NDArray[Any]:
    """Points of the unit sphere of k dimensions, up to three."""
    turn = np.linspace(0, 2 * np.pi, 73)
    if k < 2:
        return np.array([[-1.0, 1.0]]) if k else np.zeros((0, 1))
    if k == 2:
        return np.array([np.cos(turn), np.sin(turn)])
    rise = np.linspace(0, np.pi, 37)[:, None]
    return np.array(
        [np.sin(rise) * np.cos(turn), np.sin(rise) * np.sin(turn), np.cos(rise) + 0 * turn]
    )


def _unbounded(
    ax: Any, middle: NDArray[Any], axes: NDArray[Any], reach: NDArray[Any]
) -> None:
    """What has no end along the rows of `reach`: a line, a strip, a cylinder or a slab."""
    style = {"color": "tab:red", "label": "without end"}
    rim = axes @ _ball(axes.shape[1]) if axes.size else np.zeros((len(middle), 1))
    along = np.array([-1.0, 1.0])
    if len(middle) == 2 and len(reach) == 1:
        for side in rim.T[[0, -1]] if axes.shape[1] else rim.T:
            ax.plot(*(middle + side + np.outer(along, reach[0])).T, lw=1.5, **style)
            style = {"color": "tab:red", "label": "_strip"}
        if axes.shape[1]:
            corners = [middle + s * axes[:, 0] + t * reach[0] for s, t in
                       ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            ax.fill(*np.transpose(corners), color="tab:red", alpha=0.15, lw=0)
    elif len(middle) == 2:
        corners = [middle + s * reach[0] + t * reach[1] for s, t in
                   ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        ax.fill(*np.transpose(corners), alpha=0.15, lw=0, **style)
    elif len(reach) == 1 and rim.shape[1] == 1:
        ax.plot(*(middle + np.outer(along, reach[0])).T, lw=3, **style)
    elif len(reach) == 1:
        tube = (middle[:, None] + rim)[:, :, None] + reach[0][:, None, None] * along
        ax.plot_surface(*tube, alpha=0.15, lw=0, **style)
    else:
        s, t = np.meshgrid(along, along)
        for side in rim.T:
            slab = (middle + side)[:, None, None] + reach[0][:, None, None] * s
            ax.plot_surface(*(slab + reach[1][:, None, None] * t), alpha=0.15, lw=0, **style)
            style = {"color": "tab:red", "label": "_slab"}


def screws(
    screws: list[Screw], ax: Any = None, *, length: float = 0.5, names: list[str] | None = None
) -> Any:
    """Screw axes, each with its pitch; translations as arrows at the origin.

    In axes of a plane (those of ``mechanism(robot)`` for a planar mechanism) rotations are points.

    Parameters
    ----------
    screws : list of Screw
        Or of twists: ``[cy.Screw(t) for t in J.T]``.
    ax : matplotlib axes, optional
        Default: new 3-D axes.
    length : float
        Of the lines (m).
    names : list of str, optional

    Returns
    -------
    The axes.

    Raises
    ------
    ValueError
        If the axes are those of a plane and a screw is not a motion in it.
    """
    ax = axes_of(ax, space=ax is None)
    d = 3 if is_spatial(ax) else 2
    labels: list[tuple[str, list[NDArray[Any]]]] = []
    for i, screw in enumerate(screws):
        label = names[i] if names else f"{i + 1}"
        direction = np.asarray(screw.direction)
        across = np.hypot(*direction[:2])
        if d == 2:
            leaving = direction[2] if screw.is_translation else max(across, abs(screw.pitch))
            if abs(leaving) > PLANAR:
                raise ValueError(
                    f"screw {label} leaves the plane x-y: pass axes created with projection='3d'"
                )
        if screw.is_translation:
            tip = length * direction[:d]
            if d == 3:
                ax.quiver(0, 0, 0, *tip, color="tab:green")
            else:
                ax.annotate("", tip, (0, 0), arrowprops={"arrowstyle": "->", "color": "tab:green"})
                ax.update_datalim([tip, 0 * tip])
            labels.append((f"{label}: translation", [t * tip for t in (1.0, 0.8, 0.6, 1.2)]))
        elif d == 3:
            along = np.linspace(-0.5, 0.5, 2)
            ax.plot(*(screw.point + np.outer(along, length * direction)).T, color="tab:blue")
            places = (0.5, -0.5, 0.4, -0.4, 0.6, -0.6, 0.3, -0.3, 0.7, -0.7, 0.2, -0.2, 0.1, 0.0)
            positions = [np.asarray(screw.point + t * length * direction) for t in places]
            pitch = 0.0 if abs(screw.pitch) < ROUNDING else screw.pitch
            labels.append((f"{label}: h = {pitch:.3g}", positions))
        else:
            point = np.asarray(screw.point)[:2]
            ax.plot(*point, "o", color="tab:blue", zorder=4)
            labels.append((label, [point]))
    equal_scales(ax)
    if d == 2:
        ax.autoscale_view()
    write_labels(ax, labels)
    return ax


def cylindroid(
    system: ScrewSystem, ax: Any = None, *, length: float | None = None, count: int = 60
) -> Any:
    """The ruled surface of the axes of a two-system, coloured by pitch.

    Parameters
    ----------
    system : ScrewSystem
        Of order 2 with two principal screws (class IA).
    ax : matplotlib 3-D axes, optional
    length : float, optional
        Of the rulings (m). Default: three times the height of the surface.
    count : int
        Number of rulings.

    Returns
    -------
    The axes.
    """
    if system.gibson_hunt != "IA" or system.rank != 2:
        raise ValueError(
            f"a cylindroid requires a two-system of class IA; this system has order {system.rank} "
            f"and class {system.gibson_hunt}"
        )
    ax = axes_of(ax, space=True)
    first, second = (np.asarray(s.twist) for s in system.principal_screws)
    members = [
        Screw(np.cos(t) * first + np.sin(t) * second) for t in np.linspace(0, np.pi, count)
    ]
    high, low = system.principal_pitches
    length = 3 * (high - low) if length is None else length
    origin = system.canonical_pose[:3, 3]
    palette = pyplot().cm.viridis
    for screw in members:
        foot = screw.point + screw.direction * (screw.direction @ (origin - screw.point))
        ends = foot + np.outer([-0.5, 0.5], length * screw.direction)
        share = (screw.pitch - low) / (high - low)
        ax.plot(*ends.T, color=palette(share), lw=1)
    ax.set_title(f"pitches {low:.3g} to {high:.3g} m/rad")
    equal_scales(ax)
    return ax


def trajectory(
    way: Trajectory, names: list[str] | None = None, figure: Figure | None = None
) -> NDArray[Any]:
    """Joints, joint velocities, pose error and singular value ratio over time.

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
        figure = pyplot().figure(figsize=(7, 9), layout="constrained")
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
