"""Run the worked notebooks from top to bottom and store their outputs: `make notebooks`."""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
from nbformat.v4 import new_code_cell
from rich.progress import track

from ros2lab import environment

FOLDER = Path(__file__).resolve().parent.parent / "notebooks"
CELL_TIMEOUT = 120  # s

# A widget that closes leaves its picture in place of its view, which nobody could show without the kernel.
CLOSE = """
from ros2lab.session import LabSession
session = LabSession.current()
if session: session.close()
"""


def main() -> int:
    """Execute the notebooks named, or all of them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "notebooks", nargs="*", type=Path, help="the notebooks to run; all of them if none is named"
    )
    chosen = parser.parse_args().notebooks or sorted(FOLDER.glob("*.ipynb"))
    os.environ.update(environment.lab_environment())
    for path in track(chosen, description="Running"):
        try:
            run(path)
        except CellExecutionError as error:
            print(f"{path.name} failed, and was left as it was: {error}", file=sys.stderr)
            return 1
    return 0


def run(path: Path) -> None:
    """Execute a notebook in a student's folder of its own, and store its outputs in place."""
    notebook = nbformat.read(path, as_version=4)
    notebook.cells.append(new_code_cell(CLOSE))
    with tempfile.TemporaryDirectory() as work:
        os.environ["ROS2LAB_WORK"] = work
        NotebookClient(notebook, timeout=CELL_TIMEOUT, record_timing=False, store_widget_state=False).execute(
            cwd=work
        )
    notebook.cells.pop()
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.outputs = [without_places(output) for output in cell.outputs]
    # The patch release of whoever ran it last is no fact about the notebook.
    notebook.metadata["language_info"] = {"name": "python"}
    nbformat.write(notebook, path)


def without_places(value: Any) -> Any:
    """Return an output in which the folder of whoever ran it last reads like a student's."""
    if isinstance(value, str):
        return value.replace(str(FOLDER.parent), "~/ros2lab").replace(str(Path.home()), "~")
    if isinstance(value, dict):
        return type(value)({key: without_places(entry) for key, entry in value.items()})
    return [without_places(entry) for entry in value] if isinstance(value, list) else value


if __name__ == "__main__":
    sys.exit(main())
