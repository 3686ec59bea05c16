"""What the files of a package define, and what of it anything reads, calls or changes."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterator
from functools import cached_property

from ros2lab.diagnose.node_source import LOG_METHODS, NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.python_source import Function, own_nodes, walk
from ros2lab.diagnose.static_value import dotted

FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
LONGEST_NAME = 200  # letters of a text that may name something


class Uses:
    """Every name that something in a package's files reads."""

    def __init__(self, sources: NodeSources) -> None:
        self.sources = sources
        self.named: Counter[str] = (
            Counter()
        )  # as it is written: names, attributes, and what texts may ask for
        self.resolved: Counter[str] = Counter()  # names of the package's own, with their modules
        for source in sources.sources.values():
            for node in source.nodes:
                self.named.update(named(node))
                if isinstance(node, (ast.Name, ast.Attribute)):
                    self.resolved[sources.resolve(source, node) or ""] += 1

    @cached_property
    def callbacks(self) -> dict[int, str]:
        """By their identities the functions that ROS calls, and what these call, with how ROS was given them."""
        found: dict[int, str] = {}
        owners = {id(m): one for one in self.sources.classes.values() for m in one.methods.values()}
        waiting = [(function, creation.method) for creation, function in self.sources.callbacks()]
        while waiting:
            function, how = waiting.pop()
            if id(function) in found:
                continue
            found[id(function)] = how
            for node in own_nodes(function):
                called = node.func if isinstance(node, ast.Call) else None
                if is_self_attribute(called):
                    method = self.sources.method(owners.get(id(function)), called.attr)
                    waiting += [(method, how)] if method is not None else []
        return found


def named(node: ast.AST) -> Iterator[str]:
    """Yield the names that a part of a program reads, also those in its texts."""
    if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
        yield node.id
    elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load):
        yield node.attr
    elif isinstance(node, ast.Constant) and isinstance(node.value, str) and len(node.value) < LONGEST_NAME:
        yield from re.findall(r"\w+", node.value)


class State:
    """What a node class keeps in its attributes, by their texts such as `self.msg.data`, and where it is changed."""

    def __init__(self, uses: Uses, owner: NodeClass) -> None:
        self.uses, self.owner, self.source = uses, owner, owner.source
        family = [
            one
            for one in uses.sources.classes.values()
            if owner in uses.sources.lineage(one)[0] or one in uses.sources.lineage(owner)[0]
        ]
        self.stores: dict[str, list[tuple[Function, ast.AST, ast.expr | None]]] = {}
        self.loads: dict[str, list[tuple[Function, ast.AST]]] = {}
        for method in (method for one in family for method in one.methods.values()):
            values = _values(method)
            for node in walk(method):
                if isinstance(node, ast.Attribute) and (text := dotted(node) or "").startswith("self."):
                    if isinstance(node.ctx, ast.Store):
                        self.stores.setdefault(text, []).append((method, node, values.get(id(node))))
                    else:
                        self.loads.setdefault(text, []).append((method, node))
        self.elsewhere = {
            node.attr
            for source in uses.sources.sources.values()
            for node in source.nodes
            if isinstance(node, ast.Attribute)
            and not isinstance(node.ctx, ast.Load)
            and not (dotted(node) or "").startswith("self.")
        }

    def initial(self, text: str) -> ast.expr | None:
        """Return what `__init__` gives an attribute, if that is all that anybody gives it."""
        stores = self.stores.get(text, [])
        is_only = len(stores) == 1 and stores[0][0].name == "__init__"
        return stores[0][2] if is_only and text.rpartition(".")[2] not in self.elsewhere else None

    def changes(self, text: str) -> str:
        """Return the callback in which an attribute is changed; empty if none changes it."""
        return next(
            (method.name for method, *_ in self.stores.get(text, ()) if id(method) in self.uses.callbacks), ""
        )


def _values(function: Function) -> dict[int, ast.expr | None]:
    return {
        id(target): node.value
        for node in walk(function)
        if isinstance(node, (ast.Assign, ast.AnnAssign))
        for target in (node.targets if isinstance(node, ast.Assign) else [node.target])
    }


def is_log(node: ast.AST) -> bool:
    """Return whether a call only shows something."""
    return isinstance(node, ast.Call) and (
        getattr(node.func, "id", "") == "print" or getattr(node.func, "attr", "") in LOG_METHODS
    )
