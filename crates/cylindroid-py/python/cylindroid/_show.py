"""The viewer of a mechanism: a page in the browser that follows the program."""

from __future__ import annotations

import atexit
import os
import secrets
import sys
import threading
import time
import warnings
import webbrowser
from collections.abc import Sequence
from typing import Any

from numpy.typing import ArrayLike

from ._core import Mechanism, View, close_views, has_page, start_view
from ._errors import ArgumentTypeError, CylindroidError

#: The pages of Jupyter and of editors on this machine.
_NOTEBOOKS = "http://localhost:* http://127.0.0.1:* https://localhost:* vscode-webview:"

#: Longest wait for functions that run when the program ends [s].
_PATIENCE = 2.0

_CUT_OFF = (
    "cylindroid: {} of a view is cut off, without its `finally`: it ran for {:.0f} s after the end "
    "of the program; let the program wait for it"
)

_NO_PAGE = (
    "this build of cylindroid has no page: run `cargo xtask viewer` in its source (it needs "
    "Node.js), then install it again"
)

_FOR_OTHERS = (
    "everyone on the network who has the address {} can drive the robot on the page, and reads the "
    "meshes and images in the folders of the model; without `host` only this machine can"
)


def show(
    mechanism: Mechanism,
    q: ArrayLike | None = None,
    *,
    frame: str | None = None,
    tool: ArrayLike | None = None,
    open: bool = True,
    height: int = 600,
    host: str = "127.0.0.1",
    port: int = 0,
    meshes: Sequence[str | os.PathLike[str]] = (),
    frame_ancestors: str | None = None,
) -> View:
    """Shows a mechanism in the browser; the page follows the program.

    The page is that of `cylindroid view`. All pages at the address of the view show the same
    robot, target and obstacles; the first of them drives, the others observe or take over. The
    program moves the robot whoever drives.

    Parameters
    ----------
    mechanism : Mechanism
    q : array_like, (n,), optional
        The first configuration [rad or m], by default home; loops are closed from there.
    frame : str, optional
        The frame of the target, by default the tool, or the reference of a closed chain.
    tool : array_like, (4, 4), optional
        `frame_from_tool`.
    open : bool
        Opens the page: in a notebook below the cell, otherwise in the browser.
    height : int
        Of the page below a cell (pixels).
    host : str
        Any other than 127.0.0.1 and ::1 allows access from other machines, with a warning; 0.0.0.0
        are all addresses of this one. `url_for_others` of the view is the address for them.
    port : int
        0 selects a free one.
    meshes : sequence of path
        Additional folders from which meshes may be served.
    frame_ancestors : str, optional
        The addresses of the pages that may show this one in a frame, separated by spaces. By default
        those of notebooks on this machine if the program runs in one, otherwise none.

    Returns
    -------
    View

    Raises
    ------
    DimensionError, NotFiniteError, UnknownNameError
    InvalidOptionError
        For an address where the server cannot listen.

    Warns
    -----
    UserWarning
        If other machines reach the page.

    Examples
    --------
    >>> import cylindroid as cy
    >>> robot = cy.load("panda")
    >>> with cy.show(robot, open=False) as view:
    ...     view.add_line("path", [[0.4, -0.2, 0.4], [0.4, 0.2, 0.4]])
    ...     q = robot.home
    ...     for _ in range(10):
    ...         q = q + 0.01
    ...         view.q = q
    >>> view
    <View of 'panda', closed>
    """
    if not isinstance(open, bool):
        raise ArgumentTypeError(f"open: {open!r:.99} is not True or False")
    if not isinstance(height, int) or not 0 < height < 100_000:
        raise ArgumentTypeError(f"height: {height!r:.99} is not a number of pixels")
    if open and not has_page():
        raise CylindroidError(_NO_PAGE)
    if frame_ancestors is None and _in_notebook():
        frame_ancestors = _NOTEBOOKS
    token = secrets.token_urlsafe(24)
    view = start_view(mechanism, q, frame, tool, meshes, host, port, token, frame_ancestors)
    try:
        if view.url_for_others:
            warnings.warn(_FOR_OTHERS.format(view.url_for_others), UserWarning, stacklevel=2)
        if open:
            view.open(height)
    except BaseException:  # nobody would have the view to close it
        view.close()
        raise
    return view


def _in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython else None
    return hasattr(shell, "kernel")


def open_page(url: str, height: int) -> None:
    """Opens a page below the cell of a notebook, otherwise in the browser."""
    if _in_notebook():
        from IPython.display import IFrame, display  # type: ignore[import-not-found, unused-ignore]

        display(IFrame(url, "100%", height))
    elif not webbrowser.open(url):
        print(f"no browser was found; the page is at {url}")


#: Each calls the functions of a view.
_threads: list[threading.Thread] = []
#: What they call now.
_running: dict[threading.Thread, Any] = {}
#: That started them: a process that is forked has none of them.
_process = os.getpid()


def start_calls(calls: Any) -> None:
    """Calls the functions of a view in a thread, until the view is closed."""
    global _process
    _process = os.getpid()
    thread = threading.Thread(target=_call, args=(calls,), name="cylindroid-view", daemon=True)
    _threads[:] = [other for other in _threads if other.is_alive()]
    _threads.append(thread)
    thread.start()


def _call(calls: Any) -> None:
    thread = threading.current_thread()
    for function, arguments in calls:
        _running[thread] = function
        try:
            function(*arguments)
        except BaseException as error:  # the next calls are made none the less
            calls.failed(function, error)
        # A function may hold its view.
        del function, arguments, _running[thread]


@atexit.register
def _end() -> None:
    """Ends what waits for a page before Python is gone."""
    if os.getpid() != _process:
        return
    close_views()
    end = time.monotonic() + _PATIENCE
    for thread in _threads:
        thread.join(max(0.0, end - time.monotonic()))
        function = _running.get(thread)
        if function is not None and thread.is_alive():
            name = getattr(function, "__qualname__", repr(function))
            print(_CUT_OFF.format(name, _PATIENCE), file=sys.stderr)
