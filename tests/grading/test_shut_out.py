"""Programs that do not run beside each other: what each does alone is no work that is there at once."""

from __future__ import annotations

from dataclasses import replace

import evidences
import pytest

from ros2lab.grading.evidence import Run
from ros2lab.grading.grade import Grade
from ros2lab.grading.judging.ways import shut_out
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

BUSY = "The robot is busy."
PROGRAMS = (evidences.STATUS, evidences.COMMAND, evidences.VELOCITY)
RUNS = {
    evidences.STATUS: evidences.status_run(),
    evidences.COMMAND: evidences.command_run(),
    evidences.VELOCITY: evidences.velocity_run(),
}


def _together(*there: str, ended: dict[str, str], early: bool = True) -> Run:
    """Return what is seen of all programs where only some of them run."""
    seen = evidences.merged([RUNS[name] for name in there], there[0], "together")
    return replace(seen, programs=[*PROGRAMS], ended=ended, early=sorted(ended) if early else [])


def _graded(together: Run, *, is_launched: bool = False) -> Grade:
    right = evidences.right()
    runs = [run for run in right.runs if is_launched or run.setting != "launched"]
    return verdict(replace(right, runs=[*runs, together]), load())


def _points(grade: Grade) -> list[float]:
    return [grade.components[name].points for name in PROGRAMS]


def test_programs_that_lock_each_other_out_are_not_put_together() -> None:
    """One of them is there; of the others there is what stands in their code."""
    grade = _graded(_together(evidences.STATUS, ended={evidences.COMMAND: BUSY, evidences.VELOCITY: BUSY}))
    status, command, velocity = _points(grade)
    assert status == 20
    assert max(command, velocity) <= 5
    reasons = [one.reason for one in grade.criteria if one.id == "velocity_publisher.topic"]
    assert "for velocity_publisher ends with “The robot is busy” beside the other programs" in reasons[0]
    assert (
        f"{evidences.VELOCITY}, together: it ended with “The robot is busy” before any command, and was not seen to end alone."
        in [*grade.notes]
    )


def test_one_that_waits_until_the_others_have_gone_is_not_there() -> None:
    """It does not end, and nothing of its node comes."""
    grade = _graded(_together(evidences.STATUS, evidences.COMMAND, ended={}))
    assert _points(grade)[:2] == [20, 20]
    assert _points(grade)[2] <= 5
    reasons = [one.reason for one in grade.criteria if one.id == "velocity_publisher.topic"]
    assert "for velocity_publisher does nothing beside the other programs" in reasons[0]


def test_one_that_is_silent_while_another_one_has_its_turn_is_not_there() -> None:
    """Its node comes up, and publishes what it publishes alone only as long as nobody else holds a lock."""
    silent = replace(RUNS[evidences.VELOCITY], quiet={})
    together = evidences.merged([RUNS[evidences.STATUS], RUNS[evidences.COMMAND], silent], "", "together")
    status, command, velocity = _points(_graded(replace(together, programs=[*PROGRAMS])))
    assert [status, command] == [20, 20]
    assert velocity <= 9  # of a node that is there and silent


def test_what_a_launch_file_starts_together_counts() -> None:
    """It may start them so that none is in the way of another."""
    together = _together(evidences.STATUS, ended={evidences.COMMAND: BUSY, evidences.VELOCITY: BUSY})
    assert _points(_graded(together, is_launched=True)) == [20, 20, 20]


def test_another_one_that_a_launch_file_lets_through_is_no_company() -> None:
    """Which of them is the first is chance; each time it is one."""
    right = evidences.right()
    launched = replace(evidences.launched([RUNS[evidences.COMMAND]]), programs=["robot.launch.py"])
    together = _together(evidences.STATUS, ended={evidences.COMMAND: BUSY, evidences.VELOCITY: BUSY})
    apart = [run for run in right.runs if run.setting != "launched"]
    points = _points(verdict(replace(right, runs=[*apart, launched, together]), load()))
    assert sorted(points)[-1] == 20
    assert sum(points) < 31


@pytest.mark.parametrize("wins", PROGRAMS)
def test_whichever_is_first_is_worth_the_same(wins: str) -> None:
    others = {name: BUSY for name in PROGRAMS if name != wins}
    points = _points(_graded(_together(wins, ended=others)))
    assert sorted(points)[-1] == 20
    assert sum(points) < 31


def test_a_second_program_of_the_same_node_may_be_shut_out() -> None:
    """Each node minds that it runs only once; two executables start the same one."""
    right = evidences.right()
    again = replace(evidences.status_run(), programs=["status"])
    together = replace(_together(*PROGRAMS, ended={"status": BUSY}), programs=[*PROGRAMS, "status"])
    grade = verdict(replace(right, runs=[*right.runs, again, together]), load())
    assert _points(grade) == [20, 20, 20]


@pytest.mark.parametrize(
    ("together", "names"),
    [
        (_together(*PROGRAMS, ended={}), set()),
        (_together(*PROGRAMS, ended={evidences.STATUS: BUSY}, early=False), set()),  # of a command
        (_together(*PROGRAMS, ended={evidences.STATUS: BUSY}), {evidences.STATUS}),
        (
            replace(_together(evidences.STATUS, ended={}), nodes=[], publishes={}),
            set(),
        ),  # it could not be watched
    ],
)
def test_who_is_shut_out(together: Run, names: set[str]) -> None:
    assert {*shut_out([*RUNS.values(), together])} == names


def test_what_ends_alone_as_well_is_not_shut_out() -> None:
    dead = replace(evidences.status_run(), ended={evidences.STATUS: BUSY})
    together = _together(evidences.COMMAND, ended={evidences.STATUS: BUSY})
    assert shut_out([dead, RUNS[evidences.COMMAND], together]) == {}


def test_names_that_differ_from_start_to_start_are_no_absence() -> None:
    """A node may have the number of its process in its name."""
    renamed = evidences.status_run(node="/status_4711")
    together = evidences.merged([renamed, RUNS[evidences.COMMAND], RUNS[evidences.VELOCITY]], "x", "together")
    runs = [*RUNS.values(), replace(together, programs=[*PROGRAMS])]
    assert shut_out(runs) == {}
