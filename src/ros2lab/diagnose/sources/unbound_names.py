"""Names that a function uses and nothing binds: neither itself, nor a function around it, nor its file."""

from __future__ import annotations

import ast
import builtins
import symtable
from collections.abc import Iterator
from functools import lru_cache

from ros2lab.diagnose.sources.python_source import Function, PythonSource, walk

_OF_MODULES = frozenset(("__file__", "__name__", "__doc__", "__path__", "__spec__", "__builtins__"))


def unbound_names(source: PythonSource, function: Function) -> list[str]:
    """Return the names that fail when a function uses them, in the order of their first use."""
    names = _unbound(source).get((function.name, function.lineno), frozenset())
    used = [node for node in walk(function) if isinstance(node, ast.Name) and node.id in names]
    return list(dict.fromkeys(n.id for n in sorted(used, key=lambda n: (n.lineno, n.col_offset))))


@lru_cache(maxsize=256)
def _unbound(source: PythonSource) -> dict[tuple[str, int], frozenset[str]]:
    """Return the unbound names of each function, by its name and line, with those of functions inside it."""
    used = {node.id for node in source.nodes if isinstance(node, ast.Name)}
    if any(imported.local == "*" for imported in source.imports) or used & {"exec", "globals", "eval"}:
        return {}
    try:
        top = symtable.symtable(source.text, source.shown, "exec")
    except (SyntaxError, ValueError, RecursionError):
        return {}
    scopes = [*_scopes(top)]
    stored = {name for scope in scopes for name in _bound_at_top(scope, is_top=scope is top)}
    known = stored | set(dir(builtins)) | _OF_MODULES
    return {
        (scope.get_name(), scope.get_lineno()): frozenset(
            symbol.get_name()
            for inner in _scopes(scope)
            for symbol in inner.get_symbols()
            if symbol.is_global() and symbol.is_referenced()
        )
        - known
        for scope in scopes
        if scope.get_type() == "function"
    }


def _scopes(scope: symtable.SymbolTable) -> Iterator[symtable.SymbolTable]:
    yield scope
    for inner in scope.get_children():
        yield from _scopes(inner)


def _bound_at_top(scope: symtable.SymbolTable, *, is_top: bool) -> Iterator[str]:
    """Yield the names that a scope binds for the whole file."""
    for symbol in scope.get_symbols():
        is_bound = symbol.is_assigned() or symbol.is_imported() or symbol.is_namespace()
        if is_bound and (is_top or symbol.is_declared_global()):
            yield symbol.get_name()
