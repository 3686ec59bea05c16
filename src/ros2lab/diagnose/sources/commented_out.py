"""Texts without what is commented out, line by line as they were."""

from __future__ import annotations

import ast
import re
import warnings


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
