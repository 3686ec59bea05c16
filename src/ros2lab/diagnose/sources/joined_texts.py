"""Several values as one text, as a call of print() writes them or as a template says."""

from __future__ import annotations

import ast
import re
from collections.abc import Sequence


def _as_template(values: Sequence[ast.expr]) -> str:
    """Return an f-string of a text with placeholders, which the other values fill; empty if they do not fit."""
    match values:
        case [ast.Constant(value=str(text)), *others] if others:
            first, *pieces = re.split(r"%([-+ #0]*[\d.]*)[sdifgrxe]|\{\d*:?([^{}]*)\}", text)
            if len(pieces) != 3 * len(others):
                return ""
            parts: list[ast.expr] = [ast.Constant(first)]
            for value, percent, braces, piece in zip(others, *(pieces[n::3] for n in range(3)), strict=True):
                form = f"{percent}f" if percent and "." in percent else percent or braces
                spec = ast.JoinedStr([ast.Constant(form)]) if form else None
                is_number = isinstance(value, ast.Constant) and not spec
                shown = ast.FormattedValue(value, conversion=-1, format_spec=spec)
                parts += [ast.Constant(str(value.value)) if is_number else shown, ast.Constant(piece)]
            return ast.unparse(ast.JoinedStr(parts))
    return ""


def joined(values: Sequence[ast.expr]) -> str:
    """Return an f-string of several values with spaces between them, as print writes them.

    Where the first one has as many placeholders of % or of format() as there are other values, they fill these.
    """
    try:
        return _as_template(values) or _in_a_row(values)
    except ValueError:  # a backslash, which an f-string cannot show
        return f"' '.join(map(str, ({', '.join(map(ast.unparse, values))})))"


def _in_a_row(values: Sequence[ast.expr]) -> str:
    parts: list[ast.expr] = []
    for value in values:
        before = parts[-1].value if parts and isinstance(parts[-1], ast.Constant) else None
        if parts and not str(before).endswith(" "):
            parts.append(ast.Constant(" "))
        is_text = isinstance(value, ast.Constant) and isinstance(value.value, str)
        parts.append(value if is_text else ast.FormattedValue(value, conversion=-1))
    return ast.unparse(ast.JoinedStr(parts))
