"""Replacements of expressions and statements in a file, also as a student makes them who applies a fix in words."""

from __future__ import annotations

import ast
import copy
import difflib
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.calls import missing_imports
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.syntax_parts import stores_in


@dataclass(frozen=True)
class Edit:
    """A replacement for an expression or a statement."""

    node: ast.expr | ast.stmt
    text: str

    def applied(self, lines: Sequence[bytes]) -> list[bytes]:
        """Return the lines of a file with the edit applied."""
        node = self.node
        first, last = node.lineno - 1, (node.end_lineno or node.lineno) - 1
        before, after = lines[first][: node.col_offset], lines[last][node.end_col_offset :]
        return [*lines[:first], before + self.text.encode() + after, *lines[last + 1 :]]

    def of(self, source: PythonSource) -> bytes:
        """Return the text of a file with the edit."""
        return b"".join(self.applied(source.lines))

    def with_imports(self, source: PythonSource, lines: Sequence[bytes]) -> bytes:
        """Return the text of a file, or of a copy of its lines, with the edit and the imports that it needs."""
        added = [f"\n{line}".encode() for line in missing_imports(source, self.text)]
        return b"".join([*self.applied(lines), *added])

    def is_idle(self, source: PythonSource) -> bool:
        """Return whether the new text means the same as the old one, as `str('a')` and `'a'` do."""
        try:
            new = ast.parse(self.text.strip()).body
        except (SyntaxError, ValueError):
            return False
        old = [self.node if isinstance(self.node, ast.stmt) else ast.Expr(self.node)]
        return [ast.unparse(_Bare(source).visit(copy.deepcopy(statement))) for statement in new] == [
            ast.unparse(_Bare(source).visit(ast.parse(ast.unparse(statement)).body[0])) for statement in old
        ]

    def keeps_names(self, source: PythonSource) -> bool:
        """Return whether the edit keeps every name that is assigned only here and used elsewhere."""
        try:
            new = ast.parse(self.text.strip())
        except (SyntaxError, ValueError):
            return True
        inside = {id(node) for node in ast.walk(self.node)}
        others = [node for node in source.nodes if id(node) not in inside]
        lost = _stored(ast.walk(self.node)) - _stored(ast.walk(new)) - _stored(others)
        used = (node for node in others if isinstance(node, (ast.Name, ast.Attribute)))
        return not lost or all(ast.unparse(node) not in lost for node in used)


def all_applied(lines: Sequence[bytes], edits: Iterable[Edit]) -> list[bytes]:
    """Return the lines of a file with several edits, the last of which comes first."""
    found = [*lines]
    for edit in sorted(edits, key=lambda edit: (edit.node.lineno, edit.node.col_offset), reverse=True):
        found = edit.applied(found)
    return found


def revealing(source: PythonSource, asked: Sequence[ast.expr]) -> bytes:
    """Return the text of a file that asks the type checker for the types of expressions; they may lie in each other."""
    lines = [*source.lines]
    begins = ((node.lineno, node.col_offset, b"reveal_type(") for node in asked)
    ends = ((node.end_lineno or 0, node.end_col_offset or 0, b")") for node in asked)
    for number, column, text in sorted([*begins, *ends], reverse=True):
        line = lines[number - 1]
        lines[number - 1] = line[:column] + text + line[column:]
    return b"".join(lines)


def copied(source: PythonSource, text: bytes) -> PythonSource:
    """Return a file with another text."""
    return PythonSource(source.name, source.shown, text.decode(), source.is_package)


class _Bare(ast.NodeTransformer):
    """Removes conversions of plain values to the type that they already have."""

    def __init__(self, source: PythonSource) -> None:
        self.source = source

    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        match node:
            case ast.Call(
                func=ast.Name(id="str" | "int" | "float" | "bool" as kind), args=[value], keywords=[]
            ):
                made = Spot(self.source, 0).assigned(ast.unparse(value))
                known = made[0] if len(made) == 1 else value
                is_text = isinstance(known, ast.JoinedStr) and kind == "str"
                is_of_kind = isinstance(known, ast.Constant) and type(known.value).__name__ == kind
                return value if is_text or is_of_kind else node
        return node


def _stored(nodes: Iterable[ast.AST]) -> set[str]:
    """Return the names and attributes to which some nodes assign."""
    return {ast.unparse(target) for target in stores_in(nodes)}


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
