"""The texts that a program compares its input with, or looks for in it.

It does so by `==`, by `case`, as a key of a dictionary, by `in`, or by a method of `str` or a function of `re`.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator

LONGEST, MOST = 30, 100  # characters, texts

# What looks for a text in another one, in Python's library: of `str`, and of `re`.
_OF_STR = frozenset(("startswith", "endswith", "find", "rfind", "index", "rindex", "count", "__contains__"))
_OF_RE = frozenset(("match", "fullmatch", "search", "findall", "finditer"))
LOOKS_FOR = _OF_STR | _OF_RE
_NO_LETTERS = re.compile(
    r"\\.|\(\?\w*[:)]?"
)  # what a pattern has letters for that are no letters of the text
_WORD = re.compile(r"[^\W\d_][\w -]*")


def compared(code: Iterable[ast.AST]) -> list[str]:
    """Return the short texts that some code, such as all that runs, compares something with."""
    return sorted({text for node in code for text in _texts(node)})[:MOST]


def _texts(node: ast.AST) -> Iterator[str]:
    values: list[ast.expr | None] = []
    match node:
        case ast.Compare(left=left, ops=ops, comparators=others):
            if all(isinstance(operator, (ast.Eq, ast.NotEq)) for operator in ops):
                values = [left, *others]
            elif isinstance(ops[0], (ast.In, ast.NotIn)):
                values = [left]  # what is in a constant tuple is not told apart
        case ast.MatchValue(value=value):
            values = [value]
        case ast.Dict(keys=keys):
            values = keys
        case ast.Call(func=ast.Attribute(attr=name), args=[first, *_]) if name in LOOKS_FOR:
            values = [first]
    for expression in values:
        match expression:
            case ast.Constant(value=str(text)) if len(text) <= LONGEST:
                yield from [text] if not _is_pattern(node) else _words_of(text)


def _is_pattern(node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in _OF_RE


def _words_of(pattern: str) -> list[str]:
    """Return the word in a pattern; none if there are several, which it does not tell apart."""
    words = _WORD.findall(_NO_LETTERS.sub("\0", pattern))
    return words if len(words) == 1 else []
