"""What a variable or an attribute should begin with, as far as its uses tell."""

from __future__ import annotations

import ast
from collections.abc import Sequence

from ros2lab.diagnose.code.unknown_names import as_code
from ros2lab.diagnose.sources.python_source import PythonSource, walk


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
