"""Components of quaternions that are taken for angles, and angles that are put into them."""

from __future__ import annotations

import ast

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.kinds import Scope
from ros2lab.diagnose.sources.python_source import PythonSource, last_name
from ros2lab.diagnose.sources.quantities import DEGREE, Quantity


def read_as_angle(scope: Scope, node: ast.AST, known: Quantity, why: str) -> Finding:
    """Return what is said of a component of a quaternion that code takes for an angle, where it reads it."""
    there, read = known.read or (scope, None)
    q, text = (ast.unparse(read.value), ast.unparse(read)) if read else ("q", "q.z")
    yaw = f"{of_math(there.source, 'atan2')}(2 * ({q}.w * {q}.z + {q}.x * {q}.y), 1 - 2 * ({q}.y ** 2 + {q}.z ** 2))"
    instead = f"{yaw} instead of {text}"
    if isinstance(node, ast.Assign) and node.value is read:
        target = ast.unparse(node.targets[0])
        why, instead = f"but {target} is used as an angle", f"{target} = {yaw}"
    cause = f"{text} is a component of a quaternion, never above 1 and no angle, {why}."
    return Finding(
        "unit-mixed",
        cause,
        there.source.at(read or node),
        f"for the angle about z, write {instead}{also(there.source)}",
    )


def angle_put(source: PythonSource, node: ast.AST, place: str, value: ast.expr, known: Quantity) -> Finding:
    """Return what is said of an angle that is put into a component of a quaternion."""
    text = ast.unparse(value)
    cause = f"{place} is a component of a quaternion, but {text}, which is put into it, is an angle."
    angle = called(source, "radians", value) if known.unit == DEGREE else text
    half = f"{of_math(source, 'sin')}({angle} / 2) and w = {of_math(source, 'cos')}({angle} / 2)"
    axis = next((one for one in "xy" if place.endswith(f".{one}") or place.startswith(f"{one} of ")), "z")
    others = "xyz".replace(axis, "")
    fix = f"for a turn about {axis}, write {axis} = {half}, and leave {others[0]} and {others[1]} 0; for other turns, compute all four from the angles{also(source)}"
    return Finding("unit-mixed", cause, source.at(node), fix)


def added(source: PythonSource, node: ast.AugAssign) -> Finding:
    """Return what is said of an angle that is added to a component of a quaternion."""
    text = ast.unparse(node.target)
    cause = f"{text} is a component of a quaternion: `{ast.unparse(node)}` does not turn it by {ast.unparse(node.value)}."
    half = f"{of_math(source, 'sin')}(angle / 2) and w = {of_math(source, 'cos')}(angle / 2)"
    fix = f"keep the angle in a variable, add to it there, and write z = {half}"
    return Finding("unit-mixed", cause, source.at(node), fix)


def called(source: PythonSource, function: str, value: ast.expr) -> str:
    """Return a call of a function of math as a file writes it; of the inverse of that function, what it is given."""
    inverse = {"radians": "degrees", "degrees": "radians"}.get(function)
    if isinstance(value, ast.Call) and last_name(value.func) == inverse and len(value.args) == 1:
        return ast.unparse(value.args[0])
    return f"{of_math(source, function)}({ast.unparse(value)})"


def of_math(source: PythonSource, function: str) -> str:
    """Return the name of a function of math in a file, or that of NumPy in one that imports this alone."""
    names = {imported.target: imported.local for imported in source.imports}
    if "math" not in names and "numpy" in names:
        return f"{names['numpy']}.{function.replace('atan', 'arctan')}"
    return names.get(f"math.{function}", f"math.{function}")


def also(source: PythonSource) -> str:
    """Return the import that functions of math need in a file; empty if it has one."""
    has_one = any(imported.target.partition(".")[0] in ("math", "numpy") for imported in source.imports)
    return "" if has_one else ", with `import math` at the top"
