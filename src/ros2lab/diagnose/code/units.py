"""Quantities that are taken for what they are not: other units, a part for the whole, or a component for an angle."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.commented_out import comments_in
from ros2lab.diagnose.sources.kinds import CLASS, Scope
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource, assignments, last_name
from ros2lab.diagnose.sources.quantities import (
    ANGLE,
    COMPONENT,
    DEGREE,
    FIELDS,
    HALF,
    INVERSE,
    RATE,
    SHARE,
    TAKEN,
    TIME,
    Quantities,
    Quantity,
    is_same,
    named,
)
from ros2lab.diagnose.sources.signatures import signature_of
from ros2lab.diagnose.sources.syntax_parts import all_parameters, by_parameter, own_parameters

_TOO_LONG = 1000  # s
# No node waits for anything as short as this (s): DDS alone takes longer.
_TOO_SHORT = 1e-5
_WORDS = re.compile(
    r"nano|_ns\(|orientation|rotation|[qQ]uat|sin|cos|tan|degrees|radians|rad2deg|deg2rad|angle_|theta|yaw|percentage|axes|ColorRGBA|itude|\.sec\b"
)
_LESS = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)


def unit_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield quantities that are compared, added, written or given to a function as what they are not."""
    quantities = Quantities(sources)
    for source in sources.sources.values():
        yield from _for_parameters(quantities, source)
        if source.fault or not _WORDS.search(source.text):
            continue
        # A duration that is added to a time or subtracted from it may be of any length.
        operands = {id(side) for n in source.nodes if isinstance(n, ast.BinOp) for side in (n.left, n.right)}
        told = set[str]()
        for owner, function, node in sources.scoped(source):
            uses = _Uses(quantities, Scope(quantities.kinds, source, owner, function))
            found = (
                uses.at(node)
                if not isinstance(node, ast.Call) or id(node) not in operands
                else uses.given(node)
            )
            for finding in found:
                if finding.place not in told:
                    told.add(finding.place)
                    yield finding


def _for_parameters(quantities: Quantities, source: PythonSource) -> Iterator[Finding]:
    """Yield milliseconds that are given to a parameter whose name says that it takes seconds.

    A comment, or the name of the value, tells what is meant. Without them a timeout may be of any length, but
    nothing is repeated only each quarter of an hour or so, unless that is a round time.
    """
    scope = Scope(quantities.kinds, source, None, None)
    for call, name, given in _in_seconds(source):
        value, text = quantities.number(scope, given) or 0.0, ast.unparse(given)
        in_ms = (known := named(given)) is not None and (known.kind, known.unit) == (TIME, 1e-3)
        is_said = in_ms or (value > 0 and _says(source, call, value))
        is_long = "timeout" not in name and value >= _TOO_LONG and value % 100 == 0 and value % 600 > 0
        if is_said or is_long:
            lasts = f"{value:g}: {value / 60:.3g} minutes" if value >= 60 else text
            meant = f"{text} / 1000" if in_ms else str(value / 1000)
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


def _says(source: PythonSource, call: ast.Call, value: float) -> bool:
    """Return whether a comment at a call says that a number counts milliseconds, or says how many seconds these are."""
    lines = range(call.lineno - 1, (call.end_lineno or call.lineno) + 1)
    said = " ".join(text for number, text in comments_in(source.text) if number in lines).lower()
    of_seconds = rf"\b{re.escape(f'{value / 1000:g}')}(\.0)?[ -]?(s|sec|seconds?)\b"
    return bool(re.search(rf"{of_seconds}|\b{value:g} ?(ms|milliseconds?)\b", said))


@dataclass(frozen=True)
class _Uses:
    """What the code of a function does with quantities."""

    quantities: Quantities
    scope: Scope

    def at(self, node: ast.AST) -> Iterator[Finding]:
        """Yield what is wrong with one node of the syntax tree."""
        match node:
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                yield from self._meeting(node, left, right)
                if isinstance(op, _LESS):
                    yield from self._never(node, left, right)
                    yield from self._never(node, right, left)
            case ast.BinOp(left=left, op=ast.Add() | ast.Sub(), right=right):
                yield from self._meeting(node, left, right)
            case ast.BinOp(left=left, op=ast.Mult() | ast.Div(), right=right):
                yield from self._whole_seconds(node, left, right)
            case ast.Assign() | ast.AnnAssign():
                for target, value in assignments([node]):
                    yield from self._put(node, target, value)
            case ast.AugAssign(target=ast.Attribute() as target, op=ast.Add() | ast.Sub(), value=value):
                yield from self._turned(node, target, value)
            case ast.Call():
                yield from self._too_short(node)
                yield from self.given(node)
            case ast.JoinedStr(values=values):
                yield from self._shown(values)

    def given(self, call: ast.Call) -> Iterator[Finding]:
        """Yield what a call gives to a function, a message or one of the workspace's own functions as something else."""
        name = self.quantities.function(self.scope, call)
        if name in TAKEN and len(call.args) == 1:
            value = call.args[0]
            known = self.quantities.of(self.scope, value)
            number = (
                self.quantities.number(self.scope, value)
                if isinstance(value, (ast.Constant, ast.UnaryOp))
                else None
            )
            if known is not None:
                yield from self._clash(call, value, known, f"{ast.unparse(call.func)}()", TAKEN[name])
            elif number and number % 15 == 0 and TAKEN[name].kind == ANGLE and TAKEN[name].unit == 1.0:
                cause = f"{ast.unparse(call.func)}() takes radians, and {ast.unparse(value)} are {abs(number) / 2 / math.pi:.1f} turns."
                fix = f"write {self._call('radians', value)} instead of {ast.unparse(value)}"
                yield self._finding(value, cause, fix)
        kind = (self.scope.kind(call.func) or "").removeprefix(CLASS).rpartition(".")[2]
        for keyword in call.keywords:
            if keyword.arg and (wanted := FIELDS.get(f"{kind}.{keyword.arg}")):
                yield from self._written(call, f"{keyword.arg} of this {kind}", keyword.value, wanted)
        own = self.quantities.own(self.scope, call)
        if own and own.function:
            for name, value in by_parameter(call, [p.arg for p in own_parameters(own.function)]).items():
                if (wanted := named(name)) and any(p.arg == name for p in all_parameters(own.function)):
                    yield from self._named(call, name, value, wanted, own.source)

    def _meeting(self, node: ast.expr, left: ast.expr, right: ast.expr) -> Iterator[Finding]:
        """Yield two sides that are no quantities of one kind and unit."""
        first, second = (self.quantities.of(self.scope, side) for side in (left, right))
        if first and second:
            yield from self._clash(node, left, first, ast.unparse(right), second)
            yield from self._part(node, first, second)
        for side, other, known, its in ((left, right, first, second), (right, left, second, first)):
            value = self.quantities.number(self.scope, other) if its is None else None
            if (
                known
                and known.kind == TIME
                and value is not None
                and 0 < abs(value) * known.unit < _TOO_SHORT
            ):
                said = Quantity(TIME)
                if known.name and not is_same(known.unit, said.unit):
                    yield self._mixed(node, side, known, f"{ast.unparse(other)} is meant in seconds", said)

    def _never(self, node: ast.expr, side: ast.expr, other: ast.expr) -> Iterator[Finding]:
        """Yield a comparison with a number that a quantity never reaches."""
        known, number = self.quantities.of(self.scope, side), self.quantities.number(self.scope, other)
        if known is None or number is None or self.quantities.of(self.scope, other):
            return
        # An angle within half a turn may be compared with a whole one.
        most = max(known.bound, 2 * math.pi) if known.kind == ANGLE else known.bound
        is_more = known.unit and abs(number) * known.unit > most * 1.01
        if not is_more or (known.kind not in (ANGLE, COMPONENT) and not self.quantities.is_kept(known)):
            return
        text, use = ast.unparse(side), f"`{ast.unparse(node)}` never changes"
        if known.kind == COMPONENT:
            yield self._read(node, known, None, f"so `{ast.unparse(node)}` never changes")
        elif known.kind == ANGLE and known.unit == 1.0:
            cause = f"{text} is in radians, never above {most:.3g}, so {use}."
            yield self._finding(
                node, cause, f"write {self._call('radians', other)} instead of {ast.unparse(other)}"
            )
        else:
            cause = f"{text} is never above {known.bound / known.unit:g}: it is {_said(known)}, so {use}."
            share = f"write {number / 100:g} instead of {ast.unparse(other)}"
            fix = (
                share
                if known.kind == SHARE
                else f"compare it with a number up to {known.bound / known.unit:g}"
            )
            yield self._finding(node, cause, fix)

    def _put(self, node: ast.AST, target: ast.expr, value: ast.expr) -> Iterator[Finding]:
        """Yield what is assigned to a field or to a name that means something else."""
        if wanted := self.quantities.field(self.scope, target):
            yield from self._written(node, ast.unparse(target), value, wanted)
        elif wanted := named(target):
            yield from self._named(node, ast.unparse(target), value, wanted, self.scope.source)

    def _named(
        self, node: ast.AST, name: str, value: ast.expr, wanted: Quantity, home: PythonSource
    ) -> Iterator[Finding]:
        known = self.quantities.of(self.scope, value)
        if known is None or self._is_passed_on(name, home):
            return
        if isinstance(node, ast.Assign):
            held = self.quantities.of(self.scope, node.targets[0])
            if held is None or not held.is_like(known):
                return
        if known.kind == HALF and wanted.kind == ANGLE:
            text = ast.unparse(value)
            cause = f"{text} is half of the angle: a component of a quaternion is the sine or cosine of that half."
            yield self._finding(node, cause, f"write 2 * {text} instead of {text}")
        else:
            yield from self._clash(node, value, known, name, wanted)

    def _is_passed_on(self, name: str, home: PythonSource) -> bool:
        """Return whether a file makes an angle of what a name holds, or puts it into a quaternion."""
        for node in home.nodes:
            given: list[ast.expr] = []
            match node:
                case ast.Call(args=args, keywords=keywords) if INVERSE.fullmatch(
                    home.resolve(node.func) or ""
                ):
                    given = args
                case ast.Call(args=args, keywords=keywords):
                    given = [*args, *(k.value for k in keywords)] if "uat" in ast.unparse(node.func) else []
                case ast.BinOp(op=ast.Mult(), left=left, right=right):
                    is_doubled = any(isinstance(n, ast.Constant) and n.value == 2 for n in (left, right))
                    given = [left, right] if is_doubled else []
                case ast.Assign(targets=[ast.Attribute(attr="x" | "y" | "z" | "w")], value=value):
                    given = [value]
            if any(ast.unparse(one) == name for one in given):
                return True
        return False

    def _written(self, node: ast.AST, place: str, value: ast.expr, wanted: Quantity) -> Iterator[Finding]:
        """Yield what is put into a field that holds another quantity, or never so much."""
        known, number = self.quantities.of(self.scope, value), self.quantities.number(self.scope, value)
        if known is not None:
            yield from self._clash(node, value, known, place, wanted)
        elif number is not None and abs(number) * wanted.unit > wanted.bound * 1.01:
            text = ast.unparse(value)
            cause = f"{place} is {_said(wanted)}, so it is never as much as {text}."
            if wanted.kind == COMPONENT:
                yield self._turn(
                    node, place, value, Quantity(ANGLE, 1.0 if abs(number) <= 2 * math.pi else DEGREE)
                )
            elif wanted.kind == SHARE:
                whole = 255 if "color" in place.lower() or "RGBA" in place else 100
                yield self._finding(node, cause, f"write {number / whole:.3g} instead of {text}")
            elif wanted.kind == ANGLE and wanted.unit == 1.0:
                yield self._finding(node, cause, f"write {self._call('radians', value)} instead of {text}")
            else:
                yield self._finding(node, cause, f"write a number up to {wanted.bound / wanted.unit:g}")

    def _turned(self, node: ast.AugAssign, target: ast.Attribute, value: ast.expr) -> Iterator[Finding]:
        """Yield a number or an angle that is added to a component of a quaternion."""
        wanted = self.quantities.field(self.scope, target)
        known = self.quantities.of(self.scope, value)
        number = self.quantities.number(self.scope, value)
        if wanted and wanted.kind == COMPONENT and (number or (known and known.kind == ANGLE)):
            text = ast.unparse(target)
            cause = f"{text} is a component of a quaternion: `{ast.unparse(node)}` does not turn it by {ast.unparse(value)}."
            fix = f"keep the angle in a variable, add to it there, and write z = {self._math('sin')}(angle / 2) and w = {self._math('cos')}(angle / 2)"
            yield self._finding(node, cause, fix)

    def _clash(
        self, node: ast.AST, value: ast.expr, known: Quantity, place: str, wanted: Quantity
    ) -> Iterator[Finding]:
        """Yield a value that is no quantity of the kind and unit of a place."""
        kinds = {known.kind, wanted.kind}
        if kinds == {COMPONENT, ANGLE}:
            if known.kind == COMPONENT:
                yield self._read(node, known, value, f"but `{_line(node)}` takes it for an angle")
            elif isinstance(node, (ast.Assign, ast.Call)):
                yield self._turn(node, place, value, known)
            else:
                yield self._read(node, wanted, None, f"but `{_line(node)}` takes it for an angle")
        elif (kinds <= {TIME} or kinds <= {ANGLE, RATE}) and known.name and wanted.name:
            if not is_same(known.unit, wanted.unit) and (known.kind == wanted.kind or known.unit == DEGREE):
                yield self._mixed(node, value, known, f"{place} is in {wanted.name}", wanted)

    def _mixed(self, node: ast.AST, value: ast.expr, known: Quantity, said: str, wanted: Quantity) -> Finding:
        """Return what is said of two units that meet, of which the finer one is to be converted."""
        text = ast.unparse(value)
        if isinstance(node, (ast.Compare, ast.BinOp)) and known.unit > wanted.unit:
            sides = (
                [node.left, node.right] if isinstance(node, ast.BinOp) else [node.left, node.comparators[0]]
            )
            other = sides[1] if value is sides[0] else sides[0]
            return self._mixed(node, other, wanted, f"{text} is in {known.name}", known)
        cause = f"{text} is in {known.name}, but {said}, so `{_line(node)}` mixes units."
        if known.kind == TIME:
            factor = f"1e{round(math.log10(wanted.unit / known.unit))}" if wanted.unit > known.unit else ""
            ratio = f"/ {factor}" if factor else f"* 1e{round(math.log10(known.unit / wanted.unit))}"
            return self._finding(node, cause, f"write {_in_parentheses(text)} {ratio} instead of {text}")
        if (
            isinstance(node, ast.Call)
            and value in node.args
            and last_name(node.func) in ("radians", "degrees", "deg2rad", "rad2deg")
        ):
            return self._finding(
                node,
                f"{text} is in {known.name} already, and `{_line(node)}` converts it once more.",
                f"write {text} instead of {_line(node)}",
            )
        to = "degrees" if is_same(wanted.unit, DEGREE) else "radians"
        return self._finding(node, cause, f"write {self._call(to, value)} instead of {text}")

    def _part(self, node: ast.expr, first: Quantity, second: Quantity) -> Iterator[Finding]:
        """Yield nanoseconds without their seconds that are taken for a whole time."""
        if (
            first.kind == second.kind == TIME
            and is_same(first.unit, second.unit)
            and first.part != "sec" != second.part
        ):
            known = first if first.part else second
            if known.part and not self._has("sec", first, second) and not self._is_wrapped():
                text = ast.unparse(known.read[1]) if known.read else "the second value"
                cause = f"{text} is only the part of a time below one second, and starts again at 0 with each second: `{ast.unparse(node)}` takes it for the whole time."
                yield self._finding(node, cause, self._both(known))

    def _whole_seconds(self, node: ast.BinOp, left: ast.expr, right: ast.expr) -> Iterator[Finding]:
        """Yield a number of whole seconds by which something is multiplied or divided, as by a short time."""
        for side, other in ((left, right), (right, left)):
            known = self.quantities.of(self.scope, side)
            is_step = isinstance(self.scope.source.written(side), ast.BinOp)
            if side is left and isinstance(node.op, ast.Div):
                continue
            if known and known.part == "sec" and is_step and not self._has("nanosec", known):
                if self.quantities.of(self.scope, other) is None and not isinstance(other, ast.Constant):
                    cause = f"{ast.unparse(side)} counts whole seconds only, so it is 0 or 1 for shorter times: `{ast.unparse(node)}` takes it for the whole time."
                    yield self._finding(node, cause, self._both(known))

    def _has(self, part: str, *known: Quantity) -> bool:
        """Return whether a function, or one that fills its variables, reads the other part of a time, too."""
        functions = {self.scope.function, *(quantity.read[0].function for quantity in known if quantity.read)}
        text = "\n".join(ast.unparse(function) for function in functions if function)
        this = {"sec": 1, "nanosec": 0}[part]
        return bool(re.search(rf"\.({part}|nanoseconds)\b|seconds_nanoseconds\(\)(?!\[{this}\])", text))

    def _is_wrapped(self) -> bool:
        """Return whether a function adds a second where the nanoseconds began again."""
        for node in ast.walk(self.scope.function) if self.scope.function else ():
            match node:
                case (
                    ast.BinOp(op=ast.Add() | ast.Mod(), right=right)
                    | ast.AugAssign(op=ast.Add() | ast.Mod(), value=right)
                ):
                    if self.quantities.number(self.scope, right) in (1.0, 1e9):
                        return True
        return False

    def _both(self, known: Quantity) -> str:
        text = ast.unparse(known.read[1].value) if known.read else "stamp"
        return f"use both parts: {text}.sec + {text}.nanosec / 1e9"

    def _read(self, node: ast.AST, known: Quantity, value: ast.expr | None, why: str) -> Finding:
        """Return what is said of a component of a quaternion that is read as an angle."""
        scope, read = known.read or (self.scope, None)
        whole = ast.unparse(read.value) if read else "q"
        text = ast.unparse(read) if read else "q.z"
        q = whole
        yaw = f"{self._math('atan2')}(2 * ({q}.w * {q}.z + {q}.x * {q}.y), 1 - 2 * ({q}.y ** 2 + {q}.z ** 2))"
        if isinstance(node, ast.Assign) and value is read:
            why, instead = (
                f"but {ast.unparse(node.targets[0])} is used as an angle",
                f"{ast.unparse(node.targets[0])} = {yaw}",
            )
        else:
            instead = f"{yaw} instead of {text}"
        cause = f"{text} is a component of a quaternion, never above 1 and no angle, {why}."
        return Finding(
            "unit-mixed", cause, scope.source.at(read or node), f"for the angle about z, write {instead}"
        )

    def _turn(self, node: ast.AST, place: str, value: ast.expr, known: Quantity) -> Finding:
        """Return what is said of an angle that is put into a component of a quaternion."""
        text = ast.unparse(value)
        cause = f"{place} is a component of a quaternion, but {text}, which is put into it, is an angle."
        angle = self._call("radians", value) if known.unit == DEGREE else text
        half = f"{self._math('sin')}({angle} / 2) and w = {self._math('cos')}({angle} / 2)"
        fix = f"for a turn about z, write z = {half}, and leave x and y 0; for other turns, compute all four from the angles"
        return self._finding(node, cause, fix)

    def _shown(self, values: list[ast.expr]) -> Iterator[Finding]:
        """Yield a fraction that a text shows as per cent."""
        for one, after in zip(values, values[1:], strict=False):
            match one, after:
                case ast.FormattedValue(value=value, format_spec=spec), ast.Constant(value=str() as text):
                    known = self.quantities.of(self.scope, value)
                    is_scaled = spec is not None and ast.unparse(spec).endswith("%'")
                    if (
                        known
                        and known.kind == SHARE
                        and known.unit == 1.0
                        and not is_scaled
                        and text.lstrip().startswith("%")
                        and self.quantities.is_kept(known)
                    ):
                        shown = ast.unparse(value)
                        cause = f"{shown} is {_said(known)}, but this text shows it as per cent."
                        yield self._finding(value, cause, f"write {{{shown} * 100:.0f}} there")

    def _too_short(self, call: ast.Call) -> Iterator[Finding]:
        """Yield Durations of so few nanoseconds that no node could keep to them."""
        if not (self.scope.source.resolve(call.func) or "").endswith(".Duration"):
            return
        given = {keyword.arg: keyword.value for keyword in call.keywords}
        value = self.quantities.number(self.scope, given.get("nanoseconds"))
        if len(given) == 1 and value and 1 < value < _TOO_SHORT / 1e-9:  # 1 is the shortest possible
            cause = f"{ast.unparse(call)} lasts only {value:g} nanoseconds, which is over before anything can happen."
            fix = f"write Duration(seconds={value:g}), or Duration(seconds={value / 1000:g}) if milliseconds are meant"
            yield self._finding(call, cause, fix)

    def _finding(self, node: ast.AST, cause: str, fix: str) -> Finding:
        return Finding("unit-mixed", cause, self.scope.source.at(node), fix)

    def _call(self, function: str, value: ast.expr) -> str:
        """Return a call of a function of math as it is written in the file; of its inverse, what that takes."""
        inverse = {"radians": "degrees", "degrees": "radians"}.get(function, "")
        if isinstance(value, ast.Call) and last_name(value.func) == inverse and len(value.args) == 1:
            return ast.unparse(value.args[0])
        return f"{self._math(function)}({ast.unparse(value)})"

    def _math(self, function: str) -> str:
        """Return the name of a function of math in the file."""
        imports = self.scope.source.imports
        is_bare = any((i.target, i.local) == (f"math.{function}", function) for i in imports)
        return function if is_bare else f"math.{function}"


def _said(known: Quantity) -> str:
    """Return what a quantity is in words."""
    if known.kind == ANGLE:
        return f"in {known.name}, and within {known.bound / known.unit:.3g}"
    return (
        f"a {known.kind}, within -1 and 1" if known.kind not in (SHARE,) else f"a {known.kind}, from 0 to 1"
    )


def _line(node: ast.AST) -> str:
    return ast.unparse(node)


def _in_parentheses(text: str) -> str:
    return text if text.replace(".", "").replace("_", "").isalnum() else f"({text})"
