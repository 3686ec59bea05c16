"""What the files of a package define, and what of it anything reads, calls or changes."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterator
from functools import cached_property

from ros2lab.diagnose.sources.node_source import LOG_METHODS, NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, PythonSource, own_nodes, walk
from ros2lab.diagnose.sources.static_value import dotted

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
    def nodes(self) -> tuple[ast.AST, ...]:
        """Everything in the files."""
        return tuple(node for source in self.sources.sources.values() for node in source.nodes)

    @cached_property
    def stored_of_others(self) -> frozenset[str]:
        """The attributes that something gives to what is not `self`, which may be a node all the same."""
        return frozenset(
            node.attr
            for node in self.nodes
            if isinstance(node, ast.Attribute) and not isinstance(node.ctx, ast.Load)
            if not (dotted(node) or "").startswith("self.")
        )

    @cached_property
    def read_of_others(self) -> frozenset[str]:
        """The attributes that something reads of what is not `self`, also by `getattr()` and its like."""
        found = set()
        for node in self.nodes:
            if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load):
                found |= set() if is_self_attribute(node) else {node.attr}
            elif isinstance(node, ast.Call) and getattr(node.func, "id", "").endswith("attr"):
                found |= {str(given.value) for given in node.args if isinstance(given, ast.Constant)}
        return frozenset(found)

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
        self._sources: dict[int, PythonSource] = {}
        for member, method in ((one, function) for one in family for function in one.functions):
            values = values_in(method)
            for node in walk(method):
                self._sources[id(node)] = member.source
                if isinstance(node, ast.Attribute) and (text := dotted(node) or "").startswith("self."):
                    if isinstance(node.ctx, ast.Store):
                        self.stores.setdefault(text, []).append((method, node, values.get(id(node))))
                    else:
                        self.loads.setdefault(text, []).append((method, node))
        self.read = {
            *(text.split(".")[1] for text in self.loads),
            *uses.read_of_others,
        }

    def at(self, node: ast.AST | None) -> str:
        """Return the place of a part of the class, or of a class that it is derived from."""
        return self._sources.get(id(node), self.source).at(node)

    def first(self, text: str) -> ast.expr | None:
        """Return what `__init__` gives an attribute, if nothing outside the class may give it anything else."""
        values = [value for method, _, value in self.stores.get(text, ()) if method.name == "__init__"]
        name = text.rpartition(".")[2]
        others = [other for other in self.stores if other.endswith(f".{name}") and other != text]
        is_own = name not in self.uses.stored_of_others and not others
        return values[0] if len(values) == 1 and is_own else None

    def initial(self, text: str) -> ast.expr | None:
        """Return what `__init__` gives an attribute, if that is all that anybody gives it."""
        return self.first(text) if len(self.stores.get(text, ())) == 1 else None

    def later(self, text: str) -> list[tuple[Function, ast.AST, ast.expr | None]]:
        """Return where an attribute is given something but in `__init__`."""
        return [store for store in self.stores.get(text, ()) if store[0].name != "__init__"]

    def changes(self, text: str) -> str:
        """Return the callback in which an attribute is changed; empty if none changes it."""
        return next(
            (method.name for method, *_ in self.stores.get(text, ()) if id(method) in self.uses.callbacks), ""
        )


def values_in(function: Function) -> dict[int, ast.expr | None]:
    """Return what is assigned to each target of a function, by the target's identity."""
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


def filled(function: Function) -> Iterator[tuple[str, ast.expr]]:
    """Yield the fields of messages that a function fills, each with what it is given."""
    for node in own_nodes(function):
        target = node.targets[0] if isinstance(node, ast.Assign) else None
        if isinstance(node, ast.Assign) and isinstance(target, ast.Attribute):
            text = ast.unparse(target)
            if not text.startswith("self."):
                yield text, node.value
