"""The surroundings in which commands are compared: a built workspace, nodes that run, a folder to write in."""

from __future__ import annotations

import contextlib
import os
import random
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from place import own_place

from ros2lab.environment import LARGEST_SAFE_DOMAIN

ROOT = Path(__file__).resolve().parent.parent
LAUNCH_FILES = Path(__file__).parent / "launch_files"
NODES = Path(__file__).with_name("against_ros2cli_nodes.py")
# A topic of each world: the real tool's daemon knows the world when it lists it.
WORLDS = {"quiet": "", "talkers": "/chatter", "twins": "/twin/"}
SETTLE_TIMEOUT = 20.0  # s

# What every bash of a case knows: `heard` shows what /heard has brought, `tab` what the Tab key offers.
FUNCTIONS = r"""
heard() { local code=$?; sleep 0.3; cat "$HEARD"; return $code; }
tab() {
    COMP_LINE=$1 COMP_POINT=${#1} COMP_TYPE=9 _ARGCOMPLETE=1 _ARGCOMPLETE_SHELL=bash _ARGCOMPLETE_IFS=$'\013' \
        _ARGCOMPLETE_SUPPRESS_SPACE=1 _ARGCOMPLETE_STDOUT_FILENAME="$HEARD.tab" ros2 >/dev/null
    local code=$?
    tr '\013' '\n' <"$HEARD.tab" | sed -e '$a\' | sort -u
    return $code
}
"""


class Surroundings:
    """A prepared folder, the environment of both sides, and the nodes of one world at a time.

    Attributes:
        work: where each run starts, empty.
        environ: of every command; PATH does not yet hold a side's `ros2`.
    """

    def __init__(self, folder: Path, environ: Mapping[str, str], real: Path) -> None:
        self.work = folder / "work"
        self.heard = folder / "heard.txt"
        self._folder = folder
        self._real = real
        self._nodes: subprocess.Popen[str] | None = None
        self._world = ""
        functions = folder / "functions.bash"
        functions.write_text(FUNCTIONS, encoding="utf-8")
        plain = {
            name: value
            for name, value in environ.items()
            if name not in ("PYTHONUNBUFFERED", "PYTHONDONTWRITEBYTECODE", "ROS2LAB_WORK")
        }
        self.environ = {
            **plain,
            "BASH_ENV": str(functions),
            "HEARD": str(self.heard),
            "LAUNCH_FILES": str(folder / "launch_files"),
            "ROS_LOG_DIR": str(folder / "log"),
            "COLUMNS": "80",
            "LC_ALL": "C.UTF-8",
        }
        # A copy: Python writes compiled files beside a launch file.
        shutil.copytree(LAUNCH_FILES, folder / "launch_files", ignore=shutil.ignore_patterns("parts"))
        self._build()

    def side_environ(self, program: Path, name: str) -> dict[str, str]:
        """Return the environment in which `ros2` is this program."""
        commands = self._folder / f"{name}_bin"
        commands.mkdir(exist_ok=True)
        with contextlib.suppress(FileExistsError):
            (commands / "ros2").symlink_to(program)
        return {**self.environ, "PATH": f"{commands}{os.pathsep}{self.environ['PATH']}"}

    def clear(self) -> None:
        """Make the working folder empty, and forget what was heard."""
        shutil.rmtree(self.work, ignore_errors=True)
        self.work.mkdir()
        self.heard.write_text("", encoding="utf-8")
        self.heard.with_name("heard.txt.tab").write_text("", encoding="utf-8")

    def enter(self, world: str) -> None:
        """Let the nodes of `world` run, and no others, and wait until the real tool's daemon knows."""
        if world == self._world:
            return
        self.leave()
        self._nodes = subprocess.Popen(
            [sys.executable, str(NODES), world],
            env=self.environ,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        assert self._nodes.stdout is not None
        if self._nodes.stdout.readline() != "ready\n":
            raise RuntimeError(f"The nodes of {world} did not start.")
        self._world = world
        _wait(lambda: self._is_known(world), f"the daemon of the real ros2 to know the nodes of {world}")

    def leave(self) -> None:
        """End the nodes."""
        if self._nodes is None:
            return
        assert self._nodes.stdin is not None
        self._nodes.stdin.close()
        try:
            self._nodes.wait(SETTLE_TIMEOUT)
        except subprocess.TimeoutExpired:
            self._nodes.kill()
            self._nodes.wait()
        assert self._nodes.stdout is not None
        self._nodes.stdout.close()
        self._nodes, self._world = None, ""

    def ask_real(self, *words: str) -> str:
        """Return what the real tool says on standard output."""
        result = subprocess.run(
            [str(self._real), *words],
            env=self.environ,
            cwd=self._folder,
            capture_output=True,
            text=True,
            check=False,
        )
        return result.stdout

    def _is_known(self, world: str) -> bool:
        services = self.ask_real("service", "list", "--include-hidden-services")
        seen = self.ask_real("topic", "list", "--include-hidden-topics") + services
        return all((not mark) or (mark in seen) == (name == world) for name, mark in WORLDS.items())

    def _build(self) -> None:
        """Build robot_controller and the small package of the launch files."""
        workspace = self._folder / "ws"
        for package in (ROOT / "robot_controller", LAUNCH_FILES / "parts"):
            ignored = shutil.ignore_patterns("__pycache__", "build", "install", "log", "*.egg-info")
            shutil.copytree(package, workspace / "src" / package.name, ignore=ignored)
        built = subprocess.run(
            ["colcon", "--log-base", "log", "build", "--event-handlers", "console_direct-"],
            cwd=workspace,
            env=self.environ,
            capture_output=True,
            text=True,
            check=False,
        )
        if built.returncode:
            raise RuntimeError(
                f"The workspace of the comparison was not built:\n{built.stdout}{built.stderr}"
            )
        sourced = subprocess.run(
            ["bash", "-c", 'source "$0" && env -0', str(workspace / "install" / "setup.bash")],
            env=self.environ,
            capture_output=True,
            check=True,
        )
        self.environ = dict(part.split("=", 1) for part in sourced.stdout.decode().split("\0") if "=" in part)


@contextlib.contextmanager
def surroundings(real: Path) -> Iterator[Surroundings]:
    """Prepare everything, with the real tool's daemon running; end and remove it at the end."""
    with own_place() as place, _leased_domain() as domain:
        prepared = Surroundings(place.folder, {**place.environ, "ROS_DOMAIN_ID": str(domain)}, real)
        try:
            prepared.ask_real("daemon", "start")
            yield prepared
        finally:
            prepared.leave()
            prepared.ask_real("daemon", "stop")


@contextlib.contextmanager
def _leased_domain() -> Iterator[int]:
    """Keep a ROS domain from the project's tests, which lease theirs in the same way, and from other comparisons."""
    domains = list(range(1, LARGEST_SAFE_DOMAIN + 1))
    random.shuffle(domains)
    for domain in domains:
        with socket.socket(socket.AF_UNIX) as lease:
            try:
                lease.bind(f"\0ros2lab-test-domain-{domain}")
            except OSError:
                continue
            yield domain
            return
    raise RuntimeError("Every ROS domain is in use.")


def _wait(is_so: Callable[[], bool], what: str) -> None:
    deadline = time.monotonic() + SETTLE_TIMEOUT
    while not is_so():
        if time.monotonic() > deadline:
            raise TimeoutError(f"Waited {SETTLE_TIMEOUT:g} s for {what}.")
        time.sleep(0.2)
