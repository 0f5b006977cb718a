"""Columns with names in any order: the numbers that an array in the order of the joints gives."""

import pathlib
import subprocess
import sys

import numpy as np
import pandas
import polars
import pyarrow
import pytest
from calls import PANDA, calls

import cylindroid as cy

rng = np.random.default_rng(3)
NAMES = PANDA.joint_names
Q = rng.uniform(PANDA.lower, PANDA.upper, (5, 7))
#: Another order, with columns that are no coordinates.
TURNED = {
    "time": np.arange(5.0),
    **{name: Q[:, i] for i, name in reversed(list(enumerate(NAMES)))},
    "note": ["a", "b", "c", "d", "e"],
}
KINDS = {
    "dict": TURNED,
    "pandas": pandas.DataFrame(TURNED),
    "polars": polars.DataFrame(TURNED),
    "pyarrow": pyarrow.table(TURNED),
    "batch": pyarrow.RecordBatch.from_pydict(TURNED),
    "prefix": {f"q.{name}" if name in NAMES else name: values for name, values in TURNED.items()},
}


@pytest.mark.parametrize("kind", KINDS)
def test_columns_are_matched_by_name(kind):
    q = KINDS[kind]
    np.testing.assert_array_equal(PANDA.ordered(q), Q)
    np.testing.assert_array_equal(PANDA.fk(q), PANDA.fk(Q))
    np.testing.assert_array_equal(PANDA.jacobian(q), PANDA.jacobian(Q))
    own, found = PANDA.measures(Q), PANDA.measures(q)
    assert all(np.array_equal(own[name], found[name]) for name in own)
    targets = PANDA.fk(Q)
    np.testing.assert_array_equal(PANDA.ik(targets, q0=q).q, PANDA.ik(targets, q0=Q).q)
    swept = cy.sweep(PANDA, configurations=q, quantities=["pose"])
    np.testing.assert_array_equal(swept["x"], PANDA.fk(Q)[:, 0, 3])


def test_rows_are_matched_by_name():
    row = pandas.DataFrame(TURNED).drop(columns="note").iloc[2]
    for q in (row, {name: Q[2, i] for i, name in reversed(list(enumerate(NAMES)))}):
        assert PANDA.ordered(q).shape == (7,)
        np.testing.assert_array_equal(PANDA.fk(q), PANDA.fk(Q[2]))
    # q and qd beside each other, as in the trajectories of `move`.
    both = {f"{kind}.{name}": Q[k, i] for i, name in enumerate(NAMES) for k, kind in enumerate(("q", "qd"))}
    expected = PANDA.jacobian_dot(Q[0], Q[1])
    np.testing.assert_array_equal(PANDA.jacobian_dot(both, both), expected)


def test_labels_that_count_are_places():
    np.testing.assert_array_equal(PANDA.fk(pandas.DataFrame(Q)), PANDA.fk(Q))
    np.testing.assert_array_equal(PANDA.fk(pandas.Series(Q[0])), PANDA.fk(Q[0]))
    turned = pandas.DataFrame(Q)[[6, 5, 4, 3, 2, 1, 0]]
    for q in (turned, turned.iloc[0], dict(enumerate(Q[0]))):
        with pytest.raises(cy.InvalidOptionError, match="no column 'panda_joint1'.*no coordinates: "):
            PANDA.fk(q)


#: Arguments with a number for each coordinate.
COORDINATES = ("q", "qd", "q0", "posture", "to", "start", "guess", "configurations")


def with_names():
    for name, call, arguments in calls():
        owner = getattr(call, "__self__", None)
        robot = arguments.get("mechanism", arguments.get("robot", owner))
        given = [a for a in COORDINATES if isinstance(arguments.get(a), (np.ndarray, list))]
        if isinstance(robot, cy.Mechanism) and given:
            yield pytest.param(robot, call, arguments, given, id=name)


def test_many_calls_are_compared():
    assert len(list(with_names())) > 25


@pytest.mark.parametrize(("robot", "call", "arguments", "given"), list(with_names()))
def test_every_call_reads_names(robot, call, arguments, given):
    def named(values):
        values = np.asarray(values)
        assert values.shape[-1] == robot.n
        return {name: values[..., i] for i, name in reversed(list(enumerate(robot.joint_names)))}

    found = call(**arguments | {name: named(arguments[name]) for name in given})
    expected = call(**arguments)
    if not isinstance(expected, (np.ndarray, dict, list)) and type(expected).__repr__ is object.__repr__:
        assert type(found) is type(expected)
    else:
        assert repr(found) == repr(expected)


def test_servos_read_names():
    q = {name: PANDA.home[i] for i, name in reversed(list(enumerate(NAMES)))}
    target = PANDA.fk(PANDA.home + 0.05)

    def run(q):
        servo = cy.Servo(PANDA, secondary="posture", posture=q)
        yield servo.step(q, target)
        yield servo.advance(q)
        yield servo.step_twist(q, [0.1, 0, 0, 0, 0, 0])
        yield servo.simulate(q, target, duration=0.05).q
        yield servo.find_reachable_configuration(q, target)
        many = cy.TaskServo(PANDA, [cy.FrameTask("flange", target)])
        yield many.step(q)
        yield many.advance(q)
        yield cy.CollisionModel(PANDA).near(q, 0.5).distances
        stewart = cy.load("stewart")
        home = dict(zip(stewart.joint_names, stewart.home)) if isinstance(q, dict) else stewart.home
        tracking = cy.Servo(stewart)
        tracking.start_from(home)
        yield tracking.configuration

    for found, expected in zip(run(q), run(PANDA.home), strict=True):
        np.testing.assert_array_equal(found, expected)
    with pytest.raises(cy.InvalidOptionError, match="q.*order of its joint_names"):
        cy.PostureTask(q)


def test_robots_of_the_toolbox_read_names():
    from cylindroid.rtb import Robot

    robot = Robot("puma560")
    q = robot.qr + 0.1
    named = {name: q[i] for i, name in reversed(list(enumerate(robot.mechanism.joint_names)))}
    np.testing.assert_array_equal(robot.fkine(named), robot.fkine(q))
    assert robot.islimit(named) == robot.islimit(q)
    assert robot.manipulability(named) == robot.manipulability(q)
    many = pandas.DataFrame([named, named])
    np.testing.assert_array_equal(robot.manipulability(many), [robot.manipulability(q)] * 2)


def test_missing_and_unknown_columns_are_named():
    frame = KINDS["pandas"].rename(columns={"panda_joint3": "panda_joint_3"})
    with pytest.raises(cy.InvalidOptionError) as raised:
        PANDA.fk(frame)
    message = str(raised.value)
    assert "q = the columns" in message and "no column 'panda_joint3'" in message
    assert "no coordinates: time, panda_joint_3, note" in message
    twice = pandas.concat([KINDS["pandas"], KINDS["pandas"]], axis=1)
    with pytest.raises(cy.InvalidOptionError, match="several columns are 'panda_joint1'"):
        PANDA.fk(twice)
    both = {**TURNED, "q.panda_joint1": TURNED["time"]}
    with pytest.raises(cy.InvalidOptionError, match="several columns are 'panda_joint1'"):
        PANDA.jacobian(both)
    with pytest.raises(cy.InvalidOptionError, match="q0.*no column 'panda_joint1'"):
        PANDA.ik(PANDA.fk(Q[0]), q0={})
    with pytest.raises(cy.InvalidOptionError, match="one configuration is needed"):
        PANDA.outside_limits(TURNED)


def test_wrong_columns_are_named():
    def refused(error, match, **changed):
        with pytest.raises(error, match=match):
            PANDA.fk({**TURNED, **changed})

    refused(cy.InvalidOptionError, "column 'panda_joint2'.*others have 5 rows", panda_joint2=[1.0])
    refused(cy.InvalidOptionError, "column 'panda_joint2'.*others have 5 rows", panda_joint2=1.0)
    refused(cy.InvalidOptionError, "column 'panda_joint2'.*real numbers", panda_joint2=["a"] * 5)
    refused(cy.InvalidOptionError, "column 'panda_joint2'.*real numbers", panda_joint2=[None] * 5)
    refused(cy.NotFiniteError, "panda_joint2", panda_joint2=[1.0, np.nan, 1.0, 1.0, 1.0])
    gap = pyarrow.table({**TURNED, "panda_joint2": [1.0, None, 1.0, 1.0, 1.0]})
    with pytest.raises(cy.NotFiniteError, match="panda_joint2"):
        PANDA.fk(gap)


def test_libraries_of_frames_are_not_imported():
    code = (
        "import sys, cylindroid as cy; r = cy.load('3r'); r.fk(dict.fromkeys(r.joint_names, 0.0));"
        "assert not {'pandas', 'polars', 'pyarrow'} & set(sys.modules)"
    )
    folder = pathlib.Path(cy.__file__).parents[1]
    subprocess.run([sys.executable, "-c", code], check=True, cwd=folder)
