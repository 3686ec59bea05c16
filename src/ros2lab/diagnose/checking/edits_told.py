"""Turns a fix in words into the edits of a student who applies it literally."""

from __future__ import annotations

import ast
import difflib
import re
from collections.abc import Iterable, Iterator

from ros2lab.diagnose.checking.edits import Edit

_ALIKE = 0.6  # the least similarity of two texts, as difflib measures it
_IN_PLACE = re.compile(r"write `?(?P<new>.+?)`? instead of `?(?P<old>.+?)`?(?:, with .*)?$", re.DOTALL)
_WRITTEN = re.compile(r"write (?P<sign>`?)(?P<new>.+?)(?P=sign)(?:, with .*)?$")


def edits_told(fix: str, statement: ast.stmt | None, expressions: Iterable[ast.expr]) -> Iterator[Edit]:
    """Yield the edits that a student may make who applies the fix of a statement, or of its expressions, literally."""
    if match := _IN_PLACE.match(fix):
        for node in expressions:
            if ast.unparse(node) == _plain(match["old"]):
                yield Edit(node, match["new"])
            elif isinstance(node, ast.Attribute) and node.attr == match["old"]:
                yield Edit(node, f"{ast.unparse(node.value)}.{match['new']}")
    elif (match := _WRITTEN.match(fix)) and statement is not None and _plain(match["new"]):
        written = match["new"]
        yield Edit(statement, written)
        yield from (Edit(node, written) for node in expressions if _is_like(node, written))


def _plain(text: str) -> str:
    """Return a statement as `ast` writes it; empty if it cannot be parsed."""
    try:
        return ast.unparse(ast.parse(text.strip()))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return ""


def _is_like(node: ast.expr, written: str) -> bool:
    return isinstance(node, (ast.Call, ast.Attribute, ast.BinOp, ast.Compare)) and (
        difflib.SequenceMatcher(None, ast.unparse(node), written).ratio() >= _ALIKE
    )
