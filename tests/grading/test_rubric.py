"""The course's rubric, one of an instructor's own, and rubrics that say where they are wrong."""

from __future__ import annotations

from pathlib import Path

import pytest
from evidences import FAULTS, right

from ros2lab import assignments
from ros2lab.grading.questions import QUESTIONS
from ros2lab.grading.rubric import RubricError, load
from ros2lab.grading.verdict import verdict

COURSES = (Path(assignments.__file__).parent / "week2" / "rubric.yaml").read_text(encoding="utf-8")
LAMP = Path(__file__).parents[2] / "docs/examples/lamp"
DOOR = """schema: 1
title: A door
package: {name: door}
parts:
  state: {publishes: /door/state, type: std_msgs/msg/Bool, when: change}
"""
OF_DOOR = """schema: 1
components: {state: 100}
criteria: [{id: state.occasion, points: 100, question: comes_when_it_should}]
"""
OWN = """schema: 1
components: {status_publisher: 60, documentation: 40}
criteria:
  - id: status_publisher.period
    title: Every 2 s
    points: 60
    question: has_its_period
    levels:
      right: {share: 1, reason: "every {period} s"}
      close: {share: 0.9, reason: "every {period} s", hint: "2 s"}
      "off": {share: 0.5, reason: "every {period} s", hint: "2 s"}
      far: 0.1
  - id: documentation.code
    points: 40
    question: code_is_described
    levels: {some: 0.5, none: {share: 0, reason: "none of {all}", hint: "more"}}
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


def test_every_question_is_asked_and_can_earn_all_and_nothing(tmp_path: Path) -> None:
    lamp = load(LAMP / "rubric.yaml", assignments.load(LAMP))
    (tmp_path / "assignment.yaml").write_text(DOOR)
    (tmp_path / "rubric.yaml").write_text(OF_DOOR)
    door = load(tmp_path / "rubric.yaml", assignments.load(tmp_path))
    criteria = load().criteria + lamp.criteria + door.criteria
    assert {criterion.question for criterion in criteria} == QUESTIONS.keys()
    for criterion in criteria:
        shares = {level.share for level in criterion.levels.values()}
        assert max(shares) == 1
        assert min(shares) == 0


def test_what_a_rubric_does_not_say_is_as_usual(tmp_path: Path) -> None:
    path = tmp_path / "own.yaml"
    path.write_text(OWN)
    period, code = load(path).criteria
    usual = {criterion.question: criterion for criterion in load().criteria}
    assert period.levels["once"] == usual["has_its_period"].levels["once"]
    assert period.levels["far"].share == 0.1
    assert period.levels["far"].hint == usual["has_its_period"].levels["far"].hint
    assert code.title == "Classes and functions are described"


def test_a_title_names_what_is_asked_for() -> None:
    titles = {criterion.id: criterion.title for criterion in load().criteria}
    assert titles["status_publisher.topic"] == "Publishes on /robot/status"
    assert titles["command_subscriber.topic"] == "Subscribes to /robot/command"
    assert titles["velocity_publisher.type"] == "The type is geometry_msgs/msg/Twist"
    assert titles["package.setup"] == "setup.py installs the package"
    assert titles["package.manifest"].startswith("package.xml is")


def test_an_instructors_own(tmp_path: Path) -> None:
    path = tmp_path / "own.yaml"
    path.write_text(OWN)
    rubric = load(path)
    assert verdict(right(), rubric).total == 100
    grade = verdict(FAULTS["status: 1.0 s"][1](right()), rubric)
    assert grade.total == 70
    assert [one.reason for one in grade.criteria] == [
        "every 1.0 s",
        "12 of 14 modules, classes and functions have a docstring or a comment.",
    ]
    assert verdict(FAULTS["velocity: never"][1](right()), rubric).total == 100


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("schema: 1", "schema: 2", 1, "the schema must be 1"),
        ("schema: 1", "schema: 1\ndoubted: 2", 2, "a number from 0 to 1"),
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
        ("question: has_its_period", "question: has_its_perod", 7, "there is no such question; there are"),
        ("      right: ", "      rihgt: ", 9, "the levels of has_its_period are right, begun"),
        ("question: code_is_described", "question: goes_on", 15, "goes_on is asked of a part, and the parts are"),
        ("share: 0.9", "share: 90", 10, "a number from 0 to 1"),
        ("share: 0.9", "share: true", 10, "a number from 0 to 1"),
        ("far: 0.1", "far: 1.1", 12, "a number from 0 to 1"),
        ("far: 0.1", "far: little", 12, "a number from 0 to 1"),
        ("right: {share: 1, reason: \"every {period} s\"}", "right: 0.5", 9, "loses points and needs"),
        ('"every {period} s", hint: "2 s"}', '"every {period} s"}', 10, "loses points and needs a hint"),
        ('"none of {all}"', '"none of {all"', 16, "the braces do not fit"),
        ('"none of {all}"', '"none of {al}"', 16, "{al} cannot be filled in"),
        ('"none of {all}"', '"none of {all.__class__}"', 16, "cannot be filled in"),
        ("id: documentation.code", "id: status_publisher.period", 13, "there is another criterion"),
        ("{some: 0.5, none", "{none: 0.5, none", 16, "'none' is there twice"),
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
    line = "{id: status_publisher.period, points: 7, question: has_its_period"
    assert line in COURSES
    path.write_text(COURSES.replace(line, f'{line}, levels: {{"off": 0.45}}'), encoding="utf-8")
    change = FAULTS["status: 1.0 s"][1]
    assert verdict(change(right()), load(path)).total == pytest.approx(
        verdict(change(right()), load()).total + 1.4
    )


@pytest.mark.parametrize(
    ("question", "words"),
    [
        ("has_its_period", "has_its_period is asked of a publisher, and switch is a service"),
        ("parameters_take_effect", "parameters_take_effect is asked of a publisher, and switch is a service"),
        ("colour_is_right", "there is no such question"),
    ],
)
def test_a_question_is_asked_of_a_part_that_can_answer_it(tmp_path: Path, question: str, words: str) -> None:
    path = tmp_path / "rubric.yaml"
    path.write_text((LAMP / "rubric.yaml").read_text().replace("service_goes_on", question))
    with pytest.raises(RubricError, match=r"rubric.yaml:\d+: ") as caught:
        load(path, assignments.load(LAMP))
    assert words in str(caught.value)


def test_a_question_is_asked_of_a_part_that_has_what_it_needs(tmp_path: Path) -> None:
    path = tmp_path / "rubric.yaml"
    path.write_text(OWN.replace("has_its_period", "parameters_take_effect"))
    with pytest.raises(RubricError, match="a part with parameters, and status_publisher has none"):
        load(path)


@pytest.mark.parametrize("name", ["week2", "lamp"])
def test_no_criterion_has_more_than_four_shares(name: str) -> None:
    """Whoever reads a report can keep in mind what there was to get."""
    rubric = load() if name == "week2" else load(LAMP / "rubric.yaml", assignments.load(LAMP))
    for criterion in rubric.criteria:
        assert len({level.share for level in criterion.levels.values()}) <= 4, criterion.id
