"""Finds where a value was computed that was nan when it was compared: every comparison with nan is false."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import replace

from ros2lab.diagnose.explaining.shown_values import made_of_many
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, own_nodes
from ros2lab.trial.clauses import LEAST
from ros2lab.trial.record import Record, node_at


def nan_faults(record: Record) -> Iterator[tuple[Finding, str]]:
    """Yield what makes nan of values of which one is nan, each with the place where that was compared.

    A value that is nan itself may be left out by just this comparison, or mean that nothing is there.
    """
    for place, test in record.tests.items():
        source, node = place[0], node_at(place, ast.Compare)
        if not isinstance(node, ast.Compare) or isinstance(source.above(node), ast.UnaryOp):
            continue  # `not distance > 1.0` may be written for nan
        parts = (node.left, *node.comparators)
        if len({*map(ast.unparse, parts)}) < len(parts):
            continue  # `x != x` asks for nan
        for part, side in zip(parts, test.sides, strict=True):
            for found in made_of_many(source, _behind(source, part)) if side.nans >= LEAST else ():
                checks = f"{side.nans} of {test.held + test.failed} checks of `{ast.unparse(node)}`"
                cause = (
                    f"{found.cause} In the run, {ast.unparse(part)} was nan in {checks} (line {node.lineno})."
                )
                yield replace(found, cause=cause), source.at(node)


def _behind(source: PythonSource, part: ast.expr) -> list[ast.expr]:
    """Return an expression, what the names in it are given, and what functions of the file that are called there return."""
    named = [node for node in ast.walk(part) if isinstance(node, (ast.Name, ast.Attribute))]
    found = [part, *(value for node in named for value in source.given(node) if value)]
    calls = (node for value in found for node in ast.walk(value) if isinstance(node, ast.Call))
    called = {last_name(call.func) for call in calls}
    functions = (n for n in source.nodes if isinstance(n, Function) and n.name in called)
    inside = (node for function in functions for node in own_nodes(function))
    return [*found, *(node.value for node in inside if isinstance(node, ast.Return) and node.value)]
