"""Statements that only name, compare or compute something, and use nothing of it."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.construction import is_node_class
from ros2lab.diagnose.sources.node_source import CREATORS, is_self_attribute
from ros2lab.diagnose.sources.own_functions import own_function, what_a_call_makes
from ros2lab.diagnose.sources.python_source import (
    PAUSES,
    Function,
    PythonSource,
    given_to,
    is_generator,
    last_name,
    own_nodes,
)
from ros2lab.diagnose.sources.signatures import signature_of
from ros2lab.diagnose.sources.syntax_parts import is_property, needed_by, removal

_SHIFTS = (ast.LShift, ast.RShift)  # objects of libraries use them to put one after the other


def idle_statements(source: PythonSource) -> Iterator[Finding]:
    """Yield statements without effect."""
    tried = tried_statements(source)
    for node in source.nodes:
        if isinstance(node, ast.Expr) and id(node) not in tried:
            yield from _without_effect(source, node.value)


def _without_effect(source: PythonSource, value: ast.expr) -> Iterator[Finding]:
    text = ast.unparse(value)
    match value:
        case ast.Compare(left=left, ops=[ast.Eq()], comparators=[right]):
            cause = f"`{text}` only compares, and its result is not used."
            is_target = isinstance(left, (ast.Name, ast.Attribute, ast.Subscript))
            fix = f"write {ast.unparse(left)} = {ast.unparse(right)}"
            fix = (
                fix
                if is_target
                else f"use it as the condition of an if, or {removal(source, value, 'the line')}"
            )
            yield Finding("comparison-unused", cause, source.at(value), fix)
        # Tutorials write `self.subscription` alone to avoid a warning; it is an attribute, not a function.
        case ast.Attribute() | ast.Name() if text not in source.stored and _is_function(source, value):
            cause = f"`{text}` by itself does nothing: without parentheses {text.rpartition('.')[2]} is not called."
            place = source.at(value)
            yield Finding("no-effect", cause, place, _called(source, value), never=(place,))
        case ast.Call(func=called) if own := own_function(source, called):
            if made := what_a_call_makes(own[1]):
                cause = f"`{text}` only makes a {made}: nothing of {own[1].name}() runs."
                place = source.at(value)
                yield Finding("no-effect", cause, place, _run(source, value, own[1]), never=(place,))
        case ast.UnaryOp(
            op=ast.UAdd() | ast.USub() as sign, operand=ast.UnaryOp(op=same, operand=counted)
        ) if type(same) is type(sign) and isinstance(counted, (ast.Name, ast.Attribute, ast.Subscript)):
            added = "+" if isinstance(sign, ast.UAdd) else "-"
            cause = f"`{added}{added}{ast.unparse(counted)}` changes nothing: Python has no `{added}{added}`."
            fix = f"write {ast.unparse(counted)} {added}= 1"
            yield Finding("no-effect", cause, source.at(value), fix)
        case ast.BinOp() | ast.UnaryOp():
            kinds = (ast.Call, *PAUSES, *_SHIFTS)
            if not any(isinstance(n, kinds) for n in ast.walk(value)):
                cause = f"`{text}` is computed, but its result is not used."
                fix = f"assign it to a variable, or {removal(source, value, 'the line')}"
                yield Finding("no-effect", cause, source.at(value), fix)


def _run(source: PythonSource, call: ast.Call, function: Function) -> str:
    """Say how to run what a call only makes: a function without a pause need not be async, and ROS awaits a callback."""
    text, around = ast.unparse(call), source.function_at(call.lineno)
    if is_generator(function):
        return f"write `for _ in {text}: pass`, or {function.name} without yield"
    if not any(isinstance(node, PAUSES) for node in own_nodes(function)):
        return f"write def instead of async def for {function.name}"
    if isinstance(around, ast.AsyncFunctionDef):
        return f"write `await {text}`"
    creators = [node for node in source.calls if getattr(node.func, "attr", "") in CREATORS]
    if around and any(last_name(given) == around.name for node in creators for given in given_to(node)):
        return f"write `await {text}`, and `async def {around.name}` on line {around.lineno}: ROS runs such a callback to its end"
    return f"write await in front of it in an async function that is awaited, or asyncio.run({text}) where no asyncio loop runs"


def _is_function(source: PythonSource, value: ast.Name | ast.Attribute) -> bool:
    """Return whether a name is known to be that of a function, and no property, class or module."""
    whole, last = source.resolve(value) or "", ast.unparse(value).rpartition(".")[2]
    if whole.startswith(("rclpy.spin", "rclpy.init")) or last in properties(source):
        return False  # those are told elsewhere
    if getattr(value, "is_function", False) or own_function(source, value):
        return True
    if whole:
        return "." in whole and last.islower() and not interfaces.is_module(whole)
    owner = value.value if isinstance(value, ast.Attribute) else None
    if is_self_attribute(value):
        return last in interfaces.node_members()
    made = [call for text, call in source.made if owner is not None and text == ast.unparse(owner)]
    made += [owner] if isinstance(owner, ast.Call) else []
    if made and all(
        source.resolve(call.func) == "rclpy.create_node" or is_node_class(source, call.func) for call in made
    ):
        return last in interfaces.node_members()
    names = [getattr(call.func, "attr", "") for call in made]
    return bool(names) and all(name in CREATORS or name == "get_logger" for name in names)


def _called(source: PythonSource, function: ast.expr) -> str:
    """Say how to call a function that is only named."""
    text = ast.unparse(function)
    if text.endswith("publish"):
        return f"write {text}(msg)"
    needed = _needed(source, function)
    if not needed:
        return f"write {text}()"
    return f"write {text}({', '.join(needed)}), with your own {'value' if len(needed) == 1 else 'values'} for {' and '.join(needed)}"


def _needed(source: PythonSource, function: ast.expr) -> list[str]:
    """Return the parameters without defaults of a function, as far as it is known."""
    if (own := own_function(source, function)) is not None:
        return needed_by(own[1])
    if known := signature_of(source, ast.Call(function, [], [])):
        return [parameter.name for parameter in known.parameters if not parameter.default]
    module, _, name = (source.resolve(function) or "").rpartition(".")
    built_in = getattr(sys.modules.get(module), name, None) if module in sys.builtin_module_names else None
    # Functions in C begin their documentation with the call: `sleep(seconds)`.
    match = re.match(rf"{name}\(([\w, ]+)", getattr(built_in, "__doc__", None) or "")
    return match[1].split(", ") if match else []


def properties(source: PythonSource) -> set[str]:
    """Return the names of the properties of nodes, messages and the classes of a file, which cannot be called."""
    own = {node.name for node in source.nodes if isinstance(node, Function) and is_property(node)}
    imported = filter(interfaces.is_interface, source.names.values())
    fields = {field for name in imported for field in interfaces.fields_of(name) or ()}
    return own | fields | interfaces.node_properties()


def tried_statements(source: PythonSource) -> set[int]:
    """Return the statements, by `id`, that may only ask whether they fail: in a `try` or a test's `with`."""
    blocks = (
        node.body
        for node in source.nodes
        if isinstance(node, ast.Try)
        or (isinstance(node, ast.With) and "raises" in ast.unparse(node.items[0].context_expr).lower())
    )
    return {id(statement) for block in blocks for statement in block if isinstance(statement, ast.Expr)}
