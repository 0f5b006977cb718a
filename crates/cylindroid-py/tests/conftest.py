"""What tests share: the robot files, and figures for the documents. No test is skipped: one that
lacks something fails and says what gets it."""

import os
import pathlib

import pytest

# No window opens.
os.environ.setdefault("MPLBACKEND", "Agg")

figures = pytest.StashKey[list[str]]()


@pytest.fixture(scope="session")
def robot_files():
    """The folder of example-robot-data."""
    folder = pathlib.Path(os.environ.get("CYLINDROID_TEST_ROBOTS") or "not set")
    if not folder.is_dir():
        pytest.fail(
            f"no robot files in CYLINDROID_TEST_ROBOTS ({folder}): 'cargo xtask python' fetches them, "
            "sets the variable and runs these tests"
        )
    return folder


@pytest.fixture
def report(request):
    """Prints a figure after the tests."""
    return request.config.stash.setdefault(figures, []).append


def pytest_terminal_summary(terminalreporter, config):
    for figure in config.stash.get(figures, []):
        terminalreporter.write_line(figure)
