"""Attributes and methods of a node class without effect: out of date, never read, met or called."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.hidden_logs import hidden_logs
from ros2lab.diagnose.nodes.stale_values import computed_once, meant_to_change
from ros2lab.diagnose.nodes.unreached import is_seen_whole, unreached
from ros2lab.diagnose.sources.commented_out import disabled
from ros2lab.diagnose.sources.interfaces import node_members
from ros2lab.diagnose.sources.node_source import LOG_METHODS, Creation, is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, last_name, own_nodes, parameters, walk
from ros2lab.diagnose.sources.spelling import is_near_miss, nearest, words_of
from ros2lab.diagnose.sources.static_value import UNKNOWN, dotted, holds
from ros2lab.diagnose.sources.syntax_parts import calls_in
from ros2lab.diagnose.sources.uses import State, Uses, is_log

_KEPT_TO_BE_USED = frozenset(("create_publisher", "create_client"))


def state_faults(uses: Uses) -> Iterator[Finding]:
    """Yield attributes and methods of node classes that have no effect."""
    if uses.named["setattr"]:
        return  # what it sets is not known
    for owner in uses.sources.nodes:
        if not uses.resolved[owner.name] and f"{owner.source.name}.main" not in uses.sources.functions:
            continue  # it is there for others, which may use it as they like
        state = State(uses, owner)
        yield from _quoted(state)
        yield from computed_once(state)
        yield from meant_to_change(state)
        yield from _never_read(state)
        yield from _never_equal(state)
        yield from _never_passed(state)
        yield from _never_called(state)
        yield from _never_published(state)
        yield from _never_shown(state)
        yield from _overwritten(state)
        for method in owner.methods.values():
            if id(method) in uses.callbacks:
                yield from _begun_anew(state, method)


def _quoted(state: State) -> Iterator[Finding]:
    """Yield strings that hold the name of an attribute where its value was meant."""
    for method in state.owner.methods.values():
        for node in own_nodes(method):
            match node:
                case ast.Assign(
                    targets=[ast.Attribute(attr=name), *_], value=ast.Constant(str(text)) as given
                ):
                    is_shown = name == "data"
                case ast.Call(func=ast.Attribute(attr=name), args=[ast.Constant(str(text)) as given, *_]):
                    is_shown = name in (*LOG_METHODS, "publish")
                case _:
                    continue
            if text in state.stores and (is_shown or isinstance(node, ast.Assign)):
                initial = state.stores[text][0][2]
                is_number = isinstance(initial, ast.Constant) and not isinstance(initial.value, str)
                meant = f"str({text})" if is_number and is_shown else text
                cause = f"{text!r} in quotes is only a string with the name of the attribute {text}, not its value."
                yield Finding("text-not-filled", cause, state.at(given), f"write {meant} without quotes")


def _never_read(state: State) -> Iterator[Finding]:
    """Yield attributes that a method sets and nothing reads, where one that never changes is read instead."""
    own = {text.removeprefix("self.") for text in state.stores if text.count(".") == 1}
    for name in sorted(own - state.read - set(state.owner.methods)):  # what is set may be a property
        method, node, value = state.stores[f"self.{name}"][-1]
        if method.name == "__init__" or isinstance(value, ast.Call):
            continue
        # A slip is made once; a name that is also set elsewhere is meant.
        known = sorted(own & state.read) if len(state.stores[f"self.{name}"]) == 1 else []
        near = next((candidate for candidate in known if is_near_miss(name, candidate)), None)
        if near and not state.later(f"self.{near}"):
            cause = f"{method.name}() sets self.{name}, which is never read; self.{near} is read instead."
            fix = f"write self.{near} instead of self.{name}"
            yield Finding("never-read", cause, state.at(node), fix)


def _never_equal(state: State) -> Iterator[Finding]:
    """Yield strings that an attribute is compared with but never set to."""
    for name, stores in state.stores.items():
        given = {v.value if isinstance(v, ast.Constant) else UNKNOWN: node for _, node, v in stores}
        are_texts = len(given) > 1 and all(isinstance(text, (str, type(None))) for text in given)
        if not are_texts or name.rpartition(".")[2] in state.uses.stored_of_others:
            continue
        compared = _compared_with(state, name)
        known = ", ".join(repr(value) for value in given)
        unused = [value for value in given if isinstance(value, str) and value not in compared]
        for text, node in compared.items():
            if text in given:
                continue
            near = nearest(text, unused, 0.6)
            cause = f"{name} is compared with {text!r}, but is only ever set to {known}."
            place = state.at(given[near] if near else node)
            is_alone = isinstance(state.owner.source.above(node), ast.Compare)
            what = "this comparison, with what depends on it" if is_alone else f"{text!r} here"
            fix = f"remove {what}, or set {name} to {text!r} where that begins"
            fix = f"write {text!r} instead of {near!r} here" if near else fix
            yield Finding("never-equal", cause, place, fix)


def _compared_with(state: State, name: str) -> dict[str, ast.Constant]:
    """Return the strings with which a class compares an attribute, each with its place."""
    asked = [n for n in walk(state.owner.definition) if isinstance(n, ast.Compare)]
    sides = [side for node in asked if dotted(node.left) == name for side in node.comparators]
    parts = [part for side in sides for part in walk(side) if isinstance(part, ast.Constant)]
    return {part.value: part for part in parts if isinstance(part.value, str)}


def _never_passed(state: State) -> Iterator[Finding]:
    """Yield conditions that stay as they are at first: only code that they block, or none, changes them."""
    methods = state.owner.methods.values()
    calls = [n for method in methods for n in calls_in(own_nodes(method))]
    publishes = [call for call in calls if getattr(call.func, "attr", "") == "publish"]
    for method in methods:
        for number, statement in enumerate(method.body):
            gate = _gate(state, statement)
            if gate is None or not isinstance(statement, ast.If):
                continue
            name, value, is_left = gate
            guarded = method.body[number + 1 :] if is_left else statement.body
            shut = {id(node) for inner in guarded for node in walk(inner)}
            later = [node for _, node, _ in state.later(name)]
            hidden = {ast.unparse(node.func) for node in publishes if id(node) in shut}
            hidden -= {ast.unparse(node.func) for node in publishes if id(node) not in shut}
            # A node that then publishes nothing is at fault; one that publishes less may be meant to.
            is_all = all(id(node) in shut for node in publishes)
            if all(id(node) in shut for node in later) and (later or (hidden and is_all)):
                yield _shut(state, value, method, statement, "" if later else min(hidden))


def _gate(state: State, statement: ast.stmt) -> tuple[str, ast.Constant, bool] | None:
    """Return the attribute that an `if` tests and that blocks code at first, its value then, and whether it leaves there."""
    if not isinstance(statement, ast.If) or statement.orelse:
        return None
    names = {ast.unparse(node) for node in walk(statement.test) if is_self_attribute(node)}
    name = names.pop() if len(names) == 1 else ""
    value, is_left = state.first(name), isinstance(statement.body[-1], (ast.Return, ast.Raise))
    is_shut = isinstance(value, ast.Constant) and holds(statement.test, {name: value.value}) is is_left
    return (name, value, is_left) if isinstance(value, ast.Constant) and is_shut else None


def _shut(state: State, value: ast.Constant, method: Function, statement: ast.If, hidden: str) -> Finding:
    test, place = ast.unparse(statement.test), state.at(statement)
    name = next(ast.unparse(node) for node in walk(statement.test) if is_self_attribute(node))
    if not hidden:
        cause = f"{name} starts as {value.value!r} and is changed only inside `if {test}:`, which is then never true."
        return Finding(
            "never-passed", cause, place, f"change {name} before this line, or test something else"
        )
    cause = f"{name} starts as {value.value!r} and nothing changes it, so {hidden}() in {method.name}() is never reached."
    if isinstance(value.value, bool):
        begin = f"such as in __init__ (line {value.lineno})"
        return Finding(
            "never-passed", cause, place, f"write `{name} = {not value.value}` where it should begin, {begin}"
        )
    fix = f"set {name} where its value is known, such as in the callback that receives it"
    return Finding("never-passed", cause, place, fix)


def _never_called(state: State) -> Iterator[Finding]:
    """Yield methods that nothing calls although they were meant to be called.

    Such a method looks like a callback and no other does its work, or it alone changes an attribute in use.
    """
    inherited = node_members()
    sources = state.uses.sources
    if not is_seen_whole(sources, state.owner) or sources.hands_itself_on(state.source):
        return  # others may
    # A name that is used without self is reported elsewhere.
    bare = {node.id for node in walk(state.owner.definition) if isinstance(node, ast.Name)}
    # So may one be whose name stands in a text, such as in a table of commands.
    bare |= {str(node.value) for node in state.uses.nodes if isinstance(node, ast.Constant)}
    for name, method in state.owner.methods.items():
        if name in state.read | bare | inherited or name.startswith("__") or method.decorator_list:
            continue
        takes = [parameter.arg for parameter in parameters(method)][1:]
        why, begun = "", ""
        if _is_callback(state, method, takes):
            why = "it is not passed to any timer, subscription or service"
            begun = _begun(state, method, takes)
        elif not state.uses.named[name] and (changed := _changed_alone(state, method)):
            why, begun = f"only it changes {changed}", _call_of(state, name, takes)
        if begun:
            cause = f"{name}() is defined but never called: {why}."
            place = state.at(method)
            yield Finding("never-called", cause, place, begun, never=(place,))


def _is_callback(state: State, method: Function, takes: list[str]) -> bool:
    """Return whether a method looks like a callback whose work no other method does."""
    own = _publishers(method)
    others = {
        publisher for m in state.owner.methods.values() if m is not method for publisher in _publishers(m)
    }
    made = {creation.method for creation in state.uses.sources.creations if creation.owner is state.owner}
    # If others do the same, it may well be a leftover.
    is_alone = (
        bool(own - others),
        "create_subscription" not in made,
        "create_service" not in made and takes[:1] and takes[0].startswith("req"),
    )
    looks_so = bool(own) or "callback" in method.name or takes in (["msg"], ["request", "response"])
    return looks_so and len(takes) < len(is_alone) and bool(is_alone[len(takes)])


def _is_message(state: State, method: Function, name: str) -> bool:
    """Return whether a method treats a parameter as a message: it reads a field of it, or uses nothing of it."""
    uses = [n for n in own_nodes(method) if isinstance(n, ast.Name) and n.id == name]
    read = [n for n in own_nodes(method) if isinstance(n, ast.Attribute) and n.value in uses]
    return not uses or name in ("msg", "message") or not all(map(state.source.is_called, read))


def _begun(state: State, method: Function, takes: list[str]) -> str:
    """Return where a method that looks like a callback may be used, by what it does with what it takes."""
    name = method.name
    reached = [m for m in state.owner.methods.values() if id(m) not in unreached(state.uses.sources)]
    line, back = disabled(state.source.text, reached, rf"\bself\.{name}\b(?=[(),])")
    if line:
        return f"{back}, which uses it, or remove {name}()"
    if not takes:
        timer = f"write `self.timer = self.create_timer(1.0, self.{name})` in __init__"
        # Another callback may be meant to call it, or it is left over.
        has_others = any(c.owner is state.owner and c.given("callback") for c in state.uses.sources.creations)
        is_certain = not has_others or not {"callback", "timer", "cb"}.isdisjoint(words_of(name))
        either = " if it is to run every second; otherwise call it where it is needed, or remove it"
        return timer if is_certain else f"{timer}{either}"
    if len(takes) == 1 and (found := _given_by_rclpy(state, method, takes[0])):
        return found
    if len(takes) == 1 and not _is_message(state, method, takes[0]):
        return f"write `self.{name}(...)` where its {takes[0]} is known, or remove it"
    made = ("create_subscription", "create_service")[len(takes) - 1]
    return f"pass self.{name} as the callback to a {made} in __init__"


def _given_by_rclpy(state: State, method: Function, name: str) -> str:
    """Return where the callback of an action client or of a future is given; empty if its parameter is neither."""
    asked = [n for n in own_nodes(method) if isinstance(n, ast.Attribute) and ast.unparse(n.value) == name]
    read, called = {n.attr for n in asked}, {n.attr for n in asked if state.source.is_called(n)}
    sent = next((c for c in state.source.calls if last_name(c.func) == "send_goal_async"), None)
    if sent and read == {"feedback"}:
        return f"write feedback_callback=self.{method.name} in the send_goal_async(...) on line {sent.lineno}"
    if called & {"result", "exception"}:
        given = f"pass self.{method.name} to add_done_callback(...) of the future whose result it reads"
        idle = [method, *(other for _, other in unreached(state.uses.sources).values())]
        left = {id(node) for other in idle for node in walk(other)}
        reads = (c for c in state.source.calls if last_name(c.func) == "result" and id(c) not in left)
        there = next((c for c in reads if not (c.args or c.keywords)), None)
        return f"{given}; or remove it, if line {there.lineno} reads that result already" if there else given
    return ""


def _changed_alone(state: State, method: Function) -> str:
    """Return the attribute that only this method changes, if callbacks read it or only log; else empty."""
    callbacks = state.uses.callbacks
    own = [callback for callback in state.owner.methods.values() if id(callback) in callbacks]
    is_idle = bool(own) and all(map(_only_logs, own))
    for text, stores in state.stores.items():
        readers = [reader.name for reader, _ in state.loads.get(text, ()) if id(reader) in callbacks]
        changing = {m.name for m, *_ in stores} | {m.name for m in state.changing_in_place(text)}
        is_alone = changing == {"__init__", method.name} and text.count(".") == 1
        if is_alone and (readers or is_idle):
            return f"{text}, {f'which {readers[0]}() reads' if readers else 'and the callbacks only log'}"
    return ""


def _publishers(method: Function) -> set[str]:
    """Return the expressions whose publish() a method uses."""
    return {
        ast.unparse(n.value)
        for n in own_nodes(method)
        if isinstance(n, ast.Attribute) and n.attr == "publish"
    }


def _only_logs(function: Function) -> bool:
    """Return whether a function does nothing but log."""
    logged = {id(n) for call in own_nodes(function) if is_log(call) for n in walk(call)}
    kinds = (ast.Call, ast.Return, ast.Raise, ast.Assign, ast.AugAssign)
    return not any(isinstance(node, kinds) and id(node) not in logged for node in own_nodes(function))


def _call_of(state: State, name: str, takes: list[str]) -> str:
    """Say in which callback to call a method that nothing calls; empty if none has what it takes."""
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
    kind = (creation.source.resolve(creation.given("msg_type")) or "").rpartition(".")[2]
    is_whole = takes[0] in ("msg", "message", kind.lower())
    is_plain = kind in ("String", "Bool") or kind.startswith(("Int", "UInt", "Float"))
    what = f"{message}.data" if is_plain and not is_whole else message
    return f"write `self.{name}({what})` in {function.name}()"


def _never_published(state: State) -> Iterator[Finding]:
    """Yield publishers of a class that publishes nothing; where it does publish, one may be a leftover."""
    if any(getattr(node, "attr", "") == "publish" for node in walk(state.owner.definition)):
        return
    for creation in state.uses.sources.creations:
        if (
            creation.owner is not state.owner
            or creation.method != "create_publisher"
            or creation.function is None
        ):
            continue
        name = creation.kept
        last = name.rpartition(".")[2]
        if not last.isidentifier() or state.uses.named[last]:
            continue
        kept = name if name.startswith("self.") else f"self.{name}"
        fix = _sent_there(state, creation, kept)
        fix = fix if kept == name else f"write {kept} instead of {name}, and {fix.removeprefix('write ')}"
        cause = f"{name} is a publisher, but nothing publishes with it."
        yield Finding("never-sent", cause, state.at(creation.call), fix)


def _sent_there(state: State, creation: Creation, kept: str) -> str:
    """Return where a publisher may publish: in a callback that receives its type, unless it hears the same topic."""
    methods = state.owner.methods.values()
    line, back = disabled(state.source.text, methods, rf"{re.escape(kept)}\.publish\(")
    if line:
        return f"{back}, or remove the publisher"
    kind, topic = (_text(state, creation, name) for name in ("msg_type", "topic"))
    others = [c for c in state.uses.sources.creations if c.owner is state.owner]
    heard = [c for c in others if c.method == "create_subscription" and _text(state, c, "msg_type") == kind]
    if not heard and any(c.method in ("create_subscription", "create_timer") for c in others):
        return f"write {kept}.publish(...) in a callback, with a {kind} that is made there"
    if heard and all(_text(state, c, "topic") == topic for c in heard):
        topic = ast.unparse(creation.given("topic") or ast.Constant(topic))
        return f"write another topic here, or remove the publisher: a callback that publishes on {topic}, which it receives itself, never comes to an end"
    if not heard:
        return f"write {kept}.publish(...) where there is a {kind} to send, or remove the publisher"
    return f"write {kept}.publish(msg) in the callback that has the message"


def _text(state: State, creation: Creation, name: str) -> str:
    """Return what an argument is, or how it is written where that is not known."""
    given = creation.given(name)
    value = state.uses.sources.value(creation.source, given)
    return value.lstrip("/") if isinstance(value, str) else ast.unparse(given) if given else ""


def _never_shown(state: State) -> Iterator[Finding]:
    """Yield nodes that only log, all of it at a level that is not shown."""
    own = [method for method in state.owner.methods.values() if id(method) in state.uses.callbacks]
    hidden = hidden_logs(state.uses.sources, state.owner) if own and all(map(_only_logs, own)) else None
    if hidden:
        yield Finding("never-shown", f"{hidden.why}.", hidden.source.at(hidden.calls[0]), hidden.fix)


def _overwritten(state: State) -> Iterator[Finding]:
    """Yield publishers and clients whose name is given to another one before they are used."""
    for method in state.owner.methods.values():
        kept: dict[str, ast.Assign] = {}
        for statement in method.body:
            used = {ast.unparse(n) for n in walk(statement) if isinstance(getattr(n, "ctx", None), ast.Load)}
            kept = {name: first for name, first in kept.items() if name not in used}
            if any(name.removeprefix("self.") in state.owner.methods for name in used):
                kept.clear()  # a method may use them
            match statement:
                case ast.Assign(
                    targets=[ast.Attribute() as target], value=ast.Call(func=ast.Attribute(attr=how))
                ) if how in _KEPT_TO_BE_USED:
                    name = ast.unparse(target)
                case _:
                    continue
            if first := kept.get(name):
                cause = f"{name} is replaced by another {how.removeprefix('create_')} here, so the one from line {first.lineno}, `{ast.unparse(first.value)}`, is never used."
                fix = f"write another name here, such as {name}_2, and use it wherever this one is meant"
                yield Finding("replaced", cause, state.at(statement), fix)
            kept[name] = statement


def _begun_anew(state: State, method: Function) -> Iterator[Finding]:
    """Yield counters that a callback resets each time before it adds to them."""
    begun: dict[str, ast.stmt] = {}
    for statement in method.body:
        match statement:
            case ast.Assign(targets=[ast.Attribute(attr=name) as target], value=ast.Constant()) if (
                is_self_attribute(target)
            ):
                begun.setdefault(name, statement)
            case ast.AugAssign(target=ast.Attribute(attr=name) as target, value=ast.Constant()) if (
                is_self_attribute(target) and name in begun
            ):
                stores, loads = state.stores[f"self.{name}"], state.loads.get(f"self.{name}", ())
                others = {user.name for user, *_ in (*stores, *loads)} - {"__init__", method.name}
                # One that is set to something else in between does not count.
                if not others and sum(user is method for user, *_ in stores) == 2:
                    cause = f"{method.name}() resets self.{name} with `{ast.unparse(begun[name])}` each time, so it never grows."
                    line, is_begun = ast.unparse(begun[name]), any(user is not method for user, *_ in stores)
                    fix = f"remove `{line}` here" if is_begun else f"move `{line}` into __init__"
                    yield Finding("begun-anew", cause, state.at(begun[name]), fix)
