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
    texts = {name: ast.unparse(node) for name, node in zip(owner.bases, owner.definition.bases, strict=True)}
    calls = [
        n for n in calls_in(walk(owner.methods["__init__"])) if getattr(n.func, "attr", "") == "__init__"
    ]
    reached = {_reached(sources, owner, call) for call in calls}
    if len(texts) < 2 or not calls or None in reached:
        return None
    own = {name: sources.classes[name] for name in (owner.name, *texts) if name in sources.classes}
    nodes = (n for inner in own.values() for n in walk(inner.definition) if is_self_attribute(n))
    read = {n.attr for n in nodes if isinstance(n.ctx, ast.Load)} - owner.attributes
    sets = {name: _sets(sources, name) or frozenset() for name in texts.keys() - reached}
    left = [name for name in texts if (new := sets.get(name)) and (name not in own or new & read)]
    if not left:
        return None
    given = "".join(f", {ast.unparse(value)}" for value in (*calls[0].args, *calls[0].keywords))
    made = [name for name in texts if name in reached or name in left]
    each = [f"`{texts[name]}.__init__(self{given if name in NODE_CLASSES else ''})`" for name in made]
    old, there = ast.unparse(calls[0]), in_a_row([texts[name] for name in made if name not in left])
    cause = f"`{old}` runs only the constructor of {there}, which does not call that of {in_a_row([texts[name] for name in left])}."
    return Finding(
        "super-missing", cause, owner.source.at(calls[0]), f"write {in_a_row(each)} instead of `{old}`"
    )


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
