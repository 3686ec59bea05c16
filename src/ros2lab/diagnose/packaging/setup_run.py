"""Run a package's setup.py as colcon does, up to its command line, and print what setuptools was told, as JSON.

Nothing is built. It runs in a process of its own that can change nothing.
"""

from __future__ import annotations

import contextlib
import functools
import io
import json
import os
import runpy
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ros2lab.diagnose.confinement import confine
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import read_text

_LONGEST = 20  # s
_MEMORY = 1_000_000_000  # bytes
_BASE = "/base"  # where the package would be installed


def taken_by_setuptools(package: SourcePackage) -> Mapping[str, Any]:
    """Return whether a package's setup.py calls setup(), and where executables go; empty if it may not be run, or fails."""
    read = [package.folder / "setup.cfg", *sorted(package.folder.glob("*.py"))] if package.is_run else []
    return _taken(package.folder, *map(read_text, read)) if read else {}


@functools.lru_cache(maxsize=64)
def _taken(folder: Path, *_: str) -> Mapping[str, Any]:
    command = [sys.executable, "-m", __name__, str(folder.resolve())]
    try:
        # Started at the root, where no student's file shadows what it imports.
        said = subprocess.run(
            command, cwd="/", stdin=subprocess.DEVNULL, capture_output=True, timeout=_LONGEST, check=True
        ).stdout
        taken = json.loads(said)
    except (OSError, ValueError, subprocess.SubprocessError):
        return {}
    return taken if isinstance(taken, dict) else {}


def main() -> None:
    """Run the setup.py in the folder named on the command line."""
    from setuptools._distutils import core  # type: ignore[import-untyped]
    from setuptools.command import build_py, install  # type: ignore[import-untyped]  # noqa: F401 -- before it is confined

    sys.dont_write_bytecode = True
    os.chdir(sys.argv[1])
    sys.path[0] = sys.argv[1]
    sys.argv[1:] = "install", f"--prefix={_BASE}", "--single-version-externally-managed", "--record=record"
    confine(memory_bytes=_MEMORY, cpu_s=_LONGEST, written_bytes=_MEMORY)
    core._setup_stop_after = "commandline"
    told = {}
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        try:
            runpy.run_path("setup.py", run_name="__main__")
        except SystemExit as end:
            if end.code:
                raise
        if given := core._setup_distribution:
            command = given.get_command_obj("install")
            command.ensure_finalized()
            _, folder = given.get_option_dict("develop").get("script_dir", ("", None))
            told = {
                "install_scripts": command.install_scripts.replace(_BASE, "$base", 1),
                "script_dir": folder,
            }
    sys.stdout.write(json.dumps({"is_called": bool(given), **told}))


if __name__ == "__main__":
    main()
