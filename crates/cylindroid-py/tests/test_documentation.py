"""Docstrings: every public thing has one, and their examples run."""

import doctest
import inspect
import pathlib
import re
import tomllib

import pytest

import cylindroid as cy

HERE = pathlib.Path(__file__).parent
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def test_public_names_stand_once():
    assert len(set(cy.__all__)) == len(cy.__all__)


def documented():
    yield "cylindroid", cy
    for name in cy.__all__:
        thing = getattr(cy, name)
        if name.startswith("__"):
            continue
        yield name, thing
        if inspect.isclass(thing) and not issubclass(thing, BaseException):
            for member in vars(thing):
                function = getattr(thing, member)
                if not member.startswith("_") and callable(function):
                    yield f"{name}.{member}", function


@pytest.mark.parametrize(("name", "thing"), list(documented()), ids=lambda x: x if isinstance(x, str) else "")
def test_docstring(name, thing):
    text = inspect.getdoc(thing)
    assert text and text.strip(), f"{name} has no docstring"
    examples = doctest.DocTestParser().get_doctest(text, {}, name, None, 0)
    result = doctest.DocTestRunner(optionflags=FLAGS, verbose=False).run(examples)
    assert result.failed == 0


def names_in(thing, title):
    """What a section of a docstring lists: `names : type` a line."""
    section = re.search(rf"{title}\n-+\n(.*?)(\n\n|\Z)", inspect.getdoc(thing), re.S)
    listed = []
    for line in section.group(1).split("\n") if section else []:
        if line.strip() and not line.startswith(" "):
            listed += [part.strip().lstrip("*") for part in line.split(" : ")[0].split(",")]
    return listed


def test_signatures_are_documented():
    """Parameters are documented, all and in their order."""
    constructors = 0
    for name, thing in documented():
        if not callable(thing):
            continue
        try:
            signature = inspect.signature(thing)
        except ValueError:  # a class whose objects come from elsewhere
            assert inspect.isclass(thing), name
            continue
        if inspect.isclass(thing) and issubclass(thing, BaseException):
            continue
        parameters = [p for p in signature.parameters if p != "self"]
        assert sorted(names_in(thing, "Parameters")) == sorted(parameters), name
        constructors += inspect.isclass(thing) and bool(parameters)
    assert constructors >= 8


def test_attributes_are_documented():
    """The docstring of a class lists exactly the attributes that its objects have."""
    for name, thing in documented():
        if not inspect.isclass(thing) or issubclass(thing, BaseException):
            continue
        kinds = {"getset_descriptor", "member_descriptor"}
        own = {k for k, v in vars(thing).items() if type(v).__name__ in kinds}
        listed = set(names_in(thing, "Attributes"))
        assert listed == own, f"{name}: {listed ^ own}"


def test_the_two_project_files_are_one():
    root, own = HERE.parents[2] / "pyproject.toml", HERE.parent / "pyproject.toml"
    a, b = tomllib.loads(root.read_text()), tomllib.loads(own.read_text())
    for project in (a, b):
        del project["project"]["readme"]
        for path in ("manifest-path", "python-source"):
            del project["tool"]["maturin"][path]
    assert a == b


def test_version():
    manifest = tomllib.loads((HERE.parents[2] / "Cargo.toml").read_text())
    assert cy.__version__ == manifest["workspace"]["package"]["version"]
