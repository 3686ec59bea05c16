"""Notebooks and terminals of one student, in one domain: who is met, and how it is stopped."""

from __future__ import annotations

import contextlib
import os
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil
import pytest
from kernels import Kernel

from deadlines import DEADLINE
from ros2lab import course, domain_lease, environment, neighbours

NODE = (
    "from rclpy.node import Node\nfrom ros2lab import LabSession\n"
    "class Talker(Node):\n    def __init__(self):\n        super().__init__('talker')\n"
)
OPEN = "from ros2lab import LabSession; session = LabSession()"
PROGRAM = (
    "import os, signal, rclpy\n"
    "rclpy.init(); node = rclpy.create_node('loose'); print('up', flush=True)\n"
    "try:\n    rclpy.spin(node)\nexcept BaseException as error:\n    print(type(error).__name__, flush=True)\n"
)


OpenKernel = Callable[..., Kernel]


@pytest.fixture
def work(tmp_path: Path) -> Path:
    """Return a student's folder."""
    course.open_work_folder(tmp_path / "work")
    return tmp_path / "work"


@pytest.fixture
def kernel(work: Path) -> Iterator[OpenKernel]:
    """Return a function that opens a notebook."""
    with contextlib.ExitStack() as opened:

        def open_kernel(notebook: str, folder: Path = work) -> Kernel:
            new = Kernel(folder, notebook)
            opened.callback(new.close)
            return new

        yield open_kernel


@pytest.fixture
def program(work: Path) -> Iterator[Callable[..., subprocess.Popen[str]]]:
    """Return a function that starts a program with a node in a terminal of some folder."""
    started: list[subprocess.Popen[str]] = []

    def start(folder: Path = work, **variables: str) -> subprocess.Popen[str]:
        (folder / "loose.py").write_text(PROGRAM)
        new = subprocess.Popen(
            [sys.executable, "loose.py"],
            cwd=folder,
            env={**environment.lab_environment(), **variables},
            stdout=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        started.append(new)
        assert new.stdout is not None
        assert new.stdout.readline() == "up\n"
        return new

    yield start
    for process in started:
        process.kill()
        process.communicate()


def test_an_open_session_of_another_notebook_is_named_and_stopped(kernel: OpenKernel) -> None:
    """Its kernel lives on, and its notebook is told what to do."""
    first, second = kernel("04_first_node.ipynb"), kernel("08_drive.ipynb")
    assert first.run(f"{NODE}session = LabSession()\nnode = session.run(Talker)") == ""
    assert second.run(OPEN) == (
        "04_first_node still runs `talker`: stop it there, or here with `session.stop_others()`.\n"
    )
    assert second.run("session.stop_others()") == "Stopped `talker` of 04_first_node.\n"
    assert second.run(OPEN) == "", "nobody is met"
    assert first.run("print(session)") == "LabSession(closed)\n"
    assert "make a new one with LabSession()" in first.run("session.run(Talker)")
    assert "08_drive still runs a session without nodes: " in first.run(OPEN)


@pytest.mark.thorough
def test_another_kernel_of_the_same_notebook_is_told_apart(kernel: OpenKernel) -> None:
    first, second = kernel("08_drive.ipynb"), kernel("08_drive.ipynb")
    first.run(OPEN)
    assert second.run(OPEN).startswith("Another kernel of this notebook still runs a session without nodes: ")


def test_sessions_in_containers_of_one_network_do_not_meet() -> None:
    """Their processes may have the same number."""
    code = (
        "import os, sys\nfrom ros2lab.neighbours import Listener, ask_session\n"
        "listener = Listener(lambda: [sys.argv[1]], lambda: None)\n"
        "print(os.getpid(), *ask_session(os.getpid(), 'nodes', 5.0), flush=True)\nsys.stdin.read()\nlistener.close()"
    )
    box = ["bwrap", "--dev-bind", "/", "/", "--unshare-pid", "--proc", "/proc", "--die-with-parent"]
    with contextlib.ExitStack() as stack:
        containers = [
            stack.enter_context(
                subprocess.Popen(
                    [*box, sys.executable, "-c", code, name],
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    text=True,
                )
            )
            for name in ("one", "other")
        ]
        said = [container.stdout.readline().split() for container in containers if container.stdout]
        for container in containers:
            container.communicate(timeout=DEADLINE)
    assert said[0][0] == said[1][0], "they have the same number"
    assert [name for _, name in said] == ["one", "other"]


def test_programs_in_terminals_are_named_and_get_ctrl_c(
    kernel: OpenKernel, program: Callable[..., subprocess.Popen[str]], work: Path
) -> None:
    """Of another notebook, and of a terminal that has nothing to do with Jupyter."""
    first, second = kernel("04_first_node.ipynb"), kernel("08_drive.ipynb")
    loose = program()
    background = (
        "%load_ext ros2lab.terminal\n"
        "get_ipython().run_cell_magic('terminal', 'one --background', 'python loose.py')\n"
        "terminal('one').wait_for('up')"
    )
    said = first.run(background)
    assert "A terminal still runs `loose.py`: stop it there.\n" in said
    met = second.run(OPEN).splitlines()
    assert met == [
        f"{place} still runs `loose.py`: stop it there, or here with `session.stop_others()`."
        for place in ("04_first_node", "A terminal")
    ]
    second.run("session.stop_others()")
    assert loose.communicate(timeout=DEADLINE)[0] == "KeyboardInterrupt\n"
    assert second.run(OPEN) == ""
    assert "KeyboardInterrupt" in first.run("print(terminal('one').read())")
    assert first.run("%%terminal one\necho still $((1 + 1))").endswith("still 2\n"), "its shell lives on"


@pytest.mark.thorough
def test_a_kernel_with_nodes_but_no_session_is_left_alone(kernel: OpenKernel) -> None:
    first, second = kernel("00_welcome.ipynb"), kernel("08_drive.ipynb")
    first.run("import rclpy; rclpy.init(); node = rclpy.create_node('mine')")
    assert second.run(OPEN) == "00_welcome still runs nodes of its own: restart its kernel.\n"
    second.run("session.stop_others()")
    assert first.run("print(node.get_name())") == "mine\n"


def test_a_session_opens_though_somebody_has_taken_the_name_of_its_socket() -> None:
    """Another user of the machine can do so for each process number."""
    with socket.socket(socket.AF_UNIX) as taken:
        taken.bind(neighbours._address(os.getpid()))
        taken.listen()
        neighbours.Listener(lambda: ["talker"], lambda: None).close()
    listener = neighbours.Listener(lambda: ["talker"], lambda: None)
    try:
        assert neighbours.ask_session(os.getpid(), "nodes", DEADLINE) == ["talker"]
    finally:
        listener.close()


def test_what_is_not_this_students_is_neither_met_nor_stopped(
    kernel: OpenKernel, program: Callable[..., subprocess.Popen[str]], tmp_path: Path, work: Path
) -> None:
    """Another student's folder, another domain, and what the notebook has started itself."""
    other = tmp_path / "work of somebody else"
    course.open_work_folder(other)
    with socket.socket(socket.AF_UNIX) as lease:
        domain = str(domain_lease.leased(lease))
        strangers = [program(other), program(other, ROS2LAB_WORK=str(other)), program(ROS_DOMAIN_ID=domain)]
    first, second = kernel("08_drive.ipynb", other), kernel("08_drive.ipynb")
    first.run(OPEN)
    own = (
        "import subprocess\n"
        "own = subprocess.Popen(['python', 'loose.py'], stdout=subprocess.PIPE)\n"
        "print(own.stdout.readline())\n"
    )
    assert second.run(own).startswith("b'up")
    assert second.run(OPEN) == ""
    assert second.run("session.stop_others()") == ""
    assert all(process.poll() is None for process in strangers)
    assert second.run("print(own.poll()); own.kill(); own.communicate()").startswith("None")
    assert first.run("print(session.is_closed)") == "False\n"
    assert psutil.pid_exists(first.pid)
