"""Robots of the Robotics Toolbox as mechanisms: their links, by the attributes that they have; and its
members that `cylindroid.rtb` does not have.

The Toolbox is not imported: any object with these attributes is read.

robot : name, links, base, tool, configs; for trees ee_links and grippers (links, tool)
link of elementary transforms : name, parent, isjoint, jindex, qlim, v (kind, isflip), A(q)
link of a Denavit-Hartenberg table : theta, d, a, alpha, offset, isflip, isrevolute, mdh, qlim
"""

from __future__ import annotations

from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from . import InvalidOptionError, Mechanism, parse

#: What to use for members of the Toolbox that are not here.
INSTEAD = {
    "ets twists dhunique A a alpha d theta offset mdh": "Mechanism.joint_axes and Mechanism.fk_all",
    "ikine_a ikine_analytic ikine_6s analytic_ik isspherical": "Mechanism.ik, which uses closed "
    "forms",
    "plot_ellipse": "cylindroid.plot.ellipsoid",
    "teach": "cylindroid.show",
    "inertia r": "Mechanism.mass_matrix",
    "collided iscollided isselfcollided closest_point": "cylindroid.CollisionModel",
    "link_collision_damper joint_velocity_damper vision_collision_damper": "cylindroid.Servo",
    "partial_fkine0": "Mechanism.hessian, the second derivative; higher ones are not here",
    "links link_dict dfs_links hierarchy showgraph dotfile nlinks nbranches": "Mechanism.joints and "
    "Mechanism.links",
    "base base_link tool ee_links": "Mechanism.frames, and tool= of fkine and jacob0",
    "URDF urdf_string urdf_filepath": "cylindroid.load",
    "rne rne_python fdyn accel accel_x coriolis coriolis_x cinertia gravload gravload_x "
    "inertia_x itorque dynamics dynamics_list friction nofriction payload perturb paycap "
    "jointdynamics delete_rne dynchanged gravity hasdynamics payload_capacity": "Pinocchio or "
    "MuJoCo: this library has masses (Mechanism.mass_matrix), but no dynamics",
    "addconfiguration addconfiguration_attr configurations_str": "configs, a dictionary",
    "config_validate": "Mechanism.outside_limits",
    "attach attach_to": "Mechanism.with_tool, or a mechanism file of several robots",
    "copy": "the robot itself: a Mechanism never changes",
    "basemesh fkine_geometry meshdir hasgeometry linkcolormap segments": "cylindroid.show, which "
    "draws the shapes",
    "hascollision": "cylindroid.CollisionModel",
    "fkine_path get_path": "Mechanism.fk_all",
    "graph": "Mechanism.joints and Mechanism.links",
    "grippers": "Mechanism.frames",
    "symbolic": "numbers: nothing here is symbolic",
    "todegrees toradians": "numpy.degrees and numpy.radians",
    "update control_mode default_backend set_default_backend": "cylindroid.show, whose view.q is set",
    "comment manufacturer keywords": "Mechanism.name: files of models have no such texts",
}


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


def mechanism_of(robot: Any) -> tuple[Mechanism, str]:
    """The mechanism of a robot of the Toolbox, and the frame of its end effector.

    Joints, limits and poses are read; masses, meshes and the fingers of grippers are not.
    """
    links = list(robot.links)
    if not links:
        raise InvalidOptionError(f"robot = {robot.name!r} cannot be used: it has no links")
    tool = _matrix(robot.tool)
    if hasattr(links[0], "alpha"):
        joints, last, pose = _of_table(links)
        tool = pose @ tool
    else:
        joints = _of_transforms(links)
        grippers = getattr(robot, "grippers", None) or []
        if grippers:
            # The end effector of an arm with a gripper is the gripper's.
            hand, tool = grippers[0].links[0], _matrix(grippers[0].tool)
            last = hand.name
            joints.fixed(last, hand.parent.name, last, _matrix(hand.A()))
        else:
            last = robot.ee_links[0].name
    joints.fixed(f"{robot.name}: base", "world", ROOT, _matrix(robot.base))
    frame = f"{robot.name}: tool"
    joints.fixed(frame, last, frame, tool)
    mechanism = parse(joints.urdf(str(robot.name)), "urdf")
    if mechanism.joint_names != joints.names():
        order = ", ".join(mechanism.joint_names)
        raise InvalidOptionError(
            f"robot = {robot.name!r} cannot be used: its joints are not numbered from the base to "
            f"the tips, which would be {order}"
        )
    return mechanism, frame


class _Joints:
    """Joints of a URDF."""

    def __init__(self) -> None:
        self.links = [ROOT]
        self.moving: list[tuple[int, str, str]] = []
        self.rigid: list[str] = []

    def fixed(self, name: str, parent: str, child: str, pose: NDArray[np.float64]) -> None:
        self.links += [link for link in (parent, child) if link not in self.links]
        self.rigid.append(_joint(f"{name} (fixed)", "fixed", parent, child, pose, ""))

    def moves(
        self, place: int, parent: str, child: str, pose: NDArray[np.float64], kind: str,
        sign: int, limits: Any,
    ) -> None:
        """A joint along or about an axis, such as 'Rz' or 'tx'; in the plane 'R' is about z."""
        self.links += [link for link in (parent, child) if link not in self.links]
        direction = " ".join(str(sign * int(x)) for x in _AXES[kind[1:] or "z"].split())
        inside = f'<axis xyz="{direction}"/>'
        bounded = limits is not None and np.all(np.isfinite(limits))
        type = "prismatic" if kind[0] == "t" else "revolute" if bounded else "continuous"
        if bounded:
            inside += f'<limit lower="{float(limits[0])!r}" upper="{float(limits[1])!r}"/>'
        self.moving.append((place, child, _joint(child, type, parent, child, pose, inside)))

    def names(self) -> list[str]:
        """The joints in the order of q."""
        return [name for _, name, _ in sorted(self.moving)]

    def urdf(self, name: str) -> str:
        links = "".join(f"<link name={quoteattr(link)}/>" for link in self.links)
        joints = "".join(text for _, _, text in sorted(self.moving))
        return f"<robot name={quoteattr(name)}>{links}{joints}{''.join(self.rigid)}</robot>"


def _joint(
    name: str, type: str, parent: str, child: str, pose: NDArray[np.float64], inside: str
) -> str:
    (roll, pitch, yaw), xyz = _rpy(pose[:3, :3]), pose[:3, 3]
    numbers = " ".join(repr(float(x)) for x in xyz)
    return (
        f"<joint name={quoteattr(name)} type='{type}'><parent link={quoteattr(parent)}/>"
        f"<child link={quoteattr(child)}/>"
        f'<origin xyz="{numbers}" rpy="{roll!r} {pitch!r} {yaw!r}"/>{inside}</joint>'
    )


def _rpy(R: NDArray[np.float64]) -> tuple[float, float, float]:
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
            joints.moves(link.jindex, parent, link.name, pose, kind, sign, link.qlim)
        else:
            joints.fixed(link.name, parent, link.name, pose)
    return joints


def _of_table(links: list[Any]) -> tuple[_Joints, str, NDArray[np.float64]]:
    """The joints, the last link and the pose of its end."""
    joints = _Joints()
    name, pose = ROOT, np.eye(4)
    for i, link in enumerate(links):
        theta, d, a, alpha = (float(getattr(link, x)) for x in ("theta", "d", "a", "alpha"))
        offset = float(link.offset)
        if link.isrevolute:
            theta = offset
        else:
            d = offset
        before, after = _screw("x", alpha, a), _screw("z", theta, d)
        sign = -1 if link.isflip else 1
        kind = "Rz" if link.isrevolute else "tz"
        pose = pose @ before @ after if link.mdh else pose @ after
        child = f"link{i + 1}"
        joints.moves(i, name, child, pose, kind, sign, link.qlim)
        name, pose = child, np.eye(4) if link.mdh else before
    return joints, name, pose


def _screw(axis: str, angle: float, length: float) -> NDArray[np.float64]:
    """A rotation about an axis and a translation along it."""
    s, c = np.sin(angle), np.cos(angle)
    # Right angles are exact.
    s, c = (x if abs(x) > 1e-15 else 0.0 for x in (s, c))
    if axis == "x":
        return np.array([[1, 0, 0, length], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1.0]])
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, length], [0, 0, 0, 1.0]])
