"""Arrow and DLPack: arrays and tables of other libraries go in, and come out, by protocols."""

import subprocess
import sys

import nanoarrow
import numpy as np
import pandas
import polars
import pyarrow
import pytest
from calls import NEAR, PANDA

import cylindroid as cy

rng = np.random.default_rng(4)
NAMES = PANDA.joint_names
Q = rng.uniform(PANDA.lower, PANDA.upper, (5, 7))
TURNED = {
    "note": ["a", "b", "c", "d", "e"],
    **{name: Q[:, i].copy() for i, name in reversed(list(enumerate(NAMES)))},
}


class Stream:
    """A table of which nothing is known but that it hands out Arrow."""

    def __init__(self, table):
        self._table = table

    def __arrow_c_stream__(self, requested_schema=None):
        return self._table.__arrow_c_stream__(requested_schema)


class Array:
    """The same of an array."""

    def __init__(self, array):
        self._array = array

    def __arrow_c_array__(self, requested_schema=None):
        return self._array.__arrow_c_array__(requested_schema)


class Tensor:
    """A tensor of which nothing is known but that it hands out DLPack."""

    def __init__(self, array):
        self._array = array

    def __dlpack__(self, **options):
        return self._array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self._array.__dlpack_device__()


def rows(values):
    """Rows as Arrow has them: lists of one length."""
    values = np.asarray(values)
    flat = pyarrow.array(values.reshape(-1))
    for size in reversed(values.shape[1:]):
        flat = pyarrow.FixedSizeListArray.from_arrays(flat, size)
    return flat


TABLES = {
    "pyarrow": lambda: Stream(pyarrow.table(TURNED)),
    "polars": lambda: Stream(polars.DataFrame(TURNED)),
    "nanoarrow": lambda: nanoarrow.Array(pyarrow.RecordBatch.from_pydict(TURNED)),
    "batch": lambda: Array(pyarrow.RecordBatch.from_pydict(TURNED)),
    "pieces": lambda: Stream(pyarrow.concat_tables([pyarrow.table(TURNED)[:2], pyarrow.table(TURNED)[2:]])),
    "sliced": lambda: Stream(pyarrow.concat_tables([pyarrow.table(TURNED)] * 2)[5:]),
    "columns": lambda: PANDA.columns(Q),
}


@pytest.mark.parametrize("kind", TABLES)
def test_tables_are_read_by_name(kind):
    np.testing.assert_array_equal(PANDA.ordered(TABLES[kind]()), Q)
    np.testing.assert_array_equal(PANDA.fk(TABLES[kind]()), PANDA.fk(Q))
    swept = cy.sweep(PANDA, configurations=TABLES[kind](), quantities=["pose"])
    np.testing.assert_array_equal(swept["x"], PANDA.fk(Q)[:, 0, 3])


@pytest.mark.parametrize("dtype", ["f4", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8"])
def test_numbers_of_other_types_are_converted(dtype):
    whole = np.arange(14).reshape(2, 7).astype(dtype)
    table = pyarrow.table({name: whole[:, i].copy() for i, name in enumerate(NAMES)})
    np.testing.assert_array_equal(PANDA.ordered(Stream(table)), whole)
    np.testing.assert_array_equal(PANDA.ordered(Array(rows(whole))), whole)


def test_arrays_have_places():
    for array in (rows(Q), Array(rows(Q)), rows(np.vstack([Q, Q]))[5:], nanoarrow.Array(rows(Q))):
        np.testing.assert_array_equal(PANDA.ordered(array), Q)
        np.testing.assert_array_equal(PANDA.jacobian(array), PANDA.jacobian(Q))
    for one in (pyarrow.array(Q[0]), Array(pyarrow.array(Q[0])), polars.Series(Q[0]), pandas.Series(Q[0])):
        np.testing.assert_array_equal(PANDA.fk(one), PANDA.fk(Q[0]))
    J = PANDA.jacobian(Q)
    np.testing.assert_array_equal(cy.pinv(Array(rows(J))).matrix, cy.pinv(J).matrix)
    solution = PANDA.ik(Array(rows(NEAR)), q0=Array(pyarrow.array(PANDA.home)))
    np.testing.assert_array_equal(solution.q, PANDA.ik(NEAR, q0=PANDA.home).q)


def test_tensors_are_read_in_place():
    for q in (Q, Q[0]):
        np.testing.assert_array_equal(PANDA.fk(Tensor(q)), PANDA.fk(q))
    np.testing.assert_array_equal(PANDA.fk(Tensor(Q.astype("f4"))), PANDA.fk(Q.astype("f4")))
    np.testing.assert_array_equal(PANDA.fk(Tensor(np.asfortranarray(Q))), PANDA.fk(Q))
    np.testing.assert_array_equal(PANDA.fk({name: Tensor(c) for name, c in zip(NAMES, Q.T)}), PANDA.fk(Q))


def test_results_are_tensors():
    J = PANDA.jacobian(Q)
    taken = np.from_dlpack(Tensor(J))
    assert np.shares_memory(taken, J)


def test_gaps_and_other_types_are_refused():
    def refused(error, match, **changed):
        with pytest.raises(error, match=match):
            PANDA.fk(Stream(pyarrow.table({**TURNED, **changed})))

    refused(cy.NotFiniteError, "panda_joint2", panda_joint2=[1.0, None, 1.0, 1.0, 1.0])
    refused(cy.NotFiniteError, "panda_joint2", panda_joint2=pyarrow.array([1, None, 1, 1, 1]))
    refused(cy.InvalidOptionError, "column 'panda_joint2'.*real numbers.*Utf8", panda_joint2=["a"] * 5)
    renamed = pyarrow.table(TURNED).rename_columns(
        ["other" if name == "panda_joint2" else name for name in TURNED]
    )
    with pytest.raises(cy.InvalidOptionError, match="no column 'panda_joint2'.*no coordinates: note, other"):
        PANDA.fk(Stream(renamed))
    gaps = pyarrow.array([list(Q[0]), None], pyarrow.list_(pyarrow.float64(), 7))
    with pytest.raises(cy.ArgumentTypeError, match="rows that are null"):
        PANDA.fk(Array(gaps))
    with pytest.raises(cy.ArgumentTypeError, match="real numbers"):
        PANDA.fk(Array(pyarrow.array(["a"])))
    with pytest.raises(cy.ArgumentTypeError, match="real numbers"):
        PANDA.fk(object())


def test_an_interface_that_fails_says_so():
    def batches():
        yield pyarrow.RecordBatch.from_pydict(TURNED)
        raise RuntimeError("the disk is gone")

    schema = pyarrow.RecordBatch.from_pydict(TURNED).schema
    broken = Stream(pyarrow.RecordBatchReader.from_batches(schema, batches()))
    with pytest.raises(cy.CylindroidError, match="the disk is gone"):
        PANDA.fk(broken)


def test_columns_are_read_by_libraries_of_frames():
    columns = PANDA.columns(Q)
    assert list(columns) == columns.keys() == NAMES and len(columns) == 7
    assert columns.units == dict.fromkeys(NAMES, "rad")
    assert NAMES[0] in columns and "other" not in columns and 1 not in columns
    with pytest.raises(cy.UnknownNameError, match="panda_joint3"):
        columns["panda_joint_3"]
    for i, name in enumerate(NAMES):
        np.testing.assert_array_equal(columns[name], Q[:, i])
    table = pyarrow.table(columns)
    assert table.schema.field("panda_joint1").metadata == {b"unit": b"rad"}
    frames = [table, polars.DataFrame(columns), pandas.DataFrame.from_arrow(columns), nanoarrow.Array(columns)]
    for frame in frames:
        np.testing.assert_array_equal(PANDA.ordered(frame), Q)
    # Shared, not copied.
    again = pyarrow.table(columns)
    assert table["panda_joint1"].chunk(0).buffers()[1].address == again["panda_joint1"].chunk(0).buffers()[1].address
    # The memory outlives its owner.
    del columns
    np.testing.assert_array_equal(table["panda_joint7"].to_numpy(), Q[:, 6])
    assert pyarrow.table(PANDA.columns(Q[0])).num_rows == 1
    assert pyarrow.table(PANDA.columns(np.zeros((0, 7)))).num_rows == 0


def test_a_mechanism_without_coordinates_has_rows_without_columns():
    fixed = cy.parse(
        "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='fixed'>"
        "<parent link='a'/><child link='b'/></joint></robot>"
    )
    columns = fixed.columns(np.zeros((3, 0)))
    assert len(columns) == 0 and repr(columns).startswith("<Columns of 3 rows")


def test_trajectories_have_columns():
    trajectory = cy.Servo(PANDA).simulate(PANDA.home, NEAR, duration=0.05, record=True).trajectory
    columns = trajectory.columns()
    frame = polars.DataFrame(columns)
    assert len(frame) == len(trajectory) and len(columns) == 1 + 14 + 7 + 3
    np.testing.assert_array_equal(frame["time"].to_numpy(), trajectory.time)
    np.testing.assert_array_equal(frame["velocity.panda_joint2"].to_numpy(), trajectory.joint_velocities[:, 1])
    np.testing.assert_array_equal(frame["z"].to_numpy(), trajectory.pose[:, 2, 3])
    assert columns.units["velocity.panda_joint2"] == "rad/s" and columns.units["qw"] == "1"
    np.testing.assert_array_equal(PANDA.ordered(columns), trajectory.q)
    quaternion = frame.select("qw", "qx", "qy", "qz").to_numpy()
    np.testing.assert_allclose(np.linalg.norm(quaternion, axis=1), 1.0, rtol=1e-14)


def test_no_library_of_arrow_is_imported():
    code = (
        "import sys, cylindroid as cy; r = cy.load('3r'); r.fk(r.columns(r.home));"
        "assert not {'pandas', 'polars', 'pyarrow', 'rerun'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
