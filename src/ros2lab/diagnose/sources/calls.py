"""A call of a library's function as it was meant, made from the function's own parameters."""

from __future__ import annotations

import ast
import contextlib
import itertools
import re
import shlex
from collections.abc import Callable, Collection, Iterator, Sequence

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.signatures import (
    ANYTHING,
    LIST_OF,
    LISTS,
    TAKES,
    Parameter,
    Signature,
    fields_as_parameters,
    heads_of,
    kind_of,
    message_of,
    signature_by_name,
    signature_of,
)
from ros2lab.diagnose.sources.spelling import nearest

_LONGEST = 110  # letters of a call that is shown as a whole


def call_faults(
    source: PythonSource,
    lines: Collection[int],
    said: str = "",
    stands_trial: Callable[[PythonSource, ast.Call, str], bool] | None = None,
) -> Iterator[Finding]:
    """Yield the calls of library functions on some lines that are given what they do not take, or lack what is asked for.

    It is asked only of lines at which a library has failed: what a library takes besides is not always written.

    Args:
        source: the file.
        lines: where it failed.
        said: what the library says, which may name a parameter.
        stands_trial: whether a call may be written as it is proposed; None tries nothing.
    """
    for node in source.nodes:
        if not isinstance(node, ast.Call) or set(lines).isdisjoint(
            range(node.lineno, (node.end_lineno or 0) + 1)
        ):
            continue
        right, wrong, fix, whole = _meant(source, node)
        if fix and stands_trial and not stands_trial(source, node, whole):
            fix = ""
        signature, given = signature_of(source, node), {keyword.arg for keyword in node.keywords}
        words = set(re.findall(r"[a-z_]+", said.lower()))
        needs_all = signature is not None and not interfaces.is_interface(
            source.resolve(node.func)
        )  # a message needs no field
        asked = (
            [one for one in signature.parameters if one.name in words - given]
            if signature and needs_all
            else []
        )
        asked = [one for one in asked if not one.is_positional and example_of(one) != one.name]
        if fix:
            what = (
                f"does not accept {', '.join(wrong)[:_LONGEST]} as written"
                if wrong
                else f"is missing {', '.join(right)}"
            )
            yield Finding("argument-type", f"{ast.unparse(node.func)} {what}.", source.at(node), fix)
        elif asked:
            texts = [
                *map(ast.unparse, node.args),
                *_texts(node.keywords),
                f"{asked[0].name}={example_of(asked[0])}",
            ]
            cause = f"{ast.unparse(node.func)} needs the argument {asked[0].name}, which is not given."
            yield Finding(
                "argument-missing",
                cause,
                source.at(node),
                f"write `{ast.unparse(node.func)}({', '.join(texts)})`",
            )


def meant_call(source: PythonSource, call: ast.Call) -> str:
    """Return what to write for a call to be as it was meant: each value where it fits, what is missing added.

    It is empty where the call is so already, or where that is not known.
    """
    return _meant(source, call)[2]


def whole_call(source: PythonSource, call: ast.Call) -> str:
    """Return a call as a whole as it was meant, in which `meant_call` tells what is to be changed."""
    return _meant(source, call)[3]


def _meant(source: PythonSource, call: ast.Call) -> tuple[list[str], list[str], str, str]:
    """Return what a call should be given and is not, what it should not be given, what to write, and the whole call."""
    signature = signature_of(source, call)
    if signature is None or any(isinstance(one, ast.Starred) for one in call.args):
        return [], [], "", ""
    name, message = ast.unparse(call.func), source.resolve(call.func) or ""
    old = [*map(ast.unparse, call.args), *_texts(call.keywords)]
    if interfaces.fields_of(message) and call.args:
        whole = filled(message, ast.Tuple(list(call.args)))
        return [], old, f"write `{whole}`", whole
    new = _arranged(signature, call)
    whole = f"{name}({', '.join(new)})"
    right, wrong = [one for one in new if one not in old], [one for one in old if one not in new]
    if new == old:
        fix = ""
    elif len(whole) <= _LONGEST:
        fix = f"write `{whole}`"
    elif new[0].startswith("[") and call.args:
        fix = f"write {name}([ ... ]), with all its arguments as one list in brackets"
    elif len(new) > len(old) and new[-len(old) :] == old:
        fix = f"write `{', '.join(right)}` before the other arguments"
    elif right and wrong:
        fix = f"write `{', '.join(right)}` instead of `{', '.join(wrong)[:_LONGEST]}`"
    else:
        fix = f"add `{', '.join(right)}` inside its parentheses" if right else f"remove `{', '.join(wrong)}`"
    return right, wrong, fix, whole


def _arranged(signature: Signature, call: ast.Call) -> list[str]:
    """Return what stands between the parentheses of a call that is as it was meant."""
    places = [one for one in signature.parameters if one.is_positional]
    if _lacks_brackets(places, call.args):
        return [f"[{', '.join(map(ast.unparse, call.args))}]", *_texts(call.keywords)]
    slid = _with_gaps(places, list(call.args), {keyword.arg for keyword in call.keywords})
    given, rest = _placed(places, slid or _with_functions_in_place(places, list(call.args)))
    named = dict(_named(signature, call, given, rest))
    values_of = {**given, **named}
    required = (one for one in signature.parameters if not one.default)
    lacking = {one.name: example_of(one) for one in required if one.name not in values_of}
    by_name = () if rest else {keyword.arg for keyword in call.keywords}
    placed = []
    for name in (one.name for one in places):
        if name in by_name or name not in {*values_of, *lacking}:
            break
        placed.append(values_of.pop(name) if name in values_of else lacking.pop(name))
    return [*placed, *(f"{name}={value}" for name, value in {**values_of, **lacking}.items())]


_GAP = ast.Constant(...)  # stands where a value was left out


def _placed(places: list[Parameter], values: list[ast.expr]) -> tuple[dict[str, str], list[ast.expr]]:
    """Return the values that fit where they stand, by the names of their places, and the others."""
    given: dict[str, str] = {}
    rest: list[ast.expr] = []
    if len(values) > len(places):
        # One that is too much may stand before the others.
        cut = max(range(len(values), -1, -1), key=lambda n: _fit(places, [*values[:n], *values[n + 1 :]]))
        rest += values[cut : cut + 1]
        values = [*values[:cut], *values[cut + 1 :]]
    for place, value in itertools.zip_longest(places, values, fillvalue=None):
        if not isinstance(value, ast.expr) or value is _GAP:
            continue
        if isinstance(place, Parameter) and place.takes(value):
            given[place.name] = ast.unparse(value)
        elif isinstance(place, Parameter) and not place.default and (new := fitting(place.type, value)):
            given[place.name] = new
        else:
            rest.append(value)
    return given, rest


def _with_gaps(places: list[Parameter], values: list[ast.expr], named: set[str | None]) -> list[ast.expr]:
    """Return values in their places where one of those that must be given was left out, and the others have slid.

    It is empty where no value stands in a place that does not take it, and where other places take no more of them.
    """
    needed = [one for one in places if not one.default and one.name not in named]
    if not 0 < len(values) < len(needed) or _misfits(needed, values) == 0:
        return []
    ways = []
    for numbers in itertools.combinations(range(len(needed)), len(values)):
        there = dict(zip(numbers, values, strict=True))
        ways.append([there.get(n, _GAP) for n in range(numbers[-1] + 1)])
    best = min(ways, key=lambda way: (_misfits(needed, way), -_fit(needed, way)))
    return best if _misfits(needed, best) == 0 else []


def _misfits(places: list[Parameter], values: list[ast.expr]) -> int:
    """Return how many values stand where they are not taken: a function, too, where a text belongs."""
    pairs = [pair for pair in zip(places, values, strict=False) if pair[1] is not _GAP]
    return sum(1 for place, value in pairs if not place.takes(value) or _is_method_for_text(place, value))


def _is_method_for_text(place: Parameter, value: ast.expr) -> bool:
    return getattr(value, "is_function", False) is True and heads_of(place.type) == {"str"}


def _lacks_brackets(places: list[Parameter], given: list[ast.expr]) -> bool:
    """Return whether a list is asked for first, and its items are given one by one."""
    is_list = len(given) == 1 and isinstance(given[0], ast.List)
    wants_list = bool(given and places and heads_of(places[0].type) & LISTS)
    return wants_list and not is_list and not any(map(places[0].takes, given))


def _with_functions_in_place(places: list[Parameter], values: list[ast.expr]) -> list[ast.expr]:
    """Exchange a function with what stands where a function belongs."""
    wants = [n for n, place in enumerate(places[: len(values)]) if "Callable" in heads_of(place.type)]
    for number, value in enumerate(values):
        if getattr(value, "is_function", False) and len(wants) == 1 and number not in wants:
            values[number], values[wants[0]] = values[wants[0]], value
            break
    return values


def _fit(places: list[Parameter], values: list[ast.expr]) -> int:
    """Return how many literals stand where they fit."""
    return sum(1 for place, one in zip(places, values, strict=False) if kind_of(one) and place.takes(one))


def example_of(parameter: Parameter) -> str:
    """Return what may be given for a parameter; its own name where nothing else is known."""
    heads = heads_of(parameter.type)
    known = {"QoSProfile": "10", "int": "10", "float": "1.0", "Callable": "self.callback", "bool": "True"}
    if not heads & {"str", "Text", "SomeSubstitutionsType"}:
        return next((known[head] for head in known if head in heads), parameter.name)
    of_node = signature_by_name("rclpy.node.Node")
    same = of_node.named(parameter.name) if of_node else None
    if same and same.default:
        return "''"  # what may be left out elsewhere is empty
    return f"'{parameter.name}'"


def _texts(keywords: list[ast.keyword]) -> list[str]:
    return [f"{one.arg}={ast.unparse(one.value)}" for one in keywords]


def _named(
    signature: Signature, call: ast.Call, given: dict[str, str], rest: list[ast.expr]
) -> Iterator[tuple[str, str]]:
    """Yield what is given by its name: what was, under the right name, and what stood in no place of its own."""
    taken = {*given, *(keyword.arg for keyword in call.keywords)}
    free = [one for one in signature.parameters if one.name not in taken]
    for keyword in call.keywords:
        name = keyword.arg or ""
        if signature.named(name) is None and not signature.is_open:
            name = _meant_name(name, free)
            free = [one for one in free if one.name != name]
        parameter, text = signature.named(name), ast.unparse(keyword.value)
        if parameter is not None and not parameter.takes(keyword.value):
            # What fits in no form stays: to leave it out is no fix.
            text = fitting(parameter.type, keyword.value) or text
        text = "'screen'" if (name, text) == ("output", "'True'") else text  # where it is to be seen
        if name and text:
            yield name, text
    for value in rest:
        home = _home_of(value, free)
        if home is not None:
            free.remove(home)
            yield home.name, ast.unparse(value) if home.takes(value) else fitting(home.type, value)


def _meant_name(name: str, free: Sequence[Parameter]) -> str:
    """Return which of the parameters that are not given yet is meant by a name; empty if none is."""
    lacks, known = [one.name for one in free if not one.default], [one.name for one in free]
    close = next((one for one in known if one in name.split("_")), None)
    close = close or nearest(name, lacks, 0.3) or nearest(name, known, 0.5)
    return close or (lacks[0] if len(lacks) == 1 else "")


def _home_of(value: ast.expr, free: Sequence[Parameter]) -> Parameter | None:
    """Return the parameter that is not given yet and takes a value that stood in no place of its own."""
    if kind_of(value):
        for one in free:
            if not heads_of(one.type) & ANYTHING and one.takes(value):
                return one
    is_number = isinstance(value, ast.Constant) and re.fullmatch(r"\d+(\.\d*)?", str(value.value))
    return next((one for one in free if is_number and "float" in heads_of(one.type)), None)


def fitting(wanted: str, value: ast.expr) -> str:  # noqa: PLR0911 -- a table
    """Return a value as it is written for a type; empty if that cannot be told.

    Args:
        wanted: the type, as an annotation or a type checker names it, or a message's dotted name.
        value: what is given.
    """
    if getattr(value, "is_function", False):
        return ""
    text, kind = ast.unparse(value), kind_of(value)
    literal = value.value if isinstance(value, ast.Constant) else None
    heads = heads_of(wanted)
    if message := message_of(wanted):
        return filled(message, value)
    if "tuple[" in wanted.lower() and (pairs := _pairs(value)):
        return f"[{', '.join(f'({ast.unparse(key)}, {ast.unparse(one)})' for key, one in pairs)}]"
    if made := _objects(wanted, value):
        return made
    if "tuple[" in wanted.lower() and isinstance(value, ast.List) and len(value.elts) == 2:
        return f"[({', '.join(map(ast.unparse, value.elts))})]"
    if heads & LISTS and kind not in ("list", "tuple"):
        return as_list(value)
    number = str(literal).replace(",", ".").strip()
    is_number = re.fullmatch(r"[-+]?\d+(\.\d*)?", number) is not None
    if "float" in heads:
        return (
            (number if "." in number else f"{number}.0") if is_number else f"float({text})" * (kind is None)
        )
    if heads & {"int", "QoSProfile"}:
        return number.partition(".")[0] if is_number else f"int({text})" * (kind is None)
    if "bool" in heads:
        return "True"
    return _as_text(value, kind) if heads & TAKES["str"] else ""


def _as_text(value: ast.expr, kind: str | None) -> str:
    """Return a value as it is written for a text."""
    match value:
        case ast.Tuple(elts=parts) | ast.List(elts=parts):
            return joined(parts)
        case ast.Constant(value=bytes(held)):
            return repr(held.decode("latin-1"))
    text = ast.unparse(value)
    return f"'{text}'" if kind in ("int", "float", "bool") else f"str({text})"


def _pairs(value: ast.expr) -> list[tuple[ast.expr, ast.expr]]:
    """Return the items of a dictionary, or of several in a list; nothing of anything else."""
    dicts = value.elts if isinstance(value, (ast.List, ast.Tuple)) else [value]
    if not all(isinstance(one, ast.Dict) for one in dicts):
        return []
    rows = [zip(one.keys, one.values, strict=True) for one in dicts if isinstance(one, ast.Dict)]
    return [(key, given) for row in rows for key, given in row if key]


def as_list(value: ast.expr) -> str:
    """Return a value as a list: of a text its words, as a shell would read them."""
    with contextlib.suppress(ValueError):
        if isinstance(value, ast.Constant) and isinstance(value.value, str):
            return repr(shlex.split(value.value))
    return f"[{ast.unparse(value)}]"


def _objects(wanted: str, value: ast.expr) -> str:
    """Return a list of tuples as one of objects of rclpy, each made of a tuple; empty if that is not wanted."""
    inner = LIST_OF.search(wanted)
    homes = [home for home in interfaces.homes_of(inner[1]) if home.startswith("rclpy.")] if inner else []
    signature = signature_by_name(f"{homes[0]}.{inner[1]}") if homes and inner else None
    pairs = value.elts if isinstance(value, (ast.List, ast.Tuple)) else []
    if (
        not signature
        or not pairs
        or not all(isinstance(one, ast.Tuple) and len(one.elts) == 2 for one in pairs)
    ):
        return ""
    last = signature.parameters[-1].name
    texts = [
        f"{inner[1]}({ast.unparse(one.elts[0])}, {last}={ast.unparse(one.elts[1])})"  # type: ignore[attr-defined, index]
        for one in pairs
    ]
    return f"[{', '.join(texts)}]"


def missing_imports(source: PythonSource, written: str) -> list[str]:
    """Return the import of each class of ROS that is written and that a file does not import."""
    own = {node.name for node in source.tree.body if isinstance(node, ast.ClassDef)}
    # `Node(...)` only names a class, and writes none.
    names = set(re.findall(r"(?<![\w.'\"])[A-Z]\w+(?=\((?!\.\.\.))", written)) - own - {*source.names}
    homes = {name: interfaces.homes_of(name) or interfaces.launch_homes_of(name) for name in sorted(names)}
    return [f"from {found[0]} import {name}" for name, found in homes.items() if found]


def one_each(call: ast.Call) -> list[str]:
    """Return one call for each item of the list that is all that a call is given."""
    match call:
        case ast.Call(func=func, args=[ast.List(elts=items)], keywords=[]):
            return [f"{ast.unparse(func)}({ast.unparse(item)})" for item in items]
    return []


def joined(values: Sequence[ast.expr]) -> str:
    """Return the f-string of several values, with a space between two, as print writes them."""
    parts: list[ast.expr] = []
    for value in values:
        before = parts[-1].value if parts and isinstance(parts[-1], ast.Constant) else None
        if parts and not str(before).endswith(" "):
            parts.append(ast.Constant(" "))
        is_text = isinstance(value, ast.Constant) and isinstance(value.value, str)
        parts.append(value if is_text else ast.FormattedValue(value, conversion=-1))
    return ast.unparse(ast.JoinedStr(parts))


def filled(message: str, value: ast.expr | None) -> str:
    """Return how a message is made of a value: `Vector3(x=0.5)`, of one number a field `Vector3(x=1.0, y=0.0, z=0.0)`."""
    name, fields = message.rpartition(".")[2], interfaces.fields_of(message) or {}
    rows = [one for one in fields_as_parameters(fields) if one.name != "header"]
    if isinstance(value, ast.Dict):
        given = {getattr(key, "value", ""): one for key, one in zip(value.keys, value.values, strict=True)}
        rows = [one for one in rows if one.name in given]
        value = ast.Tuple([given[one.name] for one in rows])
    values = list(value.elts) if isinstance(value, (ast.Tuple, ast.List)) else [value] if value else []
    if not rows or len(values) > len(rows):
        return f"{name}()"
    pairs = []
    for row, one in zip(rows, values, strict=False):
        is_message = bool(message_of(row.type)) or (row.type, kind_of(one)) == ("float", "int")
        is_turn = row.name == "angular" and isinstance(kind_of(one), str)  # a robot turns about z
        text = fitting(row.type, one) if is_message or not row.takes(one) else ast.unparse(one)
        pairs.append(f"{row.name}={text.replace('(x=', '(z=') if is_turn else text or '...'}")
    return f"{name}({', '.join(pairs)})"
