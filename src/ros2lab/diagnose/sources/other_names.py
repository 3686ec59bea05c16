"""The executables that a word may mean that is none: the name of a file, a module, a function, a class or a node."""

from __future__ import annotations

import ast
import re

from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import last_name
from ros2lab.diagnose.sources.setup_script import EntryPoint
from ros2lab.diagnose.sources.syntax_parts import calls_in, needed_by


def by_another_name(package: SourcePackage, word: str) -> list[EntryPoint]:
    """Return the entry points whose file, module, function, class or node has the name that was typed.

    Those of the file come first; a name that all of the executables share says nothing.
    """
    points = [point for point in package.points if point.module]
    path = word.removesuffix(".py").strip("/").replace("/", ".").partition(":")[0]
    of_file = [
        point
        for point in points
        if any(
            f".{point.module}".endswith(f".{name}")
            for name in (path, path.removesuffix(f".{point.function}"))
        )
        or path in (point.name, f"{package.name}.{point.name}")
    ]
    if of_file:
        return of_file
    inner = []
    for point in points:
        source = package.sources.get(point.module)
        classes = source.classes if source else ()
        nodes = NodeSources({point.module: source}).node_names if source else {}
        if word in (point.function, *classes, *nodes):
            inner.append(point)
    return inner if len(inner) == 1 else []


def meant_function(package: SourcePackage, module: str, written: str = "") -> str:
    """Return the function that an entry point should call: as written, the only one if it needs nothing, main, or the one that a script calls."""
    if name := re.fullmatch(r"\s*(\w+)\s*(\(.*\)\s*)?", written):
        return name[1]
    source = package.sources.get(module)
    body = source.tree.body if source else []
    functions = {n.name: n for n in body if isinstance(n, ast.FunctionDef)}
    guards = [n for n in body if isinstance(n, ast.If) and "__name__" in ast.unparse(n.test)]
    called = [last_name(call.func) for guard in guards for call in calls_in(ast.walk(guard))]
    only = [name for name, function in functions.items() if len(functions) == 1 and not needed_by(function)]
    known = [
        *only,
        *(["main"] if "main" in functions else []),
        *(name for name in called if name in functions),
    ]
    return [*known, "main"][0]
