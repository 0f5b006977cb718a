"""Axes for pictures: new or given ones, in the plane or in space, with equal scales and labels."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def pyplot() -> Any:
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise ImportError(
            "plots need matplotlib: pip install matplotlib, or this package with [plot]"
        ) from error
    return pyplot


def is_spatial(ax: Any) -> bool:
    return hasattr(ax, "plot_surface")


def axes_of(ax: Any, space: bool) -> Any:
    """New axes if none are given; the dimension of given axes is checked."""
    if ax is None:
        figure = pyplot().figure()
        ax = figure.add_subplot(projection="3d" if space else None)
    elif space and not is_spatial(ax):
        raise ValueError("this plot is spatial: pass axes created with projection='3d'")
    if not is_spatial(ax):
        ax.set_aspect("equal", adjustable="datalim")
    return ax


def equal_scales(ax: Any) -> None:
    """Equal scales on all axes, and their labels."""
    if not is_spatial(ax):
        ax.set(xlabel="x (m)", ylabel="y (m)")
        return
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


def write_labels(ax: Any, labels: list[tuple[str, list[NDArray[Any]]]]) -> None:
    """Writes each text at one of its positions so that the texts overlap as little as possible.

    Boxes are estimated from the font size; positions are in order of preference. In a plane, the
    text is placed next to its position, in one of four corners.
    """
    from matplotlib import rcParams
    from matplotlib.font_manager import FontProperties

    points = FontProperties(size=rcParams["font.size"]).get_size_in_points()
    pixels = points * ax.figure.dpi / 72
    space = is_spatial(ax)
    if space:
        from mpl_toolkits.mplot3d.proj3d import proj_transform  # type: ignore[import-untyped]

        ax.apply_aspect()
        projection = ax.get_proj()
    taken: list[NDArray[Any]] = []
    for text, positions in labels:
        extent = np.array([0.62 * pixels * len(text), 1.3 * pixels])
        candidates = []
        for at in positions:
            corner = ax.transData.transform(proj_transform(*at, projection)[:2] if space else at)
            if space:
                candidates.append((corner, at))
                continue
            right, left = 0.5 * pixels, -0.5 * pixels - extent[0]
            above, below = 0.5 * pixels, -0.5 * pixels - extent[1]
            for offset in ((right, above), (left, above), (right, below), (left, below)):
                place = corner + offset
                candidates.append((place, ax.transData.inverted().transform(place)))

        def overlap(candidate: tuple[NDArray[Any], NDArray[Any]]) -> float:
            low, high = candidate[0], candidate[0] + extent
            shared = [np.minimum(high, b[1]) - np.maximum(low, b[0]) for b in taken]
            return sum(float(np.prod(sides)) for sides in shared if (sides > 0).all())

        corner, at = min(candidates, key=overlap)
        taken.append(np.array([corner, corner + extent]))
        # On white, so that no line strikes it through.
        ax.text(*at, text, bbox={"fc": "white", "ec": "none", "alpha": 0.8, "pad": 1}, zorder=5)
