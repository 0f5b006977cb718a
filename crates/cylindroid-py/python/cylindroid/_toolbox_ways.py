"""The joints on the way between two frames: those whose columns matrices of the Robotics Toolbox have."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import Mechanism


class Ways:
    """Ways between the frames of a tree; of other mechanisms every way has all joints.

    Parameters
    ----------
    mechanism : Mechanism
    of_toolbox : bool
        True for a robot of the Toolbox, whose frames are all links and carried by one joint each.
    """

    def __init__(self, mechanism: Mechanism, of_toolbox: bool) -> None:
        self._home = mechanism.home
        self._above: dict[str, tuple[str, list[int]]] | None = None
        if of_toolbox:
            place = {name: i for i, name in enumerate(mechanism.joint_names)}
            self._above = {
                joint.child: (joint.parent, [place[name] for name in joint.coordinates])
                for joint in mechanism.joints
            }

    def _joints_to(self, frame: str) -> list[int]:
        above, found = self._above or {}, []
        while frame in above:
            frame, places = above[frame]
            found += places
        return found[::-1]

    def between(self, start: str | None, end: str) -> list[int]:
        """The places in q of the joints from a frame, or the world, to another one, in this order."""
        n = len(self._home)
        if self._above is None:
            return list(range(n))
        back, out = self._joints_to(start) if start is not None else [], self._joints_to(end)
        shared = next((i for i, (a, b) in enumerate(zip(back, out)) if a != b), min(len(back), len(out)))
        return back[shared:][::-1] + out[shared:]

    def whole(self, q: ArrayLike, way: Sequence[int], others: ArrayLike | None = None) -> ArrayLike:
        """q of all joints for one that has those of a way alone; the others are at home."""
        try:
            shape = np.shape(q)
        except ValueError:  # rows of several lengths, which the mechanism refuses
            return q
        if self._above is None or shape[-1:] != (len(way),) or len(way) == len(self._home):
            return q
        filled = np.empty((*shape[:-1], len(self._home)))
        filled[...] = self._home if others is None else others
        filled[..., list(way)] = q
        return filled

    def columns(
        self, matrix: NDArray[np.float64], way: Sequence[int], axes: tuple[int, ...] = (-1,)
    ) -> NDArray[np.float64]:
        """Those of the joints of a way, along each of some axes."""
        if list(way) != list(range(len(self._home))):
            for axis in axes:
                matrix = np.take(matrix, way, axis=axis)
        return matrix
