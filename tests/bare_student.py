"""A student's computer: a bare Debian on which somebody has typed what README says, and a JupyterLab that runs there.

Tests talk to it as a browser does, over HTTP and WebSocket.
STUDENT_SUITE chooses another Debian, and STUDENT_PYTHON the prefix of a Python of this machine.
"""

from __future__ import annotations

import contextlib
import fcntl
import importlib.util
import json
import os
import re
import shutil
import socket
import struct
import subprocess
import time
import urllib.request
import uuid
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from nbformat.v4 import output_from_msg

from deadlines import DEADLINE

ROOT = Path(__file__).parents[1]
SUITE, PYTHON = os.environ.get("STUDENT_SUITE", "trixie"), os.environ.get("STUDENT_PYTHON")
OUTPUTS = ("stream", "display_data", "execute_result", "error")
FIRST_PORT = 20000  # of those that tests get
_LEASES = list[socket.socket]()  # of ports


def _tool(name: str) -> Any:
    """Import a program of tools/."""
    spec = importlib.util.spec_from_file_location(name, ROOT / "tools" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


bare_root = _tool("bare_root")
PROJECT = f"{bare_root.HOME}/ros2lab"  # where it lies inside


class Kernel:
    """A notebook's kernel, opened and talked to as JupyterLab does."""

    def __init__(self, student: Student, notebook: str) -> None:
        self.student = student
        wanted = {"path": notebook, "name": Path(notebook).name, "type": "notebook"}
        session = student.request("POST", "sessions", {**wanted, "kernel": {"name": "python3"}})
        self._session, self._id = session["id"], session["kernel"]["id"]
        self._connect()

    def connect_again(self) -> None:
        """Open the page anew; the server closes a connection on which nobody answers for a while."""
        self.leave()
        self._connect()

    def run(self, source: str) -> list[Any]:
        """Run a cell, and return its outputs.

        Raises:
            AssertionError: if it does not end, or asks for input.
        """
        request = self._send(source)
        outputs: list[Any] = []
        awaited = {"idle", "reply"}
        deadline = time.monotonic() + DEADLINE
        while awaited:
            self._socket.settimeout(max(0.01, deadline - time.monotonic()))
            try:
                frame = self._socket.recv()
            except TimeoutError as error:
                raise AssertionError(
                    f"{source}\n\nThis did not end within {DEADLINE} s: {outputs}"
                ) from error
            assert frame, f"{source}\n\nThe server has closed the connection, on which nobody answered."
            message = _message(frame)
            kind, content = message["header"]["msg_type"], message["content"]
            assert content.get("execution_state") not in ("dead", "restarting"), (
                f"{source}\n\nThe kernel died."
            )
            if message["parent_header"].get("msg_id") != request:
                continue
            assert kind != "input_request", f"{source}\n\nThis asks for input."
            if kind in OUTPUTS:
                outputs.append(output_from_msg(message))
            elif kind == "execute_reply":
                awaited.discard("reply")
            elif content.get("execution_state") == "idle":
                awaited.discard("idle")
        return outputs

    def follow(self, seconds: float) -> None:
        """Take in what comes for a while, as a page does."""
        from websocket import WebSocketTimeoutException

        deadline = time.monotonic() + seconds
        while (left := deadline - time.monotonic()) > 0:
            self._socket.settimeout(left)
            with contextlib.suppress(WebSocketTimeoutException):
                self._socket.recv()

    def leave(self) -> None:
        """Close the page; the kernel runs on."""
        self._socket.close()

    def close(self) -> None:
        """Shut the kernel down."""
        self.leave()
        self.student.request("DELETE", f"sessions/{self._session}")

    def send_to_widget(self, model_id: str, content: dict[str, Any]) -> None:
        """Send what a widget's view sends when it is clicked; the kernel takes it before the next cell."""
        self._send_message(
            "comm_msg", {"comm_id": model_id, "data": {"method": "custom", "content": content}}
        )

    def _connect(self) -> None:
        import websocket  # only here is it needed

        self._client = uuid.uuid4().hex
        self._socket = websocket.create_connection(
            f"ws://{self.student.place}/api/kernels/{self._id}/channels?session_id={self._client}",
            header=[f"Authorization: token {self.student.token}"],
            timeout=DEADLINE,
        )

    def _send(self, source: str) -> str:
        content = {"code": source, "silent": False, "store_history": True, "user_expressions": {}}
        return self._send_message("execute_request", {**content, "allow_stdin": True, "stop_on_error": True})

    def _send_message(self, kind: str, content: dict[str, Any]) -> str:
        request = uuid.uuid4().hex
        header = {"msg_id": request, "msg_type": kind, "session": self._client}
        message = {
            "channel": "shell",
            "header": {**header, "username": "student", "version": "5.3"},
            "parent_header": {},
            "metadata": {},
            "content": content,
        }
        self._socket.send(json.dumps(message))
        return request


def _message(frame: str | bytes) -> dict[str, Any]:
    """Read what came through the WebSocket; with a widget's buffers it comes as bytes, and they follow it."""
    if isinstance(frame, bytes):
        count = struct.unpack_from("!I", frame)[0]
        first, *others = struct.unpack_from(f"!{count}I", frame, 4)
        frame = frame[first : others[0] if others else None].decode()
    message: dict[str, Any] = json.loads(frame)
    return message


@dataclass
class Student:
    """A student whose JupyterLab runs.

    Attributes:
        address: where it is, with its token.
        work: the student's folder, as seen from here.
    """

    address: str
    work: Path

    @property
    def port(self) -> int:
        """The port on 127.0.0.1."""
        return int(self.address.split(":")[2].partition("/")[0])

    @property
    def place(self) -> str:
        """Host, port and, on a hub, the path of this student's server."""
        return self.address.partition("://")[2].partition("/lab")[0]

    @property
    def token(self) -> str:
        """What opens it."""
        return self.address.partition("token=")[2]

    def request(self, method: str, place: str, content: Any = None) -> Any:
        """Ask Jupyter's REST API, and return its answer.

        Raises:
            urllib.error.HTTPError: if it refuses.
        """
        request = urllib.request.Request(
            f"http://{self.place}/api/{place}",
            method=method,
            data=None if content is None else json.dumps(content).encode(),
            headers={"Authorization": f"token {self.token}", "Content-Type": "application/json"},
        )
        with urllib.request.urlopen(request, timeout=DEADLINE) as answer:
            body = answer.read()
        return json.loads(body) if body else None

    def open(self, notebook: str) -> tuple[Any, Kernel]:
        """Open a notebook: return what the server says of it, and a kernel for it."""
        return self.request("GET", f"contents/{notebook}"), Kernel(self, notebook)


class JupyterTerminal:
    """A terminal of JupyterLab, typed into as in the browser."""

    def __init__(self, student: Student) -> None:
        import websocket

        self.student = student
        self._name = student.request("POST", "terminals")["name"]
        self._socket = websocket.create_connection(
            f"ws://{student.place}/terminals/websocket/{self._name}",
            header=[f"Authorization: token {student.token}"],
            timeout=DEADLINE,
        )

    def run(self, line: str) -> None:
        """Type a line, and wait until it has ended.

        Raises:
            AssertionError: if it does not end.
        """
        self._socket.send(json.dumps(["stdin", f"{line}; echo the 'end'\r"]))
        shown = ""
        deadline = time.monotonic() + DEADLINE
        while "the end" not in shown:
            self._socket.settimeout(max(0.01, deadline - time.monotonic()))
            try:
                kind, *content = json.loads(self._socket.recv())
            except TimeoutError as error:
                raise AssertionError(f"`{line}` did not end within {DEADLINE} s: {shown}") from error
            shown += content[0] if kind == "stdout" else ""

    def close(self) -> None:
        """Shut the terminal down."""
        self._socket.close()
        self.student.request("DELETE", f"terminals/{self._name}")


@pytest.fixture(scope="session")
def installation(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Install the project in a bare Debian, once for all workers: the folder in which it lies.

    It is a fresh clone with the changes of the working tree, and has the student's packages alone.
    """
    base = tmp_path_factory.getbasetemp()
    base = base.parent if os.environ.get("PYTEST_XDIST_WORKER") else base
    home = base / "student-home"
    with (base / "student-users.lock").open("w") as users:
        with locked(base / "student.lock"):
            fcntl.flock(users, fcntl.LOCK_SH)
            if not (home / "installed").exists():
                install(home)
        yield home / "ros2lab"
        with locked(base / "student.lock"), contextlib.suppress(BlockingIOError):
            fcntl.flock(users, fcntl.LOCK_EX | fcntl.LOCK_NB)  # no other worker needs its 1 GB any more
            subprocess.run(["rm", "-rf", home], check=True)  # far quicker than Python, for so many files


@pytest.fixture
def student(installation: Path, domain_id: int, tmp_path: Path) -> Iterator[Student]:
    """Let a new student, with an empty home, type `make lab`."""
    home, work, log = tmp_path / "home", tmp_path / "work", tmp_path / "lab.log"
    for folder in (home, work):
        folder.mkdir()
        bare_root.hand_over(folder)
    binds = {PROJECT: installation, f"{PROJECT}/work": work}
    command = entering(["make", "lab", f"PORT={free_port()}"], home, binds=binds, folder=PROJECT)
    # Students of one computer have domains of their own; these all have the same name.
    environ = {**environment(), "ROS_DOMAIN_ID": str(domain_id)}
    with log.open("w") as output:
        process = subprocess.Popen(
            command, env=environ, stdout=output, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL
        )
    try:
        student = Student(wait_for_address(log, process), work)
        yield student
        student.request("POST", "shutdown")  # File, Shut Down
        assert process.wait(DEADLINE) == 0, log.read_text()
        assert log.read_text().endswith("The lab is closed.\n"), log.read_text()
    finally:
        process.kill()  # and with it all that is inside
        process.wait()


def install(home: Path) -> None:
    """Clone the project into a home, and install what a student has."""
    shutil.rmtree(home, ignore_errors=True)
    clone(home / "ros2lab")
    bare_root.hand_over(home)
    bootstrap = ["python3", "tools/bootstrap.py", "student", "--this-python"]
    finished = subprocess.run(
        entering(bootstrap, home, folder=PROJECT),
        env=environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert finished.returncode == 0, finished.stdout + finished.stderr
    (home / "installed").touch()


@contextlib.contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold a lock that all workers know."""
    with path.open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def entering(command: list[str], home: Path, **options: Any) -> list[str]:
    """Return the command that runs `command` on the student's Debian."""
    try:
        root = bare_root.bare_root(SUITE)
    except bare_root.RootError as error:
        pytest.fail(str(error), pytrace=False)
    result: list[str] = bare_root.entering(root, command, home, python=python_prefix(), **options)
    return result


def environment(**options: Any) -> dict[str, str]:
    """Return the environment in which the student's Debian is entered."""
    result: dict[str, str] = bare_root.environment(python=python_prefix(), **options)
    return result


def python_prefix() -> Path | None:
    """Return the prefix of the Python to be used instead of Debian's, if one is chosen."""
    return Path(PYTHON) if PYTHON else None


def clone(folder: Path) -> None:
    """Clone the project into a new folder, with what has changed since in the working tree."""
    subprocess.run(["git", "clone", "--quiet", str(ROOT), str(folder)], check=True)
    listing = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(listing, cwd=ROOT, capture_output=True, check=True).stdout.decode()
    for name in filter(None, listed.split("\0")):
        (folder / name).unlink(missing_ok=True)
        if os.path.lexists(ROOT / name):
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name, follow_symlinks=False)


def wait_for_address(log: Path, process: subprocess.Popen[bytes], patience: float = DEADLINE) -> str:
    """Wait until the lab has printed its address, at which it listens by then; `patience` is in s."""
    deadline = time.monotonic() + patience
    while time.monotonic() < deadline and process.poll() is None:
        found = re.search(r"http://127\.0\.0\.1:\d+/lab\S*token=\w+(?=\s)", log.read_text())
        if found:
            return found[0]
        time.sleep(0.05)
    raise AssertionError(f"the lab did not start:\n{log.read_text()}")


def free_port() -> int:
    """Return a port that nobody uses, and that no other test of this machine gets while this process lives.

    Whoever asks the system for any port gets one of a range of its own (Linux, networking/ip-sysctl): these lie below.
    """
    limit = int(Path("/proc/sys/net/ipv4/ip_local_port_range").read_text(encoding="ascii").split()[0])
    for port in range(limit - 1, FIRST_PORT, -1):
        lease = socket.socket(socket.AF_UNIX)
        with contextlib.suppress(OSError), socket.socket() as probe:
            lease.bind(f"\0ros2lab-test-port-{port}")
            probe.bind(("127.0.0.1", port))
            _LEASES.append(lease)
            return port
        lease.close()
    raise RuntimeError("All of the ports for tests are used; end some of them.")
