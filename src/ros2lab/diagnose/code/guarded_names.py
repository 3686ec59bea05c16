"""Code that may use names which Python lacks: it is only for another version, or the NameError is caught."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.sources.one_run import blocks
from ros2lab.diagnose.sources.python_source import PythonSource, walk

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
