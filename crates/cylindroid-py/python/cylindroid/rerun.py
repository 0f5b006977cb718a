"""Robots in the viewer of Rerun (``pip install .[rerun]``).

Whoever calls ``log`` starts the recording: ``rerun.init("my robot", spawn=True)``, or a
``rerun.RecordingStream`` that is handed over.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import InvalidOptionError, Mechanism
from ._skeleton import drawn_joints, moving_links, points_of_links, polygon, slides

__all__ = ["log"]


def _sdk() -> Any:
    try:
        import rerun
    except ImportError as error:
        raise ImportError(
            "this needs Rerun: pip install rerun-sdk, or this package with [rerun]"
        ) from error
    return rerun


def _strips(
    robot: Mechanism, on_parent: NDArray[Any], on_child: NDArray[Any], contacts: NDArray[Any]
) -> list[NDArray[Any]]:
    """The lines of one configuration."""
    points, moving = points_of_links(robot, on_parent, on_child, contacts), moving_links(robot)
    links = [polygon(np.array(p)) for link, p in points.items() if link in moving and len(p) > 1]
    return links + slides(robot, on_parent, on_child)


def log(
    robot: Mechanism,
    q: ArrayLike | Mapping[str, ArrayLike],
    path: str | None = None,
    *,
    time: ArrayLike | None = None,
    recording: Any = None,
) -> None:
    """Logs a robot to Rerun, at one configuration or along many.

    Entities: ``path/frames/NAME`` is the pose of each frame in the world, ``path/links`` are the lines
    of the links between their joints, ``path/joints`` the places of the joints (orange if actuated,
    otherwise white), ``path/q/NAME`` is the number of each coordinate [rad or m].

    Parameters
    ----------
    robot : Mechanism
    q : array_like, (n,) or (N, n), or columns with names
        One configuration is logged at the present time of the recording (``rerun.set_time``), many
        in one go on a timeline of their own.
    path : str, optional
        Where the entities begin. Default: the name of the robot.
    time : array_like, (N,), or float for one configuration, optional
        Seconds on the timeline 'time'. Default for many: 0, 1, 2, ... on the timeline 'step'.
    recording : rerun.RecordingStream, optional
        Default: the present one of Rerun.

    Raises
    ------
    DimensionError, NotFiniteError, InvalidOptionError
    """
    rr = _sdk()
    path = robot.name if path is None else path
    values = robot.ordered(q)
    rows = np.atleast_2d(values)
    if time is None:
        index = [rr.TimeColumn("step", sequence=np.arange(len(rows)))] if values.ndim == 2 else None
    else:
        seconds = np.atleast_1d(np.asarray(time, dtype=float))
        if seconds.shape != rows.shape[:1]:
            raise InvalidOptionError(
                f"time has shape {seconds.shape} and q {values.shape}: give a time for each "
                "configuration"
            )
        index = [rr.TimeColumn("time", duration=seconds)]

    def send(entity: str, archetype: Any, lengths: list[int] | None = None, **parts: Any) -> None:
        """Rows of an archetype, of `lengths` where a row has several instances."""
        entity = f"{path}/{entity}"
        if index is None:
            one = parts if lengths is not None else {k: v[0] for k, v in parts.items()}
            rr.log(entity, archetype(**one), recording=recording)
            return
        columns = archetype.columns(**parts)
        columns = columns if lengths is None else columns.partition(lengths)
        rr.send_columns(entity, index, columns, recording=recording)

    poses = robot.fk_all(rows)
    for i, name in enumerate(robot.frames):
        frame = poses[:, i]
        send(f"frames/{name}", rr.Transform3D, translation=frame[:, :3, 3], mat3x3=frame[:, :3, :3])
    for name, column in zip(robot.joint_names, rows.T):
        send(f"q/{name}", rr.Scalars, scalars=column)

    on_parent, on_child = (robot.joint_axes(rows, side)[:, :, 0] for side in ("parent", "child"))
    contacts = robot.contact_points(rows)
    strips = [_strips(robot, *at) for at in zip(on_parent, on_child, contacts)]
    flat = [strip for of_one in strips for strip in of_one]
    if flat:
        send("links", rr.LineStrips3D, [len(of_one) for of_one in strips], strips=flat)
    shown = [(i, j) for i, j in drawn_joints(robot) if j.coordinates or j.mimic or j.closes_loop]
    if shown:
        places = on_parent[:, [i for i, _ in shown]]
        colors = [[255, 127, 14] if j.actuated else [255, 255, 255] for _, j in shown]
        send(
            "joints",
            rr.Points3D,
            [len(shown)] * len(rows),
            positions=places.reshape(-1, 3),
            colors=colors * len(rows),
            radii=np.full(len(shown) * len(rows), 0.015 * robot.reach),
        )
