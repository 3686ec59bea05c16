"""Replacements of expressions and statements in a file."""

from __future__ import annotations

import ast
import copy
from collections.abc import Iterable, Sequence
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
