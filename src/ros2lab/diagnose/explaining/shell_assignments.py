"""Assignments that a shell refuses: blanks beside the sign, or what is no name before it."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from pathlib import Path

from ros2lab.diagnose.finding import SAID, Finding, at, shown_path
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.transcript import Step, words_in
from ros2lab.diagnose.sources.python_source import read_text

# Before a command, `NAME= command` is right: it sets the variable to nothing for that command.
_SPACED = re.compile(
    r"(?P<head>\s*(?P<tool>(?:export|declare|typeset|readonly|local|alias)(?: +-\w+)* +)?(?P<name>[A-Za-z_]\w*))"
    r"(?: +=(?!=) *|(?(tool)= +|(?!)))(?P<value>[\"'][^\"']*[\"']|[^\s=#&;|<>\"'][^#&;|<>\"']*?)(?: +#.*)?"
)
_REFUSED = re.compile(
    r"(?:\S*sh: )?(?:(?P<file>[^\s:]+): (?:line )?(?P<line>\d+): )?"
    r"(?:(?P<tool>\w+): [`'](?P<word>.*)': not a valid identifier|(?:alias: )?(?P<name>\S+): (?:command )?not found)$"
)


def without_blanks(statement: str) -> tuple[str, str] | None:
    """Return an assignment without the blanks beside its sign, and what is wrong with it; None if it has none there."""
    spaced = _SPACED.fullmatch(statement.rstrip())
    if spaced is None:
        return None
    export = "export " if not spaced["tool"] and spaced["name"].isupper() else ""
    cause = f"In a shell, no blank stands before or after the = of an assignment, so `{statement.strip()}` does not give {spaced['name']} its value."
    value = spaced["value"]
    value = shlex.quote(value) if " " in value and value[0] not in "\"'" else value
    return f"{export}{spaced['head'].lstrip()}={value}", cause


def of_assignment(line: str, step: Step, look: Look) -> Finding | None:
    """Say which assignment a shell refuses with a line, in a script or as it was typed; None if the line says something else."""
    refused = _REFUSED.match(line)
    if refused is None:
        return None
    word = refused["word"] or refused["name"] or ""
    for place, statement in _statements(refused, step, look):
        if word in statement and (better := without_blanks(statement)):
            return Finding(SAID, better[1], place, f"{'write' if place else 'type'} `{better[0]}`")
    if refused["name"]:
        return None
    cause = (
        f"{refused['tool']} takes a name, or a name and its value, but {word!r} does not begin with a name."
    )
    fix = "write NAME=value, without a blank beside the = and without a $ before the name, which has only letters, digits and _"
    place = f"{refused['file'].removeprefix('./')}:{refused['line']}" if refused["file"] else ""
    return Finding(SAID, cause, place, fix)


def _statements(refused: re.Match[str], step: Step, look: Look) -> Iterator[tuple[str, str]]:
    """Yield what a shell may have read when it refused something: what was typed, and the lines of a script, each with its place."""
    yield "", step.command
    if not look:
        return
    for name in (refused["file"], *words_in(step.command)[1:]):
        path = look.root / Path(name or ".").expanduser()
        for number, text in enumerate(read_text(path).splitlines() if path.is_file() else (), 1):
            if refused["line"] in (None, str(number)):
                yield at(shown_path(path, look.root), number), text
