"""The tutorials that the package carries."""

from __future__ import annotations

import os
from importlib import resources
from pathlib import Path

from ._errors import ArgumentTypeError, InvalidOptionError


def tutorials(folder: str | os.PathLike[str]) -> list[Path]:
    """Copies the tutorials, notebooks of Jupyter, into a folder, which is made if it is missing.

    Parameters
    ----------
    folder : str or os.PathLike

    Returns
    -------
    list of Path
        The notebooks, in the order to read them.

    Raises
    ------
    ArgumentTypeError
        No path.
    InvalidOptionError
        A notebook of this name is there already, and nothing is copied; no path can be this text.
    OSError
        The folder cannot be written.

    Examples
    --------
    >>> import tempfile, cylindroid as cy
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [path.name for path in cy.tutorials(folder)]
    ['01_seven_joints.ipynb', '02_five_joints.ipynb', '03_five_bar.ipynb']
    """
    try:
        to = Path(folder)
    except TypeError as error:
        raise ArgumentTypeError(f"folder = {folder!r}: a path is needed") from error
    carried = resources.files(__package__) / "notebooks"
    notebooks = sorted(carried.iterdir(), key=lambda notebook: notebook.name)
    paths = [to / notebook.name for notebook in notebooks]
    for path in paths:
        if path.exists():
            raise InvalidOptionError(
                f"folder = {os.fspath(folder)!r} cannot be used: {path} is there already; move it away "
                "or choose another folder"
            )
    try:
        to.mkdir(parents=True, exist_ok=True)
    except ValueError as error:  # of texts that no path can be
        raise InvalidOptionError(f"folder = {os.fspath(folder)!r} cannot be used: {error}") from error
    for notebook, path in zip(notebooks, paths):
        path.write_bytes(notebook.read_bytes())
    return paths
