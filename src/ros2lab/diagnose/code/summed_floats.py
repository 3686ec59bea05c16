"""Floats that are summed in steps and compared with a number that the sum comes near, but never is."""

from __future__ import annotations

import ast
import math
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.syntax_parts import equal_sides

_MOST_STEPS = 10_000


def summed_floats(sources: NodeSources, source: PythonSource) -> Iterator[Finding]:
    """Yield the comparisons of a file that Python, summing the same steps, never finds equal but once nearly."""
    for node in (n for n in source.nodes if isinstance(n, ast.Compare) and len(n.ops) == 1):
        for side, others, is_equal in equal_sides(node):
            if not isinstance(side, (ast.Name, ast.Attribute)):
                continue
            starts, step = _summed(sources, source, side)
            for other in others if step else ():
                wanted = sources.value(source, source.written(other))
                if isinstance(wanted, (int, float)) and (near := _nearest(starts, step, wanted)) is not None:
                    text, value = ast.unparse(side), ast.unparse(other)
                    cause = f"{text} is never exactly {wanted}: floats hold most fractions only nearly, and its steps of {abs(step)} come to {near!r}."
                    fix = compared_nearly(source, text, value, is_equal=is_equal)
                    yield Finding("never-equal", cause, source.at(node), fix)


def compared_nearly(source: PythonSource, left: str, right: str, *, is_equal: bool = True) -> str:
    """Say how to compare two floats that are rarely exactly equal."""
    more = "" if "math" in source.names else ", with `import math` at the top"
    return f"compare with `{'' if is_equal else 'not '}math.isclose({left}, {right}, abs_tol=1e-9)`{more}"


def _summed(
    sources: NodeSources, source: PythonSource, name: ast.Name | ast.Attribute
) -> tuple[list[float], float]:
    """Return the numbers at which a name starts and the only step by which it changes; 0 if it gets anything else."""
    text, values, steps = ast.unparse(name), list[float](), set[float]()
    stores = [n for n in source.nodes if isinstance(getattr(n, "ctx", None), ast.Store)]
    attr = getattr(name, "attr", "")
    if any(getattr(n, "attr", "") == attr != "" and ast.unparse(n) != text for n in stores):
        return [], 0
    around = source.function_at(name.lineno)
    for store in (n for n in stores if isinstance(n, type(name)) and ast.unparse(n) == text):
        number, factor = _given(source.above(store), text)
        value = sources.value(source, source.written(number))
        is_here = attr or source.function_at(store.lineno) is around
        if not is_here or not isinstance(value, (int, float)):
            return [], 0
        values += [] if factor else [value]
        steps |= {factor * value} if factor else set()
    return (values, steps.pop()) if values and len(steps) == 1 else ([], 0)


def _given(statement: ast.AST | None, text: str) -> tuple[ast.expr | None, int]:
    """Return the number that a statement adds to a name (1), subtracts (-1) or gives it (0); None if it does another thing."""
    match statement:
        case ast.AugAssign(op=ast.Add() | ast.Sub() as sign, value=number):
            return number, 1 if isinstance(sign, ast.Add) else -1
        case ast.Assign(value=ast.BinOp(left=before, op=ast.Add() | ast.Sub() as sign, right=number)) if (
            ast.unparse(before) == text
        ):
            return number, 1 if isinstance(sign, ast.Add) else -1
        case ast.Assign(targets=[_], value=value) | ast.AnnAssign(value=value):
            return value, 0
    return None, 0


def _nearest(starts: list[float], step: float, wanted: float) -> float | None:
    """Return the sum that comes nearest to a number; None if one is equal to it, or none is near."""
    found = None
    for start in starts:
        value = start
        for _ in range(_MOST_STEPS):
            if value == wanted:
                return None
            if math.isclose(value, wanted, rel_tol=1e-9, abs_tol=1e-9):
                found = value
            value += step
    return found
