"""Attributes that a node computes once, from what changes later."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.node_source import is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, own_nodes, walk
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import makes_text
from ros2lab.diagnose.sources.uses import State


def computed_once(state: State) -> Iterator[Finding]:
    """Yield values that the constructor computes once from what changes later, and callbacks still use."""
    for text in state.stores:
        value = state.initial(text)
        base = text.rpartition(".")[0]
        if value is None or (base != "self" and state.initial(base) is None):
            continue
        readers = [
            (method, node)
            for method, node in state.loads.get(text if base == "self" else base, ())
            if id(method) in state.uses.callbacks
        ]
        if not readers or not (makes_text(value) or isinstance(value, ast.BinOp)):
            continue
        used = {dotted(node) or "" for node in walk(value) if isinstance(node, ast.Attribute)}
        changed = next(
            ((attribute, by) for attribute in sorted(used) if (by := state.changes(attribute))), None
        )
        if changed is None or (not makes_text(value) and not _is_shown(readers)):
            continue
        attribute, by = changed
        if _is_of_use(state, attribute, value):
            continue  # it changes for others, and this may be what it was at first
        line = f"{text} = {ast.unparse(value)}"
        cause = (
            f"{text} is computed only once, in __init__, and is not updated when {by}() changes {attribute}."
        )
        fix = f"write `{line}` as the first line of {readers[0][0].name}()"
        yield Finding("computed-once", cause, state.at(state.stores[text][0][1]), fix)


def _is_of_use(state: State, attribute: str, value: ast.expr) -> bool:
    """Return whether an attribute is read anywhere but in a value that is computed once, or to change it."""
    inside = {id(node) for node in walk(value)}
    reads = [node for _, node in state.loads.get(attribute, ()) if id(node) not in inside]
    return bool(reads) or attribute.rpartition(".")[2] in state.uses.read_of_others


def _is_shown(readers: list[tuple[Function, ast.AST]]) -> bool:
    """Return whether what is read is assigned unchanged to a field of a message."""
    return any(
        isinstance(node, ast.Assign) and node.value is given and not is_self_attribute(node.targets[0])
        for method, given in readers
        for node in own_nodes(method)
    )
