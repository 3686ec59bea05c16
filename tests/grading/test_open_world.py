"""Without a sandbox a program runs all the same, and ends when it must; nothing more is promised."""

from __future__ import annotations

import sys
import time
from pathlib import Path

import psutil
import pytest

from deadlines import DEADLINE
from ros2lab.grading.sandbox.box import Limits
from ros2lab.grading.sandbox.open_world import OpenWorld
from ros2lab.grading.sandbox.worlds import FILES, HOME


def test_a_program_sees_the_copy_at_the_path_of_a_sandbox(tmp_path: Path) -> None:
    (tmp_path / "hello.py").write_text("import os, sys; print(open(sys.argv[1]).read()[:6], os.environ['X'])")
    with OpenWorld(tmp_path) as world:
        file = f"{FILES}/hello.py"
        box = world.run([sys.executable, file, file], environ={"X": f"{FILES}/x"}, cwd=FILES)
        assert (box.code, box.output.strip(), box.cut) == (0, f"import {FILES}/x", None)
        scratch = world.folder.parent
    assert not scratch.exists()
    assert (tmp_path / "hello.py").is_file()


def test_its_home_is_not_ones_own() -> None:
    with OpenWorld() as world:
        assert world.run(["sh", "-c", "cd; pwd; echo $HOME"]).output.split() == [HOME, HOME]


@pytest.mark.parametrize(("command", "code"), [("exit 3", 3), ("kill -9 $$", 137)])
def test_exit_codes(command: str, code: int) -> None:
    with OpenWorld() as world:
        assert world.run(["sh", "-c", command]).wait(DEADLINE) == code


def test_it_can_be_interrupted_and_killed() -> None:
    with OpenWorld() as world:
        for end, code in (("interrupt", 130), ("kill", 137)):
            box = world.start(["sh", "-c", "echo ready; exec sleep 600"])
            assert box.wait_for("ready", DEADLINE)
            getattr(box, end)()
            assert box.wait(DEADLINE) == code


def test_limits() -> None:
    with OpenWorld() as world:
        box = world.run(["sleep", "600"], limits=Limits(wall_s=0.2))
        assert box.cut == "It ran longer than 0.2 s."
        box = world.run(["yes"], limits=Limits(output_bytes=1000))
        assert box.cut == "It wrote more than 0.001 MB."
        assert len(box.output) == 1000


def is_over(pid: int) -> bool:
    try:
        return bool(psutil.Process(pid).status() == psutil.STATUS_ZOMBIE)
    except psutil.NoSuchProcess:
        return True


def test_what_it_leaves_behind_is_ended() -> None:
    with OpenWorld() as world:
        box = world.run(["sh", "-c", "sleep 600 & echo $!"])
        pid = int(box.output)
        left = world.start(["sleep", "600"])
    assert left.wait(DEADLINE) == 137
    deadline = time.monotonic() + DEADLINE
    while not is_over(pid):
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_what_cannot_be_started() -> None:
    with OpenWorld() as world:
        box = world.run(["/no/such/program"])
        assert box.code
        assert "/no/such/program" in box.output
