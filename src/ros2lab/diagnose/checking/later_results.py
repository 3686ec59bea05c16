"""Futures that are used as what they will hold: the response of a service, the handle of a goal, a result."""

from __future__ import annotations

import ast

from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.python_source import given_to, last_name, own_nodes
from ros2lab.diagnose.sources.syntax_parts import calls_in


def of_future(owner: str, name: str, spot: Spot, look: Look) -> tuple[str, str] | None:
    """Return cause and fix of a member that a Future lacks and that its result has; None for any other object or member.

    What every node has, such as get_logger, is asked of the wrong object.
    """
    held, is_of_node = spot.holds(name)[:1], name in interfaces.node_members()
    if owner.partition("[")[0].rpartition(".")[2] != "Future" or not held or is_of_node:
        return None
    text = held[0]
    call = _asking(text, spot)
    if call is None:
        cause = (
            f"{text} is a Future, which only holds what came: that is its result(), and only this has {name}."
        )
        return cause, f"write `{text}.result().{name}` instead of `{text}.{name}`"
    asks, client = ast.unparse(call), getattr(call.func, "value", None)
    cause = f"`{asks}` returns at once with a Future: what it asks for comes later, and then is the Future's result(), which has {name}."
    if getattr(call.func, "attr", "") == "submit":
        return cause, f"write `{asks}.result()` instead of `{asks}`"
    callbacks = [pair for package in look.packages for pair in look.sources(package).callbacks()]
    is_called_back = any(function is spot.function for _, function in callbacks)
    node = "self" if spot.file.class_at(spot.line) else "node"
    node = ast.unparse(client.value) if isinstance(client, ast.Attribute) else node
    kept = f"{text} = " if text != asks else ""
    return cause, awaited(asks, node, kept, call.lineno, is_called_back=is_called_back)


def _asking(text: str, spot: Spot) -> ast.Call | None:
    """Return the call whose Future an expression of a line holds; None if it is not known, or waited for already."""
    made = [value for value in spot.assigned(text) if isinstance(value, ast.Call)]
    made = [call for call in made if call.lineno <= spot.line] or made
    made = made or [call for call in spot.calls if ast.unparse(call) == text]
    around = own_nodes(spot.function or spot.file.tree)
    spins = [call for call in calls_in(around) if last_name(call.func) == "spin_until_future_complete"]
    is_awaited = any(text == ast.unparse(given) for call in spins for given in given_to(call))
    return made[-1] if made and not is_awaited else None


def awaited(asks: str, node: str, kept: str, line: int, *, is_called_back: bool) -> str:
    """Say how to get what a call asks for, where it returns a future: in a method of its own if an executor waits.

    Args:
        asks: the call.
        node: the node that must be spun for it.
        kept: what the result is assigned to, as `answer = `; empty if the line uses it at once.
        line: the line of the call.
        is_called_back: whether this is in a callback, during which nothing spins.
    """
    asking, spins = f"`future = {asks}`", f"`rclpy.spin_until_future_complete({node}, future)`"
    if is_called_back:
        return f"write {asking} and `future.add_done_callback(self.answered)` on line {line}, and use `future.result()` in a method `def answered(self, future):`"
    if kept:
        return f"write three lines instead of line {line}: {asking}, {spins} and `{kept}future.result()`"
    return f"write {asking} and {spins} above line {line}, and `future.result()` there instead of `{asks}`"
