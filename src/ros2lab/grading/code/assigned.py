"""What code assigns to names and attributes."""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

from ros2lab.diagnose.sources.node_source import NodeClass
from ros2lab.diagnose.sources.python_source import Function, PythonSource, own_nodes, walk
from ros2lab.grading.code.cases import leaves, text_of


@dataclass(frozen=True, eq=False)
class Store:
    """An assignment.

    Attributes:
        target: a name or an attribute.
        node: what has to run for it.
        value: the assigned value; None if it is not known.
        path: the indices of the part that is assigned, if the value is unpacked.
        change: the operator of an augmented assignment; None for any other.
    """

    target: ast.expr
    node: ast.AST
    value: ast.expr | None
    path: tuple[int, ...] = ()
    change: ast.operator | None = None

    @property
    def is_change(self) -> bool:
        """Whether the new value depends on the old one."""
        own = text_of(self.target)
        return self.change is not None or any(
            text_of(leaf) == own for leaf in leaves(self.value or self.target)
        )


Scope = tuple[PythonSource, NodeClass | None, Function | None]


class Stores:
    """All assignments in some files: by attribute, by function and local name, or by file and global name.

    Args:
        scopes: by node, the file, the class and the function that it stands in.
    """

    def __init__(self, scopes: Mapping[ast.AST, Scope]) -> None:
        self._scopes = scopes
        self._found: dict[object, list[Store]] = defaultdict(list)
        told = set[ast.AST]()
        for node in scopes:
            for store in assigned(node):
                told.add(store.target)
                self._found[self.key(store.target)].append(store)
        for node in scopes:
            if (
                isinstance(node, (ast.Name, ast.Attribute))
                and node not in told
                and not isinstance(node.ctx, ast.Load)
            ):
                self._found[self.key(node)].append(Store(node, node, None))

    def __contains__(self, key: object) -> bool:
        return key in self._found

    def get(self, key: object) -> list[Store] | None:
        """Return the assignments to what has a key; None if there are none."""
        return self._found.get(key)

    def key(self, target: ast.AST) -> object:
        """Return the key of a target, or of a name or attribute that is read."""
        source, owner, function = self._scopes[target]
        if isinstance(target, ast.Attribute):
            return target.attr
        name = getattr(target, "id", "")
        if function is None:
            return name if owner else (source, name)
        shared = {
            declared
            for node in own_nodes(function)
            if isinstance(node, (ast.Global, ast.Nonlocal))
            for declared in node.names
        }
        if name not in shared:
            return (function, name)
        outer = self._scopes[function][2]
        return (outer, name) if outer and (outer, name) in self._locals else (source, name)

    @cached_property
    def _locals(self) -> frozenset[tuple[ast.AST, str]]:
        return frozenset(
            (function, node.id)
            for node, (_, _, function) in self._scopes.items()
            if function and isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
        )


def assigned(node: ast.AST) -> Iterator[Store]:
    """Yield what a node assigns to names and attributes."""
    match node:
        case ast.Assign(targets=targets, value=value):
            # A dict counts as run where something looks it up.
            run = value if isinstance(value, ast.Dict) else node
            for target in targets:
                yield from _bound(target, run, value, ())
        case (
            ast.AnnAssign(target=target, value=ast.expr() as value)
            | ast.NamedExpr(target=target, value=value)
        ):
            yield from _bound(target, node, value, ())
        case ast.AugAssign(target=target, op=sign, value=value):
            if isinstance(target, (ast.Name, ast.Attribute)):
                yield Store(target, node, value, (), sign)


def _bound(target: ast.expr, node: ast.AST, value: ast.expr, path: tuple[int, ...]) -> Iterator[Store]:
    match target:
        case ast.Name() | ast.Attribute():
            yield Store(target, node, value, path)
        case ast.Tuple(elts=parts) | ast.List(elts=parts) if not any(
            isinstance(part, ast.Starred) for part in parts
        ):
            for number, part in enumerate(parts):
                yield from _bound(part, node, value, (*path, number))


_LOOPS = (ast.For, ast.AsyncFor, ast.While)
_INSIDE = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda, ast.ClassDef, ast.comprehension)
_BLOCKS = ("body", "orelse", "finalbody")


def value_before(source: PythonSource, leaf: ast.expr, name: str) -> ast.expr | None:
    """Return what a variable was certainly given last before it is read; None if that is not sure, or of several parts."""
    node: ast.AST = leaf
    while (above := source.above(node)) is not None:
        for block in (getattr(above, field, None) for field in _BLOCKS):
            if isinstance(block, list) and node in block:
                for earlier in reversed(block[: block.index(node)]):
                    if _binds(earlier, name):
                        return _given(earlier, name)
        is_again = isinstance(above, (*_LOOPS, ast.Try)) and _binds(above, name)
        if is_again or isinstance(above, _INSIDE):
            return None
        node = above
    return None


def _given(statement: ast.AST, name: str) -> ast.expr | None:
    match statement:
        case ast.Assign(targets=[ast.Name(id=told)], value=value) if told == name:
            return value if len([*leaves(value)]) <= 1 else None
    return None


def _binds(statement: ast.AST, name: str) -> bool:
    return any(
        (isinstance(node, ast.Name) and node.id == name and not isinstance(node.ctx, ast.Load))
        or (isinstance(node, (ast.Global, ast.Nonlocal)) and name in node.names)
        or getattr(node, "name", None) == name
        for node in walk(statement)
    )
