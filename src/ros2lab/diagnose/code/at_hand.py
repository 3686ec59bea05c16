"""The object at hand that a name which nothing defines is meant for: a node, what it has made, or an exception."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.code.unknown_names import Unknown, also_on, cause_of
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.construction import is_node_class
from ros2lab.diagnose.sources.node_source import is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, last_name, own_nodes, parameters, walk
from ros2lab.diagnose.sources.signatures import signature_of
from ros2lab.diagnose.sources.spelling import edits

_NEAR = 2  # letters that differ
_SPUN = ("rclpy.spin", "rclpy.spin_once", "rclpy.spin_until_future_complete")
# What the methods of a node make, by the modules and names of their classes.
_MADE = {
    "create_publisher": ("rclpy.publisher", "Publisher"),
    "create_client": ("rclpy.client", "Client"),
    "create_timer": ("rclpy.timer", "Timer"),
    "create_subscription": ("rclpy.subscription", "Subscription"),
    "create_node": ("rclpy.node", "Node"),
}


def as_at_hand(unknown: Unknown) -> tuple[str, str] | None:
    """Read the name as the only variable around it that holds what its uses ask for: `talker.destroy_node()`."""
    is_node = any(_is_spun(unknown, use) for use in unknown.uses)
    if not (unknown.attributes or is_node) or f"self.{unknown.name}" in unknown.source.stored:
        return None
    names = holders(unknown, unknown.attributes, is_node=is_node)
    if len(names) != 1 or (names[0] not in unknown.loaded and edits(names[0], unknown.name) <= _NEAR):
        return None  # it may be misspelt where it is assigned
    cause = f"{cause_of(unknown)} Did you mean {names[0]}?"
    return cause, unknown.with_text(unknown.node, names[0]) + also_on(unknown, names[0])


def as_method(unknown: Unknown) -> tuple[str, str] | None:
    """Read the name as a method of the only object around it that has it: `get_logger()` for `node.get_logger()`."""
    call, name = unknown.above(), unknown.name
    if not unknown.is_called or not isinstance(call, ast.Call) or f"self.{name}" in unknown.source.stored:
        return None
    names = holders(unknown, {name})
    if len(names) != 1 and not (names and name.startswith("get_")):
        return None
    whole = f"{names[0]}.{name}"
    signature = signature_of(
        unknown.source, ast.Call(ast.parse(whole, mode="eval").body, call.args, call.keywords)
    )
    if signature and not signature.accepts(call):
        return None
    cause = f"{name} is a method, so it is called with its object before it, which is {names[0]} here."
    return cause, unknown.with_text(unknown.node, whole)


def as_exception(unknown: Unknown) -> tuple[str, str] | None:
    """Read `e` in an `except` that gives the exception no name."""
    node = unknown.node
    while not isinstance(node, (ast.Module, Function, ast.ExceptHandler)):
        node = unknown.above(node)
    word = unknown.name.lower()
    is_exception = any(whole.startswith(word) for whole in ("error", "exception", "exc", "err"))
    if not isinstance(node, ast.ExceptHandler) or node.name or not is_exception:
        return None
    kind = ast.unparse(node.type) if node.type else "Exception"
    cause = f"{cause_of(unknown)} The `except` on line {node.lineno} gives the exception no name."
    return cause, f"write `except {kind} as {unknown.name}:` on line {node.lineno}"


def is_own_node(unknown: Unknown, name: str) -> bool:
    """Return whether a name is that of a node class of the file, or of Node itself."""
    return is_node_class(unknown.source, ast.Name(name))


def holders(unknown: Unknown, wanted: set[str], *, is_node: bool = False) -> list[str]:
    """Return the variables and attributes of `self` of the innermost scope that surely have the wanted members."""
    found = ([*dict.fromkeys(_held(unknown, scope, wanted, is_node=is_node))] for scope in unknown.scopes)
    return next(filter(None, found), [])


def _held(unknown: Unknown, scope: ast.AST, wanted: set[str], *, is_node: bool) -> Iterator[str]:
    line = getattr(unknown.node, "lineno", 0)
    for node in own_nodes(scope):
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call() as call) if node.lineno < line:
                if _fits(unknown, call, wanted, is_node=is_node):
                    yield name
    owner = unknown.above(scope)
    is_method = isinstance(owner, ast.ClassDef) and isinstance(scope, Function)
    if not (is_method and isinstance(scope, Function) and [p.arg for p in parameters(scope)][:1] == ["self"]):
        return
    assert isinstance(owner, ast.ClassDef)
    if is_own_node(unknown, owner.name) and wanted <= _members(unknown, owner.name):
        yield "self"
    for node in walk(owner):
        match node:
            case ast.Assign(
                targets=[ast.Attribute(value=ast.Name(id="self"), attr=name)], value=ast.Call() as call
            ) if _fits(unknown, call, wanted, is_node=is_node):
                yield f"self.{name}"


def _fits(unknown: Unknown, call: ast.Call, wanted: set[str], *, is_node: bool) -> bool:
    name = last_name(call.func)
    members = _members(unknown, name)
    is_made = is_own_node(unknown, name) or name == "create_node"
    return (is_made or not is_node) and bool(members) and wanted <= members


def _members(unknown: Unknown, name: str) -> set[str]:
    """Return what an object has that a class of the file, Node or a method of a node makes; empty if not known."""
    if name in _MADE:
        return {*interfaces.members_of(*_MADE[name])}
    if not is_own_node(unknown, name):
        return set()
    definition = unknown.source.classes.get(name)
    own = walk(definition) if definition else ()
    found = {
        getattr(n, "attr", getattr(n, "name", ""))
        for n in own
        if is_self_attribute(n) or isinstance(n, Function)
    }
    return found | {*interfaces.node_members()}


def _is_spun(unknown: Unknown, use: ast.Name) -> bool:
    around = unknown.above(use)
    if not (isinstance(around, ast.Call) and around.args[:1] == [use]):
        return False
    return unknown.source.resolve(around.func) in _SPUN or getattr(around.func, "attr", "") == "add_node"
