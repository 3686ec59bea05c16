"""Read the signatures of functions in installed libraries from their sources."""

from __future__ import annotations

import ast
import contextlib
import re
import sys
import sysconfig
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path

from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    parameters,
    read_source,
    walk,
)
from ros2lab.diagnose.sources.static_value import bound
from ros2lab.diagnose.sources.syntax_parts import all_parameters, defaults_of

_DEEPEST = 5  # modules that re-export a name, and levels of base classes
_NODE = "rclpy.node.Node"
# The types that accept a literal of each kind; a literal of any other kind needs exactly that type.
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
)  # a list of objects of a class
LISTS = TAKES["list"] - {"SomeSubstitutionsType"}
_PLAIN = frozenset().union(*TAKES.values()) - {"SomeSubstitutionsType", "QoSProfile"}
ANYTHING = frozenset(("", "Any", "object", "Unknown", "T", "MsgType", "SrvType", "AllowableParameterValue"))


@dataclass(frozen=True)
class Parameter:
    """A parameter of a function: its name, its type and its default; "" if there is none."""

    name: str
    type: str
    default: str
    is_positional: bool

    def takes(self, value: ast.expr) -> bool:
        """Return whether the parameter accepts a value; true if the kind of the value is not known."""
        kind, heads = kind_of(value), heads_of(self.type)
        if kind is None or kind == "None" or heads & ANYTHING:
            return kind != "None" or "None" in f"{self.type} {self.default}" or "Optional" in self.type
        if isinstance(value, ast.List) and LIST_OF.search(self.type) and "tuple" not in self.type.lower():
            return not any(isinstance(item, ast.Tuple) for item in value.elts)
        if isinstance(value, ast.List) and "tuple[" in self.type.lower():
            return not any(kind_of(item) in ("str", "int", "float", "dict") for item in value.elts)
        if kind == "str" and heads <= LISTS:
            return False  # a string counts as a list of characters, which nobody means
        return bool(heads - _PLAIN) if kind == "object" else bool(heads & TAKES.get(kind, {kind}))


def heads_of(wanted: str) -> set[str]:
    """Return the alternatives of a type, without brackets and None: `{list, str}` for `list[int] | str`."""
    text = wanted.strip("'\" ")
    while match := re.fullmatch(r"(?:typing\.)?(?:Optional|Union)\[(.*)\]", text):
        text = match[1]
    while (flat := re.sub(r"\[[^\[\]]*\]", "", text)) != text:
        text = flat
    return {part.strip("'\" ").rpartition(".")[2] for part in re.split(r"[|,]", text)} - {"None"}


@dataclass(frozen=True)
class Signature:
    """The parameters of a function, without `self`."""

    parameters: tuple[Parameter, ...]
    is_open: bool = False  # whether it accepts any keyword argument

    @property
    def places(self) -> list[Parameter]:
        """The parameters that may be given by position."""
        return [parameter for parameter in self.parameters if parameter.is_positional]

    def named(self, name: str) -> Parameter | None:
        """Return the parameter with this name; None if there is none."""
        return next((parameter for parameter in self.parameters if parameter.name == name), None)

    def accepts(self, call: ast.Call) -> bool:
        """Return whether the number and the names of the arguments of a call fit; true if it unpacks some."""
        keywords = {keyword.arg for keyword in call.keywords}
        if None in keywords or any(isinstance(value, ast.Starred) for value in call.args):
            return True
        places = [parameter.name for parameter in self.places]
        given = {*places[: len(call.args)], *keywords}
        needed = {parameter.name for parameter in self.parameters if not parameter.default}
        known = self.is_open or keywords <= {parameter.name for parameter in self.parameters}
        return len(call.args) <= len(places) and needed <= given and known

    @property
    def shown(self) -> str:
        """The parameters as in a call: required ones by position, and all others as `name=...`."""
        return ", ".join(
            f"{parameter.name}=..." if parameter.default or not parameter.is_positional else parameter.name
            for parameter in self.parameters
        )


def signature_of(source: PythonSource, call: ast.Call) -> Signature | None:
    """Return the signature of the library function in a call; None if it is not one, or not known."""
    name = source.resolve(call.func)
    match call.func:
        case ast.Attribute(value=ast.Call(func=ast.Name(id="super")), attr="__init__"):
            return signature_by_name(_NODE)
        case ast.Attribute(attr=method) if name is None and method in interfaces.node_members():
            return signature_by_name(f"{_NODE}.{method}")
    found = signature_by_name(name) if name and "." in name and not name.startswith(source.name) else None
    is_of_class = str(name).rpartition(".")[0].rpartition(".")[2][:1].isupper()
    # As in Node.create_timer(self, ...).
    if found and is_of_class and [*map(ast.unparse, call.args[:1])] == ["self"]:
        return replace(found, parameters=(Parameter("self", "", "", is_positional=True), *found.parameters))
    return found


def fields_as_parameters(fields: Mapping[str, str]) -> Iterator[Parameter]:
    """Yield the fields of a message as parameters of its class."""
    for name, kind in fields.items():
        wanted = interfaces.field_kind(kind) or ("list" if "[" in kind or "<" in kind else kind)
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
    """Return the kind of a literal, a new object or a function of the file; None for anything else."""
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


@lru_cache(maxsize=64)
def signature_by_name(name: str) -> Signature | None:
    """Return the signature of an installed function, or of a class or a message when it is called; None if not known."""
    fields = interfaces.fields_of(name)
    if fields is not None:
        return Signature(tuple(fields_as_parameters(fields)))
    found = _definition(name)
    if found is None:
        return None
    source, node = found
    if isinstance(node, ast.ClassDef):
        return _of_class(source, node, _DEEPEST)
    return _of_function(node, is_method=name.split(".")[-2][:1].isupper())


def _of_class(source: PythonSource, node: ast.ClassDef, depth: int) -> Signature | None:
    made = _method(node, "__init__")
    bases = [_definition(base) for base in map(source.resolve, node.bases) if depth and base]
    classes = ((file, base) for file, base in filter(None, bases) if isinstance(base, ast.ClassDef))
    of_bases = (_of_class(file, base, depth - 1) for file, base in classes)
    above = next(filter(None, of_bases), None)
    if made is None:
        return above
    own = _of_function(made, is_method=True)
    if above is None:
        return own if own.parameters or not own.is_open else _of_properties(node)
    if made.args.kwarg is None:
        return own
    own_names = {parameter.name for parameter in own.parameters}
    more = tuple(
        replace(parameter, is_positional=False, default=parameter.default or "...")
        for parameter in above.parameters
        if parameter.name not in own_names
    )
    return Signature((*own.parameters, *more), above.is_open)


def _method(node: ast.ClassDef, name: str) -> ast.FunctionDef | None:
    """Return the last method of a class with a name."""
    methods = (method for method in reversed(node.body) if isinstance(method, ast.FunctionDef))
    return next((method for method in methods if method.name == name), None)


def _of_properties(node: ast.ClassDef) -> Signature:
    """Return the signature of a class whose keyword arguments are its properties, such as rclpy's QoS profiles."""
    methods = [f for f in node.body if isinstance(f, ast.FunctionDef) and f.decorator_list]
    names = dict.fromkeys(method.name for method in methods if method.name[0] != "_")
    rows = [Parameter(name, "int" if name == "depth" else "Any", "...", False) for name in names]
    return Signature(tuple(sorted(rows, key=lambda row: row.name != "depth")))


def _of_function(node: Function, *, is_method: bool) -> Signature:
    places, defaults = parameters(node), defaults_of(node)
    found = []
    for argument in all_parameters(node)[is_method:]:
        kind = ast.unparse(argument.annotation) if argument.annotation else ""
        default = ast.unparse(defaults[argument.arg]) if argument.arg in defaults else ""
        found.append(Parameter(argument.arg, kind, default, is_positional=argument in places))
    return Signature(tuple(found), node.args.kwarg is not None)


@lru_cache(maxsize=256)
def _definition(name: str) -> tuple[PythonSource, ast.ClassDef | Function] | None:
    """Return the definition of an installed class, function or method, and its file; None if not found."""
    for _ in range(_DEEPEST):
        module, _, rest = name.rpartition(".")
        source = _module(module)
        if source is None:
            # It may be a method: look up its class.
            found = _definition(module) if "." in module else None
            if found is None or not isinstance(found[1], ast.ClassDef):
                return None
            method = _method(found[1], rest)
            return (found[0], method) if method else None
        defined = [node for node in source.tree.body if isinstance(node, (ast.ClassDef, Function))]
        own = [definition for definition in defined if definition.name == rest]
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
    return read_source(file, name, str(file), LibrarySource) if file.is_file() else None


class LibrarySource(PythonSource):
    """A Python file of a library, which works: its tree has no marks, and nothing is said of it."""

    @cached_property
    def tree(self) -> ast.Module:
        """The parsed file; empty if this Python cannot parse it."""
        with warnings.catch_warnings(), contextlib.suppress(SyntaxError, ValueError, RecursionError):
            warnings.simplefilter("ignore")
            tree = self.parsed()
            bound(walk(tree))
            return tree
        return ast.Module([], [])
