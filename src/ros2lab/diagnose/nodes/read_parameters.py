"""Parameters that nodes read: undeclared, of another node, or as another type."""

from __future__ import annotations

import ast
import contextlib
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from typing import Any

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.parameter_faults import declared_in
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.parameter_file import kind_of
from ros2lab.diagnose.sources.python_source import PythonSource, argument, children, walk
from ros2lab.diagnose.sources.spelling import nearest
from ros2lab.diagnose.sources.static_value import UNKNOWN
from ros2lab.diagnose.sources.syntax_parts import calls_in, calls_of


def parameter_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield parameters that a node reads but never declares, or reads as another type."""
    declared = declared_in(sources)
    if declared is None:
        return
    yield from _read_as_another(sources, declared)
    for source in sources.sources.values():
        if "undeclared_parameters" in source.text or "automatically_declare" in source.text:
            return
    nodes = sources.node_names
    for source in sources.sources.values():
        if sources.hands_itself_on(source):
            continue
        makes_node = any(sources.resolve(source, node) == "rclpy.create_node" for node in source.nodes)
        for owner, _, node in sources.scoped(source):
            if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.args):
                continue
            is_own = makes_node or getattr(node.func.value, "id", "") == "self"
            if node.func.attr != "get_parameter" or not is_own:
                continue
            name = sources.value(source, node.args[0])
            if isinstance(name, str) and name != "use_sim_time":
                own = {
                    n: default for n, default in declared.items() if n in _own_names(sources, source, owner)
                }
                if name not in own:
                    yield _undeclared(name, own, source, node, of_another_node(name, own, nodes))


def _undeclared(
    name: str, own: Collection[str], source: PythonSource, call: ast.Call, asked: tuple[str, str] | None
) -> Finding:
    """Say that a node does not declare a parameter that it reads, and what may be meant."""
    there = f" The declared parameters are: {', '.join(sorted(own))}." if any(own) else ""
    close = nearest(name, own, 0.5)
    default = default_by_use(source.nodes, call) or "..."
    fix = f"write `self.declare_parameter({name!r}, {default})` in the constructor, before it is read"
    fix += "; replace the dots with its default value" * (default == "...")
    if asked:
        (there, fix), close = asked, None
    if close:
        fix = f"write {close!r} if that is meant; otherwise {fix.removeprefix('write ')}"
    cause = f"The parameter {name!r} is read but never declared.{there}"
    return Finding("parameter-undeclared", cause, source.at(call), fix)


def of_another_node(name: str, own: Collection[str], nodes: Collection[str]) -> tuple[str, str] | None:
    """Return what to add to the cause, and the fix, for a parameter's name that begins with that of a node; else None."""
    found = re.fullmatch(r"(?P<node>/[\w/]+)/(?P<name>[\w.]+)|(?P<first>\w+)[./](?P<rest>[\w.]+)", name)
    if not found or (found["first"] and found["first"] not in nodes):
        return None
    if found["first"] and any(known.startswith(f"{found['first']}.") for known in own):
        return None  # a group of its own
    node, inner = found["node"] or found["first"], found["name"] or found["rest"]
    there = " A node reads only its own parameters, by their names alone."
    if inner in own:
        return there, f"write {inner!r}, which is declared here"
    there = f"{there[:-1]}; for those of {node} it has to ask that node."
    client = f"`self.client = AsyncParameterClient(self, {node!r})`"
    fix = f"write {client} in the constructor, with `from rclpy.parameter_client import AsyncParameterClient` at the top, and take {inner} from what comes when `self.client.get_parameters([{inner!r}])` is done"
    return there, fix


def _own_names(sources: NodeSources, source: PythonSource, owner: NodeClass | None) -> Collection[str]:
    """Return the parameters that a class, what it shares a subclass with, or what runs with it may declare.

    Those of the other nodes that run with it are not its own.
    """
    family = [sources.lineage(node)[0] for node in sources.nodes]
    near = [inner for chain in family if owner in chain for inner in chain]
    others = [node for node in sources.nodes if near and node not in near]
    skipped = {
        id(call)
        for node in others
        for call in calls_in(walk(node.definition))
        if is_self_attribute(call.func)
    }
    return declared_in(sources, sources.together(source.name), skipped) or ()


# A default that suits how the value is used.
_BY_USE = {
    "double_value": "1.0",
    "integer_value": "1",
    "string_value": "''",
    "bool_value": "False",
    "float": "1.0",
    "int": "1",
    "range": "1",
    "str": "''",
    "bool": "False",
    "create_timer": "1.0",
    "sleep": "1.0",
}


def default_by_use(nodes: Iterable[ast.AST], call: ast.AST, *, follows: bool = True) -> str | None:
    """Return a default that suits how a parameter's value is used, if it follows also in a variable; None if that says nothing."""
    above = {id(inner): node for node in nodes for inner in children(node)}
    while (node := above.get(id(call))) is not None:
        match node:
            case ast.Attribute(attr=attr) if attr in _BY_USE:
                return _BY_USE[attr]
            case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)) if name in _BY_USE:
                return _BY_USE[name]
            case ast.BinOp(op=ast.Mult() | ast.Div() | ast.Sub()):
                return "1.0"
            case ast.Assign(targets=[target]) if node.value is call and follows:
                return _default_by_name(nodes, target)
            case ast.stmt():
                return None
        call = node
    return None


def _default_by_name(nodes: Iterable[ast.AST], target: ast.expr) -> str | None:
    """Return a default that suits how the name is used that holds a parameter's value; else None."""
    text = ast.unparse(target)
    alike = (n for n in nodes if isinstance(n, type(target)) and isinstance(n, (ast.Name, ast.Attribute)))
    loads = [n for n in alike if isinstance(n.ctx, ast.Load) and ast.unparse(n) == text]
    return next(filter(None, (default_by_use(nodes, load, follows=False) for load in loads)), None)


# The Python type of what each field of a ParameterValue holds, by the first word of its name.
_TYPES: Mapping[str, Callable[..., Any]] = {"bool": bool, "integer": int, "double": float, "string": str}
_FIELD = re.compile(rf"({'|'.join(_TYPES)})(_array)?_value")


def _read_as_another(sources: NodeSources, declared: Mapping[str, Any]) -> Iterator[Finding]:
    """Yield parameter values that are read from the field of another type, which is always empty."""
    for source in sources.sources.values():
        for node in source.nodes:
            name = _read_from(sources, source, node) if isinstance(node, ast.Attribute) else None
            default = declared.get(name, UNKNOWN) if name else UNKNOWN
            right = _field_of(default)
            if not isinstance(node, ast.Attribute) or not _FIELD.fullmatch(right) or right == node.attr:
                continue
            cause = f"The parameter {name} is declared with {default!r}, so its value is in {right}; its {node.attr} is always {_empty(node.attr)}."
            place, fix = source.at(node), f"write .{right} instead of .{node.attr}"
            # A field that is asked for by name is meant, unless its use needs what was declared.
            use, new = default_by_use(source.nodes, node), _as_in(node.attr, default)
            if new is not None and (use is None or _field_of(ast.literal_eval(use)) != right):
                for home, value in _defaults(sources, name, default):
                    place, fix = home.at(value), f"write {new!r} instead of {ast.unparse(value)}"
                    cause = f"The parameter {name} is declared with {default!r}, so its value is in {right}, but {source.at(node)} reads {node.attr}, which is always {_empty(node.attr)}."
            yield Finding("parameter-type", cause, place, fix)


def _empty(field: str) -> str:
    """Return the value of a field of a ParameterValue that is not set."""
    kind = _FIELD.fullmatch(field)
    return repr(_TYPES[kind[1]]()) if kind and not kind[2] else "empty"


def _field_of(value: Any) -> str:
    """Return the field of a ParameterValue in which a value is."""
    return f"{kind_of(value)}_value".lower()


def _read_from(sources: NodeSources, source: PythonSource, node: ast.Attribute) -> str | None:
    """Return the parameter from one of whose fields an expression reads; None if it is none, or not known."""
    match source.written(node.value) if _FIELD.fullmatch(node.attr) else None:
        case ast.Call(func=ast.Attribute(attr="get_parameter_value", value=parameter)):
            match source.written(parameter):
                case ast.Call(
                    func=ast.Attribute(attr="get_parameter" | "declare_parameter"), args=[given, *_]
                ):
                    name = sources.value(source, given)
                    return name if isinstance(name, str) else None
    return None


def _as_in(field: str, default: Any) -> Any:
    """Return a default as a value of the type of a field; None if that would be another value."""
    kind = _TYPES[field.partition("_")[0]]
    if isinstance(default, list) != ("array" in field):
        return None
    with contextlib.suppress(ValueError, TypeError):
        new = [*map(kind, default)] if isinstance(default, list) else kind(default)
        is_same = new == default or kind is str or (isinstance(default, str) and kind is not bool)
        return new if is_same else None
    return None


def _defaults(
    sources: NodeSources, name: str | None, default: Any
) -> Iterator[tuple[PythonSource, ast.expr]]:
    """Yield where a parameter's default is written, each with its file."""
    for source in sources.sources.values():
        for call in calls_of(source.nodes, "declare_parameter"):
            value = argument(call, 1, "value")
            if value and sources.value(source, argument(call, 0, "name")) == name:
                written = source.written(value)
                if sources.value(source, written) == default:
                    yield source, written
