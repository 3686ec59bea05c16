"""Launch configurations that are used but not declared: with which value they are to be declared."""

from __future__ import annotations

import ast
import re

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.launching.launch_arguments import arguments_named
from ros2lab.diagnose.launching.lost_arguments import not_added
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.names_there import declared_parameters
from ros2lab.diagnose.sources.python_source import PythonSource, read_source
from ros2lab.diagnose.sources.spelling import nearest
from ros2lab.diagnose.sources.static_value import UNKNOWN

_MISSING = re.compile(r"launch configuration '(?P<name>[^']+)' does not exist")
_OF_EVERY_NODE: dict[str, object] = {"use_sim_time": False}


def undeclared_argument(error: ErrorText, look: Look) -> Finding | None:
    """Say how to declare a launch configuration that does not exist; None if the default is not known."""
    match = _MISSING.search(error.text)
    for path in look.launch_paths:
        if path.suffix != ".py" or match is None:
            continue
        source = read_source(path, path.stem, str(path.relative_to(look.root)))
        if lost := next(not_added(match["name"], source), None):
            return lost
        name = match["name"]
        declared = [other for other, _ in arguments_named(source, "DeclareLaunchArgument")]
        for call in (call for asked, call in arguments_named(source, "LaunchConfiguration") if asked == name):
            value = _default(name, call, source, look)
            if value is None or nearest(name, declared, 0.6):
                continue  # a similar one is probably meant
            cause = f"The launch file uses LaunchConfiguration({name!r}), but does not declare an argument {name}."
            is_known = "DeclareLaunchArgument" in source.names
            more = "" if is_known else ", with `from launch.actions import DeclareLaunchArgument` at the top"
            fix = f"write `DeclareLaunchArgument({name!r}, default_value={value!r}),` as the first item in the list of LaunchDescription{more}"
            return Finding("launch-argument", cause, source.at(call), fix)
    return None


def _default(name: str, call: ast.Call, source: PythonSource, look: Look) -> str | None:
    """Return the value to declare: of the parameter that it sets, of its condition or its namespace."""
    kept = [n.targets[0] for n in source.nodes if isinstance(n, ast.Assign) and n.value is call]
    shown = {ast.unparse(call), *map(ast.unparse, kept)}
    for node in source.nodes:
        match node:
            case ast.Dict(keys=keys, values=values):
                for key, value in zip(keys, values, strict=True):
                    if isinstance(key, ast.Constant) and ast.unparse(value) in shown:
                        return default_of(str(key.value), look)
            case ast.keyword(arg="namespace", value=value) if ast.unparse(value) in shown:
                return ""
            case ast.Call(func=func, args=[value]) if ast.unparse(value) in shown:
                if ast.unparse(func).endswith(("IfCondition", "UnlessCondition")):
                    return "true"
    return default_of(name, look) if name in _OF_EVERY_NODE else None


def default_of(parameter: str, look: Look) -> str | None:
    """Return the default of a parameter as launch reads it; None if no node declares it."""
    value = (_OF_EVERY_NODE | declared_parameters(look)).get(parameter, UNKNOWN)
    if isinstance(value, bool):
        return str(value).lower()
    return str(value) if isinstance(value, (int, float, str)) else None
