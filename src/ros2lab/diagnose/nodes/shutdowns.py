"""What comes after a call that shuts rclpy down, in a constructor and in a callback."""

from __future__ import annotations

import ast
import builtins
import math
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources
from ros2lab.diagnose.sources.one_run import blocks, is_always_reached, may_be_caught, may_be_caught_by_caller
from ros2lab.diagnose.sources.own_functions import called_function
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, own_nodes, walk
from ros2lab.diagnose.sources.syntax_parts import calls_in, removal

_Ways = list[type[BaseException]]


def shut_down_at_first(
    sources: NodeSources, source: PythonSource, owner: NodeClass | None, function: Function
) -> Iterator[Finding]:
    """Yield shutdowns in a constructor that goes on, or returns to a program that spins then."""
    spin = next((call for call in source.calls if source.resolve(call.func) == "rclpy.spin"), None)
    if spin is None or may_be_caught(source, spin.lineno, TypeError):
        return
    if not is_always_reached(source.function_at(spin.lineno) or source.tree, spin):
        return  # it may ask whether rclpy still runs
    for call, ways in _shutdowns(sources, source, owner, function):
        statement = source.above(call)
        if ways or not isinstance(statement, ast.Expr):
            continue
        cause = f"The constructor shuts rclpy down and does not end the program, so what uses rclpy after it fails, at the latest `{ast.unparse(spin)}` on line {spin.lineno}."
        is_caught = isinstance(source.above(statement), ast.ExceptHandler)
        fix = f"write `raise{'' if is_caught else ' SystemExit'}` instead of `{ast.unparse(statement)}`"
        yield Finding("life-order", cause, source.at(statement), fix)


def _shutdowns(
    sources: NodeSources, source: PythonSource, owner: NodeClass | None, function: Function
) -> Iterator[tuple[ast.Call, _Ways]]:
    """Yield the calls of a function that shut rclpy down, each with the exceptions by which the function is left after it."""
    within = [block for node in (function, *own_nodes(function)) for block in blocks(node)]
    for call in calls_in(own_nodes(function)):
        if source.resolve(call.func) not in ("rclpy.shutdown", "rclpy.try_shutdown"):
            continue
        places = [(block, n) for block in within for n, outer in enumerate(block) if call in walk(outer)]
        after = [s for block, n in places for s in (*block[n + 1 :], *getattr(block[n], "finalbody", ()))]
        called = calls_in(s.value for s in after if isinstance(s, ast.Expr))
        found = (called_function(sources, source, owner, inner.func) for inner in called)
        after += [statement for method in found if method for statement in method.body]
        yield call, [way for statement in after if (way := _way_out(statement))]


def _way_out(statement: ast.stmt) -> type[BaseException] | None:
    """Return the exception by which a statement leaves, BaseException if it ends Python at once; None if it leaves nothing."""
    if isinstance(statement, ast.Raise):
        named = getattr(builtins, last_name(getattr(statement.exc, "func", statement.exc)), None)
        return named if isinstance(named, type) and issubclass(named, BaseException) else Exception
    called = last_name(getattr(getattr(statement, "value", None), "func", None))
    return {"exit": SystemExit, "quit": SystemExit, "_exit": BaseException}.get(called)


def shut_down(
    sources: NodeSources, source: PythonSource, owner: NodeClass | None, function: Function
) -> Iterator[Finding]:
    """Yield shutdowns in a callback that has more to do, or after which the one at the end of a program fails."""
    for node, ways in _shutdowns(sources, source, owner, function):
        if not ways and is_always_reached(function, node) and node not in walk(function.body[-1]):
            cause = f"{function.name}() calls {ast.unparse(node.func)}() before its other lines, so the node ends the first time that it is called."
            fix = f"{removal(source, node)}; write `raise SystemExit` where the program should end, and rclpy.try_shutdown() at the end of main"
            yield Finding("shutdown-in-callback", cause, source.at(node), fix)
        elif again := next(_ended_again(sources, source, ways), None):
            cause = f"{function.name}(), which spin() calls, shuts rclpy down, so `rclpy.shutdown()` on line {again.lineno} then fails: it is already shut down."
            fix = f"write rclpy.try_shutdown() instead of rclpy.shutdown() on line {again.lineno}"
            yield Finding("shutdown-in-callback", cause, source.at(again), fix)


def _ended_again(sources: NodeSources, source: PythonSource, ways: _Ways) -> Iterator[ast.Call]:
    """Yield the calls of rclpy.shutdown() that a function of a file comes to after it has spun, and was left by exceptions."""
    for home, function in sources.functions.values():
        calls = calls_in(own_nodes(function)) if home is source else ()
        named = [(source.resolve(call.func), call) for call in calls]
        first = min((call.lineno for name, call in named if name == "rclpy.spin"), default=math.inf)
        for name, end in named:
            if name != "rclpy.shutdown" or end.lineno <= first or end.args:
                continue
            is_anew = any(name == "rclpy.init" and first <= c.lineno < end.lineno for name, c in named)
            is_caught = may_be_caught(source, end.lineno, RuntimeError)
            is_caught = is_caught or may_be_caught_by_caller(source, function, RuntimeError)
            lasts = (
                last for n in own_nodes(function) for s in getattr(n, "finalbody", ()) for last in walk(s)
            )
            is_last = BaseException not in ways and end in lasts
            is_left = ways and not is_last and not may_be_caught(source, int(first), *ways)
            if is_always_reached(function, end) and not (is_anew or is_caught or is_left):
                yield end
