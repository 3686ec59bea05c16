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
        value: that is assigned; None if it is not known.
        path: which part of it, where it is unpacked.
        change: what it does with the value before, if anything.
    """

    target: ast.expr
    node: ast.AST
    value: ast.expr | None
    path: tuple[int, ...] = ()
    change: ast.operator | None = None

    @property
    def is_change(self) -> bool:
        """Whether what is assigned depends on what was there before."""
        own = text_of(self.target)
        return self.change is not None or any(
            text_of(leaf) == own for leaf in leaves(self.value or self.target)
        )


def assigned(node: ast.AST) -> Iterator[Store]:
    """Yield what a node assigns, as far as it tells to what."""
    match node:
        case ast.Assign(targets=targets, value=value):
            # A table runs where something names it.
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
            isinstance(one, ast.Starred) for one in parts
        ):
            for number, part in enumerate(parts):
                yield from _bound(part, node, value, (*path, number))
