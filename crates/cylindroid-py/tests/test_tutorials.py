"""The tutorials run as programs and as the notebooks that the package carries, and what they assert
holds. `cargo xtask book --outputs` writes the notebooks."""

import os
import pathlib
import runpy

import jupytext
import nbclient
import nbformat
import pytest

import cylindroid as cy

PACKAGE = pathlib.Path(__file__).parents[1]
TUTORIALS = sorted((PACKAGE / "tutorials").glob("*.py"))
by_name = pytest.mark.parametrize("path", TUTORIALS, ids=lambda path: path.stem)


def notebook_of(path):
    """The notebook of a program in cells, without outputs; the same for the same program."""
    notebook = jupytext.reads(path.read_text(), fmt="py:percent")
    for i, cell in enumerate(notebook.cells):
        cell.id = f"cell-{i}"
        cell.metadata = {}
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    notebook.metadata = {"kernelspec": kernel, "language_info": {"name": "python"}}
    notebook.nbformat_minor = 5
    return nbformat.writes(notebook) + "\n"


def test_there_are_three():
    assert len(TUTORIALS) == 3


@by_name
def test_tutorial(path, capsys):
    runpy.run_path(str(path))
    assert len(capsys.readouterr().out) > 200


@by_name
def test_notebook(path):
    carried = PACKAGE / "python/cylindroid/notebooks" / f"{path.stem}.ipynb"
    if "CYLINDROID_WRITE_BOOK" in os.environ:
        carried.parent.mkdir(exist_ok=True)
        carried.write_text(notebook_of(path))
    same = carried.exists() and carried.read_text() == notebook_of(path)
    assert same, f"{carried}: cargo xtask book --outputs writes it"


def test_copied_notebooks_run(tmp_path, monkeypatch):
    monkeypatch.delenv("MPLBACKEND")  # Jupyter has its own
    copied = cy.tutorials(tmp_path / "new" / "folder")
    assert [path.stem for path in copied] == [path.stem for path in TUTORIALS]
    kinds = []
    for path in copied:
        notebook = nbformat.read(path, as_version=4)
        nbformat.validate(notebook)
        nbclient.NotebookClient(notebook, timeout=300).execute()
        outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
        texts = [output.text for output in outputs if output.get("name") == "stdout"]
        assert len("".join(texts)) > 200
        kinds += [kind for output in outputs for kind in output.get("data", {})]
    assert "image/png" in kinds  # pictures stand below their cells


def test_notebooks_of_the_user_stay(tmp_path):
    copied = cy.tutorials(tmp_path)
    copied[0].unlink()
    copied[1].write_text("mine")
    with pytest.raises(cy.InvalidOptionError, match="^folder: .*02_five_joints.ipynb is there already"):
        cy.tutorials(str(tmp_path))
    assert copied[1].read_text() == "mine" and not copied[0].exists()
    with pytest.raises(cy.ArgumentTypeError, match="^folder = 3: a path"):
        cy.tutorials(3)
    # A file in the way, a name that is too long, a link to nowhere.
    for folder in (copied[1] / "below", tmp_path / ("x" * 300)):
        with pytest.raises(cy.InvalidOptionError, match="^folder: nothing can be written there") as told:
            cy.tutorials(folder)
        assert told.value.option == "folder"
    linked = tmp_path / "linked"
    linked.mkdir()
    (linked / copied[0].name).symlink_to(tmp_path / "elsewhere")
    with pytest.raises(cy.InvalidOptionError, match="^folder: .*is there already"):
        cy.tutorials(linked)
    assert not (tmp_path / "elsewhere").exists()
