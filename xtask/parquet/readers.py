"""Reads a folder of `cylindroid sweep` with pandas, polars, DuckDB and pyarrow: the same numbers.

    python xtask/parquet/readers.py FOLDER
"""

import json
import sys
from pathlib import Path

import duckdb
import numpy as np
import pandas
import polars
import pyarrow.parquet

folder = Path(sys.argv[1])
files, pattern = sorted(folder.glob("part-*.parquet")), str(folder / "part-*.parquet")
manifest = json.loads((folder / "manifest.json").read_text())
names = [column["name"] for column in manifest["columns"]]
expected = pyarrow.parquet.read_table(files)
found = {
    "pandas": pandas.concat([pandas.read_parquet(file) for file in files]),
    "polars": polars.read_parquet(pattern),
    "DuckDB": duckdb.sql(f"select * from '{pattern}' order by \"index\"").df(),
}
for program, table in found.items():
    assert list(table.columns) == names, program
    assert len(table) == manifest["rows"], program
    for name in names:
        own, other = np.asarray(table[name]), expected[name].to_numpy()
        is_number = own.dtype.kind in "fu"
        same = np.array_equal(own, other, equal_nan=True) if is_number else list(own) == list(other)
        assert same, (program, name)
    version = sys.modules[program.lower()].__version__
    print(f"{program} {version}: {len(table)} rows, {len(names)} columns")
