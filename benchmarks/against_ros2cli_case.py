"""A case of the comparison with the real `ros2`, what a run of it left, and how texts are made comparable."""

from __future__ import annotations

import difflib
import re
import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

STREAMS = ("stdout", "stderr", "files")
_DIFF_LINES = 60
_TRACEBACK = "Traceback (most recent call last)"


@dataclass(frozen=True)
class Case:
    """A command that both run in the same surroundings.

    Attributes:
        command: what is typed into bash; it is also the name of the case.
        normal: names of the normalizations beside `ALWAYS`, in their order.
        world: which nodes run meanwhile; see `against_ros2cli_nodes.py`.
        until: Ctrl-C is sent as soon as this pattern is in the output; "" if the command ends by itself.
        seconds: Ctrl-C is sent at the latest after so many.
        is_terminal: whether both streams are one terminal, as at home.
        why: the reason why ours differs on purpose; "" if it should not.
    """

    command: str
    normal: tuple[str, ...] = ()
    world: str = "quiet"
    until: str = ""
    seconds: float = 20.0
    is_terminal: bool = False
    why: str = ""

    @property
    def name(self) -> str:
        """The command without its first word."""
        return self.command.removeprefix("ros2 ").strip() or "ros2"


@dataclass(frozen=True)
class Run:
    """What one run of a case left.

    Attributes:
        code: exit code of bash, which is that of the command, or the number of a signal, negated.
        seconds: how long it took; until the pattern was seen where the case has one.
        ended: `itself`, `interrupted` (as the case wants it), `late` (Ctrl-C was needed) or `killed`.
    """

    stdout: str
    stderr: str
    files: str
    code: int
    seconds: float
    ended: str


@dataclass(frozen=True)
class Comparison:
    """Both sides of a case."""

    case: Case
    real: Sequence[Run]
    ours: Sequence[Run]
    prefixes: tuple[str, str] = field(repr=False)

    def text(self, is_real: bool, stream: str) -> str:
        """Return what a side left in a stream, normalized."""
        run = (self.real if is_real else self.ours)[0]
        names = (*ALWAYS, *self.case.normal)
        text = getattr(run, stream).replace(self.prefixes[0 if is_real else 1], "PREFIX")
        return normalized(text, names)

    def is_same(self, stream: str) -> bool:
        """Whether both left the same in a stream."""
        return self.text(True, stream) == self.text(False, stream)

    @property
    def differing(self) -> list[str]:
        """What is not the same: streams, `code`, `end`."""
        names = [stream for stream in STREAMS if not self.is_same(stream)]
        if self.real[0].code != self.ours[0].code:
            names.append("code")
        if self.real[0].ended != self.ours[0].ended:
            names.append("end")
        return names

    @property
    def is_missing(self) -> bool:
        """Whether ours has no such command yet."""
        return "invalid choice" in self.ours[0].stderr and "invalid choice" not in self.real[0].stderr

    @property
    def why(self) -> str:
        """The reason why ours differs on purpose, "" if it should not."""
        if self.case.why or not self.differing:
            return self.case.why
        # A user's mistake, told by a traceback: ours tells it by a sentence, and that is what it is for.
        tracebacks = [run.stderr.count(_TRACEBACK) for run in (self.real[0], self.ours[0])]
        is_told = self.ours[0].stderr.strip() and self.ours[0].code != 0
        if tracebacks[0] and not tracebacks[1] and self.differing == ["stderr"] and is_told:
            return "A sentence instead of a traceback."
        return ""

    @property
    def verdict(self) -> str:
        """`same`, `intended`, `missing` or `differs`."""
        if not self.differing:
            return "same"
        if self.is_missing:
            return "missing"
        return "intended" if self.why else "differs"

    def seconds(self, is_real: bool) -> float:
        """The median time of a side."""
        return statistics.median(run.seconds for run in (self.real if is_real else self.ours))

    def diff(self) -> str:
        """Return the unified difference of every stream that differs, and of the exit code."""
        parts = []
        for stream in STREAMS:
            pair = [self.text(side, stream).splitlines() for side in (True, False)]
            lines = list(difflib.unified_diff(*pair, f"real {stream}", f"ours {stream}", lineterm="", n=2))
            if len(lines) > _DIFF_LINES:
                lines = [*lines[:_DIFF_LINES], f"... {len(lines) - _DIFF_LINES} more lines"]
            parts += lines
        for name, label in (("code", "exit code"), ("ended", "ended")):
            real, ours = getattr(self.real[0], name), getattr(self.ours[0], name)
            if real != ours:
                parts.append(f"{label}: real {real}, ours {ours}")
        return "\n".join(parts)

    def as_data(self) -> dict[str, Any]:
        """Return the comparison as what JSON can hold."""
        return {
            "case": vars(self.case),
            "verdict": self.verdict,
            "why": self.why,
            "differing": self.differing,
            "seconds": {"real": self.seconds(True), "ours": self.seconds(False)},
            "real": [vars(run) for run in self.real],
            "ours": [vars(run) for run in self.ours],
            "diff": self.diff(),
        }


def normalized(text: str, names: Sequence[str]) -> str:
    """Return `text` after the named normalizations, in their order."""
    for name in names:
        text = NORMALIZATIONS[name](text)
    return text


def _replace(pattern: str, by: str) -> Callable[[str], str]:
    return lambda text: re.sub(pattern, by, text, flags=re.MULTILINE)


def _sorted(text: str) -> str:
    return "\n".join(sorted(text.splitlines()))


def _flags(text: str) -> str:
    """Keep the options, their choices and the verbs of a help text, whose words and order are each one's own."""
    text = re.sub(r"-\n\s+", "-", text)  # a word that was parted at its hyphen
    options = re.findall(r"(?<![\w/-])--?[a-zA-Z][\w-]*", text)
    choices = re.findall(r"\{[\w,\s-]+\}", text)
    verbs = re.findall(r"^  ([a-z]+)  ", text, flags=re.MULTILINE)
    return "\n".join(sorted({*options, *(re.sub(r"\s", "", choice) for choice in choices), *verbs}))


def _without_own_texts(text: str) -> str:
    """Leave out what a new package's licence, tests and comments say, not that they are there."""
    texts = r"^(\S*(?:LICENSE|test_\w+\.py|visibility_control\.h) \d{6})\n.*?(?=^\S+(?:/| \d{6})$|\Z)"
    text = re.sub(texts, r"\1\n", text, flags=re.MULTILINE | re.DOTALL)
    text = re.sub(r"^\s*(?:#|//)(?!include|ifn?def|define|endif).*\n", "", text, flags=re.MULTILINE)
    return re.sub(
        r"^    (?:tests_require=\['pytest'\],|extras_require=\{.*?^    \},)",
        "    TESTS",
        text,
        flags=re.MULTILINE | re.DOTALL,
    )


def _without_usage(text: str) -> str:
    """Keep what follows the usage that argparse writes before an error: `flags` looks at that elsewhere."""
    return re.sub(r"^usage:.*?(?=^ros2[\w ]*: error:)", "", text, flags=re.MULTILINE | re.DOTALL)


def _without_repeats(text: str) -> str:
    """Keep the first of equal lines that follow each other."""
    lines = text.splitlines()
    return "\n".join(line for before, line in zip([None, *lines], lines, strict=False) if line != before)


def _without_repeated_messages(text: str) -> str:
    """Keep each of the messages that `---` parts once."""
    return "---\n".join(dict.fromkeys(part for part in re.split(r"^---\n", text, flags=re.MULTILINE) if part))


# Each is narrow: it makes one thing comparable that is different at every run, or on every machine.
NORMALIZATIONS: Mapping[str, Callable[[str], str]] = {
    "pids": _replace(r"(pid[ =]\[?)\d+", r"\1PID"),
    "times": _replace(r"\b\d{10}\.\d{3,9}\b", "TIME"),
    "log_folders": _replace(r"\b\d{4}-\d\d-\d\d-\d\d-\d\d-\d\d-\d{6}-[\w.-]+?-\d+", "LOG_FOLDER"),
    "addresses": _replace(r"\b0x[0-9a-f]{6,}", "ADDRESS"),
    "stamps": _replace(r"\b((?:nano)?sec[:=] ?)\d+", r"\1STAMP"),
    "stamp_columns": _replace(r"^\d{10},\d+", "STAMP,STAMP"),
    "gids": _replace(r"\b(?:[0-9a-f]{2}\.){15}[0-9a-f]{2}\b", "GID"),
    "rates": _replace(r"\d+\.\d+|(?<=window: )\d+", "NUMBER"),
    "sizes": _replace(r"\b[\d.]+(?= ?(?:B|KB|MB|messages?)\b)", "NUMBER"),
    "information": _replace(
        r"^((?:source_timestamp|received_timestamp|publication_sequence_number): )\d+", r"\1NUMBER"
    ),
    "node_names": _replace(r"\b_ros2cli_\d+", "_ros2cli_PID"),
    "own_nodes": _replace(r"^.*/?_ros2cli_.*\n", ""),
    "tool_packages": _replace(
        r"^(?:ament_(?:copyright|lint)|launch\w*|osrf_pycommon|ros2\w+|rosidl_runtime_py)(?:[ /].*)?\n", ""
    ),
    "modules": _replace(r"<launch[\w.]*\.(\w+) object", r"<\1 object"),
    "ends": _replace(r"process has (?:finished cleanly|died)( \[pid PID).*", r"process has ended\1]"),
    "end_levels": _replace(r"^\[\w+\](?= \[[\w-]+\]: process has ended)", "[LEVEL]"),
    "waits": _replace(r"^(?:waiting for service to become available|Waiting for at least 1 match).*\n", ""),
    "not_yet": _replace(r"^WARNING: topic .* does not appear to be published yet\n", ""),
    "partings": _replace(r"^.*Nobody publishes /robot/state any more.*\n?", ""),
    "own_texts": _without_own_texts,
    "flags": _flags,
    "usage": _without_usage,
    "order": _sorted,
    "repeats": _without_repeats,
    "repeated_messages": _without_repeated_messages,
    "spaces": lambda text: re.sub(r"\s+", " ", text),
}
ALWAYS = ("usage", "pids", "times", "log_folders", "addresses", "node_names")
