"""Sweeps: columns against single calls, folders that other programs read, names before places."""

import json
import pathlib
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pyarrow.parquet as parquet
import pytest
import xxhash

import cylindroid as cy

CRANE = """
[[joint]]
name = "lift"
type = "prismatic"
between = ["ground", "hook"]
axis = [0, 0, 1]
limits = { lower = -1.5, upper = 2.0 }
[[collision]]
link = "hook"
shape = "sphere"
radius = 0.1
[[joint]]
name = "rope"
type = "prismatic"
between = ["hook", "load"]
axis = [1, 0, 0]
[[joint]]
name = "brake"
type = "prismatic"
between = ["load", "block"]
axis = [0, 1, 0]
[[collision]]
link = "block"
shape = "sphere"
radius = 0.2
"""
QUANTITIES = ["pose", "jacobian", "yoshikawa", "limit_distance", "gibson_hunt"]


def configurations(robot, found):
    return np.stack([found[name] for name in robot.joint_names], axis=1)


def test_columns_are_those_of_single_calls():
    robot = cy.load("youbot")
    found = cy.sweep(robot, samples=200, seed=3, quantities=QUANTITIES)
    q = configurations(robot, found)
    poses, jacobians = robot.fk(q), robot.jacobian(q)
    assert np.allclose(np.stack([found[c] for c in "xyz"], 1), poses[:, :3, 3], atol=1e-14)
    for row, name in enumerate(["vx", "vy", "vz", "wx", "wy", "wz"]):
        for column, joint in enumerate(robot.joint_names):
            own = found[f"jacobian_{name}_{joint}"]
            assert np.allclose(own, jacobians[:, row, column], atol=1e-14)
    volume = np.linalg.svd(jacobians, compute_uv=False).prod(1)
    assert np.allclose(found["yoshikawa"], volume, atol=1e-12)
    distance = np.minimum(q - robot.lower, robot.upper - q).min(1)
    assert np.array_equal(found["limit_distance"], distance)
    assert found["index"].dtype == np.uint64 and list(found["gibson_hunt"][:2]) == ["h", "h"]
    measures = robot.measures(q)
    same = cy.sweep(robot, configurations=q, quantities=["measures"])
    for name, values in measures.items():
        assert np.array_equal(same[name], values, equal_nan=values.dtype == float), name


def test_payloads_reach_a_limit():
    robot = cy.load("panda")
    found = cy.sweep(robot, samples=50, quantities=["payload", "jacobian"], direction=[0.0, 0, 2])
    names = robot.joint_names
    torques = np.stack([found[f"jacobian_vz_{name}"] for name in names], 1) * found["payload"][:, None]
    effort = np.array([87.0] * 4 + [12.0] * 3)
    assert np.allclose((abs(torques) / effort).max(1), 1, atol=1e-12)
    with pytest.raises(cy.InvalidOptionError, match="direction"):
        cy.sweep(robot, samples=2, quantities=["payload"], direction=[0.0, 0, 0])
    with pytest.raises(cy.DimensionError, match="direction"):
        cy.sweep(robot, samples=2, quantities=["payload"], direction=[0.0, 1.0])


def test_distances_to_collision_are_those_of_the_model():
    crane = cy.parse(CRANE, format="toml")
    model = cy.CollisionModel(crane)
    model.add_obstacle("floor", "half_space", [0, 0, -1])
    q = np.stack([np.linspace(-1.5, 2.0, 8), np.linspace(0.0, 0.5, 8), np.zeros(8)], 1)
    found = cy.sweep(crane, configurations=q, quantities=["self_distance", "obstacle_distance"],
                     collision=model)
    for row, own in enumerate(q):
        near = model.near(own, margin=np.inf)
        to_floor = ["floor" in pair for pair in near.pairs]
        distances = np.asarray(near.distances)
        assert found["obstacle_distance"][row] == distances[to_floor].min()
        assert found["self_distance"][row] == distances[~np.array(to_floor)].min()
    assert found["obstacle_distance"].min() < 0 < found["obstacle_distance"].max()
    alone = cy.sweep(crane, configurations=q, quantities=["self_distance"])
    assert np.array_equal(alone["self_distance"], found["self_distance"])
    with pytest.raises(cy.InvalidOptionError, match="obstacle_distance.*no obstacle"):
        cy.sweep(crane, configurations=q, quantities=["obstacle_distance"])
    with pytest.raises(cy.InvalidOptionError, match="no link has a collision shape"):
        cy.sweep(cy.load("3r"), samples=2, quantities=["self_distance"])
    with pytest.raises(cy.InvalidOptionError, match="collision"):
        cy.sweep(cy.load("3r"), samples=2, quantities=["self_distance"], collision=model)


def test_threads_change_nothing():
    robot = cy.load("panda")
    a, b = (cy.sweep(robot, samples=100_000, threads=k) for k in (1, 3))
    for name in a:
        assert np.array_equal(a[name], b[name], equal_nan=a[name].dtype == float), name


def test_names_before_places():
    robot = cy.load("panda")
    found = cy.sweep(robot, samples=20, quantities=["pose"])
    turned = {name: found[name] for name in reversed(list(found))}
    again = cy.sweep(robot, configurations=turned, quantities=["pose"])
    assert all(np.array_equal(found[name], again[name]) for name in found)
    del turned["panda_joint3"]
    with pytest.raises(cy.InvalidOptionError, match="no column 'panda_joint3'"):
        cy.sweep(robot, configurations=turned)
    with pytest.raises(cy.DimensionError):
        cy.sweep(robot, configurations=np.zeros((3, 6)))
    grid = cy.sweep(robot, over={"panda_joint1": (-1.0, 1.0, 3)}, quantities=[])
    assert list(grid["panda_joint1"]) == [-1, 0, 1]
    assert (grid["panda_joint2"] == robot.home[1]).all()


def test_folders(tmp_path):
    robot = cy.load("youbot")
    folder = tmp_path / "sweep"
    summary = cy.sweep(robot, samples=70_000, quantities=QUANTITIES, out=folder)
    assert (summary.folder, summary.rows, summary.parts) == (folder, 70_000, 2)
    assert summary.computed == summary.rows
    expected = cy.sweep(robot, samples=70_000, quantities=QUANTITIES)
    manifest = json.loads((folder / "manifest.json").read_text())
    units = {column["name"]: column["unit"] for column in manifest["columns"]}
    assert units["x"] == "m" and units["arm_joint_1"] == "rad"
    first = 0
    for part in manifest["parts"]:
        path = folder / part["file"]
        assert xxhash.xxh3_128_hexdigest(path.read_bytes()) == part["xxh128"]
        table = parquet.read_table(path)
        assert table.column_names == list(expected)
        about = json.loads(table.schema.metadata[b"cylindroid"])
        assert [column["name"] for column in about["columns"]] == list(expected)
        for entry in ("model", "frame", "frame_from_tool", "length"):
            assert about[entry] == manifest["recipe"][entry]
        for name, values in expected.items():
            own = table[name].to_numpy()
            assert np.array_equal(own, values[first : first + len(own)], equal_nan=own.dtype == float)
        first += len(table)
    assert first == 70_000
    with pytest.raises(cy.InvalidOptionError, match="has a sweep already"):
        cy.sweep(robot, samples=70_000, quantities=QUANTITIES, out=folder)
    with pytest.raises(cy.InvalidOptionError, match="configurations.seed is 0 there and 1 now"):
        cy.sweep(robot, samples=70_000, seed=1, quantities=QUANTITIES, out=folder, resume=True)
    (folder / "part-000001.parquet").unlink()
    again = cy.sweep(robot, samples=70_000, quantities=QUANTITIES, out=folder, resume=True)
    assert again.computed == 70_000 - 65_536


def test_files_of_other_programs(tmp_path):
    """Compressed by Snappy, other columns beside those of the joints, in another order."""
    import pyarrow

    robot = cy.load("youbot")
    found = cy.sweep(robot, samples=50, quantities=["pose"])
    columns = {"time": np.arange(50), **{n: found[n] for n in reversed(robot.joint_names)}}
    table = pyarrow.table(columns)
    for compression in ("snappy", "none"):
        path = tmp_path / f"{compression}.parquet"
        parquet.write_table(table, path, compression=compression)
        again = cy.sweep(robot, configurations=path, quantities=["pose"])
        assert np.array_equal(again["x"], found["x"])
    parquet.write_table(table, tmp_path / "zstd.parquet", compression="zstd")
    with pytest.raises(cy.UnreadableFileError, match="Snappy"):
        cy.sweep(robot, configurations=tmp_path / "zstd.parquet")
    again = cy.sweep(robot, configurations=table, quantities=["pose"])
    assert np.array_equal(again["x"], found["x"])


def turned(robot, rows=50):
    """Columns of a table, those of the joints in the reverse order beside others; and the positions."""
    found = cy.sweep(robot, samples=rows, quantities=["pose"])
    joints = {name: found[name] for name in reversed(robot.joint_names)}
    return {"note": ["a"] * rows, "x": np.arange(rows) + 0.5, **joints}, found


def same(found, expected):
    return all(np.array_equal(found[name], expected[name]) for name in expected)


def test_files_of_arrow(tmp_path, monkeypatch):
    """Files and streams, of one or several pieces, compressed; by the names of the joints."""
    import pyarrow
    from pyarrow import feather, ipc

    robot = cy.load("youbot")
    columns, expected = turned(robot)
    table = pyarrow.table(columns)
    for compression in ("lz4", "zstd", "uncompressed"):
        path = tmp_path / f"{compression}.feather"
        feather.write_feather(table, path, compression=compression)
        assert same(cy.sweep(robot, configurations=path, quantities=["pose"]), expected)
    for opened, name in [(ipc.new_file, "file.ARROW"), (ipc.new_stream, "stream.ipc")]:
        path = tmp_path / name
        with pyarrow.OSFile(str(path), "wb") as sink, opened(sink, table.schema) as writer:
            writer.write_table(table, max_chunksize=20)
        assert same(cy.sweep(robot, configurations=str(path), quantities=["pose"]), expected)
        # Workers read the file themselves.
        with ThreadPoolExecutor(2) as workers:
            found = cy.sweep(robot, configurations=path, quantities=["pose"], engine=workers)
        assert same(found, expected)
    with pytest.raises(cy.InvalidOptionError, match="configurations.*no column 'panda_joint1'"):
        cy.sweep(cy.load("panda"), configurations=path)
    with pytest.raises(cy.MissingFileError, match="none.arrow"):
        cy.sweep(robot, configurations=tmp_path / "none.arrow")
    (tmp_path / "folder.arrow").mkdir()
    with pytest.raises(cy.UnreadableFileError, match="not a regular file"):
        cy.sweep(robot, configurations=tmp_path / "folder.arrow")
    for content in (b"", b"ARROW1", b"ARROW1\0\0 and no more of it", b"x" * 100):
        (tmp_path / "broken.arrow").write_bytes(content)
        with pytest.raises(cy.UnreadableFileError, match="cannot read .*broken.arrow"):
            cy.sweep(robot, configurations=tmp_path / "broken.arrow")
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(cy.InvalidOptionError, match="needs pyarrow: pip install pyarrow"):
        cy.sweep(robot, configurations=path)


def test_files_of_csv(tmp_path):
    """As on the command line, but never by place: a file without names is refused."""
    import pyarrow

    robot = cy.load("youbot")
    columns, expected = turned(robot)
    names, path = list(columns), tmp_path / "turned.csv"

    def write(first, columns):
        rows = zip(*columns.values())
        lines = [",".join(x if isinstance(x, str) else repr(float(x)) for x in row) for row in rows]
        path.write_text("\n".join([*first, *lines]))

    write([",".join(names)], columns)
    for given in (path, str(path)):
        assert same(cy.sweep(robot, configurations=given, quantities=["pose"]), expected)
    with pytest.raises(cy.UnreadableFileError, match="no column 'panda_joint1' among note, x"):
        cy.sweep(cy.load("panda"), configurations=path)
    # As in the motions of move.
    write([",".join(f"q.{name}" if name in robot.joint_names else name for name in names)], columns)
    assert same(cy.sweep(robot, configurations=path, quantities=["pose"]), expected)
    write([], {name: expected[name] for name in robot.joint_names})
    with pytest.raises(cy.UnreadableFileError, match="its columns have no names"):
        cy.sweep(robot, configurations=path)
    path.write_text(",".join(robot.joint_names) + "\n0,0,a,0,0\n")
    with pytest.raises(cy.UnreadableFileError, match="line 2, column 3: 'a' is not a number"):
        cy.sweep(robot, configurations=path)
    with pytest.raises(cy.MissingFileError):
        cy.sweep(robot, configurations=tmp_path / "none.csv")
    poses = ["x", "y", "z", "qw", "qx", "qy", "qz"]
    write([",".join(reversed(poses))], {name: expected[name] for name in reversed(poses)})
    assert cy.sweep(robot, poses=path, quantities=[])["reached"].all()
    # Parquet by what is in it, whatever its name.
    parquet.write_table(pyarrow.table(columns), tmp_path / "table.pq")
    found = cy.sweep(robot, configurations=tmp_path / "table.pq", quantities=["pose"])
    assert same(found, expected)


def test_columns_of_other_kinds(tmp_path):
    """Several groups of rows, whole numbers and short ones; a gap is named by its row."""
    import pyarrow

    robot = cy.load("3r")
    a, b, c = robot.joint_names
    rows = 2500
    q = np.column_stack([np.arange(rows) % 3, np.arange(rows) % 2, np.linspace(-1, 1, rows)])
    q[:, 2] = q[:, 2].astype(np.float32)
    columns = {
        c: pyarrow.array(q[:, 2], pyarrow.float32()),
        "note": pyarrow.array(["x"] * rows),
        a: pyarrow.array(q[:, 0].astype(int), pyarrow.int64()),
        b: pyarrow.array(q[:, 1].astype(int), pyarrow.int32()),
    }
    path = tmp_path / "kinds.parquet"
    parquet.write_table(pyarrow.table(columns), path, row_group_size=1000)
    found = cy.sweep(robot, configurations=path, quantities=["pose"])
    for name, column in zip(robot.joint_names, q.T):
        assert np.array_equal(found[name], column)
    gap = [None if i == 1200 else 0.5 for i in range(rows)]
    columns[b] = pyarrow.array(gap, pyarrow.float64())
    parquet.write_table(pyarrow.table(columns), path, row_group_size=1000)
    with pytest.raises(cy.UnreadableFileError, match=f"row 1201, column '{b}': no number"):
        cy.sweep(robot, configurations=path, quantities=["pose"])
    columns[b] = columns["note"]
    parquet.write_table(pyarrow.table(columns), path)
    with pytest.raises(cy.UnreadableFileError, match=f"row 1, column '{b}': no number"):
        cy.sweep(robot, configurations=path, quantities=["pose"])


def test_what_is_not_given(tmp_path):
    robot = cy.load("panda")
    with pytest.raises(cy.InvalidOptionError, match="one of samples, over, configurations, poses and reach"):
        cy.sweep(robot)
    with pytest.raises(cy.InvalidOptionError, match="resume"):
        cy.sweep(robot, samples=10, resume=True)
    with pytest.raises(cy.InvalidOptionError, match="loops"):
        cy.sweep(cy.load("five-bar"), over={"q1": (0.0, 1.0, 3)})
    found = cy.sweep(cy.load("five-bar"), samples=40)
    lost = found["closed"] == 0
    assert (np.isnan(found["q3"]) == lost).all() and 0 < lost.sum() < 40
    with pytest.raises(cy.UnknownNameError, match="yoshikawa"):
        cy.sweep(robot, samples=10, quantities=["yoshikava"])


def test_capability_maps(tmp_path):
    robot = cy.load("ur5e")
    reach = {"z": (-0.1, 0.5, 3), "x": (0.2, 1.2, 4)}
    options = {"reach": reach, "directions": 16, "rolls": 4, "quantities": ["yoshikawa"]}
    found = cy.sweep(robot, **options)
    names = ["index", "x", "y", "z", "directions", "orientations", "reachability"]
    assert list(found) == [*names, "orientation_share", "best_yoshikawa"]
    assert (found["y"] == 0).all() and np.allclose(found["z"][:3], [-0.1, 0.2, 0.5])
    assert np.array_equal(found["reachability"], found["directions"] / 16)
    assert np.allclose(found["orientation_share"], found["orientations"] / 64)
    assert (found["orientations"] <= 4 * found["directions"]).all()
    reached = found["directions"] > 0
    assert np.array_equal(np.isnan(found["best_yoshikawa"]), ~reached) and 2 < reached.sum() < 12
    again = cy.sweep(robot, **options, threads=1, out=tmp_path / "map")
    table = parquet.read_table(tmp_path / "map" / "part-000000.parquet")
    assert again.rows == 12 and np.array_equal(table["orientations"], found["orientations"])
    # The grid moves with its axes: a turn of the first joint moves all of the arm.
    turn = np.eye(4)
    turn[:2, :2] = [[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]]
    turned = cy.sweep(robot, **options, reach_from=turn)
    assert np.array_equal(turned["orientations"], found["orientations"])
    with ThreadPoolExecutor(2) as workers:
        other = cy.sweep(robot, **options, engine=workers)
    assert np.array_equal(other["best_yoshikawa"], found["best_yoshikawa"], equal_nan=True)


def test_wrong_maps_are_refused():
    robot = cy.load("ur5e")
    reach = {"x": (0.2, 1.2, 4)}
    with pytest.raises(cy.InvalidOptionError, match="points have no configurations"):
        cy.sweep(robot, reach=reach, samples=3)
    with pytest.raises(cy.UnknownNameError, match="no axis named 'u'"):
        cy.sweep(robot, reach={"u": (0, 1, 2)})
    with pytest.raises(cy.InvalidOptionError, match="best value of yoshikawa"):
        cy.sweep(robot, reach=reach, quantities=["pose"])
    with pytest.raises(cy.InvalidOptionError, match="0 asks for directions alone"):
        cy.sweep(cy.load("youbot"), reach=reach)
    with pytest.raises(cy.InvalidOptionError, match="own columns"):
        cy.sweep(robot, reach=reach, columns={"a": lambda q, names: q[:, 0]})
    with pytest.raises(cy.CylindroidError, match="reach_from"):
        cy.sweep(robot, reach=reach, reach_from=[1, 2, 3])


def test_poses(tmp_path):
    robot = cy.load("panda")
    samples = cy.sweep(robot, samples=30, seed=2, quantities=["pose"], out=tmp_path / "poses")
    q = np.stack([cy.sweep(robot, samples=30, seed=2, quantities=[])[n] for n in robot.joint_names])
    poses = robot.fk(q.T)
    poses[7, :3, 3] += 5.0
    found = cy.sweep(robot, poses=poses, quantities=["pose", "limit_distance"])
    assert list(found)[: robot.n + 2] == ["index", *robot.joint_names, "reached"]
    assert found["reached"].sum() == 29 and found["reached"][7] == 0
    own = np.stack([found[n] for n in robot.joint_names]).T
    assert np.isnan(own[7]).all() and np.isnan(found["limit_distance"][7])
    rest = np.arange(30) != 7
    assert np.allclose(robot.fk(own[rest]), poses[rest], atol=1e-5)
    assert (found["limit_distance"][rest] >= 0).all()
    # The same from the columns that a sweep writes, and of positions alone.
    part = tmp_path / "poses" / "part-000000.parquet"
    assert samples.rows == 30 and cy.sweep(robot, poses=part, quantities=[])["reached"].all()
    youbot = cy.load("youbot")
    there = youbot.fk(youbot.home)[None]
    assert cy.sweep(youbot, poses=there, task="position", quantities=[])["reached"] == [1]
    with ThreadPoolExecutor(2) as workers:
        again = cy.sweep(robot, poses=poses, quantities=[], engine=workers)
    assert np.array_equal(again["reached"], found["reached"])
    for name, value in [("samples", 3), ("reach", {"x": (0, 1, 2)}), ("q", robot.home)]:
        with pytest.raises(cy.InvalidOptionError, match=f"{name} = given beside poses"):
            cy.sweep(robot, poses=poses, **{name: value})
    pointing = cy.sweep(youbot, poses=there, task="pointing", quantities=["limit_distance"])
    assert pointing["reached"] == [1]
    with pytest.raises(cy.InvalidOptionError, match="world axes"):
        cy.sweep(youbot, poses=there, task="pointing", quantities=["yoshikawa"])
    with pytest.raises(cy.InvalidOptionError, match="poses are an array"):
        cy.sweep(robot, poses=np.eye(4))
    with pytest.raises(cy.CylindroidError, match="poses"):
        cy.sweep(robot, poses=np.full((2, 4, 4), np.nan))


DESIGNS = pathlib.Path(__file__).parents[3] / "docs/designs.toml"


def test_designs_of_a_mechanism_file():
    r = cy.load(DESIGNS, parameters={"point_y": 0.9})
    over = {"crank": (0.4, 0.7, 4), "point_x": (-0.1, 0.1, 3)}
    found = cy.sweep(r, over=over, quantities=["pose", "measures"])
    assert list(found)[:5] == ["index", "design", "design_valid", "crank", "point_x"]
    assert found["design_valid"].all() and (found["design"] == np.arange(12)).all()
    np.testing.assert_allclose(found["y"], 0.9, atol=1e-14)
    np.testing.assert_allclose(found["x"], found["point_x"], atol=1e-14)
    one = cy.load(DESIGNS, parameters={"point_y": 0.9, "crank": 0.5, "point_x": 0.1})
    own = cy.sweep(one, configurations=[one.home], quantities=["measures"])
    assert found["anisotropy"][5] == own["anisotropy"][0]
    sampled = cy.sweep(r, vary={"rod": (0.1, 1.0)}, designs=64, seed=3, quantities=["measures"])
    valid = sampled["design_valid"] == 1
    assert 10 < valid.sum() < 60
    assert (np.isnan(sampled["anisotropy"]) == ~valid).all()
    text = cy.parse(DESIGNS.read_text(), "toml", DESIGNS, {"point_y": 0.9})
    again = cy.sweep(text, over=over, quantities=["measures"])
    np.testing.assert_array_equal(again["anisotropy"], found["anisotropy"])


def test_wrong_designs_are_refused():
    r = cy.load(DESIGNS)
    with pytest.raises(cy.UnknownNameError, match="coordinate or parameter"):
        cy.sweep(r, over={"cranck": (0.4, 0.7, 4)})
    with pytest.raises(cy.InvalidOptionError, match="over or in vary"):
        cy.sweep(r, over={"crank": (0.4, 0.7, 4)}, vary={"rod": (0.5, 0.6)}, designs=3)
    with pytest.raises(cy.InvalidOptionError, match="1 to 2"):
        cy.sweep(r, vary={"rod": (0.5, 0.6)}, quantities=["measures"])
    with pytest.raises(cy.InvalidOptionError, match="its range is 0.05 to 2"):
        cy.sweep(r, vary={"rod": (0.5, 6.0)}, designs=3, quantities=["measures"])
    limited = r.with_actuated(["left_drive", "right_drive"])
    with pytest.raises(cy.InvalidOptionError, match="changed after loading"):
        cy.sweep(limited, over={"crank": (0.4, 0.7, 4)}, quantities=["measures"])


def test_optimal_designs():
    r = cy.load(DESIGNS)
    vary = {"crank": (0.3, 0.8), "point_x": (-0.1, 0.1)}
    found = cy.optimise(r, vary, minimise="anisotropy", seed=1)
    half = 0.6 / np.sqrt(2)
    assert abs(found.best["crank"] - np.hypot(half - 0.3, 0.8 - half)) < 1e-6
    assert list(found.designs) == ["crank", "point_x", "anisotropy:largest", "refined"]
    assert abs(found.designs["anisotropy:largest"][0] - 1) < 1e-6 and found.designs["refined"].all()
    assert found.evaluated == 64 + sum(r["evaluated"] for r in found.refinements)
    assert all(r["converged"] and r["values"].keys() == vary.keys() for r in found.refinements)
    best = cy.load(DESIGNS, parameters=found.best)
    own = cy.sweep(best, configurations=[best.home], quantities=["measures"])
    np.testing.assert_allclose(own["anisotropy"], found.designs["anisotropy:largest"], rtol=1e-12)
    again = cy.optimise(r, vary, minimise=["anisotropy"], seed=1, threads=1)
    assert again.best == found.best and "minimise anisotropy:largest" in repr(again)


def test_trade_offs_of_designs():
    r = cy.load(DESIGNS)
    vary = {"crank": (0.3, 0.8), "rod": (0.5, 0.9)}
    over = {"point_x": (-0.1, 0.1, 3)}
    names = {"minimise": "anisotropy:mean", "maximise": ["type_ii"]}
    found = cy.optimise(r, vary, **names, over=over, designs=32, starts=3, evaluations=100)
    columns = found.designs
    a, b = columns["anisotropy:mean"], columns["type_ii:smallest"]
    assert len(a) > 3 and (np.diff(a) > 0).all() and (np.diff(b) > 0).all()
    assert columns["refined"].any() and found.invalid > 0 and found.reason is not None
    grid = {"crank": (columns["crank"][0],) * 2 + (1,), "rod": (columns["rod"][0],) * 2 + (1,)}
    own = cy.sweep(r, over={**grid, **over}, quantities=["measures"])
    np.testing.assert_allclose(own["anisotropy"].mean(), a[0], rtol=1e-12)
    np.testing.assert_allclose(own["type_ii"].min(), b[0], rtol=1e-12)
    none = cy.optimise(r, {"rod": (0.05, 0.06)}, minimise="anisotropy", designs=4)
    assert none.best is None and none.invalid == 4 and len(none.designs["rod"]) == 0


def test_a_design_as_seen_from_a_moving_frame():
    names = [("ground", "upper", "0"), ("upper", "lower", "1"), ("lower", "hand", "2")]
    joints = [
        f"[[joint]]\nname = 'to_{b}'\ntype = 'revolute'\nbetween = ['{a}', '{b}']\norigin = [{x}, 0]"
        for a, b, x in names
    ]
    head = "dimension = 2\nreference = 'hand'\nreference_point = ['2 + b', 0]\n[parameters]\nb = 0.9\n"
    arm = cy.parse(head + "\n".join(joints), "toml")
    options = {"minimise": "condition", "q": [0.3, 1, 0.75 * np.pi], "task": "x,y"}
    # Salisbury & Craig (1982): two links are isotropic at a ratio of 1/sqrt(2).
    seen = cy.optimise(arm, {"b": (0.2, 2.0)}, relative_to="upper", **options)
    assert abs(seen.best["b"] - np.sqrt(0.5)) < 1e-6
    world = cy.optimise(arm, {"b": (0.2, 2.0)}, **options)
    assert abs(world.best["b"] - np.sqrt(0.5)) > 0.1
    with pytest.raises(cy.UnknownNameError, match="upper"):
        cy.optimise(arm, {"b": (0.2, 2.0)}, relative_to="uper", **options)


def test_wrong_objectives_are_refused():
    r = cy.load(DESIGNS)
    vary = {"crank": (0.3, 0.8)}
    with pytest.raises(cy.InvalidOptionError, match="one index at least"):
        cy.optimise(r, vary)
    with pytest.raises(cy.UnknownNameError, match="nearest: anisotropy"):
        cy.optimise(r, vary, minimise="anisotropi")
    with pytest.raises(cy.UnknownNameError, match="statistic"):
        cy.optimise(r, vary, maximise="anisotropy:most")
    with pytest.raises(cy.ArgumentTypeError, match="minimise"):
        cy.optimise(r, vary, minimise=3)
    with pytest.raises(cy.UnknownNameError, match="no parameter named 'crank'"):
        cy.optimise(cy.load("panda"), vary, minimise="condition")
