"""Callbacks that publish on the topic they listen to, and what a callback does each time it is called."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import PAUSES, Function, own_nodes, walk
from ros2lab.diagnose.sources.syntax_parts import calls_in, stores_in

if TYPE_CHECKING:
    from ros2lab.diagnose.nodes.topic_faults import End

_DEEPEST = 5  # methods that are followed from one to the next


def answers_itself(topic: str, there: Sequence[End]) -> Iterator[Finding]:
    """Yield callbacks that always publish on the topic they listen to, and so call themselves endlessly."""
    for listener in (end for end in there if not end.is_publisher and end.type):
        sources, creation = listener.sources, listener.creation
        callback = sources.function_of(creation, creation.given("callback"))
        calls = dict(called_always(sources, creation.owner, callback)) if callback else {}
        for end in there:
            is_alike = (end.type, end.is_absolute) == (listener.type, listener.is_absolute)
            is_own = (
                creation.owner is not None and end.creation.owner is creation.owner and _is_kept_alone(end)
            )
            sent = (
                calls.get(f"{end.creation.kept}.publish")
                if end.is_publisher and is_alike and is_own
                else None
            )
            if sent is not None:
                cause = f"The callback of {topic} publishes on {topic}, so the node receives its own messages and answers them endlessly."
                line = end.place.rpartition(":")[2]
                fix = f"write another topic on line {line}, or publish only under a condition that eventually becomes false"
                yield Finding("endless-loop", cause, creation.source.at(sent), fix)


def called_always(
    sources: NodeSources, owner: NodeClass | None, function: Function, depth: int = 0
) -> Iterator[tuple[str, ast.Call]]:
    """Yield the calls that a function always makes, also by methods of its own; none if it may end early."""
    leaves = (ast.Return, ast.Raise, *PAUSES)
    ends = ("destroy", "shutdown", "exit", "cancel")
    for node in own_nodes(function):
        called = ast.unparse(node.func) if isinstance(node, ast.Call) else ""
        if isinstance(node, leaves) or any(word in called for word in ends):
            return
    waiting = list(reversed(function.body))
    while waiting:
        statement = waiting.pop()
        if isinstance(statement, (ast.With, ast.Try)):
            waiting += reversed(statement.body)
        elif isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call):
            call = statement.value
            yield ast.unparse(call.func), call
            method = sources.method(owner, call.func.attr) if is_self_attribute(call.func) else None
            if method is not None and depth < _DEEPEST:
                yield from called_always(sources, owner, method, depth + 1)


def by_variable(ends: Sequence[End]) -> dict[tuple[Function, str], list[End]]:
    """Group the ends whose topic is known only at run time by their function and the topic's expression."""
    found: dict[tuple[Function, str], list[End]] = {}
    for end in ends:
        written, function = end.creation.given("topic"), end.creation.function
        if not end.topic and written is not None and function is not None and _is_stable(written, function):
            found.setdefault((function, ast.unparse(written)), []).append(end)
    return found


def _is_stable(written: ast.expr, function: Function) -> bool:
    """Return whether an expression has the same value wherever a function contains it."""
    stored = [ast.unparse(node) for node in stores_in(own_nodes(function))]
    names = [node.id for node in ast.walk(written) if isinstance(node, ast.Name)]
    calls = [ast.unparse(node.func) for node in calls_in(ast.walk(written))]
    # What a node's own `get_` returns, such as a parameter, stays.
    return all(stored.count(name) < 2 for name in names) and all(".get_" in call for call in calls)


def _is_kept_alone(end: End) -> bool:
    """Return whether nothing else is assigned to what a publisher is kept as."""
    owner, kept = end.creation.owner, end.creation.kept
    stored = stores_in(walk(owner.definition)) if owner else ()
    return [*map(ast.unparse, stored)].count(kept) == 1
