"""Lines whose indentation is wrong, moved to where the lines around them suggest, alone or with their block."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.code.repair import RARE, USUAL, Repair

_LEVELS = (" " * 4, "\t")  # what a file indents its levels by
_EACH, _MOST = 0.02, 0.3  # what each further line adds to a cost, and what all of them add at most
_CUT = 0.5  # what it costs to leave the next line behind
_DEFINITION = re.compile(r"\s*(?:(?:async )?def\b|class\b|@)")
_METHOD = re.compile(r"\s*(?:async )?def \w+\(\s*self\b")
_SHOWN = 60


def depth_of(line: str) -> int:
    """Return the number of spaces and tabs with which a line begins."""
    return len(line) - len(line.lstrip())


def is_code(line: str) -> bool:
    """Return whether a line has more than a comment."""
    return line.strip()[:1] not in ("", "#")


def is_definition(line: str) -> bool:
    """Return whether a line begins a function or a class."""
    return _DEFINITION.match(line) is not None


def level_of(lines: Sequence[str]) -> str:
    """Return what most lines of a file are indented by: a tab, or else four spaces."""
    indents = Counter(line[0] for line in lines if line.strip() and line[0] in " \t")
    return max(_LEVELS, key=lambda level: indents[level[0]])


def in_words(indent: str) -> str:
    """Return the beginning of a line in words, such as "8 spaces" or "1 tab"."""
    sign = "tab" if "\t" in indent else "space"
    return f"{len(indent)} {sign}" if len(indent) == 1 else f"{len(indent)} {sign}s"


def moves_of(lines: Sequence[str], place: int, above: int, said: str) -> Iterator[Repair]:
    """Yield the line at which Python stops, or the one above, moved to each depth around it, alone or with its block."""
    if not re.search(r"indent|tab|expected '", said, re.IGNORECASE):
        return
    if above and re.search("expected an indented block", said):
        empty = [*_with_something_below(lines, place, above)]
        yield from empty
        if any(repair.cost == USUAL for repair in empty):
            return
    for number in (place, above):
        for depth in _depths(lines, number) if number else ():
            for last in _ends(lines, number):
                yield _moved(
                    lines, number, last, depth, above if "expected an" in said and number == place else 0
                )


def _with_something_below(lines: Sequence[str], place: int, above: int) -> Iterator[Repair]:
    """Yield `pass` for a block if what follows is no part of it; it costs less if a comment stands there, as in a template."""
    head, follows = lines[above - 1], lines[place - 1]
    comments = [line for line in lines[above:place] if line.strip() and not is_code(line)]
    has_comment = any(depth_of(line) > depth_of(head) for line in comments)
    is_end = place == above or not is_code(follows) or depth_of(follows) < depth_of(head)
    if is_end or re.match(r"(def|class|@|else|elif|except|finally)\b", follows.strip()):
        what, cost = ("only a comment", USUAL) if has_comment else ("nothing", RARE)
        yield Repair(above, f"{head.rstrip()} pass", f"there is {what} below `{head.strip()}`", cost)


def _depths(lines: Sequence[str], number: int) -> list[int]:
    """Return the depths that a line may have had, the nearest to its own first."""
    now, level = depth_of(lines[number - 1]), level_of(lines)
    found = {depth_of(line) for line in lines[: number - 1] if line.strip()}
    above = [line for line in lines[: number - 1] if is_code(line)]
    if above and above[-1].rstrip().endswith(":"):
        found.add(depth_of(above[-1]) + len(level))
    is_mixed = _is_mixed(lines[number - 1], level)
    return sorted((found | {0}) - (set() if is_mixed else {now}), key=lambda depth: abs(depth - now))


def _is_mixed(line: str, level: str) -> bool:
    """Return whether a line begins with other signs than its file."""
    return not {*line[: depth_of(line)]} <= {level[0]}


def _ends(lines: Sequence[str], number: int) -> Iterator[int]:
    """Yield the numbers of the last lines of what may move with a line: itself, and the block that it begins."""
    yield number
    now, end, seen = depth_of(lines[number - 1]), number, {number}
    for other in range(number + 1, len(lines) + 1):
        line = lines[other - 1]
        if not line.strip():
            continue
        # A block ends where its level does; a definition may be the next one of what the first belongs to.
        is_next = _DEFINITION.match(line) is not None
        if (depth_of(line) <= now or is_next) and end not in seen:
            seen.add(end)
            yield end
        is_top = re.match(r"(def|class|@|async def|if __name__)\b", line) and not _METHOD.match(line)
        if depth_of(line) < now or (depth_of(line) == now and is_top):
            return
        end = other
    if end not in seen:
        yield end


def _moved(lines: Sequence[str], first: int, last: int, depth: int, head: int) -> Repair:
    now, level = depth_of(lines[first - 1]), level_of(lines)
    signs = level[0] * depth
    below = [
        level[0] * max(depth_of(line) + depth - now, 0) + line.lstrip() if line.strip() else line
        for line in lines[first:last]
    ]
    code, new = lines[first - 1].strip(), signs + lines[first - 1].lstrip()
    is_mixed = _is_mixed(lines[first - 1], level)
    why = f"`{code[:_SHOWN]}` begins with {in_words(level[0] * now)}, but the lines it belongs with begin with {depth}"
    if is_mixed:
        why = "tabs and spaces are mixed in the indentation"
    elif head:
        why = (
            f"the lines that belong to `{lines[head - 1].strip()[:_SHOWN]}` must be indented further than it"
        )
    # The body of a definition goes on to an empty line at least.
    rest = lines[last] if head and last < len(lines) and _DEFINITION.match(lines[head - 1]) else ""
    is_cut = bool(rest.strip()) and depth_of(rest) == now and not _DEFINITION.match(rest)
    cost = USUAL + min(_EACH * (last - first), _MOST) + _CUT * is_cut
    return Repair(first, new, why, cost, tuple(below), is_move=True)
