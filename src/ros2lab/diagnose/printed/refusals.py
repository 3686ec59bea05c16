"""How the lab's own ros2 says that it refuses something, read off its source."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from ros2lab.diagnose.sources.joined_texts import text_pattern


def is_refusal(line: str) -> bool:
    """Return whether a line is, or begins with, a sentence with which ros2 ends in vain."""
    return _sentences().match(line) is not None


@cache
def _sentences() -> re.Pattern[str]:
    import portable_ros2

    files = Path(portable_ros2.__file__).parent.rglob("*.py")
    said = [text_pattern(given) for file in files for given in _said(ast.parse(file.read_bytes()))]
    firsts = {pattern.removeprefix("\\\n").partition("\\\n")[0] for pattern in said}
    # What is joined to the last word are the words of somebody else: a node says why it refuses a parameter.
    own = (first for first in firsts if not re.search(r"[A-Za-z]\.\*$", first))
    return re.compile("|".join(sorted(first for first in own if len(re.findall(r"[A-Za-z]{2,}", first)) > 1)))


def _said(tree: ast.AST) -> Iterator[ast.expr]:
    """Yield what an exception is made of, what a verb returns for the standard error, and what it writes there."""
    for node in ast.walk(tree):
        match node:
            case ast.Raise(exc=ast.Call(args=given)) | ast.arguments(defaults=given):
                yield from given
            case ast.Call(func=ast.Attribute(attr="__init__"), args=given):
                yield from given
            case ast.Call(func=ast.Name(id="print"), args=given, keywords=[ast.keyword(arg="file"), *_]):
                yield from given
            case ast.FunctionDef(returns=ast.BinOp()):
                yield from (n.value for n in ast.walk(node) if isinstance(n, ast.Return) and n.value)
