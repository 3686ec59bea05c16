"""What `10_hand_in` uses beside its checks: evidence, practices, the archive, and what the grader says.

Right and wrong answers to its exercises are in `answers/hand_in.yaml`.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from ros2lab import assessment, course, environment, hand_in, observed_domain
from ros2lab.checks import CheckError
from ros2lab.checks import hand_in as check
from ros2lab.clean_build import built_from_nothing
from ros2lab.hand_in import Evidence, Published
from ros2lab.workspace import Workspace


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Workspace:
    """A student's workspace, with the reference package but for its tests, not built."""
    home = tmp_path / "my work"
    monkeypatch.setenv("ROS2LAB_WORK", str(home))
    return Workspace(course.copy_reference(home, has_tests=False))


def nothing_seen(workspace: Workspace) -> Evidence:
    return Evidence(workspace.path / hand_in.EVIDENCE_FILE, {})


def package_with(workspace: Workspace, text: str) -> Path:
    """Leave one module in the package; return the folder of its modules."""
    inner = workspace.path / "src" / "robot_controller" / "robot_controller"
    shutil.rmtree(inner)
    inner.mkdir()
    (inner / "driver.py").write_text(text)
    return inner


def test_evidence_is_what_was_seen(workspace: Workspace, capsys: pytest.CaptureFixture[str]) -> None:
    """The package really runs; what is written has its headings and sources, and an earlier file is kept."""
    (workspace.path / "EVIDENCE.md").write_text("my own notes")
    found = hand_in.collect_evidence(workspace)
    assert "Built from the 19 files in ~/robot_project_ws/src" in capsys.readouterr().out
    assert set(found.programs.values()) == {"runs"}
    assert len(found.nodes) == 3
    assert set(hand_in.TOPICS) <= set(found.topics)
    velocity = found.published["/cmd_vel"]
    assert (velocity.count or 0) > 10
    assert check.evidence(found, velocity.rate).startswith("Right")
    assert not (workspace.path / "install").exists()
    assert not [*(course.work_folder() / "hand_in").iterdir()], "the folder apart is removed"
    text = found.file.read_text()
    headings = [line for line in text.splitlines() if line.startswith("#")]
    assert headings == [
        "# Evidence",
        "## Executables",
        "## Nodes",
        "## Topics published",
        "## Topics subscribed to",
        "## Log",
        "## Sources",
    ]
    assert "Received 'reset'" in text
    assert "| src/robot_controller/setup.py |" in text
    assert [path.read_text() for path in course.earlier_folder().iterdir()] == ["my own notes"]
    assert hand_in.evidence_fault(workspace.path) == ""


@pytest.mark.thorough
def test_a_build_from_nothing_finds_no_workspace_that_was_sourced(
    workspace: Workspace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Neither where it is built nor where it runs; afterwards the terminal is as it was."""
    old = tmp_path / "old_ws" / "install"
    (old / "lost").mkdir(parents=True)
    (old / ".colcon_install_layout").write_text("isolated\n")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(old / "lost"))
    monkeypatch.setenv("PYTHONPATH", str(old / "lost" / "lib"))
    with built_from_nothing(workspace.path) as clean:
        assert clean.result.is_ok
        assert "old_ws" not in " ".join(clean.workspace.overlay.values())
    assert "old_ws" in " ".join(environment.lab_environment().values())


@pytest.mark.thorough  # it collects evidence once more
def test_a_type_that_cannot_be_imported_is_listed(
    workspace: Workspace, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A message of the student's own, which the notebook has not sourced."""

    def find(name: str) -> type:
        if name == "geometry_msgs/msg/Twist":
            raise ValueError(f"The message type {name!r} cannot be imported.")
        return find_type(name)

    find_type = observed_domain.find_type
    monkeypatch.setattr(observed_domain, "find_type", find)
    found = hand_in.collect_evidence(workspace, seconds=1.0)
    assert found.published["/cmd_vel"] == Published("geometry_msgs/msg/Twist", None, None, "nothing")
    assert found.published["/robot/status"].count
    assert "| /cmd_vel | geometry_msgs/msg/Twist | - | - | nothing |" in found.file.read_text()
    with pytest.raises(CheckError, match="messages on /cmd_vel"):
        check.evidence(found, 0)


@pytest.mark.thorough
def test_the_lesson_says_what_the_command_says(workspace: Workspace) -> None:
    """`assess()` and `ros2lab grade --self` give each part the same points, and tell the same of what is lost."""
    package_with(workspace, "import rclpy\n\nprint('It drives.')\n")
    # Whether a launch file has started what ends at once is chance.
    shutil.rmtree(workspace.path / "src" / "robot_controller" / "launch")
    command = [str(Path(sys.executable).with_name("ros2lab")), "grade", "--self", "--json", "-"]
    done = subprocess.run(command, cwd=workspace.path, capture_output=True, text=True, check=True)
    said = json.loads(done.stdout)
    assessed = assessment.assess(workspace, nothing_seen(workspace))
    assert assessed.why_not_run == ""
    assert {part: assessed.points(part) for part in assessment.POINTS} == {
        part: given["points"] for part, given in said["components"].items()
    }
    assert [one.reason for part in assessment.POINTS for one in assessed.lost(part)] == [
        one["reason"] for one in said["criteria"] if one["points"] < one["max"]
    ]


def test_without_a_sandbox_nothing_is_guessed(
    workspace: Workspace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """What rests on running nodes is marked, and what rests on files is as the grader has it."""
    monkeypatch.setenv("PATH", str(tmp_path))
    assessed = assessment.assess(workspace, nothing_seen(workspace))
    assert "because there is no sandbox: bubblewrap is not installed" in capsys.readouterr().out
    given = {row[0]: row[3] for row in assessed.table({}).rows}
    assert given["workspace"] == "15"
    assert {given[part] for part in ("status_publisher", "velocity_publisher", "bonus")} == {"not run"}


def test_practices_are_counted(workspace: Workspace) -> None:
    """Of each practice how often it holds, and where it first does not."""
    inner = package_with(
        workspace,
        "class badName:\n    def Tell(self, x):\n        try:\n            print(x)\n        except:\n"
        "            self.log.info(x)\n\n\ndef right(x: int) -> None:\n    '''Do it.'''\n"
        f"    pass  # {'x' * 88}\n",
    )
    (inner / "torn.py").write_text("def torn(:\n")
    manifest = inner.parent / "package.xml"
    manifest.write_text(manifest.read_text().replace("Apache-2.0", "TODO: License declaration"))
    rows = {name: (count, place) for name, count, place in hand_in.practices(workspace).rows}
    assert rows == {
        "names as in PEP 8": ("1 of 3", "driver.py:1"),
        "docstrings of modules and classes": ("0 of 2", "driver.py:1"),
        "type hints": ("1 of 2", "driver.py:2"),
        "logger and not print": ("1 of 2", "driver.py:4"),
        "exceptions caught by name": ("0 of 1", "driver.py:5"),
        "lines up to 99 characters": ("10 of 11", "driver.py:11"),
        "can be read as Python": ("0 of 1", "torn.py:1"),
        "a license, a description and a maintainer": ("2 of 3", "package.xml: <license>"),
    }


def test_an_archive_holds_what_was_written(workspace: Workspace, tmp_path: Path) -> None:
    """Each has the next number; linked sources are in it, and nothing that was made by a tool."""
    moved = tmp_path / "elsewhere"
    package = workspace.path / "src" / "robot_controller"
    package.rename(moved)
    package.symlink_to(moved)
    for made in ("robot_controller/__pycache__/old.pyc", "install/COLCON_IGNORE", ".git/HEAD"):
        (package / made).parent.mkdir(exist_ok=True)
        (package / made).touch()
    first, second = hand_in.pack(workspace, "Ada Lovelace"), hand_in.pack(workspace, "Ada Lovelace")
    assert (first.name, second.name) == (
        "Ada_Lovelace_robot_project_ws_1.zip",
        "Ada_Lovelace_robot_project_ws_2.zip",
    )
    names = zipfile.ZipFile(first).namelist()
    assert "robot_project_ws/src/robot_controller/package.xml" in names
    assert not [name for name in names if "pycache" in name or "/install/" in name or "/.git/" in name]
