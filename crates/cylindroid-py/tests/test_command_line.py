"""The command ``cylindroid`` that the wheel installs: its answers, exit codes and signals."""

import json
import os
import shutil
import signal
import subprocess
import sys
import urllib.request

import numpy as np

import cylindroid as cy

COMMAND = shutil.which("cylindroid", path=os.path.dirname(sys.executable))
#: Generous: another program may have the processor (s).
PATIENCE = 60


def run(*words, command=(COMMAND,), **options):
    return subprocess.run(
        [*command, *words], capture_output=True, text=True, timeout=PATIENCE, **options
    )


def test_it_prints_what_the_package_computes():
    robot = cy.load("panda")
    printed = json.loads(run("--json", "jacobian", "panda", check=True).stdout)
    J = robot.jacobian(robot.home, reference=printed["reference"])
    np.testing.assert_allclose(printed["matrix"], J, rtol=0, atol=1e-12)


def test_it_is_the_same_as_a_module():
    for words in [("--version",), ("info", "five-bar"), ()]:
        module = run(*words, command=(sys.executable, "-m", "cylindroid"))
        installed = run(*words)
        assert installed.stdout == module.stdout and installed.stdout
        assert installed.returncode == module.returncode == 0
    assert cy.__version__ in run("--version").stdout


def test_exit_codes():
    beyond_reach = run("ik", "panda", "--to", "9,0,0")
    assert beyond_reach.returncode == 1, beyond_reach.stderr
    unknown = run("info", "pnda")
    assert unknown.returncode == 2 and not unknown.stdout
    assert "panda" in unknown.stderr and "Traceback" not in unknown.stderr
    assert run("infos").returncode == 2
    assert run("info", b"pan\xff").returncode == 2


def test_a_closed_pipe_is_no_error():
    with subprocess.Popen(
        [COMMAND, "--help"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 0


def test_ctrl_c_ends_the_viewer():
    words = [COMMAND, "view", "panda", "--port", "0"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        url = process.stdout.readline().decode().strip()
        # Whoever has been served finds the handler in place.
        assert b"app" in urllib.request.urlopen(url, timeout=PATIENCE).read()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0 and not errors


def test_ctrl_c_ends_a_command_that_does_not_return(tmp_path):
    robot = cy.load("panda")
    file = tmp_path / "many.csv"
    np.savetxt(file, np.tile(robot.home, (5000, 1)), delimiter=",")
    # The other thread runs only if the command has released the interpreter.
    code = """
import os, signal, sys, threading, time
from cylindroid.__main__ import main

def interrupt():
    while signal.getsignal(signal.SIGINT) != signal.SIG_DFL:
        time.sleep(0.01)
    time.sleep(0.2)
    os.kill(os.getpid(), signal.SIGINT)

threading.Thread(target=interrupt, daemon=True).start()
sys.exit(main())
"""
    words = ["--json", "manipulability", "panda", "--configurations", file]
    # Nobody reads the output: the command waits for its pipe, which holds less.
    with subprocess.Popen(
        [sys.executable, "-c", code, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        assert process.wait(timeout=PATIENCE) == -signal.SIGINT
        assert process.stderr.read() == b""
