"""`ros2lab bundle`: the course, packed for where it is to run."""

from __future__ import annotations

import platform
import subprocess
from pathlib import Path
from typing import Annotated

import typer

from ros2lab.verbs.record import ends_in_a_sentence

bundle = typer.Typer(
    no_args_is_help=True,
    help="The course, packed for where it is to run: without a network, in Gradescope, in a repository's own CI.",
)
_THIS_PYTHON = ".".join(platform.python_version_tuple()[:2])


@bundle.command()
def offline(
    out: Annotated[Path, typer.Option("--out", help="The new folder.")] = Path("ros2lab-offline"),
    python: Annotated[
        list[str] | None,
        typer.Option(
            "--python",
            metavar="VERSION",
            help=f"The other machines' Python, such as 3.12; may be given again. (default: {_THIS_PYTHON})",
        ),
    ] = None,
) -> None:
    """Make a folder that installs the course without a network, on x86-64 Linux.

    Copy it to the other machine, and type `./lab` there. It needs about 250 MB for each version of Python.
    """
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn  # noqa: PLC0415

    from ros2lab import bundles  # noqa: PLC0415

    with (
        ends_in_a_sentence("made"),
        Progress(TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn()) as shown,
    ):
        versions = python or [_THIS_PYTHON]
        tasks = {version: shown.add_task(f"Packages for Python {version}") for version in versions}
        bundles.offline(
            out,
            versions,
            lambda version, *counts: shown.update(tasks[version], completed=counts[0], total=counts[1]),
        )
    print(f"{out} is ready: copy it to the other machine, and type ./lab in it.")


@bundle.command()
def gradescope(
    out: Annotated[Path, typer.Option("--out", help="The new zip.")] = Path("autograder.zip"),
    assignment: Annotated[
        Path | None, typer.Option("--assignment", help="An assignment of your own, instead of the course's.")
    ] = None,
) -> None:
    """Make the zip that Gradescope takes as an autograder.

    The grader's sandbox needs user namespaces, or to run as root with the right to make namespaces. Where the
    container has neither, each submission is told that it cannot be graded there, and none is run without a sandbox.
    """
    from ros2lab import bundles  # noqa: PLC0415

    with ends_in_a_sentence("made"):
        bundles.gradescope(out, assignment)
    print(f"{out} is ready: give it to Gradescope as the autograder.")


@bundle.command()
def github(
    source: Annotated[
        str | None,
        typer.Option(
            "--from", help="The git address of the course. (default: where this checkout came from)"
        ),
    ] = None,
    out: Annotated[Path, typer.Option("--out", help="The workflow's file.")] = Path(
        ".github/workflows/ros2lab.yml"
    ),
) -> None:
    """Write a workflow for GitHub Actions, also of a Classroom: it builds, tests and grades each push.

    The grade is the run's summary, and each fault stands at its line.
    """
    from ros2lab import bundles  # noqa: PLC0415

    with ends_in_a_sentence("made"):
        address = source or _origin()
        if not address:
            raise bundles.BundleError(
                "Nothing says where the course is cloned from; give its address with --from."
            )
        bundles.github(out, address, "3.12")
    print(f"{out} is ready: commit and push it.")


def _origin() -> str:
    command = ["git", "-C", str(Path(__file__).parent), "remote", "get-url", "origin"]
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()
