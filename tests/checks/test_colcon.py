"""What belongs to the lesson on colcon, besides the answers in `answers/colcon.yaml`."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from ros2lab import environment
from ros2lab.checks import CheckError, programs
from ros2lab.checks import colcon as check
from ros2lab.pictures import package_graph

HARBOUR = {
    "crane_app": ("crane_driver", "harbour_map"),
    "crane_driver": ("load_model",),
    "harbour_map": (),
    "load_model": (),
    "ship_pilot": ("harbour_map",),
}


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give the test a student's folder."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path))
    return tmp_path


def create(workspace: Path, name: str, *options: str) -> Path:
    """Make a package as the lesson does; return the folder of its modules."""
    (workspace / "src").mkdir(parents=True, exist_ok=True)
    subprocess.run(
        ["ros2", "pkg", "create", name, "--build-type", "ament_python", *options],
        cwd=workspace / "src",
        env=environment.lab_environment(),
        capture_output=True,
        check=True,
    )
    return workspace / "src" / name / name


def test_an_edit_without_end(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A loop is told as any other fault."""
    monkeypatch.setattr(programs, "RUN_TIMEOUT", 2.0)
    modules = create(home / "workshop_ws", "horn", "--node-name", "blow")
    (modules / "blow.py").write_text("def main():\n    while True:\n        pass\n")
    with pytest.raises(CheckError, match=r"the source of horn ends\. Found: after 2 s it still runs"):
        check.edit_takes_effect()


def test_the_harbour_as_a_picture(home: Path) -> None:
    """Who needs whom, in words and as arrows."""
    for name, needs in HARBOUR.items():
        create(home / "harbour_ws", name, *(["--dependencies", *needs] if needs else []))
    picture = package_graph("~/harbour_ws")
    assert repr(picture).splitlines() == [
        "crane_app needs crane_driver, harbour_map",
        "crane_driver needs load_model",
        "harbour_map needs no other",
        "load_model needs no other",
        "ship_pilot needs harbour_map",
    ]
    assert picture.mermaid.count("-- needs -->") == 4
    with pytest.raises(NotADirectoryError, match="no folder ~/rover_ws/src"):
        package_graph("~/rover_ws")
