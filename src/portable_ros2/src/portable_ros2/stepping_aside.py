"""Whether a real `ros2` and a real `launch` are there: then these are used, and never ours in their place.

The command: the first program named `ros2` on PATH that is not this one.
The libraries: an installation as a link puts ours at the very end of the path on which Python looks for
modules, so whatever other `launch` there is comes first.
"""

from __future__ import annotations

import importlib.util
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

_HERE = Path(__file__).resolve().parent
# A program named `ros2` may itself call the next one on PATH, and that is ours: then there is no real one.
_STEPS = "_PORTABLE_ROS2_STEPS_ASIDE"
_MOST_STEPS = 4


def step_aside(words: Sequence[str]) -> None:
    """Become the real `ros2` if there is one; otherwise return.

    Args:
        words: the command line without the program's name.
    """
    real = real_command(os.environ)
    if real is not None:
        os.execve(real, [str(real), *words], environment_of_real(os.environ))  # noqa: S606 -- what was asked for


def real_command(environ: Mapping[str, str]) -> Path | None:
    """Return the first program named `ros2` on PATH that is not ours, None if there is none.

    Args:
        environ: where PATH is read.
    """
    if _steps(environ) >= _MOST_STEPS:
        return None
    for part in environ.get("PATH", "").split(os.pathsep):
        path = Path(part or ".", "ros2")
        if path.is_file() and os.access(path, os.X_OK) and not _is_ours(path):
            return path.absolute()
    return None


def environment_of_real(environ: Mapping[str, str]) -> dict[str, str]:
    """Return the environment without what the pip wheels of rclpy have set: the real one brings its own."""
    own = Path(sys.prefix)
    real = {name: value for name, value in environ.items() if name != "_ROS_WHEELS_BOOTSTRAP_COMPLETE"}
    folders = [part for part in real.pop("LD_LIBRARY_PATH", "").split(os.pathsep) if part]
    kept = [folder for folder in folders if own not in Path(folder).parents]
    if kept:
        real["LD_LIBRARY_PATH"] = os.pathsep.join(kept)
    return {**real, _STEPS: str(_steps(environ) + 1)}


def has_real_launch(name: str = "launch") -> bool:
    """Return whether `import launch` (or another name) takes a module that is not ours."""
    spec = importlib.util.find_spec(name)
    return (
        spec is not None
        and spec.origin is not None
        and Path(spec.origin).resolve().parent != _HERE.parent / name
    )


def _steps(environ: Mapping[str, str]) -> int:
    steps = environ.get(_STEPS, "")
    return int(steps) if steps.isdecimal() else 0


def _is_ours(path: Path) -> bool:
    """Return whether a program is what an installation of this package makes, in this environment or another."""
    try:
        return b"portable_ros2.command" in path.read_bytes()
    except OSError:  # it may be run, but not be read
        return False
