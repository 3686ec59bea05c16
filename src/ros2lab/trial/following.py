"""Tells remarks that only follow from what is found, and remarks on what is set again before it was used."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.spots import spot_at
from ros2lab.diagnose.sources.node_source import is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, PythonSource, assignments, last_name, walk
from ros2lab.trial.clauses import LEAST, checks_in_words, is_coming, values_of
from ros2lab.trial.record import Record, spot

_Name = tuple[PythonSource | None, Function | None, str]


def set_by(found: Iterable[Finding], look: Look) -> set[_Name]:
    """Return the attributes of self and the variables that statements set, or guard, of which something is found."""
    return {
        name
        for finding in found
        for node in spot_at(finding.place, look).whole
        if isinstance(node, ast.stmt) and not isinstance(node, (Function, ast.ClassDef))
        for name in _names(finding.place, walk(node), look, ast.Store)
    }


def read_at(places: Iterable[str], look: Look) -> set[_Name]:
    """Return the attributes of self and the variables that are read in the first lines of statements."""
    return {name for place in places for name in _names(place, spot_at(place, look).whole, look, ast.Load)}


def _names(place: str, nodes: Iterable[ast.AST], look: Look, how: type[ast.expr_context]) -> Iterator[_Name]:
    at = spot_at(place, look)
    for node in nodes:
        is_own = is_self_attribute(node)
        is_named = is_own or (isinstance(node, ast.Name) and node.id != "self")
        if is_named and isinstance(getattr(node, "ctx", None), how):
            yield at.source, None if is_own else at.function, last_name(node)


def overwritten(record: Record) -> Iterator[Finding]:
    """Yield conditions that were always true, and let a callback set anew what another one had kept, before anything read that."""
    for source in {place[0] for place in record.tests}:
        for node in (n for n in source.nodes if isinstance(n, ast.If) and not n.orelse):
            test, function = record.test(source, node.test), source.above(node)
            if not test or test.failed or test.held < LEAST or not isinstance(function, Function):
                continue
            if is_coming(None, spot(source, node.test), node.test, test, wanted=False):
                continue
            values, held = values_of(node.test, test), checks_in_words(test.held)
            for kept, again in _kept(record, source, function, node):
                cause = f"`{ast.unparse(node.test)}` was always true in {held}{f' ({values})' if values else ''}: line {again.lineno} sets {ast.unparse(again)} anew each time, before anything uses what line {kept.lineno} has kept there."
                yield Finding("never-passed", cause, source.at(node))


def _kept(
    record: Record, source: PythonSource, function: Function, node: ast.If
) -> Iterator[tuple[ast.stmt, ast.expr]]:
    """Yield where a callback keeps an attribute that an `if` sets anew, where nothing reads it but what follows the `if`; and both."""
    around = source.class_at(node.lineno) or source.tree
    statements = [n for n in walk(around) if isinstance(n, ast.stmt)]
    own = [n for n in walk(around) if is_self_attribute(n)]
    for again, _ in assignments(node.body):
        text = ast.unparse(again)
        stores = [n for n in statements if any(ast.unparse(target) == text for target, _ in assignments([n]))]
        others = [n for n in stores if source.function_at(n.lineno) is not function]
        kept = [n for n in others if getattr(source.function_at(n.lineno), "name", "") != "__init__"]
        loads = [n for n in own if isinstance(n.ctx, ast.Load) and ast.unparse(n) == text]
        later = range((node.end_lineno or 0) + 1, (function.end_lineno or 0) + 1)
        is_lost = bool(loads) and all(n.lineno in later for n in loads)
        if is_self_attribute(again) and is_lost and len(kept) == 1 and record.count(source, kept[0]) >= LEAST:
            yield kept[0], again
