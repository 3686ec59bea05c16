"""Topics that do not connect: names that are nearly alike, other types or other qualities of service."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from ros2lab import assignments
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.late_readers import late_readers
from ros2lab.diagnose.nodes.node_faults import TOPIC_NAME
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.node_source import Creation, NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, PythonSource, own_nodes
from ros2lab.diagnose.sources.spelling import is_near_miss
from ros2lab.rhythm import has_period

# The course's topics, each with its type and, if fixed, its period in s; the last is from lesson 4.
COURSE_TOPICS: Mapping[str, tuple[str, float]] = {
    part.topic.lstrip("/"): (part.type_name.replace("/", "."), part.period)
    for part in assignments.load().parts.values()
} | {"robot_news": ("std_msgs.msg.String", 0.0)}

_DEEPEST = 5  # methods that are followed from one to the next


@dataclass(frozen=True)
class End:
    """A publisher or a subscription, as the source has it."""

    topic: str
    type: str | None
    is_publisher: bool
    qos: Mapping[str, str]
    creation: Creation
    sources: NodeSources

    @property
    def place(self) -> str:
        """Where the topic is named."""
        named = (self.creation.arguments or {}).get("topic")
        return self.creation.source.at(named or self.creation.call)

    @cached_property
    def name(self) -> str:
        """Its topic, with the name of its node instead of `~`; empty if that is not known."""
        return _named(self.topic, self.creation, self.sources)

    @property
    def is_private(self) -> bool:
        """Whether its name begins with that of its node."""
        return self.topic.startswith("~")

    @property
    def is_absolute(self) -> bool:
        """Whether its name begins with a slash, so that no namespace is put before it."""
        written = self.sources.value(self.creation.source, (self.creation.arguments or {}).get("topic"))
        return isinstance(written, str) and written.startswith("/")


def _named(written: str, creation: Creation, sources: NodeSources) -> str:
    """Return a name without its first slash and with its node's name instead of `~`; empty if unknown."""
    if not written.startswith("~"):
        return written.lstrip("/")
    node = sources.node_name(creation)
    return f"{node}{written[1:]}" if node else ""


def ends_of(sources: NodeSources, *, unnamed: bool = False) -> list[End]:
    """List the publishers and subscriptions whose topics the sources name, without the leading slash.

    With `unnamed`, also those whose topic is known only when the node runs; it is empty.
    """
    found = []
    for creation in sources.creations:
        if creation.method not in ("create_publisher", "create_subscription") or creation.arguments is None:
            continue
        topic = sources.value(creation.source, creation.arguments.get("topic"))
        is_named = isinstance(topic, str) and TOPIC_NAME.fullmatch(topic)
        if is_named or (unnamed and not isinstance(topic, str)):
            kind = sources.resolve(creation.source, creation.arguments.get("msg_type"))
            name = kind if _is_there(kind) else None
            qos = _qos(sources, creation)
            found.append(
                End(
                    topic.lstrip("/") if is_named else "",
                    name,
                    creation.method == "create_publisher",
                    qos,
                    creation,
                    sources,
                )
            )
    return found


def word_sources(sources: NodeSources) -> list[PythonSource]:
    """Return the files that may compare received strings: those that subscribe to them, and their imports."""
    asking = [
        end.creation.source
        for end in ends_of(sources)
        if not end.is_publisher and end.type in (None, "std_msgs.msg.String")
    ]
    handed = [
        sources.sources[name]
        for source in asking
        for imported in source.imports
        for name in (imported.target, imported.target.rpartition(".")[0])
        if name in sources.sources
    ]
    return list(dict.fromkeys([*asking, *handed]))


def _is_there(kind: str | None) -> bool:
    """Return whether a type may exist, and its import is not misspelt, which is reported already."""
    module, _, short = (kind or "").rpartition(".")
    is_misspelt = interfaces.meant(module.partition(".")[0])
    return (
        interfaces.is_interface(kind)
        and not is_misspelt
        and short in (interfaces.names_in(module) or {short})
    )


def topic_faults(ends: list[End], remapped: Set[str] = frozenset()) -> Iterator[Finding]:
    """Yield faults that keep the topics of a workspace from connecting to each other or to the course's.

    Args:
        ends: the publishers and subscriptions of all its packages.
        remapped: topics that launch files rename, by `End.topic` or `End.name`.
    """
    by_topic: dict[str, list[End]] = {}
    for end in ends:
        if end.name and remapped.isdisjoint((end.topic, end.name)):
            by_topic.setdefault(end.name, []).append(end)
    by_topic = {topic: _in_use(there) for topic, there in by_topic.items()}
    yield from _near_misses(by_topic)
    yield from _copied(by_topic)
    for topic, there in by_topic.items():
        yield from _answers_itself(repr(topic), there)
        yield from _types(topic, there)
        yield from _qualities(topic, there)
        yield from late_readers(topic, there)
        yield from _periods(topic, there)
    for (_, written), there in _by_variable(ends).items():
        yield from _answers_itself(written, there)


def _in_use(there: list[End]) -> list[End]:
    """Return the ends of a topic without those that never run, if others in their direction do."""
    if len(there) < 2:
        return there
    runs = [end for end in there if end.sources.may_run(end.creation.source, end.creation.owner)]
    taken = {end.is_publisher for end in runs}
    return [end for end in there if end in runs or end.is_publisher not in taken]


def _by_variable(ends: list[End]) -> dict[tuple[Function, str], list[End]]:
    """Group the ends whose topic is known only at run time by their function and the topic's expression."""
    found: dict[tuple[Function, str], list[End]] = {}
    for end in ends:
        written, function = (end.creation.arguments or {}).get("topic"), end.creation.function
        if not end.topic and written is not None and function is not None:
            found.setdefault((function, ast.unparse(written)), []).append(end)
    return found


def _near_misses(by_topic: Mapping[str, list[End]]) -> Iterator[Finding]:
    for topic, there in by_topic.items():
        if topic in COURSE_TOPICS or {end.is_publisher for end in there} == {True, False}:
            continue
        is_publisher = there[0].is_publisher
        # The workspace's own topics come before the course's, which contain no node's name.
        others = [
            name
            for name, ends in by_topic.items()
            if name != topic and {end.is_publisher for end in ends} == {not is_publisher}
            # A class that uses both names, such as `tx` and `rx`, means both.
            if {*map(_made_in, ends)}.isdisjoint(map(_made_in, there))
        ]
        meant = others if there[0].is_private else [*others, *COURSE_TOPICS]
        wanted = next((name for name in meant if is_near_miss(topic, name)), None)
        if wanted:
            verb = "publishes on" if is_publisher else "subscribes to"
            who = (
                "it does not reach subscribers to"
                if is_publisher
                else "it does not receive what is published on"
            )
            contrast = f"{who} {wanted!r}" if wanted in others else f"the course's topic is {wanted!r}"
            yield Finding(
                "topic-near-miss",
                f"This node {verb} {topic!r}, but {contrast}: the names differ.",
                there[0].place,
                f"write {wanted!r} if that is meant (a leading slash may stay)",
                (topic, wanted),
            )


def _made_in(end: End) -> object:
    """Return the class that creates an end, or else the function or the file."""
    return end.creation.owner or end.creation.function or end.creation.source


def _copied(by_topic: Mapping[str, list[End]]) -> Iterator[Finding]:
    """Yield publishers on a topic that has others, while the topic their file is named after has none."""
    for topic, there in by_topic.items():
        if any(end.is_publisher for end in there) or topic in COURSE_TOPICS:
            continue
        for other, ends in by_topic.items():
            publishers = [end for end in ends if end.is_publisher and end.type == there[0].type]
            files = {end.creation.source.shown: end for end in publishers}
            named = [
                end for shown, end in files.items() if _in_name(topic, shown) and not _in_name(other, shown)
            ]
            if len(files) > 1 and len(named) == 1:
                cause = f"Two programs publish on {other!r}, but none on {topic!r}, which {there[0].creation.source.shown} subscribes to."
                fix = f"write {topic!r} instead of {other!r} here"
                yield Finding("topic-near-miss", cause, named[0].place, fix, (topic, other))


def _in_name(topic: str, shown: str) -> bool:
    """Return whether a file's name contains the last part of a topic's name."""
    return topic.rpartition("/")[2].lower() in shown.rpartition("/")[2].lower()


def _makes_its_type(end: End) -> bool:
    """Return whether the file of an end creates messages of the type that the end names."""
    source = end.creation.source
    calls = (node for node in source.nodes if isinstance(node, ast.Call))
    return any(end.sources.resolve(source, call.func) == end.type for call in calls)


def _types(topic: str, there: list[End]) -> Iterator[Finding]:
    known = [end for end in there if end.type]
    wanted = COURSE_TOPICS[topic][0] if topic in COURSE_TOPICS else None
    if topic == "cmd_vel" and any(str(end.type).endswith("TwistStamped") for end in known):
        wanted = None  # what newer robots take
    # The first end whose file creates messages of its type is right; if there is none, the first of all.
    first = next((end for end in known if _makes_its_type(end)), known[0] if known else None)
    for end in known:
        right = wanted or (first.type if first else None)
        if right and end.type != right:
            yield Finding(
                "topic-type",
                f"On {topic!r} this node uses {end.type}, but {'the course' if wanted else 'another node'} uses {right}, so no messages arrive.",
                end.place,
                f"write {right.rpartition('.')[2]}, with `from {right.rpartition('.')[0]} import {right.rpartition('.')[2]}`",
                (topic, right),
            )


def _qualities(topic: str, there: list[End]) -> Iterator[Finding]:
    for publisher in (end for end in there if end.is_publisher):
        for listener in (end for end in there if not end.is_publisher):
            for policy, strict, weak in (
                ("durability", "TRANSIENT_LOCAL", "VOLATILE"),
                ("reliability", "RELIABLE", "BEST_EFFORT"),
            ):
                if listener.qos.get(policy) == strict and publisher.qos.get(policy) == weak:
                    yield Finding(
                        "qos-mismatch",
                        f"The subscription to {topic!r} requires {policy} {strict}, but the publisher offers {weak}, so nothing arrives.",
                        listener.place,
                        f"give both the same {policy}",
                    )


def _qos(sources: NodeSources, creation: Creation) -> Mapping[str, str]:
    """Return the policies that are known of a quality of service."""
    default = {"durability": "VOLATILE", "reliability": "RELIABLE"}
    given = (creation.arguments or {}).get("qos_profile")
    if isinstance(given, ast.Constant):
        return default
    node = _definition(creation, given)
    name = sources.resolve(creation.source, given) or ""
    if name == "rclpy.qos.qos_profile_sensor_data":
        return {"durability": "VOLATILE", "reliability": "BEST_EFFORT"}
    if (
        not isinstance(node, ast.Call)
        or sources.resolve(creation.source, node.func) != "rclpy.qos.QoSProfile"
    ):
        return {}
    told = dict(default)
    for keyword in node.keywords:
        if keyword.arg in told:
            text = ast.unparse(keyword.value).rpartition(".")[2]
            told[keyword.arg] = (
                text if text in ("VOLATILE", "TRANSIENT_LOCAL", "RELIABLE", "BEST_EFFORT") else ""
            )
        elif keyword.arg is None:
            return {}
    return told


def _definition(creation: Creation, given: ast.expr | None) -> ast.expr | None:
    """Return the expression that a name stands for; None if it is assigned twice or changed afterwards."""
    if not isinstance(given, (ast.Name, ast.Attribute)):
        return given
    text = ast.unparse(given)
    values: list[Any] = [
        node.value
        for node in creation.source.nodes
        if isinstance(node, (ast.Assign, ast.AnnAssign))
        and text
        in [ast.unparse(t) for t in (node.targets if isinstance(node, ast.Assign) else [node.target])]
    ]
    changed = any(
        isinstance(node, ast.Attribute)
        and isinstance(node.ctx, ast.Store)
        and ast.unparse(node.value) == text
        for node in creation.source.nodes
    )
    return values[0] if len(values) == 1 and not changed else None


def _periods(topic: str, there: list[End]) -> Iterator[Finding]:
    period = COURSE_TOPICS[topic][1] if topic in COURSE_TOPICS else 0.0
    if not period:
        return
    for end in there:
        for timer, seconds in timers_of(end):
            if not has_period(seconds, period):
                yield Finding(
                    "period",
                    f"{topic!r} is published every {seconds:g} s, but the course asks for every {period:g} s.",
                    timer.source.at(timer.call),
                    f"write create_timer({period}, ...)",
                    (topic,),
                )


def timers_of(end: End) -> Iterator[tuple[Creation, float]]:
    """Yield the timers that publish on a topic with every call, with their periods in s where known."""
    for timer in publishing_timers(end):
        seconds = end.sources.value(timer.source, (timer.arguments or {}).get("timer_period_sec"))
        if isinstance(seconds, (int, float)):
            yield timer, float(seconds)


def publishing_timers(end: End) -> Iterator[Creation]:
    """Yield the timers that publish on a topic with every call."""
    for creation, function in _timers(end):
        # Only unconditional calls.
        calls = [s.value for s in function.body if isinstance(s, ast.Expr) and isinstance(s.value, ast.Call)]
        if f"{_kept_as(end)}.publish" in [ast.unparse(call.func) for call in calls]:
            yield creation


def goes_on(end: End) -> bool:
    """Return whether a timer always publishes on a topic, itself or by the methods that it calls."""
    sent = f"{_kept_as(end)}.publish"
    owner = end.creation.owner
    return any(sent in dict(_called_always(end.sources, owner, function)) for _, function in _timers(end))


def _timers(end: End) -> Iterator[tuple[Creation, Function]]:
    """Yield the timers of the node that publishes on a topic, with their callbacks."""
    if not end.is_publisher or not _kept_as(end):
        return
    for creation in end.sources.creations:
        is_timer = creation.method == "create_timer" and creation.owner is end.creation.owner
        given = (creation.arguments or {}).get("callback")
        function = end.sources.function_of(creation, given) if is_timer else None
        if function is not None:
            yield creation, function


def _answers_itself(topic: str, there: list[End]) -> Iterator[Finding]:
    """Yield callbacks that always publish on the topic they listen to, and so call themselves endlessly."""
    for listener in (end for end in there if not end.is_publisher and end.type):
        sources, creation = listener.sources, listener.creation
        callback = sources.function_of(creation, (creation.arguments or {}).get("callback"))
        calls = dict(_called_always(sources, creation.owner, callback)) if callback else {}
        for end in there:
            is_alike = (end.type, end.is_absolute) == (listener.type, listener.is_absolute)
            is_own = creation.owner is not None and end.creation.owner is creation.owner
            sent = calls.get(f"{_kept_as(end)}.publish") if end.is_publisher and is_alike and is_own else None
            if sent is not None:
                cause = f"The callback of {topic} publishes on {topic}, so the node receives its own messages and answers them endlessly."
                fix = "publish on another topic, or only under a condition that eventually becomes false"
                yield Finding("endless-loop", cause, creation.source.at(sent), fix)


def _called_always(
    sources: NodeSources, owner: NodeClass | None, function: Function, depth: int = 0
) -> Iterator[tuple[str, ast.Call]]:
    """Yield the calls that a function always makes, also by methods of its own; none if it may end early."""
    leaves = (ast.Return, ast.Raise, ast.Yield, ast.Await)
    ends = ("destroy", "shutdown", "exit", "cancel")
    for node in own_nodes(function):
        called = ast.unparse(node.func) if isinstance(node, ast.Call) else ""
        if isinstance(node, leaves) or any(word in called for word in ends):
            return
    waiting = list(reversed(function.body))
    while waiting:
        statement = waiting.pop()
        if isinstance(statement, (ast.With, ast.Try)):
            waiting += reversed(statement.body)
        elif isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call):
            call = statement.value
            yield ast.unparse(call.func), call
            method = sources.method(owner, call.func.attr) if is_self_attribute(call.func) else None
            if method is not None and depth < _DEEPEST:
                yield from _called_always(sources, owner, method, depth + 1)


def _kept_as(end: End) -> str | None:
    for node in end.creation.source.nodes:
        if isinstance(node, (ast.Assign, ast.AnnAssign)) and node.value is end.creation.call:
            target = node.targets[0] if isinstance(node, ast.Assign) else node.target
            return ast.unparse(target)
    return None
