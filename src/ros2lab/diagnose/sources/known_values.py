"""Values and definitions that are followed from file to file, also into other packages of the workspace."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    assigned_to,
    last_name,
    own_nodes,
    walk,
)
from ros2lab.diagnose.sources.static_value import UNKNOWN, dotted, evaluate
from ros2lab.diagnose.sources.syntax_parts import all_parameters, stores_in

if TYPE_CHECKING:
    from ros2lab.diagnose.sources.node_source import Creation, NodeClass, NodeSources

_DEEPEST = 5  # names and calls through which a definition is followed
_Defined = tuple[PythonSource, ast.expr]


def value_of(sources: NodeSources, source: PythonSource, node: ast.expr | None) -> Any:
    """Return the value of an expression, from the constants of its file and those that it imports, or `UNKNOWN`."""
    known = evaluate(node, source.constants, {})
    if known is not UNKNOWN or node is None:
        return known
    names = dict(source.constants)
    for inner in walk(node):
        text = dotted(inner)
        if text and text not in names and (home := _home(sources, source, inner)):
            names |= {text: home[0].constants[home[1]]} if home[1] in home[0].constants else {}
    return evaluate(node, names, {})


def declaring(source: PythonSource, read: ast.expr) -> list[ast.Call]:
    """Return the calls of a file that declare the parameter that an expression reads; none if it reads none."""
    match source.written(read):
        case ast.Call(func=ast.Attribute(attr="get_parameter_value", value=inner)):
            return declaring(source, inner)
        case ast.Call(func=ast.Attribute(attr="declare_parameter"), args=[_, *_]) as call:
            return [call]
        case ast.Call(func=ast.Attribute(attr="get_parameter"), args=[name]):
            declared = (c for c in source.calls if last_name(c.func) == "declare_parameter" and c.args)
            return [call for call in declared if ast.unparse(call.args[0]) == ast.unparse(name)]
    return []


def default_of(source: PythonSource, read: ast.expr) -> ast.expr | None:
    """Return the default of the parameter that an expression reads, as far as its file declares it; None if it reads none."""
    given = [call.args[1] for call in declaring(source, read) if len(call.args) > 1]
    return given[0] if len(given) == 1 else None


def _home(sources: NodeSources, source: PythonSource, node: ast.AST) -> tuple[PythonSource, str] | None:
    """Return the file of the workspace in which a name is defined, and its name there."""
    name = sources.resolve(source, node) or ""
    module, _, rest = name.rpartition(".")
    for _ in range(2):  # in a module, or in a class there
        if found := sources.file(module):
            return found, rest
        module, _, owner = module.rpartition(".")
        rest = f"{owner}.{rest}"
    return None


def definition(sources: NodeSources, creation: Creation, node: ast.expr | None) -> _Defined | None:
    """Return the expression that an argument of a call stands for, with its file; None if it may be another.

    Names are followed to what is assigned to them, once and nowhere changed, and calls of the workspace's functions
    to what they return; any other expression is its own.
    """
    around = _Around(creation.source, creation.function, creation.owner)
    return _followed(sources, around, node, _DEEPEST) if node is not None else None


@dataclass(frozen=True)
class _Around:
    """Where an expression stands: its file, and the function and the class around it."""

    source: PythonSource
    function: Function | None
    owner: NodeClass | None = None


def _followed(sources: NodeSources, around: _Around, node: ast.expr, depth: int) -> _Defined | None:
    source = around.source
    found: _Defined | None = (source, node)
    if depth == 0:
        found = None
    elif isinstance(node, ast.Call) and (home := _home(sources, source, node.func)):
        function = home[0].functions.get(home[1])
        returned = [n.value for n in own_nodes(function) if isinstance(n, ast.Return)] if function else []
        if function is not None:
            value = returned[0] if len(returned) == 1 else None
            found = _followed(sources, _Around(home[0], function), value, depth - 1) if value else None
    elif isinstance(node, (ast.Name, ast.Attribute)):
        bound = _bound(sources, around, node)
        if len(bound) == 1:
            file, value = bound[0]
            inside = around if file is source else _Around(file, None)
            found = None if _is_changed(sources, file, node) else _followed(sources, inside, value, depth - 1)
        elif bound or not (sources.resolve(source, node) or "").startswith("rclpy."):
            found = None
    return found


def _bound(sources: NodeSources, around: _Around, node: ast.Name | ast.Attribute) -> Sequence[_Defined]:
    """Return what is assigned to a name: in its function or file, in its classes, or in the file it comes from."""
    text, function = ast.unparse(node), around.function
    if function and text in {parameter.arg for parameter in all_parameters(function)}:
        return ()
    if text.startswith("self.") and around.owner:
        return [
            (inner.source, value)
            for inner in sources.lineage(around.owner)[0]
            for nodes, name in (([*walk(inner.definition)], text), (inner.definition.body, text[5:]))
            for value in assigned_to(nodes, name)
        ]
    if here := assigned_to(around.source.nodes, text):
        return [(around.source, value) for value in here]
    if (home := _home(sources, around.source, node)) is None:
        return ()
    file, name = home
    owner, _, last = name.rpartition(".")
    inside = file.classes.get(owner)
    nodes = (inside.body if inside else ()) if owner else own_nodes(file.tree)
    return [(file, value) for value in assigned_to(nodes, last)]


def _is_changed(sources: NodeSources, home: PythonSource, node: ast.Name | ast.Attribute) -> bool:
    """Return whether any file sets an attribute of what has a name, as `PROFILE.depth = 5` does."""
    last = ast.unparse(node).rpartition(".")[2]
    stored = (n for source in {*sources.sources.values(), home} for n in stores_in(source.nodes))
    owners = (ast.unparse(node.value) for node in stored if isinstance(node, ast.Attribute))
    return any(owner.rpartition(".")[2] == last for owner in owners)
