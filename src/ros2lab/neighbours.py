"""Who else of a student's own has nodes in a ROS domain: other notebooks, and programs in terminals.

All notebooks and terminals of a student share one domain. Who is there is asked of Linux: which processes listen
on the domain's ports, and whether they were started in the student's folder. A session of another notebook is
asked to close itself, because its kernel is to live on; a program gets what Ctrl-C sends.
"""

from __future__ import annotations

import contextlib
import json
import os
import shlex
import signal
import socket
import struct
import threading
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import psutil

from portable_ros2 import participants
from ros2lab import course

THREAD_NAME = "ros2lab-neighbours"
ANSWER_TIMEOUT = 2.0  # s
CLOSE_TIMEOUT = 15.0  # s, in which a session ends its nodes and processes
LONGEST_COMMAND = 60  # letters
NOTEBOOK = "JPY_SESSION_NAME"  # in which Jupyter tells a kernel, and what comes from it, the notebook's path
# How long a program is given to end, in s, before the next signal.
_LADDER = ((signal.SIGINT, 5.0), (signal.SIGTERM, 2.0), (signal.SIGKILL, 2.0))


@dataclass(frozen=True)
class Neighbour:
    """A process with nodes in the same domain.

    Attributes:
        place: where it was started: the name of a notebook, or a terminal.
        runs: its nodes or its command, in words.
        process: the process.
        kind: `session`, a `program`, or a `kernel` whose nodes no session runs.
    """

    place: str
    runs: str
    process: psutil.Process
    kind: Literal["session", "program", "kernel"]

    def stop(self) -> None:
        """Close a session, or end a program as Ctrl-C does, and harder if it does not end; a kernel is left alone."""
        if self.kind == "session":
            ask_session(self.process.pid, "close", CLOSE_TIMEOUT)
        if self.kind != "program":
            return
        job = _job(self.process)
        for number, seconds in _LADDER:
            for member in job:
                with contextlib.suppress(psutil.NoSuchProcess, psutil.AccessDenied):
                    member.send_signal(number)
            _, job = psutil.wait_procs(job, timeout=seconds)
            if not job:
                return

    def __str__(self) -> str:
        return f"{self.place[0].upper()}{self.place[1:]} still runs {self.runs}"


class Listener:
    """Answers other notebooks of the same user: which nodes a session has, and closes it if it is asked to.

    Where another user has taken the name on which it listens, nobody is answered.

    Args:
        nodes: returns the names of the session's nodes.
        close: closes the session.
    """

    def __init__(self, nodes: Callable[[], list[str]], close: Callable[[], object]) -> None:
        self._nodes = nodes
        self._close = close
        self._socket = socket.socket(socket.AF_UNIX)
        with contextlib.suppress(OSError):
            self._socket.bind(_address(os.getpid()))
            self._socket.listen()
        self._thread = threading.Thread(target=self._serve, name=THREAD_NAME, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Answer no more. Closing twice does no harm."""
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        if threading.current_thread() is not self._thread:
            self._thread.join(ANSWER_TIMEOUT)
        self._socket.close()

    def _serve(self) -> None:
        while True:
            try:
                connection, _ = self._socket.accept()
            except OSError:  # it was closed
                return
            with connection, contextlib.suppress(OSError):
                connection.settimeout(ANSWER_TIMEOUT)
                if _peer(connection)[1] != os.getuid():
                    continue
                word = connection.recv(16)
                nodes = self._nodes()
                if word == b"close":
                    self._close()
                connection.sendall(json.dumps(nodes).encode())


def ask_session(pid: int, word: str, timeout: float) -> list[str] | None:
    """Ask the session of a process; return the names of its nodes, None if there is no session.

    Args:
        pid: the process.
        word: `nodes`, or `close` to close it; then the names are those that it had.
        timeout: the longest wait for the answer, in s.
    """
    with socket.socket(socket.AF_UNIX) as connection, contextlib.suppress(OSError, ValueError):
        connection.settimeout(timeout)
        connection.connect(_address(pid))
        if _peer(connection) != (pid, os.getuid()):
            return None
        connection.sendall(word.encode())
        answer = b"".join(iter(lambda: connection.recv(65536), b""))
        return [str(name) for name in json.loads(answer)]
    return None


def neighbours(domain_id: int) -> list[Neighbour]:
    """List who else of this student's own has nodes in a domain, in the order of where they were started.

    What comes from this process is not among them.
    """
    inodes = {listener.inode for listener in participants.listeners(domain_id) or []}
    this = psutil.Process()
    inodes -= participants.sockets(this.pid)
    if not inodes:
        return []
    own = {this, *this.children(recursive=True)}
    work = course.work_folder().resolve()
    found = []
    for process in psutil.process_iter():
        if process in own or not inodes & participants.sockets(process.pid):
            continue
        with contextlib.suppress(psutil.Error, OSError):
            environ = process.environ()
            if process.uids().real == os.getuid() and _belongs(process, environ, work):
                found.append(_neighbour(process, environ))
    return sorted(found, key=lambda neighbour: (neighbour.place, neighbour.runs))


def notice(met: Iterable[Neighbour], remedy: str) -> str:
    """Return a line for each neighbour that says how it is stopped; nothing if there is none.

    Args:
        met: the neighbours.
        remedy: what is typed here to stop them; empty if nothing is.
    """
    return "".join(
        f"{neighbour}: restart its kernel.\n"
        if neighbour.kind == "kernel"
        else f"{neighbour}: stop it there{remedy and f', or here with `{remedy}`'}.\n"
        for neighbour in met
    )


def stop_neighbours(domain_id: int) -> str:
    """Stop who else has nodes in a domain; return a line for each that says so."""
    met = neighbours(domain_id)
    for neighbour in met:
        neighbour.stop()
    stopped = "".join(
        f"Stopped {neighbour.runs} of {neighbour.place}.\n" for neighbour in met if neighbour.kind != "kernel"
    )
    return stopped + notice((neighbour for neighbour in met if neighbour.kind == "kernel"), "")


def _neighbour(process: psutil.Process, environ: dict[str, str]) -> Neighbour:
    notebook = Path(environ.get(NOTEBOOK, "")).stem
    if notebook and notebook == Path(os.environ.get(NOTEBOOK, "")).stem:
        notebook = "another kernel of this notebook"
    nodes = ask_session(process.pid, "nodes", ANSWER_TIMEOUT)
    if nodes is not None:
        names = ", ".join(f"`{name}`" for name in nodes) or "a session without nodes"
        return Neighbour(notebook or "another program", names, process, "session")
    if _is_kernel(process):
        return Neighbour(notebook or "another notebook", "nodes of its own", process, "kernel")
    return Neighbour(notebook or "a terminal", f"`{_command(process)}`", process, "program")


def _belongs(process: psutil.Process, environ: dict[str, str], work: Path) -> bool:
    """Return whether a process was started in the student's folder, or for it."""
    folders = [environ.get("ROS2LAB_WORK") or "/", process.cwd()]
    return any(Path(folder).resolve().is_relative_to(work) for folder in folders)


def _is_kernel(process: psutil.Process) -> bool:
    return any("ipykernel" in word for word in process.cmdline())


def _command(process: psutil.Process) -> str:
    """Return what was typed to start a process: the command of its job, without the Python that runs it."""
    with contextlib.suppress(psutil.Error, ProcessLookupError):
        leader = psutil.Process(os.getpgid(process.pid))
        process = process if _is_kernel(leader) else leader
    words = process.cmdline()
    if len(words) > 1 and Path(words[0]).name.startswith("python") and not words[1].startswith("-"):
        words = words[1:]
    text = shlex.join([Path(words[0]).name, *words[1:]])
    return text if len(text) <= LONGEST_COMMAND else f"{text[: LONGEST_COMMAND - 1]}…"


def _job(process: psutil.Process) -> list[psutil.Process]:
    """Return what Ctrl-C in its terminal would reach: the process group, unless a kernel is in it."""
    members = []
    with contextlib.suppress(ProcessLookupError):
        group = os.getpgid(process.pid)
        for other in psutil.process_iter():
            with contextlib.suppress(ProcessLookupError):
                if os.getpgid(other.pid) == group:
                    members.append(other)
    return [process] if any(map(_is_kernel, members)) else members


def _address(pid: int) -> str:
    """Return the name, in no folder, of the socket of a process's session.

    Containers that share a network have processes of the same number: their namespaces tell them apart.
    """
    with contextlib.suppress(OSError):
        return f"\0ros2lab-session-{Path('/proc/self/ns/pid').stat().st_ino}-{pid}"
    return f"\0ros2lab-session-{pid}"


def _peer(connection: socket.socket) -> tuple[int, int]:
    """Return the number and the user of the process at the other end."""
    pid, user, _ = struct.unpack("iII", connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12))
    return pid, user
