"""What Python prints of an exception that it ignores, such as one in `__del__`: it is the cause of nothing."""

from __future__ import annotations

import re
from collections.abc import Iterable

_HEADER = re.compile(r"Exception ignored\b")
_PROCESS = re.compile(r"\[[\w.]+-\d+\] ")  # what `ros2 launch` puts before the lines of a program
_BETWEEN = re.compile(r"\s*$|\s|Traceback \(most recent call last\)|(?:During handling|The above exception) ")


def without_ignored(lines: Iterable[str]) -> list[str]:
    """Return the lines of an output without ignored exceptions, each with its traceback."""
    kept: list[str] = []
    ignoring = set[str]()  # the processes whose last lines belong to an ignored exception
    for line in lines:
        process = _PROCESS.match(line)
        who, said = (process[0], line[process.end() :]) if process else ("", line)
        if _HEADER.match(said):
            ignoring.add(who)
        elif who not in ignoring:
            kept.append(line)
        elif not _BETWEEN.match(said):
            ignoring.discard(who)  # the exception itself, without indentation, ends its traceback
    return kept
