"""Bad arguments of every public call: an error of the package, with the name of an argument; no
panic, and no error that NumPy or PyO3 raise."""

import re

import pytest
from calls import calls, public

import cylindroid as cy

BAD = [
    None,
    True,
    -1,
    2**62,
    10**40,
    10**400,
    float("nan"),
    float("inf"),
    1.8e308,
    "",
    "\ud800",
    "none of them",
    b"bytes",
    1j,
    object(),
    [],
    [[]],
    [None],
    ["\ud800"],
    [10**400],
    [1.0, "a"],
    {"none of them": 1.0},
    {"\ud800": object()},
    (1.0, 2.0, 3.0, 4.0, 5.0),
    [[1.0], [2.0, 3.0]],
]


# What messages call arguments, where it is not their name.
OTHER_WORDS = {
    "Ja": "actuated Jacobian",
    "Jp": "passive Jacobian",
    "G": "grasp matrix",
    "joint_metric": "joint weights",
    "radius": "a length",
    "moment": "admittance",
    "q": "start of the joint move",
    "to": "end of the joint move",
    "name": "obstacle",
    "via": "point",
}


def is_named(argument, message):
    """True for the name as it is, or for its words: 'position tolerance'; never for a part of a word."""
    def says(words):
        return re.search(rf"(?<!\w){re.escape(words)}(?!\w)", message) is not None

    stems = [word.rstrip("s") for word in argument.split("_")]
    return (
        says(argument)
        or says(OTHER_WORDS.get(argument, argument))
        or len(argument) > 2
        and all(re.search(rf"(?<!\w){re.escape(stem)}", message) for stem in stems)
    )


def test_every_call_is_in_the_table():
    assert {name for name, _, _ in calls()} == set(public())


@pytest.mark.parametrize(("name", "call", "arguments"), list(calls()), ids=lambda x: x if isinstance(x, str) else "")
def test_bad_arguments_are_named(name, call, arguments):
    call(**arguments)
    for argument in arguments:
        for bad in BAD:
            place = f"{name}({argument}={bad!r:.40})"
            try:
                call(**arguments | {argument: bad})
            except cy.CylindroidError as error:
                message = f"{type(error).__name__}: {error}"
                if isinstance(error, (cy.UnknownNameError, OSError, cy.ModelFileError)):
                    continue  # named by the value, or a place in a file
                # A size or a value may contradict that of another argument.
                assert any(is_named(name, message) for name in arguments), f"{place}: {message}"
            except BaseException as error:
                pytest.fail(f"{place}: {type(error).__name__}: {error}")
