"""Parameters that a node reads only when it is made, although it is said that they change while it runs."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding, in_a_row
from ros2lab.diagnose.sources.python_source import (
    Function,
    argument,
    assignments,
    names_bound,
    own_nodes,
    walk,
)
from ros2lab.diagnose.sources.uses import State

_READERS = frozenset(("get_parameter", "declare_parameter"))
_WHILE_IT_RUNS = re.compile(
    r"\bat run-?\s?time\b|\bwhile\b[^.;]*\brun(s|ning)\b|\bparam set\b", re.IGNORECASE
)
_DENIED = re.compile(r"\b(cannot|not|never|only|no)\b|n't\b", re.IGNORECASE)


def meant_to_change(state: State) -> Iterator[Finding]:
    """Yield parameters of which the file says that they are changed while the node runs, and which it reads once."""
    yield from (finding for name, finding in read_once(state) if _is_said_to_change(state, name))


def read_once(state: State) -> Iterator[tuple[str, Finding]]:
    """Yield the parameters that a node reads only in its constructor and then uses as they were."""
    init = state.owner.methods.get("__init__")
    if init is None:
        return
    own = names_bound(own_nodes(init)) | {a.arg for a in (*init.args.args, *init.args.kwonlyargs)} - {"self"}
    inside = {id(node) for node in walk(init)}
    for target, value in assignments(own_nodes(init)):
        text = ast.unparse(target)
        named = [
            n for n in walk(value) if isinstance(n, ast.Call) and getattr(n.func, "attr", "") in _READERS
        ]
        names = [state.uses.sources.value(state.source, call.args[0]) for call in named if call.args]
        reads = [n for n in state.uses.nodes if _reads(n, names)]
        is_plain = len(names) == 1 and not own & {n.id for n in walk(value) if isinstance(n, ast.Name)}
        is_kept = is_plain and isinstance(names[0], str) and state.initial(text) is not None
        if not is_kept or any(id(node) not in inside for node in reads):
            continue
        read = f"self.get_parameter({names[0]!r})"
        written = f"{text} = {ast.unparse(value).replace(ast.unparse(named[0]), read)}"
        users = dict.fromkeys(m.name for m, _ in state.loads.get(text, ()) if id(m) in state.uses.callbacks)
        rows = [f"`{written}` as the first line of {name}()" for name in users]
        rows = rows or [*_of_timers(state, init, text, written)]
        if rows:
            cause = f"The node reads the parameter {names[0]} only in __init__, so setting it later changes nothing."
            yield str(names[0]), Finding("parameter-once", cause, state.at(target), f"write {in_a_row(rows)}")


def _of_timers(state: State, init: Function, text: str, written: str) -> Iterator[str]:
    """Yield how a timer whose period is kept in an attribute takes its new period: each time that it is called."""
    for node in own_nodes(init):
        if not isinstance(node, ast.Call) or getattr(node.func, "attr", "") != "create_timer":
            continue
        period, called = argument(node, 0, "timer_period_sec"), argument(node, 1, "callback")
        if period is None or called is None or text not in ast.unparse(period):
            continue
        if method := state.owner.methods.get(getattr(called, "attr", "")):
            kept = state.source.name_of(node)
            if not kept:
                yield f"`self.timer = {ast.unparse(node)}` on line {node.lineno}"
            changed = f"{kept or 'self.timer'}.timer_period_ns = int({ast.unparse(period)} * 1e9)"
            yield f"`{written}` and `{changed}` as the first lines of {method.name}()"


def _reads(node: ast.AST, names: list[object]) -> bool:
    return (
        isinstance(node, ast.Call)
        and getattr(node.func, "attr", "") == "get_parameter"
        and any(getattr(given, "value", None) in names for given in node.args[:1])
    )


def _is_said_to_change(state: State, name: str) -> bool:
    """Return whether a sentence in a docstring, a comment or the parameter's description says that it is changed."""
    scopes = [
        n for n in walk(state.source.tree) if isinstance(n, (ast.Module, ast.ClassDef, ast.FunctionDef))
    ]
    texts = [text for scope in scopes if (text := ast.get_docstring(scope))]
    texts += [row.partition("#")[2] for row in state.source.text.splitlines() if "#" in row]
    declared = [
        n
        for n in state.uses.nodes
        if isinstance(n, ast.Call) and getattr(n.func, "attr", "") == "declare_parameter"
    ]
    for call in declared:
        if call.args and getattr(call.args[0], "value", None) == name:
            values = (getattr(n, "value", None) for n in walk(call))
            texts += [f"{name}: {value}" for value in values if isinstance(value, str) and value != name]
    sentences = [sentence for text in texts for sentence in re.split(r"[.;!]\s", text)]
    word = re.compile(rf"\b{re.escape(name)}\b")
    return any(
        word.search(sentence) and _WHILE_IT_RUNS.search(sentence) and not _DENIED.search(sentence)
        for sentence in sentences
    )
