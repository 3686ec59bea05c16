"""Values that are None because of a call that returns nothing, either always or this time."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ros2lab.diagnose.checking.checked_copies import checked
from ros2lab.diagnose.checking.edits import Edit
from ros2lab.diagnose.checking.trials import type_of
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.own_functions import may_fall_through, own_function, returned
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    assigned_to,
    contains,
    given_to,
    last_name,
    own_nodes,
    returns_value,
    walk,
)
from ros2lab.diagnose.sources.spelling import nearest

if TYPE_CHECKING:
    from ros2lab.diagnose.causes.origins import Origin


_Told = tuple[str, str, str]  # cause, place and fix
_DEEPEST = 5  # functions and names followed that pass a value on


@dataclass(frozen=True)
class _Leaf:
    """An expression that gave None, and where it is; without a node, it is the end of a function."""

    node: ast.expr | None
    source: PythonSource
    function: Function | None

    @property
    def text(self) -> str:
        return ast.unparse(self.node) if self.node else ""

    @property
    def line(self) -> int:
        return self.node.lineno if self.node else 0


def of_call_that_gave_none(origin: Origin, call: ast.Call, spot: Spot) -> _Told | None:
    """Return where the None that a call returned comes from; None if that is not seen."""
    leaves = [*_leaves(origin.source, call, spot.function if origin.source is spot.file else None)]
    # A forgotten return comes before a value that the function did not get itself.
    for leaf in sorted(leaves, key=lambda leaf: leaf.node is not None):
        if leaf.node is None and isinstance(leaf.function, ast.FunctionDef):
            return _of_own_function(leaf.source, leaf.function)
        if told := _of_leaf(leaf, origin, spot):
            return told
    return None


def _leaves(
    source: PythonSource, value: ast.expr, function: Function | None, depth: int = _DEEPEST
) -> Iterator[_Leaf]:
    """Yield the expressions that a value may come from, through the functions and names that pass it on."""
    match value:
        case ast.Constant(value=None):
            yield _Leaf(value, source, function)
        case ast.Await(value=inner) | ast.NamedExpr(value=inner) | ast.BoolOp(values=[*_, inner]):
            yield from _leaves(source, inner, function, depth)
        case ast.IfExp(body=body, orelse=otherwise):
            yield from _leaves(source, body, function, depth)
            yield from _leaves(source, otherwise, function, depth)
        case ast.Call() if own := own_function(source, value.func):
            yield from _leaves_of_function(*own, depth - 1) if depth else ()
        case ast.Call():
            yield _Leaf(value, source, function)
        case ast.Name() | ast.Attribute() if depth:
            for given in _assigned(source, value, function):
                yield from _leaves(source, given, function, depth - 1)


def _leaves_of_function(source: PythonSource, function: Function, depth: int) -> Iterator[_Leaf]:
    if may_fall_through(function):
        yield _Leaf(None, source, function)
    for node in returned(function):
        if isinstance(node, ast.Return) and node.value is not None:
            yield from _leaves(source, node.value, function, depth)


def _assigned(source: PythonSource, name: ast.expr, function: Function | None) -> list[ast.expr]:
    nodes = own_nodes(function) if isinstance(name, ast.Name) and function else source.nodes
    return [value for value in assigned_to(nodes, ast.unparse(name)) if value is not name]


def _of_leaf(leaf: _Leaf, origin: Origin, spot: Spot) -> _Told | None:
    """Return what is said of an expression that gave None; None if there is nothing to say."""
    use = spot.place or origin.place
    call = leaf.node
    if not isinstance(call, ast.Call):
        where = f"{leaf.function.name}() returns" if leaf.function else "it comes from"
        cause = f"{origin.name} is None on line {spot.line}: {where} the None on line {leaf.line}."
        return cause, use, _asked_first(origin.name, spot)
    name = getattr(call.func, "attr", "")
    if name == "result" and not call.args:
        return _of_future(leaf, call, origin, spot)
    if name == "get" and len(call.args) == 1 and not call.keywords:
        return _of_get(leaf, call, origin, spot)
    return _of_other_call(leaf, call, origin, spot, use)


def _of_other_call(leaf: _Leaf, call: ast.Call, origin: Origin, spot: Spot, use: str) -> _Told | None:
    kind = _kind_given(leaf.source, call)
    if kind == "None" and call is origin.value:
        return of_what_gives_nothing(origin, call, spot)
    if kind == "None":
        cause = f"`{leaf.text}` returns nothing, so {leaf.function.name if leaf.function else 'it'}() returns None."
        return cause, leaf.source.at(call), "return the intended value on this line"
    if kind and not re.search(r"\bNone\b|Unknown|Any\b", kind):
        return None
    if origin.name == leaf.text:
        return None  # nothing holds the value, so its line is the one that fails
    own = f" on line {leaf.line}" if leaf.source is spot.file else f" ({leaf.source.at(call)})"
    fitting = ", because the string does not match the pattern" if leaf.text.startswith("re.") else ""
    cause = f"{origin.name} is None on line {spot.line}: `{leaf.text}`{own} returned None{fitting}."
    return cause, use, _asked_first(origin.name, spot)


def _kind_given(source: PythonSource, call: ast.Call) -> str:
    """Return the type that a call returns, from the type checker or rclpy's code; empty if unknown."""
    kind = type_of(source, call)
    if isinstance(call.func, ast.Attribute) and kind in ("", "Unknown", "Any"):
        owner = type_of(source, call.func.value)
        homes = interfaces.inner_homes_of(owner) if owner.isidentifier() else ()
        methods = [interfaces.method_of(home, owner, call.func.attr) for home in homes]
        if any(method and not returns_value(method) for method in methods):
            return "None"
    return kind


def _asked_first(name: str, spot: Spot) -> str:
    """Return how to skip a line while a value is None."""
    return left_out(f"{name} is None", f"{name} is not None", name, spot)


def _of_future(leaf: _Leaf, call: ast.Call, origin: Origin, spot: Spot) -> _Told:
    """Return what is said of a future's result that is read too early: how to wait for it."""
    assert isinstance(call.func, ast.Attribute)
    future, source = call.func.value, leaf.source
    name = ast.unparse(future)
    scope = own_nodes(leaf.function) if leaf.function else source.nodes
    before = [n for n in scope if isinstance(n, ast.Call) and n.lineno <= call.lineno]
    waits = [n for n in before if ast.unparse(n.func).endswith("spin_until_future_complete")]
    if any(name in map(ast.unparse, n.args) for n in waits):
        cause = f"`{leaf.text}` is None: the response did not arrive in the time that line {waits[-1].lineno} waits."
        return (cause, spot.place or origin.place, _asked_first(origin.name, spot))
    cause = (
        f"`{leaf.text}` returns None until the response has arrived, and nothing before this waits for it."
    )
    place = source.at(call)
    functions = [function for function in (leaf.function, spot.function) if function]
    if any(_is_called_back(source, function) for function in functions):
        fix = f"write {name}.add_done_callback(self.answered) instead, and use future.result() in that method: def answered(self, future)"
        return cause, place, fix
    node = _node_of(leaf, future, source)
    if not isinstance(future, (ast.Name, ast.Attribute)):
        lines = f"`future = {name}`, then `rclpy.spin_until_future_complete({node}, future)`"
        return cause, place, f"write {lines} above line {call.lineno}, and future instead of {name} in it"
    return cause, place, f"write `rclpy.spin_until_future_complete({node}, {name})` above line {call.lineno}"


def _is_called_back(source: PythonSource, function: Function) -> bool:
    """Return whether a function is a callback of ROS, or is called by one."""
    calls = source.calls
    made = (call for call in calls if getattr(call.func, "attr", "").startswith("create_"))
    given = {last_name(value) for call in made for value in given_to(call)}
    own = (call.lineno for call in calls if ast.unparse(call.func) == f"self.{function.name}")
    callers = {caller.name for line in own if (caller := source.function_at(line))}
    return bool({function.name, *callers} & given)


def _node_of(leaf: _Leaf, future: ast.expr, source: PythonSource) -> str:
    """Return the expression for the node near a future: self in its class, or the client's owner."""
    names = [argument.arg for argument in leaf.function.args.args] if leaf.function else []
    if "self" in names:
        return "self"
    asked = [future, *_assigned(source, future, leaf.function)]
    calls = [n for expression in asked for n in walk(expression) if isinstance(n, ast.Call)]
    client = next((n.func.value for n in calls if isinstance(n.func, ast.Attribute)), None)
    if isinstance(client, ast.Name):  # client = node.create_client(...)
        made = [n for n in _assigned(source, client, leaf.function) if isinstance(n, ast.Call)]
        client = made[0].func if made else client
    return ast.unparse(client.value) if isinstance(client, ast.Attribute) else "node"


def _of_get(leaf: _Leaf, call: ast.Call, origin: Origin, spot: Spot) -> _Told:
    """Return what is said of a dictionary's get() with a key that it does not have."""
    owner, key = ast.unparse(getattr(call.func, "value")), ast.unparse(call.args[0])  # noqa: B009
    place = leaf.source.at(call)
    if owner in ("os.environ", "environ"):
        cause = f"`{leaf.text}` returns None, because the variable {key} is not set where the program was started."
        fix = f"type export {key.strip(chr(39))}=... in the terminal before you start the program"
        return cause, place, fix
    made = [n for n in Spot(leaf.source, call.lineno).assigned(owner) if isinstance(n, ast.Dict)]
    keys = [ast.unparse(known) for node in made for known in node.keys if known]
    near = nearest(key, keys) if isinstance(call.args[0], ast.Constant) else None
    cause = f"{origin.name} is None on line {spot.line}: `{leaf.text}` returns None for a key that {owner} does not have."
    if near:
        return f"{cause} It has {near}.", place, f"write {near} instead of {key}"
    use = spot.place or place
    return cause, use, _asked_first(origin.name, spot)


def _of_own_function(source: PythonSource, function: ast.FunctionDef) -> _Told:
    last, values = function.body[-1], returned(function)
    place = source.at(last)
    if values:
        cause = f"{function.name}() returns nothing when none of its conditions is true."
        fix = f"add another return at its end for all other cases, as in `{ast.unparse(values[0])}`"
        return cause, place, fix
    is_value = isinstance(last, ast.Expr) and not isinstance(last.value, ast.Call)
    fix = "end it with return and the value it should return"
    if is_value:
        fix = f"write return {ast.unparse(last)}"
    return f"{function.name}() returns nothing, because it has no return statement.", place, fix


def of_what_gives_nothing(origin: Origin, call: ast.Call, spot: Spot) -> _Told:
    """Return what is said of a call that returns nothing: how to write it so that its name keeps a value."""
    name, line, written = origin.name, origin.line, ast.unparse(call)
    cause = f"`{written}` returns nothing, so line {line} sets {name} to None."
    if isinstance(call.func, ast.Attribute) and not isinstance(call.func.value, (ast.Name, ast.Attribute)):
        made = ast.unparse(call.func.value)
        rest = written.removeprefix(made)
        return cause, origin.place, f"write {name} = {made}, and {name}{rest} on a line of its own below it"
    kept = _kept(origin, call, spot)
    if not kept:
        fix = f"write {written} on a line of its own, and {name} = ... below it, with the value that line {spot.line} needs"
        return cause, origin.place, fix
    more = (
        f"and {name} = {kept} below it" if kept != name else f"without {name} ="
    )  # the name has its value already
    return cause, origin.place, f"write {written} on a line of its own, {more}"


def _kept(origin: Origin, call: ast.Call, spot: Spot) -> str:
    """Return what the name was to hold: the call's object or an argument; empty if neither fits."""
    modules = {imported.local for imported in origin.source.imports}
    owner = call.func.value if isinstance(call.func, ast.Attribute) else None
    of = [owner] if owner is not None and ast.unparse(owner) not in {*modules, "self"} else []
    given = [*map(ast.unparse, (*of, *call.args))]
    is_wait = ast.unparse(call.func).endswith("spin_until_future_complete") and len(call.args) > 1
    values = [*dict.fromkeys([*([f"{ast.unparse(call.args[1])}.result()"] if is_wait else []), *given])]
    statement = next((n for n in origin.source.nodes if isinstance(n, ast.Assign) and n.value is call), None)
    if statement is None or not values:
        return ""
    lines = origin.source.text.encode().splitlines(keepends=True)
    begin = f"{ast.unparse(call)}; {origin.name} = "
    texts = [b"".join(Edit(statement, f"{begin}{value}").applied(lines)) for value in values]
    is_here = origin.source is spot.file
    found = [
        value
        for value, rows in zip(values, checked(origin.source, texts), strict=True)
        if not any(row.line in spot.lines for row in rows if is_here)
    ]
    return found[0] if found else ""


def may_be_left(spot: Spot) -> bool:
    """Return whether a function may return early at a line: it is no constructor and returns no value."""
    function = spot.function
    is_plain = isinstance(function, ast.FunctionDef) and function.name != "__init__"
    return is_plain and not returned(function)  # type: ignore[arg-type]


def left_out(lacks: str, has: str, name: str, spot: Spot) -> str:
    """Return how to skip a line, and what uses a name below it, under the condition `lacks`, the opposite of `has`."""
    function = spot.function
    if function is None or function.name == "__init__":
        return (
            f"write `if {has}:` above line {head(spot, ())}, and indent everything that uses {name} below it"
        )
    loops = [
        node
        for node in ast.walk(function)
        if isinstance(node, (ast.For, ast.While)) and node.lineno < spot.line <= (node.end_lineno or 0)
    ]
    body = max(loops, key=lambda node: node.lineno).body if loops else function.body
    leave = "continue" if loops else "return"
    return (
        f"write these two lines above line {head(spot, body)}: `if {lacks}:`, and indented below it `{leave}`"
    )


def head(spot: Spot, body: Sequence[ast.stmt]) -> int:
    """Return the first line of the statement in a body that contains the line."""
    return next((statement.lineno for statement in body if contains(statement, spot.line)), spot.line)
