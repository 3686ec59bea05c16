"""Quantities that are taken for what they are not: other units, a part for the whole, or a component for an angle."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from ros2lab.diagnose.code.time_parts import part_faults, whole_seconds
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.commented_out import comments_in
from ros2lab.diagnose.sources.kinds import CLASS, Scope
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource, assignments, last_name
from ros2lab.diagnose.sources.quantities import (
    ANGLE,
    COMPONENT,
    DEGREE,
    HALF,
    RATE,
    SHARE,
    TAKEN,
    TIME,
    Quantities,
    Quantity,
    field_of,
    makes_angle,
    named,
)
from ros2lab.diagnose.sources.signatures import signature_of
from ros2lab.diagnose.sources.syntax_parts import by_parameter, own_parameters

_TOO_LONG = 1000  # s
# No node waits for anything as short as this (s): DDS alone takes longer.
_TOO_SHORT = 1e-5
_WORDS = re.compile(
    r"nano|_ns\(|orientation|rotation|[qQ]uat|sin|cos|tan|degrees|radians|2deg|2rad|angle_|theta|yaw|percentage|axes|ColorRGBA|itude|\.sec\b|_ms\b"
)
_TURNED = re.compile(r"\b(radians|degrees|deg2rad|rad2deg)$")
_ORDERS = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)


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
                for side, other in ((left, right), (right, left)) if isinstance(op, _ORDERS) else ():
                    yield from self._never(node, side, other)
            case ast.BinOp(left=left, op=ast.Add() | ast.Sub(), right=right):
                yield from self._meeting(node, left, right)
            case ast.BinOp(left=left, op=ast.Mult() | ast.Div() as op, right=right):
                yield from whole_seconds(self.quantities, self.scope, node, right, left)
                if isinstance(op, ast.Mult):
                    yield from whole_seconds(self.quantities, self.scope, node, left, right)
            case ast.Assign() | ast.AnnAssign():
                for target, value in assignments([node]):
                    yield from self._put(node, target, value)
            case ast.AugAssign(op=ast.Add() | ast.Sub(), target=target, value=value):
                wanted, known = (
                    self.quantities.field(self.scope, target),
                    self.quantities.of(self.scope, value),
                )
                is_angle = known.kind == ANGLE if known else self.quantities.number(self.scope, value)
                if wanted and wanted.kind == COMPONENT and is_angle:
                    yield added(self.scope.source, node)
            case ast.Call():
                yield from self._too_short(node)
                yield from self.given(node)
            case ast.JoinedStr(values=values):
                yield from self._shown(values)

    def given(self, call: ast.Call) -> Iterator[Finding]:
        """Yield what a call gives as something else to a function, a message or a function of the workspace."""
        if (wanted := TAKEN.get(self.quantities.function(self.scope, call))) and len(call.args) == 1:
            yield from self._taken(call, call.args[0], wanted)
        kind = (self.scope.kind(call.func) or "").removeprefix(CLASS)
        for keyword in call.keywords:
            if wanted := field_of(kind, keyword.arg):
                place = f"{keyword.arg} of this {kind.rpartition('.')[2]}"
                yield from self._written(call, place, keyword.value, wanted)
        own = self.quantities.own(self.scope, call)
        if own and own.function:
            for name, value in by_parameter(call, [p.arg for p in own_parameters(own.function)]).items():
                if wanted := named(name):
                    yield from self._named(call, name, value, wanted, own.source)

    def _taken(self, call: ast.Call, value: ast.expr, wanted: Quantity) -> Iterator[Finding]:
        number = self.quantities.number(self.scope, value) if isinstance(value, ast.Constant) else None
        if known := self.quantities.of(self.scope, value):
            yield from self._clash(call, value, known, f"what {ast.unparse(call.func)}() takes", wanted)
        elif number and number % 15 == 0 and wanted == Quantity(ANGLE):
            cause = f"{ast.unparse(call.func)}() takes radians, and {number:g} radians are {number / 2 / math.pi:.1f} turns."
            yield self._finding(value, cause, self._in_radians(value))

    def _meeting(self, node: ast.Compare | ast.BinOp, left: ast.expr, right: ast.expr) -> Iterator[Finding]:
        """Yield two sides that are no quantities of one kind and unit."""
        first, second = (self.quantities.of(self.scope, side) for side in (left, right))
        if first and second:
            # The finer one is converted.
            if first.unit > second.unit and first.kind == second.kind:
                left, right, first, second = right, left, second, first
            yield from self._clash(node, left, first, ast.unparse(right), second)
            is_whole = isinstance(node, ast.Compare) and not isinstance(node.ops[0], _ORDERS)
            yield from () if is_whole else part_faults(self.quantities, self.scope, node, (left, right))
        for side, other, known, its in ((left, right, first, second), (right, left, second, first)):
            value = self.quantities.number(self.scope, other) if its is None else None
            if known and known.kind == TIME and value and abs(value) * known.unit < _TOO_SHORT:
                yield from self._clash(
                    node, side, known, f"{ast.unparse(other)}, as it seems,", Quantity(TIME)
                )

    def _never(self, node: ast.expr, side: ast.expr, other: ast.expr) -> Iterator[Finding]:
        """Yield a comparison with a number that a quantity never reaches."""
        known, number = self.quantities.of(self.scope, side), self.quantities.number(self.scope, other)
        if known is None or number is None or self.quantities.of(self.scope, other):
            return
        # An angle within half a turn may be compared with a whole one.
        most = max(known.bound, 2 * math.pi) if known.kind == ANGLE else known.bound
        if not known.unit or abs(number) * known.unit <= most * 1.01 or not self.quantities.is_kept(known):
            return
        text, against = ast.unparse(side), ast.unparse(other)
        if known.kind == COMPONENT:
            yield read_as_angle(self.scope, node, known, f"so `{ast.unparse(node)}` never changes")
            return
        fix = f"write a number up to {known.bound / known.unit:g} instead of {against}"
        if known.kind == SHARE:
            fix = f"write {number / _most_of(text):.3g} instead of {against}"
        elif known.unit == 1.0 and known.kind == ANGLE:
            fix = self._in_radians(other)
        yield self._finding(
            node, f"{text} is {known.said}: with such values, `{ast.unparse(node)}` never changes.", fix
        )

    def _put(self, node: ast.AST, target: ast.expr, value: ast.expr) -> Iterator[Finding]:
        """Yield what is assigned to a field or to a name that means something else."""
        if wanted := self.quantities.field(self.scope, target):
            yield from self._written(node, ast.unparse(target), value, wanted)
        elif wanted := named(target):
            known, held = self.quantities.of(self.scope, value), self.quantities.of(self.scope, target)
            if known and held and held.is_like(known):
                yield from self._named(node, ast.unparse(target), value, wanted, self.scope.source)

    def _named(
        self, node: ast.AST, name: str, value: ast.expr, wanted: Quantity, home: PythonSource
    ) -> Iterator[Finding]:
        known = self.quantities.of(self.scope, value)
        if known is None or _is_passed_on(name, home):
            return
        if known.kind == HALF and wanted.kind == ANGLE:
            text = ast.unparse(value)
            cause = f"{text} is half of the angle: a component of a quaternion is the sine or cosine of that half."
            yield self._finding(node, cause, f"write 2 * {text} instead of {text}")
        else:
            yield from self._clash(node, value, known, name, wanted)

    def _written(self, node: ast.AST, place: str, value: ast.expr, wanted: Quantity) -> Iterator[Finding]:
        """Yield what is put into a field that holds another quantity, or never so much."""
        known, number = self.quantities.of(self.scope, value), self.quantities.number(self.scope, value)
        if known is not None:
            yield from self._clash(node, value, known, place, wanted)
        elif number is not None and abs(number) * wanted.unit > wanted.bound * 1.01:
            text = ast.unparse(value)
            fix = f"write a number up to {wanted.bound / wanted.unit:g} instead of {text}"
            if wanted.kind == COMPONENT:
                angle = Quantity(ANGLE, 1.0 if abs(number) <= 2 * math.pi else DEGREE)
                yield angle_put(self.scope.source, node, place, value, angle)
                return
            if wanted.kind == SHARE:
                fix = f"write {number / _most_of(place):.3g} instead of {text}"
            elif wanted.kind == ANGLE and wanted.unit == 1.0:
                fix = self._in_radians(value)
            yield self._finding(node, f"{place} is {wanted.said}, so it is never as much as {text}.", fix)

    def _clash(
        self, node: ast.AST, value: ast.expr, known: Quantity, place: str, wanted: Quantity
    ) -> Iterator[Finding]:
        """Yield a value that is no quantity of the kind and unit of a place."""
        kinds = {known.kind, wanted.kind}
        is_other = known.name and wanted.name and known.name.split()[0] != wanted.name.split()[0]
        if kinds == {COMPONENT, ANGLE}:
            if known.kind == ANGLE and isinstance(node, (ast.Assign, ast.Call)):
                yield angle_put(self.scope.source, node, place, value, known)
            else:
                component = known if known.kind == COMPONENT else wanted
                why = f"but `{ast.unparse(node)}` takes it for an angle"
                yield read_as_angle(self.scope, node, component, why)
        elif is_other and (len(kinds) == 1 or (kinds == {ANGLE, RATE} and known.unit == DEGREE)):
            text, whole = ast.unparse(value), ast.unparse(node)
            cause = f"{text} is in {known.name}, but {place} is in {wanted.name}, so `{whole}` mixes units."
            if known.kind == TIME:
                power = round(math.log10(wanted.unit / known.unit))
                inner = text if text.replace(".", "").replace("_", "").isalnum() else f"({text})"
                fix = f"write {inner} {'/' if power > 0 else '*'} 1e{abs(power)} instead of {text}"
            elif isinstance(node, ast.Call) and _TURNED.search(ast.unparse(node.func)):
                cause = f"{text} is in {known.name} already, and `{whole}` converts it once more."
                fix = f"write {text} instead of {whole}"
            else:
                to = (
                    "degrees"
                    if wanted.unit == DEGREE and not isinstance(node, ast.Compare | ast.BinOp)
                    else "radians"
                )
                fix = f"write {called(self.scope.source, to, value)} instead of {text}"
            yield self._finding(node, cause, fix)

    def _shown(self, values: list[ast.expr]) -> Iterator[Finding]:
        """Yield a fraction that a text shows as per cent."""
        for one, after in pairwise(values):
            match one, after:
                case ast.FormattedValue(value=value, format_spec=spec), ast.Constant(value=str() as text):
                    known = self.quantities.of(self.scope, value)
                    is_scaled = (spec and ast.unparse(spec).endswith("%'")) or not text.lstrip().startswith(
                        "%"
                    )
                    if (
                        known
                        and known.kind == SHARE
                        and known.unit == 1.0
                        and not is_scaled
                        and self.quantities.is_kept(known)
                    ):
                        shown = ast.unparse(value)
                        cause = f"{shown} is {known.said}, but this text shows it as per cent."
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

    def _in_radians(self, value: ast.expr) -> str:
        source = self.scope.source
        return f"write {called(source, 'radians', value)} instead of {ast.unparse(value)}{also(source)}"

    def _finding(self, node: ast.AST, cause: str, fix: str) -> Finding:
        return Finding("unit-mixed", cause, self.scope.source.at(node), fix)


def _most_of(place: str) -> int:
    """Return what the whole is where someone does not write it as 1: 100 per cent, or the 255 of a color."""
    return 100 if "percentage" in place else 255


def _is_passed_on(name: str, home: PythonSource) -> bool:
    """Return whether a file makes an angle of what a name holds, or puts it into a quaternion again."""
    for node in home.nodes:
        given: list[ast.expr] = []
        match node:
            case ast.Call(args=args, keywords=keywords) if makes_angle(home.resolve(node.func)):
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
