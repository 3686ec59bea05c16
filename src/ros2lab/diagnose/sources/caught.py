"""Whether an error that a statement raises may be caught around it, and so stops nothing."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Iterator

from ros2lab.diagnose.sources.python_source import Function, PythonSource
from ros2lab.diagnose.sources.static_value import dotted

# Exceptions of libraries that say that something else went wrong.
_OTHERS = frozenset(("ExternalShutdownException", "TransformException", "PackageNotFoundError"))


def may_be_caught(source: PythonSource, line: int, *errors: type[BaseException]) -> bool:
    """Return whether a `try` or `suppress` around a line catches one of some errors, as far as is known."""
    return any(_may_catch(name, errors) for name in _caught_around(source, line))


def may_be_caught_by_caller(source: PythonSource, function: Function, *errors: type[BaseException]) -> bool:
    """Return whether a file calls a function where one of some errors may be caught."""
    calls = source.calls
    named = (call for call in calls if (dotted(call.func) or "").rpartition(".")[2] == function.name)
    return any(may_be_caught(source, call.lineno, *errors) for call in named)


def _caught_around(source: PythonSource, line: int) -> Iterator[str]:
    """Yield the names of the exceptions that are caught around a line; empty for all."""
    for node in source.nodes:
        if not isinstance(node, (ast.Try, ast.With, ast.AsyncWith)):
            continue
        if not node.body[0].lineno <= line <= (node.body[-1].end_lineno or 0):
            continue
        if isinstance(node, ast.Try):
            for handler in node.handlers:
                yield from _named(handler.type)
            continue
        for item in node.items:
            call = item.context_expr
            if isinstance(call, ast.Call) and (dotted(call.func) or "").rpartition(".")[2] in (
                "suppress",
                "raises",
            ):
                for given in call.args:
                    yield from _named(given)


def _named(kinds: ast.expr | None) -> list[str]:
    if kinds is None:
        return [""]
    each = kinds.elts if isinstance(kinds, ast.Tuple) else [kinds]
    return [(dotted(kind) or "").rpartition(".")[2] for kind in each]


def _may_catch(name: str, errors: tuple[type[BaseException], ...]) -> bool:
    known = getattr(builtins, name, None) if name else BaseException
    if isinstance(known, type):
        return any(issubclass(error, known) for error in errors)
    return RuntimeError in errors and name not in _OTHERS  # as RCLError
