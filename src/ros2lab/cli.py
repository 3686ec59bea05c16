"""The `ros2lab` command: one verb a file under `verbs/`."""

from __future__ import annotations

import os
import signal
import sys

# Ctrl-C ends the command without a traceback while what follows is imported.
_interrupt = signal.signal(signal.SIGINT, signal.SIG_DFL)

from typing import Annotated

import typer

from ros2lab import __version__
from ros2lab.verbs.assignment import assignment
from ros2lab.verbs.bundle import bundle
from ros2lab.verbs.class_ import class_
from ros2lab.verbs.course import course
from ros2lab.verbs.dashboard import dashboard
from ros2lab.verbs.demo import demo
from ros2lab.verbs.diagnose import diagnose
from ros2lab.verbs.doctor import doctor
from ros2lab.verbs.grade import grade, regrade
from ros2lab.verbs.lab import lab
from ros2lab.verbs.record import record
from ros2lab.verbs.replay import replay

signal.signal(signal.SIGINT, _interrupt)

app = typer.Typer(no_args_is_help=True, pretty_exceptions_show_locals=False)
for verb in (lab, dashboard, doctor, demo, diagnose, grade, regrade, record, replay):
    app.command()(verb)
app.add_typer(assignment, name="assignment")
app.add_typer(class_, name="class")
app.add_typer(bundle, name="bundle")
app.add_typer(course, name="course")


def main() -> None:
    """Run the command line."""
    _open_standard_streams()
    try:
        app()
    except KeyboardInterrupt:  # while typer puts the verbs together; from then on it does the same itself
        sys.exit(130)


def _open_standard_streams() -> None:
    """Where one is closed, open it to nothing: else a file that is opened later would be written to as if it were that."""
    while (number := os.open(os.devnull, os.O_RDWR)) <= 2:
        name, mode = (("stdin", "r"), ("stdout", "w"), ("stderr", "w"))[number]
        setattr(sys, name, open(number, mode))  # noqa: PTH123, SIM115 -- a number, for as long as this runs
    os.close(number)


def _show_version(is_asked: bool) -> None:
    if is_asked:
        typer.echo(f"ros2lab {__version__}")
        raise typer.Exit


@app.callback()
def _ros2lab(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """An interactive course lab for ROS 2 Jazzy."""
