"""A course for nbgrader: its assignment is the student edition, and one notebook holds the points."""

from __future__ import annotations

import shutil
from pathlib import Path
from string import Template
from typing import Any

from ros2lab import course
from ros2lab.assignments.lesson import load_lesson
from ros2lab.bundles import BundleError, made_whole
from ros2lab.classroom.exports import GRADE_CELL, NOTEBOOK
from ros2lab.classroom.handed_in import ClassError
from ros2lab.classroom.judging import Judging
from ros2lab.grading.reports.shown import number
from ros2lab.grading.rubric import Rubric

CONFIG = "nbgrader_config.py"

_CONFIG = Template("""\
# nbgrader reads this in the course's folder. The grader is asked for the points, in its sandbox: no cell that a
# student has handed in is run. In a course of your own, these two lines make the same of it.
from ros2lab.classroom.autograde import configure

configure(get_config()$options)
""")
_INTRODUCTION = Template("""\
# Your points

When you hand this folder in, the grader builds the workspace `$workspace` that lies in it, runs your nodes in a
sandbox, and fills in a cell for each criterion below.
It looks at what your nodes do; what is written in this notebook does not count.

Hand in the whole folder, with `$workspace` in it.
`ros2lab grade --self`, in a terminal, tells you today what it will find.
""")
_NOT_YET = (
    'raise RuntimeError("The grader fills this in; `ros2lab grade --self` tells you what it will find.")'
)


def release(folder: Path, name: str, assignment: Path | None = None, rubric: Path | None = None) -> None:
    """Write a course for nbgrader.

    Args:
        folder: the new folder. It appears when it is whole.
        name: what nbgrader calls the assignment.
        assignment: the folder of an assignment of your own; None for the course's.
        rubric: a rubric of your own; None for the assignment's.

    Raises:
        BundleError: if it cannot be made.
    """
    import nbformat  # noqa: PLC0415 -- slow to import

    try:
        judging = Judging.of(assignment, rubric, {})
    except ClassError as error:
        raise BundleError(str(error)) from None
    own = {"assignment": assignment, "rubric": rubric}
    options = "".join(f", {key}={str(path.absolute())!r}" for key, path in own.items() if path)
    with made_whole(folder) as unfinished:
        source = unfinished / "source" / name
        source.mkdir(parents=True)
        for path in course.notebooks():
            shutil.copyfile(path, source / path.name)
        nbformat.write(graded_notebook(judging.rubric), source / f"{NOTEBOOK}.ipynb")
        # With it the folder that is handed in is the student's home in the lab, and the workspace lies in it.
        (source / course.MARKER).write_text(course.MARKER_TEXT, encoding="utf-8")
        (unfinished / CONFIG).write_text(_CONFIG.substitute(options=options), encoding="utf-8")


def graded_notebook(rubric: Rubric) -> Any:
    """Return the notebook that holds the points: a locked cell for each criterion, called as the criterion is."""
    from nbformat import v4  # noqa: PLC0415

    def marked(cell: Any, grade_id: str, points: float | None = None) -> Any:
        cell.metadata["nbgrader"] = {
            "grade": points is not None,
            "grade_id": grade_id,
            "locked": True,
            "schema_version": 3,
            "solution": False,
            "task": False,
            **({} if points is None else {"points": points}),
        }
        return cell

    text = _INTRODUCTION.substitute(workspace=load_lesson().workspace)
    cells = [marked(v4.new_markdown_cell(text, id="introduction"), "introduction")]
    for criterion in rubric.criteria:
        is_extra = criterion.component == "bonus"
        said = f"# {criterion.title}: {number(criterion.points)} points{' extra' if is_extra else ''}."
        name = criterion.id.translate(GRADE_CELL)
        cell = v4.new_code_cell(f"{said}\n{_NOT_YET}", id=name)
        cells.append(marked(cell, name, 0 if is_extra else criterion.points))
    kernel = {"name": "python3", "display_name": "Python 3 (ipykernel)", "language": "python"}
    return v4.new_notebook(cells=cells, metadata={"kernelspec": kernel, "language_info": {"name": "python"}})
