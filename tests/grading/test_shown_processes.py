"""What a program sees of the others of its run in its list of processes."""

from __future__ import annotations

import sys
from collections.abc import Iterator

import pytest

from deadlines import DEADLINE
from ros2lab.grading.sandbox.neighbours import Neighbours
from ros2lab.grading.sandbox.worlds import World

# Prints the commands of all processes, again when there are others, until it sees one of some name; then what else it has.
_LOOK = """
import os, pathlib, sys, time
def commands():
    for number in filter(str.isdigit, os.listdir("/proc")):
        try:
            yield pathlib.Path("/proc", number, "cmdline").read_text().replace("\\0", " ").strip()
        except OSError:
            pass
seen = sorted(commands())
print(*seen, sep=os.linesep, flush=True)
while not any(one.startswith("/submission/lib/drive") for one in commands()):
    time.sleep(0.01)
try:
    os.wait()
except ChildProcessError:
    print("childless, and is told", repr(sys.stdin.read()), *commands(), flush=True)
time.sleep(600)
"""
BEFORE = [sys.executable, "/submission/lib/status_publisher"]
AFTER = ["/submission/lib/drive", "--fast"]


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    with World() as made:
        yield made


def test_it_sees_who_was_started_before_and_then_all(world: World) -> None:
    """By their commands. It has no children by that, nothing to read, stands and ends as it does alone."""
    box = world.start([sys.executable, "-c", _LOOK], neighbours=Neighbours([BEFORE], [AFTER]))
    assert box.wait_for(" ".join(BEFORE), DEADLINE)
    assert f"\n{AFTER[0]} " not in box.output
    box.show_neighbours()
    assert box.wait_for("childless, and is told ''", DEADLINE)
    assert box.wait_for(AFTER[0], DEADLINE)
    assert box.hold(DEADLINE)
    box.release()
    box.interrupt()
    assert box.wait(DEADLINE) == 130


def test_alone_it_sees_nobody_and_itself_once(world: World) -> None:
    """The first process of a box names no program; else one that looks for another one of its own name finds it."""
    box = world.run([sys.executable, "-c", _LOOK.partition("while")[0], "lonely"])
    assert "\ninit\n" in box.output
    assert box.output.count("lonely") == 1


def test_what_cannot_be_started_says_so_as_it_does_alone(world: World) -> None:
    box = world.start(["/nowhere/program"], neighbours=Neighbours([BEFORE], [AFTER]))
    assert box.wait(DEADLINE) == 127
    assert "/nowhere/program" in box.output
    assert "Traceback" not in box.output
