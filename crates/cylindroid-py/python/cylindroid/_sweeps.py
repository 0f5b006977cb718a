"""Sweeps: quantities and own columns of many configurations, here or on an engine."""

from __future__ import annotations

import concurrent.futures
import dataclasses
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _engines
from ._core import CollisionModel, Mechanism, SweepPlan
from ._errors import ArgumentTypeError, refused


@dataclasses.dataclass(frozen=True, slots=True)
class SweepColumn:
    """An own column of a sweep.

    Parameters
    ----------
    function : callable
        Is called with configurations, `(N, n)` [rad or m], and the names of their coordinates, and
        returns N real numbers. The number of a configuration must not depend on the others, which
        are those of a part. It is called in several threads, processes or machines.
    unit : str
        For the metadata of the files; '1' for numbers without one.
    version : str
        Part of the recipe: change it whenever the function changes, so that a folder with numbers
        of the old one is not resumed. A folder needs it.

    Attributes
    ----------
    function, unit, version
        The parameters.

    Examples
    --------
    >>> import cylindroid as cy
    >>> panda = cy.load("panda")
    >>> height = cy.SweepColumn(lambda q, names: panda.fk(q, "link4")[:, 2, 3], unit="m")
    >>> cy.sweep(panda, samples=5, quantities=[], columns={"elbow": height})["elbow"].shape
    (5,)
    """

    function: Callable[[NDArray[Any], list[str]], ArrayLike]
    unit: str = ""
    version: str = ""

    def __post_init__(self) -> None:
        if not callable(self.function):
            raise ArgumentTypeError(f"function of a column: {self.function!r:.99} cannot be called")
        for name in ("unit", "version"):
            if not isinstance(getattr(self, name), str):
                raise ArgumentTypeError(f"{name} of a column must be text")


def sweep(
    mechanism: Mechanism,
    samples: int | None = None,
    seed: int = 0,
    over: dict[str, tuple[float, float, int]] | None = None,
    q: ArrayLike | None = None,
    configurations: Any = None,
    quantities: Sequence[str] | None = None,
    frame: str | None = None,
    tool: ArrayLike | None = None,
    task: str | None = None,
    metric: str = "unit",
    length: float | None = None,
    out: str | os.PathLike[str] | None = None,
    resume: bool = False,
    threads: int | None = None,
    vary: dict[str, tuple[float, float]] | None = None,
    designs: int = 0,
    columns: Mapping[str, Callable[..., ArrayLike] | SweepColumn] | None = None,
    engine: str | concurrent.futures.Executor | None = None,
    direction: ArrayLike | None = None,
    reach: dict[str, tuple[float, float, int]] | None = None,
    directions: int = 50,
    rolls: int = 12,
    reach_from: ArrayLike | None = None,
    poses: Any = None,
    collision: CollisionModel | None = None,
    relative_to: str | None = None,
) -> Any:
    """Quantities of many configurations: samples within the limits, a grid, configurations, or those that
    reach poses; or of the points of a capability map.

    Sample i is a function of `seed` and i alone, and results depend neither on the number of threads nor
    on the engine.
    At most one of `samples`, coordinates in `over`, `configurations`, `poses` and `reach` is given. With
    parameters of the mechanism file in `over`, or with `vary`, all of it is computed for each design.

    Parameters
    ----------
    mechanism : Mechanism
        Samples and grids need one without loops.
    samples : int, optional
        Number of points of a scrambled Sobol' sequence within the position limits; joints without
        limits rotate through [-pi, pi). Of a closed chain those of the actuated joints, with the others
        on the branch of home; a sample that no straight path reaches has NaN.
    seed : int
        Selects one of the sequences.
    over : dict of str to (float, float, int), optional
        A grid: of a coordinate its first and last value [rad or m] and the number of values; the
        last one changes fastest. Parameters of the mechanism file are axes of a grid of designs; of
        designs alone, the configuration is home, or `q`.
    q : array_like, (n,), optional
        The other coordinates of a grid [rad or m]. Default: home.
    configurations : array_like, (N, n), mapping, DataFrame or path, optional
        Configurations [rad or m]; where columns have names, those of the coordinates are taken, in
        any order. Files have names always: CSV with a first line of them, Parquet, and Arrow ('.arrow',
        '.feather' or '.ipc'), which needs pyarrow.
    quantities : sequence of str
        Of 'pose', 'jacobian', 'singular_values', 'smallest_singular_value', 'condition',
        'yoshikawa', 'limit_distance', 'self_distance', 'obstacle_distance', 'payload',
        'gibson_hunt', 'measures'; of closed chains 'pose', 'limit_distance', 'self_distance',
        'obstacle_distance', 'payload' and 'measures'. Default: 'pose', 'yoshikawa',
        'smallest_singular_value', 'limit_distance' and 'gibson_hunt', of closed chains 'pose' and
        'measures'.
    frame : str, optional
        One of `frames`. Default: the tool, of a closed chain its reference.
    tool : array_like, (4, 4), optional
        `frame_from_tool`, a tool point fixed to the frame.
    task : str, optional
        The components that measures and those of the Jacobian see, and those of `poses` that count, world
        axes: 'pose', 'position', 'orientation', or some of 'x,y,z,rx,ry,rz'; of poses without
        measures also 'pointing'. Default: 'pose'.
    metric : str
        Of 'yoshikawa' and 'measures': 'unit', 'length' or 'limits', as for `manipulability`.
    length : float, optional
        Characteristic length (m). Default: that of the mechanism, `reach`.
    out : path or URI, optional
        Folder for Parquet files, which is created. A text with '://' is a URI of pyarrow
        (`pyarrow.fs.FileSystem.from_uri`), which needs pyarrow; other processes are not kept from
        writing there at the same time.
    resume : bool
        Continue a folder that was interrupted; its finished parts are verified.
    threads : int, optional
        Default: as many as the machine has. Not with an engine, which has its own workers.
    vary : dict of str to (float, float), optional
        Ranges of parameters for sampled designs, a Sobol' sequence too.
    designs : int
        Their number.
    columns : dict of str to callable or SweepColumn, optional
        Own columns, after those of the quantities: functions of the configurations of a part, `(N, n)`,
        and the names of the coordinates, which return N numbers. Not of designs.
    direction : array_like, (3,), optional
        Of the force of 'payload', in world axes. Default: down.
    engine : 'ray' or concurrent.futures.Executor, optional
        Computes the parts: the Ray cluster that is connected, otherwise that of `ray.init()`, or any
        executor. Files and manifest are to the byte those of one machine. Arguments are pickled; workers
        need this version of the package and the model files, and, for a folder, its path. Ray computes
        the parts of a worker that died again; an executor whose worker died ends the sweep, which
        `resume` continues. Default: threads of this process.
    reach : dict of str to (float, float, int), optional
        A capability map: points with 'x', 'y' and 'z', of each its first and last value [m] and their
        number; those not named are 0, z changes fastest. Inverse kinematics is asked at each point for
        `directions` times `rolls` orientations of the tool, within the limits. Quantities are those
        of which the best value over the solutions found is meant: 'yoshikawa',
        'smallest_singular_value', 'condition', 'limit_distance', 'self_distance',
        'obstacle_distance' and 'payload'. Default: none.
    directions : int
        Approach directions of the tool's z axis, evenly spread over the sphere, in the plane angles;
        0: positions alone.
    rolls : int
        Rotations about each direction; 0: any, for arms of five joints.
    reach_from : array_like, (4, 4), optional
        Placement of the axes of `reach` in the world. Default: the world.
    poses : array_like, (N, 4, 4), or path of a CSV or Parquet file, optional
        Poses `world_from_tool` that inverse kinematics reaches from home, in the components of `task`,
        positions within 1e-6 of the reach of the mechanism; a file has the columns 'x', 'y', 'z' [m] and, where rotations count, the quaternion
        'qw', 'qx', 'qy', 'qz'.
    collision : CollisionModel, optional
        Of this mechanism: the shapes, pairs and obstacles of 'self_distance' and 'obstacle_distance',
        the smallest distances [m], negative in penetration. It is not pickled, so that it goes to
        threads alone. Default: the shapes of the links, without obstacles.
    relative_to : str, optional
        The frame from which `frame` is seen, one of `frames`, which may move: two arms together. Poses
        are `relative_to_from_frame`, Jacobians those of `Mechanism.relative_jacobian`, at the frame's
        origin in the axes of `relative_to`, and so are their measures, the screw system and `task`. Not
        of 'payload', 'measures', `reach` and `poses`. Default: the world.

    Returns
    -------
    dict of str to ndarray, (N,), or SweepSummary
        The columns: 'index', the coordinates by name, then those of the quantities. Of designs,
        'design', 'design_valid' and the parameters precede the coordinates; a design whose file
        cannot be loaded with its values has 'design_valid' 0 and NaN. Of a capability map 'x', 'y',
        'z', 'directions' and 'orientations' that are reached, 'reachability' and
        'orientation_share', their shares, and 'best_' with the name of each quantity, NaN without a
        solution. Of poses 'reached', 1 or 0, after the coordinates; those that are not reached have NaN,
        counts of 0 and empty names. With `out` the summary of the folder.

    Raises
    ------
    InvalidOptionError
        Also for a folder of another recipe, with the difference, for samples of sliders without limits,
        and for the error of an own column, which is its cause, with the rows.
    UnknownNameError, DimensionError, NotFiniteError, UnreadableFileError
    CylindroidError
        Also for workers that died.

    Notes
    -----
    An interrupt (Ctrl-C) leaves a folder that `resume` continues to the same bytes.

    Examples
    --------
    >>> import cylindroid as cy
    >>> panda = cy.load("panda")
    >>> found = cy.sweep(panda, samples=1000, quantities=["pose", "yoshikawa"])
    >>> found["yoshikawa"].shape
    (1000,)
    >>> list(found)[-3:]
    ['qy', 'qz', 'yoshikawa']

    An own column, and workers of an executor:

    >>> from concurrent.futures import ThreadPoolExecutor
    >>> with ThreadPoolExecutor(2) as workers:
    ...     found = cy.sweep(panda, samples=10, quantities=["pose"], engine=workers,
    ...                      columns={"bend": lambda q, names: abs(q).sum(1)})
    >>> list(found)[-2:]
    ['qz', 'bend']

    The share of 20 directions in which an arm reaches three points:

    >>> arm = cy.load("ur5e")
    >>> found = cy.sweep(arm, reach={"x": (0.3, 1.1, 3), "z": (0.2, 0.2, 1)}, directions=20, rolls=4)
    >>> found["reachability"]
    array([1., 1., 0.])

    One hand as seen from a link that moves:

    >>> found = cy.sweep(panda, samples=3, quantities=["jacobian"], relative_to="link4")
    >>> found["jacobian_vx_panda_joint1"]
    array([0., 0., 0.])

    Which of two poses are reached:

    >>> poses = [arm.fk(arm.home), arm.fk(arm.home)]
    >>> poses[1][0, 3] = 2.0
    >>> cy.sweep(arm, poses=poses, quantities=["limit_distance"])["reached"]
    array([1, 0], dtype=uint64)
    """
    own = _columns(columns, out is not None)
    arguments = {
        "mechanism": mechanism,
        "samples": samples,
        "seed": seed,
        "over": over,
        "q": q,
        "configurations": configurations,
        "quantities": quantities,
        "frame": frame,
        "tool": tool,
        "task": task,
        "metric": metric,
        "length": length,
        "vary": vary,
        "designs": designs,
        "columns": own,
        "direction": direction,
        "reach": reach,
        "directions": directions,
        "rolls": rolls,
        "reach_from": reach_from,
        "poses": poses,
        "collision": collision,
        "relative_to": relative_to,
    }
    plan = SweepPlan(**arguments)
    if not isinstance(resume, (bool, np.bool_)):
        raise ArgumentTypeError("resume: true or false is needed")
    if out is None and resume:
        raise refused("resume", "name the folder with out")
    if engine is None and not _engines.is_uri(out):
        return plan.collect(threads) if out is None else plan.write(out, resume, threads)
    if engine is not None and threads is not None:
        raise refused("threads", "an engine has its own workers; leave out threads or engine")
    with _engines.opened(engine, threads) as workers:
        return _engines.run(workers, plan, arguments, out, resume)


def _columns(columns: Any, in_folder: bool) -> list[tuple[str, str, str, Any]]:
    """Name, unit, version and function of each."""
    if columns is None:
        return []
    if not isinstance(columns, Mapping):
        raise ArgumentTypeError("columns: a dict of functions by name is needed")
    own = []
    for name, column in columns.items():
        if not isinstance(name, str):
            raise ArgumentTypeError(f"columns: {name!r:.99} must be text")
        if not isinstance(column, SweepColumn):
            column = SweepColumn(column)
        if in_folder and not column.version:
            raise refused(
                "columns",
                f"'{name}' has no version, by which a resumed folder knows its function; give one: "
                "SweepColumn(function, version='1')",
            )
        own.append((name, column.unit, column.version, column.function))
    return own
