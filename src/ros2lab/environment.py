"""Which ROS 2 this machine has, and the environment in which the lab's processes run.

ROS 2 comes from one of two places and never from both: an installed Jazzy (already sourced, or at
`/opt/ros/jazzy`) whose libraries fit this Python, or else the pip wheels beside this package.

Only the standard library is used: this module must work where nothing else does, because that is when it
is asked.
"""

from __future__ import annotations

import contextlib
import fcntl
import importlib.util
import os
import shlex
import subprocess
import sys
import sysconfig
import time
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

DISTRIBUTION = "jazzy"
DEFAULT_PREFIX = Path("/opt/ros/jazzy")

# Domains above 101 need ports that Linux also hands out to other programs.
# https://docs.ros.org/en/jazzy/Concepts/Intermediate/About-Domain-ID.html
LARGEST_SAFE_DOMAIN = 101

SHARED_MEMORY = Path("/dev/shm")  # noqa: S108 -- where Linux has it

# What installs the course and what opens it: by the Makefile where this is a checkout, else by pip and the command.
IS_CHECKOUT = (Path(__file__).parents[2] / "tools" / "bootstrap.py").is_file()
INSTALL, OPEN = ("make lab", "make lab") if IS_CHECKOUT else ('pip install "ros2lab[ros]"', "ros2lab lab")

DDS_PROFILE = Path(__file__).with_name(
    "fastdds_profile.xml"
)  # how soon processes meet, and messages are sent again

# Set by the hook that the wheels run at Python's start, once it has set LD_LIBRARY_PATH.
WHEELS_GUARD = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"

_PATH_VARIABLES = (
    "AMENT_PREFIX_PATH",
    "CMAKE_PREFIX_PATH",
    "COLCON_PREFIX_PATH",
    "LD_LIBRARY_PATH",
    "PATH",
    "PKG_CONFIG_PATH",
    "PYTHONPATH",
)


@dataclass(frozen=True)
class RosSource:
    """Where ROS 2 comes from.

    Attributes:
        kind: `installed` (a Jazzy installed on the system), `wheels` (from pip) or `missing`.
        prefix: the installation's folder; None unless `kind` is `installed`.
        is_sourced: whether the environment looked at already holds it.
        reason: one sentence that says why this one.
    """

    kind: Literal["installed", "wheels", "missing"]
    prefix: Path | None
    is_sourced: bool
    reason: str


def find_ros(
    environ: Mapping[str, str] = os.environ,
    version: tuple[int, int] = sys.version_info[:2],
    prefix: Path = DEFAULT_PREFIX,
    *,
    has_wheels: bool | None = None,
) -> RosSource:
    """Choose the ROS 2 that the lab uses.

    Args:
        environ: the environment to judge, usually that of this process.
        version: (major, minor) of the Python that will import rclpy.
        prefix: where an installed Jazzy is looked for when none is sourced.
        has_wheels: whether the pip wheels are there; None looks beside this package.
    """
    for sourced in sourced_prefixes(environ):
        if (sourced / "share" / "rclpy").is_dir() and environ.get("ROS_DISTRO") == DISTRIBUTION:
            if fits_python(sourced, version):
                return RosSource("installed", sourced, True, f"a Jazzy is sourced at {sourced}")
            return _wheels(has_wheels, f"the sourced Jazzy at {sourced} is not for Python {_dotted(version)}")
    if prefix.is_dir():
        if fits_python(prefix, version):
            return RosSource("installed", prefix, False, f"a Jazzy is installed at {prefix}")
        return _wheels(has_wheels, f"the Jazzy at {prefix} is not for Python {_dotted(version)}")
    foreign = environ.get("ROS_DISTRO")
    if foreign and foreign != DISTRIBUTION:
        return _wheels(has_wheels, f"the sourced ROS is {foreign} and the course needs {DISTRIBUTION}")
    return _wheels(has_wheels, f"no Jazzy is sourced and none is at {prefix}")


def fits_python(prefix: Path, version: tuple[int, int]) -> bool:
    """Return whether the rclpy below `prefix` has its compiled half for this Python."""
    tag = f"cpython-{version[0]}{version[1]}-"
    return any(prefix.glob(f"lib/python{_dotted(version)}/*-packages/rclpy/_rclpy_pybind11.{tag}*.so"))


def sourced_prefixes(environ: Mapping[str, str]) -> list[Path]:
    """List the folders on `AMENT_PREFIX_PATH`, first one first."""
    return [Path(part) for part in environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if part]


def own_domain(seed: str | None = None) -> int:
    """Return a domain id of this user's own, the same at every start, in 1 to 101.

    Two students of one machine are told apart by their user number and home folder; 0 is left alone
    because everybody else's ROS is there.
    """
    text = seed if seed is not None else f"{os.getuid()}:{Path('~').expanduser()}"
    return 1 + zlib.crc32(text.encode()) % LARGEST_SAFE_DOMAIN


def lab_settings(environ: Mapping[str, str] = os.environ) -> dict[str, str]:
    """Return the settings that the lab adds; whatever the user has set is not among them."""
    wanted = {
        "ROS_DOMAIN_ID": str(own_domain()),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        # Without it, an int put into a float field is published as 4e-323, silently.
        "ROS_PYTHON_CHECK_FIELDS": "1",
        "RCUTILS_CONSOLE_OUTPUT_FORMAT": "[{severity}] [{name}]: {message}",
        # Thirty early announcements: the worst of 100 discoveries went from 3 s to 0.43 s. Receipt is asked for
        # every 0.1 s, not every 3 s: a message is acknowledged, or sent again, so much sooner.
        "FASTRTPS_DEFAULT_PROFILES_FILE": str(DDS_PROFILE),
    }
    # Whoever chose another discovery mechanism has chosen its profile too.
    if "FASTDDS_DEFAULT_PROFILES_FILE" in environ or "ROS_DISCOVERY_SERVER" in environ:
        del wanted["FASTRTPS_DEFAULT_PROFILES_FILE"]
    return {name: value for name, value in wanted.items() if name not in environ}


def apply() -> None:
    """Put the lab's settings into the environment of this process; what the user has set stays."""
    os.environ.update(lab_settings())
    # Message modules read this one when they are imported, which may have been before.
    for module in list(sys.modules.values()):
        names = getattr(
            module, "__dict__", {}
        )  # asked by name, some modules import what they do not have yet
        if names.get("ros_python_check_fields") == "":
            names["ros_python_check_fields"] = os.environ["ROS_PYTHON_CHECK_FIELDS"]


def lab_environment(
    environ: Mapping[str, str] = os.environ, source: RosSource | None = None
) -> dict[str, str]:
    """Return the whole environment for a child process of the lab.

    It holds `environ`, the chosen ROS 2, this Python's own commands first on `PATH`, and the lab's
    settings. Folders of a ROS that was not chosen are taken out, and so is what forbids Python to compile
    modules: it hides a syntax error from a build, and setuptools warns of it at each one.

    Args:
        environ: what the child would otherwise inherit.
        source: the ROS 2 to use; None chooses by `find_ros`.

    Raises:
        RuntimeError: if the installed Jazzy cannot be sourced.
    """
    source = source or find_ros(environ)
    if source.kind == "installed" and source.prefix is not None:
        result = dict(environ) if source.is_sourced else _source(source.prefix, environ)
    else:
        result = _with_wheels(without_ros(environ))
    commands = sysconfig.get_path("scripts")
    parts = [part for part in result.get("PATH", os.defpath).split(os.pathsep) if part != commands]
    result["PATH"] = os.pathsep.join([commands, *parts])
    result.pop("PYTHONDONTWRITEBYTECODE", None)
    return {**result, **lab_settings(result)}


def enter_ros() -> None:
    """Start again with the installed ROS 2 sourced, where there is one that is not: this process needs it."""
    source = find_ros()
    if source.kind == "installed" and not source.is_sourced:
        os.execve(sys.executable, sys.orig_argv, lab_environment(source=source))  # noqa: S606


def terminal_environment(home: Path, environ: Mapping[str, str] = os.environ) -> dict[str, str]:
    """Return the whole environment for a shell in which a student types.

    Args:
        home: the student's folder, which is the shell's home folder.
        environ: what the shell would otherwise inherit.

    Raises:
        RuntimeError: as for `lab_environment`.
    """
    result = lab_environment(environ)
    # The lessons show what programs say in English; letters beyond ASCII stay as the user has them. Another
    # Python that is started here must find its own wheels.
    for name in ("LANGUAGE", WHEELS_GUARD):
        result.pop(name, None)
    if letters := result.pop("LC_ALL", ""):
        result["LC_CTYPE"] = letters
    result |= {"LC_MESSAGES": "C", "HOME": str(home), "ROS2LAB_WORK": str(home)}
    real_git = Path.home() / ".gitconfig"
    if real_git.exists():
        result["GIT_CONFIG_GLOBAL"] = str(real_git)
    if (home / ".git").is_file():  # no repository: then git says of a folder in it what it says anywhere
        result["GIT_CEILING_DIRECTORIES"] = str(home)
    return result


def shell_lines(environ: Mapping[str, str] = os.environ) -> str:
    """Return the lines that give a shell (bash, zsh) the lab's environment; `activate` of the .venv runs them.

    Raises:
        RuntimeError: as for `lab_environment`.
    """
    wanted = lab_environment(environ)
    unwanted = sorted(environ.keys() - wanted.keys())
    new = sorted(wanted.items() - dict(environ).items())
    return "".join(
        [f"unset {name}\n" for name in unwanted]
        + [f"export {name}={shlex.quote(value)}\n" for name, value in new]
    )


def remove_dead_shared_memory(folder: Path = SHARED_MEMORY) -> list[str]:
    """Remove the shared-memory files of Fast DDS whose process was killed; return their names.

    Each living owner holds a lock on its `_el` file. `fastdds shm clean` does the same, but also looks at
    files that are being made at this moment, and takes a fifth of a second. It also leaves a segment whose maker was
    killed before it was initialized, and for which everybody who opens it waits for ever.
    """
    removed = []
    for path in folder.glob("fastrtps_*"):
        if path.name.endswith("_sl") or not (
            _is_dead(path) if path.name.endswith("_el") else _is_half_made(path)
        ):
            continue  # many share a lock of this name
        name = path.name.removesuffix("_el")
        for dead in (folder / name, folder / f"sem.{name}_mutex", folder / f"{name}_el"):
            with contextlib.suppress(OSError):
                dead.unlink()
                removed.append(dead.name)
    return removed


def has_stale_guard(environ: Mapping[str, str]) -> bool:
    """Return whether the wheels' guard is set without the libraries of this Python's wheels."""
    libraries = environ.get("LD_LIBRARY_PATH", "").split(os.pathsep)
    return WHEELS_GUARD in environ and str(Path(sys.prefix, "lib")) not in libraries


def found_libraries() -> dict[str, str]:
    """Return the variables with what the wheels' start-up hook has found for this Python, which saves others the search."""
    if WHEELS_GUARD not in os.environ or find_ros({}).kind != "wheels":
        return {}
    folders = os.environ.get("LD_LIBRARY_PATH", "").split(os.pathsep)
    return {
        "LD_LIBRARY_PATH": os.pathsep.join(sorted(filter(None, folders))),
        WHEELS_GUARD: os.environ[WHEELS_GUARD],
    }


def without_ros(environ: Mapping[str, str]) -> dict[str, str]:
    """Return `environ` without the folders of any sourced ROS (workspaces built on it included)."""
    if "ROS_DISTRO" not in environ:
        return dict(environ)
    result = _without_roots(environ, sourced_prefixes(environ))
    for name in ("ROS_DISTRO", "ROS_VERSION", "ROS_PYTHON_VERSION"):
        result.pop(name, None)
    return result


def without_workspaces(environ: Mapping[str, str]) -> dict[str, str]:
    """Return `environ` without the folders of sourced workspaces; a ROS 2 that was built by colcon stays."""
    bases = {
        base
        for prefix in sourced_prefixes(environ)
        for base in (prefix, prefix.parent)
        if (base / ".colcon_install_layout").is_file()
    }
    ros = {base for base in bases if (base / "rclpy").is_dir() or (base / "share" / "rclpy").is_dir()}
    return _without_roots(environ, [*(bases - ros)])


def _wheels(has_wheels: bool | None, why: str) -> RosSource:
    if has_wheels is None:
        has_wheels = importlib.util.find_spec("ros_wheels_bootstrapper") is not None
    if has_wheels:
        return RosSource("wheels", None, True, f"the pip wheels are used because {why}")
    return RosSource("missing", None, False, f"{why}, and the pip wheels are not installed: run `{INSTALL}`")


def _with_wheels(environ: dict[str, str]) -> dict[str, str]:
    """Let the wheels' start-up hook find their libraries, unless they are found already.

    The hook does nothing where its guard is set, and starts Python a second time where it is not; a guard
    inherited from elsewhere, without the library path that belongs to it, would leave rclpy unable to load.
    """
    if has_stale_guard(environ):
        del environ[WHEELS_GUARD]
    return environ


def _source(prefix: Path, environ: Mapping[str, str]) -> dict[str, str]:
    """Return `environ` after bash has sourced `prefix`'s setup file."""
    setup = prefix / "setup.bash"
    finished = subprocess.run(
        ["bash", "-c", 'source "$1" >&2 && env -0', "bash", str(setup)],
        env=without_ros(environ),
        capture_output=True,
        check=False,
    )
    if finished.returncode:
        reason = finished.stderr.decode(errors="replace").strip() or f"exit code {finished.returncode}"
        raise RuntimeError(f"{setup} could not be sourced: {reason}; reinstall ros-jazzy-ros-base.")
    return parse_environment(finished.stdout)


def parse_environment(output: bytes) -> dict[str, str]:
    """Turn what `env -0` prints into a dictionary."""
    pairs = (entry.partition("=") for entry in os.fsdecode(output).split("\0") if entry)
    return {name: value for name, _, value in pairs}


def _is_dead(lock: Path) -> bool:
    try:
        if _is_young(lock):
            return False
        with lock.open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def _is_half_made(segment: Path) -> bool:
    """Return whether a segment does not begin with the word that Boost.Interprocess writes when it is initialized."""
    try:
        if _is_young(segment):
            return False
        with segment.open("rb") as file:
            return file.read(4) != (2).to_bytes(4, sys.byteorder)
    except OSError:
        return False


def _is_young(path: Path) -> bool:
    """Return whether a file may be between its making and its locking or initializing."""
    return time.time() - path.stat().st_mtime < 1.0


def _without_roots(environ: Mapping[str, str], roots: list[Path]) -> dict[str, str]:
    """Return `environ` without the parts of its paths that lie in one of these folders."""
    result = dict(environ)
    for name in _PATH_VARIABLES:
        if name in result:
            kept = [part for part in result[name].split(os.pathsep) if part and not _is_below(part, roots)]
            result[name] = os.pathsep.join(kept)
            if not kept:
                del result[name]
    return result


def _is_below(part: str, roots: list[Path]) -> bool:
    path = Path(part)
    return any(path == root or root in path.parents for root in roots)


def _dotted(version: tuple[int, int]) -> str:
    return f"{version[0]}.{version[1]}"


if __name__ == "__main__":
    try:
        print(shell_lines(), end="")  # noqa: T201 -- the shell reads it
    except RuntimeError as error:
        sys.exit(str(error))
