"""Locks that are acquired again while they are already held, which waits forever."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.own_functions import called_function
from ros2lab.diagnose.sources.python_source import Function, PythonSource, own_nodes, walk

# An RLock, and a Condition with its own lock, can be acquired again by the same thread; these cannot.
_ONCE = frozenset(
    ("threading.Lock", "multiprocessing.Lock", "threading.Semaphore", "threading.BoundedSemaphore")
)


def lock_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield acquisitions of a lock inside a `with` of the same lock, also in functions called there."""
    for source in sources.sources.values():
        locks = {
            ast.unparse(target)
            for node in source.nodes
            if isinstance(node, ast.Assign) and _is_lock(source, node.value)
            for target in node.targets
        }
        scoped = sources.scoped(source) if locks else ()
        for owner, node in ((owner, node) for owner, _, node in scoped if isinstance(node, ast.With)):
            for item in node.items:
                lock = ast.unparse(item.context_expr)
                held = _Held(sources, source, owner, lock)
                if lock in locks and not held.is_released(node) and (way := held.taken_again(node)):
                    yield held.finding(node, way)


def _is_lock(source: PythonSource, value: ast.expr) -> bool:
    match value:
        case ast.Call(func=function, args=[] | [ast.Constant(value=1)]):
            return source.resolve(function) in _ONCE
    return False


@dataclass(frozen=True)
class _Held:
    """A lock that is held; `owner` is None outside a class."""

    sources: NodeSources
    source: PythonSource
    owner: NodeClass | None
    lock: str

    def taken_again(self, node: ast.AST, seen: frozenset[int] = frozenset()) -> list[ast.AST]:
        """Return the calls that lead to where the lock is acquired again, and that place; or nothing."""
        for inner in own_nodes(node):
            if self._takes(inner):
                return [inner]
            function = self._called(inner)
            is_new = function is not None and id(function) not in seen
            if function is not None and is_new and (way := self.taken_again(function, seen | {id(function)})):
                return [inner, *way]
        return []

    def is_released(self, node: ast.AST) -> bool:
        """Return whether the lock is released inside a statement."""
        return any(
            ast.unparse(n) == f"{self.lock}.release" for n in walk(node) if isinstance(n, ast.Attribute)
        )

    def finding(self, node: ast.With, way: list[ast.AST]) -> Finding:
        """Say that the lock is acquired again inside a statement."""
        first, last = way[0], way[-1]
        line = f"line {getattr(last, 'lineno', 0)}"
        if isinstance(first, ast.Call) and len(way) > 1:
            name = ast.unparse(first.func)
            cause = f"{name}() is called while {self.lock} is held (line {node.lineno}), and {line} acquires {self.lock} again, so it waits forever."
            fix = f"call {name}() after the with, or write threading.RLock() instead of threading.Lock()"
        else:
            cause = f"{self.lock} is acquired again on {line} while it is already held (line {node.lineno}), so it waits forever."
            fix = f"acquire the lock only on line {node.lineno}, or write threading.RLock() instead of threading.Lock()"
        place = self.source.at(first)
        return Finding("lock-held", cause, place, fix, never=(place,))

    def _takes(self, node: ast.AST) -> bool:
        """Return whether a node acquires the lock and waits for it without a timeout."""
        match node:
            case ast.With(items=items):
                return self.lock in [ast.unparse(item.context_expr) for item in items]
            case ast.Call(func=ast.Attribute(attr="acquire", value=held), args=[], keywords=[]):
                return ast.unparse(held) == self.lock
        return False

    def _called(self, node: ast.AST) -> Function | None:
        """Return the function of the file that a node calls; None if it calls none."""
        if not isinstance(node, ast.Call):
            return None
        function = called_function(self.sources, self.source, self.owner, node.func)
        is_of_file = function in self.source.nodes and not self.lock.startswith("self.")
        return function if is_self_attribute(node.func) or is_of_file else None
