"""Run where nothing but the wheel and what it needs is installed."""

import importlib.metadata
import os
import shutil
import subprocess
import sys
import tempfile
import urllib.request

import numpy as np

import cylindroid as cy

installed = {d.metadata["Name"].lower() for d in importlib.metadata.distributions()}
extra = installed - {"cylindroid", "numpy", "pip", "setuptools", "wheel"}
assert not extra, f"the wheel brought {extra}"
assert "matplotlib" not in sys.modules

robot = cy.load("panda")
assert robot.fk(robot.home).shape == (4, 4)
# The wheel carries the page of the viewer.
with cy.show(robot, open=False) as view:
    assert b"app" in urllib.request.urlopen(view.url).read()
assert cy.pinv(robot.jacobian(np.tile(robot.home, (3, 1)))).matrix.shape == (3, 7, 6)
# It carries the tutorials.
with tempfile.TemporaryDirectory() as folder:
    assert len(cy.tutorials(folder)) == 3
# It installs the command.
command = shutil.which("cylindroid", path=os.path.dirname(sys.executable))
assert command
subprocess.run([command, "fk", "panda"], check=True, stdout=subprocess.DEVNULL)
