"""Writes toolbox_trees.json, trees of the Robotics Toolbox and its results for them, and
toolbox_members.json, the names of the public members of its robots.

    pip install roboticstoolbox-python==1.5.0 && python toolbox_trees.py
"""

import json
import pathlib

import numpy as np
import roboticstoolbox
from toolbox_reference import plain


def described(link):
    return {
        "name": link.name,
        "parent": None if link.parent is None else link.parent.name,
        "number": link.number,
        "jindex": link.jindex,
        "kind": link.v.kind if link.isjoint else None,
        "isflip": bool(link.isjoint and link.v.isflip),
        "qlim": plain(link.qlim),
        "constant": plain((link.A(0.0) if link.isjoint else link.A()).A),
    }


def reference(robot, end=None, start=None):
    """Results at q; `start` lies on another branch than `end`, or there is none."""
    q = np.linspace(-0.9, 1.1, robot.n)
    way = robot.ets(start, end).jindices
    qd = np.linspace(0.3, -0.7, robot.ets(None, end).n)
    return {
        "links": [described(link) for link in robot.links],
        "grippers": [
            {
                "links": [described(link) for link in gripper.links],
                "tool": plain(gripper.tool.A),
                "q": plain(gripper.q),
            }
            for gripper in robot.grippers
        ],
        "base": plain(robot.base.A),
        "tool": plain(robot.tool.A),
        "ee_links": [link.name for link in robot.ee_links],
        "q": plain(q),
        "qd": plain(qd),
        "start": start,
        "end": end,
        "way": plain(way),
        "qlim": plain(robot.qlim),
        "fkine_all": [plain(pose.A) for pose in robot.fkine_all(q)],
        "fkine": plain(robot.fkine(q, end, start).A),
        "jacob0": plain(robot.jacob0(q, end, start)),
        "jacobe": plain(robot.jacobe(q, end, start)),
        "of the end": {
            "hessian0": plain(robot.hessian0(q, end)),
            "hessiane": plain(robot.hessiane(q, end)),
            "jacob0_analytical": plain(robot.jacob0_analytical(q, end=end)),
        },
        "jacob0_dot": plain(robot.jacob0_dot(q, qd)) if end is None else None,
        "jacob0 of the way": plain(robot.jacob0(q[way], end, start)),
    }


def tables(robot):
    """A table of which joints some have no limits."""
    q = np.linspace(-0.9, 1.1, robot.n)
    keys = ("theta", "d", "a", "alpha", "offset", "isflip", "isrevolute", "mdh", "qlim")
    return {
        "links": [{key: plain(getattr(link, key)) for key in keys} for link in robot.links],
        "base": plain(robot.base.A),
        "tool": plain(robot.tool.A),
        "q": plain(q),
        "qlim": plain(robot.qlim),
        "fkine_all": [plain(pose.A) for pose in robot.fkine_all(q)],
    }


def members():
    """Of the classes, and of robots that have more, without their named configurations."""
    classes = "Robot DHRobot ERobot Robot2 ERobot2 PoERobot".split()
    found = {name: dir(getattr(roboticstoolbox, name)) for name in classes}
    models = roboticstoolbox.models
    robots = (models.DH.Puma560(), models.URDF.Panda(), models.URDF.px100(), models.ETS.Planar2())
    for robot in robots:
        found[f"{type(robot).__module__}"] = sorted(set(dir(robot)) - set(robot.configs))
    return {owner: [name for name in names if name[0] != "_"] for owner, names in found.items()}


def write(name, value):
    pathlib.Path(__file__).with_name(name).write_text(json.dumps(value) + "\n")


if __name__ == "__main__":
    models = roboticstoolbox.models
    trees = {
        "Panda": reference(models.URDF.Panda()),
        "px100": reference(models.URDF.px100()),
        "Planar_Y": reference(models.ETS.Planar_Y()),
        "Planar_Y across": reference(models.ETS.Planar_Y(), "eeb", "link3a"),
        "Planar_Y, link1": reference(models.ETS.Planar_Y(), "link1"),
    }
    write("toolbox_trees.json", {"trees": trees, "tables": {
        name: tables(getattr(models.DH, name)()) for name in ("Puma560", "Sawyer", "Mico")
    }})
    write("toolbox_members.json", members())
