"""Environment variables that a program reads, and what was typed in its terminal to set them."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.sources.spelling import nearest

_SET = re.compile(
    r"(?:^|[;&] *)(?P<export>export +|declare -x +|)(?P<name>[A-Za-z_]\w*)=(?P<value>\"[^\"]*\"|'[^']*'|[^\s;&]*)"
    r"(?= *(?:$|[;&]))"
)
_MISSET = re.compile(r"^(?:set +|setenv +|\$)?(?P<name>[A-Za-z_]\w*)(?: *= *| +)(?P<value>[^\s;&]+)$")
_KEPT = re.compile(r"export +(?P<name>[A-Za-z_]\w*)=(?P<value>[^\s'\";]*)['\"]? *>> *(?P<file>\S*\.\w+)")
_OTHER_TERMINAL = re.compile(r"(?i)\bterminal\b|\btab\b|\bwindow\b|\bfenster\b")


def of_variable(name: str, place: str, error: ErrorText) -> Finding:
    """Return a finding about why a program does not see a variable, and what to type so that it does."""
    # A student's note such as `# terminal 2` is no command, but tells where the next one was typed.
    shown = [line for step in error.steps for line in (step.command, *step.lines)]
    typed = _before_the_program([line for line in shown if line in error.typed or line.startswith("#")])
    for line in reversed(typed):
        if told := _of_line(line, name, typed):
            cause, command = told
            return Finding("typed-wrong", cause, "", f"type `{command}`, then start the program again")
    set_there = {
        match["name"]: match["value"] for line in typed for match in _SET.finditer(line) if match["export"]
    }
    if near := nearest(name, set_there, 0.7):
        cause = f"The program reads the variable {name}, but {near} was set: the names differ."
        command = f"export {name}={set_there[near]}"
        return Finding("typed-wrong", cause, place, f"type `{command}`, then start the program again")
    cause = f"The variable {name} is not set in the terminal where the program was started."
    fix = f"type `export {name}=...`, with its value, in that terminal, then start the program again"
    return Finding("typed-wrong", cause, place, fix)


def _before_the_program(typed: Sequence[str]) -> list[str]:
    """Return what was typed before the last program was started; everything if none was."""
    starts = [n for n, line in enumerate(typed) if re.search(r"\bros2 (?:run|launch)\b|\bpython3? \S", line)]
    return [*typed[: starts[-1] + 1]] if starts else [*typed]


def _of_line(line: str, name: str, typed: Sequence[str]) -> tuple[str, str] | None:
    """Return why a typed line does not set a variable, and the command that does; None if it is unrelated."""
    if re.match(rf"unset +(?:-v +)?{name}\b", line):
        return f"`{line}` removes the variable {name}.", f"export {name}=..."
    if (kept := _KEPT.search(line)) and kept["name"] == name:
        cause = f"`{line}` takes effect only in terminals opened from then on, not in this one."
        return cause, f"source {kept['file']}"
    for match in _SET.finditer(line):
        if match["name"] != name:
            continue
        command = f"export {name}={match['value']}"
        after = typed[len(typed) - 1 - [*reversed(typed)].index(line) :]
        if not match["export"]:
            cause = f"`{match[0].strip('; &')}` sets {name} only for the shell: the programs it starts see only exported variables."
            return cause, command
        if any(_OTHER_TERMINAL.search(later) for later in after):
            cause = f"`{command}` applies only to the terminal where it was typed, but the program was started in another one."
            return cause, command
    if (misset := _MISSET.match(line)) and misset["name"] == name:
        return f"`{line}` sets no variable of that name in this shell.", f"export {name}={misset['value']}"
    return None
