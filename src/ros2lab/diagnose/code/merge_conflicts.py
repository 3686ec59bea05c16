"""Conflicts that git leaves in a file of any kind when it cannot merge two versions of it."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ros2lab.diagnose.finding import in_a_row, lines_in_words, these_lines

_MARK = re.compile(r"(<{7}|\|{7}|={7}|>{7})(?: (?P<name>.*))?")


@dataclass(frozen=True)
class Conflict:
    """The first conflict in a file: its line, what it is, as a clause, and how to end it and those below."""

    line: int
    why: str
    told: str


def conflict_in(text: str) -> Conflict | None:
    """Return the conflict that a file still contains; None if it has none from its first mark to its last."""
    found, marks = list[tuple[int, str]](), dict[str, tuple[int, str]]()
    for number, line in enumerate(text.splitlines(), 1):
        if match := _MARK.fullmatch(line):
            marks = {} if line[0] == "<" else marks
            marks[line[0]] = number, match["name"] or ""
            if line[0] == ">" and {"<", "="} <= marks.keys():
                found.append((marks["<"][0], _ended(marks)))
                marks = {}
    if not found:
        return None
    more = f"; likewise from {these_lines([line for line, _ in found[1:]])} on" if found[1:] else ""
    return Conflict(found[0][0], "git left a merge conflict in it", f"{found[0][1]}{more}")


def _ended(marks: dict[str, tuple[int, str]]) -> str:
    """Say what to keep of a conflict, by its marks, each with its line and the name of its version."""
    (first, ours), (middle, _), (last, theirs) = (marks[mark] for mark in "<=>")
    end = marks.get("|", (middle, ""))[0]
    halves = (_half(first, end, ours), _half(middle, last, theirs))
    old = f", what was there before ({lines_in_words(end + 1, middle - 1)})" if end + 1 < middle else ""
    lines = [str(line) for line, _ in sorted(marks.values())]
    return f"keep {' or '.join(halves)}, or what you need of both, and delete the other{old} and the marks on lines {in_a_row(lines)}"


def _half(above: int, below: int, name: str) -> str:
    return f"{lines_in_words(above + 1, below - 1) if above + 1 < below else 'nothing'} ({name})"
