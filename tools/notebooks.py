"""Run the worked notebooks from top to bottom and store their outputs: `make notebooks`.

An output that differs only in what the notebooks' test hides (a duration, a folder) stays as it was, so that a
second run changes nothing.
"""

from __future__ import annotations

import argparse
import configparser
import os
import re
import socket
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
from nbformat.v4 import new_code_cell
from rich.progress import track

from ros2lab import domain_lease, environment
from ros2lab.widget_state import WIDGET_VIEW

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "notebooks"
SANITIZERS = ROOT / "tests" / "notebooks" / "sanitize.cfg"
CELL_TIMEOUT = 120  # s

# A widget that closes leaves its picture instead of its view, which nobody could show without the kernel.
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
    with socket.socket(socket.AF_UNIX) as lease:
        # What else runs on this machine, such as an open lab, has no place in a stored output.
        os.environ.setdefault("ROS_DOMAIN_ID", str(domain_lease.leased(lease)))
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
    before = {cell.id: cell.outputs for cell in notebook.cells if cell.cell_type == "code"}
    notebook.cells.append(new_code_cell(CLOSE))
    with tempfile.TemporaryDirectory() as work:
        os.environ["ROS2LAB_WORK"] = work
        client = NotebookClient(
            notebook,
            timeout=CELL_TIMEOUT,
            record_timing=False,
            store_widget_state=False,
            coalesce_streams=True,
        )
        client.execute(cwd=work)
        places = {work: "~", str(FOLDER.parent): "~/ros2lab", str(Path.home()): "~"}
    notebook.cells.pop()
    for cell in notebook.cells:
        if cell.cell_type == "code":
            new = [without_view(without_places(output, places)) for output in cell.outputs]
            cell.outputs = before[cell.id] if _essence(before[cell.id]) == _essence(new) else new
    # The patch release of whoever ran it last is no fact about the notebook.
    notebook.metadata["language_info"] = {"name": "python"}
    nbformat.write(notebook, path)


def without_view(output: Any) -> Any:
    """Return an output without the view of a widget, which nobody could show without the kernel."""
    output.get("data", {}).pop(WIDGET_VIEW, None)
    return output


def without_places(value: Any, places: Mapping[str, str]) -> Any:
    """Return an output in which the folders of whoever ran it last read like a student's."""
    if isinstance(value, str):
        for place, shown in places.items():
            value = value.replace(place, shown)
        return value
    if isinstance(value, dict):
        return type(value)({key: without_places(entry, places) for key, entry in value.items()})
    return [without_places(entry, places) for entry in value] if isinstance(value, list) else value


def _essence(outputs: list[Any]) -> list[Any]:
    """Return what the notebooks' test compares of outputs, without what it hides."""
    config = configparser.RawConfigParser()
    config.read(SANITIZERS, encoding="utf-8")
    hidden = [(re.compile(section["regex"]), section["replace"]) for section in map(dict, _sections(config))]

    def bare(value: Any) -> Any:
        if isinstance(value, str):
            for pattern, replacement in hidden:
                value = pattern.sub(replacement, value)
            return value
        if isinstance(value, dict):
            return {
                key: bare(entry)
                for key, entry in value.items()
                if key not in ("execution_count", "image/png")
            }
        return [bare(entry) for entry in value] if isinstance(value, list) else value

    return [bare(output) for output in outputs]


def _sections(config: configparser.RawConfigParser) -> Iterator[configparser.SectionProxy]:
    return (config[name] for name in config.sections())


if __name__ == "__main__":
    sys.exit(main())
