"""Correct a call of a library function from the parameters of that function."""

from __future__ import annotations

import ast
import contextlib
import itertools
import re
import shlex
import sys
from collections.abc import Callable, Collection, Iterator, Sequence

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.joined_texts import joined
from ros2lab.diagnose.sources.own_functions import unused_function
from ros2lab.diagnose.sources.python_source import Function, PythonSource
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

_LONGEST = 110  # characters of a call that is shown in full


def call_faults(
    source: PythonSource,
    lines: Collection[int],
    said: str = "",
    stands_trial: Callable[[PythonSource, ast.Call, str], bool] | None = None,
) -> Iterator[Finding]:
    """Yield the calls of library functions on some lines whose arguments are wrong or missing.

    Use it only for lines at which a library failed: not everything that a library accepts is annotated.

    Args:
        source: the file.
        lines: the lines at which a library failed.
        said: the message of the library, which may name a parameter.
        stands_trial: tells whether a proposed call is valid; None accepts every proposal.
    """
    for node in source.calls:
        if set(lines).isdisjoint(range(node.lineno, (node.end_lineno or 0) + 1)):
            continue
        right, wrong, fix, whole = _meant(source, node)
        if fix and whole and stands_trial and not stands_trial(source, node, whole):
            fix = ""
        signature, given = signature_of(source, node), {keyword.arg for keyword in node.keywords}
        words = set(re.findall(r"[a-z_]+", said.lower()))
        needs_all = signature is not None and not interfaces.is_interface(
            source.resolve(node.func)
        )  # a message needs no field
        named = (
            [p for p in signature.parameters if p.name in words - given] if signature and needs_all else []
        )
        asked = [p for p in named if not p.is_positional and example_of(p) != p.name]
        if fix:
            what = (
                f"does not accept {', '.join(wrong)[:_LONGEST]} as written"
                if wrong
                else f"is missing {', '.join(right)}"
                if right
                else "has its arguments in the wrong order"
            )
            yield Finding("argument-type", f"{ast.unparse(node.func)} {what}.", source.at(node), fix)
        elif asked:
            name = ast.unparse(node.func)
            added = f"{asked[0].name}={example_of(asked[0])}"
            texts = [*map(ast.unparse, node.args), *_texts(node.keywords), added]
            cause = f"{name} needs the argument {asked[0].name}, which is not given."
            yield Finding("argument-missing", cause, source.at(node), f"write `{name}({', '.join(texts)})`")


def meant_call(source: PythonSource, call: ast.Call) -> str:
    """Return how to correct a call: each value moved where it fits, missing arguments added.

    Empty if the call is correct already, or if its signature is not known.
    """
    return _meant(source, call)[2]


def whole_call(source: PythonSource, call: ast.Call) -> str:
    """Return the whole corrected call; `meant_call` names only the changes."""
    return _meant(source, call)[3]


def _meant(source: PythonSource, call: ast.Call) -> tuple[list[str], list[str], str, str]:
    """Return the missing and the wrong arguments of a call, what to write, and the whole corrected call."""
    signature = signature_of(source, call)
    if signature is None or any(isinstance(argument, ast.Starred) for argument in call.args):
        return [], [], "", ""
    name, message = ast.unparse(call.func), source.resolve(call.func) or ""
    old = [*map(ast.unparse, call.args), *_texts(call.keywords)]
    if interfaces.fields_of(message) and call.args:
        whole = filled(message, ast.Tuple(list(call.args)))
        return [], old, f"write `{whole}`", whole
    new = _arranged(signature, call)
    meant = unused_function(source, call.lineno)
    new = [text.replace("self.callback", meant) if text not in old and meant else text for text in new]
    whole = f"{name}({', '.join(new)})"
    right, wrong = [text for text in new if text not in old], [text for text in old if text not in new]
    has_callback = any(isinstance(n, Function) and n.name == "callback" for n in source.nodes)
    if right == ["self.callback"] and not has_callback:
        # Nothing tells which function is meant.
        fix = f"add the function that {name}() should call, without parentheses, as its callback"
        return right, wrong, fix, ""
    if new == old:
        return right, wrong, "", whole
    if len(whole) <= _LONGEST:
        return right, wrong, f"write `{whole}`", whole
    is_one_list = new[0].startswith("[") and bool(call.args)
    fix = f"write {name}([ ... ]), with all its arguments as one list in brackets"
    return right, wrong, fix if is_one_list else _change(old, new, right, wrong), whole


def _change(old: list[str], new: list[str], right: list[str], wrong: list[str]) -> str:
    """Say what to change in a call that is too long to be written whole."""
    if len(new) > len(old) and new[-len(old) :] == old:
        return f"write `{', '.join(right)}` before the other arguments"
    if right and wrong:
        return f"write `{', '.join(right)}` instead of `{', '.join(wrong)[:_LONGEST]}`"
    return f"add `{', '.join(right)}` inside its parentheses" if right else f"remove `{', '.join(wrong)}`"


def _arranged(signature: Signature, call: ast.Call) -> list[str]:
    """Return the arguments of the corrected call."""
    places = signature.places
    if _lacks_brackets(places, call.args):
        return [f"[{', '.join(map(ast.unparse, call.args))}]", *_texts(call.keywords)]
    slid = _with_gaps(places, list(call.args), {keyword.arg for keyword in call.keywords})
    given, rest = _placed(places, slid or _with_functions_in_place(places, list(call.args)))
    named = dict(_named(signature, call, given, rest))
    values_of = {**given, **named}
    required = (parameter for parameter in signature.parameters if not parameter.default)
    lacking = {
        parameter.name: example_of(parameter) for parameter in required if parameter.name not in values_of
    }
    by_name = () if rest else {keyword.arg for keyword in call.keywords}
    placed = []
    for name in (parameter.name for parameter in places):
        if name in by_name or name not in {*values_of, *lacking}:
            break
        placed.append(values_of.pop(name) if name in values_of else lacking.pop(name))
    return [*placed, *(f"{name}={value}" for name, value in {**values_of, **lacking}.items())]


_GAP = ast.Constant(...)  # instead of a value that was left out


def _placed(places: list[Parameter], values: list[ast.expr]) -> tuple[dict[str, str], list[ast.expr]]:
    """Return the values that fit their positions, by parameter name, and the remaining values."""
    given: dict[str, str] = {}
    rest: list[ast.expr] = []
    if len(values) > len(places):
        # The surplus value may come before the others.
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
    """Return the values in the right positions if a required one was left out and the others moved up.

    Empty if every value fits its position already, or if no other positions take all of them.
    """
    needed = [parameter for parameter in places if not parameter.default and parameter.name not in named]
    if not 0 < len(values) < len(needed) or _misfits(needed, values) == 0:
        return []
    ways = []
    for numbers in itertools.combinations(range(len(needed)), len(values)):
        there = dict(zip(numbers, values, strict=True))
        ways.append([there.get(n, _GAP) for n in range(numbers[-1] + 1)])
    best = min(ways, key=lambda way: (_misfits(needed, way), -_fit(needed, way)))
    return best if _misfits(needed, best) == 0 else []


def _misfits(places: list[Parameter], values: list[ast.expr]) -> int:
    """Return how many values do not fit their positions, functions in the position of a string included."""
    pairs = [pair for pair in zip(places, values, strict=False) if pair[1] is not _GAP]
    return sum(1 for place, value in pairs if not place.takes(value) or _is_method_for_text(place, value))


def _is_method_for_text(place: Parameter, value: ast.expr) -> bool:
    return getattr(value, "is_function", False) is True and heads_of(place.type) == {"str"}


def _lacks_brackets(places: list[Parameter], given: list[ast.expr]) -> bool:
    """Return whether the first parameter is a list but its items are given as separate arguments."""
    is_list = len(given) == 1 and isinstance(given[0], ast.List)
    wants_list = bool(given and places and heads_of(places[0].type) & LISTS)
    return wants_list and not is_list and not any(map(places[0].takes, given))


def _with_functions_in_place(places: list[Parameter], values: list[ast.expr]) -> list[ast.expr]:
    """Swap a misplaced function with the value in the position of the callback."""
    wants = [n for n, place in enumerate(places[: len(values)]) if "Callable" in heads_of(place.type)]
    for number, value in enumerate(values):
        if getattr(value, "is_function", False) and len(wants) == 1 and number not in wants:
            values[number], values[wants[0]] = values[wants[0]], value
            break
    return values


def _fit(places: list[Parameter], values: list[ast.expr]) -> int:
    """Return how many literals fit their positions."""
    return sum(
        1
        for place, value in zip(places, values, strict=False)
        if kind_of(value) and not heads_of(place.type) & ANYTHING and place.takes(value)
    )


def example_of(parameter: Parameter) -> str:
    """Return an example of an argument for a parameter; the parameter's name if its type is not known."""
    heads = heads_of(parameter.type)
    known = {"QoSProfile": "10", "int": "10", "float": "1.0", "Callable": "self.callback", "bool": "True"}
    if not heads & {"str", "Text", "SomeSubstitutionsType"}:
        return next((known[head] for head in known if head in heads), parameter.name)
    of_node = signature_by_name("rclpy.node.Node")
    same = of_node.named(parameter.name) if of_node else None
    if same and same.default:
        return "''"  # empty where Node has a default
    return f"'{parameter.name}'"


def _texts(keywords: list[ast.keyword]) -> list[str]:
    return [f"{keyword.arg}={ast.unparse(keyword.value)}" for keyword in keywords]


def _named(
    signature: Signature, call: ast.Call, given: dict[str, str], rest: list[ast.expr]
) -> Iterator[tuple[str, str]]:
    """Yield the keyword arguments: those given, under the right names, and the values without a position."""
    taken = {*given, *(keyword.arg for keyword in call.keywords)}
    free = [parameter for parameter in signature.parameters if parameter.name not in taken]
    for keyword in call.keywords:
        name = keyword.arg or ""
        if signature.named(name) is None and not signature.is_open:
            name = _meant_name(name, free)
            free = [parameter for parameter in free if parameter.name != name]
        parameter, text = signature.named(name), ast.unparse(keyword.value)
        if parameter is not None and not parameter.takes(keyword.value):
            # A value that fits in no form stays: leaving it out is no fix.
            text = fitting(parameter.type, keyword.value) or text
        text = "'screen'" if (name, text) == ("output", "'True'") else text  # so that the output is visible
        if name and text:
            yield name, text
    for value in rest:
        home = _home_of(value, free)
        if home is not None:
            free.remove(home)
            yield home.name, ast.unparse(value) if home.takes(value) else fitting(home.type, value)


def _meant_name(name: str, free: Sequence[Parameter]) -> str:
    """Return the name of the parameter not yet given that a wrong name means; empty if there is none."""
    lacks, known = (
        [parameter.name for parameter in free if not parameter.default],
        [parameter.name for parameter in free],
    )
    close = next((candidate for candidate in known if candidate in name.split("_")), None)
    close = close or nearest(name, lacks, 0.3) or nearest(name, known, 0.5)
    return close or (lacks[0] if len(lacks) == 1 else "")


def _home_of(value: ast.expr, free: Sequence[Parameter]) -> Parameter | None:
    """Return the parameter not yet given that takes a value without a position; None if there is none."""
    if kind_of(value):
        for parameter in free:
            if not heads_of(parameter.type) & ANYTHING and parameter.takes(value):
                return parameter
        # One that has become a keyword comes next in the def; where no type is written, its default tells it.
        named = [p for p in free if p.default and not p.is_positional and heads_of(p.type) & ANYTHING]
        if named and kind_of(ast.parse(named[0].default, mode="eval").body) == kind_of(value):
            return named[0]
    is_number = isinstance(value, ast.Constant) and re.fullmatch(r"\d+(\.\d*)?", str(value.value))
    return next((parameter for parameter in free if is_number and "float" in heads_of(parameter.type)), None)


_UNTRUE = frozenset(("", "0", "0.0", "false", "no", "off"))


def fitting(wanted: str, value: ast.expr) -> str:  # noqa: PLR0911 -- a table
    """Return a value written for a type, as an annotation, a message or the type checker names it; empty if it cannot be converted."""
    if getattr(value, "is_function", False):
        return ""
    text, kind = ast.unparse(value), kind_of(value)
    literal = value.value if isinstance(value, ast.Constant) else None
    heads = heads_of(wanted)
    if message := message_of(wanted):
        return filled(message, value)
    if "tuple[" in wanted.lower() and (pairs := _pairs(value)):
        return f"[{', '.join(f'({ast.unparse(key)}, {ast.unparse(item)})' for key, item in pairs)}]"
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
        return str(str(literal).lower() not in _UNTRUE)
    return _as_text(value, kind) if heads & TAKES["str"] else ""


def _as_text(value: ast.expr, kind: str | None) -> str:
    """Return a value written as a string."""
    match value:
        case ast.Tuple(elts=parts) | ast.List(elts=parts):
            return joined(parts)
        case ast.Constant(value=bytes(held)):
            return repr(held.decode("latin-1"))
    text = ast.unparse(value)
    return f"'{text}'" if kind in ("int", "float", "bool") else f"str({text})"


def _pairs(value: ast.expr) -> list[tuple[ast.expr, ast.expr]]:
    """Return the items of a dict or of a list of dicts; empty for anything else."""
    dicts = value.elts if isinstance(value, (ast.List, ast.Tuple)) else [value]
    if not all(isinstance(dictionary, ast.Dict) for dictionary in dicts):
        return []
    rows = [
        zip(dictionary.keys, dictionary.values, strict=True)
        for dictionary in dicts
        if isinstance(dictionary, ast.Dict)
    ]
    return [(key, given) for row in rows for key, given in row if key]


def as_list(value: ast.expr) -> str:
    """Return a value written as a list; for a string, a list of its words as a shell splits them."""
    with contextlib.suppress(ValueError):
        if isinstance(value, ast.Constant) and isinstance(value.value, str):
            return repr(shlex.split(value.value))
    return f"[{ast.unparse(value)}]"


def _objects(wanted: str, value: ast.expr) -> str:
    """Return a list of tuples written as a list of rclpy objects; empty if the type asks for none."""
    inner = LIST_OF.search(wanted)
    homes = [home for home in interfaces.homes_of(inner[1]) if home.startswith("rclpy.")] if inner else []
    signature = signature_by_name(f"{homes[0]}.{inner[1]}") if homes and inner else None
    pairs = value.elts if isinstance(value, (ast.List, ast.Tuple)) else []
    if (
        not signature
        or not pairs
        or not all(isinstance(pair, ast.Tuple) and len(pair.elts) == 2 for pair in pairs)
    ):
        return ""
    last = signature.parameters[-1].name
    texts = [
        f"{inner[1]}({ast.unparse(pair.elts[0])}, {last}={ast.unparse(pair.elts[1])})"  # type: ignore[attr-defined, index]
        for pair in pairs
    ]
    return f"[{', '.join(texts)}]"


def missing_imports(source: PythonSource, written: str) -> list[str]:
    """Return the import statements for the ROS classes and the modules of Python in a text that a file does not import."""
    # `Node(...)`, with the dots, is only a mention.
    names = set(re.findall(r"(?<![\w.'\"])[A-Z]\w+(?=\((?!\.\.\.))", written)) - {
        *source.classes,
        *source.names,
    }
    homes = {name: interfaces.homes_of(name) or interfaces.launch_homes_of(name) for name in sorted(names)}
    bound = {getattr(node, "id", getattr(node, "arg", "")) for node in source.nodes} | {*source.names}
    modules = {*re.findall(r"(?<![\w.'\"])([a-z]\w*)(?=\.\w+\()", written)} & sys.stdlib_module_names - bound
    imports = [f"import {module}" for module in sorted(modules)]
    return imports + [f"from {found[0]} import {name}" for name, found in homes.items() if found]


def one_each(call: ast.Call) -> list[str]:
    """Return a call for each item of a list that is the only argument of a call; empty for any other call."""
    match call:
        case ast.Call(func=func, args=[ast.List(elts=items)], keywords=[]):
            return [f"{ast.unparse(func)}({ast.unparse(item)})" for item in items]
    return []


def filled(message: str, value: ast.expr | None) -> str:
    """Return a message made from a value: `Vector3(x=0.5)`, or `Vector3(x=1.0, y=0.0, z=0.0)` from three."""
    name, fields = message.rpartition(".")[2].replace("_", "."), interfaces.fields_of(message) or {}
    rows = [row for row in fields_as_parameters(fields) if row.name != "header"]
    if isinstance(value, ast.Dict):
        given = {getattr(key, "value", ""): item for key, item in zip(value.keys, value.values, strict=True)}
        rows = [row for row in rows if row.name in given]
        value = ast.Tuple([given[row.name] for row in rows])
    values = list(value.elts) if isinstance(value, (ast.Tuple, ast.List)) else [value] if value else []
    if not rows or len(values) > len(rows):
        return f"{name}()"
    pairs = []
    for row, item in zip(rows, values, strict=False):
        is_message = bool(message_of(row.type)) or (row.type, kind_of(item)) == ("float", "int")
        is_turn = row.name == "angular" and isinstance(kind_of(item), str)  # a robot turns about z
        text = fitting(row.type, item) if is_message or not row.takes(item) else ast.unparse(item)
        pairs.append(f"{row.name}={text.replace('(x=', '(z=') if is_turn else text or '...'}")
    return f"{name}({', '.join(pairs)})"
