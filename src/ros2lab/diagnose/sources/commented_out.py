"""Texts without what is commented out, line by line as they were."""

from __future__ import annotations

import ast
import contextlib
import io
import re
import tokenize
import warnings
from collections.abc import Iterator


def without_comments(text: str) -> str:
    """Return an XML text with spaces instead of its comments."""
    return re.sub(r"<!--.*?-->", lambda found: re.sub(r"[^\n]", " ", found[0]), text, flags=re.DOTALL)


def without_texts(text: str) -> str:
    """Return Python code without the strings that are statements, such as code between triple quotes."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError):
        return text
    lines = text.splitlines()
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            last = node.end_lineno or node.lineno
            lines[node.lineno - 1 : last] = [""] * (last - node.lineno + 1)
    return "\n".join(lines)


def out_of_use(code: str) -> Iterator[tuple[int, str, str]]:
    """Yield the lines of Python code that are comments, or in a text that is a statement, with how to put them back."""
    yield from ((line, said, f"remove the # from line {line}") for line, said in comments_in(code))
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            rows = code.splitlines()[node.lineno - 1 : node.end_lineno]
            for line, said in enumerate(rows if len(rows) > 1 else (), node.lineno):
                yield line, said, f"take line {line} out of the quotes around it"


def disabled(code: str, wanted: str) -> tuple[int, str]:
    """Return the first line out of use that matches a pattern, and how to put it back; 0 if there is none."""
    with contextlib.suppress(SyntaxError, ValueError, tokenize.TokenError):
        found = ((line, back) for line, said, back in out_of_use(code) if re.search(wanted, said))
        return next(found, (0, ""))
    return 0, ""


def comments_in(code: str) -> Iterator[tuple[int, str]]:
    """Yield the comments of Python code that can be read, each with its line and without its `#`."""
    for token in tokenize.generate_tokens(io.StringIO(code).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], token.string.lstrip("#")
