"""What goes beyond the assignment besides launch and parameter files: period parameters, errors, tests."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

from ros2lab.grading.evidence import Run
from ros2lab.grading.judging.periods import has_rhythm, is_changed, is_followed
from ros2lab.grading.judging.player import is_for_want, is_timers
from ros2lab.grading.judging.players import Case
from ros2lab.grading.questions.answer import Answer, last_word, listed, question, shown

# Parts of parameter names that can hardly belong to anything but a timer.
_SURELY_TIMERS = re.compile(r"period|interval|timer|publish|status", re.IGNORECASE)


@question("all some none unseen missing", "without", frozenset(("parameter-undeclared", "parameter-type")))
def period_parameters_take_effect(case: Case) -> Answer:
    """Whether a timer fires at another rate when its parameter has another value."""
    tried = [*_tried(case)]
    answered = {
        name
        for run in case.evidence.runs
        if run.setting == "alone"
        for values in run.parameters.values()
        for name in values
    }
    meant = _meant(tried, answered)
    known = [trial for trial in meant if trial.has_effect is not None]
    if not known:
        return Answer("unseen" if meant else "missing", {"without": ""}, ("runs",))
    without = _without_effect(known)
    level = "all" if not without else "some" if len(without) < len(known) else "none"
    return Answer(
        level,
        {"without": listed(without)},
        tuple(f"runs[{number}].setting" for trial in known for number in trial.numbers),
    )


@dataclass(frozen=True)
class _Tried:
    """A parameter that was given other values; `has_effect` is None if no topic had a rhythm before."""

    numbers: tuple[int, ...]
    program: str
    parameter: str
    has_effect: bool | None


def _meant(tried: Sequence[_Tried], answered: Collection[str]) -> list[_Tried]:
    """Return the parameters that are meant for a period.

    If no name is a timer's, other numbers were tried; one without an effect is for something else. A
    parameter that a program does not report may belong to another program.
    """
    at_work = {trial.parameter for trial in tried if trial.has_effect}
    return [
        trial
        for trial in tried
        if trial.has_effect
        or (is_timers(trial.parameter) and (trial.parameter in answered or trial.parameter not in at_work))
    ]


def _without_effect(known: Sequence[_Tried]) -> list[str]:
    """Return the parameters that should have an effect and have none.

    A turn rate belongs to no timer: a parameter with such a name is a fault only if no other one of the
    program works.
    """
    working = {trial.program for trial in known if trial.has_effect}
    return [
        f"{trial.program} {trial.parameter}"
        for trial in known
        if not trial.has_effect and (trial.program not in working or _SURELY_TIMERS.search(trial.parameter))
    ]


def _tried(case: Case) -> Iterator[_Tried]:
    """Yield the parameters that were tried, except those that are to change messages by the assignment."""
    runs = [(number, run) for number, run in enumerate(case.evidence.runs) if run.programs]
    alone = {run.programs[0]: run for _, run in runs if run.setting == "alone"}
    parts = case.assignment.parts.values()
    of_messages = {
        parameter.name for part in parts for parameter in part.parameters if parameter.changes == "message"
    }
    found: dict[tuple[str, str], list[tuple[int, Run]]] = {}
    for number, run in runs:
        name, is_changed, _ = run.setting.partition(":=")
        if is_changed and run.programs[0] in alone and name not in of_messages:
            found.setdefault((run.programs[0], name), []).append((number, run))
    for (program, name), tries in found.items():
        effect = _takes_effect(case, alone[program], name, [run for _, run in tries])
        yield _Tried(tuple(number for number, _ in tries), program, name, effect)


def _takes_effect(case: Case, before: Run, name: str, tries: Sequence[Run]) -> bool | None:
    """Return whether any topic follows a parameter; None if no topic had a rhythm before.

    Its period or rate must change as the value does: any other change may be chance, or a fixed period for
    any value but the default. If the value before is not known, any change counts.
    """
    if not has_rhythm(before):
        return None
    effect = is_followed(before, tries, case.evidence.files.declared.get(name))
    return is_timers(name) and any(is_changed(before, run) for run in tries) if effect is None else effect


@question("by_name wholesale of_an_end none")
def errors_are_handled(case: Case) -> Answer:
    """Whether exceptions are caught, by name, and not only those that ask the program to end.

    The handler must be in the code of a program that was seen to work, or that could not be tried here.
    """
    modules = _modules_at_work(case)
    for key in ("by name", "wholesale", "of an end") if case.executables else ():
        places = [
            place
            for place in case.evidence.files.handlers.get(key, ())
            if modules is None or PurePosixPath(place.file).stem in modules
        ]
        if places:
            place = shown(f"{places[0].file}:{places[0].line}")
            return Answer(key.replace(" ", "_"), {}, ("files.handlers",), place)
    return Answer("none", {}, ("files.handlers",))


def _modules_at_work(case: Case) -> set[str] | None:
    """Return the modules of the programs that had a node, or that ended for lack of something not here.

    None if the modules of one of these programs are not known.
    """
    runs = case.evidence.runs
    launched = {node for run in runs if run.setting == "launched" for node in run.nodes}
    found = set[str]()
    for name, program in case.executables.items():
        own = [run for run in runs if name in run.programs and len(run.programs) == 1]
        is_seen = any(run.nodes or is_for_want(run.ended.get(name, "")) for run in own)
        if is_seen or (launched and not own):
            if not program.modules:
                return None
            found |= {*program.modules}
    return found


@question("sound blind failing not_run untried missing", "error files")
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
    if tests.get("is_untried"):
        return Answer("not_run", seen, ("tests",))
    if failed or not passed:
        return Answer("failing", seen, ("tests",))
    if tests.get("is_unfinished"):
        return Answer(
            "blind", seen, ("tests",), excuse="its tests take so long that broken nodes were not tried"
        )
    return Answer("sound" if tests.get("is_noticed") else "blind", seen, ("tests",))
