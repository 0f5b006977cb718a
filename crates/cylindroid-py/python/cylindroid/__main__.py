"""The command ``cylindroid``, also as ``python -m cylindroid``."""

import signal
import sys

from ._core import run_command_line


def main() -> int:
    """Runs the command line with the words of this process; its exit code."""
    # Ctrl-C ends the process, as it ends the binary; Python's handler would wait for the command.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return run_command_line(["cylindroid", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
