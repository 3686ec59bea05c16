"""Instances that a class's own code hands to other code, which may give them attributes."""

from __future__ import annotations

import ast
import builtins
import sys
from collections.abc import Iterator, Mapping

from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    given_to,
    last_name,
    parameters,
    walk,
)

# Code that takes a node as it is; what may set attributes by name is listed below.
_BUILTINS = frozenset(dir(builtins))
_TAKES_ONLY = interfaces.PACKAGES | sys.stdlib_module_names | _BUILTINS
_SETS_BY_NAME = ("setattr", "__getattr__", "__dict__", "'vars'")


class Given:
    """What code other than a class itself sets on its instances."""

    def __init__(self, sources: Mapping[str, PythonSource]) -> None:
        self._sources = sources
        self._seen: set[tuple[int, frozenset[str]]] = set()
        self.names: set[str] = set()
        self.is_known = True

    def within(self, source: PythonSource, scope: ast.AST, held: frozenset[str]) -> None:
        """Note what a scope sets on the instances that some of its expressions hold, and what is done where it hands them on."""
        if (id(scope), held) in self._seen or not held or not self.is_known:
            return
        self._seen.add((id(scope), held))
        if held - {"self"} and isinstance(scope, (ast.ClassDef, Function)):
            self._is_set_by_name(scope)
        for node in walk(scope):
            if source.gives(node):
                self.names |= {node.attr} if ast.unparse(node.value) in held else set()
            elif isinstance(node, ast.Call) and any(ast.unparse(value) in held for value in _given(node)):
                self._handed_to(source, node.func)

    def of_class(self, source: PythonSource, definition: ast.ClassDef) -> None:
        """Note what is set on `self` in a class, and by its decorators."""
        self._is_set_by_name(definition)
        self.within(source, definition, frozenset(("self",)))
        for decorator in definition.decorator_list:
            self._handed_to(source, decorator.func if isinstance(decorator, ast.Call) else decorator)

    def _is_set_by_name(self, scope: ast.AST) -> None:
        text = ast.dump(scope)
        self.is_known &= not any(word in text for word in _SETS_BY_NAME)

    def _handed_to(self, source: PythonSource, function: ast.expr) -> None:
        if self._takes_only(source, function):
            return
        called = list(self._own(function))
        self.is_known &= bool(called)
        for home, definition in called:
            makers = [definition] if isinstance(definition, Function) else definition.body
            takes = {p.arg for m in makers if isinstance(m, Function) for p in parameters(m)} - {"self"}
            kept = {
                ast.unparse(target)
                for node in walk(definition)
                if isinstance(node, ast.Assign) and getattr(node.value, "id", "") in takes
                for target in node.targets
            }
            self.within(home, definition, frozenset(takes | kept))

    def _own(self, function: ast.expr) -> Iterator[tuple[PythonSource, ast.ClassDef | Function]]:
        """Yield the functions and classes of these files that a call may mean."""
        name = last_name(function)
        for source in self._sources.values():
            for node in source.nodes:
                if isinstance(node, (ast.ClassDef, Function)) and node.name == name:
                    yield source, node

    def _takes_only(self, source: PythonSource, function: ast.expr, depth: int = 0) -> bool:
        """Return whether a function is of Python or ROS, also through an object that they made."""
        node: ast.AST | None = function
        own = {f"self.{member}" for member in interfaces.node_members()}
        while node is not None and depth < 5:
            if name := source.resolve(node):
                return name.partition(".")[0] in _TAKES_ONLY
            if isinstance(node, ast.Attribute) and ast.unparse(node) in own:
                return True
            made = [value for text, value in source.made if text == ast.unparse(node)]
            if made:
                return all(self._takes_only(source, value.func, depth + 1) for value in made)
            if isinstance(node, ast.Name) and node.id in _BUILTINS:
                return True
            node = getattr(node, "func", getattr(node, "value", None))
        return False


def _given(call: ast.Call) -> Iterator[ast.expr]:
    """Yield the arguments of a call, and the items of those that are written as lists."""
    for value in given_to(call):
        yield value
        yield from getattr(value, "elts", None) or getattr(value, "values", None) or ()


def given_from_outside(
    sources: Mapping[str, PythonSource], chain: Mapping[str, tuple[PythonSource, ast.ClassDef]]
) -> frozenset[str] | None:
    """Return the attributes that other code gives a class with its bases (`chain`, by full names); None if not all are known."""
    given = Given(sources)
    for source, definition in chain.values():
        given.of_class(source, definition)
    for name, source in sources.items():
        made = {
            text
            for text, value in source.made
            if (source.resolve(value.func) or "") in chain or f"{name}.{ast.unparse(value.func)}" in chain
        }
        given.within(source, source.tree, frozenset(made))
    return frozenset(given.names) if given.is_known else None
