"""A process with all that it starts, which are ended together."""

from __future__ import annotations

import contextlib
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from ros2lab import family_keeper

# How long colcon and what it has started are given to end, in s, before the next signal.
_LADDER = ((signal.SIGINT, 5.0), (signal.SIGTERM, 2.0))
_KEEPER_TIMEOUT = 5.0  # s, on a busy machine, for who kills all that came from a program


def kept(command: Sequence[str]) -> list[str]:
    """Return the words that start a command so that all that comes from it ends with it.

    That is so for daemons, too, which leave their session and their parent; what is started so ends with the thread
    that has started it. A program that ends its keeper on purpose escapes, for it is the same user's.
    """
    setpriv = shutil.which("setpriv")
    with_parent = [setpriv, "--pdeathsig", family_keeper.ENDING.name.removeprefix("SIG")] if setpriv else []
    return [*with_parent, *keeping(command)]


def keeping(command: Sequence[str]) -> list[str]:
    """Return the words of `kept` for a command on a terminal, with which it ends."""
    return [sys.executable, "-I", "-S", family_keeper.__file__, *command]


def end_kept(process: subprocess.Popen[Any]) -> None:
    """End what was started as `kept`, and all that came from it, at once."""
    process.send_signal(family_keeper.ENDING)
    process.send_signal(signal.SIGCONT)
    try:
        process.wait(_KEEPER_TIMEOUT)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


@contextlib.contextmanager
def family_started(
    command: Sequence[str], folder: Path, environ: dict[str, str]
) -> Iterator[subprocess.Popen[str]]:
    """Start a command whose output is read; end it, and all that it has started, whatever happens."""
    process = subprocess.Popen(
        kept(command),
        cwd=folder,
        # What it prints is read: where FORCE_COLOR is set, Python 3.13 and later would colour tracebacks.
        env={**environ, "PYTHON_COLORS": "0"},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        encoding="utf-8",
        errors="replace",
        # Signals are ours to send: one Ctrl-C must not reach half of them twice.
        start_new_session=True,
    )
    try:
        yield process
    finally:
        _end(process)


def _end(process: subprocess.Popen[str]) -> None:
    """End a process and its descendants: as Ctrl-C would, then harder. A second Ctrl-C kills at once."""
    try:
        for number, seconds in _LADDER:
            if process.poll() is not None:
                break
            process.send_signal(number)
            # Its pipe is emptied meanwhile: it could not end with its mouth full.
            with contextlib.suppress(subprocess.TimeoutExpired, ValueError):
                process.communicate(timeout=seconds)
    finally:
        end_kept(process)
        if process.stdout is not None:
            process.stdout.close()
