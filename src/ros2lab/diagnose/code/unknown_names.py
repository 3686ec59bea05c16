"""A name that nothing defines, what is around its uses, and how its line is rewritten."""

from __future__ import annotations

import ast
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from ros2lab.diagnose.sources.python_source import Function, PythonSource, walk

_LONGEST = 110  # characters of a line that is shown in full


@dataclass(frozen=True, eq=False)
class Unknown:
    """A use of a name that nothing defines.

    Attributes:
        node: where it is used first.
        members: the attributes that `self` has there.
        package: the name of the package, if it is known and the file is its setup.py.
    """

    source: PythonSource
    name: str
    node: ast.AST
    members: Collection[str] = ()
    package: str = ""
    own: Mapping[str, PythonSource] = field(default_factory=dict)

    def above(self, node: ast.AST | None = None) -> ast.AST:
        """Return the syntax node around another one, or around the use."""
        return self.source.above(node or self.node) or self.source.tree

    @cached_property
    def scopes(self) -> list[ast.AST]:
        """The functions around the use, the innermost first, and the file."""
        found, node = list[ast.AST](), self.node
        while node is not self.source.tree:
            below, node = node, self.above(node)
            if (isinstance(node, (Function, ast.Lambda)) and (below in _body(node))) or (
                isinstance(node, ast.ClassDef) and not found and below in node.body
            ):
                found.append(node)
        return [*found, self.source.tree]

    @cached_property
    def uses(self) -> list[ast.Name]:
        """The places where the name is used."""
        return [n for n in self.source.nodes if isinstance(n, ast.Name) and n.id == self.name]

    @property
    def is_called(self) -> bool:
        """Whether the use is a call."""
        return self.source.is_called(self.node)

    @property
    def is_type(self) -> bool:
        """Whether the use is an annotation, a decorator, a base class, or the name of an exception."""
        around = self.above()
        is_annotation = isinstance(around, (ast.arg, ast.AnnAssign, Function)) and self.node in (
            getattr(around, "annotation", None),
            getattr(around, "returns", None),
        )
        above = [*getattr(around, "decorator_list", ()), *getattr(around, "bases", ())]
        return is_annotation or self.node in above or self.is_exception

    @property
    def is_exception(self) -> bool:
        """Whether the use names an exception to catch or to raise."""
        around = self.above()
        around = self.above(around) if isinstance(around, (ast.Tuple, ast.Call)) else around
        return isinstance(around, (ast.ExceptHandler, ast.Raise))

    @property
    def attributes(self) -> set[str]:
        """The attributes that the uses ask for."""
        around = map(self.above, self.uses)
        return {node.attr for node in around if isinstance(node, ast.Attribute)}

    @property
    def statement(self) -> ast.stmt:
        """The statement around the use."""
        node = self.node
        while not isinstance(node, ast.stmt):
            node = self.above(node)
        return node

    @cached_property
    def loaded(self) -> set[str]:
        """The names that the file uses."""
        names = (n for n in self.source.nodes if isinstance(n, ast.Name))
        return {n.id for n in names if isinstance(n.ctx, ast.Load)}

    def line(self, node: ast.AST) -> str:
        """Return the line of a node."""
        return self.source.text.splitlines()[getattr(node, "lineno", 1) - 1]

    def with_text(self, node: ast.AST, text: str) -> str:
        """Say to write a line with another text for one of its nodes."""
        return written_with(self.source, node, text)


def written_with(source: PythonSource, node: ast.AST, text: str) -> str:
    """Say to write a line with another text for one of its nodes, or only the text if the line is not a statement."""
    old = ast.get_source_segment(source.text, node) or ast.unparse(node)
    number = getattr(node, "lineno", 1)
    row = source.text.splitlines()[number - 1].encode()
    start, end = getattr(node, "col_offset", 0), getattr(node, "end_col_offset", 0)
    new = as_code(b"".join((row[:start], text.encode(), row[end:])).decode(errors="replace"))
    is_there = row[start:end].decode(errors="replace") == old
    statements = [n for n in source.nodes if isinstance(n, ast.stmt) and n.lineno == number]
    is_whole = any(n.end_lineno == number or hasattr(n, "body") for n in statements)
    return f"write {new}" if is_there and is_whole and new else f"write `{text}` instead of `{old}`"


def _body(node: ast.AST) -> list[ast.AST]:
    body = getattr(node, "body", [])
    return [*(body if isinstance(body, list) else [body])]


def as_code(line: str) -> str:
    """Return a line as code to write; empty if it is too long to be shown."""
    bare = line.partition("  #")[0].strip()
    return f"`{bare}`" if len(bare) <= _LONGEST and "`" not in bare else ""


def cause_of(unknown: Unknown) -> str:
    """Return the sentence that says no more than that a name is not defined."""
    return f"{unknown.name} is used here but never imported or defined."


def also_on(unknown: Unknown, meant: str) -> str:
    """Say on which other lines of the function the name is to be replaced; empty if on none."""
    inside = {id(inner) for inner in walk(unknown.scopes[0])}
    loads = (use for use in unknown.uses if isinstance(use.ctx, ast.Load) and id(use) in inside)
    others = sorted({use.lineno for use in loads} - {getattr(unknown.node, "lineno", 0)})
    return f", and {meant} on line {' and '.join(map(str, others))} as well" if others else ""


def first_value(source: PythonSource, uses: Sequence[ast.AST]) -> str:
    """Return the value with which a variable begins: None, a number, a list or a dictionary; empty if unknown."""
    for use in uses:
        match source.above(use):
            case ast.Compare(ops=[ast.Is() | ast.IsNot()], comparators=[ast.Constant(value=None)]):
                return "None"
            case ast.AugAssign(op=ast.Add() | ast.Sub(), value=ast.Constant(value=int() | float() as step)):
                return "0.0" if isinstance(step, float) else "0"
            case ast.Attribute(attr="append" | "extend"):
                return "[]"
            case ast.Subscript(ctx=ast.Store(), slice=ast.Constant(value=str())):
                return "{}"
    return ""


def compared(source: PythonSource, target: ast.AST) -> str:
    """Say to assign where a statement only compares a target, as `node == Talker()`; empty if none does."""
    for statement in source.nodes:
        match statement:
            case ast.Expr(value=ast.Compare(left=left, ops=[ast.Eq()])) if target in walk(left):
                targets = left.elts if isinstance(left, (ast.Tuple, ast.List)) else [left]
                if target in targets:
                    row = source.text.splitlines()[left.lineno - 1].encode()
                    end = (left.end_col_offset or 0) if left.end_lineno == left.lineno else 0
                    new = row[:end] + row[end:].replace(b"==", b"=", 1)
                    return f"write {as_code(new.decode()) or '`=` instead of `==`'}"
    return ""
