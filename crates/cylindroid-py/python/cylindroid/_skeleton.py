"""A mechanism as points and lines: those of its links between their joints."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import Joint, Mechanism


def drawn_joints(robot: Mechanism) -> list[tuple[int, Joint]]:
    """Joints with a place, numbered: a free body is bound by nothing that could be drawn."""
    return [(i, j) for i, j in enumerate(robot.joints) if j.kind not in ("free", "planar")]


def points_of_links(
    robot: Mechanism, on_parent: NDArray[Any], on_child: NDArray[Any], contacts: NDArray[Any]
) -> dict[str, list[NDArray[Any]]]:
    """The distinct points of each link, from its joints (J, d) and contacts (c, 2, d)."""
    near = 1e-6 * robot.reach
    points: dict[str, list[NDArray[Any]]] = {}

    def add(link: str, point: NDArray[Any]) -> None:
        known = points.setdefault(link, [])
        if all(np.linalg.norm(point - p) > near for p in known):
            known.append(point)

    for i, joint in drawn_joints(robot):
        add(joint.parent, on_parent[i])
        add(joint.child, on_child[i])
    for links, ends in zip(robot.contact_links, contacts):
        for link, point in zip(links, ends):
            add(link, point)
    return points


def moving_links(robot: Mechanism) -> set[str]:
    """The links that are not the ground."""
    return {joint.child for joint in robot.joints if not joint.closes_loop}


def polygon(points: NDArray[Any]) -> NDArray[Any]:
    """The points of a link in the order of their angle about the middle; two are a line."""
    if len(points) < 3:
        return points
    away = points - points.mean(0)
    first, second = np.linalg.svd(away)[2][:2]
    order = np.argsort(np.arctan2(away @ second, away @ first))
    return points[[*order, order[0]]]


def slides(
    robot: Mechanism, on_parent: NDArray[Any], on_child: NDArray[Any]
) -> list[NDArray[Any]]:
    """Lines between the two sides of joints that slide, and of loops that are open."""
    near = 1e-6 * robot.reach
    pairs = [np.array([on_parent[i], on_child[i]]) for i, _ in drawn_joints(robot)]
    return [pair for pair in pairs if np.linalg.norm(pair[1] - pair[0]) > near]
