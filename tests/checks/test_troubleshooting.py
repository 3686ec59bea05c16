"""The robots of `09_troubleshooting`: each has the faults of its exercise and no other.

Right and wrong answers to its exercises are in `answers/troubleshooting.yaml`.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from ros2lab import course
from ros2lab.checks import troubleshooting
from ros2lab.diagnose import of_workspace


@pytest.fixture
def src(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The ward as the lesson makes it."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path / "my work"))
    troubleshooting.make_patients()
    return course.student_path(f"{troubleshooting.WARD}/src")


def test_a_robot_that_is_there_already_is_left_alone(src: Path) -> None:
    """Running the cell again loses nothing of what was fixed."""
    (src / "owl" / "setup.py").write_text("# fixed\n")
    assert "owl" in troubleshooting.make_patients()
    assert (src / "owl" / "setup.py").read_text() == "# fixed\n"


def test_the_robots_of_the_clinic_are_alike_but_for_their_names(src: Path) -> None:
    """Each copy is a package that bears its own name everywhere."""
    assert troubleshooting.make_healthy_robot() == "~/clinic_ws/src: patrol"
    assert troubleshooting.admit("robin", "wren") == "~/clinic_ws/src: robin, wren"
    clinic = course.student_path(troubleshooting.CLINIC) / "src"
    for file in (clinic / "robin").rglob("*"):
        assert "patrol" not in file.name
        assert file.is_dir() or "patrol" not in file.read_text()
    assert len([*(clinic / "robin").rglob("*")]) == len([*(clinic / "patrol").rglob("*")])


@pytest.mark.parametrize("name", troubleshooting.PATIENTS)
def test_diagnose_finds_what_is_wrong_and_nothing_else(src: Path, name: str) -> None:
    """`ros2lab diagnose`, which the lesson recommends, knows every patient; the magpie is the healthy one."""
    findings = of_workspace(src / name)
    assert bool(findings) == (name != "magpie"), findings


def test_the_healthy_robot_is_healthy(src: Path) -> None:
    """Otherwise each of its copies would have one fault more than the lesson says."""
    troubleshooting.make_healthy_robot()
    assert of_workspace(course.student_path(troubleshooting.CLINIC)) == []
