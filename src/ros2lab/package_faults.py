"""What is wrong with a package where colcon itself does not say it: in its manifest, its setup.py, or where it went."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

from catkin_pkg.package import InvalidPackage, parse_package

from ros2lab import environment
from ros2lab.build_report import Package
from ros2lab.build_text import condensed, first_error
from ros2lab.manifest_words import NOT_TAKEN, fault_of
from ros2lab.process_family import family_started

SETUP_TIMEOUT = 30.0  # s, for a setup.py to say its name


def manifest_fault(folder: Path) -> str | None:
    """Return why a package.xml is not valid; None if it is, or if there is none."""
    if not (folder / "package.xml").exists():
        return None
    try:
        parse_package(str(folder), warnings=[])
    except OSError as error:
        return f"it cannot be read: {error.strerror}"
    except (InvalidPackage, *NOT_TAKEN) as error:
        return fault_of(error, text_of(folder / "package.xml"))
    return None


def last_error(root: Path, package: Package) -> str | None:
    """Return the line that says why the last build of a package in a workspace failed, if there is one."""
    is_python = package.build_type in ("ament_python", "python")
    fault = setup_fault(root, package) if is_python else None
    log = root / "log" / "latest_build" / package.name / "stderr.log"
    return fault or first_error([*condensed(text_of(log).splitlines())])


def misplaced(root: Path, package: Package) -> list[str]:
    """Notice executables of a workspace that were installed where nobody looks for them."""
    prefix = root / "install" / package.name
    lost = {path.name for path in prefix.glob("bin/*")}
    lost -= {path.name for path in (prefix / "lib" / package.name).glob("*")}
    if package.build_type != "ament_python" or not lost:
        return []
    return [
        f"{', '.join(sorted(lost))} went to install/{package.name}/bin, where `ros2 run` does not look; "
        f"setup.cfg needs [install] with install_scripts=$base/lib/{package.name}"
    ]


def text_of(path: Path) -> str:
    """Return what a file holds; nothing if there is none."""
    return path.read_text(encoding="utf-8", errors="replace") if path.is_file() else ""


def setup_fault(root: Path, package: Package) -> str | None:
    """Ask a setup.py itself what is wrong with it, where colcon shows only its own traceback."""
    setup = package.path / "setup.py"
    if not setup.is_file():
        return f"there is no setup.py in {package.path.relative_to(root)}"
    command = [sys.executable, "setup.py", "--name"]
    with family_started(command, package.path, environment.lab_environment()) as process:
        try:
            output, _ = process.communicate(timeout=SETUP_TIMEOUT)
        except subprocess.TimeoutExpired:
            return f"setup.py does not end within {SETUP_TIMEOUT:g} s"
    if process.returncode < 0:
        return f"setup.py was ended by {signal.Signals(-process.returncode).name}"
    return first_error(output.splitlines()) if process.returncode else None
