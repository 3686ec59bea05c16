"""Angles that are put into a component of a quaternion, or read from one."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.kinds import Kinds, Scope
from ros2lab.diagnose.sources.node_source import NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import PythonSource, assigned_to
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import calls_in

_QUATERNION = "geometry_msgs.msg.Quaternion"
_FIELDS = ("x", "y", "z", "w")
_LIBRARIES = ("math.", "numpy.")
_OF_ANGLES = frozenset(("sin", "cos", "tan"))
_OF_DEGREES = frozenset(("radians", "deg2rad"))
_GIVING = frozenset(("atan2", "arctan2", "radians", "deg2rad"))


def angle_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield angles that are taken for components of a quaternion, and components that are taken for angles."""
    kinds = Kinds(sources)
    for source in sources.sources.values():
        if not any(word in source.text for word in ("orientation", "rotation", "Quaternion")):
            continue
        for owner, function, node in sources.scoped(source):
            if function is None:
                continue
            around = (function, owner.definition) if owner else (function, function)
            angles = _Angles(source, *around)
            scope = Scope(kinds, source, owner, function)
            match node:
                case ast.Assign(targets=[ast.Attribute(attr=field, value=whole)], value=given):
                    is_component = field in _FIELDS and scope.kind(whole) == _QUATERNION
                    if is_component and (angle := angles.in_radians(given)):
                        yield _written(source, node, ast.unparse(node.targets[0]), given, angle)
                case ast.Call(keywords=keywords) if sources.resolve(source, node.func) == _QUATERNION:
                    for keyword in keywords:
                        if angle := angles.in_radians(keyword.value):
                            yield _written(
                                source, node, f"{keyword.arg} of this quaternion", keyword.value, angle
                            )
                            break
                case ast.Assign(targets=[target], value=ast.Attribute(attr=field, value=whole)) if (
                    field in _FIELDS
                ):
                    if scope.kind(whole) == _QUATERNION and angles.in_radians(target):
                        yield _read(source, node, ast.unparse(whole), field)


class _Angles:
    """The names that a function and its class use as angles."""

    def __init__(self, source: PythonSource, function: ast.AST, owner: ast.AST) -> None:
        self._source, self._function, self._owner = source, function, owner

    def in_radians(self, node: ast.expr) -> str:
        """Return how to write an angle in radians; empty if nothing says that an expression is an angle."""
        if isinstance(node, ast.Call):
            return ast.unparse(node) if self._name(node) in _GIVING else ""
        text = dotted(node)
        if not text:
            return ""
        home = self._owner if is_self_attribute(node) else self._function
        nodes = [*ast.walk(home)]
        values = assigned_to(nodes, text)
        # What is assigned anew may be an angle at one time, and its sine at another.
        is_sine = any(
            self._name(call) in _OF_ANGLES for value in values for call in calls_in(ast.walk(value))
        )
        if is_sine or (home is self._function and len(values) > 1):
            return ""
        if any(isinstance(value, ast.Call) and self._name(value) in _GIVING for value in values):
            return text
        given = [call for call in calls_in(nodes) if call.args and ast.unparse(call.args[0]) == text]
        degrees = next((ast.unparse(call) for call in given if self._name(call) in _OF_DEGREES), "")
        return degrees or (text if any(self._name(call) in _OF_ANGLES for call in given) else "")

    def _name(self, call: ast.Call) -> str:
        """Return the name of a function of math or NumPy; empty for any other."""
        name = self._source.resolve(call.func) or ""
        return name.rpartition(".")[2] if name.startswith(_LIBRARIES) else ""


def _written(source: PythonSource, node: ast.AST, place: str, given: ast.expr, angle: str) -> Finding:
    cause = f"{place} is a component of a quaternion, but {ast.unparse(given)}, which is put into it, is an angle."
    half = f"sin({angle} / 2) and w = {_math(source)}cos({angle} / 2)"
    fix = f"for a turn about z, write z = {_math(source)}{half}, and leave x and y 0; for other turns, compute all four from the angles"
    return Finding("unit-mixed", cause, source.at(node), fix)


def _read(source: PythonSource, node: ast.Assign, whole: str, field: str) -> Finding:
    target = ast.unparse(node.targets[0])
    cause = f"{whole}.{field} is a component of a quaternion, but {target} is used as an angle."
    q = whole
    yaw = f"{_math(source)}atan2(2 * ({q}.w * {q}.z + {q}.x * {q}.y), 1 - 2 * ({q}.y ** 2 + {q}.z ** 2))"
    fix = f"for the angle about z, write {target} = {yaw}"
    return Finding("unit-mixed", cause, source.at(node), fix)


def _math(source: PythonSource) -> str:
    """Return what stands before a function of math in a file: nothing where these are imported by themselves."""
    is_direct = any(imported.target == "math.sin" and imported.local == "sin" for imported in source.imports)
    return "" if is_direct else "math."
