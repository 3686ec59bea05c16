"""Launch arguments and parameter files, as launch files name and read them."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from typing import Any

from ros2lab.diagnose.nodes.parameter_faults import sections_of
from ros2lab.diagnose.sources.parameter_file import ParameterFileError, read_parameter_file
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.syntax_parts import calls_in


def calls_of_launch(
    source: PythonSource, *homes: str, within: ast.AST | None = None
) -> Iterator[tuple[str, ast.Call]]:
    """Yield the calls of what belongs to launch, or to some modules of it, each with the name of what is called."""
    for call in source.calls if within is None else calls_in(ast.walk(within)):
        if (name := source.resolve(call.func) or "").startswith(homes or ("launch.", "launch_ros.")):
            yield name, call


def class_made(source: PythonSource, value: ast.expr, *modules: str) -> tuple[str, str]:
    """Return which of some modules has the class that an expression makes, and its name; both empty if none has."""
    target = source.resolve(value.func) or "" if isinstance(value, ast.Call) else ""
    module, _, name = target.rpartition(".")
    return next(((known, name) for known in modules if f"{module}.".startswith(f"{known}.")), ("", ""))


def arguments_named(
    source: PythonSource, *kinds: str, within: ast.AST | None = None
) -> Iterator[tuple[str, ast.Call]]:
    """Yield the launch arguments that calls of some classes name, such as `DeclareLaunchArgument`, each with its call."""
    for called, call in calls_of_launch(source, "", within=within):
        if called.rpartition(".")[2] in kinds:
            named = [keyword.value for keyword in call.keywords if keyword.arg in ("name", "variable_name")]
            match [*call.args, *named]:
                case [ast.Constant(value=str(name)), *_]:
                    yield name, call


def all_named(source: PythonSource, *kinds: str) -> dict[str, ast.Call] | None:
    """Return the launch arguments that some classes name in a file, each with its call; None if they may name others.

    So they may where a name is worked out, and where a class is not called: as a base class, or given to a function.
    """
    named = [*arguments_named(source, *kinds)]
    known = {id(call.func) for _, call in named}
    meant = (n for n in source.nodes if isinstance(n, (ast.Name, ast.Attribute)) and id(n) not in known)
    return None if any((source.resolve(n) or "").rpartition(".")[2] in kinds for n in meant) else dict(named)


def sections_in(text: str) -> list[tuple[str, Mapping[Any, Any]]]:
    """Return the sections of a parameter file with their parameters; none if it cannot be read."""
    try:
        content = read_parameter_file(text)
    except ParameterFileError:
        return []
    return [*sections_of(content)] if isinstance(content, Mapping) else []
