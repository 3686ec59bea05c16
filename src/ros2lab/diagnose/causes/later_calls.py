"""What a library calls later: values that are no functions, and arguments that are no tuple."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.checking.called_at_once import called_at_once, swapped_functions
from ros2lab.diagnose.code.called_back import CALLED_WITH
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText, own_frames
from ros2lab.diagnose.printed.spots import place_of, source_of
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.own_functions import as_function, returned
from ros2lab.diagnose.sources.python_source import PythonSource, given_to, last_name, own_nodes

_SAYS = re.compile(r"'(?P<kind>\w+)' object is not callable")
_MAKERS = frozenset(("partial", "partialmethod", "getattr", "wraps"))  # what they return is called later


def of_later_call(error: ErrorText, known: list[Finding], look: Look) -> Finding | None:
    """Return the finding about the line that gave a library a value to call; None if there is none."""
    report = error.report
    said = _SAYS.search(report.message) if report else None
    if report is None or said is None or not report.frames or own_frames(report.frames[-1:]):
        return None
    called = _called_callbacks(sources_around(error, look), gives_none=said["kind"] == "NoneType")
    if said["kind"] != "NoneType":
        return next(swapped_functions(look), None) or next(called, None)
    told = (finding for finding in known if finding.code == "callback-called")
    return next(told, None) or next(called_at_once(look), None) or next(called, None)


def sources_around(error: ErrorText, look: Look) -> list[NodeSources]:
    """Return the files of all packages, and each file of the traceback that belongs to none, such as a script."""
    places = [place_of([frame], look).rpartition(":")[0] for frame in error.own]
    others = [source for place in dict.fromkeys(places) if (source := source_of(place, look))]
    alone = [NodeSources({source.name: source}) for source in others if source not in look.files]
    return [*map(look.sources, look.packages), *alone]


def _called_callbacks(every: list[NodeSources], *, gives_none: bool) -> Iterator[Finding]:
    """Yield callbacks that are written as calls, of which only the error tells what they return."""
    for sources in every:
        created = [(c.source, c.call, c.given("callback")) for c in sources.creations]
        for source in sources.sources.values():
            calls = [node for node in source.calls if node.args]
            created += [
                (source, call, call.args[0]) for call in calls if getattr(call.func, "attr", "") == "submit"
            ]
        for source, call, given in created:
            if isinstance(given, ast.Call) and _may_be(sources, source, given, gives_none=gives_none):
                yield _finding(source, call, given)


def _finding(source: PythonSource, call: ast.Call, given: ast.Call) -> Finding:
    text, name = ast.unparse(given), getattr(call.func, "attr", "")
    right = as_function(None, given, CALLED_WITH.get(name, ()))[1]
    if name == "submit":
        right = ", ".join(map(ast.unparse, (given.func, *given.args, *given.keywords)))
    whole = ast.unparse(call).replace(text, right, 1)
    cause = f"`{text}` is called right here, so {name}() is given what it returns instead of a function to call later."
    return Finding("callback-called", cause, source.at(given), f"write `{whole}`")


def _may_be(sources: NodeSources, source: PythonSource, call: ast.Call, *, gives_none: bool) -> bool:
    """Return whether a call may return None, or a value: not one of a class, nor of what makes functions."""
    name = last_name(call.func)
    if name in _MAKERS or name[:1].isupper():
        return False
    known = sources.functions.get(sources.resolve(source, call.func) or "")
    own = known[1] if known else None
    if isinstance(own, ast.FunctionDef):
        inner = any(isinstance(n, (ast.FunctionDef, ast.Lambda)) for n in own_nodes(own))
        return not inner and bool(returned(own)) != gives_none
    return gives_none


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
