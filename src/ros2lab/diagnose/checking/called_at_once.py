"""Calls that stand where a function is wanted, so that they run at once: `Thread(target=work())`."""

from __future__ import annotations

import ast
import builtins
import re
from collections.abc import Iterator
from dataclasses import dataclass

from ros2lab.diagnose.checking.checked_copies import Row, checked
from ros2lab.diagnose.checking.trials import Edit
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.sources.interfaces import is_interface
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, PythonSource, returns_value
from ros2lab.diagnose.sources.uses import is_log

_NOTHING = re.compile(r"None|Never|NoReturn")
_FUNCTION = re.compile(r"Expected `.*->.*`, found")


@dataclass(frozen=True)
class _Given:
    """A call that is an argument of another one.

    Attributes:
        outer: the other one.
        call: what is given to it.
        name: of the argument; empty if it is given by its place.
        is_void: whether it calls a function of one's own that returns nothing, which the type checker does not tell.
    """

    outer: ast.Call
    call: ast.Call
    name: str
    is_void: bool


def called_at_once(look: Look) -> Iterator[Finding]:
    """Yield each call that returns nothing, and stands where something takes a function that it calls later.

    What a parameter takes, and what a function of a library returns, is asked of the type checker: no name tells it.
    """
    for package in look.packages:
        sources = look.sources(package)
        for source in sources.sources.values():
            found = [*_given_calls(sources, source)] if source.path and not source.fault else []
            yield from _called(source, found) if found else ()


def _given_calls(sources: NodeSources, source: PythonSource) -> Iterator[_Given]:
    """Yield calls that are arguments, but for rclpy's callbacks, what is only shown, and what a class makes."""
    made = {id(creation.call) for creation in sources.creations}
    for owner, _, node in sources.scoped(source):
        if not isinstance(node, ast.Call) or id(node) in made or is_log(node):
            continue
        values = [*(("", one) for one in node.args), *((one.arg or "", one.value) for one in node.keywords)]
        for name, value in values:
            if isinstance(value, ast.Call) and not _is_class(sources, source, value):
                function = _own_function(sources, source, owner, value)
                is_void = isinstance(function, ast.FunctionDef) and not returns_value(function)
                if function is None or is_void:
                    yield _Given(node, value, name, is_void)


def _is_class(sources: NodeSources, source: PythonSource, call: ast.Call) -> bool:
    """Return whether a call makes an object of a class of one's own, a message, or a value of Python's own types."""
    name = sources.resolve(source, call.func) or ""
    return name in sources.classes or is_interface(name) or hasattr(builtins, name)


def _own_function(
    sources: NodeSources, source: PythonSource, owner: NodeClass | None, call: ast.Call
) -> Function | None:
    if is_self_attribute(call.func):
        return sources.method(owner, call.func.attr)
    found = sources.functions.get(sources.resolve(source, call.func) or "")
    return found[1] if found else None


def _called(source: PythonSource, given: list[_Given]) -> Iterator[Finding]:
    lines = source.text.encode().splitlines(keepends=True)
    revealing = lines
    for call in sorted((one.call for one in given), key=lambda call: (-call.lineno, -call.col_offset)):
        written = ast.get_source_segment(source.text, call) or ast.unparse(call)
        revealing = Edit(call, f"reveal_type({written})").applied(revealing)
    others = [b"".join(Edit(one.call, "object()").applied(lines)) for one in given]
    revealed, *refused = checked(source, [b"".join(revealing), *others])
    for one, rows in zip(given, refused, strict=True):
        is_void = one.is_void or _has(revealed, "revealed-type", one.call, _NOTHING)
        if is_void and _has(rows, "invalid-argument-type", one.call, _FUNCTION):
            yield _finding(source, one)


def _has(rows: list[Row], rule: str, node: ast.expr, said: re.Pattern[str]) -> bool:
    return any(row.line == node.lineno and row.rule == rule and said.search(row.said) for row in rows)


def _finding(source: PythonSource, given: _Given) -> Finding:
    call, outer = given.call, ast.unparse(given.outer.func)
    text = ast.unparse(call)
    written = f"lambda: {text}" if call.args or call.keywords else ast.unparse(call.func)
    return Finding(
        "callback-called",
        f"`{text}` is called right here, so {outer}(), which needs a function to call later, is given its return value, None.",
        source.at(call),
        f"write `{f'{given.name}=' if given.name else ''}{written}`",
    )
