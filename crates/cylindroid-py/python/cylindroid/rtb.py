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
4 x 4, not ``SE3``; all methods of inverse kinematics are the one of `Mechanism.ik`, so that options of their searches (``method``, ``k``, ``pinv``, ...) are accepted and change
nothing; ``plot``, ``vellipse`` and ``fellipse`` draw with matplotlib and return its axes; frames are
named, not numbered; ``manipulability`` of an arm with fewer joints than axes is the volume that its
joints do span, where there it is zero; `qlim` has infinities for lengths without limits, where there
it raises; `start` is always the frame of that link, where there a way outwards begins at its parent
and has the link's own joint too. Columns of Jacobians and Hessians are those of the joints on the way from `start` to `end`
for robots of the Toolbox, and of all joints for mechanisms of this library, whose loops leave no one
way. As there, q has all joints or those of the way; results of inverse kinematics have all, so that
`q`, `fkine`, `jtraj` and `plot` take them. Members of the Toolbox that are not here raise
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
from ._toolbox_pictures import Pictures
from ._toolbox_ways import Ways

__all__ = ["ET", "ETS", "IKSolution", "Link", "Robot", "Trajectory"]


class Robot(Pictures):
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
        self._unlimited = self._speeds = None
        if is_toolbox_robot(robot):
            found = reading_of(robot)
            self.mechanism, self._end, self._motors = found.mechanism, found.end, found.motors
            self._base, self._links, frames = ROOT, found.links, found.frames
            self._unlimited, self._speeds = found.unlimited, getattr(robot, "qdlim", None)
            configs = getattr(robot, "configs", None) or {}
            self.configs = {name: np.array(q, dtype=float) for name, q in configs.items()}
        else:
            self.mechanism = robot if isinstance(robot, Mechanism) else load(robot)
            self._end, self._links = self.mechanism.tool, self.mechanism.links
            frames = self._links
        order = self.mechanism.frames
        self._places = [order.index(frame) for frame in frames]
        self._ways = Ways(self.mechanism, self._base is not None)
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
        q = self._ways.whole(q, self._ways.between(start, end or self._end))
        pose = self.mechanism.fk(q, end or self._end, tool)
        if start is None and not include_base:
            start = self._base
        if start is None:
            return pose
        return np.asarray(np.linalg.solve(self.mechanism.fk(q, start), pose), dtype=np.float64)

    def fkine_all(self, q: ArrayLike) -> NDArray[np.float64]:
        """The poses of the base and of the links, (nlinks + 1, 4, 4) or (N, nlinks + 1, 4, 4).

        Links are in the order of the Toolbox's numbers or of `links`. Those of grippers have the joints
        that their gripper had when the robot was read. `Mechanism.fk_all` has all frames.
        """
        poses = self.mechanism.fk_all(q)
        base = np.broadcast_to(self.base, (*poses.shape[:-3], 1, 4, 4))
        return np.concatenate([base, poses[..., self._places, :, :]], axis=-3)

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
        """The Jacobian in world axes, (6, k) or (N, 6, k), linear rows first.

        With `start` that relative to this frame, in its axes: `Mechanism.relative_jacobian`. The k
        columns are those of the joints from `start` to `end`, in this order, for robots of the Toolbox,
        and all n of mechanisms of this library, whose joints before `start` have zeros.
        """
        way = self._ways.between(start, end or self._end)
        q = self._ways.whole(q, way)
        if start is not None:
            found = self.mechanism.relative_jacobian(q, start, end or self._end, tool)
        else:
            found = self.mechanism.jacobian(q, end or self._end, "local_world_aligned", tool)
        return self._ways.columns(found, way)

    def jacobe(
        self,
        q: ArrayLike,
        end: str | None = None,
        start: str | None = None,
        tool: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """The Jacobian in the axes of the end effector, (6, k) or (N, 6, k); as `jacob0`."""
        way = self._ways.between(start, end or self._end)
        q = self._ways.whole(q, way)
        if start is not None:
            return in_axes_of(self.fkine(q, end, start, tool), self.jacob0(q, end, start, tool))
        return self._ways.columns(self.mechanism.jacobian(q, end or self._end, "local", tool), way)

    def hessian0(
        self,
        q: ArrayLike | None = None,
        end: str | None = None,
        start: str | None = None,
        J0: ArrayLike | None = None,
        tool: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """The Hessian in world axes, (k, 6, k) or (N, k, 6, k); as `jacob0`, and `J0` must be that of q."""
        check_given("J0", J0, None if q is None else partial(self.jacob0, q, end, None, tool))
        self._from_base(start, "the Hessian")
        way = self._ways.between(start, end or self._end)
        q = self.qr if q is None else self._ways.whole(q, way)
        found = self.mechanism.hessian(q, end or self._end, "local_world_aligned", tool)
        return self._ways.columns(found, way, (-3, -1))

    def hessiane(
        self,
        q: ArrayLike | None = None,
        end: str | None = None,
        start: str | None = None,
        Je: ArrayLike | None = None,
        tool: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """The Hessian in the axes of the end effector, (k, 6, k) or (N, k, 6, k); as `hessian0`."""
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
        """The time derivative of `jacob0`, (6, k): `Mechanism.jacobian_dot`; `J0` must be that of q.

        Joints that are not on the way are at rest where qd has those of the way alone.
        """
        if representation is not None:
            raise NotHere("rates of analytical Jacobians are not here; call it without representation")
        check_given("J0", J0, None if q is None else partial(self.jacob0, q, end))
        way = self._ways.between(None, end or self._end)
        q, qd = self._ways.whole(q, way), self._ways.whole(qd, way, 0.0)
        found = self.mechanism.jacobian_dot(q, qd, end or self._end, "local_world_aligned")
        return self._ways.columns(found, way)

    def jacob0_analytical(
        self,
        q: ArrayLike,
        representation: str = "rpy/xyz",
        end: str | None = None,
        start: str | None = None,
        tool: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """The Jacobian of position and angles, (6, k) or (N, 6, k), with the columns of `jacob0`.

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
        way = self._ways.between(start, end or self._end)
        q = self._ways.whole(q, way)
        found = self._ways.columns(
            self.mechanism.analytical_jacobian(q, angles[representation], end or self._end, tool), way
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
        """The gradient of Yoshikawa's manipulability at q or `qr`, (k, 1); NaN where there is none."""
        check_given("J", J, None if q is None else partial(self.jacob0, q, end))
        check_given("H", H, None if q is None else partial(self.hessian0, q, end))
        self._from_base(start, "the gradient")
        way = self._ways.between(start, end or self._end)
        found = self.mechanism.manipulability_gradient(
            self.qr if q is None else self._ways.whole(q, way),
            "volume",
            reference=end or self._end,
            task=task_of(axes),
        )
        gradient = np.full(self.n, np.nan) if found.gradient is None else found.gradient
        return self._ways.columns(gradient, way).reshape(-1, 1)

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
        way = self._ways.between(start, end or self._end)
        q = self.mechanism.ordered(self.qr if q is None else self._ways.whole(q, way))
        many = np.atleast_2d(q)
        if method == "asada":
            if self.mechanism.is_closed:
                raise NotHere("method = 'asada' of closed chains is not in cylindroid.rtb")
            jacobians = self.mechanism.jacobian(many, end or self._end, "local_world_aligned")
            both = zip(jacobians, self.inertia(many))
            values = [asada(J, M, task) for J, M in both]
        else:
            found = self.mechanism.manipulability(many, reference=end or self._end, task=task)
            possible = min(task.count(",") + 1, len(way))
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
            False to search beyond them: for robots of the Toolbox, and for mechanisms without limits.
        seed : int, optional
        *options, **search
            `k`, `method`, `kq`, `km`, `ps`, `pi`, `pinv`, `pinv_damping`, `kj`, `ks` of the Toolbox's
            searches, which this one does not have: they change nothing.

        Returns
        -------
        IKSolution
            Of all joints, within their limits if `joint_limits`.

        Raises
        ------
        NotImplementedError
            For `joint_limits=False` and a mechanism of this library that has limits.
        """
        if start is not None:
            if not self._is_fixed(start):
                raise NotHere(f"start = {start!r} moves: targets are in frames at rest here")
            Tep = self.mechanism.fk(self.qr, start) @ np.asarray(Tep, dtype=float)
        check_search(options, search)
        if q0 is not None:
            q0 = self._ways.whole(q0, self._ways.between(start, end or self._end))
        found = inverse_kinematics(
            self.mechanism if joint_limits else self._without_limits(),
            Tep,
            end or self._end,
            q0,
            ilimit * slimit,
            tol,
            mask,
            seed or 0,
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
