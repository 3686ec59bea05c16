"""The `ros2lab` command: one verb a file under `verbs/`."""

from __future__ import annotations

import os
import signal
import sys

# Ctrl-C ends the command without a traceback while what follows is imported.
_interrupt = signal.signal(signal.SIGINT, signal.SIG_DFL)

import functools
import importlib
from collections.abc import Iterable, Sequence
from typing import Annotated, Any

import typer

from ros2lab import __version__

signal.signal(signal.SIGINT, _interrupt)

# What each verb is, or the group of verbs. Only the one that is asked for is loaded: all of them take as long as many
# a command.
_VERBS = {
    "lab": "lab:lab",
    "dashboard": "dashboard:dashboard",
    "doctor": "doctor:doctor",
    "demo": "demo:demo",
    "diagnose": "diagnose:diagnose",
    "grade": "grade:grade",
    "regrade": "grade:regrade",
    "record": "record:record",
    "replay": "replay:replay",
    "assignment": "assignment:assignment",
    "class": "class_:class_",
    "bundle": "bundle:bundle",
    "course": "course:course",
}


def main() -> None:
    """Run the command line."""
    _open_standard_streams()
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    app = _app_for(sys.argv[1:])
    signal.signal(signal.SIGINT, _interrupt)
    try:
        app()
    except KeyboardInterrupt:  # while typer puts the verbs together; from then on it does the same itself
        sys.exit(130)
    except FileNotFoundError:
        if not _is_folder_gone():
            raise
        where = os.environ.get("PWD", "")
        typer.echo(
            f"The folder of this terminal {where} no longer exists; type `cd`, or `cd {where}` if it was made again.",
            err=True,
        )
        sys.exit(2)


def __getattr__(name: str) -> Any:
    if name != "app":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return _app_of(tuple(_VERBS))


def _app_for(words: Sequence[str]) -> typer.Typer:
    """Return what understands a command line, without the program's name."""
    return _app_of(tuple(words[:1]) if {*words[:1]} & {*_VERBS} else tuple(_VERBS))


@functools.cache
def _app_of(names: Iterable[str]) -> typer.Typer:
    app = typer.Typer(callback=_ros2lab, no_args_is_help=True, pretty_exceptions_show_locals=False)
    for name in names:
        module, _, attribute = _VERBS[name].partition(":")
        verb = getattr(importlib.import_module(f"ros2lab.verbs.{module}"), attribute)
        if isinstance(verb, typer.Typer):
            app.add_typer(verb, name=name)
        else:
            app.command(name)(verb)
    return app


def _is_folder_gone() -> bool:
    """Return whether the folder in which the command was typed has been deleted."""
    try:
        os.getcwd()  # noqa: PTH109 -- asks no more than that
    except FileNotFoundError:
        return True
    return False


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


def _ros2lab(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """An interactive course lab for ROS 2 Jazzy."""
