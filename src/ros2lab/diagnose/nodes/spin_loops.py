"""Spins in the wrong place: in a constructor or a callback, and in loops in which something stands still because of it."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.entrance import Call, Entrance
from ros2lab.diagnose.sources.node_source import CREATORS, NodeClass
from ros2lab.diagnose.sources.one_run import goes_on_forever, may_be_caught
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, own_nodes, walk
from ros2lab.diagnose.sources.syntax_parts import calls_in, removal

CALLED_BACK = frozenset(("create_timer", "create_subscription", "create_service"))
_RARE = frozenset(("create_rate", "create_guard_condition", "create_task", "ActionClient", "ActionServer"))
_SHORT_REST = 0.2  # s; after a shorter sleep a node still keeps up with its timers


def _turning(entrance: Entrance) -> Iterator[tuple[ast.While, Call]]:
    """Yield the endless loops that spin once in each round, with the first call that does."""
    turns = {id(turn.call): turn for turn in entrance.calls if turn.short == "spin_once"}
    nodes = (node for function in entrance.functions for node in own_nodes(function))
    for loop in (node for node in nodes if isinstance(node, ast.While)):
        inside = [turns[id(node)] for node in walk(loop) if id(node) in turns]
        if inside and is_endless(loop, inside[0].source):
            yield loop, inside[0]


def _turns(entrance: Entrance) -> Iterator[tuple[ast.While | None, Call]]:
    """Yield the endless loops that spin once in each round, and then each spin_once in no such loop, without one."""
    loops = [node for function in entrance.functions for node in own_nodes(function)]
    inside = {id(node) for loop in loops if isinstance(loop, ast.While) for node in walk(loop)}
    yield from _turning(entrance)
    yield from (
        (None, turn) for turn in entrance.calls if turn.short == "spin_once" and id(turn.call) not in inside
    )


def stands_still(entrance: Entrance, *, gets_nothing: bool = False) -> Iterator[Finding]:
    """Yield a spin_once that waits until a message comes, in each round of a loop, or for ever.

    Without a rhythm of its own it may mean to answer each message: then it is told only of a program that gets none.
    """
    ends = {call.short for call in entrance.calls} & {*CREATORS, *_RARE} - {"create_publisher"}
    takes_messages = entrance.has_callbacks
    is_known = _is_seen_whole(entrance) and ends == ({"create_subscription"} if takes_messages else set())
    for loop, turn in _turns(entrance) if is_known else ():
        places = 2 if turn.name == "rclpy.spin_once" else 0
        is_limited = bool(turn.call.args[places:]) or any(
            k.arg in ("timeout_sec", None) for k in turn.call.keywords
        )
        calls = [n for n in walk(loop or turn.call) if isinstance(n, ast.Call) and n is not turn.call]
        has_work = any(last_name(call.func) not in ("sleep", "ok") for call in calls)
        has_work |= loop is None and not takes_messages
        is_paced = _is_paced(entrance, turn.source, calls)
        if is_limited or not has_work or (takes_messages and not is_paced and not gets_nothing):
            continue
        sleeps = any(last_name(call.func) == "sleep" for call in calls)
        limit = ast.keyword("timeout_sec", ast.Constant(0 if sleeps else 0.1))
        limited = ast.Call(turn.call.func, turn.call.args, [*turn.call.keywords, limit])
        until = "a message comes" if takes_messages else "there is a callback to call, and this node has none"
        cause = f"spin_once() without timeout_sec waits until {until}; until then the {'loop' if loop else 'program'} stands still."
        fix = f"write {ast.unparse(limited)} instead of {ast.unparse(turn.call)}"
        yield Finding("callback-waits", cause, turn.source.at(turn.call), fix)


def _is_seen_whole(entrance: Entrance) -> bool:
    """Return whether nothing from elsewhere may give the nodes of a program more to call."""
    classes = entrance.sources.classes
    made = [classes[call.name] for call in entrance.calls if call.name in classes]
    is_known = all(entrance.sources.lineage(o)[2] and not entrance.sources.is_managed(o) for o in made)
    return is_known and not entrance.may_do_more


def _is_paced(entrance: Entrance, source: PythonSource, calls: Iterable[ast.Call]) -> bool:
    """Return whether one of some calls sleeps for longer than a node that keeps up with its timers may."""
    lengths = (call.args[0] for call in calls if last_name(call.func) == "sleep" and call.args)
    return any(not _is_short(entrance.sources.value(source, length)) for length in lengths)


def _is_short(length: object) -> bool:
    """Return whether a sleep is so short that a node keeps up with its timers."""
    return isinstance(length, (int, float)) and length < _SHORT_REST


def rests(entrance: Entrance) -> Iterator[Finding]:
    """Yield an endless loop that spins once and sleeps in each round, so that only one callback a round is called."""
    for loop, turn in _turning(entrance):
        for statement in loop.body if turn.name == "rclpy.spin_once" else ():
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


def one_turn(entrance: Entrance) -> Iterator[Finding]:
    """Yield a spin without end in a loop that publishes before it: rclpy.spin returns only when the loop ends, too."""
    senders = {
        node.name
        for source in entrance.sources.sources.values()
        for node in source.nodes
        if isinstance(node, Function) and any(last_name(inner) == "publish" for inner in own_nodes(node))
    }
    for spin in (spin for spin in entrance.spins if spin.name == "rclpy.spin" and spin.call.args):
        for loop in (node for node in own_nodes(spin.function) if isinstance(node, ast.While)):
            is_ok = isinstance(loop.test, ast.Call) and spin.source.resolve(loop.test.func) == "rclpy.ok"
            alone = [n.value for n in loop.body if isinstance(n, ast.Expr) and isinstance(n.value, ast.Call)]
            if not is_ok or spin.call not in alone:
                continue
            before = alone[: alone.index(spin.call)]
            if sent := [call for call in before if last_name(call.func) in {"publish", *senders}]:
                given = ast.unparse(spin.call.args[0])
                cause = f"rclpy.spin({given}) runs until Ctrl-C, so this loop has only one turn, and `{ast.unparse(sent[0])}` is called only once."
                fix = f"write rclpy.spin_once({given}, timeout_sec=1.0) instead of {ast.unparse(spin.call)}"
                if entrance.has_callbacks:
                    fix = f"call it in a timer callback, and write {ast.unparse(spin.call)} without the loop"
                yield Finding("callback-waits", cause, spin.source.at(spin.call), fix)


def _is_too_slow(entrance: Entrance, length: float) -> bool:
    """Return whether one callback each time is too few: there are several, or one that is due more often."""
    made = [
        c for c in entrance.sources.creations if c.method in CALLED_BACK and c.function in entrance.functions
    ]
    periods = [entrance.sources.value(c.source, c.source.written(c.given("timer_period_sec"))) for c in made]
    return len(made) > 1 or any(isinstance(period, (int, float)) and period <= length for period in periods)


def is_endless(loop: ast.While, source: PythonSource) -> bool:
    """Return whether only Ctrl-C ends a loop."""
    by_error = {id(n) for h in walk(loop) if isinstance(h, ast.ExceptHandler) for n in walk(h)}
    ends = (node for node in own_nodes(loop) if isinstance(node, (ast.Break, ast.Return, ast.Raise)))
    return goes_on_forever(source, loop) and all(id(node) in by_error for node in ends)


def spin_inside(
    source: PythonSource, owner: NodeClass | None, function: Function, spin: ast.Call, what: str
) -> Finding:
    """Return the finding of a spin; the `try` around it, and what ends the node below, go with it."""
    ends = "never returns and nothing after it is reached"
    if may_be_caught(source, spin.lineno, KeyboardInterrupt):
        ends = "does not return before Ctrl-C, and nothing after it is reached until then"
    cause = f"{what[0].upper()}{what[1:]} spins, so it {ends}."
    made = f"node = {owner.definition.name}()" if owner else "node = ..."
    tries = (
        n for n in own_nodes(function) if isinstance(n, ast.Try) and any(spin in walk(s) for s in n.body)
    )
    around = next(tries, None)
    last = (around or spin).end_lineno or 0
    ending = {
        call.lineno
        for call in calls_in(own_nodes(function))
        if last_name(call.func) in ("destroy_node", "shutdown", "try_shutdown") and call.lineno > last
    }
    fix = f"{removal(source, spin)} here, and write rclpy.spin(node) in main, after the node is made"
    if what == "the constructor" and (around or ending):
        moved = f"the whole try on line {around.lineno}" if around else f"`{ast.unparse(spin)}`"
        lines = "".join(f" and line {line}" for line in sorted(ending))
        fix = f"move {moved}{lines} to main, below `{made}`, with node instead of self"
    return Finding("spin-inside", cause, source.at(spin), fix)
