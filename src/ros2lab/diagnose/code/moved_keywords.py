"""Keyword arguments that are given to the wrong call of two, one of which is inside the other."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.code.unknown_names import as_code
from ros2lab.diagnose.sources.python_source import PythonSource, given_to
from ros2lab.diagnose.sources.signatures import Signature, signature_of
from ros2lab.diagnose.sources.spelling import same_letters
from ros2lab.diagnose.sources.syntax_parts import calls_in


def moved_keyword(source: PythonSource, call: ast.Call, name: str) -> tuple[str, str] | None:
    """Return the call that a keyword argument belongs to, and what to write; None if it is that of no call near by."""
    keyword = next((given for given in call.keywords if given.arg == name), None)
    if keyword is None:
        return None
    for other in _near(source, call):
        signature = signature_of(source, other)
        wanted = _parameter(signature, name) if signature else ""
        if wanted and wanted not in {given.arg for given in other.keywords}:
            owner = ast.unparse(other.func)
            value = f"{wanted}={source.segment(keyword.value)}"
            is_outer = call in ast.walk(other)
            whole = as_code(_moved(other if is_outer else call, call, keyword, other, wanted))
            where = f"the parentheses of {owner}() on line {other.lineno}"
            told = (
                f"write {whole}"
                if whole
                else f"write `{' '.join(value.split())}` in {where}, and remove it here"
            )
            return owner, told
    return None


def _near(source: PythonSource, call: ast.Call) -> Iterator[ast.Call]:
    """Yield the calls that a call is an argument of, the nearest first, and those that are its own arguments."""
    node: ast.AST | None = call
    while node is not None and not isinstance(node, ast.stmt):
        node = source.above(node)
        if isinstance(node, ast.Call):
            yield node
    for value in given_to(call):
        yield from calls_in(ast.walk(value))


def _parameter(signature: Signature, name: str) -> str:
    names = [parameter.name for parameter in signature.parameters]
    return name if name in names else next((known for known in names if same_letters(known, name)), "")


def _moved(outer: ast.Call, call: ast.Call, keyword: ast.keyword, other: ast.Call, wanted: str) -> str:
    """Return the outer of two calls as it is written when a keyword argument of one is given to the other."""
    place = call.keywords.index(keyword)
    call.keywords.remove(keyword)
    other.keywords.append(ast.keyword(wanted, keyword.value))
    try:
        return ast.unparse(outer)
    finally:
        other.keywords.pop()
        call.keywords.insert(place, keyword)
