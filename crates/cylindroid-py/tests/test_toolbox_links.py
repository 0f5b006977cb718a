"""Links, transforms, masses and configurations by the names of the Robotics Toolbox.

toolbox_reference.json has results of the Toolbox 1.5.0, written by toolbox_reference.py.
"""

import json
import pathlib
from types import SimpleNamespace

import numpy as np
import pytest
from test_toolbox import rotation, translation, tree

import cylindroid as cy
from cylindroid.rtb import Robot

REFERENCE = json.loads(pathlib.Path(__file__).with_name("toolbox_reference.json").read_text())


def table(reference, **changes):
    """The robot of the Toolbox that a reference describes."""
    links = [SimpleNamespace(**{**link, **changes}) for link in reference["links"]]
    base, tool = (SimpleNamespace(A=np.array(reference[key])) for key in ("base", "tool"))
    return SimpleNamespace(links=links, name="table", base=base, tool=tool, configs={})


def product(poses):
    T = np.eye(4)
    for pose in poses:
        T = T @ pose
    return T


@pytest.mark.parametrize("name", REFERENCE)
def test_as_the_toolbox(name):
    expected = REFERENCE[name]
    robot, q = Robot(table(expected)), np.array(expected["q"])
    links, ets = robot.links, robot.ets()
    found = {
        "base": robot.base,
        "tool": robot.tool,
        "fkine": robot.fkine(q),
        "A": [link.A(x) for link, x in zip(links, q)],
        "A[2]": robot.A(2, q),
        "A[1, 3]": robot.A([1, 3], q),
        "jacob0": robot.partial_fkine0(q, 1),
        "partial_fkine0": robot.partial_fkine0(q, n=2),
        "twists": robot.twists(q)[0],
        "inertia": robot.inertia(q),
        "todegrees": robot.todegrees(q),
        "jtraj": robot.jtraj(0.0 * q, q, 5).qd[1],
    }
    for key, value in found.items():
        np.testing.assert_allclose(value, expected[key], rtol=0.0, atol=1e-9, err_msg=key)
    for axes, value in expected["asada"].items():
        assert abs(robot.manipulability(q, method="asada", axes=axes) - value) < 1e-9 * value
    many = robot.manipulability(np.stack([q, q]), method="asada")
    np.testing.assert_allclose(many, 2 * [expected["asada"]["all"]], rtol=1e-9)
    assert (ets.structure, ets.n) == (expected["structure"], len(q))
    assert [link.jindex for link in links] == ets.jindices.tolist() == list(range(len(q)))
    assert [link.parent_name for link in links] == [None, *(link.name for link in links[:-1])]
    for link, row in zip(links, expected["links"]):
        np.testing.assert_array_equal(link.qlim, row["qlim"])
    assert robot.hasdynamics and robot.nbranches == 1 and robot.base_link.name == links[0].name
    np.testing.assert_allclose(robot.toradians(robot.todegrees(q)), q, rtol=1e-15)


@pytest.mark.parametrize("name", ["panda", "ur5e", "youbot", "3r"])
def test_products_of_links_and_of_transforms_are_the_pose(name):
    robot = Robot(name)
    q = np.random.default_rng(2).uniform(-1, 1, robot.n)
    at = lambda part: part.A(q[part.jindex]) if part.isjoint else part.A()  # noqa: E731
    ets = robot.ets()
    np.testing.assert_allclose(product(map(at, ets)), robot.fkine(q), atol=1e-14)
    assert (ets.structure, ets.m) == (robot.structure, len(ets))
    path, link = [], robot.ee_links[0]
    while link is not None:
        path.insert(0, link)
        link = link.parent
    whole = product([robot.base, *map(at, path), robot.tool])
    np.testing.assert_allclose(whole, robot.fkine(q), atol=1e-14)
    assert len(robot.links) == robot.nlinks and list(robot.link_dict) == robot.mechanism.links
    for link in path:
        np.testing.assert_allclose(product(map(at, link.ets)), at(link), atol=1e-14)
    # From a frame that moves.
    middle = path[len(path) // 2].name
    part = robot.ets(middle)
    assert 0 < part.n < robot.n
    np.testing.assert_allclose(product(map(at, part)), robot.fkine(q, start=middle), atol=1e-14)
    axes, pose = robot.twists(q)
    np.testing.assert_array_equal(axes, robot.mechanism.jacobian(q, reference="world").T)
    np.testing.assert_array_equal(pose, robot.fkine(q))


def test_links_of_trees():
    robot, _, _ = tree()
    right, body, lift, left = robot.links
    ours = Robot(robot)
    assert [link.name for link in ours.links] == ["right", "body", "lift", "left"]
    for link, theirs in zip(ours.links, robot.links):
        assert link.parent_name == (theirs.parent and theirs.parent.name)
        assert (link.isjoint, link.jindex) == (theirs.isjoint, theirs.jindex)
        np.testing.assert_allclose(link.A(0.3), theirs.A(0.3).A, atol=1e-15)
        assert (link.qlim is None) == (theirs.qlim is None)
    assert ours.links[2].isprismatic and ours.links[3].isrevolute and not ours.links[1].isrevolute
    assert [link.name for link in ours.ee_links] == ["right", "left"] and ours.nbranches == 2
    assert ours.base_link.name == "body" and not ours.hasdynamics
    assert str(ours.ets("lift", "left")) == "SE3(0, 0.2, 0) ⊕ Rx(-q1)"
    assert str(ours.ets()) == (
        "SE3(0, 0, 0.3; 28.65°, 0°, 0°) ⊕ tz(q0) ⊕ SE3(0, -0.2, 0) ⊕ Ry(q2)"
    )
    assert str(ours.ets("left", "left")) == "SE3()"
    with pytest.raises(NotImplementedError, match="'left' is not on the way"):
        ours.ets("left", "right")


def test_what_links_and_transforms_do_not_have():
    robot = Robot("panda")
    with pytest.raises(NotImplementedError, match="'r' of a link .* use Mechanism.mass_matrix"):
        robot.links[2].r
    assert not hasattr(robot.links[2], "m")
    with pytest.raises(AttributeError, match="no attribute 'other'"):
        robot.links[2].other
    for name in ("base", "tool"):
        with pytest.raises(NotImplementedError, match=f"'{name}' cannot be set"):
            setattr(robot, name, np.eye(4))
    for n in (0, 3, 4):
        with pytest.raises(NotImplementedError, match=f"n = {n}: derivatives of order 1 and 2"):
            robot.partial_fkine0(robot.qr, n)
    with pytest.raises(NotImplementedError, match="n = 3"):
        robot.partial_fkine0(robot.qr)
    for ask in (lambda: robot.inertia(robot.qr), lambda: robot.manipulability(method="asada")):
        with pytest.raises(cy.ModelError, match="links without mass"):
            ask()
    with pytest.raises(NotImplementedError, match="'asada' of closed chains"):
        Robot("five-bar").manipulability(method="asada")
    with pytest.raises(NotImplementedError, match="u1.first, u1.second lie between two links"):
        Robot("stewart").links
    skew = """<robot name="skew"><link name="a"/><link name="b"/><joint name="j" type="continuous">
        <parent link="a"/><child link="b"/><axis xyz="0 0.6 0.8"/></joint></robot>"""
    with pytest.raises(NotImplementedError, match="joint 'j' does not move along or about an axis"):
        Robot(cy.parse(skew, "urdf")).ets()
    follower = skew.replace("</robot>", """<link name="c"/><joint name="k" type="continuous">
        <parent link="b"/><child link="c"/><mimic joint="j"/></joint></robot>""")
    with pytest.raises(NotImplementedError, match="joint 'k' follows 'j': a link of the Toolbox"):
        Robot(cy.parse(follower, "urdf")).links
    for j in (-1, 9, [2, 1], [0, 1, 2], [0, 9], []):
        with pytest.raises(cy.InvalidOptionError, match="^j: one link or two that rise, 0 to 8"):
            robot.A(j)


def test_motors_are_not_read():
    robot = Robot(table(REFERENCE["UR10"], Jm=2e-4, G=-62.6))
    with pytest.raises(NotImplementedError, match="^the inertia of motors .Jm of link1, link2"):
        robot.inertia(robot.qz)
    assert Robot(table(REFERENCE["UR10"], Jm=0.0, G=1.0)).inertia(np.zeros(6)).shape == (6, 6)


def test_asada_without_six_directions_is_zero():
    robot = Robot(table(REFERENCE["UR10"]))
    assert robot.manipulability(np.zeros(6), method="asada") == 0.0


def test_configurations_are_kept_and_copied():
    robot = Robot("panda")
    q = robot.qr + 0.1
    robot.addconfiguration("ready", q)
    robot.addconfiguration_attr("turned", np.full(7, 90.0), unit="deg")
    np.testing.assert_array_equal(robot.ready, q)
    np.testing.assert_allclose(robot.turned, np.full(7, np.pi / 2), rtol=1e-15)
    robot.q = q
    other = robot.copy()
    other.addconfiguration("ready", robot.qz)
    other.q = robot.qz
    assert other.mechanism is robot.mechanism
    np.testing.assert_array_equal(robot.ready, q)
    np.testing.assert_array_equal(robot.q, q)
    with pytest.raises(cy.InvalidOptionError, match="^unit: 'rad' or 'deg'"):
        robot.addconfiguration_attr("bad", q, unit="turns")
    with pytest.raises(cy.DimensionError):
        robot.addconfiguration("bad", q[:3])


def test_tools_are_in_their_links():
    """A tool frame that is no link lies in the last link that it is fixed to."""
    robot = Robot("panda")
    assert robot.ee_links[0].name == "flange"
    np.testing.assert_allclose(
        robot.tool, rotation("z", -np.pi / 4) @ translation("z", 0.1034), atol=1e-15
    )
    np.testing.assert_array_equal(robot.base, np.eye(4))
