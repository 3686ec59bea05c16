"""Elements of lists, strings, dictionaries or messages that do not exist where they are read or set."""

from __future__ import annotations

import ast
import re

from ros2lab.diagnose.causes.nothing_given import left_out, may_be_left
from ros2lab.diagnose.finding import these_lines
from ros2lab.diagnose.printed.spots import Spot, kind_in_words
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.kinds import kind_within
from ros2lab.diagnose.sources.python_source import assignments, given_to, last_name, own_nodes, parameters
from ros2lab.diagnose.sources.spelling import nearest


def subscripted(match: re.Match[str], spot: Spot) -> tuple[str, str]:
    """Return cause and fix for brackets after something without elements."""
    kind = match["kind"]
    fields = {
        name for home in interfaces.homes_of(kind) for name in interfaces.fields_of(f"{home}.{kind}") or ()
    }
    for node in spot.nodes:
        match node:
            case ast.Subscript(value=value, slice=ast.Constant(value=str() as name)) if name in fields:
                text = ast.unparse(value)
                cause = f"{text} is {kind_in_words(kind)}, whose fields are accessed with a dot, not with brackets."
                return cause, f"write {text}.{name} instead of {ast.unparse(node)}"
    cause = f"`{spot.text}` takes an element of {kind_in_words(kind)}, which has no elements."
    fix = "turn it into a list or a dict first"
    if fields:
        fix = "use its field that is a list or a string, such as msg.data"
    return cause, fix


def numbered(_match: re.Match[str], spot: Spot) -> tuple[str, str]:
    """Return cause and fix for an index that is no whole number, such as a name."""
    asked = key_asked(spot)
    if asked is None:
        return f"In `{spot.text}` an index is no whole number.", "write the number of the element, from 0 on"
    name, key = ast.unparse(asked.value), ast.unparse(asked.slice)
    cause = f"The elements of {name} have numbers, from 0 on, and {key} is no whole number."
    if not isinstance(asked.slice, ast.Constant):
        return (
            cause,
            f"use a whole number there, which says how many elements come before it, instead of {key}",
        )
    beside, field = _named_by(spot, asked.value)
    if beside:
        cause += f" They are in the order of {beside}."
        return cause, f"write `{name}[{beside}.index({key})]` instead of `{ast.unparse(asked)}`"
    if field:
        cause += f" Each element has its own {field}."
        found = f"next(item for item in {name} if item.{field} == {key})"
        return cause, f"write `{found}` instead of `{ast.unparse(asked)}`"
    return cause, f"print {name} just above this line, and write the number of the element instead of {key}"


def _named_by(spot: Spot, items: ast.expr) -> tuple[str, str]:
    """Return what says which element of a list is which: another list of the message, or a field of each element; else empty."""
    if not isinstance(items, ast.Attribute):
        calls = [c for c in spot.file.calls if last_name(c.func).endswith("_set_parameters_callback")]
        named = {last_name(value) for call in calls for value in given_to(call)}
        taken = [p.arg for p in parameters(spot.function)] if spot.function else []
        is_given = spot.function and spot.function.name in named and last_name(items) in taken
        return "", "name" if is_given else ""
    fields = interfaces.fields_of(kind_within(spot.file, items.value)) or {}
    item = re.sub(r"sequence<([\w/]+).*|\[.*", r"\1", fields.get(items.attr, ""))
    own = interfaces.fields_of(interfaces.field_kind(item)) or {}
    lists = [
        f for f, kind in fields.items() if re.match(r"sequence<string|string\[", kind) and f != items.attr
    ]
    if len(lists) == 1 and not any("<" in kind for kind in own.values()):
        return f"{ast.unparse(items.value)}.{lists[0]}", ""
    texts = [field for field, kind in own.items() if kind == "string"]
    return "", "name" if "name" in texts else "".join(texts[:1])


def beyond(_match: re.Match[str], spot: Spot) -> tuple[str, str]:
    """Return cause and fix for an element that is read or replaced but does not exist."""
    asked = key_asked(spot)
    if asked is None:
        cause = (
            f"`{spot.text}` asks for an element that does not exist: the list or string is shorter, or empty."
        )
        return cause, "check len(...) first; the first element has index 0"
    name, index = ast.unparse(asked.value), ast.unparse(asked.slice)
    if isinstance(asked.ctx, ast.Store):
        cause = (
            f"{name}[{index}] can only replace an existing element, but {name} does not have that many yet."
        )
        return cause, _put(spot, asked, name)
    length = _length(spot, asked.value)
    count = f", which has {length} elements, counted from 0 to {length - 1}" if length else ""
    cause = f"{name}[{index}] asks for an element past the end of {name}{count}."
    if isinstance(asked.slice, ast.Constant):
        if length and asked.slice.value == length:
            return cause, f"write {name}[{length - 1}], or {name}[-1], for the last one"
        return _too_few(spot, name, index, cause)
    same = (
        n for n in spot.file.nodes if isinstance(n, ast.Subscript) and ast.unparse(n) == ast.unparse(asked)
    )
    lines = sorted({n.lineno for n in same})
    where = f" on {these_lines(lines)}" if len(lines) > 1 else ""
    fix = f"write {name}[{index} % len({name})]{where} to start again at the first one, or check `if {index} < len({name}):` first"
    return cause, fix


def _length(spot: Spot, items: ast.expr) -> int:
    """Return how many elements a list has wherever the file, or for a message's field the workspace, fills it; 0 if not known."""
    field = (
        f".{items.attr}" if isinstance(items, ast.Attribute) and kind_within(spot.file, items.value) else ""
    )
    made = spot.assigned(ast.unparse(items)) or [
        value
        for source in (spot.workspace if field else ())
        for target, value in assignments(source.nodes)
        if ast.unparse(target).endswith(field)
    ]
    lengths = set[int]()
    for value in made:
        match value:
            case ast.List(elts=elts) | ast.Tuple(elts=elts):
                lengths.add(len(elts))
            case ast.BinOp(left=ast.List(elts=elts), op=ast.Mult(), right=ast.Constant(value=int(times))):
                lengths.add(len(elts) * times)
            case _:
                return 0
    return lengths.pop() if len(lengths) == 1 else 0


def none_left(match: re.Match[str], spot: Spot) -> tuple[str, str]:
    """Return cause and fix for a function that needs at least one value and is given none."""
    named = [call for call in spot.calls if last_name(call.func) == match["name"]]
    calls = [spot.marked] if isinstance(spot.marked, ast.Call) else named
    given = [call.args[0] if call.args else getattr(call.func, "value", call.func) for call in calls]
    if len(given) != 1:
        return f"`{spot.text}` needs at least one value, but is given none.", "check first that there is one"
    text, need = ast.unparse(given[0]), ast.unparse(calls[0].func)
    for node in ast.walk(given[0]):
        match node:
            case ast.Subscript(value=owner, slice=ast.Slice(lower=ast.Constant(value=int(lower)))) if (
                lower >= 0
            ):
                whole, part = ast.unparse(owner), ast.unparse(node)
                cause = f"`{part}` is empty, because {whole} has no more than {lower} values here, and {need} needs at least one."
                return cause, f"print len({whole}), and choose the numbers in the brackets from it"
            case ast.comprehension(iter=values, ifs=[condition, *_]):
                cause = f"`{ast.unparse(condition)}` holds for none of {ast.unparse(values)}, and {need} needs at least one value."
                return cause, "keep the values in a list first, and check with if that it is not empty"
    return (
        f"{text} is empty here, and {need} needs at least one value.",
        f"check first that {text} is not empty",
    )


def key_asked(spot: Spot, key: str = "") -> ast.Subscript | None:
    """Return the element that a line asks for, by its key as Python writes it; None if it is unclear which is meant."""
    asked = [n for n in spot.nodes if isinstance(n, ast.Subscript) and not isinstance(n.slice, ast.Slice)]
    named = [n for n in asked if ast.unparse(n.slice) == key]
    marked = [spot.marked] if isinstance(spot.marked, ast.Subscript) else []
    found = named or marked or asked
    return found[0] if len({ast.unparse(element) for element in found}) == 1 else None


def _too_few(spot: Spot, name: str, index: str, cause: str) -> tuple[str, str]:
    """Return cause and fix for a fixed index into a list that is too short, such as a split string."""
    made = [call for call in spot.assigned(name) if isinstance(call, ast.Call)]
    split = next((call for call in reversed(made) if getattr(call.func, "attr", "") == "split"), None)
    if split is None:
        fix = f"print {name} on the line above, and make sure it has an element {index} whenever this runs"
        return cause, fix
    text = ast.unparse(split.func).removesuffix(".split")
    sign = ast.unparse(split.args[0]) if split.args else "a space"
    cause = f"`{ast.unparse(split)}` gave fewer parts than {name}[{index}] needs: {sign} does not occur that often in the string."
    fix = f"print {text} above line {split.lineno}, and write the actual separator there instead of {sign}"
    return cause, fix


def no_key(match: re.Match[str], spot: Spot) -> tuple[str, str]:
    """Return cause and fix for a key that a dictionary does not have."""
    asked = key_asked(spot, match["name"])
    if asked is None:
        cause = f"The dictionary in `{spot.text}` has no key {match['name']}."
        fix = "check first with `if ... in` whether the key is there, and compare the keys, including upper and lower case"
        return cause, fix
    name, key = ast.unparse(asked.value), ast.unparse(asked.slice)
    dicts = [value for value in spot.assigned(name) if isinstance(value, ast.Dict)]
    keys = [ast.unparse(known) for made in dicts for known in made.keys if known]
    near = nearest(match["name"], keys)
    cause = f"The dictionary {name} has no key {match['name']}{f', but has {near}' if near else ''}."
    if not isinstance(asked.slice, ast.Constant):
        if may_be_left(spot):
            return cause, left_out(f"{key} not in {name}", f"{key} in {name}", key, spot)
        fix = f"write {name}.get({key}, ...) instead of {name}[{key}], with a default for missing keys"
        return cause, fix
    if near:
        return cause, f"write {near} instead of {key}"
    if keys:
        more = f"; or add {key}: ... to the dictionary on line {dicts[0].lineno}"
        return f"{cause} It has {', '.join(keys)}.", f"use one of these instead of {key}{more}"
    fix = f"print {name} on the line above, and use one of the keys it shows instead of {key}"
    return cause, fix


def _put(spot: Spot, element: ast.Subscript, name: str) -> str:
    """Return how to fill a list whose elements are assigned one by one, in a loop or on separate lines."""
    nodes = [*own_nodes(spot.function)] if spot.function else spot.nodes
    values: dict[str, str] = {}
    for node in nodes:
        match node:
            case ast.Assign(targets=[ast.Subscript(value=owner, slice=index), *_], value=given):
                values |= {ast.unparse(index): ast.unparse(given)} if ast.unparse(owner) == name else {}
    if any(isinstance(n, (ast.For, ast.While)) and element in ast.walk(n) for n in nodes):
        value = values[ast.unparse(element.slice)]
        return f"write `{name}.append({value})` instead of `{ast.unparse(element)} = {value}`"
    whole = ", ".join(value for _, value in sorted(values.items()))
    return f"write `{name} = [{whole}]`, with all its elements, instead of {name}[...] = ..."
