"""Objects of which only a base class is known: what the base class lacks, their own class may have."""

from __future__ import annotations

import ast
import builtins
import sys
from collections.abc import Collection, Iterable, Iterator

from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.class_trees import classes_below
from ros2lab.diagnose.sources.python_source import PythonSource, walk
from ros2lab.diagnose.sources.syntax_parts import calls_in

_OF_METHODS = frozenset(
    ("missing-argument", "too-many-positional-arguments", "unknown-argument", "invalid-argument-type")
)
_OPERATORS = "__"  # how the names of the methods that Python calls begin
_SETS_BY_NAME = ("setattr", "__getattr__", "__dict__")


def asked_of(rule: str, said: str, owner: str, name: str) -> tuple[str, str]:
    """Return the class whose member the type checker misses, and the member; empty if it is of another kind."""
    kind, _, method = owner.rpartition(".")
    if rule == "missing-attribute" and said.startswith("Object of type") and owner.isidentifier():
        return owner, name
    if rule in ("unsupported-operator", "not-callable") and owner.isidentifier():
        return owner, _OPERATORS
    is_method = rule in _OF_METHODS and kind and method != "__init__"
    return (kind.rpartition(".")[2], method) if is_method else ("", "")


def may_be_of_subclass(kind: str, name: str, spot: Spot, sources: Iterable[PythonSource]) -> bool:
    """Return whether an object on a line may be of a class below the one that the type checker names.

    A hint, a handler, an `isinstance` and the result of a function tell only a base class. It is the class itself
    where the file makes the object, and where no class below it is known to have what it lacks.
    """
    values = [n.value for n in spot.nodes if isinstance(n, ast.Attribute) and n.attr == name]
    classes = [node for source in sources for node in source.nodes if isinstance(node, ast.ClassDef)]
    own = {definition.name for definition in classes}
    if not kind or (values and all(_is_made(spot, value, {kind, *own}) for value in values)):
        return False
    around = spot.source.class_at(spot.line) if spot.source else None
    if around and {*map(ast.unparse, values)} == {"self"}:
        return _is_given_below(around.name, name, classes)
    return _is_given_below(kind, name, classes) or (
        kind not in own and _is_given_in_library(spot, kind, name)
    )


def _is_made(spot: Spot, value: ast.expr, kinds: Collection[str]) -> bool:
    """Return whether an expression makes an instance of a class, or names what holds nothing else."""
    text = ast.unparse(value)
    made = [value] if isinstance(value, ast.Call) else spot.assigned(text)
    bound = [node for node in (spot.source.nodes if spot.source else ()) if _binds(node, text)]
    is_all = isinstance(value, ast.Call) or len(bound) == len(made)
    called = [ast.unparse(node.func).rpartition(".")[2] for node in calls_in(made)]
    return bool(made) and is_all and len(called) == len(made) and {*called} <= {*kinds}


def _binds(node: ast.AST, text: str) -> bool:
    """Return whether a syntax node gives a name or an attribute its value: an assignment, a parameter, a handler."""
    match node:
        case ast.arg(arg=name) | ast.ExceptHandler(name=name):
            return name == text
    return isinstance(getattr(node, "ctx", None), ast.Store) and ast.unparse(node) == text


def _is_given_below(kind: str, name: str, classes: Collection[ast.ClassDef]) -> bool:
    """Return whether a class of the workspace below another one has a name, or may have any."""
    below, above = {kind, *_library_below(kind)}, set[str]()
    while more := {c.name for c in classes if below & _bases(c)} - below:
        below |= more
    derived = [c for c in classes if c.name in below - {kind}]
    while more := {base for c in classes if c in derived or c.name in above for base in _bases(c)} - above:
        above |= more  # what a class inherits from others than the one that is named
    return any(_gives(c, name) for c in classes if c in derived or c.name in above - {kind})


def _bases(definition: ast.ClassDef) -> set[str]:
    return {ast.unparse(base).partition("[")[0].rpartition(".")[2] for base in definition.bases}


def _gives(definition: ast.ClassDef, name: str) -> bool:
    names = {found for node in walk(definition) for found in _names(node)}
    operators = [found for found in names if found.startswith(_OPERATORS) and found != "__init__"]
    is_there = bool(operators) if name == _OPERATORS else name in names
    return is_there or any(word in ast.dump(definition) for word in _SETS_BY_NAME)


def _names(node: ast.AST) -> Iterator[str]:
    match node:
        case ast.Attribute(attr=name, ctx=ast.Store()) | ast.Name(id=name, ctx=ast.Store()):
            yield name
        case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name):
            yield name


def _library_below(kind: str) -> list[str]:
    return classes_below(kind, "rclpy") if interfaces.inner_homes_of(kind) else []


def _is_given_in_library(spot: Spot, kind: str, name: str) -> bool:
    """Return whether a class of Python or of ROS below another one may have a name.

    Of other libraries nothing is known, nor of who derives an exception from one of Python's.
    """
    if found := getattr(builtins, kind, None):
        return isinstance(found, type) and issubclass(found, BaseException)
    if own := [*_of_python(spot, kind)]:
        return any(_has(below, name) for known in own for below in known.__subclasses__())
    if name == _OPERATORS:
        return False
    if interfaces.homes_of(kind) or interfaces.inner_homes_of(kind) or interfaces.launch_homes_of(kind):
        return any(
            name in interfaces.members_of(home, below)
            for below in _library_below(kind)
            if below != kind
            for home in interfaces.inner_homes_of(below)
        )
    return True


def _of_python(spot: Spot, kind: str) -> Iterator[type[object]]:
    """Yield the classes of a name in the modules of Python that the file imports."""
    for imported in spot.source.imports if spot.source else ():
        for module in (imported.target, imported.target.rpartition(".")[0]):
            if module and module.partition(".")[0] in sys.stdlib_module_names:
                found = getattr(interfaces.own_module(module), kind, None)
                if isinstance(found, type):
                    yield found


def _has(kind: type[object], name: str) -> bool:
    """Return whether a class of Python, or one below it, has an attribute, or sets it in one of its methods."""
    made = (getattr(method, "__code__", None) for method in vars(kind).values())
    is_set = any(name in code.co_names for code in made if code is not None)
    fields = getattr(kind, "_fields", ())
    return (
        hasattr(kind, name)
        or is_set
        or name in fields
        or any(_has(below, name) for below in kind.__subclasses__())
    )
