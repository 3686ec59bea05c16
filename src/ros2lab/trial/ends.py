"""Explains why programs ended while they were watched: alone, or because of what others sent."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ros2lab.diagnose import of_text
from ros2lab.diagnose.finding import UNKNOWN, Finding
from ros2lab.diagnose.printed.error_text import read_error
from ros2lab.diagnose.printed.spots import Spot, spot_of
from ros2lab.diagnose.sources.python_source import parameters
from ros2lab.grading.evidence import Run
from ros2lab.grading.judging.player import finds_no_keyboard
from ros2lab.trial.failing import with_values

UNKNOWN_WORD = "dance"  # means nothing to any robot

if TYPE_CHECKING:
    from ros2lab.trial.seen import Seen


def ended_together(seen: Seen) -> Iterator[Finding]:
    """Explain the exceptions that ended programs only when the others ran, too.

    A callback may fail because of a message or a service call from another program.
    """
    told = {
        run.programs[0]
        for run in seen.alone
        if is_told_alone(seen, run) and read_error(run.ended[run.programs[0]]).reports
    }
    for run in seen.together:
        word = word_that_ended(run)
        if word is None or word in made(seen):
            for name in run.ended:
                yield from explained(seen, run, name) if name not in told else ()


def is_told_alone(seen: Seen, run: Run) -> bool:
    """Return whether a program ended alone, and neither because of our commands nor for lack of a service."""
    is_ended = bool(run.ended.get(run.programs[0]))
    return is_ended and not _is_of_words_of_ours(seen, run) and not needs_others(seen, run)


def word_that_ended(run: Run) -> str | None:
    """Return the command after which a program of a run failed; None if no command led to a failure."""
    return next(
        (
            command.text
            for command in run.commands
            if not command.is_alive and any(text.startswith("Traceback") for _, text in command.log)
        ),
        None,
    )


def _is_of_words_of_ours(seen: Seen, run: Run) -> bool:
    """Return whether a program ended only because of a command that no node of the workspace sends."""
    is_fed = any(run.commanded in other_run.publishes for other_run in seen.alone)
    word = word_that_ended(run)
    ends = [other_run for other_run in seen.together if run.programs[0] in other_run.ended]
    is_ours = word is not None and word not in made(seen) and None not in map(word_that_ended, ends)
    return (is_fed and (is_ours or not ends)) or _is_refused(seen, run)


def _is_refused(seen: Seen, run: Run) -> bool:
    """Return whether a program ended because it does not take a text that means nothing: for its value, or on purpose."""
    report = read_error(run.ended.get(run.programs[0]) or "").report
    if report is None or word_that_ended(run) != UNKNOWN_WORD:
        return False
    spot = spot_of(report, seen.look)
    given = {parameter.arg for parameter in parameters(spot.function)} - {"self"} if spot.function else set()
    is_of_given = any(getattr(node, "id", "") in given for node in _behind(spot))
    kind = getattr(builtins, report.kind, ValueError if report.kind == "JSONDecodeError" else None)
    is_of_value = isinstance(kind, type) and issubclass(kind, (ValueError, IndexError)) and is_of_given
    is_raised = any(isinstance(node, ast.Raise) for node in spot.nodes)
    return is_raised or is_of_value or (kind is KeyError and UNKNOWN_WORD in report.message)


def _behind(spot: Spot) -> Iterator[ast.AST]:
    """Yield the syntax nodes of a line's statement, and of the values of the names in it."""
    yield from spot.whole
    for node in spot.whole:
        if isinstance(node, (ast.Name, ast.Attribute)):
            yield from (inner for value in spot.assigned(ast.unparse(node)) for inner in ast.walk(value))


def needs_others(seen: Seen, run: Run) -> bool:
    """Return whether a program calls services, so that its run together with the others counts."""
    return "create_client" in seen.names(run) and bool(seen.together)


def explained(seen: Seen, run: Run, name: str) -> Iterator[Finding]:
    """Explain the exception that ended a program; ending with a message of its own is no fault."""
    said = run.ended[name]
    if not read_error(said).reports or finds_no_keyboard(said) or lacks_arguments(seen, said):
        return  # nobody types while a program is watched
    if explained := [found for found in of_text(said, seen.look.root) if found.code != UNKNOWN]:
        yield with_values(explained[0], seen.errors)
        return
    word = word_that_ended(run)
    when = "by itself" if word is None else f"when {word!r} comes on {run.commanded}"
    last = said.strip().splitlines()[-1]
    yield Finding("program-ends", f"The program {name} ends {when}: {last}", seen.main(name))


def lacks_arguments(seen: Seen, said: str) -> bool:
    """Return whether a program failed in a line about its arguments, of which it is given none while it is watched."""
    spot = spot_of(read_error(said).report, seen.look)
    return any(getattr(node, "attr", getattr(node, "id", "")) == "argv" for node in _behind(spot))


def made(seen: Seen) -> set[str]:
    """Return the strings that the code uses other than in comparisons: they may be states."""
    nodes = [n for p in seen.look.packages for s in p.sources.values() for n in s.nodes]
    compares = [n for n in nodes if isinstance(n, (ast.Compare, ast.match_case))]
    keys = [key for n in nodes if isinstance(n, ast.Dict) for key in n.keys if key]
    compared = {id(inner) for n in (*compares, *keys) for inner in ast.walk(getattr(n, "pattern", n))}
    return {
        n.value
        for n in nodes
        if isinstance(n, ast.Constant) and isinstance(n.value, str) and id(n) not in compared
    }
