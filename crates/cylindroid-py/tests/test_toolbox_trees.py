"""Poses of links, columns, limits and members as those of the Robotics Toolbox.

toolbox_trees.json and toolbox_members.json are of the Toolbox 1.5.0, written by toolbox_trees.py.
"""

import json
import pathlib
import pickle
from types import SimpleNamespace

import numpy as np
import pytest
from test_toolbox import DHLink, Link, Table, pose, tree
from test_toolbox_links import table

import cylindroid as cy
from cylindroid import plot
from cylindroid.rtb import Robot

WRITTEN = json.loads(pathlib.Path(__file__).with_name("toolbox_trees.json").read_text())
TREES, TABLES = WRITTEN["trees"], WRITTEN["tables"]
MEMBERS = json.loads(pathlib.Path(__file__).with_name("toolbox_members.json").read_text())


def robot_of(reference):
    """The tree of the Toolbox that a reference describes."""
    found = {}

    def read(row):
        v = None if row["kind"] is None else SimpleNamespace(kind=row["kind"], isflip=row["isflip"])
        constant, parent = np.array(row["constant"]), found.get(row["parent"])
        link = Link(row["name"], parent, constant, v, row["jindex"], row["qlim"])
        link.number = row["number"]
        return found.setdefault(link.name, link)

    links = [read(row) for row in reference["links"]]
    grippers = [
        SimpleNamespace(
            links=[read(row) for row in gripper["links"]],
            tool=pose(np.array(gripper["tool"])),
            q=gripper["q"],
        )
        for gripper in reference["grippers"]
    ]
    base, tool = (pose(np.array(reference[key])) for key in ("base", "tool"))
    ee_links = [found[name] for name in reference["ee_links"]]
    return SimpleNamespace(
        name="tree", links=links, grippers=grippers, base=base, tool=tool, ee_links=ee_links
    )


def same(found, expected, what=""):
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12, err_msg=what)


@pytest.mark.parametrize("name", TREES)
def test_trees_as_the_toolbox(name):
    expected = TREES[name]
    robot, q = Robot(robot_of(expected)), np.array(expected["q"])
    start, end, way, qd = (expected[key] for key in ("start", "end", "way", "qd"))
    same(robot.fkine_all(q), expected["fkine_all"])
    assert len(expected["fkine_all"]) == robot.nlinks + 1
    same(robot.qlim, expected["qlim"])
    for call in (robot.fkine, robot.jacob0, robot.jacobe):
        same(call(q, end, start), expected[call.__name__], call.__name__)
        many = call(np.stack([q, q + 0.1]), end, start)
        same(many[0], expected[call.__name__])
        # q of the way alone, one and several.
        same(call(q[way], end, start), expected[call.__name__])
        same(call(np.stack([q, q + 0.1])[:, way], end, start), many)
    same(robot.jacob0(q[way], end, start), expected["jacob0 of the way"])
    for method, value in expected["of the end"].items():
        same(getattr(robot, method)(q, end=end), value, method)
    k = len(qd)
    assert robot.jacobm(q, end=end).shape == (k, 1)
    rates = robot.jacob0_dot(q, qd, end=end)
    same(rates, np.einsum("kij,k->ij", robot.hessian0(q, end), qd))
    if expected["jacob0_dot"] is not None:
        same(rates, expected["jacob0_dot"])
        # The others do not matter.
        same(robot.jacob0_dot(q, [*qd, *np.ones(robot.n - k)]), rates)
    J, H = robot.jacob0(q, end), robot.hessian0(q, end)
    assert robot.manipulability(q, J, end) == robot.manipulability(q, end=end)
    same(robot.jacobm(q, J, H, end), robot.jacobm(q, end=end))


@pytest.mark.parametrize("name", TABLES)
def test_tables_as_the_toolbox(name):
    expected = TABLES[name]
    robot = Robot(table(expected))
    same(robot.fkine_all(expected["q"]), expected["fkine_all"])
    same(robot.fkine_all([expected["q"]])[0], expected["fkine_all"])
    np.testing.assert_array_equal(robot.qlim, expected["qlim"])
    assert len(expected["fkine_all"]) == robot.n + 1 == robot.nlinks + 1


def test_columns_from_a_frame_that_moves():
    """The frame is that of the link itself, so that the joint that carries it has no column."""
    robot = Robot(robot_of(TREES["Panda"]))
    q, start = np.array(TREES["Panda"]["q"]), "panda_link3"
    found = robot.jacob0(q, None, start)
    assert found.shape == robot.jacobe(q[3:], None, start).shape == (6, 4)
    for i, step in enumerate(1e-6 * np.eye(7)[3:]):
        ends = [robot.fkine(q + s * step, None, start)[:3, 3] for s in (1, -1)]
        np.testing.assert_allclose(found[:3, i], (ends[0] - ends[1]) / 2e-6, atol=1e-8)
    assert robot.jacob0(q, start, start).shape == (6, 0)
    with pytest.raises(cy.UnknownNameError, match="elbow"):
        robot.jacob0(q, "elbow")


def test_poses_of_links_of_mechanisms_of_this_library():
    for name in ("panda", "five-bar", "stewart"):
        robot = Robot(name)
        q, mechanism = robot.qr, robot.mechanism
        poses = robot.fkine_all(np.stack([q, q]))
        assert poses.shape == (2, len(mechanism.links) + 1, 4, 4)
        np.testing.assert_array_equal(poses[0, 0], np.eye(4))
        for link, found in zip(mechanism.links, poses[1, 1:]):
            np.testing.assert_array_equal(found, mechanism.fk(q, link))
        assert robot.jacob0(q).shape == (6, mechanism.n)


def test_links_without_numbers_are_in_their_order():
    robot, gripper, hand = tree()
    robot.grippers = [gripper]
    found, q = Robot(robot), np.array([0.3, -0.4, 0.1])
    poses = [found.fkine(q, name) for name in ("right", "body", "lift", "left", "hand")]
    same(found.fkine_all(q), [np.eye(4), *poses])
    for number, link in zip((5, 1, 4, 3, 2), (*robot.links, hand)):
        link.number = number
    same(Robot(robot).fkine_all(q)[[0, 5, 1, 4, 3, 2]], [np.eye(4), *poses])


def test_limits_of_joints_without_limits():
    robot = Robot(Table([DHLink(), DHLink(isrevolute=False), DHLink(qlim=(-1.0, 2.0))]))
    assert robot.qlim.tolist() == [[-np.pi, -np.inf, -1.0], [np.pi, np.inf, 2.0]]
    assert np.isinf(robot.mechanism.lower[:2]).all() and robot.links[0].qlim is None
    assert robot.islimit([4.0, 9.0, 2.0]) == [False, False, True]
    assert np.abs(robot.random_q(0)).max() <= np.pi
    free = Robot("five-bar")
    assert free.qlim.tolist() == [[-np.pi] * free.n, [np.pi] * free.n]


def test_speeds():
    panda = Robot("panda")
    np.testing.assert_array_equal(panda.qdlim, panda.mechanism.velocity_limit)
    robot, _, _ = tree()
    assert np.isinf(Robot(robot).qdlim).all()
    robot.qdlim = [1.0, 2.0, 3.0]
    assert Robot(robot).qdlim.tolist() == [1.0, 2.0, 3.0]


def test_searches_beyond_limits():
    links = [DHLink(a=0.4, qlim=(-0.5, 0.5)) for _ in range(3)]
    robot, q = Robot(Table(links)), np.array([0.3, 0.2, 1.9])
    T, options = robot.fkine(q), {"q0": q, "mask": [1, 1, 0, 0, 0, 1]}
    assert not robot.ikine_LM(T, q0=0.1 * q, mask=options["mask"]).success
    found = robot.ikine_LM(T, joint_limits=False, **options)
    assert found.success and np.abs(found.q).max() > 0.5
    same(robot.fkine(found.q)[:3, 3], T[:3, 3])
    assert robot.ik_NR(T, None, None, q, 30, 100, 1e-6, options["mask"], False)[1] == 1
    again = pickle.loads(pickle.dumps(robot)).ikine_LM(T, joint_limits=False, **options)
    np.testing.assert_array_equal(again.q, found.q)
    # Of the way alone; the others stay where they are.
    y = Robot(robot_of(TREES["Planar_Y"]))
    at = np.array(TREES["Planar_Y"]["q"])
    found = y.ikine_LM(y.fkine(at, "eeb"), "eeb", q0=at[[0, 1, 4, 5]], mask=options["mask"])
    assert found.success and found.q.shape == (6,)
    assert Robot("five-bar").ikine_LM(Robot("five-bar").fkine(np.zeros(4)), joint_limits=False).success
    with pytest.raises(NotImplementedError, match="'panda', whose joints have limits; use Robot of a model"):
        Robot("panda").ikine_LM(np.eye(4), joint_limits=False)


def test_every_member_is_there_or_says_what_to_use():
    owners = {"Mechanism": cy.Mechanism, "cylindroid": cy, "cylindroid.plot": plot}
    names = sorted({name for names in MEMBERS.values() for name in names})
    assert len(names) >= 138
    for robot in (Robot("puma560"), Robot(table(TABLES["Puma560"])), Robot(robot_of(TREES["px100"]))):
        here = 0
        for name in names:
            try:
                getattr(robot, name)
                here += 1
            except NotImplementedError as error:
                check_instead(name, str(error), owners)
        assert here >= 58


def check_instead(name, message, owners):
    """What a message says to use is there."""
    start = f"'{name}' of the Robotics Toolbox is not in cylindroid.rtb; use "
    assert message.startswith(start) and len(message) > len(start) + 3, message
    for word in message[len(start) :].replace(",", " ").replace(")", " ").replace("(", " ").split():
        owner, _, member = word.rstrip(".:;").rpartition(".")
        if owner in owners:
            assert hasattr(owners[owner], member), message
