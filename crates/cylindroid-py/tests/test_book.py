"""The Python of the book: the blocks of a page run in order, in one namespace, and print what the
page shows in the ```text block that follows. `cargo xtask book --outputs` writes what they print."""

import contextlib
import io
import os
import pathlib
import re

import pytest

import cylindroid

ROOT = pathlib.Path(__file__).parents[3]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
BLOCK = re.compile(r"^```python\n(.*?)^```\n(\n```text\n(.*?)^```$)?", re.S | re.M)
NUMBER = re.compile(r"-?\d+\.?\d*(?:e[-+]?\d+)?")


def with_python(pages):
    return [page for page in pages if "```python" in page.read_text()]


def alike(shown, printed):
    """The same text, with numbers that differ by rounding alone, and spaces as they come."""
    same_words = "".join(NUMBER.sub("#", shown).split()) == "".join(NUMBER.sub("#", printed).split())
    a, b = ([float(n) for n in NUMBER.findall(text)] for text in (shown, printed))
    return same_words and a == pytest.approx(b, rel=2e-3, abs=1e-9)


@pytest.mark.parametrize("page", with_python(PAGES), ids=lambda page: page.stem)
def test_page(page):
    text, namespace, wrong = page.read_text(), {}, []

    def run(block):
        code, shown, output = block.groups()
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(code, str(page), "exec"), namespace)
        if shown is None or alike(output, printed.getvalue()):
            return block.group()
        wrong.append(f"shown:\n{output}\nprinted:\n{printed.getvalue()}")
        lines = [line.rstrip() for line in printed.getvalue().rstrip().split("\n")]
        return f"```python\n{code}```\n\n```text\n" + "\n".join(lines) + "\n```"

    written = BLOCK.sub(run, text)
    if "CYLINDROID_WRITE_BOOK" in os.environ:
        page.write_text(written)
    else:
        assert not wrong, "\n".join(wrong)


def test_the_guide_names_every_inverse():
    page = (ROOT / "docs/guide/inverses.md").read_text()
    missing = [m["name"] for m in cylindroid.inverse_methods() if f"| `{m['name']}` |" not in page]
    assert not missing, f"docs/guide/inverses.md has no row for {missing}"


def test_pages_have_python():
    assert len(with_python(PAGES)) > 15
