"""How to remove a statement, so that what is left is still Python."""

from __future__ import annotations

import ast

from ros2lab.diagnose.sources.python_source import PythonSource

_BLOCKS = ("body", "orelse", "finalbody")


def removal(source: PythonSource, node: ast.AST, what: str = "") -> str:
    """Return how to remove a statement, called `what`: a loop goes with its only line, and another block keeps a `pass`."""
    above = source.above(node)
    statement = above if isinstance(above, ast.Expr) else node
    what = what or f"`{ast.unparse(node)}`"
    while isinstance(loop := _left_empty(source, statement), (ast.For, ast.While)):
        if loop.orelse:
            break
        statement, what = loop, f"the whole loop `{ast.unparse(loop).splitlines()[0]}`"
    return f"write `pass` instead of {what}" if loop else f"remove {what}"


def _left_empty(source: PythonSource, statement: ast.AST) -> ast.AST | None:
    """Return what has a block in which a statement is alone; None if it is not alone."""
    for node in source.nodes:
        if any(getattr(node, name, None) == [statement] for name in _BLOCKS):
            return None if isinstance(node, ast.Module) else node
    return None
