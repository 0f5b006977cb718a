"""Docstrings of the compiled part for griffe: read from the sources, so that nothing is compiled.

The stubs hold the signatures, the doc comments of the `#[pyclass]`es, `#[pymethods]` and
`#[pyfunction]`s hold the docstrings.
"""

import pathlib
import re

import griffe

SOURCES = pathlib.Path(__file__).parents[2] / "crates/cylindroid-py/src"
NAME = re.compile(r'name = "(\w+)"')
# The table of inverse methods, from which a macro makes the end of a docstring.
METHODS = pathlib.Path(__file__).parents[2] / "crates/cylindroid/src/inverse/method.rs"
TABLE = "#[doc = cylindroid::inverse_methods!(documented)]"


def methods():
    """A list of the methods and their parameters."""
    lines, words = [], []
    for line in METHODS.read_text().split("macro_rules! inverse_methods")[1].split("\n"):
        text = line.strip()
        if text.startswith("///"):
            words.append(text[3:].strip())
            continue
        if row := re.match(r'\w+ = "([\w-]+)" \{', text):
            lines.append(f"- `{row[1]}`: {' '.join(words)}")
        elif row := re.match(r'(\w+): "([^"]+)" in (\w+) = .*;', text):
            lines.append(f"    - `{row[1]}` [{row[2]}]: {' '.join(words)}")
        elif line.startswith("}"):
            break
        words = []
    return lines


def read(path, classes, texts):
    """Adds to `texts` the docstrings of a file, by Python name or `Struct.method`."""
    doc, attributes, inside, open_brackets = [], "", None, 0
    for line in path.read_text().split("\n"):
        text = line.strip()
        if open_brackets > 0:
            attributes += text
            open_brackets += text.count("[") - text.count("]")
        elif text.startswith("///"):
            doc.append(text[3:].removeprefix(" "))
        elif text == TABLE:
            doc = doc[: doc.index("Methods")] + ["Notes", "-----", *methods()]
        elif text.startswith("#["):
            attributes += text
            open_brackets = text.count("[") - text.count("]")
        else:
            name = NAME.search(attributes)
            if struct := re.match(r"pub(?:\([a-z]+\))? (?:struct|enum) (\w+)", text):
                if "#[pyclass" in attributes:
                    classes[struct[1]] = name[1] if name else struct[1]
                    texts[classes[struct[1]]] = "\n".join(doc)
            elif block := re.match(r"impl (\w+)", line):
                inside = block[1] if "#[pymethods" in attributes else None
            elif line.startswith("}"):
                inside = None
            elif function := re.match(r"(?:pub(?:\([a-z]+\))? )?fn (\w+)", text):
                own = name[1] if name else function[1]
                if "#[pyfunction" in attributes:
                    texts[own] = "\n".join(doc)
                elif inside and doc and line.startswith("    fn") or line.startswith("    pub"):
                    texts[f"{inside}.{own}"] = "\n".join(doc)
            doc, attributes = [], ""


def docstrings():
    classes, texts = {}, {}
    for path in sorted(SOURCES.rglob("*.rs")):
        read(path, classes, texts)
    named = {}
    for key, text in texts.items():
        owner, dot, method = key.partition(".")
        named[f"{classes.get(owner, owner)}{dot}{method}"] = text
    return named


class CompiledDocstrings(griffe.Extension):
    def __init__(self):
        self.texts = docstrings()

    def attach(self, obj, name):
        if not obj.docstring and self.texts.get(name):
            # Shapes are words, not types.
            text = re.sub(r"\b(array_like|ndarray), \(", r"\1 of shape (", self.texts[name])
            obj.docstring = griffe.Docstring(text, parent=obj, parser="numpy")

    def on_module(self, *, mod, **kwargs):
        if mod.name != "_core":
            return
        for name, obj in mod.members.items():
            if obj.is_alias:
                continue
            self.attach(obj, name)
            if not obj.is_class:
                continue
            # The signature of a class is that of its constructor.
            if new := obj.members.pop("__new__", None):
                new.name = "__init__"
                obj.members["__init__"] = new
            for member, method in obj.members.items():
                if method.is_function:
                    self.attach(method, f"{name}.{member}")
