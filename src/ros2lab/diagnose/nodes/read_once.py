"""Parameters that a node reads only when it is made, although they are to be set while it runs."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding, in_a_row
from ros2lab.diagnose.sources.python_source import (
    Function,
    argument,
    assignments,
    last_name,
    names_bound,
    own_nodes,
    walk,
)
from ros2lab.diagnose.sources.syntax_parts import calls_in, calls_of
from ros2lab.diagnose.sources.uses import State

_READERS = frozenset(("get_parameter", "declare_parameter"))


def meant_to_change(state: State) -> Iterator[Finding]:
    """Yield parameters that a node reads once, although its file says to change them by `ros2 param set`."""
    yield from (finding for name, finding in read_once(state) if _is_said_to_change(state, name))


def read_once(state: State) -> Iterator[tuple[str, Finding]]:
    """Yield the parameters that a node reads only in its constructor and then uses as they were."""
    init = state.owner.methods.get("__init__")
    if init is None:
        return
    inside = {id(node) for node in walk(init)}
    for target, value in assignments(own_nodes(init)):
        text = ast.unparse(target)
        name, call = _parameter_of(state, init, value)
        reads = [node for node in state.uses.nodes if _reads(node, name)]
        if call is None or state.initial(text) is None or any(id(node) not in inside for node in reads):
            continue
        read = f"self.get_parameter({name!r})"
        written = f"{text} = {ast.unparse(value).replace(ast.unparse(call), read)}"
        users = dict.fromkeys(m.name for m, _ in state.loads.get(text, ()) if id(m) in state.uses.callbacks)
        rows = [f"`{written}` as the first line of {name}()" for name in users]
        rows = rows or [*_of_timers(state, init, text, written)]
        if rows:
            cause = (
                f"The node reads the parameter {name} only in __init__, so setting it later changes nothing."
            )
            yield name, Finding("parameter-once", cause, state.at(target), f"write {in_a_row(rows)}")


def _of_timers(state: State, init: Function, text: str, written: str) -> Iterator[str]:
    """Yield how a timer whose period is kept in an attribute takes its new period: each time that it is called."""
    for node in calls_of(own_nodes(init), "create_timer"):
        period, called = argument(node, 0, "timer_period_sec"), argument(node, 1, "callback")
        if period is None or called is None or text not in ast.unparse(period):
            continue
        if method := state.owner.methods.get(getattr(called, "attr", "")):
            kept = state.source.name_of(node)
            if not kept:
                yield f"`self.timer = {ast.unparse(node)}` on line {node.lineno}"
            changed = f"{kept or 'self.timer'}.timer_period_ns = int({ast.unparse(period)} * 1e9)"
            yield f"`{written}` and `{changed}` as the first lines of {method.name}()"


def _parameter_of(state: State, init: Function, value: ast.expr) -> tuple[str, ast.Call | None]:
    """Return the only parameter that a value is made of, and the call that reads it; None if it is made of more."""
    calls = [n for n in calls_in(walk(value)) if last_name(n.func) in _READERS and n.args]
    own = names_bound(own_nodes(init)) | {a.arg for a in (*init.args.args, *init.args.kwonlyargs)} - {"self"}
    name = state.uses.sources.value(state.source, calls[0].args[0]) if len(calls) == 1 else None
    is_plain = isinstance(name, str) and not own & {n.id for n in walk(value) if isinstance(n, ast.Name)}
    return (str(name), calls[0]) if is_plain else ("", None)


def _reads(node: ast.AST, name: str) -> bool:
    match node:
        case ast.Call(args=[ast.Constant(value=given), *_]):
            return given == name and last_name(node.func) == "get_parameter"
    return False


def _is_said_to_change(state: State, name: str) -> bool:
    """Return whether a line gives the command that changes it: prose is not understood."""
    rows = [row for row in state.source.text.splitlines() if "ros2 param set" in row]
    return any(re.search(rf"\b{re.escape(name)}\b", row) for row in rows)
