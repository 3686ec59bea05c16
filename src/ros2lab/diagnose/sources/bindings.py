"""What statements give to a name: the expression, and which of its items."""

from __future__ import annotations

import ast
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass

Path = tuple[int | None, ...]  # the index of the item that is taken out, or None for any


@dataclass(frozen=True)
class Import:
    """A name that an import statement binds: `local` stands for `target`, such as `rclpy.node.Node`."""

    local: str
    target: str
    line: int
    is_from: bool
    is_guarded: bool

    @property
    def meant(self) -> str:
        """The full name of what the name stands for: `import os.path` binds `os`."""
        first = self.target.partition(".")[0]
        return self.target if self.is_from or self.local != first else first


def imports_in(
    parent: ast.AST, absolute: Callable[[ast.ImportFrom], str], *, is_guarded: bool = False
) -> Iterator[tuple[ast.AST, list[Import]]]:
    """Yield the import statements below a node, each with the names that it binds."""
    for node in ast.iter_child_nodes(parent):
        line = getattr(node, "lineno", 0)
        if isinstance(node, ast.Import):
            pairs = [(a.asname or a.name.partition(".")[0], a.name) for a in node.names]
            yield node, [Import(local, name, line, False, is_guarded) for local, name in pairs]
        elif isinstance(node, ast.ImportFrom):
            home = f"{module}." if (module := absolute(node)) else ""
            pairs = [(a.asname or a.name, f"{home}{a.name}") for a in node.names]
            yield node, [Import(local, name, line, True, is_guarded) for local, name in pairs]
        elif not isinstance(node, ast.expr):
            # An import in a `try` or below a condition does not always happen.
            is_unsure = is_guarded or isinstance(node, (ast.Try, ast.If))
            yield from imports_in(node, absolute, is_guarded=is_unsure)


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
