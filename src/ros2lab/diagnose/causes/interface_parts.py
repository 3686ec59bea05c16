"""Objects that are made as another one than is needed: a time of another clock, or a whole service or action type."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.python_source import PythonSource, own_nodes

_PARTS = {"srv": ("Request", "Response"), "action": ("Goal", "Result", "Feedback")}
_WHOLE = re.compile(r"\w+\.(?P<kind>srv|action)\.(?P<name>\w+)$")
_CANNOT_BE_MADE = ("NotImplementedError", "TypeError")


def of_part(kind: str, spot: Spot) -> Finding | None:
    """Return which part of a service or action a line should make; None if it makes no whole type."""
    source = spot.file
    if kind not in _CANNOT_BE_MADE:
        return None
    for call in spot.calls:
        match = _WHOLE.match(source.resolve(call.func) or "")
        if match is None:
            continue
        parts = _PARTS[match["kind"]]
        part = next(_parts_meant(call, match[0], parts, spot), parts[0])
        written = ast.unparse(call.func)
        old = ast.unparse(call)
        whole = "service" if match["kind"] == "srv" else "action"
        cause = (
            f"{written} is the whole {whole} type, which cannot be instantiated; its {part} is needed here."
        )
        fix = f"write {written}.{part}{old[len(written) :]} instead of {old}"
        return Finding("made-wrong", cause, source.at(call), fix)
    return None


def _parts_meant(call: ast.Call, name: str, parts: tuple[str, ...], spot: Spot) -> Iterator[str]:
    """Yield the parts that have the given fields, then those that fit how the object is used."""
    source = spot.file
    targets = {target for target, made in source.made if made is call}
    fields = {keyword.arg for keyword in call.keywords if keyword.arg} | {
        node.attr
        for node in source.nodes
        if isinstance(node, ast.Attribute) and ast.unparse(node.value) in targets
    }
    for part in parts:
        known = interfaces.fields_of(f"{name}_{part}") or {}
        if fields and fields <= known.keys():
            yield part
    yield from (part for used in _uses(call, targets, source, spot) for part in parts if part == used)


def _uses(call: ast.Call, targets: set[str], source: PythonSource, spot: Spot) -> Iterator[str]:
    """Yield the parts that fit how an object is used: returned, or published as feedback."""

    def is_it(node: ast.AST | None) -> bool:
        return node is call or (node is not None and ast.unparse(node) in targets)

    inner = [*own_nodes(spot.function)] if spot.function else []
    if any(isinstance(node, ast.Return) and is_it(node.value) for node in inner):
        yield from ("Response", "Result")
    for node in source.nodes:
        if isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "publish_feedback":
            yield from ["Feedback"] if any(map(is_it, node.args)) else []


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
