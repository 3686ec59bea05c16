"""Whether an objection of the type checker rests on a type hint that the callers, or ROS, do not follow."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Iterator

from ros2lab.diagnose.checking.checked_copies import checked
from ros2lab.diagnose.checking.doubts import type_name
from ros2lab.diagnose.checking.edits import Edit
from ros2lab.diagnose.checking.trials import type_of
from ros2lab.diagnose.sources.interfaces import is_interface
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, parameters
from ros2lab.diagnose.sources.syntax_parts import all_parameters, by_parameter, own_parameters

_ANYTHING = "'_anything_'"  # a type that no file defines is one about which nothing is known
_DEEPEST = 3  # calls through which a value is followed


def is_misled(source: PythonSource, line: int, rule: str, own: NodeSources) -> bool:
    """Return whether a parameter gets something other than its hint says, with which the line is right.

    Python does not check hints, so what a parameter gets counts. Where that is not seen, a hint is trusted: all of
    them if nothing here calls the function, and otherwise only that of a message, which is seldom wrong.
    """
    for function in _around(source, line):
        for parameter in all_parameters(function):
            if parameter.annotation is None:
                continue
            given = [*_given(source, function, parameter.arg, own)]
            is_message = is_interface((source.resolve(parameter.annotation) or "").removesuffix(".Request"))
            kinds = [f"'{kind}'" for kind in given if kind]
            if not kinds and (not given or is_message):
                continue
            copies = checked(
                source, [Edit(parameter.annotation, kind).of(source) for kind in kinds or [_ANYTHING]]
            )
            if any(all((row.line, row.rule) != (line, rule) for row in rows) for rows in copies):
                return True
    return False


def _around(source: PythonSource, line: int) -> list[Function]:
    kinds = (node for node in source.nodes if isinstance(node, Function))
    return [node for node in kinds if node.lineno < line <= (node.end_lineno or 0)]


def _given(
    source: PythonSource, function: Function, name: str, own: NodeSources, depth: int = 0
) -> Iterator[str]:
    """Yield the types that a parameter gets from ROS and from each call, as the file writes them; empty if unknown."""
    names = [parameter.arg for parameter in own_parameters(function)]
    for creation, called in own.callbacks():
        if called is function and name in names:
            known = creation.arguments or {}
            kind = known.get("msg_type") or known.get("srv_type")
            part = ("", "") if "msg_type" in known else (".Request", ".Response")
            number = names.index(name)
            is_seen = kind is not None and creation.source is source and number < len(part)
            yield f"{ast.unparse(kind)}{part[number]}" if kind is not None and is_seen else ""
    for home in own.sources.values() if depth < _DEEPEST else ():
        direct = set[int]()
        for call in home.nodes:
            if isinstance(call, ast.Call) and last_name(call.func) == function.name:
                direct.add(id(call.func))
                value = by_parameter(call, names).get(name)
                yield from _kinds(home, value, source, own, depth) if value is not None else ()
        # Whatever it is passed to may call it with anything.
        yield from ("" for node in home.nodes if last_name(node) == function.name and id(node) not in direct)


def _kinds(
    home: PythonSource, value: ast.expr, source: PythonSource, own: NodeSources, depth: int
) -> Iterator[str]:
    """Yield the types of an argument, where it is a parameter itself those that it gets."""
    around = _around(home, value.lineno)
    handed = [f for f in around if ast.unparse(value) in [parameter.arg for parameter in parameters(f)]]
    found = [kind for f in handed for kind in _given(home, f, ast.unparse(value), own, depth + 1)]
    if any(found):
        yield from (kind if kind.partition(".")[0] in source.names else "" for kind in found)
        return
    kind = type_name(type_of(home, value))
    yield kind if kind in dir(builtins) or kind in source.names else ""
