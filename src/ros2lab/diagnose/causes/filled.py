"""Values put into a message, dictionary or list that fail only where they are taken out and used."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.causes.origins import kind_of_call
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.message_faults import set_field
from ros2lab.diagnose.printed.spots import Spot, kind_in_words
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.interfaces import field_kind
from ros2lab.diagnose.sources.kinds import Kinds, Scope
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource, assignments
from ros2lab.diagnose.sources.spelling import with_article


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
