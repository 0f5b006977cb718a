"""Writes toolbox_reference.json: tables of the Robotics Toolbox and its results for them.

    pip install roboticstoolbox-python==1.5.0 && python toolbox_reference.py
"""

import json
import pathlib

import numpy as np
import roboticstoolbox

NUMBERS = ("theta", "d", "a", "alpha", "offset", "isflip", "isrevolute", "mdh", "qlim", "m", "r", "I")


def plain(value):
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value


def reference(robot):
    q = np.linspace(-0.9, 1.1, robot.n)
    twists, _ = robot.twists(q)
    return {
        "links": [{key: plain(getattr(link, key)) for key in NUMBERS} for link in robot.links],
        "base": plain(robot.base.A),
        "tool": plain(robot.tool.A),
        "q": plain(q),
        "fkine": plain(robot.fkine(q).A),
        "A": [plain(link.A(x).A) for link, x in zip(robot.links, q)],
        "A[2]": plain(robot.A(2, q).A),
        "A[1, 3]": plain(robot.A([1, 3], q).A),
        "jacob0": plain(robot.jacob0(q)),
        "partial_fkine0": plain(robot.partial_fkine0(q, 2)),
        "twists": [plain(twist.S) for twist in twists],
        "inertia": plain(robot.inertia(q)),
        "asada": {axes: plain(robot.manipulability(q, method="asada", axes=axes))
                  for axes in ("all", "trans", "rot")},
        "todegrees": plain(robot.todegrees(q)),
        "structure": robot.ets().structure,
        "jtraj": plain(robot.jtraj(0.0 * q, q, 5).qd[1]),
    }


if __name__ == "__main__":
    models = roboticstoolbox.models.DH
    found = {robot.name: reference(robot) for robot in (models.Panda(), models.UR10())}
    target = pathlib.Path(__file__).with_suffix(".json")
    target.write_text(json.dumps(found) + "\n")
