"""Callbacks that wait for what only another callback of the same thread gives."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator, Sequence
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
    for function in functions:
        for node in (n for n in own_nodes(function) if isinstance(n, (ast.While, ast.Call))):
            lacks, free = _waited_for(sources, source, owner, functions, function=function, node=node)
            for name, setting in free:
                if told := _told(sources, functions, name, setting, is_grouped=bool(threads)):
                    waiter = "a loop" if isinstance(node, ast.While) else f"`{ast.unparse(node)}`"
                    why, fix = told
                    if (
                        lacks
                        and not threads
                        and function is functions[0]
                        and _are_timers(sources, functions[0])
                    ):
                        fix = f"write `if {lacks}: return` above line {node.lineno}"
                    cause = f"In {what}, {waiter} waits for self.{name}, which only {why}"
                    yield Finding("callback-waits", cause, source.at(node), fix)


def _waited_for(
    sources: NodeSources,
    source: PythonSource,
    owner: NodeClass,
    functions: list[Function],
    *,
    function: Function,
    node: ast.While | ast.Call,
) -> tuple[str, Sequence[tuple[str, list[Function]]]]:
    """Return how to ask whether a call would wait, and what a loop or a call waits for, with the functions that give it."""
    if isinstance(node, ast.While):
        found = _polled(sources, source, owner, functions, node) if _only_waits(source, node) else ()
        return "", [*found]
    if last_name(node.func) in _POLLS or not _is_reached(functions, function, node):
        return "", []
    lacks, *free = _blocked(sources, source, node)
    return lacks, free


def _told(
    sources: NodeSources,
    functions: Sequence[Function],
    name: str,
    setting: list[Function],
    *,
    is_grouped: bool,
) -> tuple[str, str] | None:
    """Return why what gives an attribute is not called meanwhile, and a fix; None if it may be.

    Args:
        sources: the program's files.
        functions: the callback that waits, and what it calls.
        name: of the attribute.
        setting: the functions that give it.
        is_grouped: whether several threads run what is not in one callback group.
    """
    callbacks = uses_of(sources).callbacks
    # What no executor calls may be called by a library, in a thread of its own.
    if not setting or not all(id(m) in callbacks and m not in functions for m in setting):
        return None
    first, own = setting[0], callbacks.get(id(functions[0]), [])
    why = f"{first.name}() changes; but rclpy calls {first.name}() only after this one returns, so once it waits, it waits forever"
    if not is_grouped:
        return f"{why}.", where_set(name, first)
    made = [*own, *(one for method in setting for one in callbacks[id(method)])]
    held = {(one.owner, node_of(one.call), group_of(sources, one.source, one.call)) for one in made}
    if not own or len(held) > 1:
        return None
    why = f"{why}: both are in one callback group, of which only one callback runs at a time, also with several threads."
    return why, f"write `{in_own_group(own[0].call)}` on line {own[0].call.lineno}, {GROUP_IMPORTED}"


def _are_timers(sources: NodeSources, callback: Function) -> bool:
    """Return whether only timers call a callback."""
    made = uses_of(sources).callbacks.get(id(callback), [])
    return {one.method for one in made} == {"create_timer"}


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
    setting = _giving(sources, held.attr, giving, {wait, polled, "clear", "task_done"} - {""})
    return ("",) if setting is None else (lacks.format(ast.unparse(held)), (held.attr, setting))


def _giving(
    sources: NodeSources, attribute: str, giving: Collection[str], harmless: Collection[str]
) -> list[Function] | None:
    """Return the functions that call one of the `giving` methods of an attribute.

    None if anything else is done with it than to store it, to enter it, or to call a harmless method.
    """
    found = list[Function]()
    for file in sources.sources.values():
        for node in (n for n in file.nodes if isinstance(n, ast.Attribute) and n.attr == attribute):
            outer, function = file.above(node), file.function_at(node.lineno)
            called = last_name(outer) if isinstance(outer, ast.Attribute) and file.is_called(outer) else ""
            if called and called in giving and function:
                found.append(function)
            elif not (
                isinstance(node.ctx, ast.Store) or isinstance(outer, ast.withitem) or called in harmless
            ):
                return None
    return found


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
