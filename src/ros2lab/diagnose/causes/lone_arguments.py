"""Arguments for a function that something else calls, given as one value and not as a tuple."""

from __future__ import annotations

import ast
import re

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText, own_frames
from ros2lab.diagnose.sources.python_source import given_to, last_name

_NO_TUPLE = re.compile(
    r"(?P<name>\w+)\(\) (?:argument after \* must be an iterable, not |takes .*positional arguments? but (?P<many>\d+) w)"
)


def of_lone_argument(error: ErrorText, look: Look) -> Finding | None:
    """Return the call that hands on `args=(x)` for `args=(x,)`; None for another error, or if no call does."""
    said = _NO_TUPLE.search(error.report.message) if error.report else None
    if said is None or error.report is None or own_frames(error.report.frames[-1:]):
        return None
    for source in look.files:
        for call in (call for call in source.calls if said["name"] in map(last_name, given_to(call))):
            args = next((keyword for keyword in call.keywords if keyword.arg == "args"), None)
            value = source.written(args.value) if args else None
            is_text = isinstance(value, ast.JoinedStr) or isinstance(getattr(value, "value", None), str)
            if args and not isinstance(value, (ast.Tuple, ast.List)) and (is_text or not said["many"]):
                cause = f"`{source.segment(args)}` hands on no tuple: a comma makes one, parentheses alone do not."
                fix = f"write `args=({ast.unparse(args.value)},)` instead of `{source.segment(args)}`"
                return Finding("made-wrong", cause, source.at(args.value), fix)
    return None
