"""The findings of a diagnosis, and their order."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from shlex import quote

UNKNOWN = "unknown"  # the code of an error that is quoted but not explained
SAID = "passed-on"  # the code of an error that a tool or Python explains itself


@dataclass(frozen=True)
class Guess:
    """What a fix writes only because it looks likely: it is tried in a copy of the file before it is told.

    Attributes:
        old: the expression or the statement that it replaces, as `ast` writes it.
        new: what it writes instead.
        otherwise: the fix if that makes something fail.
    """

    old: str
    new: str
    otherwise: str


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong.

    Attributes:
        code: the kind of fault, as a name that never changes, such as `int-in-float`.
        cause: what is wrong, in a sentence that a beginner understands.
        place: the file and line, such as `src/pk/setup.py:12`; empty if there is none.
        fix: what to type or change; empty if not known.
        about: the names of the packages, executables, files or topics that it is about.
        never: the places of what it says is in vain: functions and classes of which no code runs, and statements.
        guess: what the fix writes, if that may be wrong; None if it is certain, or nothing to type.
    """

    code: str
    cause: str
    place: str = ""
    fix: str = ""
    about: tuple[str, ...] = ()
    never: tuple[str, ...] = ()
    guess: Guess | None = None


# In the order in which they stop a student: what keeps colcon from building at all comes first, what only
# surprises comes last. Within a stage, findings stay in the order in which they were found.
STAGES: tuple[tuple[str, ...], ...] = (
    ("setuptools-too-new", "package-duplicate", "dependency-circle", "not-writable"),
    ("package-passed-over", "package-outside"),
    ("manifest-invalid", "build-type-missing", "build-type-unknown", "build-type-cmake"),
    ("setup-syntax", "setup-missing", "setup-import", "name-undefined-in-setup"),
    ("package-name", "setup-value", "entry-point-comma", "entry-point-spec", "entry-point-twice"),
    ("package-folder-missing", "marker-missing", "interface-refused", "data-file-missing"),
    (
        "setup-cfg-dashes",
        "setup-cfg-missing",
        "entry-points-key",
        "entry-points-missing",
        "executable-missing",
    ),
    ("init-file-missing", "package-not-listed", "entry-point-module", "entry-point-no-function"),
    ("node-syntax", "comma-missing", "comma-tuple"),
    ("entry-point-function",),
    ("name-shadowed", "ros1-import", "import-wrong", "module-missing"),
    ("rclpy-init-missing", "rclpy-init-twice", "context-manager"),
    ("super-missing", "super-misspelt", "super-late", "node-name-invalid", "node-property"),
    ("topic-name-invalid", "dot-for-comma", "type-not-a-message"),
    ("argument-order", "queue-size", "qos-missing", "argument-missing", "argument-unknown"),
    ("private-name", "name-hidden"),
    ("made-wrong", "argument-type", "operand-type", "not-callable", "value-none"),
    ("callback-called", "callback-missing", "callback-arguments", "attribute-missing"),
    ("name-undefined",),
    ("parameter-undeclared", "parameter-file-syntax", "parameter-type"),
    ("publisher-method", "publish-text", "publish-type", "message-field", "string-data-type", "field-type"),
    (
        "message-compared",
        "literal-comparison",
        "comparison-unused",
        "text-as-condition",
        "no-effect",
        "text-not-filled",
        "unreachable",
        "not-kept",
        "errors-hidden",
        "never-made",
        "replaced",
        "computed-once",
        "never-sent",
        "never-read",
        "never-equal",
        "never-called",
        "never-started",
        "never-passed",
        "filling-lost",
        "begun-anew",
        "one-object",
        "changed-in-loop",
        "used-up",
        "queue-short",
        "unit-mixed",
        "lock-held",
        "transition-wrong",
        "value-nan",
        "rounded-off",
    ),
    ("int-in-float", "logger-arguments"),
    (
        "spin-missing",
        "endless-loop",
        "rate-without-thread",
        "shutdown-in-callback",
        "timer-in-callback",
        "callback-waits",
        "raise-in-callback",
        "spin-inside",
        "life-order",
        "made-again",
    ),
    (
        "path-absolute",
        "launch-syntax",
        "launch-argument",
        "words-unread",
        "launch-function",
        "launch-lost",
        "launch-apart",
        "environment-apart",
        "launch-package",
        "launch-executable",
        "not-in-data-files",
        "installed-elsewhere",
    ),
    (
        "parameter-file-missing",
        "parameter-file-node",
        "parameter-name",
        "parameter-octal",
        "parameter-once",
        "remap-unknown",
        "namespace-unused",
        "parameter-replaced",
    ),
    ("program-ends", "no-node", "not-spinning", "never-activated", "never-ends"),
    ("topic-near-miss", "topic-type", "qos-mismatch", "publishes-nothing", "message-empty", "sent-early"),
    ("commanded-by-two",),
    ("launch-unused", "never-shown", "parameter-unread"),
    ("speed-implausible", "word-unanswered", "period"),
    ("test-fixture", "tests-not-run", "test-failed"),
    ("dependency-joined", "build-elsewhere", "edited-in-install"),
    ("executable-unusable", "script-fails"),
    ("not-built", "install-stale", "overlay-order", "not-sourced", "package-not-found", "file-not-found"),
    ("link-stale", "left-over"),
    (
        "marker-not-installed",
        "dependency-unknown",
        "dependency-not-ros",
        "dependency-key",
        "dependency-undeclared",
        "dependency-launched",
    ),
    ("typed-wrong", "not-running", "command-not-found", "shutdown-twice", "name-twice"),
    ("name-missing", "attribute-unknown", "python-error", SAID, UNKNOWN),
    ("axis",),  # correct for anything but a robot on the ground
)
# Lines with these run; what they lead to fails later, elsewhere.
_LATER = frozenset(
    (
        *("comma-missing", "comma-tuple", "name-shadowed", "name-hidden", "callback-called"),
        *("callback-missing", "callback-arguments", "parameter-type", "string-data-type", "field-type"),
    )
)
_STAGE_OF = {code: stage for stage, codes in enumerate(STAGES) for code in codes}


_MOVE = re.compile(r"\bmv ('[^']+'|\S+) ('[^']+'|[^\s,;)`]+)")


def without_loss(finding: Finding, root: Path) -> Finding:
    """Return a finding that tells of each file that its `mv` would write over, before the command itself."""
    fix = finding.fix
    for old, new in _MOVE.findall(fix):
        if (root / new.strip("'")).is_file():
            fix = f"there is a {new} already: compare it with {old} first, and delete the one that is not needed; if that is {new}, {fix}"
    return replace(finding, fix=fix)


def ranked(findings: Iterable[Finding]) -> list[Finding]:
    """Return the findings without duplicates, the likeliest cause first."""
    return sorted(dict.fromkeys(findings), key=lambda finding: _STAGE_OF[finding.code])


def merged(findings: Iterable[Finding]) -> list[Finding]:
    """Return the findings with those that differ only in their lines told once."""
    found: dict[Finding, list[str]] = {}
    for finding in findings:
        file, _, line = finding.place.rpartition(":")
        alike = replace(finding, place=file, never=()) if line.isdigit() else finding
        found.setdefault(alike, []).append(line)
    return [
        replace(one, place=f"{one.place}:{line}", fix="; ".join(filter(None, [one.fix, _likewise(more)])))
        if line.isdigit()
        else one
        for one, (line, *more) in found.items()
    ]


def _likewise(lines: Sequence[str]) -> str:
    return f"likewise on {these_lines(lines)}" if lines else ""


def stops_build(finding: Finding) -> bool:
    """Return whether a finding keeps colcon from building the package."""
    return _STAGE_OF[finding.code] <= _STAGE_OF["data-file-missing"]


def stops_node(finding: Finding) -> bool:
    """Return whether a line with this finding fails when it runs."""
    return _STAGE_OF[finding.code] < _STAGE_OF["message-compared"]


def fails_there(finding: Finding) -> bool:
    """Return whether a finding is untrue if its line comes to its end when it runs."""
    return finding.code == "unreachable" or (stops_node(finding) and finding.code not in _LATER)


def keeps_from_working(finding: Finding) -> bool:
    """Return whether code with this finding does not do what it is for when it runs."""
    of_code = range(_STAGE_OF["node-syntax"], _STAGE_OF["callback-waits"] + 1)
    return _STAGE_OF[finding.code] in of_code or finding.code == "sent-early"


def is_about_life(finding: Finding) -> bool:
    """Return whether a finding is about when, or from where, something is called."""
    return _STAGE_OF[finding.code] == _STAGE_OF["callback-waits"]


def at(shown: str, line: int | None) -> str:
    """Return a place such as `src/pk/setup.py:12`, or the file alone if there is no line."""
    return f"{shown}:{line}" if line else shown


def not_read(shown: str, line: int | None, problem: str) -> Finding:
    """Say that a file is too large to be read here, although ROS may read it."""
    fix = "keep only what is needed, with little nesting: nobody writes this much by hand"
    return Finding(UNKNOWN, f"{shown} is not read here: {problem}.", at(shown, line), fix)


def endless(path: Path, root: Path | None) -> Finding:
    """Say that a file is a link to what has no end, so that nothing beside it is looked at either."""
    shown = shown_path(path, root)
    cause = f"{shown} is a link to {path.resolve()}, which the system makes up as it is read, and of which there may be no end; nothing that may read it was started."
    return Finding(
        UNKNOWN, cause, shown, f"rm {quote(shown)}, and put a file of your own there if one is needed"
    )


def shown_path(path: Path, root: Path | None) -> str:
    """Return a path as it is shown: relative to the workspace if it is inside it."""
    if root is not None and path.is_relative_to(root):
        return str(path.relative_to(root))
    return str(path)


def lines_in_words(first: int, last: int) -> str:
    """Return a range of lines in words: `line 3`, or `lines 3 to 5`."""
    return f"line {first}" if first == last else f"lines {first} to {last}"


def these_lines(lines: Sequence[int | str]) -> str:
    """Return some lines in words: `line 3`, or `lines 3, 5 and 9`."""
    return f"line{'s' * (len(lines) > 1)} {in_a_row([*map(str, lines)])}"


def in_a_row(parts: Sequence[str]) -> str:
    """Return parts of a sentence in a row, with `and` before the last."""
    return f"{', '.join(parts[:-1])} and {parts[-1]}" if len(parts) > 1 else "".join(parts)


def line_with(text: str, *words: str, start: int = 1) -> int | None:
    """Return the number of the first line, from a line on, that contains one of some words; None without any."""
    lines = enumerate(text.splitlines()[start - 1 :], start)
    return next((number for number, line in lines if any(word in line for word in words)), None)
