"""Sweeps into a storage that is no folder: S3 as moto serves it, on the loopback interface."""

import hashlib
import subprocess
import sys
import time
import urllib.request

import pytest
from pyarrow import fs

import cylindroid as cy

SWEEP = {"mechanism": cy.load("ur5e"), "samples": 70_000, "quantities": ["pose"], "seed": 0}
PARTS = ["manifest.json", "part-000000.parquet", "part-000001.parquet"]


@pytest.fixture(scope="module")
def s3(tmp_path_factory):
    """The options of URIs of a server that has one bucket."""
    log = tmp_path_factory.mktemp("moto") / "log.txt"
    with log.open("w") as out:
        server = subprocess.Popen(
            [sys.executable, "-c", "from moto.server import main; main(['-p', '0'])"],
            stdout=out, stderr=subprocess.STDOUT,
        )
    try:
        for _ in range(300):
            found = [line for line in log.read_text().splitlines() if "http://127.0.0.1:" in line]
            if found:
                break
            assert server.poll() is None, log.read_text()
            time.sleep(0.1)
        address = found[0].split("http://")[1].strip()
        request = urllib.request.Request(f"http://{address}/sweeps", method="PUT")
        assert urllib.request.urlopen(request).status == 200
        yield f"region=us-east-1&scheme=http&endpoint_override={address}"
    finally:
        server.kill()
        server.wait()


def uri(s3, name):
    return f"s3://key:secret@sweeps/{name}?{s3}"


def checksums(read):
    """Of the parts; manifests have times."""
    return {name: hashlib.sha256(read(name)).hexdigest() for name in PARTS[1:]}


def test_a_bucket_has_the_bytes_of_a_folder(s3, tmp_path):
    summary = cy.sweep(**SWEEP, out=uri(s3, "own"))
    assert summary.computed == SWEEP["samples"]
    cy.sweep(**SWEEP, out=tmp_path / "own")
    system, path = fs.FileSystem.from_uri(uri(s3, "own"))

    def read(name):
        with system.open_input_stream(f"{path}/{name}") as file:
            return file.read()

    assert checksums(read) == checksums(lambda name: (tmp_path / "own" / name).read_bytes())
    names = sorted(info.base_name for info in system.get_file_info(fs.FileSelector(path)))
    assert names == PARTS
    # A part that is lost is computed again, another recipe is refused.
    whole = checksums(read)
    with pytest.raises(cy.InvalidOptionError, match="seed is 0 there and 1 now"):
        cy.sweep(**{**SWEEP, "seed": 1}, out=uri(s3, "own"), resume=True)
    system.delete_file(f"{path}/{PARTS[2]}")
    again = cy.sweep(**SWEEP, out=uri(s3, "own"), resume=True)
    assert again.computed == SWEEP["samples"] - 65_536
    assert checksums(read) == whole


def test_a_bucket_that_is_not_there_is_named(s3):
    with pytest.raises(cy.CylindroidError, match="out: .*nowhere"):
        cy.sweep(**SWEEP, out=f"s3://key:secret@nowhere/own?{s3}")
