"""Structure and state of a robot of `cylindroid.rtb`: its joints, limits, links and configurations."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import Mechanism, ModelError
from ._errors import refused
from ._toolbox import NotHere
from ._toolbox_arguments import stored_vector
from ._toolbox_links import ETS, Link, carrier_of, links_of, pose_in, transforms


def _kept(name: str, instead: str, read: Any) -> Any:
    """A property that cannot be set."""

    def write(robot: Any, value: Any) -> None:
        raise NotHere(f"'{name}' cannot be set in cylindroid.rtb; use {instead}")

    return property(read, write, doc=read.__doc__)


class Structure:
    """What a robot consists of, and the configurations that it keeps."""

    #: The mechanism itself.
    mechanism: Mechanism
    #: Named configurations, (n,) each.
    configs: dict[str, NDArray[np.float64]]
    #: The frame of the end effector.
    _end: str
    #: The frame that poses without the base are relative to; None for the world.
    _base: str | None
    #: The names of the links.
    _links: list[str]
    #: Links whose motors have an inertia that the mass matrix lacks.
    _motors: list[str]
    _now: dict[str, NDArray[np.float64]]
    #: The places in `Mechanism.frames` of the links, in the order of `fkine_all`.
    _places: list[int]
    #: Makes the mechanism without limits of a robot of the Toolbox.
    _unlimited: Callable[[], Mechanism] | None
    #: `qdlim` of the robot of the Toolbox.
    _speeds: ArrayLike | None

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
        """Joint limits, (2, n): lower, upper [rad or m].

        As in the Toolbox an angle without limits has -pi and pi, which inverse kinematics, `islimit`
        and `Mechanism.lower` do not know; a length without limits is infinite, where there it raises.
        """
        limits = np.stack([self.mechanism.lower, self.mechanism.upper])
        free = np.isinf(limits).all(axis=0) & np.array(self.revolutejoints)
        limits[:, free] = [[-np.pi], [np.pi]]
        return limits

    @property
    def qdlim(self) -> NDArray[np.float64]:
        """Limits of speeds, (n,) [rad/s or m/s], infinite without.

        Those of a robot of the Toolbox are as there, with what it may have for grippers.
        """
        if self._speeds is None:
            return self.mechanism.velocity_limit
        return np.array(self._speeds, dtype=float)

    def _without_limits(self) -> Mechanism:
        """The mechanism of searches that may leave the limits.

        Raises
        ------
        NotImplementedError
            For a mechanism of this library that has limits.
        """
        if self._unlimited is not None:
            return self._unlimited()
        if np.isfinite([self.mechanism.lower, self.mechanism.upper]).any():
            raise NotHere(
                f"joint_limits = False is not in cylindroid.rtb for '{self.name}', whose joints have limits; "
                "use Robot of a model file without them, which cylindroid.parse reads too"
            )
        return self.mechanism

    @property
    def qz(self) -> NDArray[np.float64]:
        """All joints at zero, (n,), unless the robot of the Toolbox has another `qz`."""
        return self.configs.get("qz", np.zeros(self.n)).copy()

    @property
    def qr(self) -> NDArray[np.float64]:
        """The `qr` of the robot of the Toolbox, otherwise the home configuration, (n,)."""
        return self.configs.get("qr", self.mechanism.home).copy()

    q = stored_vector("q", "A configuration to keep, (n,) [rad or m]; zero at first.")
    qd = stored_vector("qd", "Joint velocities to keep, (n,) [rad/s or m/s]; zero at first.")
    qdd = stored_vector("qdd", "Joint accelerations, (n,) [rad/s^2 or m/s^2]; zero at first.")

    def addconfiguration(self, name: str, q: ArrayLike) -> None:
        """Keeps a configuration, (n,) [rad or m], in `configs` and as an attribute of that name."""
        self.configs[str(name)] = np.array(self.mechanism.ordered(q))

    def addconfiguration_attr(self, name: str, q: ArrayLike, unit: str = "rad") -> None:
        """`addconfiguration`, also with angles in degrees: unit 'rad' or 'deg'."""
        if unit not in ("rad", "deg"):
            raise refused("unit", f"'rad' or 'deg' is needed, not {unit!r}")
        self.addconfiguration(name, self.toradians(q) if unit == "deg" else q)

    def todegrees(self, q: ArrayLike) -> NDArray[np.float64]:
        """Angles in degrees, lengths as they are, (n,) or (N, n)."""
        q = self.mechanism.ordered(q)
        return np.where(self.revolutejoints, np.degrees(q), q)

    def toradians(self, q: ArrayLike) -> NDArray[np.float64]:
        """Angles that are in degrees in radians, lengths as they are, (n,) or (N, n)."""
        q = self.mechanism.ordered(q)
        return np.where(self.revolutejoints, np.radians(q), q)

    def isrevolute(self, j: int) -> bool:
        """True if coordinate j is an angle."""
        return self.revolutejoints[j]

    def isprismatic(self, j: int) -> bool:
        """True if coordinate j is a length."""
        return self.prismaticjoints[j]

    @property
    def reach(self) -> float:
        """The characteristic length (m)."""
        return self.mechanism.reach

    @property
    def revolutejoints(self) -> list[bool]:
        """For each coordinate, true if it is an angle."""
        return [unit == "rad" for unit in self.mechanism.units]

    @property
    def prismaticjoints(self) -> list[bool]:
        """For each coordinate, true if it is a length."""
        return [unit != "rad" for unit in self.mechanism.units]

    @property
    def structure(self) -> str:
        """'R' for each angle and 'P' for each length."""
        return "".join("R" if angle else "P" for angle in self.revolutejoints)

    def islimit(self, q: ArrayLike) -> list[bool]:
        """For each coordinate, true at or beyond a limit; q of shape (n,)."""
        q, lower, upper = self.mechanism.ordered(q), self.mechanism.lower, self.mechanism.upper
        return [bool(x) for x in (q <= lower) | (q >= upper)]

    def random_q(self, seed: int | None = None) -> NDArray[np.float64]:
        """A configuration within the limits, pi or 1 m where there are none, (n,)."""
        most = np.where(self.revolutejoints, np.pi, 1.0)
        lower, upper = np.maximum(self.qlim[0], -most), np.minimum(self.qlim[1], most)
        return np.random.default_rng(seed).uniform(np.minimum(lower, upper), upper)

    @property
    def links(self) -> list[Link]:
        """The links, each with its parent, in the order of the Toolbox or of `Mechanism.links`.

        The poses of links are arrays, and their masses are in `inertia` alone. Joints of several
        coordinates, and those that follow another one, raise `NotImplementedError`.
        """
        return links_of(self.mechanism, self._links, self._base)

    @property
    def link_dict(self) -> dict[str, Link]:
        """The links by name."""
        return {link.name: link for link in self.links}

    @property
    def nlinks(self) -> int:
        """Number of links; for robots of the Toolbox those of grippers count too."""
        return len(self._places)

    @property
    def base_link(self) -> Link:
        """The first link that has no parent."""
        return next(link for link in self.links if link.parent is None)

    @property
    def ee_links(self) -> list[Link]:
        """The links that carry no other one; that of the end effector is the first."""
        links = self.links
        parents = {link.parent_name for link in links}
        tips = [link for link in links if link.name not in parents]
        last = carrier_of(self.mechanism, self._end, self._links)
        return sorted(tips, key=lambda link: link.name != last)

    @property
    def nbranches(self) -> int:
        """Number of links that carry no other one."""
        return len(self.ee_links)

    def _read_base(self) -> NDArray[np.float64]:
        """The pose of the base in the world, (4, 4), which `fkine` includes; it cannot be set."""
        return np.eye(4) if self._base is None else self.mechanism.fk(self.qz, self._base)

    def _read_tool(self) -> NDArray[np.float64]:
        """The pose of the end effector in the link that carries it, (4, 4); it cannot be set."""
        last = carrier_of(self.mechanism, self._end, self._links)
        return pose_in(self.mechanism, self.qz, last, self._end)

    base = _kept("base", "a mechanism file or URDF with the pose", _read_base)
    tool = _kept("tool", "tool= of fkine, jacob0 and others, or Mechanism.with_tool", _read_tool)

    def ets(self, start: str | None = None, end: str | None = None) -> ETS:
        """The elementary transforms from the world, or a frame, to the end effector, or a frame.

        As in tables of the Toolbox they include base and tool: the product of their poses is `fkine`.
        Unlike there, poses between joints are each one transform, 'SE3'.

        Parameters
        ----------
        start : str, optional
            A frame on the way.
        end : str, optional
            A frame by name.

        Raises
        ------
        NotImplementedError
            For joints that move along or about no axis of their links, have several coordinates or
            follow others.
        """
        return transforms(self.mechanism, start, end or self._end)

    def A(self, j: int | ArrayLike, q: ArrayLike | None = None) -> NDArray[np.float64]:
        """The pose of link j in the base, (4, 4), or from link j[0], with its joint, to link j[1].

        Default of q: `Robot.q`. Links are numbered as in `links`.
        """
        ends = [int(i) for i in np.atleast_1d(np.asarray(j))]
        last = len(self._links) - 1
        if len(ends) not in (1, 2) or ends != sorted(ends) or not 0 <= ends[0] <= ends[-1] <= last:
            raise refused("j", f"one link or two that rise, 0 to {last}, not {j!r:.99}")
        start = self._base
        if len(ends) == 2:
            start = self.links[ends[0]].parent_name or start
        q = self.q if q is None else self.mechanism.ordered(q)
        return pose_in(self.mechanism, q, start, self._links[ends[-1]])

    def twists(self, q: ArrayLike | None = None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The axes of the joints as twists in the world, (n, 6), linear part first, and `fkine`.

        Default of q: zero. `Mechanism.jacobian` with reference='world'.
        """
        q = np.zeros(self.n) if q is None else self.mechanism.ordered(q)
        axes = self.mechanism.jacobian(q, self._end, "world")
        return axes.T.copy(), self.mechanism.fk(q, self._end)

    @property
    def hasdynamics(self) -> bool:
        """True if the links that move have masses."""
        try:
            self.mechanism.mass_matrix(self.qr)
        except ModelError:
            return False
        return True

    def inertia(self, q: ArrayLike) -> NDArray[np.float64]:
        """The mass matrix of the joints, (n, n) or (N, n, n): `Mechanism.mass_matrix`.

        Raises
        ------
        ModelError
            For moving links without mass, naming them.
        NotImplementedError
            For motors of a robot of the Toolbox that have an inertia themselves (`Jm`, `G`).
        """
        if self._motors:
            raise NotHere(
                f"the inertia of motors (Jm of {', '.join(self._motors)}) is not in cylindroid.rtb; "
                "Mechanism.mass_matrix is that of the links alone"
            )
        return self.mechanism.mass_matrix(q)
