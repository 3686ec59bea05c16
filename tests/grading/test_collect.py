"""What is collected of a submission, told in the words and places of what was handed in."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import evidences
import pytest

from ros2lab import assignments
from ros2lab.grading.evidence import Files, Place
from ros2lab.grading.reading.reader import as_written
from ros2lab.grading.receiving.submission import FoundPackage, Submission
from ros2lab.grading.watching.job import Program
from ros2lab.grading.watching.other_values import changed, doubtful
from ros2lab.grading.watching.rounds import CAUGHT, _refused

PACKAGE = FoundPackage("ws/src/robot_controller", "robot_controller", "ament_python", None)
SUBMISSION = Submission("workspace", "ws", [PACKAGE], PACKAGE, [], [])
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
    assert as_written(said.format(f"{INSTALLED}/{file}"), tmp_path, PACKAGE.folder) == said.format(written)


@pytest.mark.parametrize("file", ["robot_controller/other.py", "../../../../../../../etc/passwd"])
def test_what_was_not_handed_in_stays_where_it_is(tmp_path: Path, file: str) -> None:
    said = f'  File "{INSTALLED}/{file}", line 3, in tell'
    assert as_written(said, tmp_path, PACKAGE.folder) == said


def test_a_parameter_that_the_code_declares_is_tried_on_what_does_not_spin() -> None:
    """A program that answers tells its own; one that has ended has none that could take effect."""
    mute = replace(evidences.status_run(), parameters={})
    facts = Files(declared={"period": None, "interval": 2.0, "rate_hz": 4, "speed": 0.5})
    status, drive = Program(evidences.STATUS, []), Program(evidences.VELOCITY, [])
    tried = [(one.name, *one.parameters) for one in changed([status, drive], [mute], facts)]
    assert tried == [
        (evidences.STATUS, f"{given}") for given in ("period:=0.7", "interval:=1.0", "rate_hz:=2")
    ]
    tried = [
        (one.name, *one.parameters)
        for one in changed([status, drive], [mute, evidences.velocity_run()], facts)
    ]
    assert (evidences.VELOCITY, "period:=0.2") in tried
    assert (evidences.STATUS, "period:=0.7") not in tried
    assert not [*changed([status], [replace(mute, ended={evidences.STATUS: "bye"})], facts)]


@pytest.mark.parametrize(
    ("name", "own", "given", "period", "again"),
    [
        ("period", 2.0, 1.0, 1.0, ""),  # it follows
        ("period", 2.0, 1.0, 2.0, ""),  # it does not change
        ("period", 2.0, 1.0, 1.5, "period:=4.0"),  # it may keep to a limit
        ("period", 2.0, 1.0, 0.8, "period:=4.0"),  # it may have one other period
        ("period_ms", 2000, 1000, 1.5, "period_ms:=4000"),
        ("period", 1, 2, 1.4, ""),  # there is no half of it
        ("rate_hz", 0.5, 1.0, 1.0, ""),
        ("speed", 0.5, 1.0, 1.4, ""),  # no name of a timer's
    ],
)
def test_a_period_that_has_changed_otherwise_is_looked_into(
    name: str, own: float, given: float, period: float, again: str
) -> None:
    before = replace(evidences.status_run(), parameters={"/status_publisher": {name: own}})
    changed = replace(evidences.status_run(period=period), setting=f"{name}:={given}")
    status = Program(evidences.STATUS, [])
    tried = [one.parameters for one in doubtful([status], [before, changed], Files())]
    assert tried == ([[again]] if again else [])


@pytest.mark.parametrize(
    ("catches", "values", "refused"), [(True, 0, True), (False, 0, False), (True, 3, False)]
)
def test_a_silence_that_may_be_a_caught_refusal_is_looked_into(
    *, catches: bool, values: int, refused: bool
) -> None:
    run = evidences.velocity_run(values=[evidences.twist(0.5)] * values)
    facts = Files(handlers={"wholesale": [Place("a.py", 3)] if catches else []})
    assert _refused(assignments.load(), facts, [run]) == ({evidences.VELOCITY: CAUGHT} if refused else {})


def test_what_the_check_of_fields_has_ended_is_looked_into() -> None:
    said = "Traceback (most recent call last):\nAssertionError: The 'x' field must be of type 'float'"
    run = replace(evidences.velocity_run(), ended={evidences.VELOCITY: said})
    assert _refused(assignments.load(), Files(), [run]) == {evidences.VELOCITY: said}
