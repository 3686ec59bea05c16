"""`ros2lab course`: the course, given out by other means than `make lab`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ros2lab.verbs.record import ends_in_a_sentence

course = typer.Typer(no_args_is_help=True, help="The course, given out by nbgrader.")


@course.callback()
def _course() -> None:
    """Keep the name of its only command."""


@course.command()
def release(
    out: Annotated[Path, typer.Option("--out", help="The new folder.")] = Path("nbgrader-course"),
    name: Annotated[str, typer.Option("--name", help="What nbgrader calls the assignment.")] = "week2",
    assignment: Annotated[
        Path | None, typer.Option("--assignment", help="An assignment of your own, instead of the course's.")
    ] = None,
    rubric: Annotated[
        Path | None, typer.Option("--rubric", help="A rubric of your own, instead of the assignment's.")
    ] = None,
) -> None:
    """Write a course for nbgrader: the lessons, and a notebook with a grade cell for each criterion.

    `nbgrader generate_assignment` makes the student edition of it. `nbgrader autograde` runs nothing that a student has
    written in a notebook: it asks the grader, which runs the workspace in its sandbox, as `ros2lab class grade` does.
    """
    from ros2lab.bundles.release import release as write  # noqa: PLC0415

    with ends_in_a_sentence("written"):
        write(out, name, assignment, rubric)
    print(f"{out} is ready. Next: cd {out}; nbgrader generate_assignment {name}")
