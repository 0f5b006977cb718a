"""Links and elementary transforms of a mechanism, with the names of the Robotics Toolbox.

Both are read from poses at zero and from Jacobians of the mechanism. What has none of them raises
`NotImplementedError`; as a `NotHere`, which is an `AttributeError` too, it would get lost in properties.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import Mechanism, exp
from ._toolbox import MASSES, NotHere, rpy

#: Elementary motions in the order of a twist.
KINDS = ("tx", "ty", "tz", "Rx", "Ry", "Rz")
#: Below this, entries of a pose (m, rad) and of a unit twist are zero.
ROUNDING = 1e-14


@dataclass(frozen=True, eq=False)
class Link:
    """A link and the joint that carries it.

    Attributes
    ----------
    name : str
    parent : Link or None
    jindex : int or None
        The place of its joint in q; None for a link that is fixed to its parent.
    qlim : ndarray, (2,), or None
        Lower and upper limit [rad or m]; None without limits.
    isrevolute, isprismatic, isjoint : bool
    """

    name: str
    parent: Link | None
    jindex: int | None
    qlim: NDArray[np.float64] | None
    isrevolute: bool
    isprismatic: bool
    _mechanism: Mechanism = field(repr=False)
    _base: str | None = field(repr=False)

    def __getattr__(self, name: str) -> Any:
        if name in MASSES:
            raise NotHere(
                f"'{name}' of a link of the Robotics Toolbox is not in cylindroid.rtb; use "
                "Mechanism.mass_matrix, to which the masses of all links add"
            )
        raise AttributeError(f"'Link' object has no attribute '{name}'")

    @property
    def isjoint(self) -> bool:
        return self.jindex is not None

    @property
    def parent_name(self) -> str | None:
        """The name of its parent."""
        return None if self.parent is None else self.parent.name

    @property
    def ets(self) -> ETS:
        """Its elementary transforms: from its parent, or from the base of the robot."""
        return transforms(self._mechanism, self.parent_name or self._base, self.name)

    def A(self, q: float = 0.0) -> NDArray[np.float64]:
        """Its pose in its parent, (4, 4), or in the base of the robot; q is that of its joint."""
        whole = np.zeros(self._mechanism.n)
        if self.jindex is not None:
            whole[self.jindex] = q
        return pose_in(self._mechanism, whole, self.parent_name or self._base, self.name)


@dataclass(frozen=True, eq=False)
class ET:
    """An elementary transform: the motion of a joint along or about an axis, or a constant pose.

    Attributes
    ----------
    kind : str
        'Rx', 'Ry', 'Rz', 'tx', 'ty' or 'tz' of a joint; 'SE3' of a constant pose.
    T : ndarray, (4, 4), or None
        The constant pose (m).
    jindex : int or None
        The place of the joint in q.
    isflip : bool
        True if the joint moves against the axis.
    qlim : ndarray, (2,), or None
        As of a `Link`.
    """

    kind: str
    T: NDArray[np.float64] | None = None
    jindex: int | None = None
    isflip: bool = False
    qlim: NDArray[np.float64] | None = None

    @property
    def axis(self) -> str:
        """The same as `kind`."""
        return self.kind

    @property
    def isjoint(self) -> bool:
        """True if it moves."""
        return self.jindex is not None

    @property
    def isrotation(self) -> bool:
        """True for a revolute joint."""
        return self.kind[0] == "R"

    @property
    def istranslation(self) -> bool:
        """True for a prismatic joint."""
        return self.kind[0] == "t"

    def A(self, q: float = 0.0) -> NDArray[np.float64]:
        """Its pose, (4, 4), with q [rad or m] if it moves."""
        if self.T is not None:
            return self.T.copy()
        twist = np.zeros(6)
        twist[KINDS.index(self.kind)] = -q if self.isflip else q
        return exp(twist)

    def __str__(self) -> str:
        if self.T is None:
            return f"{self.kind}({'-' if self.isflip else ''}q{self.jindex})"
        lengths, angles = self.T[:3, 3], np.degrees(rpy(self.T))
        parts = [_listed(lengths, ""), _listed(angles, "°")]
        return f"SE3({'; '.join(part for part in parts if part)})"


@dataclass(frozen=True, eq=False, repr=False)
class ETS:
    """Elementary transforms in their order, as a sequence; the product of their poses is a pose."""

    data: tuple[ET, ...]

    def __len__(self) -> int:
        return len(self.data)

    def __getitem__(self, i: int) -> ET:
        return self.data[i]

    def __iter__(self) -> Iterator[ET]:
        return iter(self.data)

    @property
    def m(self) -> int:
        """Number of transforms."""
        return len(self)

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joints())

    @property
    def structure(self) -> str:
        """'R' for each revolute and 'P' for each prismatic joint."""
        return "".join("R" if et.isrotation else "P" for et in self.joints())

    @property
    def jindices(self) -> NDArray[np.int64]:
        """The places of the joints in q."""
        return np.array([et.jindex for et in self.joints()], dtype=np.int64)

    def joints(self) -> list[ET]:
        """Those that move."""
        return [et for et in self if et.isjoint]

    def __str__(self) -> str:
        return " ⊕ ".join(str(et) for et in self) or "SE3()"

    __repr__ = __str__


def _listed(numbers: Sequence[float] | NDArray[np.float64], unit: str) -> str:
    if not np.any(np.abs(numbers) > ROUNDING):
        return ""
    return ", ".join(f"{number if abs(number) > ROUNDING else 0.0:.4g}{unit}" for number in numbers)


def pose_in(
    mechanism: Mechanism, q: NDArray[np.float64], start: str | None, end: str
) -> NDArray[np.float64]:
    """The pose of a frame in another, or in the world, (4, 4) or (N, 4, 4)."""
    pose = mechanism.fk(q, end)
    if start is None:
        return pose
    return np.asarray(np.linalg.solve(mechanism.fk(q, start), pose), dtype=np.float64)


def carrier_of(mechanism: Mechanism, frame: str, links: Sequence[str]) -> str:
    """A frame that is one of the links, or the last one that the frame is fixed to."""
    if frame in links:
        return frame
    at = mechanism.home
    fixed = (
        link for link in reversed(links) if not np.any(mechanism.relative_jacobian(at, link, frame))
    )
    found = next(fixed, None)
    if found is None:
        raise NotImplementedError(f"frame = {frame!r} is fixed to no link of the Toolbox's robot")
    return found


def limits_of(mechanism: Mechanism, place: int) -> NDArray[np.float64] | None:
    """Lower and upper limit, (2,); None without limits."""
    limits = np.array([mechanism.lower[place], mechanism.upper[place]])
    return None if np.isinf(limits).all() else limits


def _joints_to(mechanism: Mechanism, link: str) -> list[Any]:
    """The joints from the root to a link."""
    above = {joint.child: joint for joint in mechanism.joints if not joint.closes_loop}
    chain = []
    while (joint := above.get(link)) is not None:
        chain.append(joint)
        link = joint.parent
    return chain[::-1]


def _place_of(mechanism: Mechanism, joints: Sequence[Any], what: str) -> int | None:
    """The place in q of the one coordinate of some joints; None if they are fixed."""
    for joint in joints:
        if joint.mimic is not None:
            raise NotImplementedError(
                f"joint '{joint.name}' follows '{joint.mimic}': {what} has no such joints"
            )
    names = [name for joint in joints for name in joint.coordinates]
    if len(names) > 1:
        raise NotImplementedError(
            f"{', '.join(names)} lie between two links: {what} has one coordinate there"
        )
    return mechanism.joint_names.index(names[0]) if names else None


def links_of(mechanism: Mechanism, names: Sequence[str], base: str | None) -> list[Link]:
    """The links of these names, in their order; each is carried by the next of them below it."""
    found: dict[str, Link] = {}

    def link(name: str) -> Link:
        if name in found:
            return found[name]
        joints: list[Any] = []
        parent = None
        for joint in reversed(_joints_to(mechanism, name)):
            joints.append(joint)
            if joint.parent in names:
                parent = link(joint.parent)
                break
        place = _place_of(mechanism, joints, "a link of the Toolbox")
        angle = place is not None and mechanism.units[place] == "rad"
        limits = None if place is None else limits_of(mechanism, place)
        found[name] = Link(
            name, parent, place, limits, angle, place is not None and not angle, mechanism, base
        )
        return found[name]

    return [link(name) for name in names]


def transforms(mechanism: Mechanism, start: str | None, end: str) -> ETS:
    """From a frame, or the world, outwards to another one."""
    chain = _joints_to(mechanism, carrier_of(mechanism, end, mechanism.links))
    if start is not None:
        inner = _joints_to(mechanism, carrier_of(mechanism, start, mechanism.links))
        moving = [joint.name for joint in inner if joint.coordinates or joint.mimic]
        passed = [joint.name for joint in chain if joint.coordinates or joint.mimic]
        if moving != passed[: len(moving)]:
            raise NotImplementedError(f"start = {start!r} is not on the way from the base to {end!r}")
        chain = [joint for joint in chain if joint.name not in moving]
    found: list[ET] = []
    zero, here = np.zeros(mechanism.n), start
    for joint in chain:
        place = _place_of(mechanism, [joint], "a transform of the Toolbox")
        if place is None:
            continue
        twist = mechanism.jacobian(zero, joint.child, "local")[:, place]
        kind = int(np.argmax(np.abs(twist)))
        unit = np.sign(twist[kind]) * np.eye(6)[kind]
        if np.any(np.abs(twist - unit) > ROUNDING):
            raise NotImplementedError(
                f"joint '{joint.name}' does not move along or about an axis of its link: this has no "
                "elementary transform here"
            )
        found += _constant(pose_in(mechanism, zero, here, joint.child))
        limits = limits_of(mechanism, place)
        found.append(ET(KINDS[kind], None, place, bool(unit[kind] < 0), limits))
        here = joint.child
    return ETS((*found, *_constant(pose_in(mechanism, zero, here, end))))


def _constant(pose: NDArray[np.float64]) -> list[ET]:
    """A constant pose as a transform; none for the identity."""
    return [] if np.all(np.abs(pose - np.eye(4)) <= ROUNDING) else [ET("SE3", pose)]
