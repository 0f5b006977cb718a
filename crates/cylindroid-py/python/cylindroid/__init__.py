"""Tells what a robot or mechanism can do, and makes it do it, in numbers that do not change when
the frame does.

>>> import cylindroid as cy
>>> robot = cy.load("panda")
>>> robot.fk(robot.home).shape
(4, 4)
>>> robot.jacobian(robot.home).shape
(6, 7)

SI units and radians everywhere. Twists and wrenches as vectors are linear first, ``[v; w]`` and
``[f; m]``. ``world_from_tool`` names a pose, a matrix of 4 x 4. A Jacobian always names its
reference: ``'local'``, ``'world'`` or ``'local_world_aligned'``. Every q may be ``(n,)`` or
``(N, n)``; results of a batch have its axis first.
"""

from ._core import (
    Dropped,
    Inverse,
    Joint,
    LoadReport,
    Mechanism,
    PointDirection,
    __version__,
    catalogue,
    damped,
    hyperbolic,
    inverse,
    load,
    oblique,
    parse,
    pinv,
    point_direction,
    selectively_damped,
)
from ._errors import (
    CylindroidError,
    DimensionError,
    InvalidOptionError,
    MissingFileError,
    ModelError,
    ModelFileError,
    NotFiniteError,
    UnknownNameError,
    UnreadableFileError,
)

__all__ = [
    "CylindroidError",
    "DimensionError",
    "Dropped",
    "InvalidOptionError",
    "Inverse",
    "Joint",
    "LoadReport",
    "Mechanism",
    "MissingFileError",
    "ModelError",
    "ModelFileError",
    "NotFiniteError",
    "PointDirection",
    "UnknownNameError",
    "UnreadableFileError",
    "__version__",
    "catalogue",
    "damped",
    "hyperbolic",
    "inverse",
    "load",
    "oblique",
    "parse",
    "pinv",
    "point_direction",
    "selectively_damped",
]
