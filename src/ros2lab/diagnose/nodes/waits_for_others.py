"""Callbacks that wait for what only another callback of the same thread gives."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from typing import Any

from ros2lab.diagnose.code.deadlocks import (
    GROUP_IMPORTED,
    group_of,
    in_own_group,
    node_of,
    set_elsewhere,
    where_set,
)
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.endless_loops import HARMLESS, threads_of
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.one_run import is_always_reached, may_leave, own_calls
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    given_to,
    last_name,
    own_nodes,
    walk,
)
from ros2lab.diagnose.sources.syntax_parts import calls_in
from ros2lab.diagnose.sources.uses import uses_of

# Of what can be waited for: the method that waits, those that end it, and how to ask whether there is nothing yet.
_QUEUE = ("get", ("put", "put_nowait"), "{}.empty()")
_GIVEN = {
    **dict.fromkeys((f"queue.{kind}Queue" for kind in ("", "Lifo", "Priority", "Simple")), _QUEUE),
    "threading.Event": ("wait", ("set",), "not {}.is_set()"),
    "threading.Semaphore": ("acquire", ("release",), ""),
    "threading.Condition": ("wait", ("notify", "notify_all"), ""),
    "concurrent.futures.Future": ("result", ("set_result", "set_exception"), "not {}.done()"),
}
_POLLS = ("is_set", "empty")  # of a future, whether it is done is another rule's
_ONLY_GROUPS = "MultiThreadedExecutor"  # still runs one callback of a group at a time
_UNLIMITED = ("", "True", "block=True", "blocking=True", "timeout=None", "None")


def waits_for_another(
    sources: NodeSources, source: PythonSource, owner: NodeClass | None, functions: list[Function], what: str
) -> Iterator[Finding]:
    """Yield waits, in a callback or what it calls, for what only another callback gives, which cannot run meanwhile."""
    threads = threads_of(sources, source)
    if owner is None or threads - {_ONLY_GROUPS} or isinstance(functions[0], ast.AsyncFunctionDef):
        return
    uses = uses_of(sources)
    for function in functions:
        for node in (n for n in own_nodes(function) if isinstance(n, (ast.While, ast.Call))):
            waiter, lacks, free = "a loop", "", list[tuple[str, list[Function]]]()
            if isinstance(node, ast.While):
                if _only_waits(source, node):
                    free = [*_polled(sources, source, owner, functions, node)]
            elif last_name(node.func) not in _POLLS and _is_reached(functions, function, node):
                waiter, (lacks, *free) = f"`{ast.unparse(node)}`", _blocked(sources, source, node)
            for name, setting in free:
                # What no executor calls may be called by a library, in a thread of its own.
                if not setting or not all(id(m) in uses.callbacks and m not in functions for m in setting):
                    continue
                first, own = setting[0], uses.callbacks.get(id(functions[0]), [])
                others = [made for method in setting for made in uses.callbacks[id(method)]]
                cause = f"In {what}, {waiter} waits for self.{name}, which only {first.name}() changes; but rclpy calls {first.name}() only after this one returns, so once it waits, it waits forever."
                fix = where_set(name, first)
                if threads:
                    held = {
                        (c.owner, node_of(c.call), group_of(sources, c.source, c.call))
                        for c in (*own, *others)
                    }
                    if not own or len(held) > 1:
                        continue
                    cause = f"{cause[:-1]}: both are in one callback group, of which only one callback runs at a time, also with several threads."
                    fix = (
                        f"write `{in_own_group(own[0].call)}` on line {own[0].call.lineno}, {GROUP_IMPORTED}"
                    )
                elif lacks and function is functions[0] and {made.method for made in own} == {"create_timer"}:
                    fix = f"write `if {lacks}: return` above line {node.lineno}"
                yield Finding("callback-waits", cause, source.at(node), fix)


def _polled(
    sources: NodeSources,
    source: PythonSource,
    owner: NodeClass,
    functions: Sequence[Function],
    loop: ast.While,
) -> Iterator[tuple[str, list[Function]]]:
    """Yield what a loop waits for, with the functions that give it: attributes, or what is in them."""
    held = [call for call in calls_in(walk(loop.test)) if last_name(call.func) in _POLLS]
    for call in held:
        yield from _blocked(sources, source, call)[1:]
    inside = {last_name(getattr(call.func, "value", None)) for call in held}
    asked = {n.attr for n in walk(loop.test) if is_self_attribute(n)}
    if asked.isdisjoint(uses_of(sources).stored_of_others):
        yield from (pair for pair in set_elsewhere(owner, functions, loop) if pair[0] not in inside)


def _is_reached(functions: Sequence[Function], function: Function, call: ast.Call) -> bool:
    """Return whether each call of the first of some functions comes to a call in one of them."""
    first = functions[0]
    is_called = function is first or is_always_reached(first, own_calls(first)[function.name])
    return is_called and is_always_reached(function, call)


def _blocked(sources: NodeSources, source: PythonSource, call: ast.Call) -> tuple[Any, ...]:
    """Return how to ask whether a call would wait without a limit, and what for, with the functions that give it.

    Only the former, and empty, if it does not wait, or if anything else is done with what it waits for.
    """
    held = call.func.value if isinstance(call.func, ast.Attribute) else None
    made = source.written(held) if is_self_attribute(held) else None
    kind = source.resolve(made.func) if isinstance(made, ast.Call) else None
    wait, giving, lacks = _GIVEN.get(kind or "", ("", (), ""))
    polled = last_name(call.func) if last_name(call.func) in _POLLS else ""
    given = ", ".join(map(ast.unparse, (*call.args, *call.keywords)))
    is_filled = kind == "threading.Semaphore" and "0" not in map(ast.unparse, given_to(made))  # type: ignore[arg-type]
    is_waiting = last_name(call.func) == wait or (polled and f".{polled}(" in lacks)
    if not is_self_attribute(held) or not is_waiting or given not in _UNLIMITED or is_filled:
        return ("",)
    setting = list[Function]()
    for file in sources.sources.values():
        for node in (n for n in file.nodes if isinstance(n, ast.Attribute) and n.attr == held.attr):
            outer, function = file.above(node), file.function_at(node.lineno)
            is_asked = isinstance(outer, ast.Attribute) and file.is_called(outer)
            if is_asked and last_name(outer) in giving and function:
                setting.append(function)
            elif not (isinstance(node.ctx, ast.Store) or isinstance(outer, ast.withitem)) and (
                not is_asked or last_name(outer) not in (wait, polled, "clear", "task_done")
            ):
                return ("",)
    return lacks.format(ast.unparse(held)), (held.attr, setting)


def _only_waits(source: PythonSource, loop: ast.While) -> bool:
    """Return whether only the attributes that a loop asks about, or the end of rclpy, can end it."""
    asked = [node for node in walk(loop.test) if isinstance(node, (ast.Name, ast.Call))]
    is_of_self = all(
        source.resolve(node.func) == "rclpy.ok"
        or ast.unparse(node.func) == "len"
        or last_name(node.func) in _POLLS
        if isinstance(node, ast.Call)
        else node.id in ("self", "rclpy", "len")
        for node in asked
    )
    calls = [node.func for node in calls_in(walk(loop))]
    serving = (called for called in calls if is_self_attribute(called) and called.attr not in HARMLESS)
    may_serve = any("spin" in ast.unparse(called) for called in calls) or any(serving)
    return is_of_self and not may_serve and not may_leave([loop])
