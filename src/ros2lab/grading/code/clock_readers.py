"""Which code may tell a simulated clock from a real one: only such code can do something else by it.

A clock, the time of day, a computed name, the command line, a file or another process may tell. What uses nothing
but rclpy without its clocks, messages and plain computing is blind to it, and need not be compared on both.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterable

from ros2lab.diagnose.sources.python_source import PythonSource

# What plain computing imports; none of it knows of time, files, processes or the command line.
_BLIND = frozenset(
    [
        "__future__",
        "abc",
        "collections",
        "contextlib",
        "dataclasses",
        "enum",
        "functools",
        "itertools",
        "json",
        "math",
        "random",
        "re",
        "rclpy",
        "string",
        "typing",
    ]
)
_MESSAGES = re.compile(r"\w+_(?:msgs|interfaces)")
_TELLS = re.compile(r"clock|(?<![a-z])time(?![a-z])|stamp|seconds|\bnow\b", re.IGNORECASE)
_OF_COMPUTED_NAMES = frozenset(
    ("getattr", "setattr", "eval", "exec", "compile", "vars", "globals", "locals", "dir", "__import__")
)
_FROM_OUTSIDE = frozenset(("open", "input", "spin_once", "get_parameters_by_prefix"))
_ASKING = frozenset(
    ("get_parameter", "get_parameters", "get_parameter_or", "has_parameter", "declare_parameter")
)
_PLAIN_DUNDERS = frozenset(("__init__", "__name__", "__main__", "__doc__", "__str__", "__repr__"))


def clock_readers(sources: Iterable[PythonSource], own: Collection[str]) -> list[str]:
    """Return the names of the modules that may tell which clock they have.

    Args:
        sources: the modules.
        own: the names of all of them; to import one tells nothing.
    """
    return sorted(source.name for source in sources if source.fault or _may_tell(source, own))


def _may_tell(source: PythonSource, own: Collection[str]) -> bool:
    tops = {imported.target.partition(".")[0] for imported in source.imports if imported.target}
    foreign = {top for top in tops if not _MESSAGES.fullmatch(top)} - _BLIND - {*own}
    return bool(foreign) or "rosgraph_msgs" in tops or any(map(_tells, source.nodes))


def _tells(node: ast.AST) -> bool:
    match node:
        case ast.Name(id=name) | ast.Attribute(attr=name) | ast.alias(name=name):
            is_inner = name.startswith("__") and name.endswith("__") and name not in _PLAIN_DUNDERS
            named = {name.rpartition(".")[2]}
            return is_inner or not named.isdisjoint(_OF_COMPUTED_NAMES | _FROM_OUTSIDE) or _is_of_time(name)
        case ast.Call(func=ast.Attribute(attr=name), args=[asked, *_]) if name in _ASKING:
            return not isinstance(asked, ast.Constant)
        case ast.Constant(value=str(text)):
            return "sim_time" in text or "/clock" in text
    return False


def _is_of_time(name: str) -> bool:
    """Return whether a name is of a clock or a time; `create_timer` and `timer_period` are not."""
    return _TELLS.search(name) is not None
