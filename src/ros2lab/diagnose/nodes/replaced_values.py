"""Values in a parameter file that a later line of the same file replaces, which no tool mentions."""

from __future__ import annotations

from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding, at, lines_in_words
from ros2lab.diagnose.sources.parameter_file import Written, is_for, written_values


def replaced_values(shown: str, text: str) -> Iterator[Finding]:
    """Yield the values of a parameter file that never count: a later line sets another one for all nodes that they are for."""
    written = written_values(text)
    for index, lost in enumerate(written):
        later = [new for new in written[index + 1 :] if new.name == lost.name and _covers(new, lost)]
        if not later or repr(later[-1].value) == repr(lost.value):  # 1 is not 1.0
            continue
        last = later[-1]
        cause = f"{shown} sets {lost.name} to {lost.short} on line {lost.line}, but line {last.line} sets it to {last.short} for the same node, and the last value counts."
        first, second = lines_in_words(*lost.lines), lines_in_words(*last.lines)
        if first == second:  # in braces
            first, second = (f"`{value.name.rpartition('.')[2]}: {value.text}`" for value in (lost, last))
        fix = f"remove {second} if {lost.short} is meant, or {first} if {last.short} is"
        yield Finding("parameter-replaced", cause, at(shown, last.line), fix)


def _covers(new: Written, lost: Written) -> bool:
    """Return whether a value is for all nodes that another value is for."""
    return new.section == lost.section or ("*" not in lost.section and is_for(new.section, lost.section))
