"""Pictures of sweeps."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._core import WorkspaceMap
from ._figure import equal_scales, is_spatial, pyplot


def map(
    columns: Mapping[str, ArrayLike] | WorkspaceMap,
    color: str | None = None,
    x: str | None = None,
    y: str | None = "y",
    z: str | None = None,
    ax: Any = None,
    *,
    log: bool = False,
    mode: int = 0,
    place: int | None = None,
) -> Any:
    """A sweep as a slice, a cloud of points, or a histogram; a working mode of a map with its loci.

    Rows that are a grid of x and y are drawn as a slice, one cell for each, with the line on which a
    value that changes its sign is zero; other rows as points, in space with `z`; `x` alone (`y=None`) as
    a histogram.

    Parameters
    ----------
    columns : mapping of str to array_like, (N,)
        As `cylindroid.sweep` returns them; a DataFrame is one too. Of a `WorkspaceMap` over two axes
        one mode is drawn, with the curves that belong to it; over three axes a slice of it, with the
        sections of its surfaces.
    color : str, optional
        The column that colours cells or points; values that are not finite are left out. A slice
        needs one. Default for a `WorkspaceMap`: 'type_two'.
    x, y, z : str, optional
        The columns of the axes: metres for x, y and z of a pose, or coordinates of a grid. Default:
        'x' and 'y', of a `WorkspaceMap` its axes.
    ax : matplotlib axes, optional
        Default: new ones.
    log : bool, optional
        Logarithmic colours, or numbers of a histogram.
    mode : int
        The working mode of a `WorkspaceMap`.
    place : int, optional
        Of three axes the number of the value on the third one, from 0. Default: in the middle.

    Returns
    -------
    The axes.
    """
    if isinstance(columns, WorkspaceMap):
        return _mode(columns, mode, place, color, ax, log)
    x = "x" if x is None else x
    names = [name for name in (x, y, z, color) if name is not None]
    for name in names:
        if name not in columns:
            known = ", ".join(str(known) for known in columns)
            raise ValueError(f"there is no column '{name}'; the columns are {known}")
    data = {name: np.asarray(columns[name], dtype=float) for name in names}
    if any(values.shape != data[x].shape or values.ndim != 1 for values in data.values()):
        raise ValueError("columns must be arrays of one length")
    if z is not None and y is None:
        raise ValueError("z needs y")
    if ax is None:
        ax = pyplot().figure().add_subplot(projection=None if z is None else "3d")
    elif (z is not None) != is_spatial(ax):
        needed = "created with projection='3d'" if z is not None else "of a plane"
        raise ValueError(f"pass axes {needed}")
    lengths = {"x", "y", "z"}

    def label(name: str) -> str:
        return f"{name} (m)" if name in lengths else name

    ax.set_xlabel(label(x))
    if y is None:
        ax.hist(data[x][np.isfinite(data[x])], bins="auto", log=log, color="tab:blue")
        ax.set_ylabel("rows")
        return ax
    ax.set_ylabel(label(y))
    if {x, y} <= lengths and z is None:
        ax.set_aspect("equal", adjustable="datalim")
    style: dict[str, Any] = {"norm": "log"} if log and color is not None else {}
    grid = None if z is not None or color is None else _grid(data[x], data[y], data[color])
    if grid is not None:
        across, up, values = grid
        drawn = ax.pcolormesh(across, up, np.ma.masked_invalid(values), shading="nearest", **style)
        finite = values[np.isfinite(values)]
        if finite.size and finite.min() < 0 < finite.max() and min(values.shape) > 1:
            ax.contour(across, up, values, levels=[0.0], colors="k", linewidths=1)
    else:
        kept = np.ones(len(data[x]), bool) if color is None else np.isfinite(data[color])
        if color is not None:
            style["c"] = data[color][kept]
        drawn = ax.scatter(*(data[name][kept] for name in names if name != color), s=2, **style)
    if z is not None:
        ax.set_zlabel(label(z))
        if {x, y, z} == lengths:
            equal_scales(ax)
    if color is not None:
        ax.figure.colorbar(drawn, ax=ax, label=color, pad=0.05 if z is None else 0.15)
    return ax


_COLORS = {"type I": "tab:blue", "type II": "tab:red", "passive": "dimgray", "limit": "tab:green"}


def _mode(
    found: WorkspaceMap, mode: int, place: int | None, color: str | None, ax: Any, log: bool
) -> Any:
    """One working mode of a map over two axes with its loci, or a slice of one over three."""
    if len(found.axes) not in (2, 3):
        raise ValueError(f"the map has {len(found.axes)} axes; two or three can be drawn")
    if not 0 <= mode < len(found.modes):
        raise ValueError(f"mode is {mode}, the map has {len(found.modes)} modes, from 0 on")
    x, y, *third = found.axes
    columns, sections = found.modes[mode], {}
    if third:
        count = found.axes[third[0]][2]
        place = count // 2 if place is None else place
        if not 0 <= place < count:
            raise ValueError(f"place is {place}, '{third[0]}' has {count} values, from 0 on")
        columns = {name: values[place::count] for name, values in columns.items()}
        sections = found.section(mode, place)
    ax = map(columns, color or "type_two", x, y, ax=ax, log=log)
    if third:
        ax.set_title(f"{third[0]} = {columns[third[0]][0]:.4g}")
    for kind, segments in sections.items():
        ends = np.pad(segments, ((0, 0), (0, 1), (0, 0)), constant_values=np.nan)
        ax.plot(*ends.reshape(-1, 2).T, color=_COLORS[kind], label=kind)
    named = set()
    for locus in found.loci:
        kind = locus["kind"]
        if mode in locus["modes"]:
            label = None if kind in named else kind
            named.add(kind)
            ax.plot(*locus["points"].T, color=_COLORS[kind], label=label)
    if named or sections:
        ax.legend(loc="best")
    return ax


def _grid(
    x: NDArray[Any], y: NDArray[Any], values: NDArray[Any]
) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]] | None:
    """The values over the grid of x and y, if each of its nodes is one of the rows."""
    across, column = np.unique(x, return_inverse=True)
    up, row = np.unique(y, return_inverse=True)
    if len(across) * len(up) != len(x) or len(np.unique(row * len(across) + column)) != len(x):
        return None
    grid = np.empty((len(up), len(across)))
    grid[row, column] = values
    return across, up, grid
