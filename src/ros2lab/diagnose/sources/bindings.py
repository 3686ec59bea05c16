"""What statements give to a name: the expression, and which of its items."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterable, Iterator

Path = tuple[int | None, ...]  # the index of the item that is taken out, or None for any


def bindings(nodes: Iterable[ast.AST], name: str) -> Iterator[tuple[ast.expr, Path]]:
    """Yield what assignments, loops and `with` among some nodes give to a name or to `self.name`."""
    for node in nodes:
        match node:
            case ast.Assign(targets=targets, value=value):
                for target in targets:
                    yield from _unpacked(target, value, (), name)
            case (
                ast.AnnAssign(target=target, value=ast.expr() as value)
                | ast.NamedExpr(target=target, value=value)
                | ast.withitem(optional_vars=ast.expr() as target, context_expr=value)
            ):
                yield from _unpacked(target, value, (), name)
            case ast.For(target=target, iter=over) | ast.comprehension(target=target, iter=over):
                yield from _unpacked(target, over, (None,), name)


def _unpacked(target: ast.expr, value: ast.expr, path: Path, name: str) -> Iterator[tuple[ast.expr, Path]]:
    """Yield which part of a value a target gives to a name."""
    if isinstance(target, (ast.Tuple, ast.List)):
        for number, inner in enumerate(target.elts):
            yield from _unpacked(inner, value, (*path, number), name)
    elif isinstance(target, (ast.Name, ast.Attribute)) and ast.unparse(target) == name:
        yield value, path


def bound_by(node: ast.AST) -> Collection[str]:
    """Return the names that a node binds."""
    found: Collection[str | None] = ()
    match node:
        case ast.Import() | ast.ImportFrom():
            found = [alias.asname or alias.name.partition(".")[0] for alias in node.names]
        case ast.Name(ctx=ast.Store() | ast.Del()):
            found = [node.id]
        case ast.arg():
            found = [node.arg]
        case ast.MatchMapping():
            found = [node.rest]
        case ast.Global() | ast.Nonlocal():
            found = node.names
        case (
            ast.FunctionDef()
            | ast.AsyncFunctionDef()
            | ast.ClassDef()
            | ast.ExceptHandler()
            | ast.MatchAs()
            | ast.MatchStar()
        ):
            found = [node.name]
    return [*filter(None, found)]
