"""An extension of colcon that records what a run of colcon does, one JSON object a line.

colcon loads it by the entry points of ros2lab's distribution. It records to the file that `ROS2LAB_COLCON_RECORD`
names; without that variable it is not there. `ros2lab.colcon_record` reads what is written here.

Every colcon on this Python imports this module: it needs nothing but the standard library and colcon_core.
"""

from __future__ import annotations

import ast
import functools
import json
import logging
import os
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from colcon_core.event.job import JobEnded, JobQueued, JobStarted, JobUnselected
from colcon_core.event.output import StderrLine
from colcon_core.event_handler import EventHandlerExtensionPoint
from colcon_core.logging import colcon_logger
from colcon_core.package_augmentation import PackageAugmentationExtensionPoint
from colcon_core.package_descriptor import PackageDescriptor
from colcon_core.plugin_system import SkipExtensionException, satisfies_version

VARIABLE = "ROS2LAB_COLCON_RECORD"


class Recorder(logging.Handler):
    """Writes what happens to a file, each line at once, so that it is there however colcon ends.

    Args:
        path: the file; it is added to.

    Raises:
        OSError: if the file cannot be written.
    """

    def __init__(self, path: Path) -> None:
        super().__init__(logging.WARNING)
        self._file = path.open("ab", buffering=0)
        self._is_writable = True
        self.write("begun")

    def write(self, event: str, **facts: object) -> None:
        """Add a line; a file that cannot be written any more is one warning."""
        if not self._is_writable:
            return
        line = json.dumps({"event": event, "time": time.monotonic(), **facts}).encode() + b"\n"
        try:
            self._file.write(line)
        except OSError as error:
            self._is_writable = False
            colcon_logger.warning(_unwritable(self._file.name, error))

    def emit(self, record: logging.LogRecord) -> None:
        """Record what colcon itself warns of, and its errors."""
        try:
            self.write("logged", is_error=record.levelno >= logging.ERROR, text=record.getMessage())
        except Exception:
            self.handleError(record)


@functools.cache
def recorder() -> Recorder | None:
    """Return the recorder of this run; None if there is nothing to record."""
    # A colcon that a package or a test starts is another run.
    path = os.environ.pop(VARIABLE, None)
    if not path:
        return None
    try:
        result = Recorder(Path(path))
    except OSError as error:
        colcon_logger.warning(_unwritable(path, error))
        return None
    colcon_logger.addHandler(result)
    _spare_the_listing()
    return result


def _spare_the_listing() -> None:
    """Start no setup.py only to list its commands, where it imports setuptools: that takes as long as the build.

    colcon looks for `develop` and `egg_info` among them. It has run setup.py before, to learn what it defines.
    """
    from colcon_core.task.python.build import PythonBuildTask  # noqa: PLC0415 -- only where something is recorded

    listed = PythonBuildTask._get_available_commands

    async def available(task: PythonBuildTask, path: str, env: dict[str, str]) -> set[str]:
        if _imports_setuptools(Path(path, "setup.py")):
            return {"develop", "egg_info"}
        return set(await listed(task, path, env))

    PythonBuildTask._get_available_commands = available


def _imports_setuptools(script: Path) -> bool:
    """Return whether a script imports setuptools in any case, by whose commands distutils then has, too."""
    try:
        statements = ast.parse(script.read_bytes()).body
    except (OSError, SyntaxError, ValueError):
        return False
    tried = [inner for statement in statements if isinstance(statement, ast.Try) for inner in statement.body]
    modules = [
        name
        for statement in (*statements, *tried)
        for name in (
            [alias.name for alias in statement.names]
            if isinstance(statement, ast.Import)
            else [statement.module or ""]
            if isinstance(statement, ast.ImportFrom)
            else []
        )
    ]
    return any(name.partition(".")[0] == "setuptools" for name in modules)


class RecordedEvents(EventHandlerExtensionPoint):
    """Record what becomes of each package."""

    def __init__(self) -> None:
        super().__init__()
        satisfies_version(EventHandlerExtensionPoint.EXTENSION_POINT_VERSION, "^1.0")
        self._write = _recorder().write
        self._is_executing = False

    def __call__(self, event: tuple[Any, Any]) -> None:
        """Record an event if it says something about a package."""
        data, source = event
        if not self._is_executing:
            self._is_executing = True
            self._write("executing")
        if isinstance(data, StderrLine) and hasattr(source, "identifier"):
            line = data.line if isinstance(data.line, str) else data.line.decode(errors="replace")
            self._write("stderr", job=source.identifier, text=line)
        elif isinstance(data, JobEnded):
            code = data.rc if isinstance(data.rc, int | str) else repr(data.rc)
            self._write("ended", job=data.identifier, code=code)
        elif type(data) in _JOB_EVENTS:
            self._write(_JOB_EVENTS[type(data)], job=data.identifier)


_JOB_EVENTS = {JobQueued: "queued", JobStarted: "started", JobUnselected: "unselected"}


class RecordedPackages(PackageAugmentationExtensionPoint):
    """Record which packages colcon finds."""

    PRIORITY = 0  # after all that may still change a package

    def __init__(self) -> None:
        super().__init__()
        satisfies_version(PackageAugmentationExtensionPoint.EXTENSION_POINT_VERSION, "^1.0")
        self._write = _recorder().write

    def augment_packages(self, descs: Iterable[PackageDescriptor], **_: object) -> None:
        """Change nothing, and record name, path and type of each package."""
        packages = [{"name": desc.name, "path": str(desc.path), "type": desc.type} for desc in descs]
        self._write(
            "found", packages=sorted(packages, key=lambda package: (package["name"], package["path"]))
        )


def _recorder() -> Recorder:
    """Return the recorder, or have colcon leave the extension out."""
    result = recorder()
    if result is None:
        raise SkipExtensionException("nothing is to be recorded")
    return result


def _unwritable(path: object, error: OSError) -> str:
    return f"The record of this run cannot be written to {path} ({error.strerror})."
