"""The checks of `01_workspaces`, besides right and wrong answers: what bash makes of the terminals, and looking only."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest
from answering import StudentsFolder

from ros2lab import environment
from ros2lab.checks import CheckError, workspaces

CREATE = "ros2 pkg create --build-type ament_python --license Apache-2.0 --node-name hello greeter"


def is_known_after(home: Path, lines: str, ask: str = "ros2 pkg list | grep -qx greeter") -> bool:
    """Type lines into a new terminal, and return whether it knows `greeter` then."""
    environ = {**environment.lab_environment(), "HOME": str(home)}
    command = ["bash", "--noprofile", "--norc", "-c", f"{lines}\n{ask}"]
    finished = subprocess.run(
        command, cwd=home, env=environ, stdin=subprocess.DEVNULL, capture_output=True, check=False
    )
    return finished.returncode == 0


@pytest.mark.thorough  # it asks bash about what is written down
def test_the_terminals_are_what_bash_makes_of_them(tmp_path: Path) -> None:
    """The letters that the check calls right are those whose terminal knows the package."""
    home = tmp_path / "my work"
    StudentsFolder(home, tmp_path / "kept").begin(
        [("type", f"mkdir -p ~/ros2_ws/src; cd ~/ros2_ws/src; {CREATE}; cd ..; colcon build")]
    )
    terminals = {
        "a": "cd ~/ros2_ws",
        "b": "source ~/ros2_ws/install/setup.bash; cd /",
        "c": "bash ~/ros2_ws/install/setup.bash",
        "d": "cd ~/ros2_ws; colcon build",
        "e": "source ~/ros2_ws/install/local_setup.bash",
    }
    known = {name for name, lines in terminals.items() if is_known_after(home, lines)}
    if is_known_after(home, terminals["b"], ask="bash -c 'ros2 pkg list | grep -qx greeter'"):
        known.add("f")
    assert known == workspaces.KNOWING


def test_a_check_leaves_the_folder_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It looks, and writes nothing but the progress."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path))
    (tmp_path / "garden_ws" / "src").mkdir(parents=True)
    before = sorted(os.walk(tmp_path))
    with pytest.raises(CheckError):
        workspaces.second_workspace("~/garden_ws")
    assert sorted(os.walk(tmp_path)) == before
