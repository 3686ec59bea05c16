"""Calls that create a publisher, a timer and the like with their arguments in the wrong order."""

from __future__ import annotations

import ast
from collections.abc import Mapping

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.node_source import CREATORS, Creation, NodeSources

EXAMPLES = {
    "create_publisher": "create_publisher(String, 'topic', 10)",
    "create_subscription": "create_subscription(String, 'topic', self.callback, 10)",
    "create_timer": "create_timer(1.0, self.callback)",
    "create_service": "create_service(Trigger, 'name', self.callback)",
    "create_client": "create_client(Trigger, 'name')",
}


def order_fault(sources: NodeSources, creation: Creation) -> Finding | None:
    """Return the finding for arguments in the wrong order, judging by their kinds; None if they fit."""
    wanted = {"topic": "text", "srv_name": "text", "msg_type": "type", "srv_type": "type"}
    wanted |= {"callback": "function", "qos_profile": "number", "timer_period_sec": "number"}
    kinds = {name: _kind(sources, creation, value) for name, value in (creation.arguments or {}).items()}
    wrong = [name for name, kind in kinds.items() if kind and name in wanted and kind != wanted[name]]
    for value in (creation.arguments or {}).values():
        inner = value
        while isinstance(inner, ast.Attribute):
            inner = inner.value
        if isinstance(inner, ast.Constant) and isinstance(inner.value, (int, float)) and inner is not value:
            text = ast.unparse(value)
            number = ast.unparse(inner)
            cause = f"In `{text}` there is a dot where a comma should be."
            fix = f"write {number}, {text.removeprefix(number).removeprefix('.')}"
            return Finding("dot-for-comma", cause, creation.source.at(value), fix)
    missing = [name for name in CREATORS[creation.method] if name not in kinds]
    # One argument of the wrong kind may be just that; two are swapped, or one before them is missing.
    if (
        len(wrong) < 2
        and not _is_displaced(creation, wanted, kinds, wrong)
        and not (wrong == ["callback"] and missing == ["qos_profile"] and kinds["callback"] != "number")
    ):
        return None
    cause = f"The arguments of {creation.method} are in the wrong order, or one is missing: {' and '.join(wrong)} {'do' if len(wrong) > 1 else 'does'} not belong there."
    fix = (
        _in_order(sources, creation, wanted, kinds)
        or f"write them in the order of {EXAMPLES[creation.method]}"
    )
    return Finding("argument-order", cause, creation.source.at(creation.call), fix)


def _is_displaced(
    creation: Creation, wanted: Mapping[str, str], kinds: Mapping[str, str | None], wrong: list[str]
) -> bool:
    """Return whether the place of the only misplaced argument is taken by one of no known kind."""
    if len(wrong) != 1 or kinds[wrong[0]] is None:
        return False
    given = (creation.arguments or {})[wrong[0]]
    is_type = interfaces.homes_of(str(getattr(given, "value", "")))  # only quotes too many
    homes = [name for name in CREATORS[creation.method] if wanted[name] == kinds[wrong[0]]]
    return not is_type and any(name in kinds and kinds[name] is None for name in homes)


def _in_order(
    sources: NodeSources, creation: Creation, wanted: Mapping[str, str], kinds: Mapping[str, str | None]
) -> str:
    """Say how to write a call with its own arguments in order; empty if one of them fits nowhere.

    What is missing comes from the other end of the topic.
    """
    rest = dict(creation.arguments or {})
    homes = {
        name: [given for given in rest if kinds[given] == wanted[name]][:1]
        for name in CREATORS[creation.method]
    }
    for given in [given for given in rest if kinds[given] is None]:
        # What is of no known kind has the only place that is left.
        free = [name for name, found in homes.items() if not found and name != "qos_profile"]
        if len(free) == 1:
            homes[free[0]] = [given]
    right = []
    for name, found in homes.items():
        text = ast.unparse(rest.pop(found[0])) if found else _of_other_end(sources, creation, name)
        if not text:
            return ""
        right.append(text)
    return "" if rest else f"write `{ast.unparse(creation.call.func)}({', '.join(right)})`"


def _of_other_end(sources: NodeSources, creation: Creation, name: str) -> str:
    """Return the message type or the topic that the other end of a topic has; empty if several may be meant."""
    if name not in ("msg_type", "topic"):
        return ""
    mine = {ast.unparse(value) for value in (creation.arguments or {}).values()}
    others = [
        c
        for c in sources.creations
        if c is not creation and {"msg_type", "topic"} <= (c.arguments or {}).keys()
    ]
    other = "topic" if name == "msg_type" else "msg_type"
    fitting = [c.arguments or {} for c in others if ast.unparse((c.arguments or {})[other]) in mine]
    found = {ast.unparse(arguments[name]) for arguments in fitting}
    return found.pop() if len(found) == 1 else ""


def _kind(sources: NodeSources, creation: Creation, value: ast.expr) -> str | None:
    known = sources.value(creation.source, value)
    if isinstance(known, str):
        return "text"
    if isinstance(known, (int, float)) and not isinstance(known, bool):
        return "number"
    name = sources.resolve(creation.source, value)
    if interfaces.is_interface(name):
        return "type"
    if isinstance(value, ast.Lambda) or sources.function_of(creation, value) is not None:
        return "function"
    return None
