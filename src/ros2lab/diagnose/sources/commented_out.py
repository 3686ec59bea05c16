"""Texts without what is commented out, line by line as they were."""

from __future__ import annotations

import ast
import contextlib
import io
import re
import tokenize
import warnings
from collections.abc import Iterable, Iterator
from itertools import takewhile

from ros2lab.diagnose.finding import lines_in_words

_LONGEST = 12  # lines that belong together


def without_comments(text: str) -> str:
    """Return an XML text with spaces instead of its comments."""
    return re.sub(r"<!--.*?-->", lambda found: re.sub(r"[^\n]", " ", found[0]), text, flags=re.DOTALL)


def without_texts(code: str) -> str:
    """Return Python code without the strings that are statements, such as code between triple quotes."""
    lines = code.splitlines()
    for text in (node for statement in _read(code) for node in ast.walk(statement)):
        if isinstance(text, ast.Expr) and isinstance(text.value, ast.Constant):
            last = text.end_lineno or text.lineno
            blank = [""] * (last - text.lineno)
            lines[text.lineno - 1 : last] = [f"{lines[text.lineno - 1][: text.col_offset]}pass", *blank]
    return "\n".join(lines)


def out_of_use(code: str) -> Iterator[tuple[int, str, str]]:
    """Yield the lines of Python code that are comments, or in a text that is a statement, with how to put them back."""
    yield from ((line, said, "remove the # from {}") for line, said in comments_in(code))
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            rows = code.splitlines()[node.lineno - 1 : node.end_lineno]
            for line, said in enumerate(rows if len(rows) > 1 else (), node.lineno):
                yield line, said, "take {} out of the quotes around it"


def put_back(code: str, wanted: str) -> Iterator[tuple[int, str, str]]:
    """Yield the lines out of use that match a pattern, each with how to put it back, and the code that has it again.

    Those that Python cannot read where they stand are left out; lines below that belong to one come with it.
    """
    with contextlib.suppress(SyntaxError, ValueError, tokenize.TokenError):
        rows = {line: (said, back) for line, said, back in out_of_use(code)}
        for first in sorted(line for line in rows if re.search(wanted, rows[line][0])):
            back = rows[first][1]
            for last in takewhile(rows.__contains__, range(first, first + _LONGEST)):
                if whole := _with(code, first, [rows[line][0] for line in range(first, last + 1)]):
                    yield first, back.format(lines_in_words(first, last)), whole
                    break


def _with(code: str, first: int, rows: list[str]) -> str:
    """Return code with lines of it put back, one space less where a # was; empty if Python cannot read it then."""
    old = code.splitlines()[first - 1]
    is_comment = old != rows[0]
    for space in (" ", ""):
        lines = (code if is_comment else without_texts(code)).splitlines()
        before = old.partition("#")[0] * is_comment
        lines[first - 1 : first - 1 + len(rows)] = [before + row.removeprefix(space) for row in rows]
        if _read(whole := "\n".join(lines)):
            return whole
    return ""


def disabled(code: str, scopes: Iterable[ast.AST], wanted: str) -> tuple[int, str]:
    """Return the first matching line out of use in some functions, and how to put it back; 0 without any."""
    places = {getattr(scope, "lineno", 0) for scope in scopes}
    for line, back, whole in put_back(code, wanted):
        inner = (node for statement in _read(whole) for node in ast.walk(statement))
        functions = (node for node in inner if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)))
        around = [n.lineno for n in functions if n.lineno < line <= (n.end_lineno or 0)]
        if {*around[-1:]} & places:
            return line, back
    return 0, ""


def _read(code: str) -> list[ast.stmt]:
    """Return the statements of Python code; none if Python cannot read it."""
    with contextlib.suppress(SyntaxError, ValueError, RecursionError), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return ast.parse(code).body
    return []


def comments_in(code: str) -> Iterator[tuple[int, str]]:
    """Yield the comments of Python code that can be read, each with its line and without its `#`."""
    for token in tokenize.generate_tokens(io.StringIO(code).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], token.string.lstrip("#")
