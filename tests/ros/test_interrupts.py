"""A cell that a student interrupts shows one sentence."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest
from kernels import Kernel

from ros2lab import course

SESSION = "from ros2lab import LabSession\nsession = LabSession()\n"
WORKSPACE = (
    "from ros2lab import Workspace\n"
    "workspace = Workspace('ros2_ws').create()\n"
    "package = workspace.path / 'src' / 'owl'\n"
    "package.mkdir()\n"
    "(package / 'setup.py').write_text('import time; time.sleep(600)')\n"
    "(package / 'package.xml').write_text('<package format=\"3\"><name>owl</name><version>0.0.0</version>'\n"
    "    '<description>d</description><maintainer email=\"a@b.c\">a</maintainer><license>l</license>'\n"
    "    '<export><build_type>ament_python</build_type></export></package>')\n"
)


@pytest.fixture
def kernel(tmp_path: Path) -> Iterator[Kernel]:
    """A kernel with terminals."""
    course.open_work_folder(tmp_path)
    kernel = Kernel(tmp_path, "01_workspaces.ipynb")
    kernel.run("%load_ext ros2lab.terminal")
    yield kernel
    kernel.close()


def children(kernel: Kernel) -> list[str]:
    return [" ".join(child.cmdline()) for child in psutil.Process(kernel.pid).children(recursive=True)]


def test_in_a_terminal_the_program_is_stopped_and_the_terminal_can_be_used(kernel: Kernel) -> None:
    shown, trace = kernel.interrupt("%%terminal\necho u''p; sleep 600\necho never typed", when="\nup\n")
    assert trace == ["Interrupted: what ran in terminal 1 was stopped; the terminal can be used again."]
    assert "$ echo never" not in shown
    assert not [command for command in children(kernel) if "sleep" in command]
    assert kernel.run("%%terminal\necho still $((1 + 1))").endswith("still 2\n")


@pytest.mark.parametrize(
    ("prepare", "code", "sentence"),
    [
        (
            "t = terminal()",
            "t.run(['sleep 600'], in_background=True); print('go'); t.wait_for('x', 600)",
            "Interrupted: the command in terminal 1 goes on.",
        ),
        (
            f"{SESSION}from std_msgs.msg import String; log = session.log('/x', String)",
            "print('go'); log.wait_for(1, 600)",
            "Interrupted: the log of /x goes on.",
        ),
        pytest.param(
            f"{SESSION}from std_msgs.msg import String; log = session.log('/x', String)",
            "print('go'); log.wait_until(lambda _: True, 600)",
            "Interrupted: the log of /x goes on.",
            marks=pytest.mark.thorough,
        ),
        (
            SESSION,
            "print('go'); session.wait_for_subscribers('/x', timeout=600)",
            "Interrupted: the session goes on.",
        ),
        (
            WORKSPACE,
            "print('go'); workspace.build(show=False)",
            "Interrupted: colcon and what it had started were stopped.",
        ),
    ],
    ids=["terminal", "log", "log until", "subscribers", "build"],
)
def test_a_call_of_the_lab_says_what_goes_on(kernel: Kernel, prepare: str, code: str, sentence: str) -> None:
    kernel.run(prepare)
    assert kernel.interrupt(code, when="go") == ("go\n", [sentence])
    assert not [command for command in children(kernel) if "colcon" in command or "setup.py" in command]
