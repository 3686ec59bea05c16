"""Topics that do not connect: names that are nearly alike, other types or other qualities of service."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass
from functools import cached_property, lru_cache

from ros2lab import assignments
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.late_readers import late_readers
from ros2lab.diagnose.nodes.node_faults import TOPIC_NAME
from ros2lab.diagnose.nodes.own_answers import answers_itself, by_variable, called_always
from ros2lab.diagnose.nodes.partners import Partners, made_in, name_in
from ros2lab.diagnose.nodes.qos_written import with_policy, with_profile_of
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.construction import may_run
from ros2lab.diagnose.sources.node_source import Creation, NodeSources
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, own_nodes, parameters
from ros2lab.diagnose.sources.qualities import POLICIES, policies_of
from ros2lab.diagnose.sources.spelling import is_near_miss
from ros2lab.rhythm import has_period

_ASSIGNMENT = assignments.load()
# What the course asks of its packages, that of the assignment and that of lesson 4: topics with their types and, if fixed, periods in s.
_ASKED: Mapping[str, Mapping[str, tuple[str, float]]] = {
    _ASSIGNMENT.package: {
        part.topic.lstrip("/"): (part.type_name.replace("/", "."), part.period)
        for part in _ASSIGNMENT.parts.values()
    },
    "my_robot_controller": {"robot_news": ("std_msgs.msg.String", 0.0)},
}
COURSE_TOPICS = frozenset(topic for topics in _ASKED.values() for topic in topics)


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
        named = self.creation.given("topic")
        return self.creation.source.at(named or self.creation.call)

    @cached_property
    def name(self) -> str:
        """Its topic, with the name of its node instead of `~`; empty if that is not known."""
        node = self.sources.node_name(self.creation)
        return name_in(node, self.topic) if self.is_private else self.topic

    @cached_property
    def space(self) -> str:
        """The namespace that the code gives its node, if that applies to its name; empty for none."""
        is_below = not self.is_private and not self.is_absolute
        return self.sources.node_name(self.creation).rpartition("/")[0] if is_below else ""

    @property
    def full_name(self) -> str:
        """Its name with the namespace that the code gives its node."""
        return f"{self.space}/{self.name}".lstrip("/")

    @property
    def is_private(self) -> bool:
        """Whether its name begins with that of its node."""
        return self.topic.startswith("~")

    @property
    def is_absolute(self) -> bool:
        """Whether its name begins with a slash, so that no namespace is put before it."""
        written = self.sources.value(self.creation.source, self.creation.given("topic"))
        return isinstance(written, str) and written.startswith("/")


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
            qos = policies_of(sources, creation)
            topic = topic.lstrip("/") if is_named else ""
            is_publisher = creation.method == "create_publisher"
            found.append(End(topic, name, is_publisher, qos, creation, sources))
    return found


@lru_cache(maxsize=32)
def asked_of(sources: NodeSources) -> Mapping[str, tuple[str, float]]:
    """Return what the course asks of a package or a file: topics with types and periods; nothing of other work.

    The course's are the packages with its names, and whatever uses two topics of the assignment with their types.
    """
    tops = {name.partition(".")[0] for name in sources.sources}
    parts = _ASKED[_ASSIGNMENT.package]
    used = {end.topic for end in ends_of(sources) if parts.get(end.topic, ("",))[0] == end.type}
    named = next((topics for name, topics in _ASKED.items() if name in tops), {})
    return parts if len(used) > 1 else named


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


def topic_faults(
    ends: list[End], remapped: Set[str] = frozenset(), partners: Partners | None = None
) -> Iterator[Finding]:
    """Yield faults that keep the topics of a workspace from connecting to each other or to the course's."""
    partners = partners or Partners()
    by_topic: dict[str, list[End]] = {}
    for end in ends:
        if end.name and remapped.isdisjoint((end.topic, end.name)):
            by_topic.setdefault(end.full_name, []).append(end)
    by_topic = {topic: _in_use(there) for topic, there in by_topic.items()}
    unnamed = [end for end in ends if not end.topic]
    yield from _near_misses(by_topic, unnamed, partners)
    yield from _copied(by_topic, partners)
    for topic, there in by_topic.items():
        yield from answers_itself(repr(topic), there)
        yield from _types(topic, there, unnamed, partners)
        yield from _qualities(topic, there, partners)
        yield from late_readers(topic, there, partners)
        yield from _periods(topic, there)
    for (_, written), there in by_variable(ends).items():
        yield from answers_itself(written, there)


def _in_use(there: list[End]) -> list[End]:
    """Return the ends of a topic without those that never run, if others in their direction do."""
    if len(there) < 2:
        return there
    runs = [end for end in there if may_run(end.sources, end.creation.source, end.creation.owner)]
    taken = {end.is_publisher for end in runs}
    return [end for end in there if end in runs or end.is_publisher not in taken]


def _near_misses(
    by_topic: Mapping[str, list[End]], unnamed: list[End], partners: Partners
) -> Iterator[Finding]:
    for topic, there in by_topic.items():
        end = there[0]
        if topic in COURSE_TOPICS or {end.is_publisher for end in there} == {True, False}:
            continue
        # The workspace's own topics come before the course's, which contain no node's name.
        near = [(name, ends) for name, ends in by_topic.items() if is_near_miss(topic, name)]
        near = near or _only_other(end, by_topic)
        facing = [(name, ends) for name, ends in near if _may_face(there, ends)]
        others = [ends[0].name for name, ends in facing if not _has_partner(name, ends, unnamed, partners)]
        course = [
            (name, own)
            for own in there
            for name, (kind, _) in asked_of(own.sources).items()
            if not own.is_private and is_near_miss(topic, name) and own.type in (None, kind)
        ]
        meant = [*((name, end) for name in others), *(pair for pair in course if pair[0] not in by_topic)]
        wanted, end = next(iter(meant), ("", end))
        if wanted and not _has_partner(topic, there, unnamed, partners):
            verb = "publishes on" if end.is_publisher else "subscribes to"
            reached = "reach subscribers to" if end.is_publisher else "receive what is published on"
            contrast = f"it does not {reached} {wanted!r}" if others else f"the course's topic is {wanted!r}"
            cause = f"This node {verb} {end.name!r}, but {contrast}: the names differ."
            fix = f"write {wanted!r} if that is meant (a leading slash may stay)"
            yield Finding("topic-near-miss", cause, end.place, fix, (end.name, wanted))


def _only_other(end: End, by_topic: Mapping[str, list[End]]) -> list[tuple[str, list[End]]]:
    """Return the only topic that fits an end which is named after its type, its callback or the node that publishes, or that another node has."""
    kind = (end.type or "").split(".")
    fitting = [
        (name, [o for o in ends if o.type == end.type and _may_connect(end, o)])
        for name, ends in by_topic.items()
    ]
    other = [(name, ends) for name, ends in fitting if ends]
    nodes = [o.sources.node_name(o.creation) for _, ends in other for o in ends if not end.is_publisher]
    taken = {"/".join(kind), "/".join(kind[::2]), kind[-1], last_name(end.creation.given("callback")), *nodes}
    is_own = end.is_private and not end.is_publisher  # which only its own node could publish on
    taken |= {
        end.topic for name, _ in other if is_own and name.rpartition("/")[2] == end.topic.rpartition("/")[2]
    }
    return other if end.type and len(other) == 1 and end.topic in taken else []


def _may_face(there: list[End], others: list[End]) -> bool:
    """Return whether the ends of a topic, which all have one direction, may be meant for those of another."""
    is_facing = {end.is_publisher for end in others} == {not there[0].is_publisher}
    may_connect = any(_may_connect(end, other) for end in there for other in others)
    # A class that uses both names, such as `tx` and `rx`, means both.
    are_apart = {*map(made_in, others)}.isdisjoint(map(made_in, there))
    return is_facing and may_connect and others[0].space == there[0].space and are_apart


def _may_connect(end: End, other: End) -> bool:
    """Return whether two ends of one topic would be one's partner: of the other direction, not of another type."""
    return end.is_publisher is not other.is_publisher and (
        not end.type or not other.type or end.type == other.type
    )


def _has_partner(topic: str, there: list[End], unnamed: list[End], partners: Partners) -> bool:
    """Return whether an end with a name that is only known when it runs, or another program, may be a partner."""
    at_run_time = any(_may_connect(end, other) for end in there for other in unnamed)
    return at_run_time or partners.may_be_elsewhere(topic)


def _copied(by_topic: Mapping[str, list[End]], partners: Partners) -> Iterator[Finding]:
    """Yield publishers on a topic that has others, while the topic their file is named after has none.

    Both topics begin alike, such as `crane/height` and `crane/reach`: others may come from another program.
    """
    for topic, there in by_topic.items():
        if (
            any(end.is_publisher for end in there)
            or topic in COURSE_TOPICS
            or partners.may_be_elsewhere(topic)
        ):
            continue
        space = topic.rpartition("/")[0]
        for other, ends in by_topic.items():
            publishers = [
                end
                for end in ends
                if end.is_publisher and end.type == there[0].type and partners.are_together(end, there[0])
            ]
            files = {end.creation.source.shown: end for end in publishers}
            named = [
                end for shown, end in files.items() if _in_name(topic, shown) and not _in_name(other, shown)
            ]
            if space and other.rpartition("/")[0] == space and len(files) > 1 and len(named) == 1:
                cause = f"Two programs publish on {other!r}, but none on {topic!r}, which {there[0].creation.source.shown} subscribes to."
                fix = f"write {topic!r} instead of {other!r} here"
                yield Finding("topic-near-miss", cause, named[0].place, fix, (topic, other))


def _in_name(topic: str, shown: str) -> bool:
    """Return whether a file's name contains the last part of a topic's name."""
    return topic.rpartition("/")[2].lower() in shown.rpartition("/")[2].lower()


def _makes_its_type(end: End) -> bool:
    """Return whether the file of an end creates messages of the type that the end names."""
    source = end.creation.source
    return any(end.sources.resolve(source, call.func) == end.type for call in source.calls)


def _users(end: End, right: str) -> str:
    """Say what else in the file of an end would not fit another type: messages made or fields read; empty if nothing."""
    creation = end.creation
    if end.is_publisher:
        return f"where a {str(end.type).rpartition('.')[2]} is made" if _makes_its_type(end) else ""
    function = end.sources.function_of(creation, creation.given("callback"))
    taken = [argument.arg for argument in parameters(function)[-1:]] if function else []
    used = [n for n in own_nodes(function) if isinstance(n, ast.Attribute)] if function else []
    read = {n.attr for n in used if ast.unparse(n.value) in taken}
    strange = sorted(read - {*(interfaces.fields_of(right) or read)})
    return f"the callback, which reads {' and '.join(strange)}" if strange else ""


def _types(topic: str, there: list[End], unnamed: list[End], partners: Partners) -> Iterator[Finding]:
    """Yield ends without a partner of their type: what they are compared with has another type, or the course has."""
    # Newer robots take another type.
    is_newer = topic == "cmd_vel" and any(str(end.type).endswith("TwistStamped") for end in there)
    alone = [end for end in there if end.type and not any(_may_connect(end, other) for other in there)]
    for end in alone:
        facing = [other for other in there if other.is_publisher is not end.is_publisher]
        others = [other for other in facing if partners.are_together(end, other, there)]
        wanted = asked_of(end.sources).get(topic, ("", 0.0))[0] if not is_newer else ""
        right = wanted if wanted and (others or not facing) else _right_type(end, others, there, alone)
        if not right or end.type == right or _has_partner(topic, [end], unnamed, partners):
            continue
        kind = right.rpartition(".")[2]
        cause = f"On {end.name!r} this node uses {end.type}, but {'the course' if wanted else 'another node'} uses {right}, so no messages arrive."
        fix = f"write {kind}, with `from {right.rpartition('.')[0]} import {kind}`"
        if users := _users(end, right):
            fix = f"{fix}, and change {users}, too"
            fix += "" if wanted else "; or, if each type is right, give one of the two topics another name"
        yield Finding("topic-type", cause, end.place, fix, (end.name, right))


def _right_type(end: End, others: list[End], there: list[End], alone: list[End]) -> str | None:
    """Return the type that an end and those on the other side of its topic should have; None without any.

    Who has a partner is right, or else the first whose file creates messages of its type, or else the first.
    """
    if not others:
        return None
    both = [other for other in there if other is end or other in others]
    met = [other for other in both if other not in alone]
    return next(iter([*met, *filter(_makes_its_type, both), *both])).type


def _qualities(topic: str, there: list[End], partners: Partners) -> Iterator[Finding]:
    """Yield subscriptions that no publisher of their type offers what they require."""
    for listener in (end for end in there if not end.is_publisher):
        offers = [end for end in there if _may_connect(listener, end)]
        for name, policy in POLICIES.items() if listener.type and offers else ():
            wanted = listener.qos.get(name, "")
            least = policy.strictness(wanted)
            is_refused = least is not None and all(
                end.type
                and (offered := policy.strictness(end.qos.get(name, ""))) is not None
                and offered < least
                and partners.are_together(listener, end, there)
                for end in offers
            )
            if is_refused and not partners.may_be_elsewhere(topic):
                cause = f"The subscription to {topic!r} requires {policy.in_words(wanted)}, but the publisher offers {policy.in_words(offers[0].qos[name]).removeprefix(f'{policy.words} ')}, so nothing arrives."
                yield Finding("qos-mismatch", cause, listener.place, _alike(offers[0], listener, name))


def _alike(publisher: End, listener: End, policy: str) -> str:
    """Return what to write so that a subscription gets what it requires, or requires what it gets."""
    if policy != "reliability":
        return f"{with_policy(publisher, policy, listener.qos[policy])}, in {publisher.place}"
    return with_profile_of(listener, publisher) or with_policy(listener, policy, "BEST_EFFORT")


def _periods(topic: str, there: list[End]) -> Iterator[Finding]:
    for end in there:
        period = asked_of(end.sources).get(topic, ("", 0.0))[1]
        for timer, seconds in timers_of(end):
            if period and not has_period(seconds, period):
                cause = f"'/{topic}' is published every {seconds:g} s, but the course asks for every {period:g} s."
                fix = f"write create_timer({period}, ...)"
                yield Finding("period", cause, timer.source.at(timer.call), fix, (topic,))


def timers_of(end: End) -> Iterator[tuple[Creation, float]]:
    """Yield the timers that publish on a topic with every call, with their periods in s where known."""
    for timer in publishing_timers(end):
        seconds = end.sources.value(timer.source, timer.given("timer_period_sec"))
        if isinstance(seconds, (int, float)):
            yield timer, float(seconds)


def publishing_timers(end: End) -> Iterator[Creation]:
    """Yield the timers that publish on a topic with every call."""
    for creation, function in _timers(end):
        # Only unconditional calls.
        calls = [s.value for s in function.body if isinstance(s, ast.Expr) and isinstance(s.value, ast.Call)]
        if f"{end.creation.kept}.publish" in [ast.unparse(call.func) for call in calls]:
            yield creation


def goes_on(end: End) -> bool:
    """Return whether a timer always publishes on a topic, itself or by the methods that it calls."""
    sent = f"{end.creation.kept}.publish"
    owner = end.creation.owner
    return any(sent in dict(called_always(end.sources, owner, function)) for _, function in _timers(end))


def _timers(end: End) -> Iterator[tuple[Creation, Function]]:
    """Yield the timers of the node that publishes on a topic, with their callbacks."""
    if not end.is_publisher or not end.creation.kept:
        return
    for creation in end.sources.creations:
        is_timer = creation.method == "create_timer" and creation.owner is end.creation.owner
        given = creation.given("callback")
        function = end.sources.function_of(creation, given) if is_timer else None
        if function is not None:
            yield creation, function
