"""The tutorials that the package carries."""

from __future__ import annotations

import os
from importlib import resources
from pathlib import Path

from ._errors import ArgumentTypeError, refused


def tutorials(folder: str | os.PathLike[str]) -> list[Path]:
    """Copies the tutorials, notebooks of Jupyter, into a folder, which is made if it is missing.

    Open them with JupyterLab (``pip install jupyterlab matplotlib``) or an editor.

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
        A notebook of this name is there already, and nothing is copied; the folder cannot be written.

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
        raise ArgumentTypeError(f"folder = {folder!r:.99}: a path is needed") from error
    carried = resources.files(__package__) / "notebooks"
    notebooks = {n.name: n.read_bytes() for n in carried.iterdir() if n.name.endswith(".ipynb")}
    paths = [to / name for name in sorted(notebooks)]
    for path in paths:
        if os.path.lexists(path):
            raise refused("folder", f"{path} is there already; move it away or choose another folder")
    try:
        to.mkdir(parents=True, exist_ok=True)
        for path in paths:
            with path.open("xb") as file:
                file.write(notebooks[path.name])
    except (OSError, ValueError) as error:  # of texts that no path can be
        raise refused("folder", f"nothing can be written there: {error}") from error
    return paths
