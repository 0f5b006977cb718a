"""Zero is a size: public calls for no and for one joint, link, actuator, loop, contact, row and
sample give a result or an error of the package, and every part of a result can be read."""

import inspect
import itertools
import random

import numpy as np
import pytest
from calls import public

import cylindroid as cy

URDF = '<robot name="r"><link name="a"/>{}</robot>'
JOINT = """<link name="b"/><joint name="j" type="{}"><parent link="a"/><child link="b"/>
<axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint>"""
TOML = 'name = "m"\nreference = "a"\n'
PART = """
[[joint]]
name = "{0}"
type = "{1}"
between = ["{2}", "{3}"]
origin = [{4}, {5}, 0]
actuated = {6}
"""
PIN = 'axis = [0, 0, 1]'
TOUCH = """
[[contact]]
name = "c"
type = "hard_finger"
between = ["ground", "a"]
point = [1, 0, 0]
normal = [-1, 0, 0]
"""


def triangle(actuated):
    sides = [("ground", "a", 0, 0), ("a", "b", 1, 0), ("b", "ground", 0, 1)]
    return TOML + "".join(
        PART.format(f"p{i}", "revolute", *side, actuated) + PIN for i, side in enumerate(sides)
    )


FREE = TOML + PART.format("f", "free", "ground", "a", 0, 0, "false")
MECHANISMS = {
    "one link": cy.parse(URDF.format("")),
    "fixed": cy.parse(URDF.format(JOINT.format("fixed"))),
    "revolute": cy.parse(URDF.format(JOINT.format("revolute"))),
    "prismatic": cy.parse(URDF.format(JOINT.format("prismatic"))),
    "passive": cy.parse(TOML + PART.format("p", "revolute", "ground", "a", 0, 0, "false") + PIN, "toml"),
    "free": cy.parse(FREE, "toml"),
    "touched": cy.parse(FREE + TOUCH, "toml"),
    "rigid": cy.parse(triangle("false"), "toml"),
    "rigid, actuated": cy.parse(triangle("true"), "toml"),
    "no actuator": cy.load("five-bar").with_actuated([]),
    "one actuator": cy.load("five-bar").with_actuated(["q1"]),
}
POSES = [np.eye(4), np.zeros((0, 4, 4)), np.eye(4)[None]]
MATRICES = [np.ones(shape) for shape in [(0, 0), (0, 1), (1, 0), (6, 0), (6, 1), (0, 6, 1), (1, 6, 1), (1, 1)]]
VECTORS = [[], [0.0], np.zeros(6), np.ones(6), np.zeros(3)]
COUNTS = [0, 1]
NAMES = [None, []]
POINTS = [[cy.FingerContact([1, 0, 0], [-1, 0, 0])] * n for n in (0, 1)]


def choices(name, robot):
    """Values of size zero and one for an argument."""
    n = robot.n if robot else 1
    rows = [np.zeros(n), np.zeros((0, n)), np.zeros((1, n)), []]
    first = [robot.actuated[:1]] if robot else [["q1"]]
    known = {
        **dict.fromkeys(("q", "qd", "q0", "guess", "start", "to", "end", "desired", "measured"), rows),
        **dict.fromkeys(("target", "pose", "tool", "a_from_b", "b_from_a", "via"), POSES),
        **dict.fromkeys(("actuated", "hold", "names", "fixed"), NAMES + first),
        **dict.fromkeys(("J", "Ja", "Jp", "G", "K", "motions", "complement", "lines", "matrix"), MATRICES),
        **dict.fromkeys(("Wu", "Wq", "Ww", "Wtau", "Wt", "metric", "joint_metric", "joint_weights",
                         "task_weights", "compliance", "limits", "posture", "secondary"), [None, [], [1.0]]),
        **dict.fromkeys(("count", "starts", "iterations", "max_restarts", "seed"), COUNTS),
        **dict.fromkeys(("dt", "duration", "distance", "speed", "acceleration", "length", "angle",
                         "step", "h", "t", "s", "jerk", "velocity"), [0.0, 1.0, []]),
        "mechanism": list(MECHANISMS.values()),
        "along": MATRICES + [0.0, 1.0],
        "goal": [{}, {"q1": 0.0}, {"j": 0.0}],
        "stiffness": [None, {}, 1.0, []],
        "give_up": [None, [], ["x"]],
        "contacts": POINTS,
        "components": [None, [], "x", "x,y"],
        "task": [None, [], "x"],
        "text": ["", URDF.format("")],
    }
    return known.get(name, VECTORS)


def read(thing, depth=3):
    """Every attribute and the texts of a result."""
    if isinstance(thing, (list, tuple)):
        for part in thing[:2]:
            read(part, depth)
    if not type(thing).__module__.startswith("cylindroid") or depth == 0:
        return
    str(thing), repr(thing)
    for name in dir(thing):
        if not name.startswith("_"):
            part = getattr(thing, name)
            if not callable(part):
                read(part, depth - 1)


def tried(call, robot):
    """Results of a call with all kinds of small arguments."""
    parameters = [
        p for p in inspect.signature(call).parameters.values()
        if p.name != "self" and p.kind is not p.VAR_KEYWORD
    ]
    needed = [p for p in parameters if p.default is p.empty]
    more = [p for p in parameters if p.default is not p.empty]
    sets = [needed, *([*needed, p] for p in more), parameters]
    pick = random.Random(1)
    for names in sets:
        values = [choices(p.name, robot) for p in names]
        every = list(itertools.islice(itertools.product(*values), 4000))
        for chosen in pick.sample(every, min(len(every), 40)):
            arguments = dict(zip([p.name for p in names], chosen))
            try:
                found = call(**arguments)
                read(found)
            except TypeError as error:
                # Of arguments that exclude one another, or that have another type.
                assert any(name in str(error) for name in arguments), f"{call.__qualname__}: {error}"
                continue
            except cy.CylindroidError:
                continue
            except BaseException as error:
                shapes = {k: getattr(v, "shape", v) for k, v in arguments.items()}
                pytest.fail(f"{call.__qualname__} of {robot!r} with {shapes}: {error!r}")
            yield found


@pytest.mark.parametrize("name", MECHANISMS)
def test_mechanisms_of_small_sizes(name):
    robot = MECHANISMS[name]
    read(robot)
    results = 0
    for path in public():
        if path.startswith("Mechanism."):
            results += len(list(tried(getattr(robot, path.split(".")[1]), robot)))
    assert results > 50
    try:
        servo = cy.Servo(robot)
    except cy.CylindroidError:
        return
    for method in ("step", "advance", "simulate", "find_reachable_configuration"):
        list(tried(getattr(servo, method), robot))
        read(servo)
    list(tried(lambda q, to, speed=None: cy.JointMove(robot, q, to, speed), robot))


def test_functions_of_small_sizes():
    results = {}
    for path in public():
        if "." not in path and path not in ("load", "Servo", "JointMove", "OperatorAuthority"):
            results[path] = list(tried(getattr(cy, path), None))
            for thing in results[path][:20]:
                members = [p.split(".")[1] for p in public() if p.startswith(f"{path}.")]
                for member in members:
                    list(tried(getattr(thing, member), None))
    assert sum(map(len, results.values())) > 100


def test_a_mechanism_without_coordinates_has_measures():
    robot = MECHANISMS["fixed"]
    one = robot.measures([])
    assert one["dof"] == 0 and one["closed"]
    for count in (0, 1, 3):
        many = robot.measures(np.zeros((count, 0)))
        for name, value in one.items():
            assert many[name].shape == (count,)
            np.testing.assert_array_equal(many[name], np.full(count, value))
