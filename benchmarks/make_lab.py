"""`make lab` from nothing, until the address is printed, and again; beside pip and a bare JupyterLab."""

from __future__ import annotations

import os
import shutil
import signal
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path

from opened_lab import opened_lab
from row import Quantity, Row

ROOT = Path(__file__).parent.parent
INSTALL_TIMEOUT = 900.0  # s
LOCKS = ("student", "ros")  # what the bootstrap installs for a student where no ROS 2 is installed


def measure(advance: Callable[[float], None], *, is_quick: bool = False) -> list[Row]:
    """Open the lab in a fresh copy with empty caches, several times; then install its locks with pip."""
    again = 1 if is_quick else 5
    with tempfile.TemporaryDirectory(prefix="ros2lab-figures-", ignore_cleanup_errors=True) as name:
        scratch = Path(name)
        copy = scratch / "ros2lab"
        _copy_project(copy)
        environ = _bare_environment(scratch / "cache")
        make = ["make", "lab", "PORT=0"]
        with opened_lab(make, environ, copy, INSTALL_TIMEOUT) as first:
            pass
        advance(0.3)
        seconds = []
        bare = []
        for _ in range(again):
            with opened_lab(make, environ, copy) as opened:
                seconds.append(opened.seconds)
            with opened_lab(_bare_lab(copy), environ, scratch) as opened:
                bare.append(opened.seconds)
        advance(0.5)
        pip = None if is_quick else Quantity(_pip_seconds(copy, scratch / "pip"), "s")
    return [
        Row(
            "`make lab` from nothing: no .venv, empty caches",
            Quantity(first.seconds, "s"),
            "pip installing the same locks",
            pip,
            {"ratio": 1.0} if pip else {},
            "until the address is printed; depends on the network",
        ),
        Row(
            "`make lab` again",
            Quantity(statistics.median(seconds), "s", count=again),
            "a bare `jupyter lab`",
            Quantity(statistics.median(bare), "s", count=again),
            {"value": 2.0},
            f"until the address is printed; median of {again}",
        ),
    ]


def _copy_project(target: Path) -> None:
    """Copy what git knows and what it would take, but nothing that it ignores."""
    command = ["git", "ls-files", "-co", "--exclude-standard", "-z"]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    for name in filter(None, listed.split("\0")):
        source = ROOT / name
        if os.path.lexists(source):  # one that was removed but not yet for git is listed, too
            (target / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source, target / name, follow_symlinks=False)


def _bare_environment(caches: Path) -> dict[str, str]:
    """Return the environment of somebody who has just logged in, with empty caches and without a screen."""
    unwanted = ("ROS", "RMW_", "RCUTILS_", "FASTRTPS_", "_ROS_WHEELS", "JUPYTER", "VIRTUAL_ENV", "DISPLAY")
    environ = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith((*unwanted, "WAYLAND_DISPLAY", "BROWSER", "LD_LIBRARY_PATH", "AMENT_"))
    }
    for variable, folder in (("XDG_CACHE_HOME", "."), ("UV_CACHE_DIR", "uv"), ("PIP_CACHE_DIR", "pip")):
        environ[variable] = str(caches / folder)
    ours = str(ROOT / ".venv" / "bin")
    environ["PATH"] = os.pathsep.join(
        part for part in environ.get("PATH", os.defpath).split(os.pathsep) if part != ours
    )
    return environ


def _bare_lab(copy: Path) -> list[str]:
    jupyter = str(copy / ".venv" / "bin" / "jupyter")
    return [jupyter, "lab", "--no-browser", "--allow-root", "--ServerApp.port=0", "--ip=127.0.0.1"]


def _pip_seconds(copy: Path, venv: Path) -> float:
    """Return how long pip takes for the same locks into a new .venv, with an empty cache, in s."""
    environ = _bare_environment(venv / "cache")
    locks = [part for name in LOCKS for part in ("-r", str(copy / "locks" / f"{name}.txt"))]
    begin = time.monotonic()
    _run(["python3", "-m", "venv", str(venv)], environ)
    _run([str(venv / "bin" / "pip"), "install", "--quiet", "--no-deps", "--require-hashes", *locks], environ)
    return time.monotonic() - begin


def _run(command: list[str], environ: Mapping[str, str]) -> None:
    """Run a command to its end, or end it with everything that it has started."""
    process = subprocess.Popen(command, env=environ, start_new_session=True)
    try:
        code = process.wait(INSTALL_TIMEOUT)
    except BaseException:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        raise
    if code:
        raise RuntimeError(f"{' '.join(command)} ended with {code}.")
