"""Service and action types that are instantiated where their request or another part is needed."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.python_source import PythonSource, own_nodes

_PARTS = {"srv": ("Request", "Response"), "action": ("Goal", "Result", "Feedback")}
_WHOLE = re.compile(r"\w+\.(?P<kind>srv|action)\.(?P<name>\w+)$")
_CANNOT_BE_MADE = ("NotImplementedError", "TypeError")


def of_part(kind: str, spot: Spot) -> Finding | None:
    """Return which part of a service or action a line should make; None if it makes no whole type."""
    source = spot.file
    if kind not in _CANNOT_BE_MADE:
        return None
    for call in spot.calls:
        match = _WHOLE.match(source.resolve(call.func) or "")
        if match is None:
            continue
        parts = _PARTS[match["kind"]]
        part = next(_parts_meant(call, match[0], parts, spot), parts[0])
        written = ast.unparse(call.func)
        old = ast.unparse(call)
        whole = "service" if match["kind"] == "srv" else "action"
        cause = (
            f"{written} is the whole {whole} type, which cannot be instantiated; its {part} is needed here."
        )
        fix = f"write {written}.{part}{old[len(written) :]} instead of {old}"
        return Finding("made-wrong", cause, source.at(call), fix)
    return None


def _parts_meant(call: ast.Call, name: str, parts: tuple[str, ...], spot: Spot) -> Iterator[str]:
    """Yield the parts that have the given fields, then those that fit how the object is used."""
    source = spot.file
    targets = {target for target, made in source.made if made is call}
    fields = {keyword.arg for keyword in call.keywords if keyword.arg} | {
        node.attr
        for node in source.nodes
        if isinstance(node, ast.Attribute) and ast.unparse(node.value) in targets
    }
    for part in parts:
        known = interfaces.fields_of(f"{name}_{part}") or {}
        if fields and fields <= known.keys():
            yield part
    yield from (part for used in _uses(call, targets, source, spot) for part in parts if part == used)


def _uses(call: ast.Call, targets: set[str], source: PythonSource, spot: Spot) -> Iterator[str]:
    """Yield the parts that fit how an object is used: returned, or published as feedback."""

    def is_it(node: ast.AST | None) -> bool:
        return node is call or (node is not None and ast.unparse(node) in targets)

    inner = [*own_nodes(spot.function)] if spot.function else []
    if any(isinstance(node, ast.Return) and is_it(node.value) for node in inner):
        yield from ("Response", "Result")
    for node in source.nodes:
        if isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "publish_feedback":
            yield from ["Feedback"] if any(map(is_it, node.args)) else []
