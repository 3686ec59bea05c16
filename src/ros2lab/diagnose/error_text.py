"""What a failed command has printed, taken apart: which errors, of which kind, and where."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePath

from ros2lab.build_report import first_error

_ESCAPES = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]|\x1b\][^\x07]*\x07|\r")
_FRAME = re.compile(r'^\s*File "(?P<file>[^"]+)", line (?P<line>\d+)(?:, in (?P<function>\S+))?')
_CELL_FRAME = re.compile(
    r"^(?:File (?P<file>\S+?):(?P<line>\d+)|Cell In\s*\[(?P<cell>\d+)\], line (?P<cell_line>\d+))"
)
_EXCEPTION = re.compile(
    r"^(?:E +)?(?P<kind>(?:[A-Za-z_]\w*\.)*[A-Za-z_]\w*(?:Error|Exception|Interrupt|Exit))(?::\s?(?P<message>.*))?$"
)
_IN_ORDER = re.compile(r"Starting >>>|Finished <<<|Summary:|(?:\[\S+-\d+\] )?\[(?:INFO|DEBUG)\]")
_COMMAND = re.compile(r"\bros2 (?P<verb>run|launch) (?:-\S+ )*(?P<package>[\w.-]+) (?P<what>[\w./-]+)")
_INSTALLED = re.compile(
    r"/(?:site|dist)-packages/(?!.*/)|^<(?:frozen|string)|/lib/python3[\d.]*/(?!site-packages|dist-packages)"
)


@dataclass(frozen=True)
class Frame:
    """One line of a traceback that says where; the innermost one is the last."""

    file: str
    line: int

    @property
    def is_in(self) -> str:
        """The file's name with its folder's, by which a file and its installed copy are the same."""
        return "/".join(PurePath(self.file).parts[-2:])


@dataclass(frozen=True)
class ErrorReport:
    """One error.

    Attributes:
        kind: the exception's class, without its module; empty for what is no exception.
        message: what it says.
        frames: where, the innermost last.
    """

    kind: str
    message: str
    frames: tuple[Frame, ...] = ()

    @property
    def line(self) -> str:
        """The line that decides."""
        return f"{self.kind}: {self.message}".removesuffix(": ") if self.kind else self.message


@dataclass(frozen=True)
class ErrorText:
    """Everything that a text tells.

    Attributes:
        text: the text, without colours.
        reports: its exceptions, those of the first traceback first.
        decisive: the line that says best what went wrong; empty if the text is.
        command: the last `ros2 run` or `ros2 launch` in it, as (verb, package, executable or file).
    """

    text: str
    reports: tuple[ErrorReport, ...]
    decisive: str
    command: tuple[str, str, str] | None

    @property
    def frames(self) -> tuple[Frame, ...]:
        """All places that its exceptions name."""
        return tuple(frame for report in self.reports for frame in report.frames)


def read_error(text: str) -> ErrorText:
    """Take an error's text apart."""
    plain = _ESCAPES.sub("", text)
    lines = plain.splitlines()
    reports = tuple(_reports(lines))
    commands = [match for line in lines if (match := _COMMAND.search(line))]
    last = commands[-1] if commands else None
    decisive = reports[-1].line if reports else _decisive(lines)
    return ErrorText(
        plain, reports, decisive, (last["verb"], last["package"], last["what"]) if last else None
    )


def _reports(lines: Sequence[str]) -> list[ErrorReport]:
    found: list[ErrorReport] = []
    frames: list[Frame] = []
    for number, line in enumerate(lines):
        frame = _FRAME.match(line)
        cell = _CELL_FRAME.match(line)
        exception = _EXCEPTION.match(line)
        if line.startswith("Traceback (most recent call last)"):
            frames = []
        elif frame:
            frames.append(Frame(frame["file"], int(frame["line"])))
        elif cell:
            name, at = (
                (cell["file"], cell["line"]) if cell["file"] else (f"cell {cell['cell']}", cell["cell_line"])
            )
            frames.append(Frame(name, int(at)))
        elif exception:
            kind = exception["kind"].rpartition(".")[2]
            message = _whole_message(exception["message"] or "", lines[number + 1 :])
            found.append(ErrorReport(kind, message, tuple(frames)))
            frames = []
    return found


def _whole_message(first: str, rest: Sequence[str]) -> str:
    """Join a message that goes on in the next lines, as rclpy's do."""
    message = [first.strip()]
    for line in rest[:3]:
        is_next = line.startswith((" ", "\t", "Traceback", "[", "---", "File ", "$")) or _EXCEPTION.match(
            line
        )
        if not line.strip() or is_next or not first.rstrip().endswith((":", ",", "")):
            break
        if not first.rstrip().endswith((":", ".", ",")) and len(message) == 1 and not line[0].islower():
            break
        message.append(line.strip())
    return " ".join(part for part in message if part)


def _decisive(lines: Sequence[str]) -> str:
    telling = re.compile(r"(?i)\berror\b|not found|failed|cannot|no such|invalid|warning")
    said = [line for line in lines if line.strip() and not _IN_ORDER.match(line)]
    first = next(
        (line.strip() for line in said if telling.search(line) and not line.startswith("Failed   <<<")), None
    )
    return first_error(said) or "" if first is None else first


def own_frames(frames: Sequence[Frame]) -> list[Frame]:
    """Return the frames outside Python and the installed packages, the innermost first."""
    return [
        frame
        for frame in reversed(frames)
        if not _INSTALLED.search(frame.file) and not _is_foreign(frame.file)
    ]


def _is_foreign(file: str) -> bool:
    parts = PurePath(file).parts
    if "site-packages" not in parts and "dist-packages" not in parts:
        return "ros2lab" in parts and "src" in parts
    # In the installed copy of a workspace, the student's files lie below site-packages, too.
    return "install" not in parts
