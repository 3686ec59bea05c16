"""Calls of the wrong thing: of what only ROS or an instance calls, or asked of what lacks it while another at hand has it."""

from __future__ import annotations

import ast
import builtins
import sys
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.checking.checked_copies import first_that_stands
from ros2lab.diagnose.checking.trials import UNKNOWN_TYPE, type_of
from ros2lab.diagnose.checking.type_words import made_of, plain
from ros2lab.diagnose.code.at_hand import holders
from ros2lab.diagnose.code.unknown_names import Unknown
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.calls import missing_imports
from ros2lab.diagnose.sources.one_run import in_loops
from ros2lab.diagnose.sources.python_source import Function, PythonSource, own_nodes, walk
from ros2lab.diagnose.sources.syntax_parts import calls_in, removal

_MOST = 3  # variables whose types are asked for
_KNOWN = interfaces.PACKAGES | sys.stdlib_module_names  # modules whose functions say what they take


def of_another_owner(owner: str, name: str, spot: Spot) -> tuple[str, str] | None:
    """Return cause and fix of a call such as `rclpy.destroy_node(node)` or `node.spin()`; None if no owner is at hand."""
    source, calls = spot.source, calls_in(spot.nodes)
    calls = [call for call in calls if isinstance(call.func, ast.Attribute) and call.func.attr == name]
    if source is None or len(calls) != 1:
        return None
    ways = dict(_ways(source, calls[0], name))
    good = first_that_stands(source, calls[0], [*ways])
    if not good:
        return None
    cause = f"{plain(owner)} has no {name}: {ways[good]}."
    more = "".join(f", with `{line}` at the top" for line in missing_imports(source, good))
    return cause, f"write `{good}` instead of `{ast.unparse(calls[0])}`{more}"


def _ways(source: PythonSource, call: ast.Call, name: str) -> Iterator[tuple[str, str]]:
    """Yield the calls that may be meant, each with a clause that says who has the function."""
    assert isinstance(call.func, ast.Attribute)
    own = [] if _is_module(source, call.func.value) else [ast.unparse(call.func.value)]
    given, named = [*map(ast.unparse, call.args)], [*map(ast.unparse, call.keywords)]
    values = ", ".join([*given, *named])
    for number, value in enumerate(call.args):
        is_named = isinstance(value, (ast.Name, ast.Attribute)) and not _is_module(source, value)
        kind = type_of(source, value) if is_named else ""
        if kind and not UNKNOWN_TYPE.search(kind):
            rest = [*given[:number], *given[number + 1 :], *named]
            for others in (rest, [*own, *rest]):
                yield f"{given[number]}.{name}({', '.join(others)})", f"{given[number]} has it"
    for function, clause in _functions(source, name, is_of_module=not own):
        for taken in (", ".join([*own, *given, *named]), values):
            yield f"{function}({taken})", clause
    asked = (source.resolve(call.func.value) or "").partition(".")[0]
    # No method is meant as a function of Python's own modules, but many as one of rclpy.
    elsewhere = () if asked in sys.stdlib_module_names else _elsewhere(source, call, name, own)
    yield from ((f"{called}({values})", clause) for called, clause in elsewhere)


def _elsewhere(
    source: PythonSource, call: ast.Call, name: str, own: Sequence[str]
) -> Iterator[tuple[str, str]]:
    """Yield what may be called with the same arguments: under a longer name, or by what is at hand."""
    longer = sorted(member for member in interfaces.node_members() if member.startswith(f"{name}_"))
    yield from ((f"{owner}.{member}", f"it is called {member}") for owner in own for member in longer)
    around = source.function_at(call.lineno)
    itself = ["self"] * bool(around and around.name == name)  # which would call itself
    others = (holder for holder in _at_hand(source, call, name) if holder not in (*own, *itself))
    yield from ((f"{holder}.{name}", f"{holder} has it") for holder in others)


def _at_hand(source: PythonSource, call: ast.Call, name: str) -> Iterator[str]:
    """Yield the objects around a call that have a method, or may have it by a type that is known."""
    unknown = Unknown(source, name, call)
    held = holders(unknown, {name})
    yield from held
    own = own_nodes(unknown.scopes[0])
    made = {
        target.id: node.value
        for node in own
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call) and node.lineno < call.lineno
        for target in node.targets
        if isinstance(target, ast.Name) and target.id not in held
    }
    for variable, value in [*made.items()][-_MOST:]:
        kind = type_of(source, value)
        if kind and not UNKNOWN_TYPE.search(kind):
            yield variable


def _functions(source: PythonSource, name: str, *, is_of_module: bool) -> Iterator[tuple[str, str]]:
    """Yield the functions of a name that a file can call, each with a clause that says where it is."""
    if name in source.functions:
        yield name, "it is a function of this file"
    for imported in source.imports:
        is_known = not imported.is_from and imported.target.partition(".")[0] in _KNOWN
        if is_known and interfaces.has_name(imported.target, name):
            yield f"{imported.local}.{name}", f"it is in {imported.target}"
    built_in = getattr(builtins, name, None)  # whose classes, such as range, no module's function is meant as
    if callable(built_in) and not (is_of_module and isinstance(built_in, type)):
        yield name, "it is a function of Python"


def _is_module(source: PythonSource, node: ast.expr) -> bool:
    target = source.resolve(node) or ""
    return any(target == imported.target and not imported.is_from for imported in source.imports)


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
