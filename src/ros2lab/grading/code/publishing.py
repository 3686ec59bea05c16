"""What code that runs does with a publisher: whether it publishes, and repeatedly."""

from __future__ import annotations

import ast
import functools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from ros2lab.diagnose.sources.interfaces import is_interface, node_members
from ros2lab.diagnose.sources.node_source import Creation, NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, PythonSource, children, walk

# What calls a function that it is given only once; anything else may call it repeatedly.
_CALLS_ONCE = frozenset(
    ("add_done_callback", "Thread", "Timer", "submit", "register", "call_soon", "call_later")
)
_BINDS = ("partial", "partialmethod")
# Functions that only inspect their argument.
_LOOKS = frozenset(("isinstance", "len", "bool", "str", "repr", "id", "type", "print", "hasattr", "callable"))
_REPEATS = (ast.While, ast.For, ast.AsyncFor, ast.comprehension, ast.ListComp, ast.GeneratorExp)
_WAITS = ("spin", "sleep", "wait")
_CHOICES = (ast.If, ast.IfExp, ast.Match, ast.ExceptHandler)
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


@dataclass
class Rhythm:
    """How often something is published.

    Attributes:
        repeats: whether it is published repeatedly.
        begins: whether it is published as soon as the program runs, before anything calls back, and whatever holds.
    """

    repeats: bool = False
    begins: bool = False

    def add(self, other: Rhythm) -> None:
        """Add the rhythm of another place that publishes."""
        self.repeats |= other.repeats
        self.begins |= other.begins


class Publishing:
    """What the code of some files does with the publishers it creates.

    Args:
        sources: the files.
        code: the code that runs while a program lives.
    """

    def __init__(self, sources: NodeSources, code: frozenset[ast.AST]) -> None:
        self._sources = sources
        self._code = code
        self._scopes = {
            node: (source, owner, function)
            for source in sources.sources.values()
            for owner, function, node in sources.scoped(source)
        }

    def uses(self, creation: Creation) -> list[ast.Call] | None:
        """Return the calls that publish with a publisher; None if not all uses can be followed."""
        if not self._is_publish_named:
            return []
        found = list[ast.Call]()
        waiting, told = [*self._kept(creation.call)], set[str]()
        if self._is_lost(creation.call):
            return None
        while waiting:
            target = waiting.pop()
            if text_of(target) in told:
                continue
            told.add(text_of(target))
            for load in self._loads(creation, target):
                if (call := self._published(load)) is not None:
                    found += [] if self._is_gone(call, text_of(target)) else [call]
                elif self._is_lost(load):
                    return None
                else:
                    waiting += self._kept(load)
        return found

    def rhythm(self, uses: Sequence[ast.Call]) -> Rhythm:
        """Return how often these calls are made."""
        found = Rhythm()
        for call in uses:
            found.add(self._of_place(call, ()))
        return found

    def is_always_same(self, uses: Sequence[ast.Call]) -> bool:
        """Return whether these calls publish nothing but one message, with the same constants in it."""
        said = {self._constants(call) for call in uses}
        return len(said) == 1 and None not in said

    def _constants(self, call: ast.Call) -> str | None:
        """Return the code of what a call publishes, made there or in the lines before it; None if it is not constant."""
        match call.args:
            case [ast.Call() as made] if self._is_constant(made):
                return text_of(made)
            case [ast.Name(id=name)]:
                here = self._statement(call)
                function, lines = self._scope(call)[2], self._before(here)
                used = (
                    [node for node in walk(function) if getattr(node, "id", "") == name] if function else []
                )
                said = [line for line in map(self._statement, used) if line is not here]
                is_set = all(isinstance(line, ast.Assign) and line in lines for line in said)
                if said and is_set and all(self._is_constant(line.value) for line in said):  # type: ignore[attr-defined]
                    return "; ".join(map(text_of, said)).replace(name, "_")
        return None

    def _is_constant(self, value: ast.expr) -> bool:
        """Return whether an expression is made of constants and new messages alone."""
        match value:
            case ast.Call(args=[], keywords=keywords):
                return is_interface(self._made(value)) and all(self._is_constant(it.value) for it in keywords)
            case ast.UnaryOp(operand=inner):
                return self._is_constant(inner)
        return isinstance(value, ast.Constant)

    def is_destroyed(self, creation: Creation) -> bool:
        """Return whether an end is destroyed after it is created, before anything could come of it."""
        statement = self._statement(creation.call)
        names = {text_of(target) for target in self._kept(creation.call)}
        body = next((body for body in self._bodies(statement) if statement in body), [])
        for later in body[body.index(statement) + 1 :] if body else ():
            if any(_destroys(node, names) for node in walk(later)):
                return isinstance(later, ast.Expr)
            if hasattr(later, "body") or _lets_come(later):
                return False
        return False

    def _is_gone(self, call: ast.Call, name: str) -> bool:
        """Return whether a publisher is destroyed in the statements before a call, and not made again."""
        before = self._before(self._statement(call))
        ends = [
            number
            for number, earlier in enumerate(before)
            if isinstance(earlier, ast.Expr) and _destroys(earlier.value, {name})
        ]
        later = before[ends[-1] :] if ends else ()
        return bool(ends) and not any(
            text_of(node) == name and isinstance(getattr(node, "ctx", None), ast.Store)
            for earlier in later
            for node in walk(earlier)
        )

    # --- what is done with it ---------------------------------------------------------------------------

    @cached_property
    def _is_publish_named(self) -> bool:
        return any(name_read(node) == "publish" for node in self._code)

    @cached_property
    def _parents(self) -> dict[ast.AST, ast.AST]:
        return {
            child: node
            for source in self._sources.sources.values()
            for node in (source.tree, *source.nodes)
            for child in children(node)
        }

    def _scope(self, node: ast.AST) -> tuple[PythonSource | None, NodeClass | None, Function | None]:
        return self._scopes.get(node, (None, None, None))

    def _kept(self, node: ast.AST) -> list[ast.expr]:
        """Return the targets to which a node's value is assigned."""
        match self._parents.get(node):
            case ast.Assign(targets=targets):
                return targets
            case ast.AnnAssign(target=target) | ast.NamedExpr(target=target):
                return [target]
        return []

    def _is_lost(self, node: ast.AST) -> bool:
        """Return whether a value goes where we do not follow it, such as into a call."""
        if kept := self._kept(node):
            return not all(isinstance(target, (ast.Name, ast.Attribute)) for target in kept)
        match self._parents.get(node):
            case ast.Call(func=function) as call if call.func is not node:
                name = name_read(function)
                return name not in _LOOKS and not name.startswith("destroy_") and not self._says(function)
            case ast.Attribute(attr="publish"):
                return True
            case ast.BoolOp() | ast.NamedExpr() | ast.IfExp() as outer:
                return not isinstance(self._parents.get(outer), (ast.If, ast.While, ast.UnaryOp, ast.Expr))
            case parent:
                plain = (ast.Attribute, ast.Compare, ast.UnaryOp, ast.If, ast.While, ast.Expr, ast.Delete)
                return not isinstance(parent, (*plain, ast.FormattedValue, ast.Assert))

    def _says(self, function: ast.expr) -> bool:
        return isinstance(function, ast.Attribute) and "get_logger" in text_of(function)

    def _loads(self, creation: Creation, target: ast.expr) -> Iterator[ast.AST]:
        """Yield the places where code that runs loads a name or an attribute."""
        _, made_in, function = self._scope(target)
        for module in self._sources.together(creation.source.name):
            source = self._sources.sources[module]
            for owner, within, node in self._sources.scoped(source):
                if node not in self._code or name_read(node) != _last(target):
                    continue
                if isinstance(target, ast.Name) and function is not None:
                    is_taken = isinstance(node, ast.Name) and self._is_within(within, function, target.id)
                else:
                    is_taken = isinstance(target, ast.Name) or not isinstance(node, ast.Name)
                    is_taken &= self._is_same(made_in, owner, node)
                if is_taken:
                    yield node

    def _is_same(self, made_in: NodeClass | None, owner: NodeClass | None, node: ast.AST) -> bool:
        """Return whether a node may mean the same object; a self attribute only in related classes."""
        if not (is_self_attribute(node) and owner and made_in):
            return True
        lines = [{*self._sources.lineage(node_class)[0]} for node_class in (owner, made_in)]
        return not lines[0].isdisjoint(lines[1])

    def _is_within(self, within: Function | None, function: Function, name: str) -> bool:
        """Return whether a function is another one or nested in it, or that one declares the name global."""
        is_shared = any(isinstance(node, ast.Global) and name in node.names for node in walk(function))
        while within is not None and within is not function:
            within = self._scope(within)[2]
        return is_shared or within is function

    def _published(self, load: ast.AST) -> ast.Call | None:
        """Return the call of `publish` on a loaded publisher; None if it is not used for one."""
        match self._parents.get(load):
            case ast.Attribute(attr="publish") as told:
                call = self._parents.get(told)
                return call if isinstance(call, ast.Call) and call.func is told else None
        return None

    # --- how often --------------------------------------------------------------------------------------

    def _of_place(self, node: ast.AST, below: tuple[ast.AST, ...]) -> Rhythm:
        """Return how often a place in the code is reached.

        Args:
            node: the node at that place.
            below: the functions whose callers led to this place, to stop at recursion.
        """
        inner, outer, passed = node, self._parents.get(node), set[type[ast.AST]]()
        waits = self._waits_before(node)
        while outer is not None and not isinstance(outer, (ast.Lambda, *_FUNCTIONS)):
            passed.add(type(outer))
            inner, outer = outer, self._parents.get(outer)
            waits |= self._waits_before(inner)
        found = Rhythm(begins=True)
        if isinstance(outer, _FUNCTIONS):
            found = self._of_function(outer, below)
        elif outer is not None:
            found = self._of_handed(outer, below)
        found.begins &= not waits and (outer is None or passed.isdisjoint(_CHOICES))
        return found if passed.isdisjoint(_REPEATS) else Rhythm(True, found.begins)

    def _waits_before(self, node: ast.AST) -> bool:
        """Return whether a statement before this one, in the same block, may wait."""
        before = self._before(node)
        return any(_lets_come(it, _WAITS) for it in before if not isinstance(it, (*_FUNCTIONS, ast.ClassDef)))

    def _of_function(self, function: Function, below: tuple[ast.AST, ...]) -> Rhythm:
        if function in below or self._is_called_by_others(function):
            return Rhythm(True)
        owner = self._scope(function)[1]
        name = owner.definition.name if owner and function.name == "__init__" else function.name
        users = [node for node in self._code if name_read(node) == name]
        found = Rhythm(begins=not users)  # an entry point leads to it
        for node in users:
            parent = self._parents.get(node)
            is_called = isinstance(parent, ast.Call) and parent.func is node
            go_on = self._of_place if is_called else self._of_handed
            found.add(go_on(node, (*below, function)))
        return found

    def _is_called_by_others(self, function: Function) -> bool:
        """Return whether rclpy, Python, or an unknown class may call a function by its name."""
        owner = self._scope(function)[1]
        if owner is None or function.name == "__init__":
            return bool(function.decorator_list)
        is_known = self._sources.lineage(owner)[2]
        is_inherited = function.name in node_members() or function.name.startswith("__")
        return not is_known or is_inherited or bool(function.decorator_list)

    def _of_handed(self, node: ast.AST, below: tuple[ast.AST, ...]) -> Rhythm:
        """Return how often a function is called that is passed on as a value."""
        outer = self._parents.get(node)
        if isinstance(outer, ast.keyword):
            outer = self._parents.get(outer)
        if isinstance(outer, ast.ClassDef):  # a base class
            return Rhythm()
        if not isinstance(outer, ast.Call):
            return Rhythm(True)
        name = name_read(outer.func)
        if name in _BINDS:
            return self._of_handed(outer, below)
        if name in _CALLS_ONCE:
            return self._of_place(outer, below)
        return Rhythm(True)

    def _made(self, call: ast.Call) -> str:
        source = self._scope(call)[0]
        return (self._sources.resolve(source, call.func) or "") if source else ""

    def _statement(self, node: ast.AST) -> ast.AST:
        while not isinstance(node, ast.stmt) and node in self._parents:
            node = self._parents[node]
        return node

    def _before(self, node: ast.AST) -> list[ast.AST]:
        """Return what stands before a node in its block."""
        return next((body[: body.index(node)] for body in self._bodies(node) if node in body), [])

    def _bodies(self, statement: ast.AST) -> Iterator[list[ast.AST]]:
        for _, value in ast.iter_fields(self._parents.get(statement, statement)):
            if isinstance(value, list):
                yield value


@functools.lru_cache(maxsize=10_000)
def text_of(node: ast.AST) -> str:
    """Return the source text of a node; a unique label if Python cannot write it for a long number."""
    try:
        return ast.unparse(node)
    except ValueError:
        return f"#{id(node)}"


def name_read(node: ast.AST) -> str:
    """Return the name that a node loads, or looks up with `getattr`; empty if it does neither."""
    match node:
        case ast.Name(id=name, ctx=ast.Load()) | ast.Attribute(attr=name, ctx=ast.Load()):
            return name
        case ast.Call(func=ast.Name(id="getattr"), args=[_, ast.Constant(value=str(name)), *_]):
            return name
    return ""


def _last(target: ast.expr) -> str:
    """Return the last part of a name or an attribute."""
    return target.attr if isinstance(target, ast.Attribute) else getattr(target, "id", "")


def _destroys(node: ast.AST, names: set[str]) -> bool:
    match node:
        case ast.Call(func=ast.Attribute(attr="destroy", value=owner)):
            return text_of(owner) in names
        case ast.Call(func=ast.Attribute(attr="destroy_publisher" | "destroy_subscription"), args=[given]):
            return text_of(given) in names
    return False


def _lets_come(statement: ast.AST, verbs: tuple[str, ...] = (*_WAITS, "publish")) -> bool:
    """Return whether anything may be received or published in a statement, by the verbs in the names that it uses."""
    return any(name_read(node).startswith(verbs) for node in walk(statement))
