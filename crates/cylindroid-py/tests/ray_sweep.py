"""A sweep on a local Ray cluster of two workers, one of which is killed on the way; run by
test_engines.py, in a network namespace that has nothing but the loopback interface."""

import os
import pathlib
import signal
import sys

import ray
from loopback import raise_loopback

import cylindroid as cy

folder = pathlib.Path(sys.argv[1])
MARK = folder / "killed"


def reach(q, names):
    """The first part of a worker ends it, once; `MARK` is there on one machine."""
    assert names == cy.load("panda").joint_names
    if not MARK.exists():
        MARK.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return abs(q).sum(1)


def sweep(name, **options):
    columns = {"reach": cy.SweepColumn(reach, "rad", "1")}
    out = folder / name
    return cy.sweep(cy.load("panda"), samples=ROWS, out=out, columns=columns, **options)


ROWS = 400_000
raise_loopback()
ray.init(
    address="local",
    num_cpus=2,
    include_dashboard=False,
    object_store_memory=100_000_000,
    _node_ip_address="127.0.0.1",
    _temp_dir=sys.argv[2],
)
summary = sweep("ray", engine="ray")
assert MARK.exists()
assert (summary.rows, summary.computed, summary.parts) == (ROWS, ROWS, 7)
again = sweep("ray", engine="ray", resume=True)
assert again.computed == 0
sweep("one")
uri = f"file://{folder}/uri"
found = cy.sweep(cy.load("panda"), samples=ROWS, out=uri, engine="ray")
assert found.folder == uri
cy.sweep(cy.load("panda"), samples=ROWS, out=folder / "plain")
rows = cy.sweep(cy.load("panda"), samples=10, quantities=["pose"], engine="ray")
assert (rows["x"] == cy.sweep(cy.load("panda"), samples=10, quantities=["pose"])["x"]).all()


def fails(q, names):
    raise LookupError("no such configuration")


try:
    cy.sweep(cy.load("panda"), samples=10, columns={"mine": fails}, engine="ray")
except cy.InvalidOptionError as error:
    assert "mine" in str(error) and "rows 0 to 9: LookupError" in str(error), error
else:
    raise AssertionError("an error of a column is lost")
ray.shutdown()
print("done")
