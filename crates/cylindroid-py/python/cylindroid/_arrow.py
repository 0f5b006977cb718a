"""Arrow files, which pyarrow reads: it is imported only for them."""

from __future__ import annotations

import importlib
import os
from typing import Any

from ._errors import MissingFileError, UnreadableFileError, refused

#: The beginning of an Arrow file; a stream has none.
MAGIC = b"ARROW1"


def table(path: str | os.PathLike[str]) -> Any:
    """The table of an Arrow file or of a stream in a file."""
    name = os.fspath(path)
    try:
        pyarrow: Any = importlib.import_module("pyarrow")
        ipc: Any = importlib.import_module("pyarrow.ipc")
    except ImportError as error:
        raise refused(
            "configurations",
            f"'{name}' needs pyarrow: pip install pyarrow, or name a CSV or Parquet file",
        ) from error
    if not os.path.exists(name):
        raise _unreadable(MissingFileError, name, "there is no such file")
    # A pipe would be waited for.
    if not os.path.isfile(name):
        raise _unreadable(UnreadableFileError, name, "it is not a regular file")
    try:
        with pyarrow.OSFile(name) as file:
            is_file = file.read(len(MAGIC)) == MAGIC
            file.seek(0)
            reader = ipc.open_file(file) if is_file else ipc.open_stream(file)
            return reader.read_all()
    except (OSError, pyarrow.ArrowException) as error:
        raise _unreadable(UnreadableFileError, name, str(error)) from error


def _unreadable(kind: type[UnreadableFileError], name: str, reason: str) -> UnreadableFileError:
    error = kind(f"cannot read {name}: {reason}")
    error.filename = name
    return error
