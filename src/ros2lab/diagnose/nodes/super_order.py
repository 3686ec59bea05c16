"""What a node's constructor owes its base classes: which of their constructors it runs, and what it uses before."""

from __future__ import annotations

import ast
import dis
from collections.abc import Iterator, Sequence
from types import FunctionType

from ros2lab.diagnose.finding import Finding, in_a_row, lines_in_words
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.node_source import NODE_CLASSES, NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.one_run import blocks, heads, runs_of
from ros2lab.diagnose.sources.own_functions import called_function
from ros2lab.diagnose.sources.python_source import own_nodes, walk
from ros2lab.diagnose.sources.syntax_parts import calls_in, stores_in


class SuperOrder:
    """The order of a constructor's statements, in which each branch calls super().__init__() by itself."""

    def __init__(self, sources: NodeSources, owner: NodeClass, inherited: frozenset[str]) -> None:
        self._sources, self._owner, self._inherited = sources, owner, inherited
        self.constructor = owner.methods["__init__"]
        self._early: list[ast.Attribute] = []
        runs_of(self.constructor.body, False, self._is_made, any, self._may_be_made)

    def calls_init(self) -> bool:
        """Return whether the constructor calls super().__init__() itself or by another function."""
        return any(self._is_init(node) for node in walk(self.constructor))

    def first_early(self) -> tuple[ast.Attribute, str] | None:
        """Return the first use before super().__init__() on every way to it, and what to move; None if there is none."""
        return next(((use, fix) for use in self._early if (fix := self._moved(use))), None)

    def _is_init(self, node: ast.AST, depth: int = 0) -> bool:
        """Return whether a node is a call of `__init__`, or of a function of the package that calls it."""
        if not isinstance(node, ast.Call):
            return False
        if getattr(node.func, "attr", "") == "__init__":
            return True
        called = called_function(self._sources, self._owner.source, self._owner, node.func)
        return (
            called is not None and depth < 3 and any(self._is_init(n, depth + 1) for n in own_nodes(called))
        )

    def _is_made(self, is_made: bool, statement: ast.stmt) -> bool:
        """Collect the early uses in a statement, and return whether the node is made after what it evaluates itself."""
        nodes = [node for head in heads(statement) for node in walk(head)]
        is_made = is_made or any(map(self._is_init, nodes))
        self._early += [] if is_made else self._uses(nodes)
        return is_made

    def _may_be_made(self, is_made: bool, statement: ast.stmt, number: int) -> bool:
        """Return whether the node may be made where a branch begins: what a `try` or a loop has done before may have made it."""
        is_open = isinstance(statement, (ast.For, ast.AsyncFor, ast.While))
        is_open |= isinstance(statement, ast.Try) and number > 0
        return is_made or (is_open and any(map(self._is_init, walk(statement))))

    def _uses(self, nodes: Sequence[ast.AST]) -> Iterator[ast.Attribute]:
        hidden = {id(n) for node in nodes if isinstance(node, ast.Lambda) for n in walk(node)}
        for node in nodes:
            if not is_self_attribute(node) or id(node) in hidden or not isinstance(node.ctx, ast.Load):
                continue
            if node.attr in self._inherited - self._owner.attributes:
                yield node

    def _moved(self, use: ast.Attribute) -> str:
        """Return what to move so that super().__init__() comes before a use; empty if no call of it comes later."""
        for block, index in reversed([*_blocks_around(self.constructor.body, use)]):
            for later in block[index + 1 :]:
                calls = [n for n in calls_in(walk(later)) if self._is_init(n)]
                if not calls:
                    continue
                first, call = block[index], calls[0]
                before = (n for s in block[index : block.index(later)] for n in walk(s))
                between = {*map(ast.unparse, stores_in(before))}
                is_needed = any(
                    ast.unparse(n) in between for n in walk(call) if isinstance(n, (ast.Name, ast.Attribute))
                )
                if isinstance(later, ast.Expr) and later.value is call and not is_needed:
                    is_direct = getattr(call.func, "attr", "") == "__init__"
                    what = "the call of super().__init__()" if is_direct else f"`{ast.unparse(call)}`"
                    return f"move {what} from line {call.lineno} up to above line {first.lineno}"
                lines = lines_in_words(first.lineno, first.end_lineno or first.lineno)
                return f"move {lines} down to below line {later.end_lineno}"
        return ""


def _blocks_around(block: Sequence[ast.stmt], node: ast.AST) -> Iterator[tuple[Sequence[ast.stmt], int]]:
    """Yield the blocks around a node, the outermost first, each with the place of the statement around it."""
    for index, statement in enumerate(block):
        if any(inner is node for inner in walk(statement)):
            yield block, index
            parts = (statement, *getattr(statement, "handlers", ()), *getattr(statement, "cases", ()))
            for branch in (block for part in parts for block in blocks(part)):
                yield from _blocks_around(branch, node)


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
