"""Which of the definitions in a package's files are read, called or changed."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterator
from functools import cached_property, lru_cache

from ros2lab.diagnose.sources.interfaces import node_members
from ros2lab.diagnose.sources.node_source import (
    LOG_METHODS,
    Creation,
    NodeClass,
    NodeSources,
    is_self_attribute,
)
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    assignments,
    given_to,
    last_name,
    own_nodes,
    walk,
)
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import own_parameters

LONGEST_NAME = 200  # characters of a string that may name something
# What others get a copy of, or all of it, at once: a later change is not in it.
SENDS = frozenset(("publish", "call", "call_async", "send_goal", "send_goal_async", "publish_feedback"))
SENDS |= {"sendTransform"}


class Uses:
    """The names that a package's files read."""

    def __init__(self, sources: NodeSources) -> None:
        self.sources = sources
        self.named: Counter[str] = Counter()  # as written: names, attributes, and words in strings
        self.resolved: Counter[str] = Counter()  # the package's own names, with their modules
        for source in sources.sources.values():
            for node in source.nodes:
                self.named.update(named(node))
                if isinstance(node, (ast.Name, ast.Attribute)):
                    self.resolved[sources.resolve(source, node) or ""] += 1

    @cached_property
    def nodes(self) -> tuple[ast.AST, ...]:
        """All syntax nodes of the files."""
        return tuple(node for source in self.sources.sources.values() for node in source.nodes)

    @cached_property
    def senders(self) -> frozenset[str]:
        """The methods that give what they take to others at once, without the names of those that the files define."""
        functions = (node for node in self.nodes if isinstance(node, Function))
        return SENDS.difference(function.name for function in functions if own_parameters(function))

    @cached_property
    def stored_of_others(self) -> frozenset[str]:
        """The attributes assigned on objects other than `self`, which may be nodes, too."""
        return frozenset(
            node.attr
            for node in self.nodes
            if isinstance(node, ast.Attribute) and not isinstance(node.ctx, ast.Load)
            if not (dotted(node) or "").startswith("self.")
        )

    @cached_property
    def read_of_others(self) -> frozenset[str]:
        """The attributes read from objects other than `self`, also by `getattr()` and the like."""
        found = set()
        for node in self.nodes:
            if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load):
                found |= set() if is_self_attribute(node) else {node.attr}
            elif isinstance(node, ast.Call) and "attr" in last_name(node.func):
                given = [str(given.value) for given in node.args if isinstance(given, ast.Constant)]
                found |= {name for text in given for name in text.split(".")}
        return frozenset(found)

    @cached_property
    def callbacks(self) -> dict[int, list[Creation]]:
        """The callbacks and the methods that they call, by `id`, each with the calls that passed it to ROS."""
        found: dict[int, list[Creation]] = {}
        owners = {
            id(m): node_class
            for node_class in self.sources.classes.values()
            for m in node_class.methods.values()
        }
        waiting = [*self.sources.callbacks()]
        while waiting:
            creation, function = waiting.pop()
            if creation in found.setdefault(id(function), []):
                continue
            found[id(function)].append(creation)
            for node in own_nodes(function):
                called = node.func if isinstance(node, ast.Call) else None
                if is_self_attribute(called):
                    method = self.sources.method(owners.get(id(function)), called.attr)
                    waiting += [(creation, method)] if method is not None else []
        return found


def named(node: ast.AST) -> Iterator[str]:
    """Yield the names that a syntax node reads, and the words in a string."""
    if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
        yield node.id
    elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load):
        yield node.attr
    elif isinstance(node, ast.Constant) and isinstance(node.value, str) and len(node.value) < LONGEST_NAME:
        yield from re.findall(r"\w+", node.value)


class State:
    """The attributes of a node class, as written (`self.msg.data`), and where they are read and assigned."""

    def __init__(self, uses: Uses, owner: NodeClass) -> None:
        self.uses, self.owner, self.source = uses, owner, owner.source
        family = [
            node_class
            for node_class in uses.sources.classes.values()
            if owner in uses.sources.lineage(node_class)[0] or node_class in uses.sources.lineage(owner)[0]
        ]
        self.stores: dict[str, list[tuple[Function, ast.AST, ast.expr | None]]] = {}
        self.loads: dict[str, list[tuple[Function, ast.AST]]] = {}
        self._sources: dict[int, PythonSource] = {}
        for member, method in (
            (node_class, function) for node_class in family for function in node_class.functions
        ):
            values = values_in(method)
            for node in walk(method):
                self._sources[id(node)] = member.source
                if isinstance(node, ast.Attribute) and (text := dotted(node) or "").startswith("self."):
                    if isinstance(node.ctx, ast.Store):
                        self.stores.setdefault(text, []).append((method, node, values.get(id(node))))
                    else:
                        self.loads.setdefault(text, []).append((method, node))
        self.read = {*(text.split(".")[1] for text in self.loads), *uses.read_of_others}

    def at(self, node: ast.AST | None) -> str:
        """Return the place of a syntax node in the class, its bases or the classes derived from it."""
        return self._sources.get(id(node), self.source).at(node)

    def changing_in_place(self, text: str) -> Iterator[Function]:
        """Yield the methods that may change what an attribute holds: an item, a field, or by a call only made for that."""
        for method in {id(method): method for method, _ in self.loads.get(text, ())}.values():
            if any(text in map(dotted, _changed_by(node)) for node in walk(method)):
                yield method

    def first(self, text: str) -> ast.expr | None:
        """Return what `__init__` assigns to an attribute; None if code outside the class may assign it."""
        values = [value for method, _, value in self.stores.get(text, ()) if method.name == "__init__"]
        name = text.rpartition(".")[2]
        others = [stored for stored in self.stores if stored.endswith(f".{name}") and stored != text]
        is_own = name not in self.uses.stored_of_others and not others
        return values[0] if len(values) == 1 and is_own else None

    def initial(self, text: str) -> ast.expr | None:
        """Return what `__init__` assigns to an attribute; None if it is assigned anywhere else."""
        return self.first(text) if len(self.stores.get(text, ())) == 1 else None

    def later(self, text: str) -> list[tuple[Function, ast.AST, ast.expr | None]]:
        """Return the assignments to an attribute outside `__init__`."""
        return [store for store in self.stores.get(text, ()) if store[0].name != "__init__"]

    def changes(self, text: str) -> str:
        """Return the name of a callback that assigns an attribute; empty if there is none."""
        return next(
            (method.name for method, *_ in self.stores.get(text, ()) if id(method) in self.uses.callbacks), ""
        )


def _changed_by(node: ast.AST) -> list[ast.expr]:
    """Return the expressions whose objects a syntax node may change."""
    match node:
        case ast.Attribute(value=value) | ast.Subscript(value=value) if not isinstance(node.ctx, ast.Load):
            return [value]
        case ast.Expr(value=ast.Call(func=ast.Attribute(value=value, attr=how)) as call) if not is_log(call):
            return [value, *(given_to(call) if how != "publish" else ())]
        case ast.Expr(value=ast.Call() as call) if not is_log(call):
            return given_to(call)
    return []


def own_stores(scope: ast.AST) -> set[str]:
    """Return the attributes of `self` that a scope assigns."""
    return {n.attr for n in walk(scope) if is_self_attribute(n) and isinstance(n.ctx, ast.Store)}


def own_changes(scope: ast.AST) -> set[str]:
    """Return the attributes of `self` that a scope assigns, or of which it may change what they hold."""
    held = (expression for node in walk(scope) for expression in _changed_by(node))
    return own_stores(scope).union(node.attr for node in held if is_self_attribute(node))


def free_name(owner: NodeClass, wished: str) -> str:
    """Return a name that neither a node nor the class has: the one that is wished, or it with underscores after it."""
    taken = node_members() | owner.attributes
    taken |= {node.attr for node in walk(owner.definition) if is_self_attribute(node)}
    while wished in taken:
        wished += "_"
    return wished


def values_in(function: Function) -> dict[int, ast.expr]:
    """Return the value assigned to each target in a function, by the `id` of the target."""
    return {id(target): value for target, value in assignments(walk(function))}


def is_log(node: ast.AST) -> bool:
    """Return whether a node is a call that only prints or logs."""
    return isinstance(node, ast.Call) and (
        getattr(node.func, "id", "") == "print" or getattr(node.func, "attr", "") in LOG_METHODS
    )


def filled(function: Function) -> Iterator[tuple[str, ast.expr]]:
    """Yield the fields that a function assigns on local messages, each with its value."""
    for target, value in assignments(own_nodes(function)):
        if isinstance(target, ast.Attribute) and not (text := ast.unparse(target)).startswith("self."):
            yield text, value


@lru_cache(maxsize=16)
def uses_of(sources: NodeSources) -> Uses:
    """Return what a package's files read, call and change; found once for all rules."""
    return Uses(sources)
