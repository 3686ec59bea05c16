"""Lesson 8, in which everything runs at once: three nodes, panel, plot and logs."""

from __future__ import annotations

import nbformat

from ros2lab import course

NOTEBOOK = "08_drive_the_robot.ipynb"


def code_cells() -> list[str]:
    """Return the code of its cells."""
    path = next(path for path in course.notebooks() if path.name == NOTEBOOK)
    return [cell.source for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"]
