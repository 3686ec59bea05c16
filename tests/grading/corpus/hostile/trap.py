"""What shows that a submission did harm: files that must not change, ears that must hear nothing, names that must not appear."""

from __future__ import annotations

import contextlib
import hashlib
import os
import secrets
import socket
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path

import ros2lab
from ros2lab.domain_lease import leased

SECRET = "corpus-secret-that-no-report-may-show"
VARIABLE = "ROS2LAB_CORPUS_SECRET"
_MULTICAST = "239.255.0.1"


@contextlib.contextmanager
def trap(folder: Path) -> Iterator[Mapping[str, str]]:
    """Set a trap beside a submission, give what it is told of it, and see at the end that nothing went into it.

    Yields:
        `TOKEN` (in the names of all that it makes, and in the command line of all that it starts), `CANARY` (a file
        that it tries to change), `SECRET_FILE`, `PORT` (TCP, on the loopback), `SOCKET` (an abstract Unix socket) and
        `DOMAIN` (of ROS).

    Raises:
        AssertionError: at the end, if harm was done.
    """
    token = f"corpus-{secrets.token_hex(6)}"
    beside = folder.parent / f"{folder.name}-canaries"
    beside.mkdir()
    canary, secret = beside / "report.json", beside / "secret.txt"
    canary.write_text('{"total": 0}\n')
    secret.write_text(SECRET)
    secret.chmod(0o600)
    grader = _grader()
    os.environ[VARIABLE] = SECRET
    try:
        with contextlib.ExitStack() as stack:
            domain = leased(stack.enter_context(socket.socket(socket.AF_UNIX)))
            ears = _ears(stack, token, domain)
            yield {
                "TOKEN": token,
                "CANARY": str(canary),
                "SECRET_FILE": str(secret),
                "PORT": str(ears["tcp"].getsockname()[1]),
                "SOCKET": token,
                "DOMAIN": str(domain),
            }
            heard = [name for name, ear in ears.items() if _has_heard(ear)]
            assert not heard, f"The submission reached the host by {', '.join(heard)}."
    finally:
        del os.environ[VARIABLE]
    assert canary.read_text() == '{"total": 0}\n', "The submission has changed a report."
    assert secret.read_text() == SECRET, "The submission has changed a file beside it."
    assert sorted(beside.iterdir()) == [canary, secret], "The submission has written beside itself."
    assert _grader() == grader, "The submission has changed the grader."
    assert not _left_files(token, folder), f"The submission has left {_left_files(token, folder)}."
    assert not _left_processes(token), f"The submission still runs: {_left_processes(token)}."


def _ears(stack: contextlib.ExitStack, token: str, domain: int) -> dict[str, socket.socket]:
    """Return sockets that listen on the host."""
    ears = {
        "tcp": socket.socket(socket.AF_INET, socket.SOCK_STREAM),
        "unix": socket.socket(socket.AF_UNIX, socket.SOCK_STREAM),
    }
    ears["tcp"].bind(("127.0.0.1", 0))
    ears["unix"].bind(f"\0{token}")
    for port in (7400 + 250 * domain, 7400 + 250 * domain + 10):  # where participants are looked for
        ears[f"udp {port}"] = ear = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        ear.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        ear.bind(("", port))
        with contextlib.suppress(OSError):  # a machine without any network has no multicast
            group = socket.inet_aton(_MULTICAST) + socket.inet_aton("127.0.0.1")
            ear.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group)
    for ear in ears.values():
        stack.enter_context(ear)
        ear.setblocking(False)
    for name in ("tcp", "unix"):
        ears[name].listen(16)
    return ears


def _has_heard(ear: socket.socket) -> bool:
    try:
        if ear.type == socket.SOCK_STREAM:
            ear.accept()[0].close()
        else:
            ear.recv(1)
    except BlockingIOError:
        return False
    return True


def _grader() -> str:
    """Return a digest of the grader's code."""
    digest = hashlib.sha256()
    for path in sorted(Path(ros2lab.__file__).parent.glob("**/*.py")):
        digest.update(str(path).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def _left_files(token: str, folder: Path) -> list[str]:
    """Return what has the token in its name; what was handed in may."""
    places = {
        Path.home(),
        Path.cwd(),
        Path(tempfile.gettempdir()),
        Path("/"),
        Path("/tmp"),
        Path("/var/tmp"),
        Path("/dev/shm"),
    }
    places |= {folder.parent, Path(ros2lab.__file__).parent, Path(ros2lab.__file__).parent / "grading"}
    return sorted(str(path) for place in places for path in place.glob(f"*{token}*"))


def _left_processes(token: str) -> list[str]:
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError):
            command = path.read_bytes().replace(b"\0", b" ").decode(errors="replace")
            if token in command:
                found.append(command.strip()[:200])
    return found
