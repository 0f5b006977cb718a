"""Executes a notebook that shows a robot and prints the outputs of its cells; the kernel lives on."""

import json
import sys

import nbformat
from nbclient import NotebookClient

CELLS = [
    "import cylindroid as cy\nrobot = cy.load('panda')\nview = cy.show(robot)",
    "q = robot.home\nq[0] = 0.5\nview.q = q\n"
    "view.add_line('way', [[0.3, -0.3, 0.4], [0.5, 0, 0.6], [0.3, 0.3, 0.4]])\n"
    "view.add_frame('grasp', [0.3, 0.3, 0.4])",
]
notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in CELLS])
client = NotebookClient(notebook, timeout=120)
with client.setup_kernel():
    for i, cell in enumerate(notebook.cells):
        client.execute_cell(cell, i)
    print(json.dumps([cell.outputs for cell in notebook.cells]), flush=True)
    sys.stdin.readline()
