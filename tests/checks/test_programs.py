"""A student's program is run to its end: what it says is read, and nothing of it stays behind."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import psutil
import pytest

from ros2lab.checks import CheckError, programs
from ros2lab.node_process import last_line

# Leaves a child that notes its number, and holds standard output open.
PARENT = """
import pathlib, subprocess, sys, time
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
pathlib.Path(sys.argv[1]).write_text(str(child.pid))
print("Ready.")
"""
REPORT = """<testsuites><testsuite>
<testcase classname="battery.test.test_charge" name="test_full"/>
<testcase classname="battery.test.test_charge" name="test_half"><failure/></testcase>
<testcase classname="battery.test.test_charge" name="test_empty"><error/></testcase>
<testcase classname="battery.test.test_later" name="test_later"><skipped/></testcase>
<testcase classname="battery.test.test_flake8" name="test_flake8"><failure/></testcase>
</testsuite></testsuites>"""


def until(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 30
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def expect_gone(file: Path) -> None:
    """The process of this number ends, if it has not."""
    number = int(file.read_text())
    until(lambda: not psutil.pid_exists(number) or psutil.Process(number).status() == psutil.STATUS_ZOMBIE)


def test_what_a_program_says_is_read_and_its_child_ends(tmp_path: Path) -> None:
    """It has ended itself, so nobody waits for the child that it has left."""
    started = time.monotonic()
    done = programs.run([sys.executable, "-c", PARENT, tmp_path / "child"], "it", folder=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "Ready.\n", "")
    assert time.monotonic() - started < programs.RUN_TIMEOUT
    expect_gone(tmp_path / "child")


def test_a_program_without_end_is_told_and_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(programs, "RUN_TIMEOUT", 3.0)
    with pytest.raises(CheckError, match=r"`ros2 run` ends\. Found: after 3 s it still runs"):
        programs.run([sys.executable, "-c", PARENT + "time.sleep(60)", tmp_path / "child"], "`ros2 run`")
    expect_gone(tmp_path / "child")


def test_ctrl_c_ends_the_program_too(tmp_path: Path) -> None:
    def interrupt() -> None:
        until(lambda: (tmp_path / "child").is_file() and (tmp_path / "child").read_text() != "")
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        programs.run([sys.executable, "-c", PARENT + "time.sleep(60)", tmp_path / "child"], "it")
    thread.join()
    expect_gone(tmp_path / "child")


def test_a_loop_that_prints_does_not_fill_the_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(programs, "LARGEST_OUTPUT", 100_000)
    done = programs.run([sys.executable, "-c", "while True: print('again')"], "it")
    assert done.returncode != 0
    assert len(done.stdout) <= 100_000
    assert "File too large" in last_line(done.stderr)


def test_what_cannot_be_started_is_told(tmp_path: Path) -> None:
    with pytest.raises(CheckError, match=r"the horn can be started\. Found: No such file"):
        programs.run([tmp_path / "horn"], "the horn")


@pytest.mark.parametrize(
    ("output", "line"),
    [
        ("one\n  two  \n\n", "two"),
        ("ValueError: x\n[ros2run]: Process exited with failure 1\n", "ValueError: x"),
        ("[INFO] [launch]: Default logging verbosity is set to INFO\n", ""),
        ("", ""),
    ],
)
def test_the_last_line_of_its_own(output: str, line: str) -> None:
    assert last_line(output) == line


def test_tests_are_counted(tmp_path: Path) -> None:
    report = tmp_path / "pytest.xml"
    assert programs.count_tests(report) is None
    report.write_text(REPORT)
    assert programs.count_tests(report) == {"passed": 1, "failed": 3, "skipped": 1}
    assert programs.count_tests(report, except_of=["test_flake8"]) == {"passed": 1, "failed": 2, "skipped": 1}
    report.write_text(REPORT[:100])
    assert programs.count_tests(report) is None
