"""Sweeps on executors and on Ray: the bytes are those of one machine."""

import concurrent.futures
import hashlib
import os
import pathlib
import pickle
import secrets
import shutil
import subprocess
import sys
import time

import numpy as np
import pytest

import cylindroid as cy

ROWS = 150_000
HERE = pathlib.Path(__file__).parent
robot = cy.load("youbot")


def bend(q, names):
    return abs(q).sum(1)


def ends_the_worker(q, names):
    os._exit(1)


COLUMNS = {"bend": cy.SweepColumn(bend, "rad", "1")}
SWEEP = {"mechanism": robot, "samples": ROWS, "quantities": ["pose", "yoshikawa"], "columns": COLUMNS}


def checksums(folder):
    files = [path for path in folder.iterdir() if path.name != ".lock"]
    assert not any(path.name.startswith(".") for path in files)
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The checksums of one process."""
    folder = tmp_path_factory.mktemp("sweep")
    cy.sweep(**SWEEP, out=folder)
    return checksums(folder)


KINDS = [concurrent.futures.ThreadPoolExecutor, concurrent.futures.ProcessPoolExecutor]


@pytest.mark.parametrize("kind", KINDS, ids=["threads", "processes"])
def test_executors_write_the_same_bytes(kind, whole, tmp_path):
    with kind(2) as engine:
        summary = cy.sweep(**SWEEP, out=tmp_path / "own", engine=engine)
        assert (summary.folder, summary.rows, summary.parts) == (tmp_path / "own", ROWS, 3)
        assert summary.computed == ROWS
        assert checksums(tmp_path / "own") == whole
        found, own = cy.sweep(**SWEEP, engine=engine), cy.sweep(**SWEEP)
    assert list(found) == list(own)
    for name, values in own.items():
        same = np.array_equal(found[name], values, equal_nan=values.dtype == float)
        assert same and found[name].dtype == values.dtype, name


def test_a_uri_has_the_same_bytes(whole, tmp_path):
    """Resumed too; a damaged part is computed again, a folder of another recipe refused."""
    uri = f"file://{tmp_path}/deep/own"
    summary = cy.sweep(**SWEEP, out=uri)
    assert summary.folder == uri and summary.computed == ROWS
    own = tmp_path / "deep/own"
    assert checksums(own) == whole
    with pytest.raises(cy.InvalidOptionError, match="has a sweep already"):
        cy.sweep(**SWEEP, out=uri)
    with pytest.raises(cy.InvalidOptionError, match="seed is 0 there and 1 now"):
        cy.sweep(**SWEEP, out=uri, seed=1, resume=True)
    with (own / "part-000001.parquet").open("r+b") as file:
        file.seek(1000)
        file.write(b"damage")
    (own / "part-000002.parquet").unlink()
    again = cy.sweep(**SWEEP, out=uri, resume=True, threads=2)
    assert again.computed == ROWS - 65_536
    assert checksums(own) == whole
    (own / "manifest.json").unlink()
    with pytest.raises(cy.InvalidOptionError, match="no manifest") as refused:
        cy.sweep(**SWEEP, out=uri)
    assert refused.value.option == "out" and refused.value.reason.startswith(uri)
    with pytest.raises(cy.InvalidOptionError, match="whole number") as refused:
        cy.sweep(**SWEEP, out=uri, threads=0)
    assert refused.value.option == "threads"
    (own / "manifest.json").write_text("half a fi")
    with pytest.raises(cy.UnreadableFileError, match="no manifest of a sweep"):
        cy.sweep(**SWEEP, out=uri, resume=True)
    (tmp_path / "file").write_text("")
    for place in (f"file://{tmp_path}/file/own", "nothing://own"):
        with pytest.raises(cy.CylindroidError, match=f"out: .*{place}"):
            cy.sweep(**SWEEP, out=place)


def test_a_dead_worker_leaves_a_folder_to_resume(whole, tmp_path):
    dying = {"bend": cy.SweepColumn(ends_the_worker, "rad", "1")}
    with concurrent.futures.ProcessPoolExecutor(1) as engine:
        with pytest.raises(cy.CylindroidError, match="worker of the engine died"):
            cy.sweep(**SWEEP | {"columns": dying}, out=tmp_path, engine=engine)
    cy.sweep(**SWEEP, out=tmp_path, resume=True)
    assert checksums(tmp_path) == whole


def test_an_interrupt_keeps_finished_parts(whole, tmp_path):
    def interrupted(q, names):
        if len(q) < 65_536:
            raise KeyboardInterrupt
        return abs(q).sum(1)

    columns = {"bend": cy.SweepColumn(interrupted, "rad", "1")}
    with concurrent.futures.ThreadPoolExecutor(1) as engine:
        with pytest.raises(KeyboardInterrupt):
            cy.sweep(**SWEEP | {"columns": columns}, out=tmp_path, engine=engine)
    again = cy.sweep(**SWEEP, out=tmp_path, resume=True)
    assert again.computed == ROWS - 2 * 65_536
    assert checksums(tmp_path) == whole


def test_a_worker_with_another_model_is_refused(tmp_path):
    """The file of the model has changed between the driver and the worker."""
    path = tmp_path / "arm.toml"
    path.write_text((HERE.parents[2] / "docs/designs.toml").read_text())
    changed = cy.load(path)
    path.write_text(path.read_text().replace("value = 0.5", "value = 0.55", 1))
    assert "0.55" in path.read_text()
    with concurrent.futures.ProcessPoolExecutor(1) as engine:
        with pytest.raises(cy.InvalidOptionError, match="another sweep.*length is"):
            cy.sweep(changed, configurations=[changed.home], engine=engine)


def test_wrong_engines_are_refused(tmp_path):
    for engine in ("rai", 3, concurrent.futures):
        with pytest.raises(cy.InvalidOptionError, match="engine: .*neither 'ray' nor"):
            cy.sweep(**SWEEP, engine=engine)
    with concurrent.futures.ProcessPoolExecutor(1) as engine:
        with pytest.raises(cy.InvalidOptionError, match="threads: an engine has its own"):
            cy.sweep(**SWEEP, engine=engine, threads=2)
        with pytest.raises(cy.InvalidOptionError, match="functions of a module"):
            cy.sweep(robot, samples=10, columns={"a": lambda q, names: q[:, 0]}, engine=engine)
        with pytest.raises(cy.InvalidOptionError, match="too many for memory"):
            cy.sweep(robot, samples=2**31, engine=engine)
        found = cy.sweep(robot, configurations=np.zeros((0, 5)), engine=engine)
        assert list(found) == list(cy.sweep(robot, samples=1)) and found["x"].shape == (0,)


def test_own_columns_name_themselves_and_the_rows(tmp_path):
    def one(function, **options):
        return cy.sweep(robot, samples=70_000, columns={"mine": function}, threads=1, **options)

    with pytest.raises(cy.InvalidOptionError, match="mine.*rows 0 to 65535: ZeroDiv") as raised:
        one(lambda q, names: 1 / 0)
    assert isinstance(raised.value.__cause__, ZeroDivisionError)
    with pytest.raises(cy.InvalidOptionError, match="mine.*rows 65536 to 69999: 1 values"):
        one(lambda q, names: q[:, 0] if len(q) == 65_536 else [1.0])
    with pytest.raises(cy.InvalidOptionError, match="mine.*shape .70000, 5|shape .65536, 5"):
        one(lambda q, names: q)
    with pytest.raises(cy.InvalidOptionError, match="mine.*real numbers are needed"):
        one(lambda q, names: ["text"] * len(q))
    with pytest.raises(KeyboardInterrupt):
        one(lambda q, names: exec("raise KeyboardInterrupt"))
    with pytest.raises(cy.InvalidOptionError, match="columns.*'mine' has no version"):
        one(bend, out=tmp_path)
    with pytest.raises(cy.InvalidOptionError, match="columns = x .*another column"):
        cy.sweep(robot, samples=10, quantities=["pose"], columns={"x": bend})
    for columns in (3, {"a": 3}, {3: bend}):
        with pytest.raises(cy.ArgumentTypeError, match="column"):
            cy.sweep(robot, samples=10, columns=columns)
    for wrong in ({"function": 3}, {"function": bend, "unit": 3}, {"function": bend, "version": 1}):
        with pytest.raises(cy.ArgumentTypeError, match="of a column"):
            cy.SweepColumn(**wrong)


@pytest.mark.parametrize("workers", [1, 2, 8])
def test_of_several_errors_that_of_the_first_part_is_raised(workers, tmp_path):
    """Part 2 ends after those behind it, all of which have an error too."""

    def late(q, names):
        part = round(q[0, 0] * 100)
        if part == 2:
            time.sleep(0.05)
        if part == 2 or part > 3:
            raise ValueError(f"no number in part {part}")
        return q[:, 0]

    columns = {"mine": cy.SweepColumn(late, "rad", "1")}
    q = np.zeros((6 * 65_536, 5))
    q[:, 0] = np.arange(len(q)) // 65_536 / 100
    with concurrent.futures.ThreadPoolExecutor(workers) as engine:
        for out in (None, tmp_path / "own"):
            with pytest.raises(cy.InvalidOptionError, match="no number in part 2"):
                cy.sweep(robot, configurations=q, quantities=[], columns=columns, engine=engine, out=out)


def test_own_columns_are_part_of_the_recipe(tmp_path):
    cy.sweep(**SWEEP | {"samples": 100}, out=tmp_path)
    again = cy.sweep(**SWEEP | {"samples": 100}, out=tmp_path, resume=True)
    assert again.computed == 0
    others = [None, {"bend": cy.SweepColumn(bend, "rad", "2")}, {"b": COLUMNS["bend"]}]
    for columns in others:
        with pytest.raises(cy.InvalidOptionError, match="own_columns is"):
            cy.sweep(**SWEEP | {"samples": 100, "columns": columns}, out=tmp_path, resume=True)
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(tmp_path / "part-000000.parquet")
    q = np.column_stack([table[name].to_numpy() for name in robot.joint_names])
    assert np.array_equal(table["bend"].to_numpy(), abs(q).sum(1))
    assert b'"name":"bend","unit":"rad"' in table.schema.metadata[b"cylindroid"]


def test_columns_survive_pickling():
    column = pickle.loads(pickle.dumps(COLUMNS["bend"]))
    assert column == COLUMNS["bend"]


def test_ray_with_a_killed_worker(tmp_path):
    """In a network namespace without any interface but the loopback, with token authentication."""
    assert shutil.which("unshare"), "the test needs unshare (util-linux)"
    environment = {
        **os.environ,
        "RAY_AUTH_MODE": "token",
        "RAY_AUTH_TOKEN": secrets.token_hex(16),
        "RAY_USAGE_STATS_ENABLED": "0",
        # Of the workers, which import this package.
        "PYTHONPATH": os.pathsep.join(path for path in sys.path if path),
    }
    # Sockets have short paths.
    temporary = pathlib.Path("/tmp") / f"ray-{secrets.token_hex(4)}"
    script = [sys.executable, HERE / "ray_sweep.py", tmp_path, temporary]
    try:
        found = subprocess.run(
            ["unshare", "--map-root-user", "--net", "--kill-child", *script],
            env=environment,
            capture_output=True,
            text=True,
            timeout=300,
        )
    finally:
        shutil.rmtree(temporary, ignore_errors=True)
    assert found.returncode == 0 and "done" in found.stdout, found.stdout + found.stderr
    assert "Task _call failed" in found.stdout + found.stderr
    assert checksums(tmp_path / "ray") == checksums(tmp_path / "one")
    assert checksums(tmp_path / "uri") == checksums(tmp_path / "plain")


def test_ray_is_not_imported():
    code = "import sys, cylindroid; assert not {'ray', 'pyarrow', 'pandas', 'polars'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)
