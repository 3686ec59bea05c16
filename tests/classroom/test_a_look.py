"""What an instructor is asked to look at, and why; a right submission needs no look."""

from __future__ import annotations

from dataclasses import replace

import evidences
import pytest
from evidences import FAULTS, right

from ros2lab.classroom.a_look import Looked, reasons
from ros2lab.classroom.gradebook import Row
from ros2lab.classroom.handed_in import HandedIn
from ros2lab.grading import rubric
from ros2lab.grading.evidence import Evidence, Executable, WrittenEnd
from ros2lab.grading.overrides import Decision
from ros2lab.grading.receiving.notes import Note
from ros2lab.grading.verdict import verdict


def fault(name: str) -> Evidence:
    _, change = FAULTS[name]
    return change(right())


def changed(**of_a_run: object) -> Evidence:
    first, *others = right().runs
    return replace(right(), runs=[replace(first, **of_a_run), *others])  # type: ignore[arg-type]


def with_a_program_more() -> Evidence:
    build = right().build
    assert build is not None
    more = Executable("extra", "a.extra:main", "installed", ["extra"])
    return replace(right(), build=replace(build, executables=[*build.executables, more]))


REASONS = {
    "It was watched on the real clock": evidences.real_clock(),
    "This could not be tried: command_subscriber.commands, command_subscriber.log.": fault("command: ends"),
    "Points rest on what was likely meant: status_publisher.topic.": fault("status: topic /status"),
    "A field was given a value of another type, so it was watched a second time: status_publisher.": changed(
        refused="AssertionError"
    ),
    "The sandbox notes: It is slow; It is loud.": changed(
        notes=["It is slow.", "It is loud.", "It is slow."]
    ),
    "Not everything could be received: ../evil.": replace(
        right(), submission=replace(right().submission, notes=[Note("outside", ["../evil"])])
    ),
    "A part of it was taken from elsewhere in the repository: src -> ../bob/src.": replace(
        right(), submission=replace(right().submission, notes=[Note("from elsewhere", ["src -> ../bob/src"])])
    ),
    "Not all of it was read: It is nested too deeply.": replace(
        right(), files=replace(right().files, unread={"sources": "It is nested too deeply."})
    ),
    "Not all of it was read: Not looked at, because it is larger than 1000000 bytes: a.py.": replace(
        right(),
        submission=replace(right().submission, notes=[Note("too large python", ["a.py"], "1000000")]),
    ),
    "Reading did not find the code of what runs: status_publisher, command_subscriber, velocity_publisher.": replace(
        right(),
        files=replace(
            right().files,
            ends_elsewhere=[
                WrittenEnd("", "", is_publisher=True, periods=[]),
                WrittenEnd("", "", is_publisher=False, periods=[]),
            ],
        ),
    ),
    "Not all of its programs were watched: extra.": with_a_program_more(),
    "It ran without the sandbox.": replace(right(), sandbox="none"),
}


def sentences(evidence: Evidence, problem: str = "", *, is_decided: bool = False) -> list[str]:
    course = rubric.load()
    decisions = {"documentation.code": Decision(1, "It is short.", "I. Structor")} if is_decided else {}
    row = Row(HandedIn("1", "Ann"), "", "graded", "", None, 1, problem, 6.0)
    return [*reasons(Looked(row, verdict(evidence, course, decisions), evidence, course))]


def test_a_right_submission_needs_no_look() -> None:
    assert sentences(replace(right(), sandbox="bubblewrap 0.8.0")) == []


@pytest.mark.parametrize("reason", REASONS)
def test_what_needs_a_look_says_why(reason: str) -> None:
    evidence = REASONS[reason]
    if "without the sandbox" not in reason:
        evidence = replace(evidence, sandbox="bubblewrap 0.8.0")
    (sentence,) = sentences(evidence)
    assert sentence.startswith(reason)


def test_nothing_to_grade_and_what_was_decided_are_looked_at() -> None:
    assert sentences(evidences.nothing(), "It is empty.")[0] == "There was nothing to grade: It is empty."
    (decided,) = sentences(replace(right(), sandbox="bubblewrap 0.8.0"), is_decided=True)
    assert decided == "An instructor has decided: documentation.code 1 instead of 3, by I. Structor."
