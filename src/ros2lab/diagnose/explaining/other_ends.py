"""Texts of a topic that a callback cannot read: what the publisher writes, and in which form it is read."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.topic_faults import End
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.names_there import topic_ends
from ros2lab.diagnose.printed.spots import Spot, spot_of
from ros2lab.diagnose.sources.joined_texts import text_pattern
from ros2lab.diagnose.sources.python_source import PythonSource, assignments, parameters, walk

_READS = frozenset(("json.loads", "float", "int"))


def of_other_end(error: ErrorText, look: Look) -> Finding | None:
    """Return what a publisher writes that a callback cannot read; None for another error, or if others may have written it."""
    report = error.report
    if not look or report is None or report.kind.rpartition(".")[2] not in ("JSONDecodeError", "ValueError"):
        return None
    spot = spot_of(report, look)
    sender, read = _sender(spot, look), _read(spot)
    written = [*_written(sender)] if sender else []
    is_typed = any("topic pub" in line for line in error.typed)
    if sender is None or read is None or len(written) != 1 or is_typed:
        return None
    source, (value,) = sender.creation.source, written
    said = re.search(r": '(.*)'$", report.message)
    fix = "write the text here in the form that is read there, or read it there in this form"
    if ast.unparse(read.func) == "json.loads":
        fix = _as_json(value, source)
    if not fix or (said and not _may_be(value, said[1])):
        return None
    cause = f"`{ast.unparse(read)}` in {spot.place} cannot read what is sent on /{sender.topic}: `{ast.unparse(value)}`."
    return Finding("made-wrong", cause, source.at(value), fix)


def _sender(spot: Spot, look: Look) -> End | None:
    """Return the publisher whose messages the callback at a place takes; None unless it is the only one."""
    function, ends = spot.function, topic_ends(look)
    called = ((end, end.sources.function_of(end.creation, end.creation.given("callback"))) for end in ends)
    heard = {end.topic for end, by in called if function and by and ast.dump(by) == ast.dump(function)}
    senders = [end for end in ends if end.is_publisher and end.topic in heard]
    return senders[0] if len(senders) == 1 else None


def _read(spot: Spot) -> ast.Call | None:
    """Return the call at a place that reads the text of the message; None unless it is the only one."""
    own = {f"{one.arg}.data" for one in parameters(spot.function)} if spot.function else set()
    reads = [c for c in spot.calls if ast.unparse(c.func) in _READS and own & {*map(ast.unparse, c.args)}]
    return reads[0] if len(reads) == 1 else None


def _as_json(value: ast.expr, source: PythonSource) -> str:
    """Return what to write for a text that is what Python shows of a value; empty if it is another text."""
    inner = _shown(value)
    if inner is None or "json.dumps" in ast.unparse(inner):
        return ""
    more = "" if "json" in source.names else ", with `import json` at the top"
    return f"write `json.dumps({ast.unparse(inner)})` instead of `{ast.unparse(value)}`{more}"


def _may_be(value: ast.expr, text: str) -> bool:
    """Return whether an expression of which a part is known gives a text."""
    pattern = text_pattern(value)
    return pattern.replace(".*", "") != "" and re.fullmatch(pattern, text) is not None


def _written(end: End) -> Iterator[ast.expr]:
    """Yield what the class or file of a publisher gives to the data of messages."""
    owner, source = end.creation.owner, end.creation.source
    nodes = [*walk(owner.definition if owner else source.tree)]
    yield from (v for target, v in assignments(nodes) if getattr(target, "attr", "") == "data")
    yield from (node.value for node in nodes if isinstance(node, ast.keyword) and node.arg == "data")


def _shown(value: ast.expr) -> ast.expr | None:
    """Return the expression of which a text is what Python shows of it; None if it is put together otherwise."""
    match value:
        case ast.Call(func=ast.Name(id="str" | "repr"), args=[inner], keywords=[]):
            return inner
        case ast.JoinedStr(values=[ast.FormattedValue(value=inner, format_spec=None)]):
            return inner
    return None
