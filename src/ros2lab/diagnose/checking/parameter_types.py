"""Tells the type checker which type each parameter has that the code reads: that of its declared default."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.checking.edits import Edit
from ros2lab.diagnose.nodes.parameter_faults import declared_in
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource

_READERS = frozenset(("get_parameter", "declare_parameter"))
_TYPES = (bool, int, float, str)  # their names convert a value, which tells its type


def parameter_casts(source: PythonSource, sources: NodeSources) -> Iterator[Edit]:
    """Yield edits that convert each parameter that is read to the type of its default, if that is known."""
    values = [node for node in source.nodes if isinstance(node, ast.Attribute) and node.attr == "value"]
    reads = [(node, name) for node in values if (name := _name_read(node, source, sources))]
    declared = declared_in(sources) if reads else None
    for node, name in reads:
        kind = type((declared or {}).get(name))
        if kind in _TYPES:
            yield Edit(node, f"{kind.__name__}({ast.unparse(node)})")


def _name_read(node: ast.Attribute, source: PythonSource, sources: NodeSources) -> str:
    """Return the name of the parameter whose value an expression reads; empty if it reads none."""
    match node.value:
        case ast.Call(func=ast.Attribute(attr=method), args=[given, *_]):
            name = sources.value(source, given) if method in _READERS else None
            return name if isinstance(name, str) else ""
    return ""
