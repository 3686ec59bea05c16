"""Tracebacks that a program prints of what it has caught itself: it goes on, so they are no fault."""

from __future__ import annotations

import ast
import builtins
import re
import sys

from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import own_frames, read_error
from ros2lab.diagnose.printed.spots import place_of, spot_at
from ros2lab.diagnose.sources.python_source import Function, last_name, own_nodes, walk
from ros2lab.handlers import EVERY_ERROR, Handlers

_BEGIN = "Traceback (most recent call last):"
_PROCESS = r"(?:\[[\w.]+-\d+\] )?"  # what `ros2 launch` puts before the lines of a program
_ONE = rf".*{re.escape(_BEGIN)}\n(?:{_PROCESS} +\S.*\n)+{_PROCESS}\S.*(?:\n|\Z)"
_CHAIN = re.compile(
    rf"^{_ONE}(?:{_PROCESS}\n{_PROCESS}(?:During handling|The above exception) .*\n{_PROCESS}\n{_ONE})*", re.M
)
_KIND = re.compile(rf"{_PROCESS}([\w.]+)(?::|$)")
# A function that does so is the program's own frame: behind what it catches, the program ends.
_OF_PROGRAMS = frozenset(
    ("init", "spin", "spin_once", "spin_until_future_complete", "shutdown", "try_shutdown")
)
_ENDS = frozenset(("exit", "_exit", "quit", "shutdown", "try_shutdown"))
# What a message, a file or a device may bring about; other errors are slips in the code, whoever catches them.
_OF_INPUT = (ValueError, LookupError, ArithmeticError, OSError)


def without_caught(text: str, look: Look) -> str:
    """Return a text without the tracebacks of what the student's code catches, and then goes on."""
    return _CHAIN.sub(lambda found: "" if _is_caught(found[0], look) else found[0], text)


def _is_caught(chain: str, look: Look) -> bool:
    """Return whether the first frame of a traceback, with those before it that it names, catches its exception.

    A traceback begins at the frame that has caught the exception; else where Python or a thread begins.
    """
    last = f"{_BEGIN}{chain.rpartition(_BEGIN)[2]}"
    kind, reports = _KIND.match(last.splitlines()[-1]), read_error(last).reports
    first = reports[0].frames[:1] if reports else ()
    if not kind or not own_frames(first):
        return False
    spot = spot_at(place_of(first, look), look)
    function = spot.file.function_at(spot.line)
    if function is None or _calls(function, _OF_PROGRAMS):
        return False
    known = Handlers(spot.file.nodes)
    return any(
        _takes(known.caught(handler), kind[1]) and not _ends(handler)
        for node in own_nodes(function)
        if isinstance(node, ast.Try) and node.body[0].lineno <= spot.line <= (node.body[-1].end_lineno or 0)
        for handler in node.handlers
    )


def _calls(function: Function | ast.ExceptHandler, names: frozenset[str]) -> bool:
    """Return whether some code calls a function of one of some names."""
    return any(isinstance(node, ast.Call) and last_name(node.func) in names for node in walk(function))


def _ends(handler: ast.ExceptHandler) -> bool:
    """Return whether a handler may raise an exception, or end the program."""
    return _calls(handler, _ENDS) or any(isinstance(node, ast.Raise) for node in walk(handler))


def _takes(names: set[str], kind: str) -> bool:
    """Return whether a handler of some exceptions takes one of a kind, such as `json.decoder.JSONDecodeError`."""
    module, _, name = kind.rpartition(".")
    raised = getattr(sys.modules.get(module) if module else builtins, name, None)
    raised = raised if isinstance(raised, type) else None
    if not EVERY_ERROR.isdisjoint(names):
        return raised is None or issubclass(raised, _OF_INPUT)
    bases = {base.__name__ for base in raised.__mro__} if raised else {name}
    return not bases.isdisjoint(caught.rpartition(".")[2] for caught in names)
