"""Says which values made a line fail, from what was noted there."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from dataclasses import replace

from ros2lab.diagnose.finding import SAID, Finding, in_a_row
from ros2lab.diagnose.sources.python_source import PythonSource, walk
from ros2lab.trial.record import Error

MOST = 3  # values that are told where none is known to be the cause
_OF_CODE = frozenset(("NameError", "ImportError", "ModuleNotFoundError", "AttributeError", "TypeError"))


def is_of_code(kind: str, message: str = "") -> bool:
    """Return whether an exception comes of the code itself, whatever the values are; with a None it may not.

    A message refuses a value of another type by an AssertionError.
    """
    is_of_type = kind == "AssertionError" and " field must be of type" in message
    return (kind in _OF_CODE or is_of_type) and "None" not in message


def with_values(finding: Finding, errors: Iterable[Error]) -> Finding:
    """Return a finding about a line that failed, with the values there; where Python only says so itself, with all of them."""
    error = next((error for error in errors if error.place == finding.place), None)
    is_said = finding.code == SAID
    if error is None or not (is_said or finding.code == "python-error"):
        return finding
    values = values_told(error, is_whole=is_said)
    if not values:
        return finding
    fix = (
        "see which of these values is not what you expected, and where it is set" if is_said else finding.fix
    )
    return replace(finding, cause=f"{finding.cause.rstrip('.')}. In that line, {values}.", fix=fix)


def failed_with(error: Error) -> str:
    """Return an exception with the values in the line that raised it."""
    values = values_told(error)
    return f"{error.last_line} ({values})" if values else error.last_line


def values_told(error: Error, *, is_whole: bool = True) -> str:
    """Return the values in the line that failed, as a clause such as `i was 575`: those that explain it.

    If none does, all if `is_whole`, else nothing.
    """
    if not error.lines:
        return ""
    source, line = error.lines[-1]
    shown = {text: (value, length) for text, value, length in error.values}
    nodes = [node for statement in source.around(line, ast.stmt)[-1:] for node in walk(statement)]
    deciding = [text for node in nodes for text in _deciding(error, node, shown)]
    told = dict.fromkeys(deciding or (_telling(nodes, shown) if is_whole else ()))
    parts = [f"{text} was {shown[text][0]}" for text in told]
    since = _set_last(source, line, deciding[-1]) if deciding else ""
    return f"{in_a_row(parts[:MOST])}{since}"


_Shown = dict[str, tuple[str, int | None]]


def _deciding(error: Error, node: ast.AST, shown: _Shown) -> Iterator[str]:
    """Yield the expressions whose values make a part of a line raise an exception."""
    match error.kind, node:
        case ("IndexError", ast.Subscript(value=owner, slice=index)):
            length = shown.get(ast.unparse(owner), ("", None))[1]
            if length is not None and isinstance(place := _value(index, shown), int):
                yield from _texts(shown, owner, index) if not -length <= place < length else ()
        case ("KeyError", ast.Subscript(value=owner, slice=key)):
            if shown.get(ast.unparse(owner), ("",))[0].startswith(("a dict", "an empty dict")):
                yield from _texts(shown, owner, key)
        case ("ZeroDivisionError", ast.BinOp(op=ast.Div() | ast.FloorDiv() | ast.Mod(), right=divisor)):
            yield from _texts(shown, divisor) if _value(divisor, shown) == 0 else ()
        case ("AttributeError" | "TypeError", ast.Attribute(value=owner) | ast.Subscript(value=owner)):
            is_none = "NoneType" in error.message and shown.get(ast.unparse(owner), ("",))[0] == "None"
            yield from _texts(shown, owner) if is_none else ()
        case ("TypeError", ast.BinOp(left=left, right=right)):
            yield from _texts(shown, left, right)
        case ("ValueError", ast.Assign(targets=[ast.Tuple() | ast.List()], value=value)):
            yield from _texts(shown, value)
        case ("ValueError", ast.Call(func=ast.Name(id="min" | "max" | "int" | "float"), args=[given, *_])):
            yield from _texts(shown, given)


def _texts(shown: _Shown, *nodes: ast.expr) -> Iterator[str]:
    return (text for text in map(ast.unparse, nodes) if shown.get(text, (text,))[0] != text)


def _value(node: ast.expr, shown: _Shown) -> object:
    try:
        return ast.literal_eval(shown.get(ast.unparse(node), (ast.unparse(node),))[0])
    except (ValueError, SyntaxError):
        return None


def _telling(nodes: list[ast.AST], shown: _Shown) -> list[str]:
    """Return the expressions of a line that have a value of their own: a number, a text, None, or something with a length."""
    written = (ast.unparse(node) for node in nodes if isinstance(node, ast.expr))
    found = (text for text in dict.fromkeys(written) if text in shown)
    return [
        text for text in found if shown[text][1] is not None or not shown[text][0].startswith(("a ", "an "))
    ]


def _set_last(source: PythonSource, line: int, text: str) -> str:
    """Return where the function of a line sets a value before it, as a relative clause, if it does so in one place."""
    function = source.function_at(line)
    lines = {
        node.lineno
        for node in (walk(function) if function else ())
        if isinstance(node, (ast.Name, ast.Attribute))
        and isinstance(node.ctx, ast.Store)
        and ast.unparse(node) == text
    }
    return f", which line {min(lines)} sets" if len(lines) == 1 and min(lines) < line else ""
