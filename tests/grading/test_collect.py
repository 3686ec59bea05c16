"""What is collected of a submission, told in the words and places of what was handed in."""

from __future__ import annotations

from pathlib import Path

import pytest

from ros2lab.grading.collect import _as_written
from ros2lab.grading.submission import FoundPackage, Submission

PACKAGE = FoundPackage("ws/src/robot_controller", "robot_controller", "ament_python", None)
SUBMISSION = Submission("workspace", "ws", (PACKAGE,), PACKAGE, (), ())
INSTALLED = "/submission/graded_ws/install/robot_controller/lib/python3.12/site-packages"


@pytest.mark.parametrize(
    ("file", "below"),
    [
        ("robot_controller/status.py", ""),
        ("robot_controller/status.py", "src"),
        ("robot_controller/nodes/my status.py", ""),
    ],
)
def test_an_installed_file_is_told_as_it_was_handed_in(tmp_path: Path, file: str, below: str) -> None:
    written = tmp_path / PACKAGE.folder / below / file
    written.parent.mkdir(parents=True)
    written.touch()
    said = 'Traceback (most recent call last):\n  File "{}", line 3, in tell\nNameError: name'
    assert _as_written(said.format(f"{INSTALLED}/{file}"), tmp_path, SUBMISSION) == said.format(written)


@pytest.mark.parametrize("file", ["robot_controller/other.py", "../../../../../../../etc/passwd"])
def test_what_was_not_handed_in_stays_where_it_is(tmp_path: Path, file: str) -> None:
    said = f'  File "{INSTALLED}/{file}", line 3, in tell'
    assert _as_written(said, tmp_path, SUBMISSION) == said
