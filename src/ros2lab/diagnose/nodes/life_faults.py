"""The life cycle of a node: init, spin and shutdown, and what keeps its callbacks from being called."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.code.deadlocks import GROUP_IMPORTED, spun_by_threads
from ros2lab.diagnose.finding import Finding, in_a_row
from ros2lab.diagnose.nodes.asked_early import asked_early, old_parameters
from ros2lab.diagnose.nodes.endless_loops import (
    endless_loops,
    has_others_than,
    rate_faults,
    spins_on,
    threads_of,
)
from ros2lab.diagnose.nodes.entrance_faults import entrance_faults
from ros2lab.diagnose.nodes.executors import several_threads, two_executors
from ros2lab.diagnose.nodes.shutdowns import shut_down, shut_down_at_first
from ros2lab.diagnose.nodes.spin_loops import spin_inside
from ros2lab.diagnose.nodes.unreached import unreached, unreached_faults
from ros2lab.diagnose.nodes.waits_for_others import waits_for_another
from ros2lab.diagnose.sources.answered import ends_open, plain_returns, unanswered
from ros2lab.diagnose.sources.entrance import SPINNING, Entrance
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources
from ros2lab.diagnose.sources.one_run import in_loops, is_always_reached, may_end, own_calls, run_once
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    assigned_to,
    assignments,
    given_to,
    is_generator,
    last_name,
    names_bound,
    names_read,
    own_nodes,
    parameters,
    walk,
)
from ros2lab.diagnose.sources.qualities import policies_of
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import calls_in, calls_of, removal

_ASKED = "create_service"  # its callback answers, so that it can only wait itself until it has done what it is asked for
_TRANSITIONS = frozenset(
    f"on_{transition}"
    for transition in ("configure", "activate", "deactivate", "cleanup", "shutdown", "error")
)


def life_faults(sources: NodeSources, mains: list[str] | None) -> Iterator[Finding]:
    """Yield faults in how programs and their nodes start, run and end; `mains` are what executables call, None any `main`."""
    for name in (
        mains if mains is not None else [main for main in sources.functions if main.endswith(".main")]
    ):
        if name in sources.functions:
            entrance = Entrance(sources, name)
            yield from entrance_faults(entrance, mains or ())
            yield from two_executors(entrance)
            yield from several_threads(entrance)
    for source in sources.sources.values():
        yield from _spin_not_called(sources, source)
    yield from _callback_faults(sources)
    for owner in filter(sources.is_managed, sources.nodes):
        yield from _transition_faults(owner)


def _spin_not_called(sources: NodeSources, source: PythonSource) -> Iterator[Finding]:
    made = {
        text for text, call in source.made if (sources.resolve(source, call.func) or "") in sources.classes
    }
    name = made.pop() if len(made) == 1 else "node"
    for node in source.nodes:
        if isinstance(node, ast.Expr) and source.resolve(node.value) in ("rclpy.spin", "rclpy.init"):
            text = ast.unparse(node.value)
            cause = f"`{text}` only names the function; without parentheses it is not called."
            fix = f"write {text}({name})" if text.endswith("spin") else f"write {text}()"
            yield Finding(
                "spin-missing" if text.endswith("spin") else "rclpy-init-missing", cause, source.at(node), fix
            )


def _transition_faults(owner: NodeClass) -> Iterator[Finding]:
    """Yield transition callbacks of a managed node that skip what rclpy's own do, or return nothing."""
    made = [ast.unparse(n.func) for n in calls_in(walk(owner.definition))]
    has_managed = any(name.endswith(".create_lifecycle_publisher") for name in made)
    for name, method in owner.methods.items():
        if name not in _TRANSITIONS:
            continue
        called = {n.func.attr for n in calls_in(own_nodes(method)) if isinstance(n.func, ast.Attribute)}
        if has_managed and name in ("on_activate", "on_deactivate") and name not in called:
            does = name.removeprefix("on_")
            cause = f"{name}() overrides the method that would {does} this node's lifecycle publishers, so their state does not change."
            given = ", ".join(parameter.arg for parameter in parameters(method)[1:]) or "state"
            agreed = [n for n in own_nodes(method) if isinstance(n, ast.Return) and _agrees(n)]
            places = [f"instead of line {n.lineno}" for n in agreed]
            places += ["as its last line"] * (not agreed or ends_open(method))
            fix = f"write `return super().{name}({given})` {in_a_row(places)}"
            yield Finding("transition-wrong", cause, owner.source.at(method), fix)
        elif fix := unanswered(method, "TransitionCallbackReturn.SUCCESS"):
            cause = f"{name}() returns nothing, so the transition counts as failed."
            if plain := [n for n in plain_returns(method) if n.value]:
                cause = f"{name}() returns {ast.unparse(plain[0]).removeprefix('return ')}, which is no answer to a transition."
            if "TransitionCallbackReturn" not in owner.source.names:
                fix += ", with `from rclpy.lifecycle import TransitionCallbackReturn` at the top"
            yield Finding("transition-wrong", cause, owner.source.at(method), fix)


def _agrees(node: ast.Return) -> bool:
    """Return whether a statement says that a transition has succeeded."""
    value = getattr(node.value, "value", None) if isinstance(node.value, ast.Constant) else node.value
    return value is True or (isinstance(value, ast.Attribute) and value.attr == "SUCCESS")


def _callback_faults(sources: NodeSources) -> Iterator[Finding]:
    running: list[tuple[PythonSource, Function, NodeClass | None, str]] = []
    # What a service shares with others waits for its answer.
    for creation, function in sorted(sources.callbacks(), key=lambda made: made[0].method != _ASKED):
        running.append((creation.source, function, creation.owner, f"the callback {function.name}"))
    for node_class in sources.nodes:
        if "__init__" in node_class.methods:
            running.append((node_class.source, node_class.methods["__init__"], node_class, "the constructor"))
    repeated = {
        id(function)
        for creation, function in sources.callbacks()
        if creation.method in ("create_timer", "create_subscription", "create_service")
    }
    seen: set[int] = set()
    waits = dict[str, Finding]()
    for source, function, owner, what in running:
        if id(function) in seen:
            continue
        seen.add(id(function))
        own = [sources.method(owner, name) for name in own_calls(function)]
        functions = [function, *(method for method in own if method and not is_generator(method))]
        yield from endless_loops(sources, source, owner, functions, what)
        waits |= {f.place: f for f in _waits(sources, source, owner, functions, what) if f.place not in waits}
        yield from _needs_asyncio(sources, source, functions, what)
        yield from waits_for_another(sources, source, owner, functions, what)
        yield from asked_early(sources, source, owner, functions, what)
        if what == "the constructor":
            yield from shut_down_at_first(sources, source, owner, function)
            continue
        if spins_on(sources, source):
            yield from shut_down(sources, source, owner, function)
        if id(function) in repeated and id(function) not in unreached(sources):
            yield from _made_again(sources, source, functions)
    yield from waits.values()
    yield from unreached_faults(sources)
    yield from rate_faults(sources)
    yield from _sent_early(sources)
    yield from old_parameters(sources)


def _needs_asyncio(
    sources: NodeSources, source: PythonSource, functions: list[Function], what: str
) -> Iterator[Finding]:
    """Yield uses of asyncio in a callback, which rclpy runs without an asyncio event loop."""
    starts = re.compile(r"asyncio\.run|run_until_complete|run_forever|event_loop")
    texts = (sources.sources[name].text for name in sources.together(source.name))
    if any(map(starts.search, texts)) or threads_of(sources, source):
        return
    for function in functions:
        for node in own_nodes(function):
            called = node.value if isinstance(node, ast.Await) else None
            name = source.resolve(called.func) or "" if isinstance(called, ast.Call) else ""
            if name.startswith("asyncio."):
                cause = f"{what[0].upper()}{what[1:]} is run by rclpy, which has no asyncio event loop, so {name}() fails."
                fix = f"{removal(source, node)}, and do what should happen later in a method of a timer: self.later = self.create_timer(period, self.method), with self.later.cancel() as the first line of that method, so that it runs once"
                yield Finding("callback-waits", cause, source.at(node), fix)


def _sent_early(sources: NodeSources) -> Iterator[Finding]:
    """Yield messages published only before the node spins, when no subscriber can have connected."""
    waits = re.compile(r"subscription_count|sleep\(|wait|input\(", re.IGNORECASE)
    if any(waits.search(source.text) for source in sources.sources.values()):
        return
    bases = {base for derived in sources.classes.values() for base in derived.bases}
    for owner in sources.nodes:
        made = owner.methods.get("__init__")
        if made is not None and not sources.is_managed(owner) and owner.name not in bases:
            sent = _sent_while_made(sources, owner, made)
            fix = "publish in a method, and call it with a timer: create_timer(1.0, self.that_method)"
            yield from (_early(owner.source, call, "in the constructor", fix) for call in sent[:1])
    for creation in sources.creations:
        if creation.method != "create_publisher" or creation.owner or not creation.function:
            continue
        if policies_of(sources, creation).get("durability") == "VOLATILE":
            yield from _sent_at_once(sources, creation.source, creation.function, creation.call)


def _sent_while_made(sources: NodeSources, owner: NodeClass, made: Function) -> list[ast.Call]:
    """Return the messages of a node class if all of them are sent once, in its constructor; else none."""
    if any(getattr(node, "attr", "") in SPINNING for node in own_nodes(made)):
        return []
    sent = [n for n in calls_in(walk(owner.definition)) if _is_publish(n.func)]
    kept = set(map(_publisher_of, sent))
    files = [node for source in sources.sources.values() for node in source.nodes]
    others = [n for n in calls_in(files) if _is_publish(n.func) and n not in sent]
    early = run_once(sources, owner, made, files)
    is_early = all(id(call) in early for call in sent) and kept.isdisjoint(map(_publisher_of, others))
    return sent if is_early and _are_not_kept(sources, owner, sent) else []


def _publisher_of(call: ast.Call) -> str:
    """Return the attribute whose `publish` is called."""
    return getattr(getattr(call.func, "value", None), "attr", "")


def _are_not_kept(sources: NodeSources, owner: NodeClass, sent: list[ast.Call]) -> bool:
    """Return whether none of the publishers that send is known or likely to keep messages for later subscribers."""
    made = {id(creation.call): creation for creation in sources.creations}
    kept: dict[str, list[str]] = {}
    for source in {inner.source for inner in sources.lineage(owner)[0]}:
        for name, call in source.made:
            if creation := made.get(id(call)):
                kept.setdefault(name, []).append(policies_of(sources, creation).get("durability", ""))
    names = {ast.unparse(node.func).rpartition(".")[0] for node in sent}
    return all(set(kept.get(name, ())) == {"VOLATILE"} for name in names)


def _sent_at_once(
    sources: NodeSources, source: PythonSource, function: Function, made: ast.Call
) -> Iterator[Finding]:
    """Yield messages sent right after the publisher is created, without a wait or spin in between."""
    name = source.name_of(made)
    sent = [n for n in source.calls if ast.unparse(n.func) == f"{name}.publish"]
    at_once = run_once(sources, None, function, ())
    if not name or not sent or not all(id(n) in at_once for n in sent):
        return
    if _spins_before(function, made) or _takes_time(
        sources, source, function, range(made.lineno, sent[0].lineno)
    ):
        return
    node = ast.unparse(made.func.value) if isinstance(made.func, ast.Attribute) else "node"
    fix = f"write `while {name}.get_subscription_count() == 0: rclpy.spin_once({node}, timeout_sec=0.1)` above this line, and `rclpy.spin_once({node}, timeout_sec=1.0)` below it"
    yield _early(source, sent[0], "as soon as its publisher has been created", fix)


def _spins_before(function: Function, made: ast.Call) -> bool:
    """Return whether a function spins until rclpy is shut down before it makes something: then no waiting helps."""
    before = (n for n in calls_in(own_nodes(function)) if n.lineno < made.lineno)
    return any(getattr(call.func, "attr", "") == "spin" for call in before)


def _takes_time(sources: NodeSources, source: PythonSource, function: Function, lines: range) -> bool:
    """Return whether some lines of a function spin, or call what may: a function or a class of one's own."""
    own = sources.functions.keys() | sources.classes.keys()
    calls = [n for n in calls_in(own_nodes(function)) if n.lineno in lines]
    return any(
        getattr(call.func, "attr", "").startswith("spin") or sources.resolve(source, call.func) in own
        for call in calls
    )


def _early(source: PythonSource, sent: ast.Call, when: str, fix: str) -> Finding:
    cause = f"`{ast.unparse(sent.func)}(...)` runs once, {when}, before any subscriber is connected, so nothing receives the message."
    return Finding("sent-early", cause, source.at(sent), fix)


def _is_publish(function: ast.expr) -> bool:
    return isinstance(function, ast.Attribute) and function.attr == "publish"


# What a callback that makes more of something each time does, by the method, and where to make it instead.
_AGAIN = {
    "create_timer": (
        "timer-in-callback",
        "starts another timer each time, while the earlier ones keep running",
        "create the timer once, in __init__, if it is to fire again and again; if it is to fire once after each call, keep it in an attribute of self, cancel here the one that was kept before, and cancel it in its own callback, too",
    ),
    **{
        f"create_{what}": (
            "made-again",
            f"makes one more {what} each time{more}",
            f"move create_{what}(...) into __init__, and keep it as an attribute of self",
        )
        for what, more in (
            ("publisher", ""),
            ("client", ""),
            ("subscription", ", so that each message is received more and more often"),
        )
    },
}


def _made_again(sources: NodeSources, source: PythonSource, functions: list[Function]) -> Iterator[Finding]:
    """Yield what a callback creates each time, where it is not ended before and no state of the node guards it."""
    first = functions[0]
    calls = own_calls(first)
    for function in functions:
        if function is not first and not is_always_reached(first, calls[function.name]):
            continue
        for node in calls_of(own_nodes(function), *_AGAIN):
            ends = _ends_of_last(sources, source, functions, node)
            if ends is not None and (
                is_always_reached(function, node) or _asks_message(source, function, node)
            ):
                how = getattr(node.func, "attr", "")
                code, does, fix = _AGAIN[how]
                if "publisher" in does and _is_used_at_once(sources, source, function, node):
                    does += ", to which no subscriber is connected yet when it is used"
                cause = f"{first.name}() is called repeatedly and {does}."
                key = _from_outside(function, node)
                if key and how in ("create_publisher", "create_client"):
                    fix = f"keep each in a dictionary of self under `{key}`, and call {how}(...) only where the dictionary has none for it yet"
                elif ends or key:
                    fix = _in_its_place(source, node)
                if ends:
                    cause += f" `{ast.unparse(ends[0])}` on line {ends[0].lineno} ends only the last one."
                yield Finding(code, cause, source.at(node), fix)


def _in_its_place(source: PythonSource, made: ast.Call) -> str:
    """Say how to end what a callback made the last time, where another takes its place."""
    what = last_name(made.func).removeprefix("create_")
    name = source.name_of(made) or f"self.{what}"
    others = [value for value in assigned_to(source.nodes, name) if value is not made]
    end = f"`self.destroy_{what}({name})`"
    fix = "" if source.name_of(made) else f"write `{name} = {ast.unparse(made)}` here; and "
    if others and all(isinstance(value, ast.Call) for value in others):
        return f"{fix}write {end} above this line, so that the new one takes the place of the one before"
    fix += f"write `if {name} is not None:` above this line, and {end} indented below it"
    return fix if others else f"{fix}; and `{name} = None` in __init__"


def _from_outside(function: Function, made: ast.Call) -> str:
    """Return the argument of a call that depends on what the function is given; empty if none does."""
    given = {parameter.arg for parameter in parameters(function)[1:]}
    for target, value in assignments(own_nodes(function)):
        if not given.isdisjoint(names_read(walk(value))):
            given |= names_bound(walk(target))
    return next(
        (ast.unparse(arg) for arg in given_to(made) if not given.isdisjoint(names_read(walk(arg)))), ""
    )


def _ends_of_last(
    sources: NodeSources, source: PythonSource, functions: list[Function], made: ast.Call
) -> list[ast.Call] | None:
    """Return what ends the last of the things that a callback makes; None if something else may be ended, or each of them.

    What calls the callback may be stopped, so that it is called once, or what it makes is made anew.
    """
    name, given = source.name_of(made), {last_name(value) for value in given_to(made)}
    own = [f for f in source.nodes if isinstance(f, Function) and f.name in given]
    before = {id(node) for function in (*functions, *own) for node in walk(function)}
    calls = [call for file in sources.sources.values() for call in file.calls]
    ends = [call for call in calls if re.match("(cancel|destroy)(?!_node)", last_name(call.func) or "")]
    here = {last_name(target) for target, value in assignments(source.nodes) if isinstance(value, ast.Call)}
    ended = {id(call): call.args[0] if call.args else getattr(call.func, "value", call) for call in ends}
    ends = [call for call in ends if call in source.calls or last_name(ended[id(call)]) in here]
    is_last = (
        bool(name) and id(call) not in before and ast.unparse(ended[id(call)]) == name for call in ends
    )
    return ends if all(is_last) else None


def _asks_message(source: PythonSource, function: Function, made: ast.Call) -> bool:
    """Return whether only what a callback is given decides whether it makes something that it keeps in an attribute."""
    given, inner = {parameter.arg for parameter in parameters(function)[1:]}, source.above(made)
    while inner is not None and isinstance(above := source.above(inner), ast.If):
        if not {n.id for n in walk(above.test) if isinstance(n, ast.Name)} <= given:
            return False
        inner = above
    is_first = inner in function.body and not any(map(may_end, function.body[: function.body.index(inner)]))
    return is_first and source.name_of(made).startswith("self.")


def _is_used_at_once(sources: NodeSources, source: PythonSource, function: Function, made: ast.Call) -> bool:
    """Return whether only the function that makes a publisher sends with it, and does not wait in between."""
    name = source.name_of(made) or ast.unparse(made)
    sent = [node for node in source.calls if ast.unparse(node.func) == f"{name}.publish"]
    own = {id(node) for node in own_nodes(function)}
    if not sent or any(id(node) not in own for node in sent):
        return False
    lines = range(made.lineno, sent[0].lineno)
    between = (node for node in own_nodes(function) if getattr(node, "lineno", 0) in lines)
    waits = (
        isinstance(node, ast.While) or last_name(getattr(node, "func", None)) == "sleep" for node in between
    )
    return not any(waits) and not _takes_time(sources, source, function, lines)


def _waits(
    sources: NodeSources, source: PythonSource, owner: NodeClass | None, functions: list[Function], what: str
) -> Iterator[Finding]:
    """Yield spins in callbacks and constructors, and the first call in a function that blocks a callback for long."""
    is_alone = not has_others_than(sources, owner, functions[0])
    asked = [
        made for made, function in sources.callbacks() if function is functions[0] and made.method == _ASKED
    ]
    # Where there is no other callback, a service may take its time, and a loop may be all that the node does.
    is_free = what == "the constructor" or threads_of(sources, source) or (is_alone and bool(asked))
    for function in functions:
        repeated = in_loops(function) if is_alone else set()
        calls = [
            (call, source.resolve(call.func) or dotted(call.func) or "")
            for call in calls_in(own_nodes(function))
        ]
        yield from (
            spin_inside(source, owner, function, c, what) for c, name in calls if name == "rclpy.spin"
        )
        rests = [pair for pair in calls if id(pair[0]) not in repeated and _rests(*pair)]
        for node, name in rests[: not is_free]:
            cause = f"{what[0].upper()}{what[1:]} waits in {name}(), and no other callback is called until it continues."
            fix = "do the next step in a timer callback, with create_timer(period, self.callback), instead of waiting"
            if name == "input":
                fix = f"call {name}() in a separate thread, and let the callback only use the result"
            elif asked:
                threads = spun_by_threads(sources, source) or ["the spin with a MultiThreadedExecutor"]
                group = "callback_group=MutuallyExclusiveCallbackGroup()"
                fix = f"write {threads[0]}, and add {group} to create_service(...) on line {asked[0].call.lineno}, {GROUP_IMPORTED}"
            yield Finding("callback-waits", cause, source.at(node), fix)


def _rests(call: ast.Call, name: str) -> bool:
    """Return whether a call waits for a key, or for a second or longer."""
    seconds = getattr(call.args[0], "value", None) if call.args else None
    return name == "input" or (name == "time.sleep" and isinstance(seconds, (int, float)) and seconds >= 1)
