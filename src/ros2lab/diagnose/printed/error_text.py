"""Parse what a failed command printed: which errors, of which kind, and where."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import PurePath
from typing import BinaryIO

from ros2lab.build_text import first_error
from ros2lab.diagnose.printed.ignored import without_ignored
from ros2lab.diagnose.printed.transcript import (
    LABELLED,
    OF_LATER,
    WARNING,
    Step,
    harmless_lines,
    is_telling,
    prompt_in,
    says_well,
    steps_of,
)

_MOST_QUOTED = 30  # lines of a command
MOST_READ = 100_000  # characters of output

# What a tool, launch or a logger puts before its message.
PREFIX = re.compile(
    r"^(?:\[[\w.-]+\]:? )*(?:\[?[\d.]+s?\]? )?(?:WARNING|ERROR|Error(?=:)|E(?= )|fatal)?(?::[\w.]+)?:? ?"
)
# Colours and titles of a terminal, and the boxes that click's rich errors stand in.
_ESCAPES = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]|\x1b\][^\x07]*\x07|\r|^[╭╰]─.*[╮╯]$|^│ | *│$", re.M)
_FRAME = re.compile(r'^\s*File "(?P<file>[^"]+)", line (?P<line>\d+)(?:, in (?P<function>\S+))?')
_CELL_FRAME = re.compile(
    r"^(?:File (?P<file>\S+?):(?P<line>\d+)|Cell In\s*\[(?P<cell>\d+)\], line (?P<cell_line>\d+))"
)
_EXCEPTION = re.compile(
    r"^(?:E +| - )?(?P<kind>(?:[A-Za-z_]\w*\.)*[A-Za-z_]\w*(?:Error|Exception|Interrupt|Exit))(?::\s?(?P<message>.*))?$"
)
# Some exceptions have other names, such as StopIteration: the line after the frames of a traceback is one.
_OTHER_EXCEPTION = re.compile(r"(?P<kind>[A-Za-z_][\w.]*)(?::\s(?P<message>.*))?$")
# What is printed when nothing is wrong: progress, messages, names, separators and Ctrl-C.
_OF_COURSE = re.compile(
    r"Starting >>>|Finished <<<|\[WARNING\] \[launch\]: user interrupted|\[ERROR\] \[[\w.-]+\]: process has died .*exit code -2\b|\S+\.xml: \d+ tests?, |Set parameter successful|Failed to publish log message to rosout|\w+ value is: |Summary:|\[(?:INFO|DEBUG)\]|\[ros2run\]: |(?:\w+: )?(?!\w*thing\b)\w+ing (?:#|\w+$|loop)"
)
# What the student's own program logs: it may lead to a finding, but no tool printed it.
_OWN_LOG = re.compile(r"\[(?:WARN|ERROR|FATAL)\] \[\d+\.\d+\] \[(?!rcl|rmw|ros2)[\w./]+\]: ")
_IN_ORDER = re.compile(r"\s*(?:- )?[a-z_/]+:(?: .*)?$|/[\w/]+(?: \[[\w/]+\])?$|\W*$")
_OF_MESSAGE = re.compile(r" *(?:- )*[a-z]\w*:(?: |$)| +\S|- ")
_HARDLY_MEANT = re.compile(r"[:-] -?(?:\.?nan|\.?inf|\d(?:\.\d+)?e-3\d\d)$")  # as a value in a message
_PROCESS = re.compile(r"^\[[\w.]+-\d+\] ")
_NAMED = re.compile(r"\((?P<file>[^\s()]+\.py), line (?P<line>\d+)\)$")
# What a program raises when it is ended from outside; nothing is wrong then.
_ENDED = frozenset(("KeyboardInterrupt", "ExternalShutdownException"))
_INTERRUPTED = re.compile(r"^\^C|user interrupted with ctrl-c")
_WRAPPED = re.compile(r"Invalid(?:Frontend)?LaunchFileError$")  # launch says why in the line above
_COMMAND = re.compile(r"\bros2 (?P<verb>run|launch) (?:-\S+ )*(?P<package>[\w.-]+) (?P<what>[\w./-]+)")
_STARTS = re.compile(r"load_entry_point|next\(matches\)\.load")  # the lines of a script that setuptools makes
_INSTALLED = re.compile(
    r"/(?:site|dist)-packages/(?!.*/)|^<(?:frozen|string)|/\.?venv/|/lib/python3[\d.]*/(?!site-packages|dist-packages)"
)


@dataclass(frozen=True)
class Frame:
    """One frame of a traceback, with the part of the line that Python marks and its text, if they were printed."""

    file: str
    line: int
    part: str = ""
    text: str = ""

    @property
    def is_in(self) -> str:
        """The file name with its folder name, which a file shares with its installed copy."""
        return "/".join(PurePath(self.file).parts[-2:])


@dataclass(frozen=True)
class ErrorReport:
    """One error: the class of the exception without its module, if it is one, and its frames, the innermost last."""

    kind: str
    message: str
    frames: tuple[Frame, ...] = ()

    @property
    def line(self) -> str:
        """The line that states the error, such as `KeyError: 'name'`."""
        return f"{self.kind}: {self.message}".removesuffix(": ") if self.kind else self.message


@dataclass(frozen=True)
class ErrorText:
    """A parsed error text.

    Attributes:
        text: the text, without colours.
        reports: its exceptions, those of the first traceback first.
        decisive: the line that best says what went wrong; empty if the text is empty.
        is_clear: whether the words of that line say that something went wrong.
        steps: the commands typed after prompts, in order, each with its output.
        command: the last `ros2 run` or `ros2 launch` in it, as (verb, package, executable or file).
    """

    text: str
    reports: tuple[ErrorReport, ...]
    decisive: str
    is_clear: bool
    command: tuple[str, str, str] | None
    steps: tuple[Step, ...] = ()

    @property
    def report(self) -> ErrorReport | None:
        """The exception that decides: the last one; None if there is none."""
        return self.reports[-1] if self.reports else None

    @property
    def own(self) -> list[Frame]:
        """The frames of the student's files in the exception that decides, the innermost first."""
        return own_frames(self.report.frames) if self.report else []

    @property
    def typed(self) -> tuple[str, ...]:
        """The commands that were typed, in order."""
        return tuple(step.command for step in self.steps if step.command)

    @property
    def frames(self) -> tuple[Frame, ...]:
        """The frames of all exceptions."""
        return tuple(frame for report in self.reports for frame in report.frames)


def read_printed(stream: BinaryIO) -> str:
    """Return the output of a command; if it is very long, only its beginning and end."""
    begin, end = stream.read(MOST_READ), b""
    while part := stream.read(MOST_READ):
        end = (end + part)[-MOST_READ:]
    return (begin + end).decode(errors="replace")


def commands_with_output(text: str) -> list[tuple[str, list[str]]]:
    """Return each command typed after a prompt, with the lines printed up to the next prompt."""
    steps = steps_of(_with_whole_quotes(_ESCAPES.sub("", text[-MOST_READ:]).splitlines()))
    return [(step.command, [*step.lines]) for step in steps if step.command]


_TRIED = re.compile(r"when trying to load file of format \[\w+\]:$")


def read_error(text: str) -> ErrorText:
    """Parse an error text; if it is very long, only its beginning and end."""
    if len(text) > MOST_READ:
        text = f"{text[: MOST_READ // 2]}\n{text[-MOST_READ // 2 :]}"
    lines = _with_whole_quotes(_ESCAPES.sub("", text).splitlines())
    commands = [match for line in lines if (match := _COMMAND.search(line))]
    last = commands[-1] if commands else None
    steps = steps_of(lines)
    lines = [line for step in steps for line in step.lines]
    told = without_ignored(lines)
    lines = _of_its_own_format(told if any(_reports(told)) else lines)
    lines = _of_one_process_each(_before_ctrl_c(lines))
    reports: list[ErrorReport] = []
    said: list[str] = []  # all lines but the tracebacks of programs that were only ended from outside
    start = 0
    for end, report in _reports(lines):
        if report.kind not in _ENDED:
            said += lines[start:end]
            reports.append(report)
        else:
            headers = [n for n in range(start, end) if lines[n].startswith("Traceback")]
            said += lines[start : headers[0]] if headers else []
        start = end
    said = _without_messages([*said, *lines[start:]])
    # The last report is the decisive one: not a warning, and not a traceback of colcon or launch themselves.
    reports.sort(key=_decides)
    harmless = harmless_lines(steps)
    judged = [line for line in said if line not in harmless]
    decisive, is_clear = (reports[-1].line, True) if reports else _decisive(judged)
    command = (last["verb"], last["package"], last["what"]) if last else None
    return ErrorText("\n".join(said), tuple(reports), decisive, is_clear, command, tuple(steps))


def _decides(report: ErrorReport) -> tuple[bool, bool, bool]:
    """Return how much an exception tells: one that only passes on another tells least."""
    is_own = bool(own_frames(report.frames))
    return not _WRAPPED.match(report.kind), not report.kind.endswith("Warning"), is_own


def _without_messages(lines: Sequence[str]) -> list[str]:
    """Leave out the messages that `ros2 topic echo` prints, as YAML followed by `---`: only their values may be errors.

    colcon, too, ends the output of a package with `---`, but begins it with a line such as `--- stderr`.
    """
    found: list[str] = []
    is_of_colcon = False
    for line in lines:
        if line.strip() != "---" or is_of_colcon:
            is_of_colcon = line.startswith("--- ") or (is_of_colcon and line.strip() != "---")
            found.append(line)
            continue
        odd: list[str] = []
        while found and _OF_MESSAGE.match(found[-1]):
            value = found.pop()
            odd += [value] if _HARDLY_MEANT.search(value) else []
        found += reversed(odd)
    return found


def _of_its_own_format(lines: Sequence[str]) -> list[str]:
    """Leave out why launch could not read a file in the formats that it tries after the first."""
    found: list[str] = []
    tried = -1  # the number of reasons so far; negative outside such a list
    for line in lines:
        tried = 0 if _TRIED.search(line) else tried + 1 if tried >= 0 and line.startswith(" - ") else -1
        if tried < 2:
            found.append(line)
    return found


def _with_whole_quotes(lines: Sequence[str]) -> list[str]:
    """Join the lines of a command whose quote is closed on a later line; a shell shows `> ` before those."""
    found: list[str] = []
    left, shown = list(lines), prompt_in(lines)
    while left:
        line = left.pop(0)
        prompt = shown.match(line)
        quote = re.search(
            r"^[^'\"]*(?:'[^']*'[^'\"]*|\"[^\"]*\"[^'\"]*)*(['\"])[^'\"]*$",
            line[prompt.end() :] if prompt else "",
        )
        end = next(
            (n for n, following in enumerate(left[:_MOST_QUOTED]) if quote and quote[1] in following), None
        )
        if end is not None and not any(shown.match(following) for following in left[: end + 1]):
            line = "\n".join([line, *(following.removeprefix("> ") for following in left[: end + 1])])
            del left[: end + 1]
        found.append(line)
    return found


def _before_ctrl_c(lines: list[str]) -> list[str]:
    """Return what was printed before Ctrl-C if it says what went wrong; otherwise everything but the ^C."""
    end = next((n for n, line in enumerate(lines) if _INTERRUPTED.search(line)), len(lines))
    before, lines = lines[:end], [line.removeprefix("^C") for line in lines]
    return before if _decisive(before)[1] or any(_reports(before)) else lines


def _of_one_process_each(lines: Sequence[str]) -> list[str]:
    """Group the output of a launch by process, without the name of the process."""
    parts: dict[str, list[str]] = {}
    for line in lines:
        process = _PROCESS.match(line)
        parts.setdefault(process[0] if process else "", []).append(line[process.end() if process else 0 :])
    return [line for part in parts.values() for line in part]


def _reports(lines: Sequence[str]) -> Iterator[tuple[int, ErrorReport]]:
    """Yield each exception, with the number of the line after it."""
    frames: list[Frame] = []
    is_traceback = False
    package = ""
    for number, line in enumerate(lines):
        is_pytests = line.startswith("E  ")
        line = line.removeprefix("E  ").lstrip() if is_pytests else line  # noqa: PLW2901 -- pytest's mark
        frame = _frame(line, lines[number + 1 : number + 3], package, frames)
        exception = _EXCEPTION.match(line) or (is_traceback and _OTHER_EXCEPTION.match(line))
        if line.startswith("Traceback (most recent call last)"):
            frames, is_traceback = [], True
        elif line.startswith("Starting >>> "):
            package = line.split()[2]
        elif (
            (warned := WARNING.match(line))
            and not (warned["indent"] or OF_LATER.search(f"{warned['kind']}: {warned['message']}"))
            and own_frames([spot := Frame(warned["file"], int(warned["line"]))])
        ):
            yield number + 1, ErrorReport(warned["kind"], warned["message"], (spot,))
        elif frame:
            frames.append(frame)
        elif exception:
            kind = exception["kind"].rpartition(".")[2]
            message = _whole_message(exception["message"] or "", lines[number + 1 :])
            frames = frames or _named_places(message, lines[number + 1 : number + 4] if is_pytests else ())
            yield number + 1, ErrorReport(kind, message, tuple(_up_to_repeated(frames, kind)))
            frames, is_traceback = [], False


def _up_to_repeated(frames: list[Frame], kind: str) -> list[Frame]:
    """Return the frames up to the last call that leads back to itself: what it reached at last is no cause."""
    own = own_frames(frames) if kind == "RecursionError" else []
    again = next((frame for frame in own if own.count(frame) > 1), None)
    return frames[: len(frames) - frames[::-1].index(again)] if again else frames


def _frame(line: str, below: Sequence[str], package: str, before: Sequence[Frame]) -> Frame | None:
    """Return the frame in a line of a traceback from Python, pytest or IPython; None if there is none."""
    if frame := _FRAME.match(line) or _PYTEST_FRAME.match(line):
        # colcon passes setup.py to Python as a string.
        is_setup = frame["file"] == "<string>" and before and before[-1].file.endswith("/core.py")
        file = f"{package}/setup.py" if is_setup else frame["file"]
        text = below[0].strip() if below and below[0].startswith("    ") else ""
        return Frame(file, int(frame["line"]), _marked(below), text)
    if cell := _CELL_FRAME.match(line):
        is_file = cell["file"] is not None
        name = cell["file"] if is_file else f"cell {cell['cell']}"
        return Frame(name, int(cell["line"] if is_file else cell["cell_line"]))
    return None


def _named_places(message: str, below: Sequence[str]) -> list[Frame]:
    """Return where an exception without a traceback was raised, from the lines below or its own message."""
    places = [match for line in below if (match := _PYTEST_PLACE.match(line))]
    named = places or [match for match in [_NAMED.search(message)] if match]
    return [Frame(place["file"], int(place["line"])) for place in named]


# How pytest names a line: before the code, or below the code in its long form.
_PYTEST_FRAME = re.compile(r"(?P<file>\S+\.py):(?P<line>\d+): (?:in \S+)?$")
_PYTEST_PLACE = re.compile(r"(?P<file>\S+\.py):(?P<line>\d+): \w+$")


def _marked(lines: Sequence[str]) -> str:
    """Return the part of a line of code that the line below marks, as in `    ~~~~^^^`; empty if none."""
    match lines:
        case [code, marks] if re.fullmatch(r" +[~^]+", marks):
            return code[len(marks) - len(marks.lstrip()) : len(marks)]
    return ""


def _whole_message(first: str, rest: Sequence[str]) -> str:
    """Return a message with the lines on which it continues, as rclpy's messages do."""
    message = [first.strip()]
    for line in rest[:3]:
        is_other = line.startswith((" ", "\t", "Traceback", "[", "---", "File ", "$"))
        if not line.strip() or is_other or _EXCEPTION.match(line):
            break
        if not first.rstrip().endswith((":", ".", ",")) and len(message) == 1 and not line[0].islower():
            break
        message.append(line.strip())
    return " ".join(part for part in message if part)


def _decisive(lines: Sequence[str]) -> tuple[str, bool]:
    """Return the line that best says what went wrong, and whether its words say so: a warning's do not."""
    lines = [line for line in lines if not (_OF_COURSE.match(line) or _OWN_LOG.match(line))]
    lines = [line for line in lines if not says_well(line)]
    marked = [line for line in lines if re.match(r"\s*E  +\S", line)]  # as pytest marks it
    plain = (line for line in lines if not line.startswith("Failed ") and not LABELLED.match(line))
    if telling := next((line for line in (*marked, *plain) if line in marked or is_telling(line)), None):
        return telling.strip(), True
    if warning := next((line for line in lines if LABELLED.match(line)), None):
        return warning.strip(), False
    return first_error([line for line in lines if not _IN_ORDER.match(line)]) or "", False


def own_frames(frames: Sequence[Frame]) -> list[Frame]:
    """Return the frames outside Python and the installed packages, the innermost first."""
    others = (frame for frame in reversed(frames) if not _INSTALLED.search(frame.file))
    return [frame for frame in others if not _is_foreign(frame.file) and not _STARTS.search(frame.text)]


def _is_foreign(file: str) -> bool:
    parts = PurePath(file).parts
    if "site-packages" not in parts and "dist-packages" not in parts:
        return "ros2lab" in parts and "src" in parts
    # In the install folder of a workspace, the student's files are below site-packages, too.
    return "install" not in parts or ".venv" in parts
