"""Keyword arguments that a function of Python or of setuptools does not take."""

from __future__ import annotations

import ast
import importlib
import inspect
import sys
from collections.abc import Iterator
from functools import lru_cache

from ros2lab.diagnose.code.moved_keywords import moved_keyword
from ros2lab.diagnose.code.unknown_names import written_with
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.spelling import nearest


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
