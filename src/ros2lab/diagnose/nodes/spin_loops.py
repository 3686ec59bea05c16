"""Loops that call spin_once: what stands still, or comes too late, because of it."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.entrance import Call, Entrance
from ros2lab.diagnose.sources.node_source import CREATORS
from ros2lab.diagnose.sources.one_run import goes_on_forever
from ros2lab.diagnose.sources.python_source import PythonSource, last_name, own_nodes, walk

CALLED_BACK = frozenset(("create_timer", "create_subscription", "create_service"))
_RARE = frozenset(("create_rate", "create_guard_condition", "ActionClient", "ActionServer"))
_SHORT_REST = 0.2  # s; after a shorter sleep a node still keeps up with its timers


def _turning(entrance: Entrance) -> Iterator[tuple[ast.While, Call]]:
    """Yield the endless loops that spin once in each round, with the first call that does."""
    turns = {id(turn.call): turn for turn in entrance.calls if turn.name == "rclpy.spin_once"}
    for loop in (node for function in entrance.functions for node in own_nodes(function)):
        inside = [turns[id(node)] for node in walk(loop) if id(node) in turns]
        if isinstance(loop, ast.While) and inside and _is_endless(loop, inside[0].source):
            yield loop, inside[0]


def stands_still(entrance: Entrance) -> Iterator[Finding]:
    """Yield a loop with a rhythm of its own in which each round waits until a message comes, or for ever."""
    ends = {call.short for call in entrance.calls} & {*CREATORS, *_RARE}
    waits_for = {"create_subscription"} if entrance.has_callbacks else set()
    classes = [
        entrance.sources.classes[call.name]
        for call in entrance.calls
        if call.name in entrance.sources.classes
    ]
    is_seen_whole = all(entrance.sources.lineage(owner)[2] for owner in classes)
    if not is_seen_whole or entrance.may_do_more or ends - {"create_publisher"} != waits_for:
        return
    for loop, turn in _turning(entrance):
        calls = [n for n in walk(loop) if isinstance(n, ast.Call) and n is not turn.call]
        rests_for = [n.args[0] for n in calls if last_name(n.func) == "sleep" and n.args]
        has_work = any(last_name(n.func) not in ("sleep", "ok") for n in calls)
        is_limited = bool(turn.call.args[2:]) or any(k.arg == "timeout_sec" for k in turn.call.keywords)
        is_paced = any(not _is_short(entrance.sources.value(turn.source, length)) for length in rests_for)
        if is_limited or not has_work or (waits_for and not is_paced):
            continue
        given = ast.unparse(turn.call.args[0]) if turn.call.args else "node"
        until = "a message comes" if waits_for else "there is a callback to call, and this node has none"
        yield Finding(
            "callback-waits",
            f"spin_once() without timeout_sec waits until {until}, and the loop stands still until then.",
            turn.source.at(turn.call),
            f"write rclpy.spin_once({given}, timeout_sec=0) instead of {ast.unparse(turn.call)}",
        )


def _is_short(length: object) -> bool:
    """Return whether a sleep is so short that a node keeps up with its timers."""
    return isinstance(length, (int, float)) and length < _SHORT_REST


def rests(entrance: Entrance) -> Iterator[Finding]:
    """Yield an endless loop that spins once and sleeps in each round, so that only one callback a round is called."""
    for loop, turn in _turning(entrance):
        for statement in loop.body:
            call = statement.value if isinstance(statement, ast.Expr) else None
            if not isinstance(call, ast.Call) or turn.source.resolve(call.func) != "time.sleep":
                continue
            length = entrance.sources.value(turn.source, call.args[0]) if call.args else None
            if not isinstance(length, (int, float)) or length < _SHORT_REST:
                continue
            if _is_too_slow(entrance, length):
                given = ast.unparse(turn.call.args[0]) if turn.call.args else "node"
                yield Finding(
                    "callback-waits",
                    f"spin_once() calls one callback, and then this loop sleeps for {length:g} s, so callbacks run only that often and messages pile up.",
                    turn.source.at(statement),
                    f"write rclpy.spin({given}) instead of the loop, and move the loop's other work into a timer callback",
                )


def _is_too_slow(entrance: Entrance, length: float) -> bool:
    """Return whether one callback each time is too few: there are several, or one that is due more often."""
    made = [
        c for c in entrance.sources.creations if c.method in CALLED_BACK and c.function in entrance.functions
    ]
    periods = [entrance.sources.value(c.source, c.source.written(c.given("timer_period_sec"))) for c in made]
    return len(made) > 1 or any(isinstance(period, (int, float)) and period <= length for period in periods)


def _is_endless(loop: ast.While, source: PythonSource) -> bool:
    """Return whether only Ctrl-C ends a loop."""
    by_error = {id(n) for h in walk(loop) if isinstance(h, ast.ExceptHandler) for n in walk(h)}
    ends = (node for node in own_nodes(loop) if isinstance(node, (ast.Break, ast.Return, ast.Raise)))
    return goes_on_forever(source, loop) and all(id(node) in by_error for node in ends)
