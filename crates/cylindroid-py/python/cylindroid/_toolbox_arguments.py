"""Arguments of the Robotics Toolbox, in the terms of this library."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import Constraint, InvalidOptionError, Mechanism, pinv
from ._toolbox import NotHere

#: Components by the Toolbox's names of their sets.
AXES = {
    "all": "x,y,z,rx,ry,rz",
    "trans": "x,y,z",
    "rot": "rx,ry,rz",
}

#: Measures of manipulability.
METHODS = ("yoshikawa", "minsingular", "invcondition", "asada")

#: Options of its searches for inverse kinematics, and how many of them one search has.
SEARCH = {"k", "kj", "ks", "method", "kq", "km", "ps", "pi", "pinv", "pinv_damping"}
MOST_OPTIONS = 6


def stored_vector(name: str, doc: str) -> Any:
    """A property of n finite numbers that `Robot` stores; both ways they are copied."""

    def read(robot: Any) -> NDArray[np.float64]:
        return robot._now[name].copy()

    def write(robot: Any, values: ArrayLike) -> None:
        try:
            values = np.array(values, dtype=float)
        except (TypeError, ValueError) as error:
            raise InvalidOptionError(f"{name}: {robot.n} numbers are needed") from error
        if values.shape != (robot.n,) or not np.all(np.isfinite(values)):
            raise InvalidOptionError(f"{name}: {robot.n} finite numbers are needed")
        robot._now[name] = values

    return property(read, write, doc=doc)


def check_given(name: str, given: Any, own: Callable[[], NDArray[np.float64]] | None) -> None:
    """Raises for a matrix that is not that of the configuration, `own`: there is none without q."""
    if given is None:
        return
    if own is None:
        raise NotHere(f"{name} without q is not in cylindroid.rtb; pass q")
    expected = own()
    try:
        found = np.asarray(given, dtype=float)
    except (TypeError, ValueError) as error:
        raise InvalidOptionError(f"{name} = {given!r}: a matrix of numbers is needed") from error
    if found.shape != expected.shape:
        raise InvalidOptionError(
            f"{name} has the shape {found.shape}: {expected.shape} is needed, that of q"
        )
    if not np.allclose(found, expected, rtol=1e-9, atol=1e-9):
        raise NotHere(f"{name} is another one than that of q, which is not in cylindroid.rtb")


def measure(spectrum: Any, method: str, possible: int) -> float:
    """A measure by the Toolbox's name; zero with fewer than `possible` finite efficiencies."""
    finite = spectrum.finite
    if len(finite) < possible:
        return 0.0  # singular
    if method == "yoshikawa":
        return spectrum.volume
    ratio = finite[-1] if method == "minsingular" else finite[-1] / finite[0]
    return float(np.sqrt(ratio))


def asada(J: NDArray[np.float64], M: NDArray[np.float64], task: str) -> float:
    """Least over largest eigenvalue of the rows and columns `task` of J+^T M J+; zero below rank six.

    These eigenvalues are the efficiencies of J+ in the metric M.
    """
    inverse = pinv(J, max(J.shape) * np.finfo(float).eps)  # the threshold of numpy.linalg.matrix_rank
    if inverse.rank < 6:
        return 0.0
    all_axes = AXES["all"].split(",")
    columns = inverse.matrix[:, [all_axes.index(axis) for axis in task.split(",")]]
    spectrum = Constraint(columns).manipulability(Wu=M).kinematic
    return float(spectrum.finite[-1] / spectrum.finite[0]) if spectrum.zeros == 0 else 0.0


def _chosen(mask: NDArray[np.bool_]) -> str:
    return ",".join(np.array(AXES["all"].split(","))[mask])


def task_of(axes: str | ArrayLike) -> str:
    """The components of `axes`: 'all', 'trans', 'rot', or six booleans."""
    if isinstance(axes, str):
        if axes not in AXES:
            raise ValueError(f"axes = {axes!r}: one of {', '.join(AXES)}, or six booleans")
        return AXES[axes]
    mask = np.asarray(axes, dtype=bool)
    if mask.shape != (6,):
        raise ValueError("axes are six booleans: x, y, z, rx, ry, rz")
    return _chosen(mask)


def in_axes_of(pose: NDArray[np.float64], twists: NDArray[np.float64]) -> NDArray[np.float64]:
    """Twists, (..., 6, n), in the axes of a pose, (..., 4, 4)."""
    axes = np.zeros((*pose.shape[:-2], 6, 6))
    axes[..., :3, :3] = axes[..., 3:, 3:] = np.swapaxes(pose[..., :3, :3], -1, -2)
    return axes @ twists


def check_search(options: Sequence[Any], search: Mapping[str, Any]) -> None:
    """Raises for options that no search of the Toolbox has."""
    if len(options) > MOST_OPTIONS:
        raise TypeError("inverse kinematics has at most six options of the search")
    for name in search:
        if name not in SEARCH:
            raise TypeError(f"inverse kinematics has no argument {name!r}")


def inverse_kinematics(
    mechanism: Mechanism,
    target: ArrayLike,
    frame: str,
    q0: ArrayLike | None,
    iterations: int,
    tolerance: float,
    mask: ArrayLike | None,
    seed: int,
) -> Any:
    """`Mechanism.ik` with a mask and the tolerance of half the squared error."""
    task = None
    if mask is not None:
        components = np.asarray(mask, dtype=float) != 0
        if components.shape != (6,):
            raise ValueError("mask has six entries: x, y, z, rx, ry, rz")
        task = _chosen(components)
    # Half of e^2 + a^2 within the tolerance where both are within its root.
    error = float(np.sqrt(tolerance))
    return mechanism.ik(
        target,
        frame,
        q0,
        task=task,
        tolerance_position=error,
        tolerance_orientation=error,
        seed=seed,
        iterations=iterations,
    )
