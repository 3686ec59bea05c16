"""Values that a library calls as functions: the line that gave it one is named nowhere in the traceback."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.checking.called_at_once import called_at_once, swapped_functions
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText, own_frames
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.own_functions import returned
from ros2lab.diagnose.sources.python_source import PythonSource

_SAYS = re.compile(r"'(?P<kind>\w+)' object is not callable")
_MAKERS = frozenset(("partial", "partialmethod", "getattr", "wraps"))  # what they return is called later


def of_later_call(error: ErrorText, known: list[Finding], look: Look) -> Finding | None:
    """Return the finding about the line that gave a library a value to call; None if there is none."""
    report = error.reports[-1] if error.reports else None
    said = _SAYS.search(report.message) if report else None
    if report is None or said is None or not report.frames or own_frames(report.frames[-1:]):
        return None
    if said["kind"] != "NoneType":
        return next(swapped_functions(look), None)
    told = (finding for finding in known if finding.code == "callback-called")
    return next(told, None) or next(called_at_once(look), None) or next(_called_callbacks(look), None)


def _called_callbacks(look: Look) -> Iterator[Finding]:
    """Yield callbacks that are written as calls, of which only the error tells that they return None."""
    for package in look.packages:
        sources = look.sources(package)
        for creation in sources.creations:
            given = (creation.arguments or {}).get("callback")
            if isinstance(given, ast.Call) and _may_give_none(sources, creation.source, given):
                text = ast.unparse(given)
                right = f"lambda: {text}" if given.args or given.keywords else ast.unparse(given.func)
                whole = ast.unparse(creation.call).replace(text, right, 1)
                cause = f"`{text}` is called right here, so {creation.method} is given its return value, None, instead of a function."
                yield Finding("callback-called", cause, creation.source.at(given), f"write `{whole}`")


def _may_give_none(sources: NodeSources, source: PythonSource, call: ast.Call) -> bool:
    """Return whether a call may return None: not one of a class, nor of what makes functions."""
    name = getattr(call.func, "attr", getattr(call.func, "id", ""))
    if name in _MAKERS or name[:1].isupper():
        return False
    known = sources.functions.get(sources.resolve(source, call.func) or "")
    own = known[1] if known else None
    return not (isinstance(own, ast.FunctionDef) and returned(own))
