"""Recognizes tests that say nothing about a node: guards against trouble, and those that see who watches it."""

from __future__ import annotations

import ast
import re

from ros2lab.diagnose.sources.node_source import LOG_METHODS, is_self_attribute
from ros2lab.diagnose.sources.python_source import PythonSource, last_name
from ros2lab.trial.record import Test

_WARNINGS = LOG_METHODS - {"debug", "info"}
# What watches a program is a node, too, which subscribes and publishes.
_OF_GRAPH = re.compile(
    r"count_(?:publishers|subscribers|clients|services)|get_subscription_count|get_\w+_(?:info_by_topic|names_and_types\w*)|get_node_names\w*"
)


def asks_who_is_there(source: PythonSource, test: ast.expr) -> bool:
    """Return whether a test depends on which nodes or ends there are."""
    named = [node for node in ast.walk(test) if isinstance(node, (ast.Name, ast.Attribute))]
    parts = [test, *filter(None, map(source.written, named))]
    nodes = (node for part in parts for node in ast.walk(part) if isinstance(node, ast.Call))
    return any(_OF_GRAPH.fullmatch(last_name(node.func)) for node in nodes)


def only_warns(block: list[ast.stmt]) -> bool:
    """Return whether statements do nothing but say that something is wrong, or leave: the trouble need not come."""
    said = [node.value for node in block if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)]
    logs = [last_name(call.func) for call in said if last_name(call.func) in LOG_METHODS | {"print"}]
    left = [node for node in block if _leaves(node)]
    return len(logs) + len(left) == len(block) and bool(left or _WARNINGS.intersection(logs))


def _leaves(node: ast.stmt) -> bool:
    is_bare = isinstance(node, ast.Return) and ast.unparse(node) in ("return", "return None")
    return is_bare or isinstance(node, (ast.Raise, ast.Continue, ast.Break))


def is_guard(source: PythonSource, node: ast.Compare, test: Test) -> bool:
    """Return whether a comparison that was never true only guards against what did not come.

    If it asks for a state of the node itself that has changed, it may be for one that the node never has.
    """
    around: ast.AST | None = source.above(node)
    while isinstance(around, ast.BoolOp):
        around = source.above(around)
    sides = zip((node.left, *node.comparators), test.sides, strict=True)
    is_of_state = any(is_self_attribute(part) and side.has_changed for part, side in sides)
    is_alone = isinstance(around, ast.If) and not around.orelse and only_warns(around.body)
    return is_alone and not is_of_state
