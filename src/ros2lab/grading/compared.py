"""The texts with which a program compares what it gets: by `==`, by `case`, or as a key of a dictionary."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator

LONGEST, MOST = 30, 100  # characters, texts


def compared(code: Iterable[ast.AST]) -> list[str]:
    """Return the short texts with which something is compared in code, such as all that runs."""
    return sorted({text for node in code for text in _texts(node)})[:MOST]


def _texts(node: ast.AST) -> Iterator[str]:
    values: list[ast.expr | None] = []
    match node:
        case ast.Compare(left=left, ops=ops, comparators=others):
            if all(isinstance(one, (ast.Eq, ast.NotEq)) for one in ops):
                values = [left, *others]
        case ast.MatchValue(value=value):
            values = [value]
        case ast.Dict(keys=keys):
            values = keys
    for one in values:
        match one:
            case ast.Constant(value=str(text)) if len(text) <= LONGEST:
                yield text
