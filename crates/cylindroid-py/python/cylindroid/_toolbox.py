"""Robots of the Robotics Toolbox as mechanisms: their links, by the attributes that they have; and its
members that `cylindroid.rtb` does not have.

The Toolbox is not imported: any object with these attributes is read.

robot : name, links, base, tool, configs; for trees ee_links and grippers (links, tool)
link of elementary transforms : name, parent, isjoint, jindex, qlim, v (kind, isflip), A(q)
link of a Denavit-Hartenberg table : theta, d, a, alpha, offset, isflip, isrevolute, mdh, qlim
any link, where it has them : m, r, I, Jm, G
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from . import InvalidOptionError, Mechanism, parse

#: What to use for members of the Toolbox that are not here.
INSTEAD = {
    "dhunique a alpha d theta offset mdh": "ets, joint by joint, or Mechanism.joint_axes: models other "
    "than tables have no such numbers",
    "ikine_a ikine_analytic ikine_6s analytic_ik isspherical": "Mechanism.ik, which uses closed "
    "forms",
    "plot_ellipse": "cylindroid.plot.ellipsoid",
    "teach": "cylindroid.show",
    "r": "Mechanism.mass_matrix",
    "collided iscollided isselfcollided closest_point": "cylindroid.CollisionModel",
    "link_collision_damper joint_velocity_damper vision_collision_damper": "cylindroid.Servo",
    "dfs_links hierarchy showgraph dotfile graph": "links, each with its parent, or Mechanism.joints",
    "URDF urdf_string urdf_filepath": "cylindroid.load",
    "rne rne_python fdyn accel accel_x coriolis coriolis_x cinertia gravload gravload_x "
    "inertia_x itorque dynamics dynamics_list friction nofriction payload perturb paycap "
    "jointdynamics delete_rne dynchanged gravity payload_capacity": "Pinocchio or "
    "MuJoCo: this library has masses (Mechanism.mass_matrix), but no dynamics",
    "configurations_str": "configs, a dictionary",
    "config_validate": "Mechanism.outside_limits",
    "T": "base, the pose of the robot in the world",
    "tree tree_children": "links, each with its parent, or cylindroid.show",
    "attach attach_to scene_parent scene_children": "Mechanism.with_tool, or a mechanism file of "
    "several robots",
    "copy": "the robot itself: a Mechanism never changes",
    "basemesh fkine_geometry meshdir hasgeometry linkcolormap segments": "cylindroid.show, which "
    "draws the shapes",
    "hascollision": "cylindroid.CollisionModel",
    "fkine_path get_path": "Mechanism.fk_all",
    "grippers": "Mechanism.frames",
    "symbolic": "numbers: nothing here is symbolic",
    "update control_mode default_backend set_default_backend": "cylindroid.show, whose view.q is set",
    "comment manufacturer keywords": "Mechanism.name: files of models have no such texts",
}


#: Numbers of a link of the Toolbox that mechanisms do not give out.
MASSES = ("m", "r", "I", "Jm", "G", "B", "Tc")


class NotHere(NotImplementedError, AttributeError):
    """A member of the Toolbox that is not here; for `hasattr` a missing attribute."""


def instead_of(name: str) -> str | None:
    """What to use for a member of the Toolbox; None of other names."""
    found = (instead for names, instead in INSTEAD.items() if name in names.split())
    return next(found, None)


#: The link that the base of a robot carries.
ROOT = "base of the links"
_AXES = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}


def is_toolbox_robot(robot: object) -> bool:
    """True for an object with links, a base and a tool."""
    return all(hasattr(robot, name) for name in ("links", "base", "tool"))


@dataclass(frozen=True)
class Reading:
    """A robot of the Toolbox as a mechanism."""

    mechanism: Mechanism
    #: The frame of the end effector.
    end: str
    #: The links that it has there.
    links: list[str]
    #: Those whose motors have an inertia.
    motors: list[str]
    #: The links and those of grippers, in the order of their numbers.
    frames: list[str]
    #: Makes the mechanism without limits of its joints.
    unlimited: Callable[[], Mechanism]


def reading_of(robot: Any) -> Reading:
    """The mechanism of a robot of the Toolbox.

    Joints, limits, poses and masses of links are read; motors and meshes are not. Links of grippers are
    read with the joints that their gripper has at the time, and rest there.
    """
    links = list(robot.links)
    if not links:
        raise InvalidOptionError(f"robot = {robot.name!r} cannot be used: it has no links")
    tool = _matrix(robot.tool)
    if hasattr(links[0], "alpha"):
        names = [f"link{i + 1}" for i in range(len(links))]
        joints, last, frames = _of_table(links, names), names[-1], names
    else:
        names = [str(link.name) for link in links]
        joints = _of_transforms(links)
        grippers = getattr(robot, "grippers", None) or []
        every = [*links, *(link for gripper in grippers for link in gripper.links)]
        frames = [str(link.name) for link in sorted(every, key=_number)]
        for gripper in grippers:
            for link in gripper.links:
                at = (gripper.q[link.jindex],) if link.isjoint else ()
                joints.fixed(link.name, link.parent.name, link.name, _matrix(link.A(*at)))
        if grippers:
            # The end effector of an arm with a gripper is the gripper's.
            last, tool = grippers[0].links[0].name, _matrix(grippers[0].tool)
        else:
            last = robot.ee_links[0].name
    joints.fixed(f"{robot.name}: base", "world", ROOT, _matrix(robot.base))
    frame = f"{robot.name}: tool"
    joints.fixed(frame, last, frame, tool)
    for name, link in zip(names, links):
        joints.has_mass(name, link)
    mechanism = parse(joints.urdf(str(robot.name)), "urdf")
    if mechanism.joint_names != joints.names():
        order = ", ".join(mechanism.joint_names)
        raise InvalidOptionError(
            f"robot = {robot.name!r} cannot be used: its joints are not numbered from the base to "
            f"the tips, which would be {order}"
        )
    motors = [name for name, link in zip(names, links) if _is_driven(link)]
    text = joints.urdf(str(robot.name), limits=False)
    unbounded = partial(parse, text, "urdf")
    return Reading(mechanism, frame, names, motors, frames, unbounded)


def _number(link: Any) -> int:
    """That of the Toolbox; those of objects without numbers stay in their order."""
    return int(getattr(link, "number", None) or 0)


def _is_driven(link: Any) -> bool:
    return bool(getattr(link, "Jm", 0.0) and getattr(link, "G", 0.0))


class _Joints:
    """Joints of a URDF."""

    def __init__(self) -> None:
        self.links = [ROOT]
        self.masses: dict[str, str] = {}
        #: Place, name, and the text with limits and without.
        self.moving: list[tuple[int, str, str, str]] = []
        self.rigid: list[str] = []

    def fixed(self, name: str, parent: str, child: str, pose: NDArray[np.float64]) -> None:
        self.links += [link for link in (parent, child) if link not in self.links]
        self.rigid.append(_joint(f"{name} (fixed)", "fixed", parent, child, pose, ""))

    def moves(
        self, place: int, parent: str, child: str, pose: NDArray[np.float64], kind: str,
        sign: int, limits: Any, name: str,
    ) -> None:
        """A joint along or about an axis, such as 'Rz' or 'tx'; in the plane 'R' is about z."""
        self.links += [link for link in (parent, child) if link not in self.links]
        direction = " ".join(str(sign * int(x)) for x in _AXES[kind[1:] or "z"].split())
        axis = f'<axis xyz="{direction}"/>'
        type = "prismatic" if kind[0] == "t" else "continuous"
        free = bounded = _joint(name, type, parent, child, pose, axis)
        if limits is not None and np.all(np.isfinite(limits)):
            inside = f'{axis}<limit lower="{float(limits[0])!r}" upper="{float(limits[1])!r}"/>'
            type = "prismatic" if kind[0] == "t" else "revolute"
            bounded = _joint(name, type, parent, child, pose, inside)
        self.moving.append((place, name, bounded, free))

    def has_mass(self, name: str, link: Any) -> None:
        """The mass of a link, its centre and its inertia about it, in the axes of the link."""
        mass = float(getattr(link, "m", None) or 0.0)
        center = np.asarray(getattr(link, "r", np.zeros(3)), dtype=float)
        inertia = np.asarray(getattr(link, "I", np.zeros((3, 3))), dtype=float)
        if center.shape != (3,) or inertia.shape != (3, 3) or not (mass or np.any(inertia)):
            return
        numbers = " ".join(repr(float(x)) for x in center)
        entries = " ".join(
            f'i{"xyz"[i]}{"xyz"[j]}="{float(inertia[i, j])!r}"' for i in range(3) for j in range(i, 3)
        )
        self.masses[name] = (
            f'<inertial><origin xyz="{numbers}"/><mass value="{mass!r}"/><inertia {entries}/></inertial>'
        )

    def names(self) -> list[str]:
        """The joints in the order of q."""
        return [name for _, name, _, _ in sorted(self.moving)]

    def urdf(self, name: str, limits: bool = True) -> str:
        links = "".join(
            f"<link name={quoteattr(link)}>{self.masses.get(link, '')}</link>" for link in self.links
        )
        joints = "".join(
            bounded if limits else free for _, _, bounded, free in sorted(self.moving)
        )
        return f"<robot name={quoteattr(name)}>{links}{joints}{''.join(self.rigid)}</robot>"


def _joint(
    name: str, type: str, parent: str, child: str, pose: NDArray[np.float64], inside: str
) -> str:
    (roll, pitch, yaw), xyz = rpy(pose[:3, :3]), pose[:3, 3]
    numbers = " ".join(repr(float(x)) for x in xyz)
    return (
        f"<joint name={quoteattr(name)} type='{type}'><parent link={quoteattr(parent)}/>"
        f"<child link={quoteattr(child)}/>"
        f'<origin xyz="{numbers}" rpy="{roll!r} {pitch!r} {yaw!r}"/>{inside}</joint>'
    )


def rpy(R: NDArray[np.float64]) -> tuple[float, float, float]:
    """Angles about fixed x, y, z; accurate also where the pitch is a right angle."""
    pitch = np.arctan2(-R[2, 0], np.hypot(R[0, 0], R[1, 0]))
    yaw = np.arctan2(R[1, 0], R[0, 0])
    s, c = np.sin(yaw), np.cos(yaw)
    roll = np.arctan2(s * R[0, 2] - c * R[1, 2], c * R[1, 1] - s * R[0, 1])
    return float(roll), float(pitch), float(yaw)


def _matrix(pose: Any) -> NDArray[np.float64]:
    """The matrix of an SE3 or SE2, or the array itself; the identity for `None`."""
    whole = np.eye(4)
    if pose is not None:
        matrix = np.asarray(getattr(pose, "A", pose), dtype=float)
        rows = [0, 1, 3] if matrix.shape == (3, 3) else [0, 1, 2, 3]
        whole[np.ix_(rows, rows)] = matrix
    return whole


def _of_transforms(links: list[Any]) -> _Joints:
    joints = _Joints()
    for link in links:
        parent = ROOT if link.parent is None else link.parent.name
        pose = _matrix(link.A(0.0) if link.isjoint else link.A())
        if link.isjoint:
            kind, sign = str(link.v.kind), -1 if link.v.isflip else 1
            joints.moves(link.jindex, parent, link.name, pose, kind, sign, link.qlim, link.name)
        else:
            joints.fixed(link.name, parent, link.name, pose)
    return joints


def _of_table(links: list[Any], names: list[str]) -> _Joints:
    """The joints; where a link ends beyond its joint, the joint has a frame of its own."""
    joints = _Joints()
    parent = ROOT
    for i, (link, name) in enumerate(zip(links, names)):
        theta, d, a, alpha = (float(getattr(link, x)) for x in ("theta", "d", "a", "alpha"))
        offset = float(link.offset)
        if link.isrevolute:
            theta = offset
        else:
            d = offset
        along_x, along_z = _screw("x", alpha, a), _screw("z", theta, d)
        sign, kind = -1 if link.isflip else 1, "Rz" if link.isrevolute else "tz"
        if link.mdh:
            joints.moves(i, parent, name, along_x @ along_z, kind, sign, link.qlim, name)
        else:
            axis = f"axis of {name}"
            joints.moves(i, parent, axis, along_z, kind, sign, link.qlim, name)
            joints.fixed(name, axis, name, along_x)
        parent = name
    return joints


def _screw(axis: str, angle: float, length: float) -> NDArray[np.float64]:
    """A rotation about an axis and a translation along it."""
    s, c = np.sin(angle), np.cos(angle)
    # Right angles are exact.
    s, c = (x if abs(x) > 1e-15 else 0.0 for x in (s, c))
    if axis == "x":
        return np.array([[1, 0, 0, length], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1.0]])
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, length], [0, 0, 0, 1.0]])
