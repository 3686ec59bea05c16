"""How the doctor looks at a machine: it runs commands, and looks at folders and packages."""

from __future__ import annotations

import importlib.metadata
import re
import signal
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ros2lab import environment
from ros2lab.build_text import first_error
from ros2lab.environment import RosSource

if TYPE_CHECKING:
    pass


COMMAND_TIMEOUT = 30.0  # s
ENDING_TIMEOUT = 5.0  # s
IMPORTS = """
import json, importlib.metadata
import rclpy, std_msgs.msg, geometry_msgs.msg
def version(*names):
    for name in names:
        try:
            return importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            pass
    return 'of unknown version'
print(json.dumps({
    'file': rclpy.__file__,
    'rclpy': version('ros-rclpy', 'rclpy'),
    'interfaces': version('ros-jazzy-common-interfaces', 'std_msgs'),
}))
"""


@dataclass(frozen=True)
class Machine:
    """What the checks look at.

    Attributes:
        environ: the environment as the user has it.
        child: the environment in which the lab starts its processes.
        source: which ROS 2 is used.
        problem: why there is no such environment; None if there is.
    """

    environ: dict[str, str]
    child: dict[str, str]
    source: RosSource
    problem: str | None

    @classmethod
    def of(cls, environ: dict[str, str]) -> Machine:
        """Look at an environment."""
        source = environment.find_ros(environ)
        try:
            return cls(environ, environment.lab_environment(environ, source), source, None)
        except RuntimeError as error:
            return cls(environ, environ, source, str(error))


def finished_of(
    command: Sequence[str], environ: Mapping[str, str], folder: str | None = None
) -> subprocess.CompletedProcess[str]:
    """Run a command; one that does not end in time has failed."""
    try:
        return subprocess.run(
            command,
            env=environ,
            cwd=folder,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=COMMAND_TIMEOUT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        late = f"no end within {COMMAND_TIMEOUT:g} s"
        return subprocess.CompletedProcess(command, 1, "", late)
    except OSError as error:
        return subprocess.CompletedProcess(command, 1, "", str(error))


def reason(finished: subprocess.CompletedProcess[str]) -> str:
    """Return the first error that a command has printed."""
    said = first_error(finished.stderr.splitlines())
    # Which line of the probe it was says nothing to anybody.
    said = re.sub(r" \(\S+, line \d+\)$", "", said or "")
    return said or f"it ended with code {finished.returncode} and said nothing"


def end(process: subprocess.Popen[str]) -> None:
    """End a process as Ctrl-C does, or else at once."""
    process.send_signal(signal.SIGINT)
    try:
        process.wait(ENDING_TIMEOUT)
    except subprocess.TimeoutExpired:
        process.kill()


def version_of(distribution: str) -> str | None:
    """Return the version of a distribution; None if it is not installed."""
    try:
        return importlib.metadata.version(distribution)
    except importlib.metadata.PackageNotFoundError:
        return None


def nearest_folder(folder: Path) -> Path:
    """Return the folder itself, or what is there of the path to it."""
    return next(path for path in (folder, *folder.parents) if path.exists())


def write_problem(folder: Path) -> str | None:
    """Say why nothing can be written in a folder, which need not exist yet; None if it can."""
    try:
        with tempfile.TemporaryFile(dir=nearest_folder(folder)):
            return None
    except OSError as error:
        return error.strerror or str(error)
