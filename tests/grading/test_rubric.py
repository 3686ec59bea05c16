"""The course's rubric, one of an instructor's own, and rubrics that say where they are wrong."""

from __future__ import annotations

from pathlib import Path

import pytest
from evidences import FAULTS, right

import ros2lab.grading.rubric as rubric_module
from ros2lab.grading.questions import ANSWERS, NAMES
from ros2lab.grading.rubric import RubricError, load
from ros2lab.grading.verdict import verdict

COURSES = Path(rubric_module.__file__).with_name("rubric.yaml").read_text(encoding="utf-8")
OWN = """schema: 1
components: {status_publisher: 60, documentation: 40}
criteria:
  - id: status_publisher.period
    title: Every 2 s
    points: 60
    question: status_period
    levels:
      right: {share: 1, reason: "every {period} s"}
      close: {share: 0.9, reason: "every {period} s", hint: "2 s"}
      "off": {share: 0.5, reason: "every {period} s", hint: "2 s"}
      far: {share: 0.1, reason: "every {period} s", hint: "2 s"}
      irregular: {share: 0, reason: "now and then", hint: "2 s"}
      growing: {share: 0, reason: "more and more", hint: "2 s"}
      once: {share: 0, reason: "once", hint: "2 s"}
      silent: {share: 0, reason: "never", hint: "2 s"}
      missing: {share: 0, reason: "no node", hint: "write one"}
  - id: documentation.code
    title: Described
    points: 40
    question: code_is_described
    levels:
      most: {share: 1, reason: "most"}
      some: {share: 0.5, reason: "some", hint: "more"}
      few: {share: 0.2, reason: "few", hint: "more"}
      none: {share: 0, reason: "none", hint: "more"}
"""


def test_the_course_has_100_points_and_10_more() -> None:
    rubric = load()
    assert dict(rubric.components) == {
        "workspace": 15,
        "package": 15,
        "status_publisher": 20,
        "command_subscriber": 20,
        "velocity_publisher": 20,
        "documentation": 10,
        "bonus": 10,
    }
    assert {criterion.points for criterion in rubric.criteria if criterion.component == "bonus"} == {2}


def test_every_question_is_asked_and_can_earn_all_and_nothing() -> None:
    criteria = load().criteria
    assert {criterion.question for criterion in criteria} == ANSWERS.keys() == NAMES.keys()
    for criterion in criteria:
        shares = {level.share for level in criterion.levels.values()}
        assert max(shares) == 1
        assert min(shares) == 0


def test_an_instructors_own(tmp_path: Path) -> None:
    path = tmp_path / "own.yaml"
    path.write_text(OWN)
    rubric = load(path)
    assert verdict(right(), rubric).total == 100
    grade = verdict(FAULTS["status: 1.0 s"][1](right()), rubric)
    assert grade.total == 70
    assert [one.reason for one in grade.criteria] == ["every 1.0 s", "most"]
    assert verdict(FAULTS["velocity: never"][1](right()), rubric).total == 100


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("schema: 1", "schema: 2", 1, "the schema must be 1"),
        ("schema: 1\n", "", 1, "schema is missing"),
        ("documentation: 40}", "documentation: 30}", 2, "add up to 90, not to 100"),
        ("documentation: 40}", "documentation: 40, bonus: 11}", 2, "bonus must be at most 10"),
        ("documentation: 40}", "documentation: .nan}", 2, "a number from 0"),
        ("documentation: 40}", "documentation: .inf}", 2, "a number from 0"),
        ("points: 40", "points: 39", 4, "the criteria of documentation add up to 39, not to 40"),
        ("id: status_publisher.period", "id: staus.period", 4, "an id is component.name"),
        ("id: status_publisher.period", "id: status_publisher", 4, "an id is component.name"),
        ("title: Every 2 s", "titel: Every 2 s", 5, "'titel' is not one of"),
        ("title: Every 2 s", "title:", 5, "a text is wanted here"),
        ("points: 60", "points: many", 6, "a number from 0"),
        ("question: status_period", "question: status_perod", 7, "there is no question status_perod"),
        ("      once: {share: 0, reason: \"once\", hint: \"2 s\"}\n", "", 9, "the levels of status_period must be"),
        ("share: 0.9", "share: 90", 10, "a number from 0 to 1"),
        ("share: 0.9", "share: true", 10, "a number from 0 to 1"),
        ('"every {period} s", hint: "2 s"}', '"every {period} s"}', 10, "close loses points and needs a hint"),
        ('{share: 0, reason: "never"', '{share: 0, reason: "every {period"', 16, "the braces do not fit"),
        ('{share: 0, reason: "never"', '{share: 0, reason: "{perod}"', 16, "{perod} cannot be filled in"),
        ('{share: 0, reason: "never"', '{share: 0, reason: "{period.__class__}"', 16, "cannot be filled in"),
        ("id: documentation.code", "id: status_publisher.period", 18, "there is another criterion"),
        ("      few: ", "      none: ", 26, "'none' is there twice"),
        ("criteria:\n", "criteria: [\n", 0, "this is not YAML"),
        ("components: {status", "components: !!python/name:os.system {status", 2, ""),
    ],
)  # fmt: skip
def test_a_wrong_rubric_says_where(tmp_path: Path, old: str, new: str, line: int, words: str) -> None:
    path = tmp_path / "own.yaml"
    assert old in OWN
    path.write_text(OWN.replace(old, new, 1))
    if not words:  # a tag that a mapping of names bears is passed over, never obeyed
        assert load(path)
        return
    with pytest.raises(RubricError) as caught:
        load(path)
    text = str(caught.value)
    assert words in text
    assert text.startswith(f"{path}:{line}: " if line else f"{path}:")
    assert "\n" not in text


@pytest.mark.parametrize("text", ["", "# nothing\n"])
def test_an_empty_rubric_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "own.yaml"
    path.write_text(text)
    with pytest.raises(RubricError, match="it is empty"):
        load(path)


def test_a_rubric_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RubricError, match="cannot be read"):
        load(tmp_path / "none.yaml")
    (tmp_path / "bytes.yaml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(RubricError, match="cannot be read"):
        load(tmp_path / "bytes.yaml")


def test_the_courses_own_can_be_changed_and_used(tmp_path: Path) -> None:
    path = tmp_path / "course.yaml"
    path.write_text(
        COURSES.replace('"off":\n        share: 0.4\n', '"off":\n        share: 0.6\n'), encoding="utf-8"
    )
    change = FAULTS["status: 1.0 s"][1]
    assert verdict(change(right()), load(path)).total == pytest.approx(
        verdict(change(right()), load()).total + 1.4
    )
