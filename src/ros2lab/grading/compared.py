"""The texts that a program compares its input with: by `==`, by `case`, or as a key of a dictionary."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator

LONGEST, MOST = 30, 100  # characters, texts


def compared(code: Iterable[ast.AST]) -> list[str]:
    """Return the short texts that some code, such as all that runs, compares something with."""
    return sorted({text for node in code for text in _texts(node)})[:MOST]


def _texts(node: ast.AST) -> Iterator[str]:
    values: list[ast.expr | None] = []
    match node:
        case ast.Compare(left=left, ops=ops, comparators=others):
            if all(isinstance(operator, (ast.Eq, ast.NotEq)) for operator in ops):
                values = [left, *others]
        case ast.MatchValue(value=value):
            values = [value]
        case ast.Dict(keys=keys):
            values = keys
    for expression in values:
        match expression:
            case ast.Constant(value=str(text)) if len(text) <= LONGEST:
                yield text
