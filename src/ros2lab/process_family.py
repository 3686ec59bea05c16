"""A process with all that it starts, which are ended together."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import psutil

# How long colcon and what it has started are given to end, in s, before the next signal.
_LADDER = ((signal.SIGINT, 5.0), (signal.SIGTERM, 2.0), (signal.SIGKILL, 2.0))


@contextlib.contextmanager
def family_started(
    command: Sequence[str], folder: Path, environ: dict[str, str]
) -> Iterator[subprocess.Popen[str]]:
    """Start a command whose output is read; end it, and all that it has started, whatever happens."""
    process = subprocess.Popen(
        command,
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
    known: set[psutil.Process] = set()
    try:
        for number, seconds in _LADDER:
            known |= _family(process)
            alive = [member for member in known if member.is_running()]
            if not alive:
                break
            _signal(alive, number)
            if process.poll() is None:
                # Its pipe is emptied meanwhile: it could not end with its mouth full.
                with contextlib.suppress(subprocess.TimeoutExpired, ValueError):
                    process.communicate(timeout=seconds)
            psutil.wait_procs(alive, timeout=seconds)
    except KeyboardInterrupt:
        _signal(known | _family(process), signal.SIGKILL)
        raise
    finally:
        if process.stdout is not None:
            process.stdout.close()
        process.wait()


def _family(leader: subprocess.Popen[str]) -> set[psutil.Process]:
    """Return what still runs of a process, its descendants, and the rest of its session."""
    found: set[psutil.Process] = set()
    with contextlib.suppress(psutil.NoSuchProcess):
        if leader.poll() is None:
            found |= {psutil.Process(leader.pid), *psutil.Process(leader.pid).children(recursive=True)}
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.NoSuchProcess, ProcessLookupError):
            if os.getsid(process.pid) == leader.pid:
                found.add(process)
    return {process for process in found if _is_alive(process)}


def _is_alive(process: psutil.Process) -> bool:
    with contextlib.suppress(psutil.NoSuchProcess):
        return bool(process.status() != psutil.STATUS_ZOMBIE)
    return False


def _signal(processes: Iterable[psutil.Process], number: int) -> None:
    for process in processes:
        with contextlib.suppress(psutil.NoSuchProcess, psutil.AccessDenied):
            process.send_signal(number)
