"""A grade as Markdown, for a comment or an issue.

Only words are plain text; everything else from a submission is put into code spans, where Markdown, HTML and
addresses have no effect.
"""

from __future__ import annotations

import re

from ros2lab.grading.grade import Fault, Grade, Judgement
from ros2lab.grading.reports.losses import losses, missed_bonus, other_faults
from ros2lab.grading.reports.shown import number, title, visible

MOST = 50  # faults and notes, each

# Words and numbers; then also code spans in our own sentences, and calls.
_WORD = re.compile(r"""["'(]*(?:\d+\.\d+|[^\W_]+(?:['\u2019-][^\W_]+)*)[)"',.;:!?]*""")
_PIECE = re.compile(
    r"""(?<!\S)(["'(]*)(?:`([^`]+)`|(\[[^][`]*\]|\{[^{}`]*\}|[\w.]+\([^()`]*\)|\S*?))([)"',.;:!?]*)(?!\S)"""
)


def markdown(grade: Grade) -> str:
    """Return a grade as Markdown: total, components, what was lost, all criteria, notes."""
    blocks = [
        f"# Grade of {prose(grade.submission)}",
        f"**{number(grade.total)} of {number(grade.max)} points**",
        _components(grade),
        "## Lost points",
        *_lost(grade),
        "## All criteria",
        "\n".join(map(_criterion, grade.criteria)) or "There are none.",
    ]
    if grade.notes:
        blocks += ["## Notes", _list([f"- Note: {prose(note)}" for note in grade.notes])]
    versions = ", ".join(prose(f"{name} {version}") for name, version in grade.versions.items())
    blocks += [
        "## How it was graded",
        f"- Run: {grade.run}\n- Clock: {prose(grade.clock)}\n- Sandbox: {prose(grade.sandbox)}\n- Versions: {versions}",
    ]
    return "\n\n".join(blocks) + "\n"


def prose(text: str) -> str:
    """Return a text in one line that has no effect inside a block of Markdown, if other words come before."""
    parts = []
    for piece in _PIECE.finditer(" ".join(visible(text, keeps_lines=True).split())):
        before, quoted, word, after = piece.groups()
        inner, after = (quoted, after) if quoted else _closed(word, after)
        is_plain = not inner or _WORD.fullmatch(piece[0])
        parts.append(piece[0] if is_plain else f"{before}{_code(inner)}{after}")
    return " ".join(parts)


def _closed(word: str, after: str) -> tuple[str, str]:
    """Return a word with as much of the text after it as closes its brackets, and the rest of that text."""
    for length in range(len(after) + 1):
        if word.count("(") == (word + after[:length]).count(")"):
            return word + after[:length], after[length:]
    return word, after


def _code(text: str) -> str:
    longest = max(map(len, re.findall("`+", text)), default=0)
    fence = "`" * (longest + 1)
    gap = " " if longest else ""
    return f"{fence}{gap}{text}{gap}{fence}"


def _components(grade: Grade) -> str:
    rows = "\n".join(
        # A bar would end the cell, and a code span with it.
        f"| {prose(title(name)).replace('|', '¦')} | {number(given.points)} | {number(given.max)} |"
        for name, given in grade.components.items()
    )
    return f"| Component | Points | Of |\n| --- | ---: | ---: |\n{rows}"


def _lost(grade: Grade) -> list[str]:
    blocks = []
    for loss in losses(grade):
        blocks.append(f"### {prose(title(loss.component))}: {number(loss.points)} lost")
        lines = []
        for criterion in loss.criteria:
            lines.append(
                f"- **{number(criterion.max - criterion.points)} lost**: {prose(criterion.title)}. {prose(criterion.reason)}"
            )
            if criterion.hint:
                lines.append(f"  - Hint: {prose(criterion.hint)}")
        blocks.append("\n".join(lines))
        if loss.faults:
            blocks.append(_list(list(map(_fault, loss.faults))))
    if not blocks:
        blocks.append("None.")
    if further := other_faults(grade):
        blocks += ["### Also found", _list(list(map(_fault, further)))]
    if missed := missed_bonus(grade):
        blocks += [
            "### Bonus that is still to be had",
            "\n".join(
                f"- **{number(criterion.max - criterion.points)} more**: {prose(criterion.title)}. {prose(criterion.hint)}"
                for criterion in missed
            ),
        ]
    return blocks


def _fault(fault: Fault) -> str:
    lines = [f"- Cause: {prose(fault.cause)}"]
    # A place is one code span, even if a file's name has spaces.
    place = _code(" ".join(visible(fault.place).split())) if " " in fault.place else prose(fault.place)
    fixes = (("Place", place), ("Fix", prose(fault.fix)))
    lines += [f"  - {name}: {text}" for name, text in fixes if text]
    return "\n".join(lines)


def _criterion(criterion: Judgement) -> str:
    line = f"- **{number(criterion.points)} of {number(criterion.max)}**: {prose(criterion.title)}. {prose(criterion.reason)}"
    if criterion.override:
        line += (
            f"\n  - Set by {prose(criterion.override.by)}: {prose(criterion.override.comment)} "
            f"(the machine gave {number(criterion.override.machine)})"
        )
    return line


def _list(items: list[str]) -> str:
    left_out = [f"- Left out: {len(items) - MOST} more."] if len(items) > MOST else []
    return "\n".join([*items[:MOST], *left_out])
