"""Keyword arguments that a function does not take, and those that belong to another call beside it."""

from __future__ import annotations

import ast
import importlib
import inspect
import sys
from collections.abc import Iterator
from functools import lru_cache

from ros2lab.diagnose.code.unknown_names import as_code, written_with
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.python_source import PythonSource, given_to
from ros2lab.diagnose.sources.signatures import Signature, signature_of
from ros2lab.diagnose.sources.spelling import nearest, same_letters
from ros2lab.diagnose.sources.syntax_parts import calls_in


def refused_keywords(source: PythonSource) -> Iterator[Finding]:
    """Yield the keyword arguments in a file that the called function of Python or setuptools refuses."""
    for call in source.nodes:
        if isinstance(call, ast.Call) and call.keywords:
            name = source.resolve(call.func) or ""
            taken = _taken(name)
            for keyword in call.keywords if taken is not None else ():
                if keyword.arg and keyword.arg not in (taken or ()):
                    yield _refused(source, call, keyword, name.rpartition(".")[2], taken or frozenset())


def _refused(
    source: PythonSource, call: ast.Call, keyword: ast.keyword, name: str, taken: frozenset[str]
) -> Finding:
    near = nearest(keyword.arg, taken - {other.arg for other in call.keywords})
    cause = f"{name}() has no argument called {keyword.arg}."
    value = ast.get_source_segment(source.text, keyword.value) or ast.unparse(keyword.value)
    fix = f"remove {keyword.arg}={value}; {name}() takes {', '.join(sorted(taken))}"
    if moved := moved_keyword(source, call, keyword.arg or ""):
        cause, fix = f"{cause} It is one of {moved[0]}().", moved[1]
    elif near:
        cause, fix = f"{cause} Did you mean {near}?", written_with(source, keyword, f"{near}={value}")
    return Finding("argument-unknown", cause, source.at(keyword), fix)


@lru_cache(maxsize=64)
def _taken(name: str) -> frozenset[str] | None:
    """Return the names of the arguments of a function; None if it takes any, or if it is not known."""
    module, _, function = name.rpartition(".")
    if module == "setuptools":
        home = importlib.import_module(module)
    elif module in sys.stdlib_module_names:
        home = interfaces.own_module(module)  # type: ignore[assignment]
    else:
        return None
    try:
        parameters = inspect.signature(getattr(home, function)).parameters.values()
    except (AttributeError, TypeError, ValueError):
        return None
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters):
        return None
    return frozenset(p.name for p in parameters if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY))


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
