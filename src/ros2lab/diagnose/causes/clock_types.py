"""Times of two clocks, compared or subtracted: where the one not from the node's clock was made."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.python_source import PythonSource

_SAYS = re.compile(r"times? with different clock types")
_TIME, _CLOCK = "rclpy.time.Time", "rclpy.clock.Clock"


def of_clock_types(message: str, spot: Spot) -> Finding | None:
    """Return a finding about where a line's system-clock time was made; None if none is seen."""
    source = spot.file
    if not _SAYS.search(message):
        return None
    for node in spot.nodes:
        operands = [node.left, node.right] if isinstance(node, ast.BinOp) else []
        operands = [node.left, *node.comparators] if isinstance(node, ast.Compare) else operands
        for operand in operands:
            for made in [operand, *spot.assigned(ast.unparse(operand))]:
                if wrong := next(_of_the_system(made, source), None):
                    return _told(operand, wrong, source, spot)
    return None


def _of_the_system(made: ast.expr, source: PythonSource) -> Iterator[ast.Call]:
    """Yield the times and clocks that an expression makes without naming a clock type."""
    for call in [node for node in ast.walk(made) if isinstance(node, ast.Call)]:
        is_named = "clock_type" in {keyword.arg for keyword in call.keywords}
        if not is_named and source.resolve(call.func) in (_TIME, _CLOCK):
            yield call


def _told(operand: ast.expr, made: ast.Call, source: PythonSource, spot: Spot) -> Finding:
    function = Spot(source, made.lineno).function
    first = function.args.args[0].arg if function and function.args.args else ""
    clock = f"{first if first == 'self' else 'node'}.get_clock()"
    name, text = ast.unparse(made.func), ast.unparse(made)
    given = text[len(name) + 1 : -1]
    is_time = source.resolve(made.func) == _TIME
    new = f"{name}({given + ', ' if given else ''}clock_type={clock}.clock_type)" if is_time else clock
    where = "" if made.lineno == spot.line else f" Line {spot.line} fails because of this one."
    cause = f"`{ast.unparse(operand)}` is a system-clock time, because {text} names no other clock, but the node's times are ROS-clock times: the two cannot be compared or subtracted.{where}"
    return Finding("made-wrong", cause, source.at(made), f"write {new} instead of {text}")
