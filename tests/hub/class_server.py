"""A server for a class: an empty Debian whose systemd runs, on which somebody types what deploy/jupyterhub says."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import psutil

from bare_student import ROOT, bare_root, clone, free_port
from deadlines import DEADLINE

SUITE = os.environ.get("CLASS_SUITE", "bookworm")
GROUPS = Path("/sys/fs/cgroup")
DEPLOY = ROOT / "deploy" / "jupyterhub"
STARTED = "Started ros2lab-hub.service"
CERTIFICATES = "/etc/certificates-of-this-machine.crt"


@dataclass
class ClassServer:
    """The server, while it runs.

    Attributes:
        folder: its files, as seen from here.
        port: where its hub is, on 127.0.0.1.
        init: its systemd.
        group: the control group that systemd has divided.
    """

    folder: Path
    port: int
    init: psutil.Process
    group: Path

    @property
    def address(self) -> str:
        """The hub's address."""
        return f"http://127.0.0.1:{self.port}"

    def type(self, lines: str, **options: Any) -> str:
        """Let root type lines, and return what was printed.

        Raises:
            AssertionError: if one of them fails.
        """
        enter = ["nsenter", f"--target={self.init.pid}", "--mount", "--pid", "--uts", "--ipc", "--cgroup"]
        finished = subprocess.run(
            [*enter, "bash", "-e", "-c", f"cd\n{lines}"],
            env=environment(),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
            **options,
        )
        assert finished.returncode == 0, f"{lines}\n\n{finished.stdout}\n{self.log()}"
        return finished.stdout

    def processes(self, name: str) -> list[psutil.Process]:
        """Return the processes of a student's server."""
        unit = self.group / "ros2lab.slice" / f"jupyter-{name}-singleuser.service"
        numbers = (unit / "cgroup.procs").read_text(encoding="ascii").split()
        return [psutil.Process(int(number)) for number in numbers]

    def log(self) -> str:
        """Return what the hub, its proxy and the students' servers have told."""
        command = ["nsenter", f"--target={self.init.pid}", "--mount", "journalctl", "--no-pager"]
        return subprocess.run(command, capture_output=True, text=True, check=False).stdout

    def start(self) -> None:
        """Start the hub again; return when its proxy knows the way to the hub and to all servers.

        Raises:
            AssertionError: if that does not come.
        """
        servers = len([*(self.group / "ros2lab.slice").glob("jupyter-*-singleuser.service")])
        before = self.log().count(STARTED)
        self.type("systemctl restart ros2lab-hub")
        deadline = time.monotonic() + DEADLINE
        while (told := self.log()).count(STARTED) == before or not _is_ready(
            told.rpartition(STARTED)[2], servers
        ):
            assert time.monotonic() < deadline, self.log()
            time.sleep(0.2)


def _is_ready(told: str, servers: int) -> bool:
    """Return whether a hub has told since its start that it runs, and its proxy that it knows all servers' ways.

    A hub that has many to look after runs before it has found all of them.
    """
    return "JupyterHub is now running" in told and told.count("201 POST /api/routes/user/") >= servers


def readme_blocks() -> dict[str, str]:
    """Return what README lets root type, by the heading above it."""
    text = (DEPLOY / "README.md").read_text(encoding="utf-8")
    sections = re.split(r"^## ", text, flags=re.MULTILINE)[1:]
    return {
        section.partition("\n")[0]: "".join(
            re.findall(r"^```bash\n(.*?)^```", section, re.MULTILINE | re.DOTALL)
        )
        for section in sections
    }


@contextlib.contextmanager
def class_server(folder: Path) -> Iterator[ClassServer]:
    """Boot an empty Debian; all of it is gone afterwards.

    Args:
        folder: where its files are to lie; it must not exist.

    What the hub, its proxy and the students' servers have told is printed where something fails.

    Raises:
        PermissionError: if this is not root.
        RootError: of `tools/bare_root.py`, if the Debian cannot be made.
    """
    if os.geteuid() != 0:
        raise PermissionError("Only root can boot a system beside the one that runs: run this as root.")
    root = bare_root.bare_root(SUITE, ("systemd-sysv", "dbus"))
    subprocess.run(["cp", "--archive", root, folder], check=True)
    try:
        _connect(folder)
        clone(folder / "mnt" / "ros2lab")
        publish(folder / "mnt" / "ros2lab")
        with _groups() as groups, _booted(folder, groups) as init:
            server = ClassServer(folder, free_port(), init, groups[-1])
            try:
                yield server
            except BaseException:
                print(server.log(), file=sys.stderr)
                raise
    finally:
        shutil.rmtree(folder)


def _connect(folder: Path) -> None:
    """Let the package clients of a Debian reach what those of this machine reach."""
    for name in ("/etc/resolv.conf", "/etc/hosts"):
        shutil.copyfile(name, f"{folder}{name}")
    if bare_root.certificates():
        shutil.copyfile(bare_root.certificates(), f"{folder}{CERTIFICATES}")
    (folder / "etc/apt/apt.conf.d/99network").write_text(bare_root.apt_settings(), encoding="utf-8")


def publish(folder: Path) -> None:
    """Commit what is in the repository that README clones."""
    commit = ["-c", "user.name=Test", "-c", "user.email=test@localhost", "commit", "--quiet", "--allow-empty"]
    subprocess.run(["git", "add", "--all"], cwd=folder, check=True)
    subprocess.run(["git", *commit, "--no-verify", "--message=The working tree"], cwd=folder, check=True)


@contextlib.contextmanager
def _booted(folder: Path, groups: list[Path]) -> Iterator[psutil.Process]:
    command = [Path(__file__).with_name("boot"), folder, *groups]
    booting = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    try:
        deadline = time.monotonic() + DEADLINE
        while time.monotonic() < deadline and booting.poll() is None:
            for init in psutil.Process(booting.pid).children():
                enter = ["nsenter", f"--target={init.pid}", "--mount", "--pid"]
                asking = [*enter, "systemctl", "is-system-running", "--wait"]
                asked = subprocess.run(asking, capture_output=True, text=True, check=False)
                if asked.stdout.strip() in {"running", "degraded"}:
                    yield init
                    return
            time.sleep(0.1)
        raise AssertionError("The Debian does not boot.")
    finally:
        booting.kill()
        booting.wait()


@contextlib.contextmanager
def _groups() -> Iterator[list[Path]]:
    """Make a control group for the server in each hierarchy, and remove it with all below it."""
    made = []
    for line in Path("/proc/self/cgroup").read_text(encoding="ascii").splitlines():
        _, names, own = line.split(":", 2)
        place = GROUPS / (names.removeprefix("name=") or ("unified" if (GROUPS / "unified").is_dir() else ""))
        if (
            names != "cpuset"
        ):  # it takes nobody in before it has processors and memory, and systemd does without
            made.append(Path(f"{place}{own}", f"ros2lab-class-{os.getpid()}"))
    try:
        for group in made:
            group.mkdir()
        yield made
    finally:
        for group in made:
            folders = [Path(place) for place, _, _ in os.walk(group, topdown=False)]
            for folder in folders:
                _remove_group(folder)


def _remove_group(folder: Path) -> None:
    """Remove a control group as soon as the last process of it is gone."""
    deadline = time.monotonic() + DEADLINE
    while folder.exists():
        with contextlib.suppress(OSError):
            folder.rmdir()
            return
        assert time.monotonic() < deadline, f"{folder} still has processes."
        time.sleep(0.1)


def environment() -> dict[str, str]:
    """Return the environment of root on the server, with this machine's settings of the package clients."""
    result: dict[str, str] = bare_root.environment(as_root=True)
    registry = subprocess.run(
        ["npm", "config", "get", "registry"], capture_output=True, text=True, check=False
    )
    if registry.returncode == 0:
        result["npm_config_registry"] = registry.stdout.strip()
    if bare_root.certificates():
        result |= dict.fromkeys(("PIP_CERT", "SSL_CERT_FILE", "NODE_EXTRA_CA_CERTS"), CERTIFICATES)
    return {**result, "DEBIAN_FRONTEND": "noninteractive"}
