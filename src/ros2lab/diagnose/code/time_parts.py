"""The seconds or the nanoseconds of a time that are taken for the whole time."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.kinds import Scope
from ros2lab.diagnose.sources.python_source import own_nodes
from ros2lab.diagnose.sources.quantities import TIME, Quantities, Quantity, is_same


def part_faults(
    quantities: Quantities, scope: Scope, node: ast.Compare | ast.BinOp, sides: tuple[ast.expr, ast.expr]
) -> Iterator[Finding]:
    """Yield nanoseconds without their seconds that are compared with a time or subtracted from one."""
    first, second = (quantities.of(scope, side) for side in sides)
    if (
        not first
        or not second
        or not first.kind == second.kind == TIME
        or not is_same(first.unit, second.unit)
    ):
        return
    known = first if first.part else second
    is_fine = {first.part, second.part} - {""} == {"nanosec"}
    if is_fine and not _has("sec", scope, first, second) and not _is_wrapped(quantities, scope):
        text = ast.unparse(known.read[1]) if known.read else ast.unparse(sides[0])
        cause = f"{text} is only the part of a time below one second, and starts again at 0 with each second: `{ast.unparse(node)}` takes it for the whole time."
        yield Finding("unit-mixed", cause, scope.source.at(node), _both(node, sides, first.unit))


def whole_seconds(
    quantities: Quantities, scope: Scope, node: ast.BinOp, step: ast.expr, other: ast.expr
) -> Iterator[Finding]:
    """Yield a difference of whole seconds with which something is multiplied, or by which it is divided."""
    known, difference = quantities.of(scope, step), scope.source.written(step)
    if not known or known.part != "sec" or not isinstance(difference, ast.BinOp):
        return
    sides = [quantities.of(scope, side) for side in (difference.left, difference.right)]
    if any(side is None or side.part != "sec" for side in sides):
        return
    is_scaled = isinstance(other, ast.Constant) or quantities.of(scope, other)
    if not is_scaled and not _has("nanosec", scope, known):
        cause = f"{ast.unparse(step)} counts whole seconds only, so it is 0 or 1 for shorter times: `{ast.unparse(node)}` takes it for the whole time."
        fix = _both(difference, (difference.left, difference.right), 1.0)
        yield Finding("unit-mixed", cause, scope.source.at(difference), fix)


def _both(node: ast.expr, sides: tuple[ast.expr, ast.expr], unit: float) -> str:
    """Return how to take both parts of two times, or of one."""
    reads = [
        next((n for n in ast.walk(side) if getattr(n, "attr", "") in ("sec", "nanosec")), None)
        for side in sides
    ]
    owners = [ast.unparse(read.value) for read in reads if isinstance(read, ast.Attribute)]
    if len(owners) < 2 or "self" in owners:
        return "use both parts of each time, as in stamp.sec + stamp.nanosec / 1e9"
    parts = [f"({owners[0]}.{part} - {owners[1]}.{part})" for part in ("sec", "nanosec")]
    is_fine = unit < 1e-6 and isinstance(node, ast.BinOp)
    whole = f"{parts[0]} * 1e9 + {parts[1]}" if is_fine else f"{parts[0]} + {parts[1]} / 1e9"
    if isinstance(node, ast.BinOp):
        return f"write ({whole}) instead of {ast.unparse(node)}"
    return f"compare {whole} with 0, or with a number of seconds"


def _has(part: str, scope: Scope, *known: Quantity) -> bool:
    """Return whether a function, or one that fills its variables, reads the other part of a time, too."""
    functions = {scope.function, *(quantity.read[0].function for quantity in known if quantity.read)}
    text = "\n".join(ast.unparse(function) for function in functions if function)
    this = {"sec": 1, "nanosec": 0}[part]
    return bool(re.search(rf"\.({part}|nanoseconds)\b|seconds_nanoseconds\(\)(?!\[{this}\])", text))


def _is_wrapped(quantities: Quantities, scope: Scope) -> bool:
    """Return whether a function adds a second where the nanoseconds began again."""
    for node in own_nodes(scope.function) if scope.function else ():
        match node:
            case ast.BinOp(op=op, right=right) | ast.AugAssign(op=op, value=right):
                if isinstance(op, (ast.Add, ast.Mod)) and quantities.number(scope, right) in (1.0, 1e9):
                    return True
    return False
