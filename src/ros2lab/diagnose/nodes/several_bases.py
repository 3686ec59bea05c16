"""Node classes with several bases, of which one is not set up: the constructor of another base does not call its own."""

from __future__ import annotations

import ast
import dis
from types import FunctionType

from ros2lab.diagnose.finding import Finding, in_a_row
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.node_source import NODE_CLASSES, NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import walk
from ros2lab.diagnose.sources.syntax_parts import calls_in, stores_in


def constructor_left_out(sources: NodeSources, owner: NodeClass) -> Finding | None:
    """Return the finding about a base class whose constructor a node never calls; None if all are called, or may be."""
    inside = calls_in(walk(owner.methods["__init__"]))
    calls = [call for call in inside if getattr(call.func, "attr", "") == "__init__"]
    reached = {_reached(sources, owner, call) for call in calls}
    if len(owner.bases) < 2 or not calls or None in reached:
        return None
    left = [name for name in owner.bases if name not in reached and _is_missed(sources, owner, name)]
    if not left:
        return None
    texts = dict(zip(owner.bases, map(ast.unparse, owner.definition.bases), strict=True))
    given = "".join(f", {ast.unparse(value)}" for value in (*calls[0].args, *calls[0].keywords))
    made = [name for name in texts if name in reached or name in left]
    each = [f"`{texts[name]}.__init__(self{given if name in NODE_CLASSES else ''})`" for name in made]
    old, there = ast.unparse(calls[0]), in_a_row([texts[name] for name in made if name not in left])
    cause = f"`{old}` runs only the constructor of {there}, which does not call that of {in_a_row([texts[name] for name in left])}."
    fix = f"write {in_a_row(each)} instead of `{old}`"
    return Finding("super-missing", cause, owner.source.at(calls[0]), fix)


def _is_missed(sources: NodeSources, owner: NodeClass, base: str | None) -> bool:
    """Return whether a base class's constructor sets what is needed: of a class of one's own, what the classes read."""
    sets = _sets(sources, base)
    if not sets or base not in sources.classes:
        return bool(sets)
    own = [sources.classes[name] for name in (owner.name, *owner.bases) if name in sources.classes]
    nodes = (n for inner in own for n in walk(inner.definition) if is_self_attribute(n))
    read = {n.attr for n in nodes if isinstance(n.ctx, ast.Load)} - owner.attributes
    return not sets.isdisjoint(read)


def _reached(sources: NodeSources, owner: NodeClass, call: ast.Call) -> str | None:
    """Return the base class whose constructor a call runs, if that calls no other one; None if it is not known."""
    match call.func:
        case ast.Attribute(value=ast.Call(func=ast.Name(id="super"), args=[])):
            first = next((base for base in owner.bases if _sets(sources, base) != frozenset()), None)
            return first if _sets(sources, first) else None
        case ast.Attribute(value=named) if call.args and ast.unparse(call.args[0]) == "self":
            name = sources.resolve(owner.source, named)
            return name if name in owner.bases else None
    return None


def _sets(sources: NodeSources, base: str | None) -> frozenset[str] | None:
    """Return the attributes that a class's constructor sets; None if it is not known, or calls that of another class."""
    module, _, name = (base or "").rpartition(".")
    if base in NODE_CLASSES:
        return frozenset(("handle",))
    if base in sources.classes:
        inner = sources.classes[base]
        nodes = [*walk(inner.methods["__init__"])] if "__init__" in inner.methods else []
        calls_on = any(getattr(n, "attr", "") == "__init__" for n in nodes)
        is_last = {*inner.bases} <= {"object", "abc.ABC"} and not calls_on
        return frozenset(n.attr for n in stores_in(nodes) if is_self_attribute(n)) if is_last else None
    library = interfaces.own_module(module) if module else None
    constructor = getattr(getattr(library, name, None), "__init__", None)
    if isinstance(constructor, FunctionType) and "super" not in constructor.__code__.co_names:
        steps = dis.get_instructions(constructor)
        return frozenset(step.argval for step in steps if step.opname == "STORE_ATTR")
    return frozenset() if constructor is object.__init__ else None
