"""What goes beyond the assignment, besides a launch file and a parameter file: periods, errors, tests."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from ros2lab.assignments import Part
from ros2lab.grading.evidence import Run
from ros2lab.grading.periods import period_of
from ros2lab.grading.player import Player, is_timers
from ros2lab.grading.players import Case
from ros2lab.grading.questions.answer import Answer, last_word, listed, question, shown
from ros2lab.rhythm import LEAST_CHANGE

# Parts of the names of parameters that can hardly be anything but a timer's.
_SURELY_TIMERS = re.compile(r"period|interval|timer|publish|status", re.IGNORECASE)

NEARLY = 1.2  # times, from the change of a parameter to that of a period that follows it


@question("all some none unseen missing", "without", frozenset(("parameter-undeclared", "parameter-type")))
def period_parameters_take_effect(case: Case) -> Answer:
    """Whether a timer fires at another rate when its parameter is another one."""
    tried = [*_tried(case)]
    answered = {
        name
        for run in case.evidence.runs
        if run.setting == "alone"
        for values in run.parameters.values()
        for name in values
    }
    at_work = {one.parameter for one in tried if one.has_effect}
    # Where no name is a timer's, other numbers were tried; one that has no effect is for something else. What a program
    # does not tell of may be another's.
    meant = [
        one
        for one in tried
        if one.has_effect
        or (is_timers(one.parameter) and (one.parameter in answered or one.parameter not in at_work))
    ]
    known = [one for one in meant if one.has_effect is not None]
    if not known:
        return Answer("unseen" if meant else "missing", {"without": ""}, ("runs",))
    working = {one.program for one in known if one.has_effect}
    # A turn rate is no timer's: what has such a name is a fault only where no parameter of the program is one's.
    without = [
        f"{one.program} {one.parameter}"
        for one in known
        if not one.has_effect and (one.program not in working or _SURELY_TIMERS.search(one.parameter))
    ]
    level = "all" if not without else "some" if len(without) < len(known) else "none"
    return Answer(level, {"without": listed(without)}, tuple(f"runs[{one.number}].setting" for one in known))


@dataclass(frozen=True)
class _Tried:
    """A parameter that was given another value, and whether a rhythm has followed; None if there was none before."""

    number: int
    program: str
    parameter: str
    has_effect: bool | None


def _tried(case: Case) -> Iterator[_Tried]:
    """Yield the parameters that were tried, but those that the assignment asks to change messages."""
    runs = [(number, run) for number, run in enumerate(case.evidence.runs) if run.programs]
    alone = {run.programs[0]: run for _, run in runs if run.setting == "alone"}
    parts = case.assignment.parts.values()
    of_messages = {one.name for part in parts for one in part.parameters if one.changes == "message"}
    for number, run in runs:
        name, is_changed, _ = run.setting.partition(":=")
        program = run.programs[0]
        if is_changed and program in alone and name not in of_messages:
            yield _Tried(number, program, name, _takes_effect(alone[program], run))


@question("by_name wholesale of_an_end none")
def errors_are_handled(case: Case) -> Answer:
    """Whether exceptions are caught, by name, and others than that the program is asked to end."""
    for key in ("by name", "wholesale", "of an end") if case.executables else ():
        if places := case.evidence.files.handlers.get(key):
            place = shown(f"{places[0].file}:{places[0].line}")
            return Answer(key.replace(" ", "_"), {}, ("files.handlers",), place)
    return Answer("none", {}, ("files.handlers",))


@question("sound blind failing untried missing", "error files")
def tests_find_faults(case: Case) -> Answer:
    """Whether the package's own tests pass, and fail when a node is broken."""
    tests = case.evidence.tests
    passed, failed = int(tests.get("passed") or 0), int(tests.get("failed") or 0)
    left_out = case.evidence.files.tests_left_out
    seen = {"error": last_word(tests.get("error") or ""), "files": listed(left_out)}
    if left_out and not case.evidence.files.tests:
        return Answer("untried", seen, ("files.tests_left_out",), shown(left_out[0]))
    if not case.evidence.files.tests or not (passed or failed or tests.get("error")):
        return Answer("missing", seen, ("files.tests",))
    if failed or not passed:
        return Answer("failing", seen, ("tests",))
    return Answer("sound" if tests.get("is_noticed") else "blind", seen, ("tests",))


def _takes_effect(before: Run, after: Run) -> bool | None:
    """Return whether any topic comes at another rate; None if none comes again and again before.

    Where the name is not a timer's, the rate must have changed as the value has: a loop's rhythm may differ by chance.
    """
    periods = [*_periods(before, after)]
    if not periods:
        return None
    changes = [max(new / old, old / new) for old, new in periods if new]
    name, _, value = after.setting.partition(":=")
    if is_timers(name):
        return any(change >= LEAST_CHANGE for change in changes)
    own = (values.get(name) for values in before.parameters.values())
    asked = [abs(float(value) / one) for one in own if isinstance(one, (int, float)) and one]
    return any(1 / NEARLY < change / max(one, 1 / one) < NEARLY for change in changes for one in asked)


def _periods(before: Run, after: Run) -> Iterator[tuple[float, float | None]]:
    for topic in before.publishes:
        part = Part("", "publisher", topic, "")
        pair = [period_of(Player(part, "right", topic, "", (), 0, run, "")) for run in (before, after)]
        if pair[0]:
            yield pair[0], pair[1] or None
