"""What a function of an installed library takes, read from its source."""

from __future__ import annotations

import ast
import re
import sys
import sysconfig
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.python_source import Function, PythonSource, read_source

_DEEPEST = 5  # modules through which a name is handed on, and classes above one
_NODE = "rclpy.node.Node"
# The names of types that take a literal of each kind; a literal of any other kind is taken by that type alone.
TAKES = {
    "str": {"str", "Text", "SomeSubstitutionsType", "Path", "PathLike", "Iterable"},
    "int": {"int", "float", "QoSProfile", "SomeSubstitutionsType"},
    "float": {"float"},
    "bool": {"bool"},
    "list": {"list", "List", "Iterable", "Sequence", "Collection", "SomeSubstitutionsType"},
    "dict": {"dict", "Dict", "Mapping"},
    "tuple": {"tuple", "Tuple", "Iterable", "Sequence"},
}
LIST_OF = re.compile(
    r"(?:[lL]ist|Sequence|Iterable|Collection)\[['\"]?(?:\w+\.)*([A-Z]\w+)['\"]?\]"
)  # of objects of a class
LISTS = TAKES["list"] - {"SomeSubstitutionsType"}
_PLAIN = frozenset().union(*TAKES.values()) - {"SomeSubstitutionsType", "QoSProfile"}
ANYTHING = frozenset(("", "Any", "object", "Unknown", "T", "MsgType", "SrvType", "AllowableParameterValue"))


@dataclass(frozen=True)
class Parameter:
    """A parameter of a function: its name, the type that it asks for, and its default; "" stands for none."""

    name: str
    type: str
    default: str
    is_positional: bool

    def takes(self, value: ast.expr) -> bool:
        """Return whether a value may be given for it, as far as its kind can be read."""
        kind, heads = kind_of(value), heads_of(self.type)
        if kind is None or kind == "None" or heads & ANYTHING:
            return kind != "None" or "None" in f"{self.type} {self.default}" or "Optional" in self.type
        if isinstance(value, ast.List) and LIST_OF.search(self.type) and "tuple" not in self.type.lower():
            return not any(isinstance(one, ast.Tuple) for one in value.elts)
        if isinstance(value, ast.List) and "tuple[" in self.type.lower():
            return not any(kind_of(one) in ("str", "int", "float", "dict") for one in value.elts)
        if kind == "str" and heads <= LISTS:
            return False  # it is a list of its letters, which nobody means
        return bool(heads - _PLAIN) if kind == "object" else bool(heads & TAKES.get(kind, {kind}))


def heads_of(wanted: str) -> set[str]:
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
            return signature_by_name(_NODE)
        case ast.Attribute(attr=method) if source.resolve(call.func) is None and method in _methods():
            return signature_by_name(f"{_NODE}.{method}")
    name = source.resolve(call.func)
    fields = interfaces.fields_of(name)
    if fields is not None:
        return Signature(tuple(fields_as_parameters(fields)))
    return signature_by_name(name) if name and "." in name and not name.startswith(source.name) else None


def fields_as_parameters(fields: Mapping[str, str]) -> Iterator[Parameter]:
    """Yield a message's fields as the parameters that they are of its class."""
    for name, kind in fields.items():
        plain = {"double": "float", "string": "str", "boolean": "bool"}.get(kind, kind)
        wanted = message_of(kind) or (
            "list" if "[" in kind or "<" in kind else "int" if "int" in kind else plain
        )
        yield Parameter(name, wanted, "...", False)


def message_of(wanted: str) -> str:
    """Return the dotted name of the message that a type names; empty if it names none."""
    wanted = wanted.replace(" | None", "").strip()
    if "/" in wanted and re.fullmatch(r"\w+/(?:msg/)?\w+", wanted):
        return f"{wanted.partition('/')[0]}.msg.{wanted.rpartition('/')[2]}"
    if interfaces.is_interface(wanted):
        return wanted
    homes = interfaces.homes_of(wanted) if re.fullmatch(r"[A-Z]\w*", wanted) else ()
    return f"{homes[0]}.{wanted}" if homes and homes[0].endswith(".msg") else ""


def kind_of(value: ast.AST) -> str | None:  # noqa: PLR0911 -- a table
    """Return of which kind a literal or a function of the file is; None if it is neither."""
    match value:
        case ast.Constant():
            return type(value.value).__name__.replace("NoneType", "None") if value.value is not ... else None
        case ast.UnaryOp(operand=ast.Constant()):
            return kind_of(value.operand)
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
        case ast.Lambda():
            return "object"
    return "object" if getattr(value, "is_function", False) else None


@lru_cache(maxsize=1)
def _methods() -> frozenset[str]:
    return interfaces.members_of("rclpy.node", "Node")[0]


@lru_cache(maxsize=64)
def signature_by_name(name: str) -> Signature | None:
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
    of_python = Path(sysconfig.get_path("stdlib"), package) if package in sys.stdlib_module_names else None
    folder = of_python or interfaces.folder_of(package)
    path = folder.joinpath(*rest) if folder else Path("-")
    file = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    return read_source(file, name, str(file)) if file.is_file() else None
