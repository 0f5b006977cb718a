"""For users of the Robotics Toolbox: its names and conventions on a :class:`cylindroid.Mechanism`.

>>> from cylindroid.rtb import Robot
>>> panda = Robot("panda")
>>> panda.jacob0(panda.qz).shape
(6, 7)

A robot of the Toolbox itself is read by its links: ``Robot(roboticstoolbox.models.DH.Puma560())``.

What is as there: ``links`` with name, parent, ``jindex`` and ``A(q)``, ``ets``, ``base`` and ``tool``, which
can be read and not set; ``jacob0`` has world axes and its linear part at the end effector's origin,
``jacobe`` the axes of the end effector; ``ikine_LM`` returns ``.q``, ``.success``, ``.iterations``,
``.searches``, ``.residual``, and ``ik_LM`` the same as a tuple. What is not: poses are arrays of
4 x 4, not ``SE3``; all methods of inverse kinematics are the one of `Mechanism.ik`, which keeps joint
limits, so that options of their searches (``method``, ``k``, ``pinv``, ...) are accepted and change
nothing; ``plot``, ``vellipse`` and ``fellipse`` draw with matplotlib and return its axes; frames are
named, not numbered; ``manipulability`` of an arm with fewer joints than axes is the volume that its
joints do span, where there it is zero. Members of the Toolbox that are not here raise
`NotImplementedError` with the function that does the same.
"""

from __future__ import annotations

import os
from copy import copy
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import Mechanism, load
from ._toolbox import ROOT, NotHere, instead_of, is_toolbox_robot, reading_of
from ._toolbox_arguments import (
    AXES,
    METHODS,
    asada,
    check_given,
    check_search,
    in_axes_of,
    inverse_kinematics,
    measure,
    task_of,
)
from ._toolbox_links import ET, ETS, Link
from ._toolbox_results import IKSolution, Trajectory, from_configurations, from_pose_to_pose
from ._toolbox_structure import Structure

__all__ = ["ET", "ETS", "IKSolution", "Link", "Robot", "Trajectory"]


class Robot(Structure):
    """A mechanism with the methods of the Toolbox.

    Parameters
    ----------
    robot : Mechanism, str, os.PathLike or a robot of the Toolbox
        A mechanism, the name of a catalogue model, a file, or a robot of the Robotics Toolbox, of
        which joints, limits, poses and named configurations are read.

    Examples
    --------
    >>> from cylindroid.rtb import Robot
    >>> panda = Robot("panda")
    >>> solution = panda.ikine_LM(panda.fkine(panda.qr))
    >>> solution.success
    True
    """

    def __init__(self, robot: Mechanism | str | os.PathLike[str] | Any) -> None:
        self.configs, self._base, self._motors = {}, None, []
        if is_toolbox_robot(robot):
            found = reading_of(robot)
            self.mechanism, self._end, self._motors = found.mechanism, found.end, found.motors
            self._base, self._links = ROOT, found.links
            configs = getattr(robot, "configs", None) or {}
            self.configs = {name: np.array(q, dtype=float) for name, q in configs.items()}
        else:
            self.mechanism = robot if isinstance(robot, Mechanism) else load(robot)
            self._end, self._links = self.mechanism.tool, self.mechanism.links
        self._now = {name: np.zeros(self.n) for name in ("q", "qd", "qdd")}

    def copy(self) -> Robot:
        """The same mechanism, with configurations of its own."""
        own = copy(self)
        own.configs = {name: q.copy() for name, q in self.configs.items()}
        own._now = {name: q.copy() for name, q in self._now.items()}
        return own

    def __getattr__(self, name: str) -> Any:
        configs = self.__dict__.get("configs", {})
        if name in configs:
            return configs[name].copy()
        if (instead := instead_of(name)) is not None:
            raise NotHere(f"'{name}' of the Robotics Toolbox is not in cylindroid.rtb; use {instead}")
        raise AttributeError(f"'Robot' object has no attribute '{name}'")

    def fkine(
        self,
        q: ArrayLike,
        end: str | None = None,
        start: str | None = None,
        tool: ArrayLike | None = None,
        include_base: bool = True,
    ) -> NDArray[np.float64]:
        """The pose of the end effector, (4, 4) or (N, 4, 4): `Mechanism.fk`.

        With `start` in this frame; without the base, which robots of the Toolbox have, in its frame.
        """
        pose = self.mechanism.fk(q, end or self._end, tool)
        if start is None and not include_base:
            start = self._base
        if start is None:
            return pose
        return np.asarray(np.linalg.solve(self.mechanism.fk(q, start), pose), dtype=np.float64)

    def fkine_all(self, q: ArrayLike) -> NDArray[np.float64]:
        """The poses of all frames, in the order of `Mechanism.frames`: `Mechanism.fk_all`."""
        return self.mechanism.fk_all(q)

    def _is_fixed(self, start: str) -> bool:
        return not np.any(self.mechanism.jacobian(self.qr, start))

    def _from_base(self, start: str | None, what: str) -> None:
        """Raises if `start` is not the base, for what is relative to the world alone."""
        if start is None:
            return
        turned = np.any(self.mechanism.fk(self.qr, start)[:3, :3] != np.eye(3))
        if turned or not self._is_fixed(start):
            raise NotHere(
                f"start = {start!r} moves or is turned: {what} has the axes of the world here"
            )

    def jacob0(
        self,
        q: ArrayLike,
        end: str | None = None,
        start: str | None = None,
        tool: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """The Jacobian in world axes, (6, n) or (N, 6, n), linear rows first.

        With `start` that relative to this frame, in its axes: `Mechanism.relative_jacobian`. Unlike in
        the Toolbox, n is the number of all joints; those before `start` have zeros.
        """
        if start is not None:
            return self.mechanism.relative_jacobian(q, start, end or self._end, tool)
        return self.mechanism.jacobian(q, end or self._end, "local_world_aligned", tool)

    def jacobe(
        self,
        q: ArrayLike,
        end: str | None = None,
        start: str | None = None,
        tool: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """The Jacobian in the axes of the end effector, (6, n) or (N, 6, n); as `jacob0`."""
        if start is not None:
            return in_axes_of(self.fkine(q, end, start, tool), self.jacob0(q, end, start, tool))
        return self.mechanism.jacobian(q, end or self._end, "local", tool)

    def hessian0(
        self,
        q: ArrayLike | None = None,
        end: str | None = None,
        start: str | None = None,
        J0: ArrayLike | None = None,
        tool: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """The Hessian in world axes, (n, 6, n) or (N, n, 6, n); `J0` must be that of q."""
        check_given("J0", J0, None if q is None else partial(self.jacob0, q, end, None, tool))
        self._from_base(start, "the Hessian")
        q = self.qr if q is None else q
        return self.mechanism.hessian(q, end or self._end, "local_world_aligned", tool)

    def hessiane(
        self,
        q: ArrayLike | None = None,
        end: str | None = None,
        start: str | None = None,
        Je: ArrayLike | None = None,
        tool: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """The Hessian in the axes of the end effector, (n, 6, n) or (N, n, 6, n); as `hessian0`."""
        check_given("Je", Je, None if q is None else partial(self.jacobe, q, end, None, tool))
        q = self.qr if q is None else q
        pose = self.fkine(q, end, tool=tool)[..., None, :, :]
        return in_axes_of(pose, self.hessian0(q, end, start, None, tool))

    def partial_fkine0(
        self, q: ArrayLike, n: int = 3, end: str | None = None, start: str | None = None
    ) -> NDArray[np.float64]:
        """The n-th derivative of the pose: `jacob0` for n = 1, `hessian0` for n = 2; no others.

        Raises
        ------
        NotImplementedError
            For n from 3, which is the default of the Toolbox.
        """
        if n not in (1, 2):
            raise NotHere(f"n = {n!r}: derivatives of order 1 and 2 are in cylindroid.rtb")
        return self.jacob0(q, end, start) if n == 1 else self.hessian0(q, end, start)

    def jacob0_dot(
        self,
        q: ArrayLike,
        qd: ArrayLike,
        J0: ArrayLike | None = None,
        representation: str | None = None,
        *,
        end: str | None = None,
    ) -> NDArray[np.float64]:
        """The time derivative of `jacob0`, (6, n): `Mechanism.jacobian_dot`; `J0` must be that of q."""
        if representation is not None:
            raise NotHere("rates of analytical Jacobians are not here; call it without representation")
        check_given("J0", J0, None if q is None else partial(self.jacob0, q, end))
        return self.mechanism.jacobian_dot(q, qd, end or self._end, "local_world_aligned")

    def jacob0_analytical(
        self,
        q: ArrayLike,
        representation: str = "rpy/xyz",
        end: str | None = None,
        start: str | None = None,
        tool: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """The Jacobian of position and angles, (6, n) or (N, 6, n).

        Parameters
        ----------
        q : array_like, (n,) or (N, n)
        representation : str
            'rpy/xyz', 'rpy/zyx' (roll, pitch and yaw), 'eul' (angles about z, y, z) or 'exp' (rotation
            vector).
        end : str, optional
            A frame by name.
        start : str, optional
            A frame at rest.
        tool : array_like, (4, 4), optional
            A point on it.
        """
        self._from_base(start, "the analytical Jacobian")
        angles = {"rpy/xyz": "xyz", "rpy/zyx": "rpy", "eul": "zyz", "exp": "rotation_vector"}
        if representation not in angles:
            raise ValueError(f"representation = {representation!r}: one of {', '.join(angles)}")
        found = self.mechanism.analytical_jacobian(
            q, angles[representation], end or self._end, tool
        )
        # Roll first, which is the last angle there.
        return found[..., [0, 1, 2, 5, 4, 3], :] if representation == "rpy/xyz" else found

    def jacobm(
        self,
        q: ArrayLike | None = None,
        J: ArrayLike | None = None,
        H: ArrayLike | None = None,
        end: str | None = None,
        start: str | None = None,
        axes: str | ArrayLike = "all",
    ) -> NDArray[np.float64]:
        """The gradient of Yoshikawa's manipulability at q or `qr`, (n, 1); NaN where there is none."""
        check_given("J", J, None if q is None else partial(self.jacob0, q, end))
        check_given("H", H, None if q is None else partial(self.hessian0, q, end))
        self._from_base(start, "the gradient")
        found = self.mechanism.manipulability_gradient(
            self.qr if q is None else q,
            "volume",
            reference=end or self._end,
            task=task_of(axes),
        )
        gradient = np.full(self.n, np.nan) if found.gradient is None else found.gradient
        return gradient.reshape(-1, 1)

    def manipulability(
        self,
        q: ArrayLike | None = None,
        J: ArrayLike | None = None,
        end: str | None = None,
        start: str | None = None,
        method: str = "yoshikawa",
        axes: str | ArrayLike = "all",
    ) -> Any:
        """Manipulability at one or many configurations.

        Parameters
        ----------
        q : array_like, (n,) or (N, n), optional
            Default: `qr`.
        J : array_like, optional
            That of q.
        end : str, optional
            A frame by name.
        start : str, optional
            The base.
        method : str
            'yoshikawa' (volume of the velocity ellipsoid), 'minsingular' (smallest singular value),
            'invcondition' (smallest over largest singular value) or 'asada' (smallest over largest
            inertia at the end effector, from the masses of `inertia`; of a closed chain none).
        axes : str or six booleans
            'all', 'trans', 'rot', or which of x, y, z, rx, ry, rz.

        Returns
        -------
        float, or ndarray, (N,)
        """
        task = task_of(axes)
        if method not in METHODS:
            raise ValueError(f"method = {method!r}: one of {', '.join(METHODS)}")
        check_given("J", J, None if q is None else partial(self.jacob0, q, end))
        self._from_base(start, "manipulability")
        q = self.mechanism.ordered(self.qr if q is None else q)
        many = np.atleast_2d(q)
        if method == "asada":
            if self.mechanism.is_closed:
                raise NotHere("method = 'asada' of closed chains is not in cylindroid.rtb")
            both = zip(self.jacob0(many, end), self.inertia(many))
            values = [asada(J, M, task) for J, M in both]
        else:
            found = self.mechanism.manipulability(many, reference=end or self._end, task=task)
            possible = min(task.count(",") + 1, self.n)
            values = [measure(report.kinematic, method, possible) for report in found]
        return values[0] if np.ndim(q) == 1 else np.array(values)

    def ikine_LM(
        self,
        Tep: ArrayLike,
        end: str | None = None,
        start: str | None = None,
        q0: ArrayLike | None = None,
        ilimit: int = 30,
        slimit: int = 100,
        tol: float = 1e-6,
        mask: ArrayLike | None = None,
        joint_limits: bool = True,
        seed: int | None = None,
        *options: Any,
        **search: Any,
    ) -> IKSolution:
        """A configuration that puts the end effector at a pose: `Mechanism.ik`.

        Parameters
        ----------
        Tep : array_like, (4, 4)
            The pose (m).
        end : str, optional
            A frame by name.
        start : str, optional
            A frame at rest, in which the pose is.
        q0 : array_like, (n,), optional
            Where to start.
        ilimit, slimit : int
            Iterations of a search and searches; their product is the budget.
        tol : float
            Tolerance of the residual, half the squared error.
        mask : six numbers, optional
            Which components matter; those that are not zero.
        joint_limits : bool
            True; limits are always kept.
        seed : int, optional
        *options, **search
            `k`, `method`, `kq`, `km`, `ps`, `pi`, `pinv`, `pinv_damping`, `kj`, `ks` of the Toolbox's
            searches, which this one does not have: they change nothing.

        Returns
        -------
        IKSolution
            Within joint limits, always.
        """
        if start is not None:
            if not self._is_fixed(start):
                raise NotHere(f"start = {start!r} moves: targets are in frames at rest here")
            Tep = self.mechanism.fk(self.qr, start) @ np.asarray(Tep, dtype=float)
        check_search(options, search, joint_limits)
        found = inverse_kinematics(
            self.mechanism, Tep, end or self._end, q0, ilimit * slimit, tol, mask, seed or 0
        )
        residual = 0.5 * (found.position_error**2 + found.orientation_error**2)
        reason = "" if found.success else "not reached within the budget"
        if found.out_of_reach:
            reason = "out of reach: the target is farther away than the arm is long"
        return IKSolution(
            found.q, found.success, found.iterations, found.restarts, residual, reason
        )

    #: The Toolbox's other methods find the same solutions.
    ikine_NR = ikine_GN = ikine_QP = ikine_LM

    def ik_LM(
        self,
        Tep: ArrayLike,
        end: str | None = None,
        start: str | None = None,
        q0: ArrayLike | None = None,
        ilimit: int = 30,
        slimit: int = 100,
        tol: float = 1e-6,
        mask: ArrayLike | None = None,
        joint_limits: bool = True,
        *options: Any,
        **search: Any,
    ) -> tuple[NDArray[np.float64], int, int, int, float]:
        """`ikine_LM` as a tuple: q, success (0 or 1), iterations, searches, residual."""
        found = self.ikine_LM(
            Tep, end, start, q0, ilimit, slimit, tol, mask, joint_limits, None, *options, **search
        )
        return found.q, int(found.success), found.iterations, found.searches, found.residual

    ik_NR = ik_GN = ik_LM

    def jtraj(self, T1: ArrayLike, T2: ArrayLike, t: ArrayLike, **options: Any) -> Trajectory:
        """A motion of the joints, along a straight line of configurations.

        Parameters
        ----------
        T1, T2 : array_like, (n,) or (4, 4)
            Two configurations [rad or m], or two poses of the end effector (m).
        t : int, or array_like, (N,)
            A number of times from 0 to 1 s, or times that rise from 0 (s).
        **options
            Of poses those of `ikine_LM`; `q0` is for T1, from whose configuration the search for T2
            starts.

        Returns
        -------
        Trajectory
            From rest to rest; `cylindroid.JointMove` keeps limits on velocities and accelerations.

        Raises
        ------
        InvalidOptionError
            A pose that is not reached, times that do not rise.
        """
        if not options and all(np.ndim(end) == 1 for end in (T1, T2)):
            ordered = self.mechanism.ordered
            return from_configurations(ordered(T1), ordered(T2), t)
        return from_pose_to_pose(partial(self.ikine_LM, **options), T1, T2, t)

    def _ellipse(self, q: ArrayLike | None, opt: str, kind: str, options: dict[str, Any]) -> Any:
        from . import plot

        if opt not in ("trans", "rot"):
            raise ValueError(f"opt = {opt!r}: 'trans' or 'rot'")
        q = self.mechanism.ordered(self.q if q is None else q)
        report = self.mechanism.manipulability(q, reference=self._end, task=AXES[opt])
        return plot.ellipsoid(getattr(report, kind), self.fkine(q)[:3, 3], **options)

    def vellipse(self, q: ArrayLike | None = None, opt: str = "trans", **options: Any) -> Any:
        """Draws the ellipsoid of velocities, 'trans' or 'rot'; returns the axes of matplotlib.

        The options are those of `cylindroid.plot.ellipsoid`. Default of q: `Robot.q`.
        """
        return self._ellipse(q, opt, "kinematic", options)

    def fellipse(self, q: ArrayLike | None = None, opt: str = "trans", **options: Any) -> Any:
        """Draws the ellipsoid of forces; as `vellipse`."""
        return self._ellipse(q, opt, "active_force", options)

    plot_vellipse, plot_fellipse = vellipse, fellipse

    def plot(self, q: ArrayLike | None = None, ax: Any = None) -> Any:
        """Draws the robot: `cylindroid.plot.mechanism`; returns the axes of matplotlib."""
        from . import plot

        return plot.mechanism(self.mechanism, self.q if q is None else q, ax)
