"""Values in a message, a dictionary or a list that its field refuses, or that fail where they are taken out."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.causes.origins import kind_of_call
from ros2lab.diagnose.causes.wrong_literals import of_wrong_literal
from ros2lab.diagnose.checking.trials import type_of
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.message_faults import set_field
from ros2lab.diagnose.printed.spots import Spot, kind_in_words
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.calls import fitting
from ros2lab.diagnose.sources.interfaces import field_kind
from ros2lab.diagnose.sources.kinds import Kinds, Scope
from ros2lab.diagnose.sources.known_values import declaring
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.own_functions import held_once
from ros2lab.diagnose.sources.python_source import PythonSource, assigned_to, assignments, last_name, walk
from ros2lab.diagnose.sources.spelling import with_article
from ros2lab.diagnose.sources.syntax_parts import calls_in

_SAYS = re.compile(r"The '(?P<field>\w+)' field must be (?P<what>.+)")
_RANGE = re.compile(r"an (?:unsigned )?integer in \[(?P<least>-?\d+), ?(?P<most>\d+)\]")


def of_refused(message: str, spot: Spot, look: Look) -> Finding | None:
    """Return a finding about the value that a field refuses; None if it is not clear which value that is."""
    said = _SAYS.search(message)
    if said is None:
        return None
    given = [value for name, value in _given(spot) if name == said["field"]]
    if literal := of_wrong_literal(message, spot, given, look):
        return literal
    if len({ast.unparse(value) for value in given}) != 1:
        return None
    return of_list(said["field"], said["what"], given[0], spot) or _of_number(spot, given[0], said)


def _of_number(spot: Spot, value: ast.expr, said: re.Match[str]) -> Finding | None:
    """Return a finding about a number that is outside the range of a field, or no float; None for any other."""
    if outside := _RANGE.match(said["what"]):
        return _outside(spot.file, value, said["field"], outside)
    if said["what"].startswith("of type 'float'"):
        return _no_float(spot.file, value, said["field"], spot.line)
    return None


def _given(spot: Spot) -> Iterator[tuple[str, ast.expr]]:
    """Yield the fields that the marked part of a line, or else the line, sets, each with its value."""
    marked = spot.marked
    for node in walk(marked) if isinstance(marked, ast.Call) else spot.nodes:
        match node:
            case ast.Call(keywords=keywords):
                yield from ((keyword.arg, keyword.value) for keyword in keywords if keyword.arg)
            case ast.Assign(targets=[ast.Attribute(attr=name)], value=value):
                yield name, value
            case ast.Assign(targets=[ast.Tuple(elts=targets)], value=ast.Tuple(elts=values)):
                pairs = zip(targets, values, strict=False)
                yield from (
                    (target.attr, value) for target, value in pairs if isinstance(target, ast.Attribute)
                )


def _outside(source: PythonSource, value: ast.expr, field: str, said: re.Match[str]) -> Finding:
    least, most = int(said["least"]), int(said["most"])
    text = ast.unparse(value)
    side, by = _counted(source, text)
    by_count = f": line {by} counts it {'up' if side == 'above' else 'down'}" if by else ""
    cause = f"The field {field} holds whole numbers from {least} to {most}, but `{text}` is outside that range here{by_count}."
    made = (source.resolve(node.func) or "" for node in source.calls)
    sent = next((name for name in made if _range_of(name, field) == (least, most)), "")
    larger = _larger(sent, field, least - (side != "above"), most + (side != "below"))
    keep = f"keep it in that range, for example with min(max({text}, {least}), {most})"
    fix = keep
    if by:
        last = most if side == "above" else least
        fix = keep = (
            f"let line {by} run only while {text} is {'below' if side == 'above' else 'above'} {last}, or cancel the timer that counts"
        )
    if larger:
        fix = f"write {larger} instead of {sent.rpartition('.')[2]} everywhere, including where it is received; or {keep}"
    return Finding("field-type", cause, source.at(value), fix)


def _counted(source: PythonSource, text: str) -> tuple[str, int]:
    """Return on which side a value leaves a range, and the line that counts it that way; 0 if it may be either."""
    changes = [n for n in source.nodes if isinstance(n, ast.AugAssign) and ast.unparse(n.target) == text]
    steps = {type(n.op) if ast.unparse(n.value).isdigit() else None for n in changes}
    if len(steps) == 1 and (step := steps.pop()) in (ast.Add, ast.Sub):
        return "above" if step is ast.Add else "below", changes[0].lineno
    return "", 0


def _range_of(name: str, field: str) -> tuple[int, int] | None:
    """Return the least and greatest number that a field can hold; None if it holds no whole numbers."""
    kind = (interfaces.fields_of(name) or {}).get(field, "")
    match = re.fullmatch(r"(?P<sign>u?)int(?P<bits>\d+)", {"byte": "uint8", "octet": "uint8"}.get(kind, kind))
    if match is None:
        return None
    bits = int(match["bits"])
    return (0, 2**bits - 1) if match["sign"] else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def _larger(name: str, field: str, least: int, most: int) -> str:
    """Return the smallest message type with the same field that holds a range; empty if there is none."""
    module, found = name.rpartition(".")[0], []
    for candidate in interfaces.names_in(module) or ():
        there = _range_of(f"{module}.{candidate}", field)
        is_alike = [*(interfaces.fields_of(f"{module}.{candidate}") or {})] == [field]
        if is_alike and there and there[0] <= least and there[1] >= most:
            found.append(((there[0] < 0) != (least < 0), there[1], candidate))
    return min(found)[2] if found else ""


def _no_float(source: PythonSource, value: ast.expr, field: str, line: int) -> Finding:
    text = ast.unparse(value)
    declared = [*_declarations(source, value)]
    defaults = [(call, default) for call in declared for default in call.args[1:2]]
    for call, default in defaults:
        if not isinstance(default, ast.Constant) or type(default.value) is not int:
            continue
        name = _first_text(call)
        cause = f"The field {field} holds a float, but the parameter {name} is declared as {ast.unparse(default)}, an int. Line {line} fails because of this one."
        fix = f"write {ast.unparse(default)}.0 instead of {ast.unparse(default)}"
        return Finding("int-in-float", cause, source.at(default), fix)
    for empty in (call for call in declared if len(call.args) == 1 and not call.keywords):
        name = _first_text(empty)
        cause = f"The field {field} holds a float, but the parameter {name} is declared without a value, so `{text}` is None."
        fix = f"write `{ast.unparse(empty)[:-1]}, 0.0)`, or another number as its default"
        return Finding("int-in-float", cause, source.at(empty), fix)
    cause = f"The field {field} holds a float, but `{text}` is something else here: an int or a string."
    fix = f"write {text}.0" if text.lstrip("-").isdigit() else f"write float({text})"
    return Finding("int-in-float", cause, source.at(value), f"{fix} instead of {text}")


def _declarations(source: PythonSource, value: ast.expr) -> Iterator[ast.Call]:
    """Yield the calls that declare the parameter that a value comes from."""
    made = assigned_to(source.nodes, ast.unparse(value))
    calls = (call for expression in (value, *made) for call in calls_in(walk(expression)))
    yield from dict.fromkeys(declared for call in calls for declared in declaring(source, call))


def _first_text(call: ast.Call) -> str:
    first = call.args[0] if call.args else None
    return first.value if isinstance(first, ast.Constant) and isinstance(first.value, str) else "?"


_SEVERAL_SAID = re.compile(
    r"a set or sequence(?: with length (?P<most><= )?(?P<length>\d+))? and each value of type '(?P<kind>\w+)'"
)
_ZERO = {"float": "0.0"}
_LISTS = frozenset(("list", "tuple", "set", "frozenset", "array", "deque", "range"))
_GONE_THROUGH = frozenset(
    ("map", "filter", "zip", "reversed", "dict_keys", "dict_values", "Generator", "dict")
)


def of_list(field: str, what: str, value: ast.expr, spot: Spot) -> Finding | None:
    """Return a finding about a wrong value for a field that holds several; None if nothing can be said."""
    said = _SEVERAL_SAID.match(what)
    if said is None:
        return None
    kind, source = said["kind"], spot.file
    is_fixed = said["length"] is not None and not said["most"]
    count = int(said["length"]) if is_fixed else None
    written, given = _as_list(value, kind, count, source)
    text = ast.unparse(value)
    if not written or ast.unparse(ast.parse(written, mode="eval")) in (text, f"[one for one in {text}]"):
        return None  # also where it would only be the same items again
    several = f"{count} values" if count else "a list"
    holds = f"The field {field} holds {several} of type {kind}"
    cause = f"{holds}, but `{ast.unparse(value)}` is {given}."
    return Finding("field-type", cause, source.at(value), _list_told(value, written, spot))


def _list_told(value: ast.expr, written: str, spot: Spot) -> str:
    """Return the fix: the whole statement if it only assigns this value, or else the value."""
    for node in spot.nodes:
        if isinstance(node, ast.Assign) and node.value is value:
            return f"write {' = '.join(map(ast.unparse, node.targets))} = {written}"
    return f"write {written} instead of {ast.unparse(value)}"


def _as_list(value: ast.expr, kind: str, count: int | None, source: PythonSource) -> tuple[str, str]:
    """Return a value as the wanted list, and what the value is in words; both empty if unknown."""
    home, made = held_once(source, value) or (source, value)
    made = made if home is source else value
    if isinstance(made, (ast.List, ast.Tuple)):
        return _of_literal(value, made, kind, count)
    name = _type_name(made, source)
    text = ast.unparse(value)
    if name in _LISTS or _is_several(made):
        return _of_several(text, kind, count)
    if name in _GONE_THROUGH:
        inner = text if name != "dict" else f"{text}.values()"
        return f"[{_made(kind, 'one')} for one in {inner}]", f"{with_article(name)}, which is not a list"
    if name == "ndarray":
        return f"{text}.tolist()", "a NumPy array of another size or type"
    if not name:
        return "", ""
    is_right = name == kind
    item = text if is_right else fitting(kind, value) or _made(kind, text)
    many = f" * {count}" if count and count > 1 else ""
    return f"[{item}]{many}", f"a single value, {kind_in_words(name)}"


def _of_several(text: str, kind: str, count: int | None) -> tuple[str, str]:
    """Return a list of unknown length converted as needed, and what is wrong with it."""
    items = f"[{_made(kind, 'one')} for one in {text}]"
    if count is None:
        return items, "a list with values of another type"
    filled = f"({items} + [{_ZERO.get(kind, '0')}] * {count})[:{count}]"
    return filled, "a list of another length, or with values of another type"


def _is_several(made: ast.expr) -> bool:
    """Return whether an expression has the form of a list: a comprehension, or a repeated list."""
    is_repeated = isinstance(made, ast.BinOp) and isinstance(made.left, ast.List)
    return is_repeated or isinstance(made, (ast.ListComp, ast.SetComp, ast.GeneratorExp))


def _of_literal(value: ast.expr, made: ast.List | ast.Tuple, kind: str, count: int | None) -> tuple[str, str]:
    """Return a list literal with values of the right type, and what was wrong with it."""
    if count is not None and len(made.elts) ** 2 == count > 1:
        row = f"for row, one in enumerate({ast.unparse(value)})"
        diagonal = f"[{_made(kind, 'one')} if row == column else {_ZERO.get(kind, '0')} {row} for column in range({len(made.elts)})]"
        return diagonal, f"a list of {len(made.elts)}: only the diagonal of {len(made.elts)} rows"
    if count is not None and len(made.elts) != count:
        more = [ast.unparse(element) for element in made.elts][:count]
        filled = ", ".join([*more, *[_ZERO.get(kind, "0")] * (count - len(more))])
        return f"[{filled}]", f"a list of {len(made.elts)}"
    right = [_item(element, kind) for element in made.elts]
    texts = map(ast.unparse, made.elts)
    wrong = [text for text, new in zip(texts, right, strict=True) if text != new]
    given = f"a list with {', '.join(wrong)} in it"
    if made is not value:
        return f"[{_made(kind, 'one')} for one in {ast.unparse(value)}]", given
    return f"[{', '.join(right)}]", given


def _item(element: ast.expr, kind: str) -> str:
    if isinstance(element, ast.Constant):
        is_right = type(element.value).__name__ == kind
        return ast.unparse(element) if is_right else fitting(kind, element) or ast.unparse(element)
    is_called = isinstance(element, ast.Call) and last_name(element.func) == kind
    is_text = isinstance(element, ast.JoinedStr) and kind == "str"
    return ast.unparse(element) if is_called or is_text else _made(kind, ast.unparse(element))


def _made(kind: str, text: str) -> str:
    """Return how to convert an expression to a plain type; unchanged for other types."""
    return f"{kind}({text})" if kind in ("float", "int", "str", "bool") else text


def _type_name(value: ast.expr, source: PythonSource) -> str:
    """Return the class name of a value; empty if it is unknown or ambiguous."""
    if isinstance(value, ast.Constant):
        return type(value.value).__name__
    if isinstance(value, ast.JoinedStr):
        return "str"
    kind = type_of(source, value)
    if re.match(r"Literal\b", kind):
        return "str" if re.search(r"['\"]", kind) else "int"
    return "" if re.search(r"Unknown|Any\b| \| |None", kind) else re.sub(r"\[.*", "", kind).rpartition(".")[2]


def of_filled(message: str, spot: Spot) -> Finding | None:
    """Return which field of a message on a line with publish() was given another type; None if none is seen."""
    said = re.search(r"'(?P<kind>\w+)' object has no attribute '(?P<name>\w+)'", message)
    if said is None or spot.function is None:
        return None
    wrong = [
        field for field in _fields_filled(spot) if said["name"] in (interfaces.fields_of(field[1]) or {})
    ]
    if not wrong:
        return _of_appended(said["kind"], said["name"], spot)
    texts = []
    libraries = [home for home in interfaces.homes_of(said["kind"]) if not home.endswith(".msg")]
    for target, wanted, value in wrong:
        if any("to_msg" in interfaces.members_of(home, said["kind"]) for home in libraries):
            texts.append(f"write {ast.unparse(target)} = {ast.unparse(value)}.to_msg()")
        else:
            texts.append(set_field(target, wanted, value))
    target, wanted, value = wrong[0]
    name = wanted.rpartition(".")[2]
    given = f"{with_article(name)} of rclpy" if said["kind"] == name else kind_in_words(said["kind"])
    cause = f"{ast.unparse(target)} holds the message type {name}, but `{ast.unparse(value)}` is {given}; Python notices only in publish()."
    more = [f"on line {field[0].lineno} {text}" for field, text in zip(wrong[1:], texts[1:], strict=True)]
    return Finding("field-type", cause, spot.file.at(target), "; ".join([texts[0], *more]))


def _fields_filled(spot: Spot) -> Iterator[tuple[ast.Attribute, str, ast.expr]]:
    """Yield the published message's fields of a message type that are given another: target, type, value."""
    sent = tuple(f"{path}." for path in published(spot))
    sources = NodeSources({spot.file.name: spot.file})
    kinds = Kinds(sources)
    for owner, function, node in sources.scoped(spot.file):
        scope = Scope(kinds, spot.file, owner, function)
        for target, value in assignments([node]) if function is spot.function else ():
            if isinstance(target, ast.Attribute) and ast.unparse(target).startswith(sent):
                wanted = field_kind((interfaces.fields_of(scope.kind(target.value)) or {}).get(target.attr))
                if wanted and interfaces.fields_of(wanted) and scope.kind(value) != wanted:
                    yield target, wanted, value


def _of_appended(kind: str, name: str, spot: Spot) -> Finding | None:
    """Return which item of a list in a published message has another type than the list; None if none is seen."""
    sources = NodeSources({spot.file.name: spot.file})
    kinds, sent = Kinds(sources), published(spot)
    for owner, function, node in sources.scoped(spot.file):
        match node:
            case ast.Call(func=ast.Attribute(attr="append", value=ast.Attribute() as items), args=[value]):
                scope = Scope(kinds, spot.file, owner, function)
            case _:
                continue
        path = ast.unparse(items.value)
        if not any(f"{path}.".startswith(f"{each}.") for each in sent) or not (
            function is spot.function or path.startswith("self.")
        ):
            continue
        field = (interfaces.fields_of(scope.kind(items.value)) or {}).get(items.attr, "")
        wanted, given = field_kind(re.sub(r"^sequence<([^,>]+).*", r"\1", field)), scope.kind(value)
        is_it = given and wanted and given != wanted and given.rpartition(".")[2] == kind
        if is_it and name in (interfaces.fields_of(wanted) or {}):
            return _with_item(spot.file, node, items, value, (str(wanted), str(given)))
    return None


def published(spot: Spot) -> list[str]:
    """Return what a line publishes, as it is written."""
    calls = [call for call in spot.calls if getattr(call.func, "attr", "") == "publish"]
    return [ast.unparse(call.args[0]) for call in calls if call.args]


def _with_item(
    source: PythonSource, call: ast.Call, items: ast.Attribute, value: ast.expr, types: tuple[str, str]
) -> Finding:
    """Say what a list holds, and how the value that was put into it becomes an item, or comes out of the value."""
    (wanted, given), shown = types, ast.unparse(value)
    name, other = (kind.rpartition(".")[2] for kind in types)
    around = [key for key, kind in (interfaces.fields_of(wanted) or {}).items() if field_kind(kind) == given]
    within = [key for key, kind in (interfaces.fields_of(given) or {}).items() if field_kind(kind) == wanted]
    home = f"`from {wanted.rpartition('.')[0]} import {name}` at the top"
    is_known = any(imported.target == wanted and imported.local == name for imported in source.imports)
    fix = f"make {with_article(name)} for each item of {ast.unparse(items)}, and append that"
    if len(within) == 1:
        fix = f"write {ast.unparse(items)}.append({shown}.{within[0]})"
    elif len(around) == 1:
        fix = f"write {ast.unparse(items)}.append({name}({around[0]}={shown}))"
        fix += "" if is_known else f", with {home}"
    cause = f"{ast.unparse(items)} holds messages of type {name}, but `{shown}` is {with_article(other)}; Python notices only in publish()."
    return Finding("field-type", cause, source.at(call), fix)


def of_item(message: str, spot: Spot) -> Finding | None:
    """Return which functions a dictionary or list calls instead of storing them; None if there are none."""
    if "'NoneType' object is not callable" not in message:
        return None
    items = (call.func for call in spot.calls if isinstance(call.func, ast.Subscript))
    held = [ast.unparse(item.value) for item in items]
    for node in spot.file.nodes:
        match node:
            case ast.Assign(targets=[target], value=ast.Dict(values=values) | ast.List(elts=values)) if (
                ast.unparse(target) in held
            ):
                calls = (item for item in values if isinstance(item, ast.Call))
                called = [call for call in calls if kind_of_call(spot.file, call) == "NoneType"]
                if called:
                    texts = [f"{ast.unparse(call.func)} instead of {ast.unparse(call)}" for call in called]
                    first = ast.unparse(called[0])
                    cause = f"`{first}` calls the function right here and stores its return value, None, in {ast.unparse(target)}."
                    return Finding(
                        "callback-called", cause, spot.file.at(called[0]), f"write {', '.join(texts)}"
                    )
    return None
