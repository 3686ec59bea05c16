"""A folder for a while does not stay where its owner is killed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

HOLDER = """
import sys
from pathlib import Path
from ros2lab.scratch import scratch_folder
place = Path(sys.argv[1]) if len(sys.argv) > 1 else None
with scratch_folder(place) as folder:
    (folder / "inside").mkdir()
    print(folder, flush=True)
    input()
"""


def holder(environ: dict[str, str], *place: str) -> tuple[subprocess.Popen[str], Path]:
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDER, *place],
        env=environ,
        text=True,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    )
    assert process.stdout is not None
    return process, Path(process.stdout.readline().strip())


@pytest.mark.parametrize("is_in_a_place", [False, True])
def test_the_next_one_removes_what_a_kill_has_left(tmp_path: Path, is_in_a_place: bool) -> None:
    """Of those that nobody holds any more, and nothing else that is called alike."""
    environ, place = {"TMPDIR": str(tmp_path)}, [str(tmp_path)] * is_in_a_place
    killed, left = holder(environ, *place)
    with killed:
        killed.kill()
    assert left.is_dir()
    others = [left.with_name(f"{left.name}.txt"), tmp_path / "mine"]
    others[0].write_text("a file")
    others[1].mkdir()
    (left.with_name(f"{left.name}-link")).symlink_to(others[1])
    (others[1] / "work.py").write_text("mine")
    alive, held = holder(environ, *place)
    with alive:
        assert not left.exists()
        other, beside = holder(environ, *place)
        with other:
            assert held.is_dir()
            other.communicate("\n")
        alive.communicate("\n")
    assert not held.exists()
    assert not beside.exists()
    assert (others[1] / "work.py").read_text() == "mine"
    assert others[0].is_file()


# Whoever makes a folder in /tmp for a while, and is killed while it is in use.
USERS = {
    "a build": """
from ros2lab.workspace import Workspace
workspace = Workspace(folder / "ws")
workspace.path.joinpath("src").mkdir(parents=True)
(workspace.path / "src/package.xml").write_text("<package>")
import ros2lab.workspace as module
module.family_started = lambda *_: die()
workspace.build()
""",
    "a domain that is observed": """
from ros2lab.observed_domain import ObservedDomain
with ObservedDomain():
    die()
""",
    "the hand-in": """
from ros2lab.clean_build import folder_apart
with folder_apart():
    die()
""",
}
KILLED = """
import os, signal, sys
from pathlib import Path
folder = Path(sys.argv[1])
def die():
    os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.parametrize("user", USERS)
def test_what_uses_one_leaves_nothing_after_the_next(user: str, tmp_path: Path) -> None:
    temporary, work = tmp_path / "tmp", tmp_path / "work"
    temporary.mkdir()
    environ = {**os.environ, "TMPDIR": str(temporary), "ROS2LAB_WORK": str(work)}
    command = [sys.executable, "-c", KILLED + USERS[user], str(tmp_path)]
    killed = subprocess.run(command, env=environ, check=False, capture_output=True, text=True)
    assert killed.returncode == -9, killed.stderr
    places = [temporary, work / "hand_in"] if (work / "hand_in").is_dir() else [temporary]
    assert [path for place in places for path in place.iterdir()] != []
    for place in places:
        other, _ = holder(environ, *([] if place == temporary else [str(place)]))
        with other:
            other.communicate("\n")
    assert [path for place in places for path in place.iterdir()] == []
