"""What a node's constructor uses before it has called super().__init__()."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.finding import lines_in_words
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
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
