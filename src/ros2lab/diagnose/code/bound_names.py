"""The names that a file binds, and those that it uses although nothing binds them."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Iterator
from functools import lru_cache

from ros2lab.diagnose.sources.bindings import bound_by
from ros2lab.diagnose.sources.one_run import blocks
from ros2lab.diagnose.sources.python_source import Function, PythonSource, own_nodes, walk

MODULE_NAMES = frozenset(
    ("__file__", "__name__", "__doc__", "__path__", "__package__", "__spec__", "__loader__")
)


_SCOPES = (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)


def undefined_names(source: PythonSource) -> Iterator[tuple[str, ast.AST]]:
    """Yield each name that a file uses where nothing binds it, with its first use.

    The order of the lines is ignored, so a name that is yielded fails wherever it is reached.
    """
    first = dict[str, ast.AST]()
    for node in _unbound_uses(source):
        first.setdefault(node.id, node)
    yield from first.items()


def unbound_names(source: PythonSource, function: Function) -> list[str]:
    """Return the names that fail when a function uses them, in the order of their first use."""
    inside = {id(node) for node in walk(function)}
    uses = sorted(
        (n for n in _unbound_uses(source) if id(n) in inside), key=lambda n: (n.lineno, n.col_offset)
    )
    return list(dict.fromkeys(node.id for node in uses))


@lru_cache(maxsize=256)
def _unbound_uses(source: PythonSource) -> tuple[ast.Name, ...]:
    """Return all uses of names that nothing binds; none where code binds names only when it runs."""
    used = {node.id for node in source.nodes if isinstance(node, ast.Name)}
    if any(imported.local == "*" for imported in source.imports) or used & {"exec", "globals"}:
        return ()
    known = frozenset(dir(builtins)) | MODULE_NAMES | global_names(source)
    unbound = [*_unbound(source.tree, known, frozenset())]
    unread = {id(inner) for node in (_unevaluated(source) if unbound else ()) for inner in walk(node)}
    unread |= {id(inner) for node in (guarded(source) if unbound else ()) for inner in walk(node)}
    return tuple(n for n in unbound if id(n) not in unread)


def _unevaluated(source: PythonSource) -> Iterator[ast.AST]:
    """Yield the annotations that Python does not evaluate: those of a function's own variables, or all."""
    is_any = any(imported.target == "__future__.annotations" for imported in source.imports)
    functions = (node for node in source.nodes if isinstance(node, Function))
    inner = (node for function in functions for node in own_nodes(function))
    for node in source.nodes if is_any else (n for n in inner if isinstance(n, ast.AnnAssign)):
        yield from filter(None, (getattr(node, "annotation", None), getattr(node, "returns", None)))


def _unbound(parent: ast.AST, known: frozenset[str], of_class: frozenset[str]) -> Iterator[ast.Name]:
    """Yield the names below a node that are neither known nor bound by the class body that they are directly in."""
    if named := getattr(parent, "type_params", ()):
        known = known.union(parameter.name for parameter in named)
    for field, value in ast.iter_fields(parent):
        visible, direct = known, of_class
        # Decorators, defaults and annotations are evaluated in the scope around the function.
        if field == "body" and isinstance(parent, _SCOPES):
            own = frozenset(bound_in(parent))
            is_class = isinstance(parent, ast.ClassDef)
            visible, direct = (known, own) if is_class else (known | own | {"__class__"}, frozenset())
        for node in value if isinstance(value, list) else [value]:
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
                if node.id not in visible and node.id not in direct:
                    yield node
            elif isinstance(node, ast.AST):
                yield from _unbound(node, visible, direct)


def global_names(source: PythonSource) -> frozenset[str]:
    """Return the names that a file binds at its top level, or in a function that says `global`."""
    of_functions = (node.names for node in source.nodes if isinstance(node, ast.Global))
    return frozenset(bound_in(source.tree)).union(*of_functions)


def bound_in(scope: ast.AST) -> set[str]:
    """Return the names that a file, a class or a function binds itself, without those of its inner scopes."""
    return {name for node in own_nodes(scope) for name in bound_by(node)}


_VERSIONS = ("sys.version", "sys.hexversion", "platform.python_version", "six.PY")


def guarded(source: PythonSource) -> Iterator[ast.AST]:
    """Yield what runs only where a condition about Python's version, or a caught NameError, allows for it."""
    for node in source.nodes:
        match node:
            case ast.If() | ast.IfExp() if _asks_version(source, node.test):
                yield node
            case ast.BoolOp(values=[first, *_]) if _asks_version(source, first):
                yield node
            case ast.Try(handlers=handlers) if any(_names_it(handler.type) for handler in handlers):
                yield from node.body
        for block in blocks(node):
            for number, statement in enumerate(block):
                match statement:
                    case ast.If(test=test, body=[*_, ast.Return(value=value)]) if (
                        value and not isinstance(value, ast.Constant) and _asks_version(source, test)
                    ):
                        yield from block[number + 1 :]


def _names_it(kinds: ast.expr | None) -> bool:
    """Return whether an `except` names NameError itself: one that takes every error hides a slip as well."""
    return kinds is not None and any(getattr(node, "id", "") == "NameError" for node in walk(kinds))


def _asks_version(source: PythonSource, test: ast.AST, names: frozenset[str] = frozenset()) -> bool:
    """Return whether a condition depends on Python's version, by itself or by a name that is set to it."""
    for node in walk(test):
        if (source.resolve(node) or "").startswith(_VERSIONS):
            return True
        name = node.id if isinstance(node, ast.Name) else ""
        made = (n for n in source.tree.body if isinstance(n, ast.Assign)) if name not in {"", *names} else ()
        values = [n.value for n in made if any(getattr(target, "id", "") == name for target in n.targets)]
        if any(_asks_version(source, value, names | {name}) for value in values):
            return True
    return False
