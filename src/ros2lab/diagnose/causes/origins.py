"""Where a value that fails was made: the line to fix is seldom the one that Python names.

Python tells the value's type, and the sources what made a value of that type. Only where both agree is
anything said.
"""

from __future__ import annotations

import ast
import builtins
import re
from collections.abc import Iterator
from dataclasses import dataclass
from types import ModuleType
from typing import Any

from ros2lab.diagnose.causes.nothing_given import of_call_that_gave_none
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.printed.spots import Spot, kind_in_words
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.bindings import Import
from ros2lab.diagnose.sources.known_values import declaring
from ros2lab.diagnose.sources.own_functions import may_fall_through, own_function
from ros2lab.diagnose.sources.python_source import PythonSource, assigned_to, last_name, own_nodes

_FUNCTIONS = frozenset(("function", "method", "builtin_function_or_method", "method-wrapper"))
# What an error says about a value: its type, and which part of the line it means.
_SAYS = (
    (r"AttributeError: '(?P<kind>\w+)' object has no attribute '(?P<name>\w+)'", "owner"),
    (r"AttributeError: (?P<kind>module) '[\w.]+' has no attribute '(?P<name>\w+)'", "owner"),
    (r"TypeError: '(?P<kind>\w+)' object is not callable", "called"),
    (r"TypeError: Expected .*, got <class '(?:[\w.]+\.)?(?P<kind>\w+)'>", "any"),
    (r"TypeError: .*, not '?(?P<kind>\w+)'?$", "any"),
    (r"TypeError: can only concatenate (?P<kind2>\w+) \(not \"(?P<kind>\w+)\"\)", "any"),
    (r"TypeError: .*(?::|of) '(?P<kind>\w+)' and '(?P<kind2>\w+)'$", "any"),
    (r"TypeError: '(?P<kind>\w+)' object (?:is not subscriptable|does not support item)", "subscripted"),
    (r"TypeError: (?P<kind>type) '\w+' is not subscriptable", "subscripted"),
    (r"TypeError: .*'(?P<kind>\w+)' object (?:is not|does not|cannot)", "any"),
    (r"TypeError: .*type '(?P<kind>\w+)' ", "any"),
    (r"TypeError: cannot unpack non-iterable (?P<kind>\w+) object", "any"),
)
_LITERALS: dict[type[ast.expr], str] = {
    ast.JoinedStr: "str",
    ast.List: "list",
    ast.ListComp: "list",
    ast.Dict: "dict",
    ast.DictComp: "dict",
    ast.Set: "set",
    ast.SetComp: "set",
    ast.Tuple: "tuple",
    ast.Lambda: "function",
}
_EMPTY = {"list": "[]", "dict": "{}", "set": "set()"}


@dataclass(frozen=True)
class Origin:
    """What made the value of a name.

    Attributes:
        name: the expression that holds it where it is used.
        value: what made it: an expression (also the name of a class or function), or an import.
        source: the file in which it was made.
        line: the line on which it was made.
        kind: the type of the value, as Python calls it; empty if only running would tell.
    """

    name: str
    value: ast.AST | Import
    source: PythonSource
    line: int
    kind: str

    @property
    def place(self) -> str:
        """Where it was made, as it is shown."""
        return self.source.at(self.line)


_Told = tuple[str, str, str]  # cause, place and fix


def of_origin(kind: str, message: str, spot: Spot) -> Finding | None:
    """Return where the value that an error is about was made, and how to fix it; None if that is not seen."""
    for pattern, part in _SAYS:
        match = re.search(pattern, f"{kind}: {message}")
        if match is None:
            continue
        said = match.groupdict()
        kinds = [name for name in (said["kind"], said.get("kind2")) if name]
        asked = said.get("name") or ""
        origins = list(_origins(spot, part, asked))
        for wanted in ["NoneType"] if "NoneType" in kinds else kinds:
            for origin in _fitting(origins, wanted):
                others = [
                    other.kind for other in origins if other.name == origin.name and other.kind != "NoneType"
                ]
                if wanted == "NoneType" and others and not isinstance(origin.value, ast.Call):
                    continue  # it is set later, so the line of use is to blame
                if told := _told(origin, kinds, asked, spot):
                    return Finding("made-wrong", *told)
        return None
    return None


def of_argument(message: str, spot: Spot, caller: Spot) -> Finding | None:
    """Return a finding about a function given a whole message instead of its contents; None if it was not."""
    said = re.search(r"'(?P<kind>\w+)' object has no attribute '(?P<name>\w+)'", message)
    field, function = interfaces.only_field(said["kind"]) if said else "", spot.function
    if said is None or not field or function is None:
        return None
    names = [argument.arg for argument in function.args.args]
    for call in caller.calls:
        is_method = isinstance(call.func, ast.Attribute) and names[:1] == ["self"]
        if last_name(call.func) != function.name:
            continue
        for name, given in zip(names[is_method:], call.args, strict=False):
            if name in spot.holds(said["name"]):
                old = ast.unparse(given)
                new = re.sub(rf"\b{re.escape(old)}\b", f"{old}.{field}", ast.unparse(call), count=1)
                cause = f"{function.name}() is given the whole message {old}, but works with its contents."
                return Finding("made-wrong", cause, caller.file.at(call), f"write {new}")
    return None


def _fitting(origins: list[Origin], kind: str) -> list[Origin]:
    """Return the origins of this type; for None, or else those of unknown type if all have one name."""
    fitting = [origin for origin in origins if _is_of(origin.kind, kind)]
    unknown = [origin for origin in origins if not origin.kind]
    is_one = len({origin.name for origin in origins}) == 1
    return fitting or (unknown if kind == "NoneType" and is_one else [])


def _is_of(kind: str, said: str) -> bool:
    if said.startswith("Metaclass_"):
        return kind == "type"
    return kind == said or (kind in _FUNCTIONS and said in _FUNCTIONS)


def _origins(spot: Spot, part: str, name: str) -> Iterator[Origin]:
    """Yield the origins of each value on the line that an error may be about."""
    for node in spot.whole:
        match node:
            case ast.Attribute(value=used, attr=attr) if part == "owner" and attr == name:
                yield from _made(spot, used)
            case ast.Call(func=used) if part == "called":
                yield from _made(spot, used)
            case ast.Subscript(value=used) if part == "subscripted":
                yield from _made(spot, used)
            case ast.AugAssign(target=used) if part == "any":
                yield from _made(spot, used)
            case ast.Call() | ast.Name(ctx=ast.Load()) | ast.Attribute(ctx=ast.Load()) if part == "any":
                yield from _made(spot, node)


def _made(spot: Spot, expression: ast.expr) -> Iterator[Origin]:
    """Yield the possible origins of an expression's value, the likeliest first."""
    source, name = spot.file, ast.unparse(expression)
    if isinstance(expression, ast.Call):
        yield Origin(name, expression, source, expression.lineno, _kind(source, expression))
    if declared := _declared(source, expression):
        yield Origin(name, declared, source, declared.lineno, _kind_of_default(source, declared))
    if not isinstance(expression, (ast.Name, ast.Attribute)):
        return
    scopes = (
        [spot.function, source.tree] if isinstance(expression, ast.Name) else [source.class_at(spot.line)]
    )
    for scope in filter(None, scopes):
        nodes = own_nodes(scope) if isinstance(expression, ast.Name) else ast.walk(scope)
        values = [(value.lineno, value) for value in assigned_to(nodes, name)]
        for line, value in sorted(values, key=lambda pair: (pair[0] > spot.line, -pair[0])):
            yield Origin(name, value, source, line, _kind(source, value))
            if declared := _declared(source, value):
                yield Origin(name, declared, source, declared.lineno, _kind_of_default(source, declared))
    imported = next(
        (candidate for candidate in source.imports if candidate.local == name.partition(".")[0]), None
    )
    if imported is not None:
        yield Origin(name, imported, source, imported.line, _kind_of_object(imported, name))


def _declared(source: PythonSource, value: ast.expr) -> ast.Call | None:
    """Return the call that declares the parameter whose value an expression is; None if it is none."""
    match value:
        case ast.Attribute(value=ast.Call(func=ast.Attribute(attr="get_parameter")) as read):
            return next(iter(declaring(source, read)), None)
    return None


def _kind_of_default(source: PythonSource, declared: ast.Call) -> str:
    if len(declared.args) > 1:
        return _kind(source, declared.args[1])
    return "?" if declared.keywords else "NoneType"


def _kind(source: PythonSource, value: ast.expr) -> str:
    """Return the type of an expression's value; empty if only running would tell, ? if it is another."""
    if isinstance(value, ast.Constant):
        return type(value.value).__name__
    if isinstance(value, ast.Call):
        return kind_of_call(source, value)
    if isinstance(value, (ast.Name, ast.Attribute)):
        return _kind_of_name(source, value)
    return _LITERALS.get(type(value), "?")


def kind_of_call(source: PythonSource, call: ast.Call) -> str:
    """Return the type of what a call returns, as Python calls it; empty if only running would tell."""
    if own := own_function(source, call.func):
        return "NoneType" if may_fall_through(own[1]) else ""
    name = last_name(call.func)
    known = getattr(builtins, name, None) if isinstance(call.func, ast.Name) else None
    if isinstance(known, type):
        return known.__name__
    known_calls = {"get_parameter": "Parameter", "get_parameter_value": "ParameterValue", "input": "str"}
    return known_calls.get(name, "")


def _kind_of_name(source: PythonSource, value: ast.Name | ast.Attribute) -> str:
    from rclpy.node import Node

    if own_function(source, value) or (isinstance(value, ast.Attribute) and hasattr(Node, value.attr)):
        return "function"
    resolved = (source.resolve(value) or "").rpartition(".")[2]
    return "type" if resolved in source.classes or interfaces.homes_of(resolved) else "?"


def _object(name: str) -> Any:
    """Return the object of a dotted name in Python's own library; None if there is none."""
    module, _, last = name.rpartition(".")
    return interfaces.own_module(name) or (getattr(_object(module), last, None) if module else None)


def _kind_of_object(imported: Import, name: str) -> str:
    """Return the type of an imported name, including further names after dots; ? if unknown."""
    known = _object(".".join([imported.target, *name.split(".")[1:]]))
    return type(known).__name__ if known is not None else "?"


def _told(origin: Origin, kinds: list[str], asked: str, spot: Spot) -> _Told | None:
    """Return what is said of a value that was made wrong; None if there is nothing to say."""
    value = origin.value
    if isinstance(value, Import):
        return _of_import(origin, value, asked, spot)
    if origin.kind == "type" or origin.kind in _FUNCTIONS:
        return _of_what_is_not_called(origin, value)
    if isinstance(value, ast.Call):
        return _of_call(origin, value, kinds, spot)
    if origin.line == spot.line:
        return None
    if origin.kind == "NoneType":
        cause = f"Line {origin.line} sets {origin.name} to None, and nothing else sets it."
        fix = f"give it the value that line {spot.line} needs there, or write `if {origin.name} is not None:` first"
        return cause, origin.place, fix
    return _of_literal(origin, ast.unparse(value), kinds, asked)


def _of_what_is_not_called(origin: Origin, value: ast.AST) -> _Told | None:
    name, written = origin.name, ast.unparse(value)
    if name == written or isinstance(value, ast.Lambda):
        return None
    if origin.kind == "type":
        cause = f"Line {origin.line} assigns the class {written} itself to {name}, not an instance of it."
        return cause, origin.place, f"write {name} = {written}()"
    cause = f"Line {origin.line} assigns the function {written} itself to {name} without calling it."
    return cause, origin.place, f"write {name} = {written}(...), with its arguments in the parentheses"


def _of_literal(origin: Origin, written: str, kinds: list[str], asked: str) -> _Told | None:
    """Return what is said of a string, a list or the like where another type was meant."""
    name, line = origin.name, origin.line
    is_number = origin.kind == "str" and re.fullmatch(r"['\"][-+]?\d+(\.\d*)?['\"]", written) is not None
    if is_number and ({"int", "float"} & set(kinds) or kinds == ["str"]):
        cause = f"Line {line} assigns the string {written} to {name}, but a number is needed."
        return cause, origin.place, f"write {name} = {written[1:-1]}"
    meant = [kind for kind in _EMPTY if asked and hasattr(getattr(builtins, kind), asked)]
    if not meant or origin.kind not in (*_EMPTY, "tuple", "str"):
        return None
    cause = f"Line {line} makes {name} {kind_in_words(origin.kind)}, but {asked} belongs to {kind_in_words(meant[0])}."
    here = f"; or here {name}[...] = ..." if origin.kind == "dict" else ""
    return cause, origin.place, f"write {name} = {_EMPTY[meant[0]]} there{here}"


def _of_call(origin: Origin, call: ast.Call, kinds: list[str], spot: Spot) -> _Told | None:
    """Return what is said of a call that does not return what is needed."""
    name, written = origin.name, ast.unparse(call)
    store = f"{name} = " if name != written else ""
    if origin.kind == "Parameter" or (origin.kind == "ParameterValue" and not _asks_for_field(spot, name)):
        return _of_parameter(origin, call, spot)
    is_str = getattr(call.func, "id", "") == "str" and len(call.args) == 1
    if origin.kind == "str" and (({"int", "float"} & set(kinds) and store) or (kinds == ["str"] and is_str)):
        number = ast.unparse(call.args[0]) if is_str else f"float({written})"
        fix = f"write {store}{number}" if store else f"write {number} instead of {written}"
        return f"`{written}` is a string, but a number is needed.", origin.place, fix
    if "NoneType" not in kinds:
        return None
    if getattr(call.func, "attr", "") == "declare_parameter":
        cause = f"The parameter {ast.unparse(call.args[0])} is declared without a value, so {name} is None."
        return cause, origin.place, f"write {written[:-1]}, ...), with its default value"
    return of_call_that_gave_none(origin, call, spot)


def _asks_for_field(spot: Spot, written: str) -> bool:
    """Return whether a line asks a ParameterValue for one of its fields, such as `double_value`, or nearly so."""
    asked = {n.attr for n in spot.nodes if isinstance(n, ast.Attribute) and ast.unparse(n.value) == written}
    return any(name.endswith("_value") or name == "type" for name in asked)


def _of_parameter(origin: Origin, call: ast.Call, spot: Spot) -> _Told:
    written = ast.unparse(call)
    if origin.kind == "Parameter":
        cause = f"{written} is the parameter itself, with its name and type, not its value."
    else:
        cause = f"{written} is a ParameterValue, which has a field for each type and is not the value itself."
    meant = f"{written.removesuffix('.get_parameter_value()')}.value"
    if origin.name != written:
        return cause, origin.place, f"write {origin.name} = {meant}"
    old = next(
        (ast.unparse(n) for n in spot.nodes if isinstance(n, ast.Attribute) and n.value is call), written
    )
    return cause, origin.place, f"write {meant} instead of {old if old.endswith('.value') else written}"


_OF_PARAMETER = re.compile(r"\bParameterValue\b|field must be|incompatible function arguments")


def of_parameter(message: str, spot: Spot) -> Finding | None:
    """Return a finding about a line that uses the ParameterValue of a parameter as its value; else None."""
    for node in spot.whole if _OF_PARAMETER.search(message) else ():
        if not isinstance(node, (ast.Name, ast.Attribute, ast.Call)):
            continue
        origins = [*_made(spot, node)] if isinstance(getattr(node, "ctx", ast.Load()), ast.Load) else []
        is_whole = not _asks_for_field(spot, ast.unparse(node))
        if {origin.kind for origin in origins} == {"ParameterValue"} and is_whole:
            call = origins[0].value
            if isinstance(call, ast.Call):
                return Finding("made-wrong", *_of_parameter(origins[0], call, spot))
            return None
    return None


def _of_import(origin: Origin, imported: Import, asked: str, spot: Spot) -> _Told | None:
    """Return what is said of a module used instead of a name in it, or a name instead of its module."""
    name, target, known = origin.name, imported.target, _object(imported.target)
    module, _, last = target.rpartition(".")
    if isinstance(known, ModuleType):
        inner = getattr(known, last, None)
        if inner is None or (asked and not hasattr(inner, asked)):
            return None
        cause = f"{name} is the module {target}; its {last} is meant."
        return cause, origin.source.at(spot.line), f"write {_called_as(name, f'{name}.{last}', spot)}"
    if asked and hasattr(_object(module), asked):
        cause = f"As imported, {name} is only {last} from the module {module}, but {asked} is another part of that module."
        fix = f"write import {module}, and {module}.{last} wherever {last} alone is used"
        return cause, origin.place, fix
    return None


def _called_as(name: str, meant: str, spot: Spot) -> str:
    """Return the line's call that begins with a name, with another name instead."""
    calls = (ast.unparse(node) for node in spot.nodes if isinstance(node, ast.Call))
    fitting = [call for call in calls if re.match(rf"{re.escape(name)}\b", call)]
    return meant + fitting[0].removeprefix(name) if fitting else meant
