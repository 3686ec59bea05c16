"""Several values as one text: as print() writes them, as a template says, and what it may then be."""

from __future__ import annotations

import ast
import io
import itertools
import re
import tokenize
from collections.abc import Sequence

VALUE = re.compile(r"%[-+ 0#]*\d*(?:\.\d+)?[a-zA-Z]|\{[^{}]*\}")  # a placeholder in a format string


def text_of(node: object) -> str:
    """Return the text that a literal is; empty for anything else."""
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""


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


def text_pattern(written: ast.expr) -> str:
    """Return a pattern of the texts that an expression may have: what is not written there may be anything."""
    match written:
        case ast.Constant(value=str(text)):
            return re.escape(text)
        case ast.JoinedStr(values=parts):
            return "".join(map(text_pattern, parts))
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            return text_pattern(left) + text_pattern(right)
        case ast.BinOp(left=ast.Constant(value=str(text)), op=ast.Mod()):
            return ".*".join(map(re.escape, VALUE.split(text)))
        case ast.Call(func=ast.Attribute(attr="format", value=ast.Constant(value=str(text)))):
            return ".*".join(map(re.escape, VALUE.split(text)))
    return ".*"


def strings(text: str) -> list[tuple[int, str, bool]]:
    """Return the strings of a file in order: the line on which each ends, its code, and whether one follows directly."""
    try:
        tokens = [*tokenize.generate_tokens(io.StringIO(text).readline)]
    except (tokenize.TokenError, SyntaxError):
        return []
    tokens = [token for token in tokens if token.type not in (tokenize.NL, tokenize.COMMENT)]
    lines = text.splitlines()
    starts = (tokenize.STRING, getattr(tokenize, "FSTRING_START", tokenize.STRING))
    ends = (tokenize.STRING, getattr(tokenize, "FSTRING_END", tokenize.STRING))
    found, start = [], (0, 0)
    for token, following in itertools.pairwise(tokens):
        start = token.start if token.type in starts else start
        if token.type in ends and start[0] == token.end[0]:
            code = lines[start[0] - 1][start[1] : token.end[1]]
            found.append((token.end[0], code, following.type in starts))
    return found
