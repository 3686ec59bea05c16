"""Fields of a message that are filled where nobody receives them: after it is sent, or before it is made anew."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.interfaces import is_interface
from ros2lab.diagnose.sources.python_source import Function, PythonSource, children, own_nodes, walk


def lost_fillings(source: PythonSource, method: Function) -> Iterator[Finding]:
    """Yield message fields that are filled after the message is sent, or before it is created again."""
    made: dict[str, set[str]] = {}
    for node in own_nodes(method):
        for target in node.targets if isinstance(node, ast.Assign) else ():
            if isinstance(target, ast.Name) and isinstance(node, ast.Assign):
                made.setdefault(target.id, set()).add(_new(source, node))
    for name, kinds in made.items():
        # Otherwise it may stand for a message that others have, too.
        if len(kinds) == 1 and "" not in kinds and not is_shared(method, name):
            yield from _lost(source, method, name)


def _lost(source: PythonSource, method: Function, name: str) -> Iterator[Finding]:
    pending: ast.stmt | None = None
    sent: ast.stmt | None = None
    filled: set[str] = set()  # its fields that have a value, which may be what was meant to be sent
    for statement in method.body:
        fills, reads, binds = _changes_of(statement, name)
        if binds and isinstance(statement, ast.Assign) and pending is not None:
            cause = f"{name} is created again here, so what line {pending.lineno} filled in is lost."
            yield Finding("filling-lost", cause, source.at(statement), "remove this line")
            return
        if reads and not _sends(statement, name):
            return  # others may have it now
        if binds:
            pending, sent, filled = None, None, set()
        elif reads:
            pending, sent = None, statement
        pending = pending or next((fill for field, fill in fills.items() if not _is_in(field, filled)), None)
        filled |= fills.keys()
    if pending is not None and sent is not None:
        last = ast.unparse(sent).splitlines()[0]
        cause = f"`{ast.unparse(pending)}` comes after `{last}`, so it is not in what was sent."
        fix = f"move `{last}` after the lines that fill {name}"
        yield Finding("filling-lost", cause, source.at(pending), fix)


def _is_in(field: str, filled: set[str]) -> bool:
    """Return whether a field, or what it is a part of, or a part of it, is among those with a value."""
    return any(f"{field}.".startswith(f"{one}.") or one.startswith(f"{field}.") for one in filled)


def _new(source: PythonSource, node: ast.Assign) -> str:
    """Return the type of the new, empty message that is assigned; empty if it is anything else."""
    match node.value:
        case ast.Call(func=func, args=[], keywords=[]) if is_interface(kind := source.resolve(func)):
            return str(kind)
    return ""


def _sends(statement: ast.stmt, name: str) -> bool:
    """Return whether a statement only publishes a message."""
    match statement:
        case ast.Expr(value=ast.Call(func=ast.Attribute(attr="publish"), args=[ast.Name(id=sent)])):
            return sent == name
    return False


def _changes_of(statement: ast.stmt, name: str) -> tuple[dict[str, ast.stmt], bool, bool]:
    """Return the fields of a variable that a statement sets, each with where, whether it reads it otherwise, and assigns to it."""
    fills: dict[str, ast.stmt] = {}
    bases: set[int] = set()
    for inner in (node for node in walk(statement) if isinstance(node, ast.stmt)):
        for node in children(inner):
            base: ast.AST = node
            while isinstance(base, (ast.Attribute, ast.Subscript)):
                base = base.value
            is_field = base is not node and isinstance(node.ctx, ast.Store)  # type: ignore[attr-defined]
            if is_field and isinstance(base, ast.Name) and base.id == name:
                bases.add(id(base))
                fills.setdefault(ast.unparse(node), inner)
    names = [node for node in walk(statement) if isinstance(node, ast.Name) and node.id == name]
    reads = any(id(node) not in bases and isinstance(node.ctx, ast.Load) for node in names)
    return fills, reads, any(isinstance(node.ctx, ast.Store) for node in names)


def is_shared(function: Function, name: str) -> bool:
    """Return whether a variable is one of the file or of a function around, which others may read."""
    scopes = (node for node in walk(function) if isinstance(node, (ast.Global, ast.Nonlocal)))
    return any(name in scope.names for scope in scopes)
