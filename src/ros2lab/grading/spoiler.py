"""Break modules on purpose: a program of a box, which `own_tests` starts.

Only the standard library: it is shown nothing else of the grader.
"""

from __future__ import annotations

import ast
import contextlib
import json
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

Spoiler = Callable[[ast.Module], ast.Module]

LARGEST = 1_000_000  # bytes of a module that is broken
HARMLESS = "comment"
_ENTRANCES = ("main",)  # what only starts a node is not what tests are about


def spoil(files: Iterable[Path], kind: str) -> None:
    """Break modules of which nothing has run.

    Args:
        files: the modules.
        kind: one of `SPOILERS`, or `HARMLESS`, which only adds a comment.
    """
    for path in files:
        if path.stat().st_size <= LARGEST:
            # What no parser can read stays as it is: it is broken enough.
            with contextlib.suppress(SyntaxError, ValueError, RecursionError, MemoryError):
                source = path.read_bytes()
                if kind == HARMLESS:
                    path.write_bytes(source.rstrip() + b"\n# the end\n")
                else:
                    text = ast.unparse(SPOILERS[kind](ast.parse(source)))
                    path.write_text(text, encoding="utf-8")


def _empty(tree: ast.Module) -> ast.Module:
    """Take away what the functions do, except the makers of objects and what starts a node."""
    for node in ast.walk(tree):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            is_special = node.name.startswith("__") or node.name in _ENTRANCES
            is_generator = any(isinstance(inner, (ast.Yield, ast.YieldFrom)) for inner in ast.walk(node))
            if not is_special and not is_generator:
                node.body = [ast.Return(ast.Constant(None))]
    return ast.fix_missing_locations(tree)


class _Change(ast.NodeTransformer):
    """Change every text and number, except docstrings and what asks whether a file is run as a program."""

    def visit_Constant(self, node: ast.Constant) -> ast.Constant:
        value = node.value
        if isinstance(value, str) and value != "__main__":
            return ast.copy_location(ast.Constant(f"{value}x"), node)
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            return ast.copy_location(ast.Constant(value + 1), node)
        return node

    def visit_Expr(self, node: ast.Expr) -> ast.Expr:
        return node if isinstance(node.value, ast.Constant) else self.generic_visit(node)  # type: ignore[return-value]

    def visit_JoinedStr(self, node: ast.JoinedStr) -> ast.JoinedStr:
        return node


def _change(tree: ast.Module) -> ast.Module:
    _Change().visit(tree)
    return ast.fix_missing_locations(tree)


SPOILERS: Mapping[str, Spoiler] = {"empty": _empty, "change": _change}


if __name__ == "__main__":
    spoil(map(Path, json.load(sys.stdin)), sys.argv[1])
