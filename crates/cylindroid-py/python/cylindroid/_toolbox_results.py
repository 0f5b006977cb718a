"""What `cylindroid.rtb` returns, with the names of the Robotics Toolbox."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import InvalidOptionError


@dataclass(frozen=True)
class IKSolution:
    """What `ikine_LM` returns, with the names of the Toolbox.

    Attributes
    ----------
    q : ndarray, (n,)
    success : bool
    iterations : int
    searches : int
    residual : float
        Half the squared error, metres and radians, unscaled.
    reason : str
        Empty on success.
    """

    q: NDArray[np.float64]
    success: bool
    iterations: int
    searches: int
    residual: float
    reason: str


@dataclass(frozen=True, eq=False)
class Trajectory:
    """What `jtraj` returns, with the names of the Toolbox.

    Attributes
    ----------
    t : ndarray, (N,)
        Times (s).
    q, qd, qdd : ndarray, (N, n)
        Joints, their velocities and accelerations [rad or m, per second].
    """

    t: NDArray[np.float64]
    q: NDArray[np.float64]
    qd: NDArray[np.float64]
    qdd: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.t)

    @property
    def naxes(self) -> int:
        """Number of joints."""
        return int(self.q.shape[1])


def from_pose_to_pose(
    inverse: Callable[..., IKSolution], T1: ArrayLike, T2: ArrayLike, t: ArrayLike
) -> Trajectory:
    """`jtraj` with a search for configurations, which takes a pose and `q0`."""
    times, ends = _times_of(t), []
    given: dict[str, NDArray[np.float64]] = {}
    for name, pose in (("T1", T1), ("T2", T2)):
        found = inverse(pose, **given)
        if not found.success:
            raise InvalidOptionError(f"{name} cannot be used: {found.reason}")
        given = {"q0": found.q}
        ends.append(found.q)
    return _quintic(ends[0], ends[1], times)


def _times_of(t: Any) -> NDArray[np.float64]:
    """The times of the Toolbox's argument `t`, (N,): so many from 0 to 1 s, or those given (s).

    Raises
    ------
    InvalidOptionError
        Fewer than two times, or times that do not begin at zero and rise.
    """
    if isinstance(t, (int, np.integer)) and t >= 2:
        return np.linspace(0.0, 1.0, int(t))
    try:
        times = np.array(t, dtype=float)
    except (TypeError, ValueError) as error:
        raise InvalidOptionError(f"t = {t!r}: times or their number are needed") from error
    rises = times.ndim == 1 and len(times) >= 2 and times[0] == 0.0 and np.all(np.diff(times) > 0.0)
    if not (rises and np.isfinite(times[-1])):
        raise InvalidOptionError(
            f"t = {t!r} cannot be used: at least two times from 0 s on, each later than the one "
            "before it, or their number"
        )
    return times


def _quintic(
    start: NDArray[np.float64], end: NDArray[np.float64], times: NDArray[np.float64]
) -> Trajectory:
    """From rest to rest along a line, without acceleration at its ends.

    q(t) = start + (10 s^3 - 15 s^4 + 6 s^5) (end - start), s = t / times[-1].
    """
    law = np.polynomial.Polynomial([0.0, 0.0, 0.0, 10.0, -15.0, 6.0])
    length, way = times[-1], end - start
    shares = [law.deriv(order)(times / length) / length**order for order in range(3)]
    q, qd, qdd = (np.outer(share, way) for share in shares)
    return Trajectory(times, start + q, qd, qdd)
