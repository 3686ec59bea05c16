"""A grade for the terminal, drawn by rich."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from ros2lab.grading.grade import Fault, Grade
from ros2lab.grading.reports.losses import losses, missed_bonus, other_faults
from ros2lab.grading.reports.shown import number, title, visible

WIDTH = 20  # characters of a bar
MOST = 50  # faults and notes, each


def table(grade: Grade) -> RenderableType:
    """Return a grade as rich renders it in a terminal: components, losses, overrides, notes."""
    parts: list[RenderableType] = [_components(grade)]
    lost = _lost(grade)
    if lost.row_count:
        parts.append(lost)
    for criterion in grade.criteria:
        if criterion.override:
            parts.append(
                _text(
                    f"{visible(criterion.id)}: {number(criterion.points)} of {number(criterion.max)}, set by "
                    f"{visible(criterion.override.by)}: {visible(criterion.override.comment)} "
                    f"(the machine gave {number(criterion.override.machine)})"
                )
            )
    parts += [_text(f"Note: {visible(note)}") for note in grade.notes[:MOST]]
    if len(grade.notes) > MOST:
        parts.append(_text(f"Note: {len(grade.notes) - MOST} more are not shown."))
    return Group(*parts)


def _components(grade: Grade) -> Table:
    result = Table(
        title=_text(f"{visible(grade.submission)}: {number(grade.total)} of {number(grade.max)} points"),
        show_footer=True,
    )
    result.add_column("Component", footer="Total")
    result.add_column("", no_wrap=True)
    result.add_column("Points", justify="right", footer=number(grade.total), no_wrap=True)
    result.add_column("Of", justify="right", footer=number(grade.max), no_wrap=True)
    for name, given in grade.components.items():
        result.add_row(
            _text(title(visible(name))),
            _bar(given.points / given.max if given.max else 1.0),
            number(given.points),
            number(given.max),
        )
    return result


def _bar(share: float) -> Text:
    done = int(min(1.0, max(0.0, share)) * WIDTH)
    return Text("█" * done + "·" * (WIDTH - done), "green" if share >= 1 else "yellow")


def _lost(grade: Grade) -> Table:
    result = Table(title="What was lost, and how to fix it", show_lines=True)
    result.add_column("Lost", justify="right", no_wrap=True)
    for name in ("What", "Why", "Fix"):
        result.add_column(name, overflow="fold")
    for loss in losses(grade):
        for criterion in loss.criteria:
            result.add_row(
                number(criterion.max - criterion.points),
                *map(_text, map(visible, (criterion.title, criterion.reason, criterion.hint))),
            )
        _add_faults(result, loss.faults)
    _add_faults(result, other_faults(grade))
    for criterion in missed_bonus(grade):
        result.add_row(
            "bonus", *map(_text, map(visible, (criterion.title, criterion.reason, criterion.hint)))
        )
    return result


def _add_faults(result: Table, faults: list[Fault]) -> None:
    for fault in faults[:MOST]:
        result.add_row(
            "",
            *map(_text, (visible(fault.place), visible(fault.cause), visible(fault.fix, keeps_lines=True))),
        )
    if len(faults) > MOST:
        result.add_row("", "", f"{len(faults) - MOST} more are not shown.", "")


def _text(text: str) -> Text:
    """Return a text whose brackets are not taken for markup."""
    return Text(text, overflow="fold")
