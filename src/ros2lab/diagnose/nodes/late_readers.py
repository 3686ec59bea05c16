"""Subscriptions that come too late for what is published once, because they ask only for new messages."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.qos_written import with_policy
from ros2lab.diagnose.sources.one_run import is_always_reached, run_once
from ros2lab.diagnose.sources.python_source import Function, own_nodes, walk
from ros2lab.diagnose.sources.uses import uses_of

if TYPE_CHECKING:
    from ros2lab.diagnose.nodes.partners import Partners
    from ros2lab.diagnose.nodes.topic_faults import End

_LATCHED, _NEW_ONLY = "TRANSIENT_LOCAL", "VOLATILE"


def late_readers(topic: str, there: Sequence[End], partners: Partners) -> Iterator[Finding]:
    """Yield subscriptions that do not ask for the messages that a publisher keeps for those who come later."""
    kept = [
        end
        for end in there
        if end.is_publisher and end.qos.get("durability") == _LATCHED and _sends_once(end)
    ]
    if not kept or len(kept) != len([end for end in there if end.is_publisher]):
        return
    for listener in there:
        is_other = all(
            listener.creation.owner is not end.creation.owner
            and listener.type == end.type
            and partners.are_together(listener, end, there)
            for end in kept
        )
        if is_other and not listener.is_publisher and listener.qos.get("durability") == _NEW_ONLY:
            if partners.may_be_elsewhere(topic):
                return
            cause = f"{kept[0].creation.source.shown} publishes on {topic!r} only once, when it starts, and keeps that message for subscribers that come later; this one asks only for new messages, so it receives nothing if it starts after that."
            yield Finding(
                "qos-mismatch", cause, listener.place, with_policy(listener, "durability", _LATCHED)
            )


def _sends_once(end: End) -> bool:
    """Return whether a publisher publishes only in the function that creates it, in what that calls once, or in a timer for one call."""
    kept, creation = end.creation.kept, end.creation
    is_at_start = creation.function is not None and creation.function.name in ("__init__", "main")
    nodes = [*_its_users(end)] if is_at_start and kept else []
    sends = [n for n in nodes if isinstance(n, ast.Call) and ast.unparse(n.func) == f"{kept}.publish"]
    own = {id(send.func.value) for send in sends if isinstance(send.func, ast.Attribute)}
    if not sends or any(id(n) not in own and _names(n, kept) for n in nodes):
        return False
    functions = [creation.function, *_called_once(end, nodes)]
    once = set[int]().union(*(run_once(end.sources, creation.owner, f, nodes) for f in functions if f))
    return all(id(send) in once for send in sends)


def _its_users(end: End) -> Iterator[ast.AST]:
    """Yield all syntax nodes that may publish with a publisher; none if code elsewhere names it, too."""
    sources, owner, name = end.sources, end.creation.owner, end.creation.kept.rpartition(".")[2]
    if owner is None or not end.creation.kept.startswith("self."):
        yield from walk(end.creation.function or end.creation.source.tree)
    elif name not in uses_of(sources).read_of_others:
        for other in sources.classes.values():
            if owner in sources.lineage(other)[0] or other in sources.lineage(owner)[0]:
                yield from walk(other.definition)


def _names(node: ast.AST, kept: str) -> bool:
    is_read = isinstance(node, (ast.Name, ast.Attribute)) and isinstance(node.ctx, ast.Load)
    return is_read and ast.unparse(node) == kept


def _called_once(end: End, nodes: Sequence[ast.AST]) -> Iterator[Function]:
    """Yield the callbacks of timers that are made where a publisher is, and that they end at once."""
    for timer, callback in end.sources.callbacks():
        if timer.method == "create_timer" and timer.function is end.creation.function and timer.kept:
            ends = (f"{timer.kept}.cancel()", f"self.destroy_timer({timer.kept})")
            stops = [n for n in own_nodes(callback) if isinstance(n, ast.Call) and ast.unparse(n) in ends]
            is_named = sum(getattr(n, "attr", "") == callback.name for n in nodes) > 1
            if not is_named and any(is_always_reached(callback, stop) for stop in stops):
                yield callback
