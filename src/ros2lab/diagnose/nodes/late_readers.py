"""Subscriptions that come too late for what is published once, because they ask only for new messages."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.qos_written import with_policy
from ros2lab.diagnose.sources.one_run import run_once

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
    """Return whether a publisher publishes only in the function that creates it and what that calls once."""
    source, function = end.creation.source, end.creation.function
    kept = end.creation.kept
    sends = [n for n in source.calls if ast.unparse(n.func) == f"{kept}.publish"]
    if not kept or not sends or function is None or function.name not in ("__init__", "main"):
        return False
    if _is_handed_on(end, kept.rpartition(".")[2], sends):
        return False
    once = run_once(end.sources, end.creation.owner, function, source.nodes)
    return all(id(send) in once for send in sends)


def _is_handed_on(end: End, name: str, sends: Sequence[ast.Call]) -> bool:
    """Return whether a publisher is mentioned other than to publish with it here, so that others may."""
    own = {id(getattr(send.func, "value", None)) for send in sends}
    return any(
        name in (getattr(node, "attr", ""), getattr(node, "id", ""))
        and id(node) not in own
        and isinstance(getattr(node, "ctx", None), ast.Load)
        for source in end.sources.sources.values()
        for node in source.nodes
    )
