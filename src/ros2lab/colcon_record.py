"""What colcon did in one run, as plain data: read from what `ros2lab.colcon_extension` has recorded.

A package's setup.py runs below colcon and could write to the record, so nothing in it is trusted to have the
right form: what has not is left out.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import NamedTuple

VARIABLE = "ROS2LAB_COLCON_RECORD"  # names the file to the extension, which imports nothing of the lab

STOPPED = "SIGINT"  # colcon's return code of a package that it stopped because another one failed


class FoundPackage(NamedTuple):
    """A package that colcon has found; its type is colcon's, such as `ros.ament_python`."""

    name: str
    path: str
    kind: str


class Message(NamedTuple):
    """A warning or an error that colcon itself has logged; it may have several lines."""

    is_error: bool
    text: str


@dataclass
class Job:
    """What became of one package.

    Attributes:
        name: the package's name.
        is_selected: whether it was to be worked on.
        returncode: None while it has not ended; `STOPPED` if colcon stopped it.
        started: when, in s on the monotonic clock; None if it was not begun.
        ended: when, in s on the same clock; None while it has not ended.
        errors: what its commands wrote to standard error, as lines.
    """

    name: str
    is_selected: bool = True
    returncode: int | str | None = None
    started: float | None = None
    ended: float | None = None
    errors: list[str] = field(default_factory=list)

    @property
    def seconds(self) -> float:
        """How long it took, in s."""
        return 0.0 if self.started is None or self.ended is None else max(0.0, self.ended - self.started)

    @property
    def has_failed(self) -> bool:
        """Whether it has failed by itself."""
        return self.returncode not in (None, 0, STOPPED)

    @property
    def is_colcon_traceback(self) -> bool:
        """Whether what it left is a traceback of colcon's own code, which hides the reason."""
        return any("colcon_core/executor" in line for line in self.errors)


@dataclass
class Record:
    """What one run of colcon did.

    Attributes:
        is_begun: whether colcon came as far as loading the extension.
        is_executing: whether it came as far as choosing what to work on.
        packages: those that it found, in the order of their names; None if it did not come so far.
        jobs: what became of each package that it knows how to work on, by name, in colcon's order.
        messages: its own warnings and errors.
    """

    is_begun: bool = False
    is_executing: bool = False
    packages: list[FoundPackage] | None = None
    jobs: dict[str, Job] = field(default_factory=dict)
    messages: list[Message] = field(default_factory=list)

    def job(self, name: str) -> Job:
        """Return the job of this name, a new one if there is none."""
        return self.jobs.setdefault(name, Job(name))


def read_record(text: str) -> Record:
    """Read the text of a record, whole or cut off anywhere."""
    record = Record()
    for line in text.split("\n"):
        try:
            entry = json.loads(line)
        except (ValueError, RecursionError):
            continue
        _add(record, entry)
    return record


def _add(record: Record, entry: object) -> None:
    """Add one line of a record, if it has the form of one."""
    match entry:
        case {"event": "begun"}:
            record.is_begun = True
        case {"event": "executing"}:
            record.is_executing = True
        case {"event": "found", "packages": list(packages)}:
            record.packages = [found for package in packages if (found := _found(package))]
        case {"event": "logged", "is_error": bool(is_error), "text": str(text)}:
            record.messages.append(Message(is_error, text))
        case {"event": "queued", "job": str(name)}:
            record.job(name)
        case {"event": "unselected", "job": str(name)}:
            record.job(name).is_selected = False
        case {"event": "started", "job": str(name), "time": float(time)}:
            record.job(name).started = time
        case {"event": "stderr", "job": str(name), "text": str(text)}:
            record.job(name).errors += text.splitlines()
        case {"event": "ended", "job": str(name), "time": float(time), "code": int(code) | str(code)}:
            job = record.job(name)
            job.ended, job.returncode = time, code


def _found(entry: object) -> FoundPackage | None:
    match entry:
        case {"name": str(name), "path": str(path), "type": str(kind)}:
            return FoundPackage(name, path, kind)
    return None
