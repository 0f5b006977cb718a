"""The picture of a three-system: conics of equal pitch in the plane of its screws."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import Screw, ScrewSystem
from ._figure import axes_of, pyplot, write_labels

if TYPE_CHECKING:
    from ._core import PitchConics

# Corners of the triangle in which homogeneous coordinates are barycentric: the generators.
CORNERS = np.array([[0.0, 1.0], [-0.75**0.5, -0.5], [0.75**0.5, -0.5]])
# Half the width and height of the chart, and conics between two principal pitches.
HALF = np.array([2.4, 2.0])
CONICS = 5


def _chart(x: NDArray[Any]) -> NDArray[Any]:
    """Points (k, 2) of homogeneous coordinates (k, 3); the curve is cut at infinity."""
    total = x.sum(1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        points = x @ CORNERS / total
    points[(np.abs(points) > 4 * HALF).any(1)] = np.nan
    flips = np.flatnonzero(total[1:, 0] * total[:-1, 0] < 0) + 1
    return np.insert(points, flips, np.nan, axis=0)


def _pencil(conics: PitchConics, system: ScrewSystem) -> list[float]:
    """Pitches of real conics: between the principal ones, and beyond them."""
    ends = np.unique(np.round(system.pitches / system.length, 9)) * system.length
    width = np.ptp(ends) if len(ends) > 1 else system.length
    first, last = (ends[0], ends[-1]) if len(ends) else (0.0, 0.0)
    ends = np.array([first - width, *ends, last + width])
    pitches = [np.linspace(a, b, CONICS + 2)[1:-1] for a, b in zip(ends, ends[1:])]
    every = np.unique([*np.concatenate(pitches), 0.0])
    return [h for h in every if conics.kind(h) not in ("empty", "whole plane")]


def conics(
    system: ScrewSystem,
    ax: Any = None,
    *,
    twists: ArrayLike | None = None,
    names: list[str] | None = None,
) -> Any:
    """The screws of each pitch in a three-system: a pencil of conics in the plane of its screws.

    Homogeneous coordinates are barycentric ones of a triangle whose corners are the generators of
    the normal form. Those of the principal pitches are bold: points and pairs of lines.

    Parameters
    ----------
    system : ScrewSystem
        Of order 3.
    ax : matplotlib axes, optional
        Default: new axes.
    twists : array_like, (6, m), optional
        Twists of the system to show as points, as columns.
    names : list of str, optional
        Of the twists.

    Returns
    -------
    The axes.

    Raises
    ------
    ValueError
        For a system of another order.

    Notes
    -----
    Ball 1900; Donelan and Selig, figure 1.
    """
    from .plot import ROUNDING

    family = system.pitch_conics()
    if family is None:
        raise ValueError(f"conics require a three-system; this system has order {system.rank}")
    ax = axes_of(ax, space=False)
    colours = pyplot().cm.viridis
    pitches = _pencil(family, system)
    low, high = (min(pitches), max(pitches)) if pitches else (0.0, 1.0)
    for h in pitches:
        colour = colours((h - low) / (high - low) if high > low else 0.5)
        for curve in family.points(h):
            ax.plot(*_chart(curve).T, color=colour, lw=1, label=f"_h = {h:.6g}")
    for h in np.unique(system.pitches):
        for curve in family.points(h):
            points = _chart(curve)
            style = {"marker": "o", "ls": ""} if len(points) == 1 else {"lw": 2.5}
            ax.plot(*points.T, color="tab:red", label=f"_principal h = {h:.6g}", **style)
    labels: list[tuple[str, list[NDArray[Any]]]] = []
    for corner, generator in zip(CORNERS, family.generators.T):
        screw = Screw(generator)
        ax.plot(*corner, "k.", zorder=4)
        pitch = 0.0 if abs(screw.pitch) < ROUNDING else screw.pitch
        labels.append(("translation" if screw.is_translation else f"h = {pitch:.3g}", [corner]))
    given = np.zeros((6, 0)) if twists is None else np.asarray(twists, dtype=float)
    for i, twist in enumerate(given.T):
        x = family.coordinates(twist)
        if x is not None:
            point = _chart(x[None])[0]
            if (np.abs(point) < HALF).all():
                ax.plot(*point, "o", color="tab:green", zorder=4)
                labels.append((names[i] if names else f"{i + 1}", [point]))
    ax.set_aspect("equal", adjustable="box")
    ax.set(xlim=(-HALF[0], HALF[0]), ylim=(-HALF[1], HALF[1]), xticks=[], yticks=[])
    ax.set_title(f"pitches {low:.3g} to {high:.3g} m/rad" if pitches else "one pitch")
    write_labels(ax, labels)
    return ax
