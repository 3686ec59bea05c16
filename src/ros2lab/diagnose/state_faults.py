"""What a node class keeps, where it is changed too seldom for what reads it: once, never, or by what nobody calls."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.interfaces import members_of
from ros2lab.diagnose.node_source import LOG_METHODS, is_self_attribute
from ros2lab.diagnose.python_source import Function, own_nodes, parameters, walk
from ros2lab.diagnose.static_value import dotted
from ros2lab.diagnose.uses import State, Uses, is_log


def state_faults(uses: Uses) -> Iterator[Finding]:
    """Yield what the attributes of node classes show to stay as it was, or to be used by nothing."""
    if uses.named["setattr"]:
        return  # what it sets is not told
    for owner in uses.sources.nodes:
        state = State(uses, owner)
        yield from _quoted(state)
        yield from _computed_once(state)
        yield from _never_set(state)
        yield from _never_changed(state)
        yield from _never_published(state)


def _quoted(state: State) -> Iterator[Finding]:
    """Yield a text that says what an attribute is called, where its value was meant."""
    for method in state.owner.methods.values():
        for node in own_nodes(method):
            given: ast.expr | None = None
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Attribute):
                given = node.value
            elif (
                isinstance(node, ast.Call)
                and getattr(node.func, "attr", "") in (*LOG_METHODS, "publish")
                and node.args
            ):
                given = node.args[0]
            text = given.value if isinstance(given, ast.Constant) else None
            if isinstance(text, str) and text in state.stores:
                initial = state.stores[text][0][2]
                is_number = isinstance(initial, ast.Constant) and not isinstance(initial.value, str)
                is_shown = isinstance(node, ast.Call) or ast.unparse(node).startswith(
                    ("msg.data", "message.data")
                )
                meant = f"str({text})" if is_number and is_shown else text
                cause = f"{text!r} in quotes is a text, which says only what the attribute {text} is called."
                yield Finding(
                    "text-not-filled", cause, state.source.at(given), f"write {meant} without quotes"
                )


def _computed_once(state: State) -> Iterator[Finding]:
    """Yield what the constructor computes from something that changes later, and a callback still uses."""
    for text in state.stores:
        value = state.initial(text)
        base = text.rpartition(".")[0]
        if value is None or (base != "self" and state.initial(base) is None):
            continue
        readers = [
            (method, node)
            for method, node in state.loads.get(text if base == "self" else base, ())
            if id(method) in state.uses.callbacks
        ]
        if not readers or not _is_snapshot(value):
            continue
        used = {dotted(node) or "" for node in walk(value) if isinstance(node, ast.Attribute)}
        changed = next(((one, by) for one in sorted(used) if (by := state.changes(one))), None)
        if changed is None or (not _is_text(value) and not _is_shown(readers)):
            continue
        one, by = changed
        line = f"{text} = {ast.unparse(value)}"
        yield Finding(
            "computed-once",
            f"{text} is computed only once, in __init__, and stays as it is when {by}() changes {one}.",
            state.source.at(state.stores[text][0][1]),
            f"write `{line}` as the first line of {readers[0][0].name}()",
        )


def _is_text(value: ast.expr) -> bool:
    is_call = isinstance(value, ast.Call) and (
        dotted(value.func) == "str" or getattr(value.func, "attr", "") == "format"
    )
    return (
        is_call
        or isinstance(value, ast.JoinedStr)
        or (
            isinstance(value, ast.BinOp)
            and any(
                _is_text(n) or isinstance(getattr(n, "value", None), str) for n in (value.left, value.right)
            )
        )
    )


def _is_snapshot(value: ast.expr) -> bool:
    return _is_text(value) or isinstance(value, ast.BinOp)


def _is_shown(readers: list[tuple[Function, ast.AST]]) -> bool:
    """Return whether what is read goes as it is into a field of a message."""
    return any(
        isinstance(node, ast.Assign) and node.value is given and not is_self_attribute(node.targets[0])
        for method, given in readers
        for node in own_nodes(method)
    )


def _never_set(state: State) -> Iterator[Finding]:
    """Yield a condition for all that a publisher sends, which never holds: what it asks for is set once and for all."""
    publishes = [
        (method, node)
        for method in state.owner.methods.values()
        for node in own_nodes(method)
        if isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "publish"
    ]
    for method in state.owner.methods.values():
        for number, statement in enumerate(method.body):
            if not isinstance(statement, ast.If) or statement.orelse:
                continue
            name, is_wanted = _asks(statement.test)
            value = state.initial(f"self.{name}")
            if not isinstance(value, ast.Constant) or not isinstance(value.value, (bool, int)):
                continue
            is_left = isinstance(statement.body[-1], ast.Return)
            if (bool(value.value) is is_wanted and not is_left) or (
                bool(value.value) is not is_wanted and is_left
            ):
                continue
            shut = [*method.body[number + 1 :]] if is_left else statement.body
            inside = {id(node) for one in shut for node in walk(one)}
            hidden = {ast.unparse(node.func) for _, node in publishes if id(node) in inside}
            open_ = {ast.unparse(node.func) for _, node in publishes if id(node) not in inside}
            if hidden - open_:
                cause = f"self.{name} is {ast.unparse(value)} from the beginning and nothing changes it, so {min(hidden)}() in {method.name}() is never reached."
                right = not value.value if isinstance(value.value, bool) else 1
                yield Finding(
                    "never-passed",
                    cause,
                    state.source.at(statement),
                    f"write `self.{name} = {right}` where it is to begin, such as in __init__ (line {value.lineno})",
                )


def _asks(test: ast.expr) -> tuple[str, bool]:
    """Return the attribute that a condition asks for, and whether it must be true."""
    match test:
        case ast.Attribute(attr=name) if is_self_attribute(test):
            return name, True
        case ast.UnaryOp(op=ast.Not(), operand=ast.Attribute(attr=name) as inner) if is_self_attribute(inner):
            return name, False
        case ast.Compare(
            left=ast.Attribute(attr=name) as left,
            ops=[ast.Is() | ast.Eq() | ast.IsNot() | ast.NotEq()],
            comparators=[ast.Constant(value=True | False | None as wanted)],
        ) if is_self_attribute(left):
            return name, bool(wanted) is isinstance(test.ops[0], (ast.Is, ast.Eq))
    return "", True


def _never_changed(state: State) -> Iterator[Finding]:
    """Yield a method that nothing calls, where it alone changes what is read, or nothing else does anything."""
    inherited = members_of("rclpy.node", "Node")[0]
    callbacks = state.uses.callbacks
    own = [method for method in state.owner.methods.values() if id(method) in callbacks]
    is_idle = bool(own) and all(map(_only_logs, own))
    for name, method in state.owner.methods.items():
        if name.startswith("__") or name in inherited or method.decorator_list or state.uses.named[name]:
            continue
        for text, stores in state.stores.items():
            readers = [one.name for one, _ in state.loads.get(text, ()) if id(one) in callbacks]
            is_alone = {one.name for one, *_ in stores} == {"__init__", name} and text.count(".") == 1
            if not is_alone or not (readers or is_idle):
                continue
            if begun := _call_of(state, name, [one.arg for one in parameters(method)[1:]]):
                why = f"which {readers[0]}() reads" if readers else "and the callbacks only log"
                cause = f"{name}() is defined, and nothing calls it; only it changes {text}, {why}."
                yield Finding("never-called", cause, state.source.at(method), begun)
            break


def _only_logs(function: Function) -> bool:
    """Return whether a function stores nothing, and calls nothing but the logger."""
    logged = {id(n) for call in own_nodes(function) if is_log(call) for n in walk(call)}
    kinds = (ast.Call, ast.Return, ast.Raise, ast.Assign, ast.AugAssign)
    return not any(isinstance(node, kinds) and id(node) not in logged for node in own_nodes(function))


def _call_of(state: State, name: str, takes: list[str]) -> str:
    """Say where a method may be called that nothing calls: in the only callback that has what it takes."""
    methods = {id(method): method for method in state.owner.methods.values()}
    given = [
        (creation, function)
        for creation, function in state.uses.sources.callbacks()
        if id(function) in methods and creation.method in ("create_subscription", "create_timer")
    ]
    if not takes:
        timers = [function for creation, function in given if creation.method == "create_timer"]
        there = timers[:1] or [function for _, function in given][:1]
        return (
            f"write `self.{name}()` in {there[0].name}(), or self.create_timer(1.0, self.{name}) in __init__"
            if there
            else ""
        )
    received = [(c, f) for c, f in given if c.method == "create_subscription" and len(parameters(f)) > 1]
    if len(takes) != 1 or not received:
        return ""
    creation, function = received[0]
    message = parameters(function)[1].arg
    kind = (creation.source.resolve((creation.arguments or {}).get("msg_type")) or "").rpartition(".")[2]
    is_whole = takes[0] in ("msg", "message", kind.lower())
    is_plain = kind in ("String", "Bool") or kind.startswith(("Int", "UInt", "Float"))
    what = f"{message}.data" if is_plain and not is_whole else message
    return f"write `self.{name}({what})` in {function.name}()"


def _never_published(state: State) -> Iterator[Finding]:
    """Yield a publisher of a class that publishes nothing; beside another one it may well be left over."""
    if any(getattr(node, "attr", "") == "publish" for node in walk(state.owner.definition)):
        return
    for creation in state.uses.sources.creations:
        if (
            creation.owner is not state.owner
            or creation.method != "create_publisher"
            or creation.function is None
        ):
            continue
        values = [
            node.targets[0]
            for node in walk(creation.function)
            if isinstance(node, ast.Assign) and node.value is creation.call
        ]
        name = ast.unparse(values[0]) if values else ""
        if not values or not isinstance(values[0], (ast.Name, ast.Attribute)):
            continue
        if state.uses.named[name.rpartition(".")[2]]:
            continue
        kept = name if name.startswith("self.") else f"self.{name}"
        fix = f"write {kept}.publish(msg) in the callback that has the message"
        fix = fix if kept == name else f"write {kept} in place of {name}, and {fix.removeprefix('write ')}"
        cause = f"{name} is a publisher, and nothing publishes with it."
        yield Finding("never-sent", cause, state.source.at(creation.call), fix)
