"""Lines whose indentation is wrong, moved to where the lines around them suggest, alone or with their block."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.code.repair import RARE, USUAL, Repair

_STEP = 4  # spaces of a level
_EACH = 0.02  # what each further line adds to a cost
_SHOWN = 60


def depth_of(line: str) -> int:
    """Return the number of spaces and tabs with which a line begins."""
    return len(line) - len(line.lstrip())


def moves_of(lines: Sequence[str], place: int, above: int, said: str) -> Iterator[Repair]:
    """Yield the line at which Python stops, or the one above, moved to each depth around it, alone or with its block."""
    if not re.search(r"indent|tab|expected '", said, re.IGNORECASE):
        return
    if above and re.search("expected an indented block", said):
        yield from _with_something_below(lines, place, above)
    for number in (place, above):
        for depth in _depths(lines, number) if number else ():
            for last in _ends(lines, number):
                yield _moved(
                    lines, number, last, depth, above if "expected an" in said and number == place else 0
                )


def _with_something_below(lines: Sequence[str], place: int, above: int) -> Iterator[Repair]:
    if re.match(r"(def|class|@|else|elif|except|finally)\b", lines[place - 1].strip()) or place == above:
        head = lines[above - 1].strip()
        yield Repair(above, f"{lines[above - 1].rstrip()} pass", f"there is nothing below `{head}`", RARE)


def _depths(lines: Sequence[str], number: int) -> list[int]:
    """Return the depths that a line may have had, the nearest to its own first."""
    now = depth_of(lines[number - 1])
    found = {depth_of(line) for line in lines[: number - 1] if line.strip()}
    above = [line for line in lines[: number - 1] if line.strip()]
    if above and above[-1].rstrip().endswith(":"):
        found.add(depth_of(above[-1]) + _STEP)
    is_tabbed = "\t" in lines[number - 1][:now]
    return sorted((found | {0}) - (set() if is_tabbed else {now}), key=lambda depth: abs(depth - now))


def _ends(lines: Sequence[str], number: int) -> Iterator[int]:
    """Yield the numbers of the last lines of what may move with a line: itself, and the block that it begins."""
    yield number
    now, end, seen = depth_of(lines[number - 1]), number, {number}
    for other in range(number + 1, len(lines) + 1):
        line = lines[other - 1]
        if not line.strip():
            continue
        # A block ends where its level does; a definition may be the next one of what the first belongs to.
        is_next = re.match(r"\s*(def|class|@|async def)\b", line) is not None
        if (depth_of(line) <= now or is_next) and end not in seen:
            seen.add(end)
            yield end
        if depth_of(line) < now or (
            depth_of(line) == now and re.match(r"(def|class|@|async def|if __name__)\b", line)
        ):
            return
        end = other
    if end not in seen:
        yield end


def _moved(lines: Sequence[str], first: int, last: int, depth: int, head: int) -> Repair:
    now = depth_of(lines[first - 1])
    moved = [
        _at(line, depth_of(line) + depth - now) if line.strip() else line for line in lines[first - 1 : last]
    ]
    moved[0] = _at(lines[first - 1], depth)
    code = lines[first - 1].strip()
    why = f"`{code[:_SHOWN]}` begins with {now} spaces, but the lines it belongs with begin with {depth}"
    if head:
        why = (
            f"the lines that belong to `{lines[head - 1].strip()[:_SHOWN]}` must be indented further than it"
        )
    why = "tabs and spaces are mixed in the indentation" if "\t" in lines[first - 1][:now] else why
    return Repair(first, moved[0], why, USUAL + _EACH * (last - first), tuple(moved[1:]), is_move=True)


def _at(line: str, depth: int) -> str:
    return " " * max(depth, 0) + line.lstrip()
