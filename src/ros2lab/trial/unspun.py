"""Explains why a node was not spun: the program waits for something, or it spins without this node."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ros2lab.diagnose.causes.waited import waited_for
from ros2lab.diagnose.checking.later_results import awaited
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.entrance_faults import left_out, second_spins
from ros2lab.diagnose.nodes.executors import two_executors
from ros2lab.diagnose.printed.error_text import Frame
from ros2lab.diagnose.printed.spots import Spot, place_of, spot_at
from ros2lab.diagnose.sources.entrance import Entrance
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import Function, PythonSource, walk
from ros2lab.grading.evidence import Run
from ros2lab.trial.unmade import kept_as

if TYPE_CHECKING:
    from ros2lab.trial.seen import Seen

_FRAME = re.compile(r'^  File "([^"]+)", line (\d+)', re.MULTILINE)


def unspun_fault(seen: Seen, run: Run, name: str, node: str) -> Finding | None:
    """Say why a node does not respond: the line in which it waits, or where the node was left out.

    None if nothing comes of it: the node has no callbacks, and the program does not wait for anything in vain.
    """
    found = seen.entrance(name)
    if found is not None and _only_publishes(found, node):
        return None
    spot, is_called_back = _stood(seen, str(run.stopped.get(name, {}).get("said", "")))
    if spot is not None and (told := waited_for(seen.look, spot)):
        return told
    if found is not None:
        left = [one for one in left_out(found, is_unspun=True) if one.code == "not-spinning"]
        told = next(two_executors(found), None) or next(second_spins(found), None)
        told = told or (left[0] if len(left) == 1 else None)
        if told := told or _waiting(found, spot, is_called_back=is_called_back):
            return told
        if not found.has_callbacks:
            return None
    is_lasting = found is None or is_called_back or any(spin.is_lasting for spin in found.spins)
    return Finding(
        "not-spinning",
        f"The node {node} does not respond: it is not spun, or one of its callbacks or its constructor does not return.",
        spot.source.at(spot.line) if spot and spot.source else seen.main(name),
        "write rclpy.spin(node) in main, and do not wait, sleep or loop in a constructor or callback",
        never=() if found is None or is_lasting else _callbacks(found),
    )


def _stood(seen: Seen, said: str) -> tuple[Spot | None, bool]:
    """Return the student's line that was running at Ctrl-C, and whether an executor had called it."""
    spot, is_called_back = None, False
    is_spinning = False
    for file, line in _FRAME.findall(said):
        is_spinning |= file.endswith("/rclpy/executors.py")
        here = spot_at(place_of([Frame(file, int(line))], seen.look), seen.look)
        if here.source is not None and here.source.shown.startswith("src/"):
            spot, is_called_back = here, is_spinning
    return spot, is_called_back


def _callbacks(entrance: Entrance) -> tuple[str, ...]:
    """Return the places of a program's callbacks, none of which is called without a spin."""
    callbacks = entrance.sources.callbacks()
    return tuple(
        made.source.at(function) for made, function in callbacks if made.function in entrance.functions
    )


def _waiting(entrance: Entrance, spot: Spot | None, *, is_called_back: bool) -> Finding | None:
    """Return the fault of the line in which a program waits; None if it is not known."""
    source = spot.source if spot else None
    if spot is None or source is None:
        # If Ctrl-C is caught, the line is not known; a blocking service call is then the likeliest cause.
        calls = [(call.source, call.call) for call in entrance.calls if not entrance.spins]
        return next(
            filter(None, (_asking(entrance.sources, *source_and_call) for source_and_call in calls)), None
        )
    for node in spot.nodes:
        if isinstance(node, ast.Call) and (
            told := _asking(entrance.sources, source, node, is_called_back=is_called_back)
        ):
            return told
    is_spin = any(spin.call in spot.nodes for spin in entrance.spins)
    if is_called_back or is_spin or spot.function is None:
        return None
    names = [parameter.arg for parameter in spot.function.args.args[:1]]
    node_name = "self" if names == ["self"] else kept_as(entrance)
    if told := _until_done(source, spot.function, spot.line, node_name):
        return told
    if node_name == "self" or not entrance.has_callbacks:
        return None
    return Finding(
        "not-spinning",
        f"`{spot.text}` waits, and nothing spins {node_name} in the meantime, so none of its callbacks is called.",
        source.at(spot.line),
        f"write `threading.Thread(target=rclpy.spin, args=({node_name},), daemon=True).start()` above line {_outermost(spot)}, "
        "or do its work in a timer callback and write rclpy.spin instead",
        never=_callbacks(entrance),
    )


def _until_done(source: PythonSource, function: Function, line: int, node_name: str) -> Finding | None:
    """Return the fault of the loop around a line that waits until a future is done; None if it is no such loop."""
    for loop in walk(function):
        if isinstance(loop, ast.While) and loop.lineno <= line <= (loop.end_lineno or 0):
            for test in walk(loop.test):
                if isinstance(test, ast.Attribute) and test.attr == "done":
                    future = ast.unparse(test.value)
                    return Finding(
                        "not-spinning",
                        f"This loop waits until {future} is done, which can happen only while {node_name} is being spun.",
                        source.at(loop),
                        f"write `rclpy.spin_until_future_complete({node_name}, {future})` instead of this loop",
                    )
    return None


def _outermost(spot: Spot) -> int:
    """Return the line of the outermost loop around a line, or that line: a thread is started only once."""
    loops = [n for n in walk(spot.function) if isinstance(n, (ast.While, ast.For))] if spot.function else []
    around = [loop.lineno for loop in loops if loop.lineno <= spot.line <= (loop.end_lineno or 0)]
    return min(around, default=spot.line)


def _asking(
    sources: NodeSources, source: PythonSource, call: ast.Call, *, is_called_back: bool = False
) -> Finding | None:
    """Return the fault of a blocking service call; None if the call is something else."""
    match call.func:
        case ast.Attribute(attr="call", value=client):
            pass
        case _:
            return None
    makers = [*_makers(sources, client)]
    if not makers:
        return None
    node = ast.unparse(client.value) if isinstance(client, ast.Attribute) else makers[0]
    given = ", ".join(map(ast.unparse, (*call.args, *call.keywords)))
    kept = next((n for n in source.nodes if isinstance(n, ast.Assign) and n.value is call), None)
    result = f"{ast.unparse(kept.targets[0])} = " if kept else ""
    asks = f"{ast.unparse(client)}.call_async({given})"
    fix = awaited(asks, node, result, call.lineno, is_called_back=is_called_back)
    why = (
        "the executor waits for this callback to return"
        if is_called_back
        else f"nothing spins {node} before this"
    )
    cause = f"`{ast.unparse(call)}` waits forever: the response arrives only during a spin, but {why}."
    return Finding("not-spinning", cause, source.at(call), fix)


def _makers(sources: NodeSources, client: ast.expr) -> Iterator[str]:
    """Yield the expressions of the nodes that create a client of this name."""
    name = getattr(client, "attr", getattr(client, "id", ""))
    for source in sources.sources.values():
        for node in source.nodes:
            match node:
                case ast.Assign(
                    targets=[target], value=ast.Call(func=ast.Attribute(attr="create_client", value=maker))
                ) if name and getattr(target, "attr", getattr(target, "id", "")) == name:
                    yield ast.unparse(maker)


def _only_publishes(entrance: Entrance, node: str) -> bool:
    """Return whether a node of no class of its own is used only for what calls nothing back, such as publishers."""
    for made in filter(entrance.makes_node, entrance.calls):
        named = [given.value for given in made.call.args[:1] if isinstance(given, ast.Constant)]
        kept = made.source.name_of(made.call)
        if named != [node] or made.name in entrance.sources.classes or not kept:
            continue
        uses = [n for n in made.source.nodes if isinstance(n, ast.expr) and ast.unparse(n) == kept]
        asked = [made.source.above(use) for use in uses if isinstance(getattr(use, "ctx", None), ast.Load)]
        names = [n.attr if isinstance(n, ast.Attribute) else "create_" for n in asked]
        return all(name == "create_publisher" or not name.startswith(("create_", "add_")) for name in names)
    return False
