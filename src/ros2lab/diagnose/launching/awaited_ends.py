"""Event handlers that wait for the end of a program that goes on until it is stopped."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.launching.started_faults import Started
from ros2lab.diagnose.sources.entrance import Entrance
from ros2lab.diagnose.sources.python_source import PythonSource, argument, last_name, own_nodes, walk

_HANDLERS = {"OnProcessExit": "on_exit", "OnExecutionComplete": "on_completion"}
_STARTS = frozenset(("Node", "LifecycleNode", "ExecuteProcess", "IncludeLaunchDescription"))
_ENDS = frozenset(("exit", "_exit", "quit", "shutdown", "try_shutdown", "kill", "cancel"))


def awaited_ends(source: PythonSource, nodes: Sequence[Started]) -> Iterator[Finding]:
    """Yield handlers in a launch file that start something at the end of a program that spins for ever."""
    for call in source.calls:
        given = _HANDLERS.get(last_name(call.func), "")
        target, then = argument(call, 0, "target_action"), argument(call, 1, given)
        made = source.written(target) if given and isinstance(target, (ast.Name, ast.Attribute)) else target
        started = next((n for n in nodes if made and n.launched.place == source.at(made)), None)
        begun = [n for n in _begun(source, then) if n is not made] if then else []
        if not (given and started and begun):
            continue
        if spin := _spins_on(started.entrance):
            program, next_ = started.launched.executable, ast.unparse(then) if then else ""
            cause = f"{last_name(call.func)} waits for the end of {program}, which spins until it is stopped ({spin}), so what is to follow is never started."
            fix = f"write `OnProcessStart(target_action={ast.unparse(target or call)}, on_start={next_})`, with `from launch.event_handlers import OnProcessStart` at the top, if it is to begin as soon as {program} runs; otherwise let {program} end, by `raise SystemExit` where its work is done"
            yield Finding("launch-lost", cause, source.at(call), fix, (program,))


def _begun(source: PythonSource, then: ast.expr) -> list[ast.expr]:
    """Return the calls that make what an expression starts: nodes, processes and other launch files."""
    held = then.elts if isinstance(then, (ast.List, ast.Tuple)) else [then]
    return [made for made in map(source.written, held) if last_name(getattr(made, "func", None)) in _STARTS]


def _spins_on(entrance: Entrance | None) -> str:
    """Return where a program spins for ever; empty if it may end by itself, or is not known."""
    if entrance is None:
        return ""
    lasting = [call for call in entrance.calls if call.is_lasting and call.function is entrance.function]
    others = [function for function in entrance.functions if function is not entrance.function]
    inside = [node for function in others for node in own_nodes(function)]
    may_end = any(
        isinstance(node, ast.Raise) or (isinstance(node, ast.Call) and last_name(node.func) in _ENDS)
        for node in inside
    )
    given = any(isinstance(node, ast.Lambda) for function in entrance.functions for node in walk(function))
    if len(lasting) != 1 or may_end or given or entrance.may_do_more:
        return ""
    return lasting[0].source.at(lasting[0].call)
