"""For users of the Robotics Toolbox: its names and conventions on a :class:`cylindroid.Mechanism`.

>>> from cylindroid.rtb import Robot
>>> panda = Robot("panda")
>>> panda.jacob0(panda.qz).shape
(6, 7)

What is as there: ``jacob0`` has world axes and its linear part at the end effector's origin,
``jacobe`` the axes of the end effector; ``ikine_LM`` returns ``.q``, ``.success``, ``.iterations``,
``.searches``, ``.residual``. What is not: poses are arrays of 4 x 4, not ``SE3``; ``ikine_LM``
keeps joint limits; frames are named, not numbered; ``manipulability`` of an arm with fewer joints
than axes is the volume that its joints do span, where there it is zero.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import Mechanism, load

__all__ = ["IKSolution", "Robot"]

_AXES = {
    "all": "x,y,z,rx,ry,rz",
    "trans": "x,y,z",
    "rot": "rx,ry,rz",
}


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


class Robot:
    """A mechanism with the methods of the Toolbox.

    Parameters
    ----------
    robot : Mechanism, str or os.PathLike
        A mechanism, the name of a catalogue model, or a file.
    """

    def __init__(self, robot: Mechanism | str | os.PathLike[str]) -> None:
        self.mechanism = robot if isinstance(robot, Mechanism) else load(robot)

    @property
    def n(self) -> int:
        """Number of joints."""
        return self.mechanism.n

    @property
    def name(self) -> str:
        """Its name."""
        return self.mechanism.name

    @property
    def qlim(self) -> NDArray[np.float64]:
        """Joint limits, (2, n): lower, upper [rad or m]."""
        return np.stack([self.mechanism.lower, self.mechanism.upper])

    @property
    def qz(self) -> NDArray[np.float64]:
        """All joints at zero, (n,)."""
        return np.zeros(self.n)

    @property
    def qr(self) -> NDArray[np.float64]:
        """The home configuration, (n,)."""
        return self.mechanism.home

    def fkine(
        self, q: ArrayLike, end: str | None = None, tool: ArrayLike | None = None
    ) -> NDArray[np.float64]:
        """The pose of the end effector, (4, 4) or (N, 4, 4): `Mechanism.fk`."""
        return self.mechanism.fk(q, end, tool)

    def jacob0(
        self, q: ArrayLike, end: str | None = None, tool: ArrayLike | None = None
    ) -> NDArray[np.float64]:
        """The Jacobian in world axes, (6, n) or (N, 6, n), linear rows first."""
        return self.mechanism.jacobian(q, end, "local_world_aligned", tool)

    def jacobe(
        self, q: ArrayLike, end: str | None = None, tool: ArrayLike | None = None
    ) -> NDArray[np.float64]:
        """The Jacobian in the axes of the end effector, (6, n) or (N, 6, n)."""
        return self.mechanism.jacobian(q, end, "local", tool)

    def hessian0(self, q: ArrayLike, end: str | None = None) -> NDArray[np.float64]:
        """The Hessian in world axes, (n, 6, n) or (N, n, 6, n)."""
        return self.mechanism.hessian(q, end, "local_world_aligned")

    def manipulability(
        self,
        q: ArrayLike | None = None,
        method: str = "yoshikawa",
        axes: str | ArrayLike = "all",
        end: str | None = None,
    ) -> Any:
        """Manipulability at one or many configurations.

        Parameters
        ----------
        q : array_like, (n,) or (N, n), optional
            Default: `qr`.
        method : str
            'yoshikawa' (volume of the velocity ellipsoid) or 'invcondition' (smallest over largest
            singular value).
        axes : str or six booleans
            'all', 'trans', 'rot', or which of x, y, z, rx, ry, rz.
        end : str, optional
            A frame by name.

        Returns
        -------
        float, or ndarray, (N,)
        """
        if isinstance(axes, str):
            if axes not in _AXES:
                raise ValueError(f"axes = {axes!r}: one of {', '.join(_AXES)}, or six booleans")
            task = _AXES[axes]
        else:
            mask = np.asarray(axes, dtype=bool)
            if mask.shape != (6,):
                raise ValueError("axes are six booleans: x, y, z, rx, ry, rz")
            task = ",".join(np.array(_AXES["all"].split(","))[mask])
        if method not in ("yoshikawa", "invcondition"):
            raise ValueError(f"method = {method!r}: 'yoshikawa' or 'invcondition'")
        q = self.qr if q is None else np.asarray(q, dtype=float)
        found = self.mechanism.manipulability(np.atleast_2d(q), reference=end or self.mechanism.tool, task=task)
        possible = min(len(task.split(",")), self.n)
        values = []
        for k in (report.kinematic for report in found):
            if len(k.finite) < possible:
                values.append(0.0)  # singular
            elif method == "yoshikawa":
                values.append(k.volume)
            else:
                values.append(float(np.sqrt(k.finite[-1] / k.finite[0])))
        return values[0] if np.ndim(q) == 1 else np.array(values)

    def ikine_LM(
        self,
        Tep: ArrayLike,
        end: str | None = None,
        q0: ArrayLike | None = None,
        ilimit: int = 30,
        slimit: int = 100,
        tol: float = 1e-6,
        mask: ArrayLike | None = None,
        seed: int | None = None,
    ) -> IKSolution:
        """A configuration that puts the end effector at a pose: `Mechanism.ik`.

        Parameters
        ----------
        Tep : array_like, (4, 4)
            The pose (m).
        end : str, optional
            A frame by name.
        q0 : array_like, (n,), optional
            Where to start.
        ilimit, slimit : int
            Iterations of a search and searches; their product is the budget.
        tol : float
            Tolerance of the residual, half the squared error.
        mask : six numbers, optional
            Which components matter; those that are not zero.
        seed : int, optional

        Returns
        -------
        IKSolution
            Within joint limits, always.
        """
        task = None
        if mask is not None:
            chosen = np.asarray(mask, dtype=float) != 0
            if chosen.shape != (6,):
                raise ValueError("mask has six entries: x, y, z, rx, ry, rz")
            task = ",".join(np.array(_AXES["all"].split(","))[chosen])
        # Half of e^2 + a^2 within tol where both are within its root.
        error = float(np.sqrt(tol))
        found = self.mechanism.ik(
            Tep,
            end,
            q0,
            task=task,
            tolerance_position=error,
            tolerance_orientation=error,
            seed=seed or 0,
            iterations=ilimit * slimit,
        )
        residual = 0.5 * (found.position_error**2 + found.orientation_error**2)
        reason = "" if found.success else "not reached within the budget"
        if found.out_of_reach:
            reason = "out of reach: the target is farther away than the arm is long"
        return IKSolution(
            found.q, found.success, found.iterations, found.restarts, residual, reason
        )
