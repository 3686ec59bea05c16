"""What a terminal shows, command by command: what each has printed, and whether that shows that it did well."""

from __future__ import annotations

import errno
import os
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

_NAMED = r"^(?:\([\w.-]+\) ?)?[\w.-]+@[\w.-]+:[^$\n]*\$ (?=\S)|^[\w.-]+@[\w.-]+:?\S* ?# |^>>> "
_PLAIN = re.compile(r"^[^$\n]{0,60}?\$ (?=\S)")
_PROMPT = re.compile(rf"{_NAMED}|{_PLAIN.pattern}")
# A bare # is root's prompt, and begins a comment: in what `ros2 interface show` prints, or of who wrote the text.
_PROMPT_OF_ROOT = re.compile(rf"{_NAMED}|^# (?=[a-z./])")
AT_REST = re.compile(
    r"^(?:(?:\([\w.-]+\) ?)?[\w.-]+@[\w.-]+:[^$\n]*)?\$\s*$"
)  # a prompt after which nothing was typed
# What the operating system says, with its number.
SYSTEM = {os.strerror(number): number for number in sorted(errno.errorcode)}
TELLING = re.compile(
    rf"(?i){'|'.join(map(re.escape, SYSTEM))}|"
    r"\berror\b|not found|failed|cannot|can't|could not|unable|unknown|no such|invalid|denied|unexpected|\bfatal\b"
)
# What of a line is data, in which any word may stand: a comment, a value, and a name, as of a topic or of a file.
_DATA = re.compile(
    r"(?:^|\s)#.*| value is: .*|\b\w+ ?= ?(?:'[^']*'|\"[^\"]*\"|[^\s,)]+)|(?<!\S)(?=\S*[/_.]\S)[\w./\[\]-]+(?!\S)"
)
OF_MESSAGE = re.compile(r" *(?:- )*[a-z]\w*:(?: (?!error:)|$)| +\S|- ")
# What its tool itself calls a warning: at its beginning, or after the place of which Python or a compiler warns.
LABELLED = re.compile(
    r"^\s*(?:\[[\w.-]+\] )*\[?WARN(?:ING)?\]?(?=[:\s])|^\s*(?:\S+:\d+: ?)?(?:\w*Warning|warning|CMake Warning\b.*):"
)
# How Python prints a warning, at the place that it is about.
WARNING = re.compile(
    r"^(?P<indent>\s*)(?P<file>\S+\.py):(?P<line>\d+): (?P<kind>\w*Warning): (?P<message>.+)"
)
_QUOTED = re.compile(r"'([^']{3,})'|\"([^\"]{3,})\"")
# What Python warns of because it will be otherwise some day.
OF_LATER = re.compile(r"Deprecation|Resource")
_WAITING = re.compile(r"(?i)\bwait(?:ing|s)? for\b|does not appear to be|no publisher")
# How the tools that run others say at their end how these did: colcon, pytest, unittest.
_CLOSING = re.compile(
    r"^\s*(?:Summary: (?P<finished>\d+) packages? finished|\d+ packages? (?P<not>failed|aborted|not processed|had test failures)"
    r"|Summary: \d+ tests?, (?P<errors>\d+) errors?, (?P<failures>\d+) failures?"
    r"|=+ (?P<counts>\d+ \w+.*) in [\d.]+s.* =+$|(?P<ok>OK)(?: \(.*\))?$|(?P<failed>FAILED) \(.*\)$)"
)


_THAT_RUN = (["run"], ["launch"], ["bag"])  # programs, which say what they like, and do not ask


@dataclass(frozen=True)
class Step:
    """A command with what it has printed.

    Attributes:
        command: what was typed; empty for what stands before the first prompt.
        lines: what was printed below it.
    """

    command: str
    lines: tuple[str, ...]

    @property
    def text(self) -> str:
        """Everything that it has printed."""
        return "\n".join(self.lines)

    @property
    def is_answered(self) -> bool:
        """Whether it got at last what it asked for: something was printed, and no complaint came after it."""
        said = [line for line in self.lines if line.strip() and not line.startswith(("^C", "#"))]
        return bool(said) and not is_complaint(said[-1])

    @property
    def is_answer(self) -> bool:
        """Whether all that was printed is what a command of ros2 was asked for: words of the graph, and none of a tool."""
        words = self.command.split()
        return words[:1] == ["ros2"] and words[1:2] not in _THAT_RUN and self.is_answered

    @property
    def ended_well(self) -> bool:
        """Whether a tool said at its end that everything did well."""
        closings = [match for line in self.lines if (match := _CLOSING.match(line))]
        return bool(closings) and all(map(_is_good, closings))


def unsettled(steps: Sequence[Step]) -> list[Step]:
    """Return the steps without those whose command was typed again later, and was answered then."""
    answered = {step.command: number for number, step in enumerate(steps) if step.is_answer}
    return [step for number, step in enumerate(steps) if number >= answered.get(step.command, 0)]


def harmless_lines(steps: Sequence[Step]) -> set[str]:
    """Return the lines that are no complaint, whatever their words: answers, what was typed, and all but warnings of what ended well."""
    found: set[str] = set()
    left = unsettled(steps)
    for step in steps:
        if step.is_answer or step not in left:
            found.update(step.lines)
            continue
        quoted = [one or other for one, other in _QUOTED.findall(step.command)]
        for line in step.lines:
            rest = line
            for text in quoted:
                rest = rest.replace(text, "")
            is_echo = rest != line and not TELLING.search(rest)
            if is_echo or (step.ended_well and not LABELLED.match(line)):
                found.add(line)
    return found


def prompt_in(lines: Iterable[str]) -> re.Pattern[str]:
    """Return how the prompts of a text look."""
    return _PROMPT if any(map(_PLAIN.match, lines)) else _PROMPT_OF_ROOT


def steps_of(lines: Sequence[str]) -> list[Step]:
    """Take what a terminal shows apart at its prompts."""
    shown = prompt_in(lines)
    steps = [("", list[str]())]
    for line in lines:
        if prompt := shown.match(line):
            steps.append((line[prompt.end() :].strip(), []))
        elif not AT_REST.match(line):
            steps[-1][1].append(line)
    return [Step(command, tuple(printed)) for command, printed in steps]


def step_with(line: str, steps: Sequence[Step]) -> Step:
    """Return the step that has printed a line; the last one if that is not known."""
    wanted = line.strip()
    found = (step for step in reversed(steps) if any(wanted in one for one in step.lines))
    return next(found, steps[-1] if steps else Step("", ()))


def is_complaint(line: str) -> bool:
    """Return whether a line says that something is wrong, warns of it, or only waits."""
    if LABELLED.match(line) or _WAITING.search(line):
        return True
    if says_well(line):
        return False
    return is_telling(line) and not OF_MESSAGE.match(line)


def is_telling(line: str) -> bool:
    """Return whether the words of a line, without its data, say that something is wrong."""
    return TELLING.search(line) is not None and TELLING.search(without_data(line)) is not None


def without_data(line: str) -> str:
    """Return the words of a line in which its tool itself speaks."""
    return _DATA.sub(" ", line).strip()


def says_well(line: str) -> bool:
    """Return whether a line is one with which a tool says at its end that everything did well."""
    closing = _CLOSING.match(line)
    return closing is not None and _is_good(closing)


def _is_good(closing: re.Match[str]) -> bool:
    if closing["counts"]:
        return re.search(r"\b[1-9]\d* (?:failed|errors?)\b", closing["counts"]) is None
    if closing["finished"]:
        return int(closing["finished"]) > 0
    return not (
        closing["not"] or closing["failed"] or int(closing["errors"] or 0) or int(closing["failures"] or 0)
    )
