"""The exceptions of cylindroid.

Every one is a :class:`CylindroidError`, and also what a Python user would catch for its kind. The
fields of an error are attributes.
"""

from __future__ import annotations

import re


class CylindroidError(Exception):
    """What every error of cylindroid is.

    Degeneracy (a lost rank, an inverse that does not exist, a target out of reach) is never an
    error but a value in a report. Errors are for input that has no answer.
    """

    def __str__(self) -> str:
        # KeyError would print the repr of the message.
        return str(self.args[0]) if self.args else ""

    def add_note(self, note: str, /) -> None:
        """Adds a note, or the name of the argument, which PyO3 gives as one.

        Its note begins with "while processing", and comes from Python 3.10 too, which has no notes.
        """
        named = re.fullmatch(r"while processing '(\w+)'", note)
        if named:
            if isinstance(self, InvalidOptionError):
                self.option, self.reason = named[1], str(self)
            self.args = (f"{named[1]}: {self}",)
        else:
            super().add_note(note)


class ModelFileError(CylindroidError, ValueError):
    """A model file that cannot be understood, with the place."""

    format: str
    path: str
    line: int
    column: int
    help: str


class UnreadableFileError(CylindroidError, OSError):
    """A file that cannot be read."""


class MissingFileError(UnreadableFileError, FileNotFoundError):
    """A file that is not there."""


class UnknownNameError(CylindroidError, KeyError):
    """A name that the model or the library does not know; `similar` holds the nearest ones."""

    what: str
    name: str
    similar: list[str]


class DimensionError(CylindroidError, ValueError):
    """A vector or matrix of the wrong size."""

    what: str
    expected: int
    got: int


class NotFiniteError(CylindroidError, ValueError):
    """NaN or infinity where a number is needed."""

    what: str
    value: float


class InvalidOptionError(CylindroidError, ValueError):
    """An argument outside its domain: which, its value, and what can be used instead."""

    option: str = ""
    value: str = ""
    reason: str = ""


def refused(option: str, reason: str) -> InvalidOptionError:
    """The error about an argument by name."""
    error = InvalidOptionError(f"{option}: {reason}")
    error.option, error.reason = option, reason
    return error


class ArgumentTypeError(CylindroidError, TypeError):
    """An argument that is no number, text or object of the right kind."""


class InUseError(CylindroidError, RuntimeError):
    """An object that another thread, or a call around this one, is changing."""


class ModelError(CylindroidError, ValueError):
    """A model that contradicts itself, or that cannot do what is asked."""

    model: str
    culprit: str
