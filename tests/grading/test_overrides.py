"""What an instructor decides, as a file: read as it stands, and refused with its line where it is wrong."""

from __future__ import annotations

from pathlib import Path

import pytest
from evidences import FAULTS, right

from ros2lab.grading.overrides import Decision, OverridesError, read
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

RIGHT = """# Ada's submission, after she came to my office
status_publisher.period:
  points: 5
  comment: The robot's clock was wrong.
  by: Grace
documentation.readme: {points: 0, comment: "Copied, see mail.", by: Grace}
"""


def file(folder: Path, text: str) -> Path:
    path = folder / "overrides.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_decisions_are_read(tmp_path: Path) -> None:
    assert read(file(tmp_path, RIGHT), load()) == {
        "status_publisher.period": Decision(5, "The robot's clock was wrong.", "Grace"),
        "documentation.readme": Decision(0, "Copied, see mail.", "Grace"),
    }


def test_decisions_count(tmp_path: Path) -> None:
    rubric = load()
    e = FAULTS["status: never"][1](right())
    grade = verdict(e, rubric, read(file(tmp_path, RIGHT), rubric))
    assert grade.total == verdict(e, rubric).total + 5 - 2


@pytest.mark.parametrize("text", ["", "# none\n"])
def test_an_empty_file_decides_nothing(tmp_path: Path, text: str) -> None:
    assert read(file(tmp_path, text), load()) == {}


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("status_publisher.period", "status.period", 2, "there is no criterion 'status.period'"),
        ("documentation.readme", "status_publisher.period", 6, "is there twice"),
        ("points: 5", "points: 7.5", 3, "a number from 0 to 7 is wanted here"),
        ("points: 5", "points: -1", 3, "a number from 0 to 7 is wanted here"),
        ("points: 5", "points: .nan", 3, "a number from 0 to 7 is wanted here"),
        ("points: 5", "points: five", 3, "a number from 0 to 7 is wanted here"),
        ("  points: 5\n", "", 3, "points is missing"),
        ("  comment: The robot's clock was wrong.\n", "", 3, "comment is missing"),
        ("comment: The robot's clock was wrong.", "comment:", 4, "a text is wanted here"),
        ("  by: Grace\n", "", 3, "by is missing"),
        ("by: Grace", "who: Grace", 5, "'who' is not one of points, comment, by"),
        (RIGHT, "- status_publisher.period\n", 1, "names with values are wanted here"),
        (RIGHT, "status_publisher.period: 5\n", 1, "names with values are wanted here"),
        (RIGHT, "status_publisher.period: [\n", 0, "this is not YAML"),
    ],
)
def test_a_wrong_decision_says_where(tmp_path: Path, old: str, new: str, line: int, words: str) -> None:
    assert old in RIGHT
    path = file(tmp_path, RIGHT.replace(old, new, 1))
    with pytest.raises(OverridesError) as caught:
        read(path, load())
    assert words in str(caught.value)
    assert str(caught.value).startswith(f"{path}:{line}: " if line else f"{path}:")


def test_a_file_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(OverridesError, match="cannot be read"):
        read(tmp_path / "none.yaml", load())
