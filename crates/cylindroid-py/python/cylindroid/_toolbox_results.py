"""Results of `cylindroid.rtb`, with the names of the Robotics Toolbox."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import refused

#: Times of a motion; the package counts no further anywhere.
MOST_TIMES = 1_000_000


@dataclass(frozen=True)
class IKSolution:
    """Result of `ikine_LM`, with the names of the Toolbox.

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
    """Result of `jtraj`, with the names of the Toolbox.

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
        try:
            shape = np.shape(pose)
        except ValueError as error:
            raise refused(name, "a pose of shape (4, 4) is needed, not rows of several lengths") from error
        if shape != (4, 4):
            raise refused(name, f"a pose of shape (4, 4) is needed, not {shape}")
        found = inverse(pose, **given)
        if not found.success:
            raise refused(name, found.reason)
        given = {"q0": found.q}
        ends.append(found.q)
    return _quintic(ends[0], ends[1], times)


def from_configurations(
    q0: NDArray[np.float64], qf: NDArray[np.float64], t: ArrayLike
) -> Trajectory:
    """`jtraj` of two configurations, (n,)."""
    return _quintic(q0, qf, _times_of(t))


def _times_of(t: ArrayLike) -> NDArray[np.float64]:
    """The times of the Toolbox's argument `t`, (N,): so many from 0 to 1 s, or those given (s).

    Raises
    ------
    InvalidOptionError
        Fewer than two times or more than a million, or times that do not begin at zero and rise.
    """
    if isinstance(t, (int, np.integer)) and 2 <= t <= MOST_TIMES:
        return np.linspace(0.0, 1.0, int(t))
    wanted = f"2 to {MOST_TIMES} times that rise from 0 s, or their number, are needed, not {t!r:.99}"
    try:
        given = np.array(t)
        times = given.real.astype(float)
    except (TypeError, ValueError, OverflowError) as error:
        raise refused("t", wanted) from error
    is_list = not np.iscomplexobj(given) and times.ndim == 1 and 2 <= len(times) <= MOST_TIMES
    if not (is_list and times[0] == 0.0 and np.isfinite(times[-1]) and np.all(np.diff(times) > 0.0)):
        raise refused("t", wanted)
    return times


def _quintic(
    start: NDArray[np.float64], end: NDArray[np.float64], times: NDArray[np.float64]
) -> Trajectory:
    """From rest to rest along a line, without acceleration at its ends.

    q(t) = start + (10 s^3 - 15 s^4 + 6 s^5) (end - start), s = t / times[-1].
    """
    law = np.polynomial.Polynomial([0.0, 0.0, 0.0, 10.0, -15.0, 6.0])
    length, way = times[-1], end - start
    with np.errstate(all="ignore"):  # of times so short that nothing finite moves so fast
        shares = [law.deriv(order)(times / length) / length**order for order in range(3)]
        q, qd, qdd = (np.outer(share, way) for share in shares)
    if not np.isfinite(qdd).all():
        raise refused("t", f"{times[-1]} s are too short for a motion")
    return Trajectory(times, start + q, qd, qdd)
