"""`ros2lab assignment`: what an instructor needs who writes an assignment."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ros2lab.scratch import scratch_folder
from ros2lab.verbs.grade import Judge, UsageError, collected, told_in_a_sentence

SOLUTION = "solution"
UNSOUND = 1

assignment = typer.Typer(
    no_args_is_help=True, help="Assignments of your own: check one before it is given out."
)


@assignment.callback()
def _assignment() -> None:
    """Keep the name of its only command."""


@assignment.command()
def check(
    folder: Annotated[
        Path,
        typer.Argument(help="A folder with assignment.yaml, rubric.yaml and a model solution in solution."),
    ],
) -> None:
    """Grade an assignment's model solution, and what `ros2 pkg create` alone makes, and compare the two.

    The solution has to get all points, and a package in which nothing was written not more than half of them. Each
    criterion that cannot tell the two apart is named. The exit code is 0 if both hold, 1 if one does not; 2 for
    wrong usage, such as a mistake in a file, and 4 if this machine cannot grade.
    """
    with told_in_a_sentence():
        judge = Judge.of(folder, None, None)
        solution = folder / SOLUTION
        if not solution.is_dir():
            raise UsageError(f"There is no {solution}; put a model solution there, a workspace with its src.")
        is_sound = _compare(judge, solution)
    if not is_sound:
        raise typer.Exit(UNSOUND)


def _compare(judge: Judge, solution: Path) -> bool:
    """Grade both, say what came of it, and return whether it is as it should be."""
    from ros2lab.grading.told_apart import Comparison, create_bare, sentences  # noqa: PLC0415

    with scratch_folder() as scratch:
        bare = create_bare(judge.assignment, scratch)
        grades = []
        for path, name in ((solution, "the solution"), (bare, "an empty package")):
            seen, problem = collected(path, judge.assignment, None, has_sandbox=True, name=name)
            if problem:
                raise UsageError(problem)
            grades.append(judge.grade(seen))
    comparison = Comparison(*grades)
    for sentence in sentences(comparison):
        print(sentence)
    return comparison.is_sound
