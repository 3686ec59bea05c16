"""Runs the type checker, and asks it which Python reads a file."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from ros2lab.scratch import scratch_folder

_LONGEST = 60.0  # s, on a busy machine; a workspace takes a quarter of a second
_UNREAD = re.compile(r":(?P<line>\d+):\d+: \w+\[invalid-syntax\] (?P<said>.*)$", re.MULTILINE)
_NEWER = re.compile(r"(?P<what>.+) on Python [\d.]+ \(syntax was added in Python (?P<version>[\d.]+)\)$")
Version = tuple[int, ...]


def type_checker_says(folder: Path, options: Sequence[str]) -> str:
    """Return what the type checker prints in a folder, a line for each message; empty if it is missing or fails."""
    places = f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}"
    checker = shutil.which("ty", path=places)
    environ = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    environ["TY_MAX_PARALLELISM"] = "1"  # of a workspace, further threads take more than they save
    command = [checker or "", "check", "--output-format", "concise", "--exit-zero", *options]
    with contextlib.suppress(OSError, subprocess.SubprocessError):
        (folder / "ty.toml").touch()  # it names modules from its own folder on
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=_LONGEST, check=False, cwd=folder, env=environ
        )
        return done.stdout
    return ""


@dataclass(frozen=True)
class Newer:
    """What a Python cannot do on a line, in a few words, and the first version that can."""

    line: int
    what: str
    version: Version


@lru_cache(maxsize=64)
def newer_syntax(text: str, python: Version = sys.version_info[:2]) -> Newer | None:
    """Return the first thing in a file that a Python cannot read, if a later one can; None if none can or it is not known."""
    with scratch_folder() as folder:
        (folder / "file.py").write_text(text, encoding="utf-8", errors="replace")
        said = type_checker_says(folder, ["--python-version", ".".join(map(str, python)), "file.py"])
    rows = [(int(row["line"]), _NEWER.match(row["said"])) for row in _UNREAD.finditer(said)]
    first = min((line for line, _ in rows), default=0)
    found = [newer for line, newer in rows if line == first]
    versions = [tuple(map(int, newer["version"].split("."))) for newer in found if newer]
    if not versions or len(versions) < len(found) or found[0] is None:
        return None
    return Newer(first, found[0]["what"], max(versions))
