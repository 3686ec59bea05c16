"""Times in the wrong unit, such as nanoseconds that are compared with seconds."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.commented_out import comments_in
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource, last_name
from ros2lab.diagnose.sources.signatures import signature_of
from ros2lab.diagnose.sources.static_value import UNKNOWN
from ros2lab.diagnose.sources.syntax_parts import by_parameter

_NS, _S = 1e-9, 1.0
# The unit, in seconds, of attributes and functions of rclpy, builtin_interfaces and time.
_ATTRIBUTES = {"nanoseconds": _NS, "nanosec": _NS, "sec": _S}
_FUNCTIONS = {
    **dict.fromkeys(("time.time", "time.monotonic", "time.perf_counter", "time.process_time"), _S),
    **dict.fromkeys(("time.time_ns", "time.monotonic_ns", "time.perf_counter_ns"), _NS),
}
_SAME = frozenset(("abs", "float", "int", "round", "max", "min"))  # these keep the unit of their argument
_NAMES = {_NS: "nanoseconds", 1e-6: "microseconds", 1e-3: "milliseconds", _S: "seconds"}
_TOO_LONG = 1000  # s
# No node waits for anything as short as this (s): DDS alone takes longer.
_TOO_SHORT = 1e-5


def unit_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield times that are compared, added, or given to a Duration or a keyword in the wrong unit."""
    for source in sources.sources.values():
        yield from _for_parameters(sources, source)
        if "nano" not in source.text and "_ns(" not in source.text:
            continue
        times = _Times(sources, source)
        # A duration that is added to a time or subtracted from it may be of any length.
        operands = {
            id(operand) for n in source.nodes if isinstance(n, ast.BinOp) for operand in (n.left, n.right)
        }
        for node in source.nodes:
            match node:
                case ast.Compare(left=left, ops=[_], comparators=[right]):
                    yield from times.mixed(node, left, right)
                case ast.BinOp(left=left, op=ast.Add() | ast.Sub(), right=right):
                    yield from times.mixed(node, left, right)
                case ast.Call() if id(node) not in operands:
                    yield from times.too_short(node)


def _for_parameters(sources: NodeSources, source: PythonSource) -> Iterator[Finding]:
    """Yield milliseconds that are given to a parameter whose name says that it takes seconds.

    A comment, or the name of the value, tells what is meant. Without them a timeout may be of any length, but
    nothing is repeated only each quarter of an hour or so, unless that is a round time.
    """
    times = _Times(sources, source)
    for call, name, given in _in_seconds(source):
        value, text = times.number(given) or 0.0, ast.unparse(given)
        is_said = _is_in_ms(given) or (value > 0 and _says(source, call, value))
        is_long = "timeout" not in name and value >= _TOO_LONG and value % 100 == 0 and value % 600 > 0
        if is_said or is_long:
            lasts = f"{value:g}: {value / 60:.3g} minutes" if value >= 60 else text
            meant = f"{text} / 1000" if _is_in_ms(given) else str(value / 1000)
            fix = f"write {meant} instead of {text}{'' if is_said else ' if milliseconds are meant'}"
            cause = f"{name} counts seconds, and is given {lasts}."
            yield Finding("unit-mixed", cause, source.at(given), fix)


def _in_seconds(source: PythonSource) -> Iterator[tuple[ast.Call, str, ast.expr]]:
    """Yield what calls give to parameters whose names say that they take seconds."""
    for call in source.calls if not source.fault else ():
        known = signature_of(source, call) if call.args else None
        places = [parameter.name for parameter in known.places] if known else []
        for name, given in by_parameter(call, places).items():
            if name.endswith(("_sec", "_seconds")):
                yield call, name, given


def _is_in_ms(value: ast.expr) -> bool:
    """Return whether the name of a value says that it counts milliseconds."""
    return re.search(r"(^|_)(ms|msecs?|millis(econds?)?)$", last_name(value).lower()) is not None


def _says(source: PythonSource, call: ast.Call, value: float) -> bool:
    """Return whether a comment at a call says that a number counts milliseconds, or says how many seconds these are."""
    lines = range(call.lineno - 1, (call.end_lineno or call.lineno) + 1)
    said = " ".join(text for number, text in comments_in(source.text) if number in lines).lower()
    of_seconds = rf"\b{re.escape(f'{value / 1000:g}')}(\.0)?[ -]?(s|sec|seconds?)\b"
    return bool(re.search(rf"{of_seconds}|\b{value:g} ?(ms|milliseconds?)\b", said))


class _Times:
    """Finds the unit in which each expression of a file counts time."""

    def __init__(self, sources: NodeSources, source: PythonSource) -> None:
        self._sources, self._source = sources, source

    def mixed(self, node: ast.expr, left: ast.expr, right: ast.expr) -> Iterator[Finding]:
        """Yield an expression whose sides count time in different units, or too finely for the number."""
        sides = [(unit, side) for side in (left, right) if (unit := self.unit(side)) is not None]
        if not sides:
            return
        fine, side = min(sides, key=lambda pair: pair[0])
        other = right if side is left else left
        coarse = max(unit for unit, _ in sides) if len(sides) == 2 else _S
        value = self.number(other)
        if len(sides) == 1 and (value is None or not 0 < abs(value) * fine < _TOO_SHORT):
            return
        if fine not in _NAMES or coarse not in _NAMES or _is_same(fine, coarse):
            return
        text, against = ast.unparse(side), ast.unparse(other)
        said = f"is in {_NAMES[coarse]}" if len(sides) == 2 else f"is meant in {_NAMES[coarse]}"
        cause = f"{text} is in {_NAMES[fine]}, but {against} {said}, so `{ast.unparse(node)}` mixes units."
        factor = f"1e{round(math.log10(coarse / fine))}"
        fix = f"write {_in_parentheses(text)} / {factor} instead of {text}"
        yield Finding("unit-mixed", cause, self._source.at(node), fix)

    def too_short(self, call: ast.Call) -> Iterator[Finding]:
        """Yield Durations of so few nanoseconds that no node could keep to them."""
        if not (self._source.resolve(call.func) or "").endswith(".Duration"):
            return
        given = {keyword.arg: keyword.value for keyword in call.keywords}
        value = self.number(given.get("nanoseconds"))
        if len(given) == 1 and value and 1 < value < _TOO_SHORT / _NS:  # 1 is the shortest possible
            cause = f"{ast.unparse(call)} lasts only {value:g} nanoseconds, which is over before anything can happen."
            fix = f"write Duration(seconds={value:g}), or Duration(seconds={value / 1000:g}) if milliseconds are meant"
            yield Finding("unit-mixed", cause, self._source.at(call), fix)

    def unit(self, node: ast.expr | None, depth: int = 4) -> float | None:
        """Return the unit of an expression, in seconds; None if it is no time, or the unit is unknown."""
        found: float | None = None
        match node:
            case ast.Attribute(attr=attr) if attr in _ATTRIBUTES:
                found = _ATTRIBUTES[attr]
            case ast.Attribute() | ast.Name() if depth:
                written = self._source.written(node)
                found = self.unit(written, depth - 1) if written is not node else None
            case ast.Call(func=ast.Name(id=name), args=[first, *_]) if name in _SAME:
                found = self.unit(first, depth)
            case ast.Call(func=function):
                found = _FUNCTIONS.get(self._source.resolve(function) or "")
            case ast.BinOp(left=left, op=ast.Add() | ast.Sub(), right=right):
                units = {self.unit(left, depth), self.unit(right, depth)} - {None}
                found = units.pop() if len(units) == 1 else None
            case ast.BinOp(left=left, op=ast.Div() | ast.FloorDiv(), right=right):
                found = self._scaled(left, right, depth, divides=True)
            case ast.BinOp(left=left, op=ast.Mult(), right=right):
                found = self._scaled(left, right, depth) or self._scaled(right, left, depth)
        return found

    def _scaled(self, node: ast.expr, by: ast.expr, depth: int, *, divides: bool = False) -> float | None:
        unit, factor = self.unit(node, depth), self.number(by)
        if unit is None or not factor or self.unit(by, depth) is not None:
            return None
        found = unit * factor if divides else unit / factor
        return next((known for known in _NAMES if _is_same(known, found)), found)

    def number(self, node: ast.expr | None) -> float | None:
        """Return the value of a literal, a variable or a parameter's default; None if it is unknown."""
        written = self._source.written(node)
        match written:
            case ast.Attribute(
                attr="value", value=ast.Call(func=ast.Attribute(attr=how), args=[_, default, *_])
            ) if how == "declare_parameter":
                written = default
        value = self._sources.value(self._source, written)
        is_number = value is not UNKNOWN and isinstance(value, (int, float)) and not isinstance(value, bool)
        return float(value) if is_number else None


def _is_same(first: float, second: float) -> bool:
    return abs(first / second - 1) < 1e-6


def _in_parentheses(text: str) -> str:
    return text if text.replace(".", "").replace("_", "").isalnum() else f"({text})"
