"""How objects of one's own classes are made, where that is not by what their bodies say alone."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator

from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources
from ros2lab.diagnose.sources.python_source import Function, PythonSource, parameters, walk

_SLIP = re.compile(r"_*(?:init|int|inti)_*")
_MAKERS = frozenset(("__init__", "__new__", "__call__"))


def is_of_construction(sources: NodeSources, source: PythonSource, line: int, said: str) -> bool:
    """Return whether an objection to a line is to what a class takes that its body does not decide, or that lost its constructor.

    Args:
        sources: the files of the package.
        source: the file.
        line: of the call to which a type checker objects.
        said: what it says.
    """
    if ".__init__`" not in said:
        return False
    for one in sources.classes.values():
        if one.source is source and one.definition.lineno <= line <= (one.definition.end_lineno or 0):
            return "`object.__init__`" in said and is_mixed_in(sources, one)
    calls = (node.func for node in source.nodes if isinstance(node, ast.Call) and node.lineno == line)
    made = [
        sources.classes[name] for call in calls if (name := sources.resolve(source, call)) in sources.classes
    ]
    return any(is_made_otherwise(sources, one) or lost_constructor(sources, one) for one in made)


def is_made_otherwise(sources: NodeSources, one: NodeClass) -> bool:
    """Return whether something beside its methods decides what a class takes.

    A decorator or a metaclass may give the values itself, and a constructor may be assigned.
    """
    return any(
        _is_handed_on(inner) or any(_assigns_maker(sources, inner)) for inner in sources.lineage(one)[0]
    )


def is_mixed_in(sources: NodeSources, one: NodeClass) -> bool:
    """Return whether another class has this one as a base: whose constructor `super()` is, that other one decides."""
    return any(
        one.name == base for other in sources.classes.values() for base in other.bases if other is not one
    )


def lost_constructor(sources: NodeSources, one: NodeClass) -> Function | None:
    """Return the method that calls the constructor of the class above, in a class without one of its own."""
    if "__init__" in one.attributes or is_made_otherwise(sources, one):
        return None
    used = {
        node.attr
        for source in sources.sources.values()
        for node in source.nodes
        if isinstance(node, ast.Attribute)
    }
    slips = (method for name, method in one.methods.items() if _SLIP.fullmatch(name) and name not in used)
    if slip := next(slips, None):
        return slip
    return next(
        (method for method in one.functions if not method.name.startswith("__init_sub") and _begins(method)),
        None,
    )


def _begins(method: Function) -> bool:
    """Return whether a method does what a constructor does first: `super().__init__(...)`, or `Node.__init__(self, ...)`."""
    own = next((one.arg for one in parameters(method)), "")
    for node in walk(method):
        match node:
            case ast.Call(func=ast.Attribute(value=ast.Call(func=ast.Name(id="super")), attr="__init__")):
                return True
            case ast.Call(func=ast.Attribute(attr="__init__"), args=[ast.Name(id=first), *_]) if first == own:
                return True
    return False


def _is_handed_on(one: NodeClass) -> bool:
    """Return whether a decorator that is no part of Python, or a metaclass, has the class before who calls it."""
    wholes = [node.func if isinstance(node, ast.Call) else node for node in one.definition.decorator_list]
    wholes += [keyword.value for keyword in one.definition.keywords if keyword.arg == "metaclass"]
    names = [one.source.resolve(whole) or "" for whole in wholes]
    return any(name.partition(".")[0] not in sys.stdlib_module_names for name in names)


def _assigns_maker(sources: NodeSources, one: NodeClass) -> Iterator[bool]:
    """Yield whether each statement that may do so gives a class another constructor, or its name to another class."""
    if _MAKERS & {name for name in one.attributes if name not in one.methods}:
        yield True
    for source in sources.sources.values():
        yield from (_gives(source, node, one.name) for node in source.nodes)


def _gives(source: PythonSource, node: ast.AST, name: str) -> bool:
    match node:
        case ast.Attribute(value=value, attr=attribute, ctx=ast.Store()) if attribute in _MAKERS:
            return source.resolve(value) == name
        case ast.Call(func=ast.Name(id="setattr"), args=[value, *_]):
            return source.resolve(value) == name
        case ast.Assign(targets=[ast.Name(id=target)]):
            return f"{source.name}.{target}" == name
    return False
