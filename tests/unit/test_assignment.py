"""An assignment as data: the course's own, one of somebody else's, and those that say where they are wrong."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from ros2lab import assignments
from ros2lab.assignments import AskedParameter, Assignment, AssignmentError, Exchange

OWN = """schema: 1
title: A thermostat
package: {name: thermostat, dependencies: [rclpy, std_msgs]}
parts:
  thermometer:
    publishes: /temperature
    type: std_msgs/msg/Float64
    period: 0.5
  heater:
    subscribes: /heating
    type: std_msgs/msg/String
    commands: [warmer, colder]
    unknown: [""]
    words: [heat, radiator]
"""


SERVICE = """schema: 1
title: A lamp
package: {name: lamp}
parts:
  switch:
    provides: /switch
    type: std_srvs/srv/SetBool
    within: 0.5
    requests:
      - {request: {data: true}, response: {success: true}}
      - {}
"""


def written(folder: Path, text: str = OWN) -> Path:
    (folder / "assignment.yaml").write_text(text)
    return folder


def test_the_courses_own_is_read_once() -> None:
    week2 = assignments.load()
    assert week2 is assignments.load()
    assert week2.package == "robot_controller"
    assert week2.topics == ("/robot/status", "/robot/command", "/cmd_vel")
    assert week2.commanded is week2.parts["command_subscriber"]
    assert week2.parts["command_subscriber"].effects == ("moving", "still", "still")


def test_another_one_is_read_from_its_folder(tmp_path: Path) -> None:
    thermostat = assignments.load(written(tmp_path))
    assert thermostat.name == tmp_path.name
    thermometer, heater = thermostat.parts.values()
    assert (thermometer.is_publisher, thermometer.period) == (True, 0.5)
    assert thermometer.words == ("thermometer",)
    assert (heater.commands, heater.effects, heater.unknown) == (("warmer", "colder"), ("any", "any"), ("",))
    assert thermostat.is_only(thermometer)


def test_it_survives_the_way_through_json(tmp_path: Path) -> None:
    others = (assignments.load(written(tmp_path, text)) for text in (OWN, SERVICE))
    for assignment in (assignments.load(), *others):
        assert Assignment.of_plain(json.loads(json.dumps(assignment.plain()))) == assignment


@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("stat_pub", "status_publisher"),
        ("cmd_listener", "command_subscriber"),
        ("cmd_vel_node", "velocity_publisher"),
        ("VelocityNode", "velocity_publisher"),
        ("talker", None),
        ("", None),
    ],
)
def test_the_longest_word_tells_which_part_a_name_means(name: str, part: str | None) -> None:
    found = assignments.load().meant_by(name)
    assert (found.name if found else None) == part


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("schema: 1", "schema: 2", 1, "the schema must be 1"),
        ("title: A thermostat\n", "", 1, "title is missing"),
        ("title: A thermostat", "titel: A thermostat", 2, "'titel' is not one of"),
        (
            "name: thermostat",
            "name: Thermo-Stat",
            3,
            "a package's name such as robot_controller is wanted here",
        ),
        ("  thermometer:", "  Thermo Meter:", 5, "a name such as status_publisher is wanted here"),
        ("publishes: /temperature", "publishes: temperature", 6, "a topic's full name such as /robot/status"),
        ("publishes: /temperature\n    ", "", 6, "thermometer needs one of publishes, subscribes, provides"),
        ("std_msgs/msg/Float64", "Float64", 7, "a message's type such as std_msgs/msg/String"),
        ("period: 0.5", "period: 0", 8, "a number from 0.01 to 10"),
        (
            "period: 0.5",
            "commands: [a]",
            8,
            "'commands' is not one of publishes, type, period, parameters, when, words",
        ),
        ("/heating", "/temperature", 10, "another part has the topic /temperature"),
        (
            "[warmer, colder]",
            "{warmer: moving, colder: stil}",
            12,
            "one of moving, still, any is wanted here",
        ),
        ("parts:", "parts: [", 0, "this is not YAML"),
        ("parts:", "parts: " + "[" * 1000, 0, "it is nested too deeply"),
        ("period: 0.5", f"period: 0x{'f' * 5000}", 8, "a number from 0.01 to 10 is wanted here"),
        ("[warmer, colder]", '["\\ud800"]', 12, "a text of whole characters is wanted here"),
    ],
)
def test_a_wrong_one_says_where(tmp_path: Path, old: str, new: str, line: int, words: str) -> None:
    assert old in OWN
    with pytest.raises(AssignmentError) as caught:
        assignments.load(written(tmp_path, OWN.replace(old, new, 1)))
    text = str(caught.value)
    assert words in text
    path = tmp_path / "assignment.yaml"
    assert text.startswith(f"{path}:{line}: " if line else f"{path}:")
    assert "\n" not in text


def test_what_is_published_on_an_occasion_has_no_period(tmp_path: Path) -> None:
    once = assignments.load(written(tmp_path, OWN.replace("period: 0.5", "when: once")))
    assert once.parts["thermometer"].when == "once"
    for given, words in (
        ("when: often", "assignment.yaml:8: once or change is wanted here, not 'often'"),
        (
            "when: change\n    period: 1",
            "assignment.yaml:8: what is published on such an occasion has no period",
        ),
    ):
        with pytest.raises(AssignmentError) as caught:
            assignments.load(written(tmp_path, OWN.replace("period: 0.5", given)))
        assert words in str(caught.value)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("{period: {value: 0.5, changes: rythm}}", "rhythm or message is wanted here, not 'rythm'"),
        ("{period: {value: fast, changes: rhythm}}", "a number from 0 is wanted here"),
        ("{text: {value: [1], changes: message}}", "a number, a text, true or false is wanted here"),
        ("{text: {value: hi}}", "changes is missing"),
        ("{2nd: {value: 1, changes: message}}", "a parameter's name such as period is wanted here"),
        ("[period]", "names with values are wanted here"),
    ],
)
def test_a_wrong_parameter_says_where(tmp_path: Path, given: str, words: str) -> None:
    text = OWN.replace("    period: 0.5", f"    parameters: {given}")
    with pytest.raises(AssignmentError, match=r"assignment.yaml:8: ") as caught:
        assignments.load(written(tmp_path, text))
    assert words in str(caught.value)


def test_a_parameter_has_a_value_and_what_it_changes(tmp_path: Path) -> None:
    given = "{period: {value: 2, changes: rhythm}, text: {value: hi, changes: message}}"
    text = OWN.replace("    period: 0.5", f"    parameters: {given}")
    assignment = assignments.load(written(tmp_path, text))
    assert assignment.parts["thermometer"].parameters == (
        AskedParameter("period", 2.0, "rhythm"),
        AskedParameter("text", "hi", "message"),
    )
    assert Assignment.of_plain(json.loads(json.dumps(assignment.plain()))) == assignment


def test_a_service_has_requests_and_their_responses(tmp_path: Path) -> None:
    lamp = assignments.load(written(tmp_path, SERVICE))
    (switch,) = lamp.services
    assert (switch.end, switch.topic, switch.within) == ("service", "/switch", 0.5)
    assert switch.requests == (Exchange({"data": True}, {"success": True}), Exchange())


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("SetBool", "SetBol", 7, "there is no std_srvs/srv/SetBol on this machine"),
        (
            "std_srvs/srv/SetBool",
            "std_srvs/srv/SetBool_Request",
            7,
            "there is no std_srvs/srv/SetBool_Request on",
        ),
        ("data: true", f"data: {'[' * 300}{']' * 300}", 10, "a plain value is wanted here"),
        ("std_srvs/srv/SetBool", "std_msgs/msg/Bool", 7, "a service's type such as std_srvs/srv/SetBool"),
        ("within: 0.5", "within: 0", 8, "a number from 0.1 to 10"),
        ("data: true", "dat: true", 10, "has no field 'dat'"),
        ("data: true", "data: [1]", 10, "data"),
        ("success: true", "sucess: true", 10, "has no field 'sucess'"),
        ("{}", "{answer: {}}", 11, "'answer' is not one of request, response"),
    ],
)
def test_a_wrong_service_says_where(tmp_path: Path, old: str, new: str, line: int, words: str) -> None:
    assert old in SERVICE
    with pytest.raises(AssignmentError, match=rf"assignment.yaml:{line}: ") as caught:
        assignments.load(written(tmp_path, SERVICE.replace(old, new, 1)))
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_one_that_is_not_there_or_empty_is_refused(tmp_path: Path) -> None:
    with pytest.raises(AssignmentError, match=r"cannot be read .*; give a folder with assignment.yaml"):
        assignments.load(tmp_path)
    with pytest.raises(AssignmentError, match="it is empty"):
        assignments.load(written(tmp_path, "# nothing\n"))


def test_the_words_of_a_node_are_its_own_where_the_commands_are_not_known() -> None:
    """A few of those with which its code compares something, less what is sent anyhow and what is no word."""
    course = assignments.load()
    part = course.commanded
    assert part is not None
    assert course.with_own_words(["go", *part.commands]) is course
    theirs = course.with_own_words(
        ["__main__", "", "2", "Start", "START", "dance", "go", "halt", "left", "right", "up"]
    )
    assert theirs.commanded is not None
    assert theirs.commanded.own == ("Start", "go", "halt", "left")
    assert Assignment.of_plain(json.loads(json.dumps(theirs.plain()))) == theirs
