"""Calls of what only ROS calls, or what only an instance has: a callback without its message, a method of a class."""

from __future__ import annotations

import ast

from ros2lab.diagnose.checking.type_words import made_of
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.one_run import in_loops
from ros2lab.diagnose.sources.python_source import Function, PythonSource, walk
from ros2lab.diagnose.sources.removal import removal
from ros2lab.diagnose.sources.syntax_parts import calls_in

_GIVEN = {"create_subscription": "each message", "create_service": "each request"}
_DESTROYED = ("publisher", "subscription", "client", "service", "timer")


def of_callback(call: ast.Call, missing: str, spot: Spot, look: Look) -> tuple[str, str] | None:
    """Return cause and fix of a call of a node's callback without what ROS passes to it; None for another call."""
    name = getattr(call.func, "attr", "")
    found = (
        (creation, function)
        for package in look.packages
        for creation, function in look.sources(package).callbacks()
        if function.name == name and creation.method in _GIVEN
    )
    creation, _ = next(found, (None, None))
    statement = spot.source.above(call) if spot.source else None
    if (
        creation is None
        or not isinstance(statement, ast.Expr)
        or not isinstance(call.func, ast.Attribute)
        or call.args
    ):
        return None
    when, owner = _GIVEN[creation.method], ast.unparse(call.func.value)
    cause = f"{name} is a callback, which ROS calls with {when} while the node spins; here it is called without {missing}."
    return cause, _instead(spot, statement, "" if owner == "self" else owner)


def _instead(spot: Spot, statement: ast.Expr, node: str) -> str:
    """Return what to write instead of a statement that calls a callback; `node` is empty for self."""
    text = ast.unparse(statement)
    is_repeated = spot.function is not None and id(statement) in in_loops(spot.function)
    spins = _spins(spot.source, spot.function, statement)
    if node and (is_repeated or not spins):
        turn = "spin_once" if is_repeated else "spin"
        return f"write `rclpy.{turn}({node})` instead of `{text}`"
    return removal(spot.source, statement) if spot.source else f"remove `{text}`"


def _spins(source: PythonSource | None, function: Function | None, statement: ast.stmt) -> bool:
    later = [call for call in calls_in(walk(function)) if call.lineno > statement.lineno] if function else []
    return source is not None and any(source.resolve(call.func) == "rclpy.spin" for call in later)


def of_class_method(call: ast.Call, spot: Spot) -> tuple[str, str] | None:
    """Return cause and fix of a method that is called on its class instead of an instance; None for another call."""
    function = call.func
    if not (isinstance(function, ast.Attribute) and isinstance(function.value, ast.Name) and spot.source):
        return None
    name = function.value.id
    own = any(isinstance(n, ast.ClassDef) and n.name == name for n in spot.source.nodes)
    if not (own or spot.source.names.get(name) == "rclpy.node.Node"):
        return None
    made = made_of(name, spot)
    kind = function.attr.removeprefix("destroy_")
    if kind in _DESTROYED and [*map(type, call.args)] == [ast.Constant]:
        cause = f"{name} is the class itself and not a node, and what {function.attr}() takes is the {kind}, not its name."
        why = f": {made}.destroy_node() destroys its {kind}s, too" if made else ""
        return cause, f"{removal(spot.source, call)}{why}"
    if not made or any(isinstance(value, ast.Name) and value.id in (made, "self") for value in call.args):
        return None
    written = ast.unparse(call).replace(f"{name}.", f"{made}.", 1)
    return f"{name} is the class itself; its instance here is {made}.", f"write `{written}`"
