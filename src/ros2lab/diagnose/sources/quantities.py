"""The kinds of quantities that fields of messages and functions hold, followed through a program."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

from ros2lab.diagnose.sources.kinds import Kinds, Scope
from ros2lab.diagnose.sources.known_values import default_of
from ros2lab.diagnose.sources.node_source import NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    assignments,
    last_name,
    own_nodes,
)
from ros2lab.diagnose.sources.static_value import UNKNOWN
from ros2lab.diagnose.sources.syntax_parts import all_parameters, by_parameter, calls_in, own_parameters

TIME, ANGLE, RATE, COMPONENT, HALF, SHARE, STICK = (
    "time",
    "angle",
    "turn rate",
    "component of a quaternion",
    "half of the angle",
    "fraction of the whole",
    "fraction of the way of a stick",
)
DEGREE = math.pi / 180
_ANY = 0.0  # an angle in radians or degrees, which is not known


@dataclass(frozen=True)
class Quantity:
    """What a number means.

    Attributes:
        unit: how much 1 is, in seconds, in radians, or of the whole.
        bound: how large the quantity may be at most, in seconds, in radians, or of the whole.
        part: the field of a time that holds only a part of it: "sec" or "nanosec"; empty for a whole time.
        read: where it is read, with the names there; None if it is not read from one field.
    """

    kind: str
    unit: float = 1.0
    bound: float = math.inf
    part: str = ""
    read: tuple[Scope, ast.Attribute] | None = field(default=None, compare=False)

    @property
    def name(self) -> str:
        """The unit in words; empty if it has none."""
        names = UNITS.get(self.kind, {})
        return next((name for unit, name in names.items() if is_same(unit, self.unit)), "")

    @property
    def said(self) -> str:
        """What it is, and how large it may be, in words."""
        if self.kind == ANGLE:
            return f"in {self.name}, and within {self.bound / self.unit:.3g}"
        return f"a {self.kind}, from {0 if self.kind == SHARE else -1} to 1 by the definition of its message"

    def is_like(self, other: Quantity) -> bool:
        """Return whether two quantities are of the same kind and unit."""
        same = (self.kind, self.part) == (other.kind, other.part)
        return same and is_same(self.unit, other.unit)


UNITS: Mapping[str, Mapping[float, str]] = {
    TIME: {1e-9: "nanoseconds", 1e-6: "microseconds", 1e-3: "milliseconds", 1.0: "seconds"},
    ANGLE: {1.0: "radians", DEGREE: "degrees"},
    RATE: {1.0: "radians per second", DEGREE: "degrees per second"},
}
# A whole turn is the most that a message's angle needs; there is no need for more to tell degrees from radians.
_TURN = Quantity(ANGLE, bound=2 * math.pi)
_WHOLE = Quantity(SHARE, bound=1.0)
# The fields of messages, by the class of the message.
FIELDS: Mapping[str, Quantity] = {
    **{f"Quaternion.{name}": Quantity(COMPONENT, bound=1.0) for name in "xyzw"},
    **{f"LaserScan.angle_{name}": _TURN for name in ("min", "max", "increment")},
    **dict.fromkeys(("Pose2D.theta", "Pose.theta", "Range.field_of_view"), _TURN),
    **dict.fromkeys(
        ("Spawn_Request.theta", "TeleportAbsolute_Request.theta", "RotateAbsolute_Goal.theta"), _TURN
    ),
    **{f"ColorRGBA.{name}": _WHOLE for name in "rgba"},
    "BatteryState.percentage": _WHOLE,
    "Joy.axes": Quantity(STICK, bound=1.0),
    "NavSatFix.latitude": Quantity(ANGLE, DEGREE, math.pi / 2),
    "NavSatFix.longitude": Quantity(ANGLE, DEGREE, math.pi),
}
_TIMES = {
    "nanoseconds": Quantity(TIME, 1e-9),
    "nanosec": Quantity(TIME, 1e-9, part="nanosec"),
    "sec": Quantity(TIME, part="sec"),
}
_S, _NS, _RAD, _DEG = Quantity(TIME), Quantity(TIME, 1e-9), Quantity(ANGLE), Quantity(ANGLE, DEGREE)
_TURNS = {"atan2": 1.0, "acos": 1.0, "asin": 0.5, "atan": 0.5}  # how much they give at most, as a part of pi
# What functions give, and what they take; those of NumPy count as those of math.
_GIVEN: Mapping[str, Quantity] = {
    **dict.fromkeys(("time.time", "time.monotonic", "time.perf_counter", "time.process_time"), _S),
    **dict.fromkeys(("time.time_ns", "time.monotonic_ns", "time.perf_counter_ns"), _NS),
    **{f"math.{name}": Quantity(ANGLE, bound=part * math.pi) for name, part in _TURNS.items()},
    "math.radians": _RAD,
    "math.degrees": _DEG,
}
_SINES = ("math.sin", "math.cos", "math.tan")
TAKEN: Mapping[str, Quantity] = {
    **dict.fromkeys((*_SINES, "math.degrees"), _RAD),
    "math.radians": _DEG,
    "time.sleep": _S,
}
_NUMPY = {
    "deg2rad": "radians",
    "rad2deg": "degrees",
    "arctan2": "atan2",
    "arctan": "atan",
    "arcsin": "asin",
    "arccos": "acos",
}
_PI = ("math.pi", "numpy.pi")
_SAME = frozenset(("abs", "float", "int", "round", "max", "min"))  # these keep the unit of their argument
# What the last word of a name says, where nothing else is known of it.
_NAMED: Mapping[str, Quantity] = {
    **dict.fromkeys(("yaw", "theta", "heading", "bearing", "angle"), Quantity(ANGLE, _ANY)),
    **dict.fromkeys(("deg", "degs", "degrees"), _DEG),
    **dict.fromkeys(("rad", "rads", "radians"), _RAD),
    **dict.fromkeys(("ms", "msec", "msecs", "millis", "milliseconds"), Quantity(TIME, 1e-3)),
}


def field_of(kind: str | None, name: str | None) -> Quantity | None:
    """Return the quantity of a field of a message, which is named as its class is; None if nothing is known of it."""
    package, _, message = (kind or "").partition(".")
    is_standard = package in ("geometry_msgs", "sensor_msgs", "std_msgs", "turtlesim")
    return FIELDS.get(f"{message.rpartition('.')[2]}.{name}") if is_standard else None


def named(node: ast.AST | str) -> Quantity | None:
    """Return what the name of a variable says of its value; None if it says nothing."""
    name = node if isinstance(node, str) else last_name(node)
    return _NAMED.get(re.split(r"_|(?<=[a-z])(?=[A-Z])", name)[-1].lower()) if name else None


def _of_math(name: str | None) -> str:
    """Return the name of a function, that of math for one of NumPy."""
    module, _, own = (name or "").rpartition(".")
    return f"math.{_NUMPY.get(own, own)}" if module == "numpy" else name or ""


def makes_angle(name: str | None) -> bool:
    """Return whether a function makes an angle of its sine, cosine or tangent."""
    return _of_math(name).removeprefix("math.") in _TURNS


def _names_in(value: ast.expr) -> list[ast.expr]:
    return [node for node in ast.walk(value) if isinstance(node, (ast.Name, ast.Attribute))]


def is_same(first: float, second: float) -> bool:
    """Return whether two units are the same."""
    return abs(first - second) <= 1e-6 * second


class Quantities:
    """The quantities of the expressions of some sources."""

    def __init__(self, sources: NodeSources) -> None:
        self.sources, self.kinds = sources, Kinds(sources)
        self._known: dict[int, Quantity | None] = {}
        self._used: dict[int, Mapping[str, Quantity]] = {}
        self._changed: dict[PythonSource, tuple[set[str], set[int]]] = {}

    def of(self, scope: Scope, node: ast.expr | None) -> Quantity | None:
        """Return the quantity of an expression; None if nothing is known of it."""
        if node is None:
            return None
        if id(node) not in self._known:
            self._known[id(node)] = None  # what leads back to itself tells nothing
            self._known[id(node)] = self._of(scope, node)
        return self._known[id(node)]

    def _of(self, scope: Scope, node: ast.expr) -> Quantity | None:
        found = self.field(scope, node)
        match node:
            case ast.UnaryOp(op=ast.USub() | ast.UAdd(), operand=inner):
                found = self.of(scope, inner)
            case ast.Subscript(value=ast.Call(func=ast.Attribute(attr="seconds_nanoseconds"))):
                found = _TIMES.get({"0": "sec", "1": "nanosec"}.get(ast.unparse(node.slice), ""))
            case ast.Subscript(value=items):
                found = self.field(scope, items)
            case ast.Call(func=ast.Name(id=name), args=[first, *more]) if name in _SAME:
                found = self.of(scope, first)
                # The least or the most of an angle and a number is a limit of another kind.
                found = found if found and (not more or found.kind == TIME) else None
            case ast.Call():
                found = self._result(scope, node)
            case ast.BinOp():
                found = self._combined(scope, node)
            case ast.Attribute() | ast.Name():
                found = found or self._held(scope, node)
        return found

    def field(self, scope: Scope, node: ast.expr) -> Quantity | None:
        """Return the quantity of a message's field, also of one that is written; None for any other expression."""
        if not isinstance(node, ast.Attribute):
            return None
        is_read = isinstance(node.ctx, ast.Load) and not is_self_attribute(node)
        found = _TIMES.get(node.attr) if is_read and node.attr not in self._own_fields else None
        if found is None and any(key.endswith(f".{node.attr}") for key in FIELDS):
            kind, name = scope.kind(node.value), last_name(node.value)
            if kind is None and self._is_quaternion(scope, node.value):
                kind = "geometry_msgs.msg.Quaternion"
            found = field_of(kind, node.attr)
            if found is None and name == "angular" and (kind or "").endswith(".Vector3"):
                found = Quantity(RATE)
        return replace(found, read=(scope, node)) if found else None

    def _is_quaternion(self, scope: Scope, node: ast.expr, depth: int = 3) -> bool:
        """Return whether a value of unknown type is surely a quaternion: a field of that name, or what was given."""
        if scope.kind(node) == "geometry_msgs.msg.Quaternion":
            return True
        named = {getattr(node, "attr", "")} & {"orientation", "rotation"}
        if named and not named & self._own_fields:
            return any("_msgs." in imported.target for imported in scope.source.imports)
        given = self._values(scope, node) if isinstance(node, (ast.Name, ast.Attribute)) and depth else []
        given = [row for row in given if not isinstance(row[1], ast.Constant)]
        return bool(given) and all(v is not None and self._is_quaternion(s, v, depth - 1) for s, v in given)

    @cached_property
    def _own_fields(self) -> set[str]:
        """The names that the workspace's own classes give to what their objects hold."""
        sources = self.sources.sources.values()
        stored = (name.partition(".") for source in sources for name in source.stored if name.count(".") == 1)
        bodies = (node.body for source in sources for node in source.nodes if isinstance(node, ast.ClassDef))
        fields = (node.target for body in bodies for node in body if isinstance(node, ast.AnnAssign))
        return {name for _, _, name in stored} | {field.id for field in fields if isinstance(field, ast.Name)}

    def _values(self, scope: Scope, node: ast.Name | ast.Attribute) -> list[tuple[Scope, ast.expr | None]]:
        """Return what a variable, an attribute or the parameter of a function is given, everywhere."""
        if isinstance(node, ast.Attribute):
            return scope.assigned(node)
        function = scope.function
        if function is None:
            written = scope.source.written(node)
            return [(scope, written)] if written is not node else []
        values = [(scope, value) for value in self.kinds.locals_of(function).get(node.id, [])]
        if any(parameter.arg == node.id for parameter in all_parameters(function)):
            return values + self._passed(scope, function, node.id) + [(scope, None)] * bool(values)
        if not values and (written := scope.source.written(node)) is not node:
            return [(Scope(self.kinds, scope.source, None, None), written)]
        return values

    @cached_property
    def _calls(self) -> Mapping[str, list[tuple[Scope, ast.Call]]]:
        found: dict[str, list[tuple[Scope, ast.Call]]] = {}
        for source in self.sources.sources.values():
            for owner, function, node in self.sources.scoped(source):
                if isinstance(node, ast.Call):
                    scope = Scope(self.kinds, source, owner, function)
                    found.setdefault(last_name(node.func), []).append((scope, node))
        return found

    def _passed(self, scope: Scope, function: Function, name: str) -> list[tuple[Scope, ast.expr | None]]:
        names = [parameter.arg for parameter in own_parameters(function)]
        rows = self._calls.get(function.name, [])
        # What only others call is given anything.
        return [(there, by_parameter(call, names).get(name)) for there, call in rows] or [(scope, None)]

    def _held(self, scope: Scope, node: ast.Name | ast.Attribute) -> Quantity | None:
        """Return the quantity of a name, from all that it is given, from its uses, or from its name."""
        text = ast.unparse(node)
        if self.sources.resolve(scope.source, node) in _PI:
            return Quantity(ANGLE, bound=math.pi)
        scaled, added = self._stepped(scope.source)
        if text in scaled:
            return None
        rows = self._values(scope, node)
        values = [row for row in rows if id(row[1]) not in added and not self._is_start(*row)]
        known = [self.of(there, value) if value is not None else None for there, value in values]
        found = [quantity for quantity in known if quantity is not None]
        # What is made of the name's own value, as by radians(), is another quantity before and after that.
        if any(
            quantity and value and text in map(ast.unparse, _names_in(value))
            for quantity, (_, value) in zip(known, values, strict=True)
        ):
            return None
        if found:
            is_sure = len(found) == len(known) and all(map(found[0].is_like, found))
            bounds = (math.inf if id(value) in added else 0.0 for _, value in rows)
            bound = max(*bounds, *(quantity.bound for quantity in found))
            return replace(found[0], bound=bound) if is_sure else None
        said, used = named(node), self._uses(scope, node).get(text)
        if used is None or self._has_sine(scope, values) or (said and said.unit):
            return said
        return used

    def _is_start(self, scope: Scope, value: ast.expr | None) -> bool:
        """Return whether a value is a plain number or None, with which a name begins whatever it holds later."""
        is_plain = isinstance(value, ast.Constant) or self.number(scope, value) is not None
        return is_plain and value is not None and not self._has_pi(scope, value)

    def _has_pi(self, scope: Scope, value: ast.expr) -> bool:
        return any(
            self.sources.resolve(scope.source, inner) in _PI
            for inner in ast.walk(value)
            if isinstance(inner, (ast.Name, ast.Attribute))
        )

    def _has_sine(self, scope: Scope, values: Iterable[tuple[Scope, ast.expr | None]]) -> bool:
        """Return whether a value is the sine of an angle: what is assigned anew may be each of both at its time."""
        calls = (call for _, value in values if value is not None for call in calls_in(ast.walk(value)))
        return any(self.function(scope, call) in _SINES for call in calls)

    def is_kept(self, known: Quantity) -> bool:
        """Return whether no file puts more into a field than its message defines, or what is not known."""
        if known.kind in (ANGLE, COMPONENT):
            return True
        name = known.read[1].attr if known.read else ""
        scopes = [Scope(self.kinds, source, None, None) for source in self.sources.sources.values()]
        puts = ((scope, pair) for scope in scopes for pair in assignments(scope.source.nodes))
        numbers = [
            self.number(scope, value)
            for scope, (target, value) in puts
            if getattr(target, "attr", "") == name
        ]
        return all(number is not None and abs(number) <= known.bound for number in numbers)

    def _stepped(self, source: PythonSource) -> tuple[set[str], set[int]]:
        """Return the names in a file whose values are changed by a factor, and the `id` of what is only added to a name."""
        if source not in self._changed:
            steps = [node for node in source.nodes if isinstance(node, ast.AugAssign)]
            added = [node for node in steps if isinstance(node.op, (ast.Add, ast.Sub))]
            scaled = {ast.unparse(node.target) for node in steps if node not in added}
            self._changed[source] = scaled, {id(node.value) for node in added}
        return self._changed[source]

    def _uses(self, scope: Scope, node: ast.expr) -> Mapping[str, Quantity]:
        """Return the names that a function, or its class for attributes, gives to functions that take angles."""
        around = scope.owner.definition if scope.owner and is_self_attribute(node) else scope.function
        if around is None:
            return {}
        if id(around) not in self._used:
            found: dict[str, Quantity] = {}
            for call in calls_in(ast.walk(around)):
                taken = TAKEN.get(self.function(scope, call) or "")
                if (
                    taken
                    and taken.kind == ANGLE
                    and call.args
                    and isinstance(call.args[0], (ast.Name, ast.Attribute))
                ):
                    text = ast.unparse(call.args[0])
                    agrees = text not in found or found[text].is_like(taken)
                    found[text] = taken if agrees else Quantity(ANGLE, _ANY)
            self._used[id(around)] = found
        return self._used[id(around)]

    def function(self, scope: Scope, call: ast.Call) -> str:
        """Return the full name of the function that is called, that of math for one of NumPy; empty if it is not known."""
        return _of_math(self.sources.resolve(scope.source, call.func))

    def _result(self, scope: Scope, call: ast.Call) -> Quantity | None:
        name = self.function(scope, call)
        given = [self.of(scope, value) for value in call.args]
        if makes_angle(name) and given and all(q == FIELDS["Quaternion.z"] for q in given):
            return replace(given[0], kind=HALF, unit=1.0, bound=math.pi) if given[0] else None
        if name in _GIVEN:
            return _GIVEN[name]
        own = self.own(scope, call)
        if own is None or own.function is None:
            return None
        returned = [n.value for n in own_nodes(own.function) if isinstance(n, ast.Return)]
        known = [self.of(own, value) for value in returned]
        first = known[0] if known else None
        return first if first and all(q is not None and first.is_like(q) for q in known) else None

    def own(self, scope: Scope, call: ast.Call) -> Scope | None:
        """Return the function of the sources that is called, as a scope; None if it is none of them."""
        if is_self_attribute(call.func) and scope.owner:
            for owner in self.sources.lineage(scope.owner)[0]:
                if method := owner.methods.get(call.func.attr):
                    return Scope(self.kinds, owner.source, owner, method)
            return None
        found = self.sources.functions.get(self.function(scope, call))
        return Scope(self.kinds, found[0], None, found[1]) if found else None

    def _combined(self, scope: Scope, node: ast.BinOp) -> Quantity | None:
        if self.number(scope, node) is not None:
            return Quantity(ANGLE) if self._has_pi(scope, node) and self._is_literal(node) else None
        left, right = self.of(scope, node.left), self.of(scope, node.right)
        match node.op:
            case ast.Add() | ast.Sub():
                if left and right:
                    return replace(left, bound=left.bound + right.bound) if left.is_like(right) else None
                one = left or right
                return replace(one, bound=math.inf) if one and one.kind in (TIME, ANGLE) else None
            case ast.Mult():
                return self._scaled(left, self.number(scope, node.right)) or self._scaled(
                    right, self.number(scope, node.left)
                )
            case ast.Div() | ast.FloorDiv():
                factor = self.number(scope, node.right)
                return self._scaled(left, 1 / factor) if factor else None
        return None

    @staticmethod
    def _is_literal(node: ast.BinOp) -> bool:
        """Return whether a number with pi is an angle, as pi / 2 is, but 180 / pi is not."""
        return not isinstance(node.op, (ast.Div, ast.FloorDiv)) or "pi" not in ast.unparse(node.right)

    @staticmethod
    def _scaled(quantity: Quantity | None, factor: float | None) -> Quantity | None:
        if quantity is None or not factor:
            return None
        if quantity.kind == HALF:
            return Quantity(ANGLE, bound=2 * quantity.bound) if factor == 2 else None
        unit = quantity.unit / abs(factor)
        units = UNITS.get(quantity.kind, {})
        return replace(quantity, unit=next((known for known in units if is_same(known, unit)), unit))

    def number(self, scope: Scope, node: ast.expr | None, depth: int = 6) -> float | None:
        """Return the value of a literal, a variable or a parameter's default; None if it is unknown."""
        written = scope.source.written(node) if depth else None
        match written:
            case ast.Attribute(attr="value" | "double_value" | "integer_value", value=read):
                written = default_of(scope.source, read) or written
            case ast.BinOp(left=left, op=ast.Mult() | ast.Div() as op, right=right):
                one, other = self.number(scope, left, depth - 1), self.number(scope, right, depth - 1)
                if one is None or other is None or (other == 0 and isinstance(op, ast.Div)):
                    return None
                return one * other if isinstance(op, ast.Mult) else one / other
            case ast.UnaryOp(op=ast.USub(), operand=inner):
                one = self.number(scope, inner, depth - 1)
                return None if one is None else -one
            case ast.Name() | ast.Attribute() if self.sources.resolve(scope.source, written) in _PI:
                return math.pi
        value = self.sources.value(scope.source, written)
        is_number = value is not UNKNOWN and isinstance(value, (int, float)) and not isinstance(value, bool)
        return float(value) if is_number else None
