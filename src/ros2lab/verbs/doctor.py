"""`ros2lab doctor`: what this machine has, what is wrong with it, and the line that fixes it.

It is run when something is broken. So each check stands alone, a check that fails is a row and never a
traceback, and whatever may crash or hang is tried in a process of its own.
"""

from __future__ import annotations

import json
import os
import platform
import select
import shutil
import socket
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated

import typer

from ros2lab import __version__, course, environment
from ros2lab.environment import DISTRIBUTION, LARGEST_SAFE_DOMAIN, SHARED_MEMORY, WHEELS_GUARD
from ros2lab.scratch import scratch_folder
from ros2lab.verbs.doctor_report import Diagnosis, Finding, Status
from ros2lab.verbs.doctor_tools import (
    COMMAND_TIMEOUT,
    IMPORTS,
    Machine,
    end,
    finished_of,
    nearest_folder,
    reason,
    version_of,
    write_problem,
)

OLDEST_PYTHON, NEWEST_PYTHON = (3, 10), (3, 14)
LARGEST_DOMAIN = 232
WHEELS_MIDDLEWARE = "rmw_fastrtps_cpp"
USAGE_ERROR = 2  # argparse's exit code

GIB, MIB = 2**30, 2**20
LITTLE_DISK, TOO_LITTLE_DISK = GIB, 100 * MIB
LITTLE_SHARED_MEMORY = 16 * MIB


def doctor(
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON for a program to read.")] = False,
) -> None:
    """Look whether the lab can work on this machine, and say what fixes it if not."""
    from rich.console import Console  # noqa: PLC0415 -- the other verbs print no colours

    # A path may hold letters that this terminal cannot show.
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        with Console(stderr=True).status("Looking at this machine ..."):
            diagnosis = examine()
    except KeyboardInterrupt:
        raise typer.Exit(130) from None
    if as_json:
        print(diagnosis.as_json())
    else:
        Console().print(diagnosis.as_table())
    raise typer.Exit(0 if diagnosis.is_ok else 1)


def examine(environ: Mapping[str, str] | None = None) -> Diagnosis:
    """Look at this machine; takes a few seconds.

    Args:
        environ: the environment to judge; None is that of this process.
    """
    machine = Machine.of(dict(os.environ if environ is None else environ))
    findings = [finding for check in _CHECKS for finding in _tried(check, machine)]
    return Diagnosis(tuple(findings))


_Check = Callable[[Machine], "Finding | list[Finding]"]


def _tried(check: _Check, machine: Machine) -> list[Finding]:
    """Return what a check finds; if it fails itself, that is what is found."""
    try:
        found = check(machine)
    except Exception as error:
        name = check.__name__.strip("_").replace("_", " ")
        found = Finding(name, "failed", f"could not be looked at: {type(error).__name__}: {error}")
    return found if isinstance(found, list) else [found]


def _system(_: Machine) -> Finding:
    name, kind = platform.system(), platform.machine()
    values = {"system": name, "machine": kind, "release": platform.release()}
    if (name, kind) == ("Linux", "x86_64"):
        return Finding("system", "ok", f"{name} on {kind}", values=values)
    return Finding(
        "system", "failed", f"{name} on {kind}", "use Linux on x86_64, in a virtual machine", values
    )


def _python(_: Machine) -> Finding:
    version, executable = platform.python_version(), sys.executable
    values = {"version": version, "executable": executable}
    found = f"{version} at {executable}"
    if not OLDEST_PYTHON <= sys.version_info[:2] <= NEWEST_PYTHON:
        oldest, newest = (".".join(map(str, limit)) for limit in (OLDEST_PYTHON, NEWEST_PYTHON))
        return Finding("python", "failed", found, f"install a Python from {oldest} to {newest}", values)
    if any(character.isspace() for character in executable):
        # Neither colcon's setup.bash nor the first line of a script can name such a Python.
        fix = f"move the course's folder to a path without spaces, then {environment.INSTALL}"
        return Finding("python", "failed", f"{found}: what colcon builds cannot name it", fix, values)
    return Finding("python", "ok", found, values=values)


def _ros2(machine: Machine) -> Finding:
    source = machine.source
    prefix = str(source.prefix) if source.prefix else None
    values = {"kind": source.kind, "prefix": prefix, "reason": source.reason}
    if machine.problem:
        return Finding("ROS 2", "failed", machine.problem, "reinstall ros-jazzy-ros-base", values)
    if source.kind == "missing":
        return Finding("ROS 2", "failed", source.reason, environment.INSTALL, values)
    return Finding("ROS 2", "ok", source.reason, values=values)


def _rclpy(machine: Machine) -> list[Finding]:
    """Import it where the nodes run: a broken one may take its process with it."""
    finished = finished_of([sys.executable, "-c", IMPORTS], machine.child, "/")
    causes = [*_middleware(machine), *_foreign_ros(machine)]
    fix = causes[0].fix if causes else environment.INSTALL
    if finished.returncode:
        found = f"cannot be imported: {reason(finished)}"
        return [Finding(name, "failed", found, fix) for name in ("rclpy", "common interfaces")]
    told = json.loads(finished.stdout.splitlines()[-1])
    place = Path(told["file"]).parents[1]
    home = machine.source.prefix or Path(sysconfig.get_path("platlib"))
    values = {"version": told["rclpy"], "path": str(place)}
    if place.resolve().is_relative_to(home.resolve()):
        rclpy = Finding("rclpy", "ok", f"{told['rclpy']} at {place}", values=values)
    else:
        rclpy = Finding("rclpy", "failed", f"{told['rclpy']} from {place}, not from {home}", fix, values)
    interfaces = told["interfaces"]
    return [rclpy, Finding("common interfaces", "ok", interfaces, values={"version": interfaces})]


def _colcon(machine: Machine) -> Finding:
    path = shutil.which("colcon", path=machine.child.get("PATH"))
    if path is None:
        return Finding("colcon", "failed", "not installed", environment.INSTALL)
    with scratch_folder() as empty:
        finished = finished_of([path, "--log-base", os.devnull, "list"], machine.child, str(empty))
    version = version_of("colcon-core") if Path(path).parent == Path(sysconfig.get_path("scripts")) else None
    values = {"version": version, "path": path}
    if finished.returncode:
        return Finding(
            "colcon", "failed", f"{path} does not run: {reason(finished)}", environment.INSTALL, values
        )
    return Finding("colcon", "ok", f"{version or 'runs'} at {path}", values=values)


def _ros2_command(machine: Machine) -> Finding:
    path = shutil.which("ros2", path=machine.child.get("PATH"))
    if path is None:
        return Finding("ros2 command", "failed", "not installed", environment.INSTALL)
    finished = finished_of([path, "--version"], machine.child)
    said = finished.stdout.strip()
    if said.startswith("portable_ros2"):
        return Finding("ros2 command", "ok", said, values={"path": path, "version": said.split()[1]})
    if finished.returncode == USAGE_ERROR:  # the real one knows no --version
        return Finding("ros2 command", "ok", "that of the installed ROS 2", values={"path": path})
    return Finding("ros2 command", "failed", f"{path} does not run: {reason(finished)}", environment.INSTALL)


def _setuptools(_: Machine) -> Finding:
    version = version_of("setuptools")
    if version is None:
        return Finding("setuptools", "failed", "not installed", environment.INSTALL)
    number = int(version.partition(".")[0])
    if number >= 72:
        lost = "colcon build --symlink-install fails" if number >= 80 else "tests_require is not read"
        found = f"{version}: {lost} with {80 if number >= 80 else 72} and newer"
        return Finding("setuptools", "warning", found, environment.INSTALL, {"version": version})
    return Finding("setuptools", "ok", version, values={"version": version})


def _jupyterlab(_: Machine) -> Finding:
    version = version_of("jupyterlab")
    if version is None:
        return Finding("jupyterlab", "failed", "not installed", environment.INSTALL)
    return Finding("jupyterlab", "ok", version, values={"version": version})


def _ros2lab(_: Machine) -> Finding:
    place = str(Path(__file__).parents[1])
    return Finding(
        "ros2lab", "ok", f"{__version__} at {place}", values={"version": __version__, "path": place}
    )


def _domain(machine: Machine) -> Finding:
    text = machine.child["ROS_DOMAIN_ID"]
    origin = "the lab's choice for you" if text == str(environment.own_domain()) else "your choice"
    values = {"domain_id": text}
    name, fix = "domain", "unset ROS_DOMAIN_ID"
    if not (text.isascii() and text.isdigit()) or int(text) > LARGEST_DOMAIN:
        return Finding(name, "failed", f"ROS_DOMAIN_ID={text} is no number from 0 to 232", fix, values)
    if int(text) > LARGEST_SAFE_DOMAIN:
        found = f"{text}: above {LARGEST_SAFE_DOMAIN}, other programs may take its ports"
        return Finding(name, "warning", found, fix, values)
    return Finding(name, "ok", f"{text} ({origin})", values=values)


def _discovery(machine: Machine) -> Finding:
    reach = machine.child["ROS_AUTOMATIC_DISCOVERY_RANGE"]
    values = {"range": reach, "static_peers": machine.environ.get("ROS_STATIC_PEERS", "")}
    fix = "unset ROS_AUTOMATIC_DISCOVERY_RANGE"
    if reach == "LOCALHOST":
        return Finding("discovery", "ok", "LOCALHOST: nodes on this machine only", values=values)
    if reach == "OFF":
        return Finding("discovery", "failed", "OFF: no node finds another one", fix, values)
    found = f"{reach}: nodes of other machines in this network take part"
    if reach not in ("SUBNET", "SYSTEM_DEFAULT"):
        found = f"{reach} is no range that ROS knows"
    return Finding("discovery", "warning", found, fix, values)


def _settings(machine: Machine) -> list[Finding]:
    """List the settings that will hurt, a row each."""
    environ = machine.environ
    found = [
        Finding(name, status, f"{environ[name]}: {why}", f"unset {name}", {"value": environ[name]})
        for name, status, is_bad, why in _HARMFUL
        if name in environ and is_bad(environ[name])
    ]
    found += [
        *_middleware(machine),
        *_foreign_ros(machine),
        *_stale_guard(machine),
        *_stale_prefixes(machine),
    ]
    return found or [Finding("settings", "ok", "none that will hurt")]


def _middleware(machine: Machine) -> list[Finding]:
    wanted = machine.environ.get("RMW_IMPLEMENTATION")
    if not wanted or wanted == WHEELS_MIDDLEWARE:
        return []
    prefix = machine.source.prefix
    if prefix and (prefix / "lib" / f"lib{wanted}.so").exists():
        return []
    # rcl then ends the whole process, and with it the notebook's kernel.
    found = f"{wanted}: is not installed, and every node ends at once"
    return [Finding("RMW_IMPLEMENTATION", "failed", found, "unset RMW_IMPLEMENTATION", {"value": wanted})]


def _foreign_ros(machine: Machine) -> list[Finding]:
    """Find folders of another ROS on the path of the lab's processes."""
    own = machine.source.prefix
    parts = [Path(part) for part in machine.child.get("PYTHONPATH", "").split(os.pathsep) if part]
    foreign = [part for part in parts if (part / "rclpy").is_dir() and not (own and part.is_relative_to(own))]
    fix = "open a terminal in which no other ROS is sourced (look at ~/.bashrc)"
    return [
        Finding("PYTHONPATH", "failed", f"{part} holds another ROS", fix, {"value": str(part)})
        for part in foreign
    ]


def _stale_guard(machine: Machine) -> list[Finding]:
    """Find a guard of the wheels that was inherited without the library path that belongs to it."""
    if machine.source.kind != "wheels" or not environment.has_stale_guard(machine.environ):
        return []
    found = "set, but LD_LIBRARY_PATH lacks the wheels: rclpy cannot be imported from this terminal"
    return [Finding(WHEELS_GUARD, "failed", found, f"unset {WHEELS_GUARD}")]


def _stale_prefixes(machine: Machine) -> list[Finding]:
    gone = [str(part) for part in environment.sourced_prefixes(machine.child) if not part.is_dir()]
    fix = "open a new terminal and source the workspace again"
    found = f"{', '.join(gone)}: sourced, but not there any more"
    return [Finding("AMENT_PREFIX_PATH", "warning", found, fix, {"value": gone})] if gone else []


def _logs(machine: Machine) -> Finding:
    """Find the folder in which nodes write their logs: without it, no node starts."""
    child = machine.child
    fix = "export ROS_LOG_DIR=/tmp/ros-logs"
    home = child.get("ROS_HOME") or (f"{child['HOME']}/.ros" if child.get("HOME") else None)
    chosen = child.get("ROS_LOG_DIR") or (f"{home}/log" if home else None)
    if chosen is None:
        return Finding("logs", "failed", "HOME is not set, so no node can write its log", fix)
    folder = Path(chosen).expanduser()
    problem = write_problem(folder)
    values = {"path": str(folder)}
    if problem:
        return Finding("logs", "failed", f"{folder} cannot be written ({problem})", fix, values)
    return Finding("logs", "ok", str(folder), values=values)


def _shell(machine: Machine) -> Finding:
    path = shutil.which("bash", path=machine.child.get("PATH"))
    if path is None:
        return Finding("bash", "failed", "not installed; a workspace is sourced with it", "apt install bash")
    return Finding("bash", "ok", path, values={"path": path})


def _disk(machine: Machine) -> Finding:
    folder = course.work_folder(machine.environ)
    problem = write_problem(folder)
    if problem:
        fix = f"ROS2LAB_WORK=~/ros2lab-work {environment.OPEN}"
        return Finding("disk", "failed", f"{folder} cannot be written ({problem})", fix)
    free = shutil.disk_usage(nearest_folder(folder)).free
    found = f"{free / GIB:.1f} GiB free for {folder}"
    values = {"path": str(folder), "free_bytes": free}
    if free < LITTLE_DISK:
        status: Status = "failed" if free < TOO_LITTLE_DISK else "warning"
        return Finding("disk", status, found, f"make room on the disk of {folder}", values)
    return Finding("disk", "ok", found, values=values)


def _shared_memory(_: Machine) -> Finding:
    """Look at the place through which large messages go; without it they go over the network, slower."""
    name, fix = "shared memory", f"mount -t tmpfs -o size=512m tmpfs {SHARED_MEMORY}"
    problem = write_problem(SHARED_MEMORY)
    if problem or not SHARED_MEMORY.is_dir():
        found = f"{SHARED_MEMORY} cannot be written ({problem or 'it is missing'}); messages go over UDP"
        return Finding(name, "warning", found, fix)
    usage = shutil.disk_usage(SHARED_MEMORY)
    left = sum(1 for _ in SHARED_MEMORY.glob("fastrtps_*"))
    values = {"total_bytes": usage.total, "free_bytes": usage.free, "fastdds_files": left}
    found = f"{usage.free / MIB:.0f} of {usage.total / MIB:.0f} MiB free"
    if usage.free < LITTLE_SHARED_MEMORY:
        return Finding(name, "warning", found, "close other ROS programs, then fastdds shm clean", values)
    return Finding(name, "ok", found, values=values)


def _network(_: Machine) -> Finding:
    """Send a packet to ourselves: nodes of one machine find each other over its loopback interface."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.settimeout(2.0)
        try:
            receiver.bind(("127.0.0.1", 0))
            receiver.sendto(b"hello", receiver.getsockname())
            receiver.recv(16)
        except OSError as error:
            found = f"nothing can be sent to 127.0.0.1 ({error.strerror or error})"
            return Finding("network", "failed", found, "sudo ip link set lo up")
    return Finding("network", "ok", "127.0.0.1 answers")


def _message(machine: Machine) -> Finding:
    """Send real messages between two processes, there and back."""
    command = [sys.executable, str(Path(__file__).with_name("doctor_loopback.py"))]
    topic = f"/ros2lab_doctor_{os.getpid()}"
    with subprocess.Popen(
        [*command, "pong", topic],
        env=machine.child,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    ) as pong:
        try:
            assert pong.stdout is not None
            # Until it is ready; it may also die or hang, and then the other half says why.
            select.select([pong.stdout], [], [], COMMAND_TIMEOUT)
            finished = finished_of([*command, "ping", topic], machine.child)
        finally:
            end(pong)
    if finished.returncode:
        fix = "fix the rows above; then close other ROS programs and try again"
        return Finding("message", "failed", f"none came through: {reason(finished)}", fix)
    values = json.loads(finished.stdout.splitlines()[-1])
    found = (
        f"{values['message_s'] * 1e3:.2f} ms from one process to another by {values['middleware']}; "
        f"they met in {values['discovery_s']:.2f} s"
    )
    return Finding("message", "ok", found, values=values)


_CHECKS: tuple[_Check, ...] = (
    _system,
    _python,
    _ros2lab,
    _ros2,
    _rclpy,
    _colcon,
    _ros2_command,
    _setuptools,
    _jupyterlab,
    _domain,
    _discovery,
    _settings,
    _logs,
    _shell,
    _disk,
    _shared_memory,
    _network,
    _message,
)

# Name, how bad, when, and what it does.
_HARMFUL: tuple[tuple[str, Status, Callable[[str], bool], str], ...] = (
    (
        "ROS_LOCALHOST_ONLY",
        "warning",
        bool,
        "out of date; the lab sets ROS_AUTOMATIC_DISCOVERY_RANGE in its place",
    ),
    ("ROS_DISCOVERY_SERVER", "warning", bool, "nodes meet only through that server"),
    ("ROS_STATIC_PEERS", "warning", bool, "nodes of those machines take part"),
    ("ROS_SECURITY_ENABLE", "failed", lambda text: text == "true", "nodes without keys do not start"),
    (
        "ROS_PYTHON_CHECK_FIELDS",
        "warning",
        lambda text: not text,
        "an int in a float field is sent as 4e-323",
    ),
    (
        "FASTRTPS_DEFAULT_PROFILES_FILE",
        "warning",
        lambda text: not Path(text).is_file(),
        "there is no such file",
    ),
    (
        "FASTDDS_DEFAULT_PROFILES_FILE",
        "warning",
        lambda text: not Path(text).is_file(),
        "there is no such file",
    ),
    ("ROS_DISTRO", "warning", lambda text: text != DISTRIBUTION, f"the course needs {DISTRIBUTION}"),
)
