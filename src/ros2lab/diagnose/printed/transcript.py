"""Parse what a terminal shows: the output of each command, and whether the command succeeded or ros2 refused it."""

from __future__ import annotations

import ast
import errno
import os
import re
import shlex
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from ros2lab.diagnose.sources.joined_texts import text_pattern

_NAMED = r"^(?:\([\w.-]+\) ?)?[\w.-]+@[\w.-]+:[^$\n]*\$ (?=\S)|^[\w.-]+@[\w.-]+:?\S* ?# |^>>> "
_PLAIN = re.compile(r"^[^$\n]{0,60}?\$ (?=\S)")
_PROMPT = re.compile(rf"{_NAMED}|{_PLAIN.pattern}")
# A bare # is root's prompt, but also begins a comment, as in the output of `ros2 interface show`.
_PROMPT_OF_ROOT = re.compile(rf"{_NAMED}|^# (?=[a-z./])")
AT_REST = re.compile(
    r"^(?:(?:\([\w.-]+\) ?)?[\w.-]+@[\w.-]+:[^$\n]*)?\$\s*$"
)  # a prompt after which nothing was typed
# The messages of the operating system, with their error numbers.
SYSTEM = {os.strerror(number): number for number in sorted(errno.errorcode)}
TELLING = re.compile(
    rf"(?i){'|'.join(map(re.escape, SYSTEM))}|"
    r"\berror\b|not found|failed|cannot|can't|could not|unable|unknown|no such|invalid|not a valid identifier|denied|unexpected|\bfatal\b"
)
# The parts of a line that are data and may hold any word: comments, values, and names of topics or files.
_DATA = re.compile(
    r"(?:^|\s)#.*| value is: .*|\b\w+ ?= ?(?:'[^']*'|\"[^\"]*\"|[^\s,)]+)|(?<!\S)(?=\S*[/_.]\S)[\w./\[\]-]+(?!\S)"
)
OF_MESSAGE = re.compile(r" *(?:- )*[a-z]\w*:(?: (?!error:)|$)| +\S|- ")
# A line that a tool labels as a warning, at its beginning or after the place that the warning is about.
LABELLED = re.compile(
    r"^\s*(?:\[[\w.-]+\] )*\[?WARN(?:ING)?\]?(?=[:\s])|^\s*(?:\S+:\d+: ?)?(?:\w*Warning|warning|CMake Warning\b.*):"
)
# How Python prints a warning, with its place.
WARNING = re.compile(
    r"^(?P<indent>\s*)(?P<file>\S+\.py):(?P<line>\d+): (?P<kind>\w*Warning): (?P<message>.+)"
)
_QUOTED = re.compile(r"'([^']{3,})'|\"([^\"]{3,})\"")
# Warnings about what a later release will change, or about resources.
OF_LATER = re.compile(r"^\w*(?:Deprecation|Resource)|(?i:\bdeprecated\b)")
# What rcl prints of a line that is logged after Ctrl-C: the terminal shows that line all the same.
_LOGGED_LAST = re.compile(r"Failed to publish log message to rosout: publisher's context is invalid")
_WAITING = re.compile(r"(?i)\bwait(?:ing|s)? for\b|does not appear to be|no publisher")
# The last line of colcon, pytest and unittest, which says how many succeeded or failed.
_CLOSING = re.compile(
    r"^\s*(?:Summary: (?P<finished>\d+) packages? finished|\d+ packages? (?P<not>failed|aborted|not processed|had test failures)"
    r"|Summary: \d+ tests?, (?P<errors>\d+) errors?, (?P<failures>\d+) failures?"
    r"|=+ (?P<counts>\d+ \w+.*) in [\d.]+s.* =+$|(?P<ok>OK)(?: \(.*\))?$|(?P<failed>FAILED) \(.*\)$)"
)


_THAT_RUN = (["run"], ["launch"], ["bag"])  # verbs that start programs, which may print anything


@dataclass(frozen=True)
class Step:
    """A command, empty before the first prompt, with what was printed below it."""

    command: str
    lines: tuple[str, ...]

    @property
    def text(self) -> str:
        """Its whole output."""
        return "\n".join(self.lines)

    @property
    def is_answered(self) -> bool:
        """Whether the command got an answer in the end: its last line of output is no complaint."""
        said = [line for line in self.lines if line.strip() and not line.startswith(("^C", "#"))]
        return bool(said) and not is_complaint(said[-1])

    @property
    def is_answer(self) -> bool:
        """Whether the output answers a ros2 command that queries the graph, and is no program's log."""
        words = self.command.split()
        return words[:1] == ["ros2"] and words[1:2] not in _THAT_RUN and self.is_answered

    @property
    def ended_well(self) -> bool:
        """Whether a tool said in the end that everything succeeded."""
        closings = [match for line in self.lines if (match := _CLOSING.match(line))]
        return bool(closings) and all(map(_is_good, closings))


def unsettled(steps: Sequence[Step]) -> list[Step]:
    """Return the steps without those whose command was typed again later and was answered then."""
    answered = {step.command: number for number, step in enumerate(steps) if step.is_answer}
    return [step for number, step in enumerate(steps) if number >= answered.get(step.command, 0)]


def harmless_lines(steps: Sequence[Step]) -> set[str]:
    """Return the lines that are no complaints, whatever their words.

    They are answers, echoes of what was typed, what follows from logging after Ctrl-C, and all lines but warnings of a
    command that succeeded.
    """
    found: set[str] = set()
    left = unsettled(steps)
    for step in steps:
        if step.is_answer or step not in left:
            found.update(step.lines)
            continue
        quoted = [single or double for single, double in _QUOTED.findall(step.command)]
        for line in step.lines:
            rest = line
            for text in quoted:
                rest = rest.replace(text, "")
            is_echo = rest != line and not TELLING.search(rest)
            if is_echo or _LOGGED_LAST.match(line) or (step.ended_well and not LABELLED.match(line)):
                found.add(line)
    return found


def words_in(command: str) -> list[str]:
    """Return the words of a command as a shell parts them; none if a quote is left open."""
    try:
        return shlex.split(command)
    except ValueError:
        return []


def prompt_in(lines: Iterable[str]) -> re.Pattern[str]:
    """Return the pattern of the prompts in a text."""
    return _PROMPT if any(map(_PLAIN.match, lines)) else _PROMPT_OF_ROOT


def steps_of(lines: Sequence[str]) -> list[Step]:
    """Split what a terminal shows at its prompts."""
    shown = prompt_in(lines)
    steps = [("", list[str]())]
    for line in lines:
        if prompt := shown.match(line):
            steps.append((line[prompt.end() :].strip(), []))
        elif not AT_REST.match(line):
            steps[-1][1].append(line)
    return [Step(command, tuple(printed)) for command, printed in steps]


def step_with(line: str, steps: Sequence[Step]) -> Step:
    """Return the last step that printed a line; the last step of all if none did."""
    wanted = line.strip()
    found = (step for step in reversed(steps) if any(wanted in printed for printed in step.lines))
    return next(found, steps[-1] if steps else Step("", ()))


def is_complaint(line: str) -> bool:
    """Return whether a line reports an error, warns, or only waits for something."""
    if LABELLED.match(line) or _WAITING.search(line):
        return True
    if says_well(line):
        return False
    return is_telling(line) and not OF_MESSAGE.match(line)


def is_telling(line: str) -> bool:
    """Return whether the words of a line, without its data, say that something is wrong, or ros2 refuses with them."""
    is_so = TELLING.search(line) and TELLING.search(without_data(line))
    return bool(is_so) or is_refusal(line)  # which reads ros2's source, once


def without_data(line: str) -> str:
    """Return a line without the data in it: what remains are the tool's own words."""
    return _DATA.sub(" ", line).strip()


def says_well(line: str) -> bool:
    """Return whether a line is the last one of a tool, and says that everything succeeded."""
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


def is_refusal(line: str) -> bool:
    """Return whether a line is, or begins with, a sentence with which ros2 ends in vain."""
    return _sentences().match(line) is not None


@cache
def _sentences() -> re.Pattern[str]:
    import portable_ros2

    files = Path(portable_ros2.__file__).parent.rglob("*.py")
    said = [text_pattern(given) for file in files for given in _said(ast.parse(file.read_bytes()))]
    firsts = {pattern.removeprefix("\\\n").partition("\\\n")[0] for pattern in said}
    # What is joined to the last word are the words of somebody else: a node says why it refuses a parameter.
    own = (first for first in firsts if not re.search(r"[A-Za-z]\.\*$", first))
    return re.compile("|".join(sorted(first for first in own if len(re.findall(r"[A-Za-z]{2,}", first)) > 1)))


def _said(tree: ast.AST) -> Iterator[ast.expr]:
    """Yield what an exception is made of, what a verb returns for the standard error, and what it writes there."""
    for node in ast.walk(tree):
        match node:
            case ast.Raise(exc=ast.Call(args=given)) | ast.arguments(defaults=given):
                yield from given
            case ast.Call(func=ast.Attribute(attr="__init__"), args=given):
                yield from given
            case ast.Call(func=ast.Name(id="print"), args=given, keywords=[ast.keyword(arg="file"), *_]):
                yield from given
            case ast.FunctionDef(returns=ast.BinOp()):
                yield from (n.value for n in ast.walk(node) if isinstance(n, ast.Return) and n.value)
