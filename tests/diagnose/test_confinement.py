"""What is only looked at changes nothing, starts nothing and reaches nobody, also where it does not ask Python."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path
from unittest import mock

import psutil
import pytest
from right_workspace import right_workspace

from deadlines import DEADLINE
from ros2lab.diagnose import confinement, of_workspace
from ros2lab.diagnose.finding import UNKNOWN
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.file_texts import bytes_of

LAUNCH = "launch/robot.launch.py"
ATTACKS = """
import asyncio, ctypes, os, signal, socket, sys, threading
folder, parent = sys.argv[1], os.getppid()
from ros2lab.diagnose.confinement import confine
libc = ctypes.CDLL(None)
there = os.open(folder, os.O_RDONLY)
confine(memory_bytes=1_000_000_000, cpu_s=60, written_bytes=1000)
path = f"{folder}/there".encode()
attacks = {
    "system": lambda: not libc.system(b"true"),
    "fork": lambda: libc.fork() >= 0,
    "vfork by number": lambda: libc.syscall(58) >= 0,
    "clone by number": lambda: libc.syscall(56, signal.SIGCHLD, 0, 0, 0, 0) >= 0,
    "clone3 by number": lambda: libc.syscall(435, ctypes.create_string_buffer(88), 88) >= 0,
    "fork of 32 bits": lambda: libc.syscall(0x40000000 + 57) >= 0,
    "execve": lambda: libc.execv(b"/bin/true", None) >= 0,
    "write": lambda: libc.open(path, os.O_WRONLY) >= 0,
    "append": lambda: libc.open(path, os.O_RDWR | os.O_APPEND) >= 0,
    "truncate": lambda: libc.open(path, os.O_RDONLY | os.O_TRUNC) >= 0,
    "make": lambda: libc.openat(there, b"new", os.O_CREAT, 0o600) >= 0,
    "openat2": lambda: libc.syscall(437, there, b"there", ctypes.create_string_buffer(b"\\2" + bytes(23)), 24) >= 0,
    "unlink": lambda: not libc.unlink(path),
    "rename": lambda: not libc.rename(path, path + b"2"),
    "chmod": lambda: not libc.chmod(path, 0),
    "mkdir": lambda: not libc.mkdir(path + b"3", 0o700),
    "kill": lambda: not libc.kill(parent, 0),
    "own a descriptor for a signal": lambda: not libc.fcntl(there, 8, parent),
    "socket": lambda: libc.socket(socket.AF_INET, socket.SOCK_STREAM, 0) >= 0,
    "ptrace": lambda: not libc.ptrace(16, parent, 0, 0),
    "another's limit": lambda: not libc.prlimit(parent, 7, ctypes.create_string_buffer(16), None),
    "to outlive": lambda: not libc.prctl(1, 0, 0, 0, 0),
    "memory": lambda: len(bytearray(2_000_000_000)) > 0,
}
for name, attack in attacks.items():
    try:
        if attack():
            print(name)
    except (OSError, MemoryError):
        pass
thread = threading.Thread(target=lambda: print(os.listdir(folder), open(path).read()))
thread.start()
thread.join()
asyncio.run(asyncio.sleep(0))
"""


def test_a_confined_process_reads_and_does_nothing_else(tmp_path: Path) -> None:
    (tmp_path / "there").write_text("text")
    command = [sys.executable, "-c", ATTACKS, str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=DEADLINE, check=True)
    assert done.stdout == "['there'] text\n"
    assert [path.name for path in tmp_path.iterdir()] == ["there"]


def test_a_confined_process_ends_with_its_parent(tmp_path: Path) -> None:
    waiting = f"import time; from {confinement.__name__} import confine; confine(memory_bytes=10**9, cpu_s=9, written_bytes=99); print(); time.sleep(600)"
    starting = "import subprocess, sys; child = subprocess.Popen([sys.executable, '-c', sys.argv[1]], stdout=subprocess.PIPE); child.stdout.readline(); print(child.pid)"
    done = subprocess.run(
        [sys.executable, "-c", starting, waiting], stdout=subprocess.PIPE, timeout=DEADLINE, check=True
    )
    deadline = time.monotonic() + DEADLINE
    while psutil.pid_exists(int(done.stdout)):
        assert time.monotonic() < deadline
        time.sleep(0.01)


@pytest.mark.parametrize(
    "code",
    [
        "import ctypes\nctypes.CDLL(None).system(b'touch OWNED')\nctypes.CDLL(None).creat(b'OWNED', 0o600)\n",
        """import os\nos.write(1, b'{"' + os.fsencode(__file__) + b'": {"nodes": 5}}')\nos._exit(0)\n""",
        "import os\nos.write(1, b'[' * 9000)\nos._exit(0)\n",
        "import os\nwhile True:\n    os.write(1, b'x' * 1_000_000)\n",
        "import os\nos.execv('/bin/sh', ['sh', '-c', 'touch OWNED'])\n",
    ],
    ids=["libc", "forged", "deep", "endless", "another program"],
)
def test_a_launch_file_does_nothing_while_it_is_looked_at(code: str, tmp_path: Path) -> None:
    """Of what it does instead, nothing is believed; it is only read then."""
    owned = tmp_path / "OWNED"
    code = code.replace("OWNED", str(owned))
    root = right_workspace().change(LAUNCH, "from launch import", f"{code}from launch import").write(tmp_path)
    assert Look(root, loads=True).findings == []
    assert not owned.exists()


def test_code_that_nobody_can_follow_is_said_to_be_so(tmp_path: Path) -> None:
    classes = "".join(f"class C{n}(C{n + 1}, Node):\n    pass\n" for n in range(1500))
    root = right_workspace().change("node", "\ndef main", f"\n{classes}\ndef main").write(tmp_path)
    *others, said = of_workspace(root)
    assert said.code == UNKNOWN
    assert "too entangled" in said.cause
    # What can be told of it without following it is told: there is no C1500.
    assert [one.code for one in others] == ["name-undefined"]


def test_a_name_that_no_file_can_have_is_said_to_be_so(tmp_path: Path) -> None:
    root = (
        right_workspace()
        .change("node", "import rclpy\n", f"import rclpy\nimport {'long' * 80}\n")
        .write(tmp_path)
    )
    findings = of_workspace(root)
    assert [one.code for one in findings] == [UNKNOWN]
    assert "longer than that of any file" in findings[0].cause


@pytest.mark.parametrize("name", ["unittest.__main__", "this", "idlelib.idle", "test.autotest", "rclpy"])
def test_only_python_s_own_modules_are_imported_and_none_that_is_a_program(name: str) -> None:
    """An error's text, or a workspace, may name any; `unittest.__main__` would run the tests that lie there."""
    assert interfaces.own_module(name) is None


def test_a_module_of_python_s_own_is_found() -> None:
    assert interfaces.own_module("unittest.mock") is mock


@pytest.mark.parametrize(
    "name", ["setup.py", "package.xml", "setup.cfg", LAUNCH, "config/odd.yaml", "robot_controller/odd.py"]
)
def test_what_may_be_read_without_end_is_told_and_not_read(tmp_path: Path, name: str) -> None:
    """It is a file like any other to who asks the system, and empty, and reading it waits for the kernel."""
    root = right_workspace().write(tmp_path)
    file = next(root.rglob("package.xml")).parent / name
    file.parent.mkdir(exist_ok=True)
    file.unlink(missing_ok=True)
    file.symlink_to("/proc/kmsg")
    began = time.monotonic()
    first = of_workspace(root)[0]
    assert time.monotonic() - began < DEADLINE
    assert (first.code, first.place) == (UNKNOWN, str(file.relative_to(root)))
    assert "is a link to /proc/kmsg" in first.cause


def test_no_more_is_read_of_a_file_than_it_is_said_to_hold(tmp_path: Path) -> None:
    """What the kernel makes up holds nothing, as it says."""
    (tmp_path / "plain").write_text("x" * 100_000)
    (tmp_path / "own").symlink_to(tmp_path / "plain")
    assert (bytes_of(Path("/proc/self/status")), len(bytes_of(tmp_path / "own"))) == (b"", 100_000)
    assert bytes_of(Path("/dev/zero")) == bytes_of(tmp_path) == bytes_of(tmp_path / "none") == b""
