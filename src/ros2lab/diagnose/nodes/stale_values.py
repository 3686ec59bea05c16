"""What a node computes or reads only once, although it changes while the node runs."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding, in_a_row
from ros2lab.diagnose.sources.node_source import is_self_attribute
from ros2lab.diagnose.sources.python_source import (
    Function,
    argument,
    assignments,
    last_name,
    names_bound,
    own_nodes,
    walk,
)
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import calls_in, calls_of, makes_text
from ros2lab.diagnose.sources.uses import State


def computed_once(state: State) -> Iterator[Finding]:
    """Yield values that the constructor computes once from what changes later, and callbacks still use."""
    for text in state.stores:
        value = state.initial(text)
        whole = ".".join(text.split(".")[:2])  # the attribute of which it may be a field
        if value is None or (whole != text and state.initial(whole) is None):
            continue
        readers = [
            (method, node)
            for method, node in state.loads.get(whole, ())
            if id(method) in state.uses.callbacks
        ]
        is_made = makes_text(value) or isinstance(value, ast.BinOp)
        is_sent = whole != text and isinstance(value, (ast.Attribute, ast.BinOp))
        if not readers or not (is_made or is_sent):
            continue
        used = {dotted(node) or "" for node in walk(value) if isinstance(node, ast.Attribute)}
        changed = next(
            ((attribute, by) for attribute in sorted(used) if (by := state.changes(attribute))), None
        )
        if changed is None or not (is_sent or makes_text(value) or _is_shown(readers)):
            continue
        attribute, by = changed
        if _is_of_use(state, attribute, value):
            continue  # it changes for others, and this may be what it was at first
        line = f"{text} = {ast.unparse(value)}"
        cause = (
            f"{text} is computed only once, in __init__, and is not updated when {by}() changes {attribute}."
        )
        fix = f"write `{line}` as the first line of {readers[0][0].name}()"
        yield Finding("computed-once", cause, state.at(state.stores[text][0][1]), fix)


def _is_of_use(state: State, attribute: str, value: ast.expr) -> bool:
    """Return whether an attribute is read anywhere but in a value that is computed once, or to change it."""
    inside = {id(node) for node in walk(value)}
    reads = [node for _, node in state.loads.get(attribute, ()) if id(node) not in inside]
    return bool(reads) or attribute.rpartition(".")[2] in state.uses.read_of_others


def _is_shown(readers: list[tuple[Function, ast.AST]]) -> bool:
    """Return whether what is read is assigned unchanged to a field of a message."""
    return any(
        isinstance(node, ast.Assign) and node.value is given and not is_self_attribute(node.targets[0])
        for method, given in readers
        for node in own_nodes(method)
    )


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
