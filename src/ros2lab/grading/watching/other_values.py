"""Choose which programs are started again with other parameter values, and with which values."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from ros2lab.assignments import Assignment
from ros2lab.grading.evidence import DOCUMENTED, Files, Run
from ros2lab.grading.judging.periods import is_changed, is_followed
from ros2lab.grading.judging.player import RATE, is_timers
from ros2lab.grading.questions.parameters import setting
from ros2lab.grading.watching.job import Program

# In a README: a program with the rest of its command, the parameters in that, and those that are set later.
_RUN = re.compile(r"\bros2 +run +\S+ +(\S+)((?:\\\n|[^\n`#&|;])*)")
_GIVEN = re.compile(r"(?:-p|--param) +['\"]?(\w[\w.]*:=[^\s'\"]+)")
_SET = re.compile(r"\bros2 +param +set +/?(\S+) +([\w.]+) +([^\s`'\"#&|;]+)")
DOUBTFUL = 1.4  # s or Hz, for a timer parameter whose value is not known


def documented(programs: Sequence[Program], runs: Sequence[Run], facts: Files) -> Iterator[Program]:
    """Yield programs that have publishers and are silent, with the parameters that the README gives them."""
    said = {topic for run in runs for topics in run.stretches for topic in topics}
    for program in programs:
        own = [run for run in runs if run.setting == "alone" and run.programs == [program.name]]
        topics = {topic for run in own for topic in run.publishes}
        nodes = {node.lstrip("/") for run in own for node in run.nodes}
        if not topics or topics & said:
            continue
        run_with = (_GIVEN.findall(rest) for name, rest in _RUN.findall(facts.readme) if name == program.name)
        later = [f"{name}:={value}" for node, name, value in _SET.findall(facts.readme) if node in nodes]
        for given in dict.fromkeys((*map(tuple, run_with), tuple(later))):
            if given:
                yield replace(program, parameters=given, setting=DOCUMENTED)


def changed(programs: Sequence[Program], runs: Sequence[Run], facts: Files) -> Iterator[Program]:
    """Yield programs with another value for each timer parameter; if there is none, for each number.

    A program that does not spin cannot say which parameters it has; for it, those that the code declares are
    tried.
    """
    yield from documented(programs, runs, facts)
    by_name = {program.name: program for program in programs}
    numbers = {
        (run.programs[0], name): number
        for run in runs
        if run.setting == "alone"
        for values in run.parameters.values()
        for name, value in values.items()
        if (number := _positive(value))
    }
    timers = {key: value for key, value in numbers.items() if is_timers(key[1])}
    answered = {name for _, name in numbers}
    timers |= {
        (run.programs[0], name): _positive(value) or DOUBTFUL
        for run in runs
        for name, value in facts.declared.items()
        if run.unasked and is_timers(name) and name not in answered
    }
    for (program, name), value in (timers or numbers).items():
        yield replace(
            by_name[program], parameters=[f"{name}:={_other(value, is_rate=bool(RATE.search(name)))}"]
        )


def doubtful(programs: Sequence[Program], runs: Sequence[Run], facts: Files) -> Iterator[Program]:
    """Yield programs whose rhythm did not follow a parameter, with a value on the other side of their own."""
    by_name = {program.name: program for program in programs}
    alone = {run.programs[0]: run for run in runs if run.setting == "alone"}
    for run in runs:
        name, is_tried, given = run.setting.partition(":=")
        before = alone.get(run.programs[0])
        if not (is_tried and is_timers(name) and before) or run.programs[0] not in by_name:
            continue
        declared = facts.declared.get(name)
        held = [*(values.get(name) for values in before.parameters.values()), declared]
        own = next(filter(None, map(_positive, held)), 0)
        if own and is_changed(before, run) and not is_followed(before, [run], declared):
            value = type(own)(own * 2 if float(given) < own else own / 2)
            if value:
                yield replace(by_name[run.programs[0]], parameters=[f"{name}:={value}"])


def asked(assignment: Assignment, programs: Sequence[Program], runs: Sequence[Run]) -> Iterator[Program]:
    """Yield programs with the value that the assignment asks for, for each parameter that it names.

    For a parameter that is to change messages, also yield them with their own value: what differs then is
    chance.
    """
    by_name = {program.name: program for program in programs}
    wanted = [parameter for part in assignment.parts.values() for parameter in part.parameters]
    for run, parameter in itertools.product(runs, wanted):
        if run.setting != "alone" or run.programs[0] not in by_name:
            continue
        program = by_name[run.programs[0]]
        held = [values[parameter.name] for values in run.parameters.values() if parameter.name in values]
        if held or run.unasked:
            yield replace(program, parameters=[setting(parameter.name, parameter.value, held[:1])])
        if held and parameter.changes == "message":
            yield replace(program, parameters=[setting(parameter.name, held[0])])


def _positive(value: Any) -> float:
    """Return a value if it is a positive number, else 0."""
    return value if isinstance(value, (int, float)) and not isinstance(value, bool) and value > 0 else 0


def _other(value: float, *, is_rate: bool) -> float:
    """Return a value with which a timer fires half as often; twice as often if that takes long to see."""
    is_slow = value <= 1 if is_rate else value >= 1
    if is_slow == is_rate:
        return value * 2
    if isinstance(value, int):
        return value // 2 or 2
    return value / 2
