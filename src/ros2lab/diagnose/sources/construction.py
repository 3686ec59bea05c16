"""How objects of the student's own classes are made if not only by the bodies of the classes, or where nothing names them."""

from __future__ import annotations

import ast
import builtins
import re
import sys
from collections.abc import Iterator, Sequence
from functools import lru_cache

from ros2lab.diagnose.sources.interfaces import is_module
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources
from ros2lab.diagnose.sources.python_source import Function, PythonSource, own_nodes, parameters, walk
from ros2lab.diagnose.sources.spelling import snake_case
from ros2lab.diagnose.sources.syntax_parts import needed_by

_SLIP = re.compile(r"_*(?:init|int|inti)_*")
_MAKERS = frozenset(("__init__", "__new__", "__call__"))
# Methods that Python itself calls, by the types that have them.
_BY_PYTHON = frozenset(
    name
    for kind in vars(builtins).values()
    if isinstance(kind, type)
    for name in dir(kind)
    if name[:2] == "__"
)


def is_node_class(source: PythonSource, named: ast.expr) -> bool:
    """Return whether an expression stands for rclpy's Node, or for a class of the file that is derived from it."""
    own = source.classes.get(ast.unparse(named))
    classes = [named, *(own.bases if own else ())]
    return any(source.resolve(node) == "rclpy.node.Node" for node in classes)


def is_of_construction(sources: NodeSources, source: PythonSource, line: int, said: str) -> bool:
    """Return whether an objection is about a class that lost its `__init__`, or is not made by it alone."""
    if ".__init__`" not in said:
        return False
    around = source.around(line, ast.ClassDef)
    for node_class in sources.classes.values():
        if node_class.definition in around:
            return "`object.__init__`" in said and is_mixed_in(sources, node_class)
    calls = (node.func for node in source.calls if node.lineno == line)
    made = [
        sources.classes[name] for call in calls if (name := sources.resolve(source, call)) in sources.classes
    ]
    return any(
        is_made_otherwise(sources, node_class) or lost_constructor(sources, node_class) for node_class in made
    )


def is_made_otherwise(sources: NodeSources, node_class: NodeClass) -> bool:
    """Return whether more than its methods decides which arguments a class takes.

    A decorator or a metaclass may pass the arguments itself, and a constructor may be assigned.
    """
    return any(
        _is_handed_on(inner) or any(_assigns_maker(sources, inner))
        for inner in sources.lineage(node_class)[0]
    )


def is_mixed_in(sources: NodeSources, node_class: NodeClass) -> bool:
    """Return whether another class has this one as a base, and so decides what `super()` means in it."""
    return any(
        node_class.name == base
        for derived in sources.classes.values()
        for base in derived.bases
        if derived is not node_class
    )


def lost_constructor(sources: NodeSources, node_class: NodeClass) -> Function | None:
    """Return the method that was meant as the constructor of a class without one; None if there is none.

    A dataclass has one that is not written, and a method that Python calls by its name is meant as what it is.
    """
    is_data = any("dataclasses.dataclass" in _wholes(inner) for inner in sources.lineage(node_class)[0])
    if "__init__" in node_class.attributes or is_data or is_made_otherwise(sources, node_class):
        return None
    used = {
        node.attr
        for source in sources.sources.values()
        for node in source.nodes
        if isinstance(node, ast.Attribute) and not _has_its_own(source, node_class, node.value)
    }
    slips = (
        method for name, method in node_class.methods.items() if _SLIP.fullmatch(name) and name not in used
    )
    if slip := next(slips, None):
        return slip
    others = (method for method in node_class.functions if method.name not in _BY_PYTHON)
    return next(filter(_begins, others), None)


def _has_its_own(source: PythonSource, node_class: NodeClass, owner: ast.expr) -> bool:
    """Return whether what an attribute is asked of is no object of a class: `super()`, a base class or a module."""
    is_super = isinstance(owner, ast.Call) and getattr(owner.func, "id", "") == "super"
    name = source.resolve(owner) or ""
    return is_super or name in node_class.bases or is_module(name)


def super_call(sources: NodeSources, owner: NodeClass, given: Sequence[ast.expr] = ()) -> str:
    """Return the call of the base class's constructor in a class of nodes, with what it passes already, if anything."""
    if given:
        return f"super().__init__({', '.join(map(ast.unparse, given))})"
    own = [parameter.arg for parameter in parameters(owner.methods["__init__"])[1:]]
    name = snake_case(owner.definition.name)
    above = next((sources.classes[base] for base in owner.bases if base in sources.classes), None)
    constructor = above.methods.get("__init__") if above else None
    wanted = ["node_name"]
    if constructor is not None:
        wanted = needed_by(constructor)
    given_name = next((parameter for parameter in own if "name" in parameter), f"'{name}'")
    texts = [asked if asked in own or "name" not in asked else given_name for asked in wanted]
    return f"super().__init__({', '.join(texts)})"


def given_to_super(constructor: Function) -> Sequence[ast.expr]:
    """Return the arguments of the call that was meant to be that of the base class's constructor."""
    for node in own_nodes(constructor):
        match node:
            case ast.Call(func=ast.Attribute(attr=name) as called):
                if "super" in ast.unparse(called) or _SLIP.fullmatch(name):
                    return [given for given in node.args if getattr(given, "id", "") != "self"]
    return ()


def _begins(method: Function) -> bool:
    """Return whether a method calls `super().__init__(...)` or `Node.__init__(self, ...)`."""
    own = next((parameter.arg for parameter in parameters(method)), "")
    for node in walk(method):
        match node:
            case ast.Call(func=ast.Attribute(value=ast.Call(func=ast.Name(id="super")), attr="__init__")):
                return True
            case ast.Call(func=ast.Attribute(attr="__init__"), args=[ast.Name(id=first), *_]) if first == own:
                return True
    return False


def _is_handed_on(node_class: NodeClass) -> bool:
    """Return whether a class has a decorator or a metaclass that is not part of Python."""
    return any(name.partition(".")[0] not in sys.stdlib_module_names for name in _wholes(node_class))


def _wholes(node_class: NodeClass) -> list[str]:
    """Return the names of the decorators and the metaclass of a class, each empty if it is not known."""
    wholes = [
        node.func if isinstance(node, ast.Call) else node for node in node_class.definition.decorator_list
    ]
    wholes += [keyword.value for keyword in node_class.definition.keywords if keyword.arg == "metaclass"]
    return [node_class.source.resolve(whole) or "" for whole in wholes]


def _assigns_maker(sources: NodeSources, node_class: NodeClass) -> Iterator[bool]:
    """Yield for each node whether it assigns a constructor to a class, or rebinds the name of the class."""
    if _MAKERS & {name for name in node_class.attributes if name not in node_class.methods}:
        yield True
    for source in sources.sources.values():
        yield from (_gives(source, node, node_class.name) for node in source.nodes)


def _gives(source: PythonSource, node: ast.AST, name: str) -> bool:
    match node:
        case ast.Attribute(value=value, attr=attribute, ctx=ast.Store()) if attribute in _MAKERS:
            return source.resolve(value) == name
        case ast.Call(func=ast.Name(id="setattr"), args=[value, *_]):
            return source.resolve(value) == name
        case ast.Assign(targets=[ast.Name(id=target)]):
            return f"{source.name}.{target}" == name
    return False


_BUILTINS = frozenset(dir(builtins))
# What finds something by a text, and the position of that text; -1 for what gives all that there is.
_BY_TEXT = {"getattr": 1, "attrgetter": 0, "methodcaller": 0, "__getattribute__": 0, "eval": 0, "exec": 0}
_BY_TEXT |= dict.fromkeys(("globals", "vars", "dir", "getmembers"), -1)


def may_be_made_unseen(sources: NodeSources, owner: NodeClass) -> bool:
    """Return whether code that does not name a class may still instantiate it.

    Code outside the package may, if a decorator, a metaclass or an unknown base gives it the class. The package's
    own code may, if it calls a value that can be any class: an item of a registry, or the variable of a loop.
    """
    is_known = sources.lineage(owner)[2]
    return not is_known or is_made_otherwise(sources, owner) or _calls_any_value(sources)


def may_run(sources: NodeSources, source: PythonSource, owner: NodeClass | None) -> bool:
    """Return whether an executable may run a file and, if it is in a class, create that class."""
    if not sources.may_import(source):
        return False
    return owner is None or sources.is_named(owner) or may_be_made_unseen(sources, owner)


@lru_cache(maxsize=16)
def _calls_any_value(sources: NodeSources) -> bool:
    files = sources.sources.values()
    return any(not _is_known(source, call.func) for source in files for call in source.calls)


def _is_known(source: PythonSource, called: ast.expr) -> bool:
    """Return whether a called expression stands for one function or class, which its name tells."""
    if isinstance(called, ast.Name):
        return (
            called.id in _BUILTINS
            or source.resolve(called) is not None
            or any(isinstance(node, Function) and node.name == called.id for node in source.nodes)
        )
    if isinstance(called, ast.Attribute):
        return ast.unparse(called) not in source.stored
    return isinstance(called, ast.Lambda)


def looks_up(node: ast.AST) -> bool:
    """Return whether a node finds a function or a class by a computed name, or goes through all of them."""
    match node:
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name), args=args) if name in _BY_TEXT:
            at = _BY_TEXT[name]
            return at < 0 or not isinstance(next(iter(args[at:]), None), ast.Constant)
        case ast.Attribute(attr="__dict__"):
            return True
    return False
