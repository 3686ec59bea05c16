"""Whether a class may be instantiated although nothing names it, such as by a registry of classes."""

from __future__ import annotations

import ast
import builtins
from functools import lru_cache

from ros2lab.diagnose.sources.construction import is_made_otherwise
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources
from ros2lab.diagnose.sources.python_source import Function, PythonSource

_BUILTINS = frozenset(dir(builtins))
# What finds something by a text, and the position of that text; -1 for what gives all that there is.
_BY_TEXT = {"getattr": 1, "attrgetter": 0, "methodcaller": 0, "__getattribute__": 0, "eval": 0, "exec": 0}
_BY_TEXT |= dict.fromkeys(("globals", "vars", "dir", "getmembers"), -1)


def may_be_made_unseen(sources: NodeSources, owner: NodeClass) -> bool:
    """Return whether code that does not name a class may still instantiate it.

    Code outside the package may, if a decorator, a metaclass or an unknown base gives it the class. The package's
    own code may, if it calls a value that can be any class: an item of a registry, or the variable of a loop.
    """
    is_known = sources.lineage(owner)[2]
    return not is_known or is_made_otherwise(sources, owner) or _calls_any_value(sources)


def may_run(sources: NodeSources, source: PythonSource, owner: NodeClass | None) -> bool:
    """Return whether an executable may run a file and, if it is in a class, create that class."""
    if not sources.may_import(source):
        return False
    return owner is None or sources.is_named(owner) or may_be_made_unseen(sources, owner)


@lru_cache(maxsize=16)
def _calls_any_value(sources: NodeSources) -> bool:
    files = sources.sources.values()
    return any(not _is_known(source, call.func) for source in files for call in source.calls)


def _is_known(source: PythonSource, called: ast.expr) -> bool:
    """Return whether a called expression stands for one function or class, which its name tells."""
    if isinstance(called, ast.Name):
        return (
            called.id in _BUILTINS
            or source.resolve(called) is not None
            or any(isinstance(node, Function) and node.name == called.id for node in source.nodes)
        )
    if isinstance(called, ast.Attribute):
        return ast.unparse(called) not in source.stored
    return isinstance(called, ast.Lambda)


def looks_up(node: ast.AST) -> bool:
    """Return whether a node finds a function or a class by a computed name, or goes through all of them."""
    match node:
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name), args=args) if name in _BY_TEXT:
            at = _BY_TEXT[name]
            return at < 0 or not isinstance(next(iter(args[at:]), None), ast.Constant)
        case ast.Attribute(attr="__dict__"):
            return True
    return False
