"""What a student types into one terminal, and what is seen there."""

from __future__ import annotations

import contextlib
import os
import re
import shlex
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import psutil

from ros2lab import environment

FOREGROUND = 5  # s, after which what still runs is ended by Ctrl-C
AWAITED = 15  # s, if something is waited for
READING = 1  # s, in which what was waited for is printed to its end
STARTING = 3  # s, in which what was started in the background announces itself
LIMIT = 120  # s, for everything that is typed

_RUNS = (
    "ros2 run",
    "ros2 launch",
    "ros2 topic",
    "ros2 node",
    "ros2 param",
    "python3 ",
    "/usr/bin/python3",
    "./",
)


@dataclass(frozen=True)
class Screen:
    """What a terminal shows, and what it would hand on to the next command.

    Attributes:
        text: everything that was typed and printed.
        environ: the terminal's variables.
    """

    text: str
    environ: Mapping[str, str]


def runs_a_node(command: str) -> bool:
    """Return whether a command uses what was built, and does not build it."""
    return command.partition("=")[2].partition(" ")[2].startswith(_RUNS) or command.startswith(_RUNS)


def first_environ(home: Path, domain: int, other: int) -> dict[str, str]:
    """Return what a new terminal of the lab has, in a domain and a home of its own."""
    kept = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith(("ROS_", "ROS2LAB_", "RMW_", "RCUTILS_", "PYTHON", "AMENT_", "COLCON_"))
    }
    given = {"HOME": str(home), "ROS_DOMAIN_ID": str(domain), "OTHER_DOMAIN": str(other), "COLUMNS": "200"}
    return {**environment.lab_environment({**kept, **given}), "PYTHONUNBUFFERED": "1"}


def type_in(
    commands: Sequence[str],
    folder: Path,
    environ: Mapping[str, str],
    elsewhere: str = "",
    *,
    until: str = "",
    bound: bool = False,
) -> Screen:
    """Type commands in a folder, one after the other; the last thing typed is Ctrl-C.

    Args:
        commands: what is typed.
        folder: where.
        environ: the terminal's variables.
        elsewhere: what is started in another terminal as soon as this one has sourced its workspace.
        until: a pattern after which Ctrl-C is typed, once it and the last command are on the screen.
        bound: whether root, too, may write only where it owns the folder.
    """
    with tempfile.TemporaryDirectory() as place:
        text, variables = Path(place, "text"), Path(place, "environ")
        lines = ["set -m", f"exec >{shlex.quote(str(text))} 2>&1", _SUDO if os.geteuid() == 0 else ""]
        for command in commands:
            if elsewhere and runs_a_node(command):
                lines += [f"{_ended(elsewhere, LIMIT)} >/dev/null 2>&1 &", f"sleep {STARTING}"]
                elsewhere = ""
            lines += [f"printf '$ %s\\n' {shlex.quote(command)}", _typed(command, bool(until))]
        lines += [
            f"env -0 >{shlex.quote(str(variables))}",
            "for job in $(jobs -p); do kill -INT -- -$job 2>/dev/null; done",
            "wait",
        ]
        script = Path(place, "script")
        script.write_text("\n".join(lines))
        is_bound = bound and os.geteuid() == 0
        shell = ["setpriv", "--bounding-set=-dac_override", "bash"] if is_bound else ["bash"]
        _run(
            [*shell, str(script)],
            folder,
            environ,
            lambda: bool(until) and _is_there(until, text, commands[-1]),
        )
        pairs = variables.read_text(errors="replace").split("\0") if variables.exists() else []
        after = dict(pair.split("=", 1) for pair in pairs if "=" in pair)
        return Screen(text.read_text(errors="replace"), after or environ)


_SUDO = 'sudo() { "$@"; }; export USER=$(id -un)'


def _is_there(pattern: str, path: Path, last: str) -> bool:
    """Return whether a pattern is on the screen, and the last command has been typed."""
    text = path.read_text(errors="replace") if path.exists() else ""
    return f"$ {last}\n" in text and bool(re.search(pattern, text, re.MULTILINE))


def _typed(command: str, is_awaited: bool) -> str:
    """Return what bash runs for a command."""
    if not runs_a_node(command):
        return command
    is_background = command.endswith("&")
    line = _ended(command.rstrip("& "), LIMIT if is_background else AWAITED if is_awaited else FOREGROUND)
    return f"{line} &\nsleep {STARTING}" if is_background else line


def _ended(command: str, seconds: int) -> str:
    """Return a command that is ended by Ctrl-C after some seconds; the variables set for it stay in front."""
    setting, _, rest = command.partition(" ")
    if "=" not in setting:
        setting, rest = "", command
    return f"{setting} timeout -s INT -k 5 {seconds} {rest}"


def _run(
    command: Sequence[str], folder: Path, environ: Mapping[str, str], is_done: Callable[[], bool]
) -> None:
    with subprocess.Popen(
        command,
        cwd=folder,
        env=environ,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    ) as process:
        end = time.monotonic() + LIMIT
        while process.poll() is None and not is_done() and time.monotonic() < end:
            time.sleep(0.1)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(READING)
        _interrupt(process.pid)
        try:
            process.wait(LIMIT)
        except subprocess.TimeoutExpired:
            started = psutil.Process(process.pid).children(recursive=True)
            process.kill()
            for child in started:
                with contextlib.suppress(psutil.NoSuchProcess):
                    child.kill()


def _interrupt(shell: int) -> None:
    """Type Ctrl-C to what runs in the foreground of a shell."""
    with contextlib.suppress(psutil.NoSuchProcess):
        for child in psutil.Process(shell).children():
            if child.cmdline()[:6] == ["timeout", "-s", "INT", "-k", "5", str(AWAITED)]:
                child.send_signal(signal.SIGINT)
