"""Launch configurations that are used but not declared: with which value they are to be declared."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.launching.lost_arguments import not_added
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.parameter_faults import declared_in
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.sources.python_source import PythonSource, read_source
from ros2lab.diagnose.sources.spelling import nearest
from ros2lab.diagnose.sources.static_value import UNKNOWN

_MISSING = re.compile(r"launch configuration '(?P<name>[^']+)' does not exist")
_OF_EVERY_NODE = {"use_sim_time": False}


def undeclared_argument(error: ErrorText, look: Look) -> Finding | None:
    """Say how to declare a launch configuration that does not exist; None if the default is not known."""
    match = _MISSING.search(error.text)
    for path in look.launch_paths:
        if path.suffix != ".py" or match is None:
            continue
        source = read_source(path, path.stem, str(path.relative_to(look.root)))
        if lost := next(not_added(match["name"], source), None):
            return lost
        for call in _used(match["name"], source):
            value = _default(match["name"], call, source, look)
            if value is None or nearest(match["name"], _declared_in(source), 0.6):
                continue
            name = match["name"]
            cause = f"The launch file uses LaunchConfiguration({name!r}), but does not declare an argument {name}."
            is_known = "DeclareLaunchArgument" in source.names
            more = "" if is_known else ", with `from launch.actions import DeclareLaunchArgument` at the top"
            fix = f"write `DeclareLaunchArgument({name!r}, default_value={value!r}),` as the first item in the list of LaunchDescription{more}"
            return Finding("launch-argument", cause, source.at(call), fix)
    return None


def _used(name: str, source: PythonSource) -> Iterator[ast.Call]:
    """Yield the uses of a launch configuration."""
    for node in source.nodes:
        match node:
            case ast.Call(args=[ast.Constant(value=given), *_]) if given == name:
                if (source.resolve(node.func) or "").endswith(".LaunchConfiguration"):
                    yield node


def _declared_in(source: PythonSource) -> Iterator[str]:
    """Yield the arguments that a launch file declares: a similar one is probably meant."""
    for node in source.nodes:
        match node:
            case ast.Call(func=func, args=[ast.Constant(value=str(name)), *_]):
                if (source.resolve(func) or "").endswith(".DeclareLaunchArgument"):
                    yield name


def _default(name: str, call: ast.Call, source: PythonSource, look: Look) -> str | None:
    """Return the value to declare: of the parameter that it sets, of its condition or its namespace."""
    kept = [n.targets[0] for n in source.nodes if isinstance(n, ast.Assign) and n.value is call]
    shown = {ast.unparse(call), *map(ast.unparse, kept)}
    for node in source.nodes:
        match node:
            case ast.Dict(keys=keys, values=values):
                for key, value in zip(keys, values, strict=True):
                    if isinstance(key, ast.Constant) and ast.unparse(value) in shown:
                        return _as_text(_declared(str(key.value), look))
            case ast.keyword(arg="namespace", value=value) if ast.unparse(value) in shown:
                return ""
            case ast.Call(func=func, args=[value]) if ast.unparse(value) in shown:
                if ast.unparse(func).endswith(("IfCondition", "UnlessCondition")):
                    return "true"
    return _as_text(_OF_EVERY_NODE.get(name, UNKNOWN))


def _declared(parameter: str, look: Look) -> object:
    """Return the default with which a node declares a parameter; UNKNOWN if none does."""
    found: dict[str, object] = {**_OF_EVERY_NODE}
    for package in look.packages:
        found |= declared_in(look.sources(package)) or {}
    return found.get(parameter, UNKNOWN)


def _as_text(value: object) -> str | None:
    """Return a value as launch reads it; None if it is not known."""
    if isinstance(value, bool):
        return str(value).lower()
    return str(value) if isinstance(value, (int, float, str)) else None
