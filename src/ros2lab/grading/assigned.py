"""What code assigns to names and attributes."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass

from ros2lab.grading.cases import leaves, text_of


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
