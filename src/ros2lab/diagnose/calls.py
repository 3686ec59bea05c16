"""A call of a library's function as it was meant, made from the function's own parameters."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

from ros2lab.diagnose import interfaces
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.python_source import Function, PythonSource, read_source
from ros2lab.diagnose.spelling import nearest

_DEEPEST = 5  # modules through which a name is handed on, and classes above one
_NODE = "rclpy.node.Node"
# The names of types that take a literal of each kind.
_TAKES = {
    "str": {"str", "Text", "SomeSubstitutionsType", "Path", "PathLike", "Iterable"},
    "int": {"int", "float", "QoSProfile", "SomeSubstitutionsType"},
    "float": {"float"},
    "bool": {"bool"},
    "list": {"list", "List", "Iterable", "Sequence", "Collection", "SomeSubstitutionsType"},
    "dict": {"dict", "Dict", "Mapping"},
    "tuple": {"tuple", "Tuple", "Iterable", "Sequence"},
}
_LISTS = _TAKES["list"] - {"SomeSubstitutionsType"}
_PLAIN = frozenset().union(*_TAKES.values()) - {"SomeSubstitutionsType", "QoSProfile"}
_ANYTHING = frozenset(("", "Any", "object", "Unknown", "T", "MsgType", "SrvType", "AllowableParameterValue"))
_LONGEST = 110  # letters of a call that is shown as a whole


@dataclass(frozen=True)
class Parameter:
    """A parameter of a function: its name, the type that it asks for, and its default; "" stands for none."""

    name: str
    type: str
    default: str
    is_positional: bool

    def takes(self, value: ast.expr) -> bool:
        """Return whether a value may be given for it, as far as its kind can be read."""
        kind, heads = _kind(value), _heads(self.type)
        if kind is None or kind == "None" or heads & _ANYTHING:
            return kind != "None" or "None" in f"{self.type} {self.default}" or "Optional" in self.type
        if isinstance(value, ast.List) and "tuple[" in self.type.lower():
            return not any(_kind(one) in ("str", "int", "float") for one in value.elts)
        return bool(heads - _PLAIN) if kind == "object" else bool(heads & _TAKES[kind])


def _heads(wanted: str) -> set[str]:
    """Return the alternatives of a type, each without what stands in its brackets: `{list, None}` for `list[int] | None`."""
    text = wanted.strip("'\" ")
    while match := re.fullmatch(r"(?:typing\.)?(?:Optional|Union)\[(.*)\]", text):
        text = match[1]
    while (flat := re.sub(r"\[[^\[\]]*\]", "", text)) != text:
        text = flat
    return {part.strip("'\" ").rpartition(".")[2] for part in re.split(r"[|,]", text)} - {"None"}


@dataclass(frozen=True)
class Signature:
    """What a function takes, without `self`."""

    parameters: tuple[Parameter, ...]
    is_open: bool = False  # whether it takes any name

    def named(self, name: str) -> Parameter | None:
        """Return the parameter of this name."""
        return next((one for one in self.parameters if one.name == name), None)

    @property
    def shown(self) -> str:
        """What stands between the parentheses: what must be given, and the names of what may be."""
        return ", ".join(
            f"{one.name}=..." if one.default or not one.is_positional else one.name for one in self.parameters
        )


def signature_of(source: PythonSource, call: ast.Call) -> Signature | None:
    """Return what the library's function takes that a call means; None if it is none, or is not known."""
    match call.func:
        case ast.Attribute(value=ast.Call(func=ast.Name(id="super")), attr="__init__"):
            return _signature(_NODE)
        case ast.Attribute(attr=method) if source.resolve(call.func) is None and method in _methods():
            return _signature(f"{_NODE}.{method}")
    name = source.resolve(call.func)
    fields = interfaces.fields_of(name)
    if fields is not None:
        return Signature(tuple(_of_fields(fields)))
    return _signature(name) if name and "." in name and not name.startswith(source.name) else None


def call_faults(source: PythonSource, lines: Collection[int], said: str = "") -> Iterator[Finding]:
    """Yield the calls of library functions on some lines that are given what they do not take, or lack what is asked for.

    It is asked only of lines at which a library has failed: what a library takes besides is not always written.

    Args:
        source: the file.
        lines: where it failed.
        said: what the library says, which may name a parameter.
    """
    for node in source.nodes:
        if not isinstance(node, ast.Call) or set(lines).isdisjoint(
            range(node.lineno, (node.end_lineno or 0) + 1)
        ):
            continue
        right, wrong, fix = _meant(source, node)
        signature, given = signature_of(source, node), {keyword.arg for keyword in node.keywords}
        words = set(re.findall(r"[a-z_]+", said.lower()))
        asked = [one for one in signature.parameters if one.name in words - given] if signature else []
        asked = [one for one in asked if not one.is_positional and _example(one) != one.name]
        if fix:
            what = (
                f"is given {', '.join(wrong)[:_LONGEST]}, which it does not take"
                if wrong
                else f"lacks {', '.join(right)}"
            )
            yield Finding("argument-type", f"{ast.unparse(node.func)} {what} so.", source.at(node), fix)
        elif asked:
            texts = [
                *map(ast.unparse, node.args),
                *_texts(node.keywords),
                f"{asked[0].name}={_example(asked[0])}",
            ]
            cause = f"{ast.unparse(node.func)} asks for {asked[0].name}, which is not given."
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


def _meant(source: PythonSource, call: ast.Call) -> tuple[list[str], list[str], str]:
    """Return what a call should be given and is not, what it should not be given, and what to write."""
    signature = signature_of(source, call)
    if signature is None or any(isinstance(one, ast.Starred) for one in call.args):
        return [], [], ""
    name, message = ast.unparse(call.func), source.resolve(call.func) or ""
    old = [*map(ast.unparse, call.args), *_texts(call.keywords)]
    if interfaces.fields_of(message) and call.args:
        return [], old, f"write `{filled(message, ast.Tuple(list(call.args)))}`"
    new = _arranged(signature, call)
    whole = f"{name}({', '.join(new)})"
    right, wrong = [one for one in new if one not in old], [one for one in old if one not in new]
    if new == old:
        fix = ""
    elif len(whole) <= _LONGEST:
        fix = f"write `{whole}`"
    elif new[0].startswith("[") and call.args:
        fix = f"write {name}([ ... ]): one list, in brackets, of all that it is given"
    elif right and wrong:
        fix = f"write `{', '.join(right)}` in place of `{', '.join(wrong)[:_LONGEST]}`"
    else:
        fix = (
            f"write `{', '.join(right)}` into its parentheses" if right else f"take `{', '.join(wrong)}` away"
        )
    return right, wrong, fix


def _arranged(signature: Signature, call: ast.Call) -> list[str]:
    """Return what stands between the parentheses of a call that is as it was meant."""
    places = [one for one in signature.parameters if one.is_positional]
    if call.args and places and _heads(places[0].type) & _LISTS and not any(map(places[0].takes, call.args)):
        return [f"[{', '.join(map(ast.unparse, call.args))}]", *_texts(call.keywords)]
    given: dict[str, str] = {}
    rest: list[ast.expr] = []
    values = list(call.args)
    if len(values) > len(places):
        # One that is too much may stand before the others.
        cut = max(range(len(values), -1, -1), key=lambda n: _fit(places, [*values[:n], *values[n + 1 :]]))
        rest += values[cut : cut + 1]
        values = [*values[:cut], *values[cut + 1 :]]
    for number, value in enumerate(values):
        place = places[number] if number < len(places) else None
        if place and place.takes(value):
            given[place.name] = ast.unparse(value)
        elif place and not place.default and (new := fitting(place.type, value)):
            given[place.name] = new
        else:
            rest.append(value)
    named = dict(_named(signature, call, given, rest))
    lacks = [one for one in signature.parameters if not one.default and one.name not in {*given, *named}]
    placed = [*given.values(), *(_example(one) for one in lacks if one.is_positional)]
    named |= {one.name: _example(one) for one in lacks if not one.is_positional}
    return [*placed, *(f"{name}={value}" for name, value in named.items())]


def _fit(places: list[Parameter], values: list[ast.expr]) -> int:
    """Return how many literals stand where they fit."""
    return sum(1 for place, one in zip(places, values, strict=False) if _kind(one) and place.takes(one))


def _example(parameter: Parameter) -> str:
    """Return what may be given for a parameter."""
    heads = _heads(parameter.type)
    known = {"QoSProfile": "10", "int": "10", "float": "1.0", "Callable": "self.callback", "bool": "True"}
    if not heads & {"str", "Text", "SomeSubstitutionsType"}:
        return next((known[head] for head in known if head in heads), parameter.name)
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
        parameter = signature.named(name)
        if parameter is None and not signature.is_open:
            lacks = [one.name for one in free if not one.default]
            known = [one.name for one in free]
            close = next((one for one in known if one in name.split("_")), None)
            close = close or nearest(name, lacks, 0.3) or nearest(name, known, 0.5)
            name = close or (lacks[0] if len(lacks) == 1 else "")
            parameter = signature.named(name)
            free = [one for one in free if one is not parameter]
        is_misfit = parameter is not None and not parameter.takes(keyword.value)
        text = ast.unparse(keyword.value)
        text = fitting(parameter.type, keyword.value) if parameter and is_misfit else text
        if name and text:
            yield name, text
    for value in rest:
        kind = _kind(value)
        home = next(
            (one for one in free if kind and not _heads(one.type) & _ANYTHING and one.takes(value)), None
        )
        number = isinstance(value, ast.Constant) and re.fullmatch(r"\d+(\.\d*)?", str(value.value))
        home = home or next((one for one in free if number and "float" in _heads(one.type)), None)
        if home is not None:
            free.remove(home)
            yield home.name, ast.unparse(value) if home.takes(value) else fitting(home.type, value)


def fitting(wanted: str, value: ast.expr) -> str:  # noqa: PLR0911 -- a table
    """Return a value as it is written for a type; empty if that cannot be told.

    Args:
        wanted: the type, as an annotation or a type checker names it, or a message's dotted name.
        value: what is given.
    """
    text, kind = ast.unparse(value), _kind(value)
    literal = value.value if isinstance(value, ast.Constant) else None
    heads = _heads(wanted)
    if message := _message(wanted):
        return filled(message, value)
    if "tuple[" in wanted.lower() and isinstance(value, ast.Dict):
        items = zip(value.keys, value.values, strict=True)
        return f"[{', '.join(f'({ast.unparse(key)}, {ast.unparse(one)})' for key, one in items if key)}]"
    if "tuple[" in wanted.lower() and isinstance(value, ast.List) and len(value.elts) == 2:
        return f"[({', '.join(map(ast.unparse, value.elts))})]"
    if heads & _LISTS and kind not in ("list", "tuple"):
        return f"[{text}]"
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
    if heads & _TAKES["str"]:
        if kind in ("list", "tuple"):
            return f"' '.join({text})"
        return {"True": "'screen'"}.get(text, f"'{text}'" if kind in ("int", "float") else f"str({text})")
    return ""


def filled(message: str, value: ast.expr | None) -> str:
    """Return how a message is made of a value: `Vector3(x=0.5)`, of one number a field `Vector3(x=1.0, y=0.0, z=0.0)`."""
    name, fields = message.rpartition(".")[2], interfaces.fields_of(message) or {}
    rows = [one for one in _of_fields(fields) if one.name != "header"]
    if isinstance(value, ast.Dict):
        given = {getattr(key, "value", ""): one for key, one in zip(value.keys, value.values, strict=True)}
        rows = [one for one in rows if one.name in given]
        value = ast.Tuple([given[one.name] for one in rows])
    values = list(value.elts) if isinstance(value, (ast.Tuple, ast.List)) else [value] if value else []
    if not rows or len(values) > len(rows):
        return f"{name}()"
    pairs = []
    for row, one in zip(rows, values, strict=False):
        is_message = bool(_message(row.type)) or (row.type, _kind(one)) == ("float", "int")
        is_turn = row.name == "angular" and isinstance(_kind(one), str)  # a robot turns about z
        text = fitting(row.type, one) if is_message or not row.takes(one) else ast.unparse(one)
        pairs.append(f"{row.name}={text.replace('(x=', '(z=') if is_turn else text or '...'}")
    return f"{name}({', '.join(pairs)})"


def _of_fields(fields: Mapping[str, str]) -> Iterator[Parameter]:
    """Yield a message's fields as the parameters that they are of its class."""
    for name, kind in fields.items():
        plain = {"double": "float", "string": "str", "boolean": "bool"}.get(kind, kind)
        wanted = _message(kind) or (
            "list" if "[" in kind or "<" in kind else "int" if "int" in kind else plain
        )
        yield Parameter(name, wanted, "...", False)


def _message(wanted: str) -> str:
    """Return the dotted name of the message that a type names; empty if it names none."""
    wanted = wanted.replace(" | None", "").strip()
    if "/" in wanted and re.fullmatch(r"\w+/(?:msg/)?\w+", wanted):
        return f"{wanted.partition('/')[0]}.msg.{wanted.rpartition('/')[2]}"
    if interfaces.is_interface(wanted):
        return wanted
    homes = interfaces.homes_of(wanted) if re.fullmatch(r"[A-Z]\w*", wanted) else ()
    return f"{homes[0]}.{wanted}" if homes and homes[0].endswith(".msg") else ""


def _kind(value: ast.AST) -> str | None:  # noqa: PLR0911 -- a table
    """Return of which kind a literal is; None if it is none."""
    match value:
        case ast.Constant():
            return type(value.value).__name__.replace("NoneType", "None") if value.value is not ... else None
        case ast.UnaryOp(operand=ast.Constant()):
            return _kind(value.operand)
        case ast.JoinedStr():
            return "str"
        case ast.List() | ast.ListComp():
            return "list"
        case ast.Dict() | ast.DictComp():
            return "dict"
        case ast.Tuple():
            return "tuple"
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)) if name[:1].isupper():
            return "object"
    return None


@lru_cache(maxsize=1)
def _methods() -> frozenset[str]:
    return interfaces.members_of("rclpy.node", "Node")[0]


@lru_cache(maxsize=64)
def _signature(name: str) -> Signature | None:
    """Return what a function, or a class where it is made into an object, takes."""
    found = _definition(name)
    if found is None:
        return None
    source, node = found
    if isinstance(node, ast.ClassDef):
        return _of_class(source, node, _DEEPEST)
    return _of_function(node, is_method=name.split(".")[-2][:1].isupper())


def _of_class(source: PythonSource, node: ast.ClassDef, depth: int) -> Signature | None:
    made = [one for one in node.body if isinstance(one, ast.FunctionDef) and one.name == "__init__"]
    bases = [source.resolve(base) for base in node.bases]
    above = [
        one
        for base in bases
        if depth and base and (found := _definition(base)) and isinstance(found[1], ast.ClassDef)
        if (one := _of_class(*found, depth - 1))  # type: ignore[arg-type]
    ]
    if not made:
        return above[0] if above else None
    own = _of_function(made[-1], is_method=True)
    if not own.parameters and own.is_open and not above:
        # As in rclpy's profiles: what can be given are its properties.
        names = [
            f.name
            for f in node.body
            if isinstance(f, ast.FunctionDef) and f.decorator_list and f.name[0] != "_"
        ]
        rows = [
            Parameter(name, "int" if name == "depth" else "Any", "...", False)
            for name in dict.fromkeys(names)
        ]
        return Signature(tuple(sorted(rows, key=lambda one: one.name != "depth")))
    if made[-1].args.kwarg is None or not above:
        return own
    own_names = {one.name for one in own.parameters}
    more = tuple(
        replace(one, is_positional=False, default=one.default or "...")
        for one in above[0].parameters
        if one.name not in own_names
    )
    return Signature((*own.parameters, *more), above[0].is_open)


def _of_function(node: Function, *, is_method: bool) -> Signature:
    arguments = node.args
    places = [*arguments.posonlyargs, *arguments.args]
    defaults = [*[None] * (len(places) - len(arguments.defaults)), *arguments.defaults]
    rows = [
        *((one, default, True) for one, default in zip(places, defaults, strict=True)),
        *(
            (one, default, False)
            for one, default in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)
        ),
    ][is_method:]
    return Signature(
        tuple(
            Parameter(
                one.arg,
                ast.unparse(one.annotation) if one.annotation else "",
                ast.unparse(default) if default else "",
                is_positional,
            )
            for one, default, is_positional in rows
        ),
        arguments.kwarg is not None,
    )


@lru_cache(maxsize=256)
def _definition(name: str) -> tuple[PythonSource, ast.ClassDef | Function] | None:
    """Return where an installed class, function or method is defined."""
    for _ in range(_DEEPEST):
        module, _, rest = name.rpartition(".")
        source = _module(module)
        if source is None:
            # A method: its class comes before it.
            found = _definition(module) if "." in module else None
            if found is None or not isinstance(found[1], ast.ClassDef):
                return None
            return next(
                (
                    (found[0], one)
                    for one in reversed(found[1].body)
                    if isinstance(one, ast.FunctionDef) and one.name == rest
                ),
                None,
            )
        kinds = (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
        own = [one for one in source.tree.body if isinstance(one, kinds) and one.name == rest]
        if own:
            return source, own[-1]
        handed_on = source.names.get(rest)
        if handed_on in (None, name):
            return None
        name = str(handed_on)
    return None


@lru_cache(maxsize=64)
def _module(name: str) -> PythonSource | None:
    package, *rest = name.split(".")
    folder = interfaces.folder_of(package)
    path = folder.joinpath(*rest) if folder else Path("-")
    file = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    return read_source(file, name, str(file)) if file.is_file() else None
