"""What was seen of nodes while they ran, and the findings about it."""

from __future__ import annotations

import ast
import itertools
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from ros2lab import every_node
from ros2lab.assignments import Assignment
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.graph import finding_of
from ros2lab.diagnose.nodes.ros_graph import End, Fault, NearMiss, Observation, SharedName, graph_of
from ros2lab.diagnose.nodes.topic_faults import asked_of, ends_of, goes_on, timers_of
from ros2lab.diagnose.sources.entrance import Entrance
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.grading.evidence import Heard, Run
from ros2lab.rhythm import has_period, median_gap
from ros2lab.trial.contents import VELOCITIES, content_faults
from ros2lab.trial.ends import ended_together, explained, is_told_alone, needs_others
from ros2lab.trial.made_by_words import is_made_by_words
from ros2lab.trial.record import Error
from ros2lab.trial.spoken import NOTHING, Said
from ros2lab.trial.starts import executable_of
from ros2lab.trial.timers import pauseless
from ros2lab.trial.unended import unended_faults
from ros2lab.trial.unspun import unspun_fault
from ros2lab.trial.words import word_faults

SEEN_PERIOD = 5.0  # s; a timer with a longer period may not fire twice while its program is watched
LONGEST_PAUSE = 1.0  # s between two velocities; a robot that receives none for so long should stop
# Ways to control a program besides topics, which nobody uses while it is watched.
ASKS = frozenset(("create_service", "create_client", "add_post_set_parameters_callback", "input", "stdin"))


@dataclass(frozen=True)
class Seen:
    """The runs of a workspace's programs, each alone and all together, with their sources.

    Attributes:
        look: the workspace.
        assignment: which commands were sent, and where.
        alone: a run of each program.
        together: a run of all programs; empty if there is only one program.
        errors: the exceptions that were noted in the runs.
        said: what each program published by its own notes.
    """

    look: Look
    assignment: Assignment
    alone: Sequence[Run]
    together: Sequence[Run]
    errors: Sequence[Error] = ()
    said: Said = NOTHING

    @cached_property
    def _ends(self) -> list[Any]:
        return [end for package in self.look.packages for end in ends_of(self.look.sources(package))]

    def ends(self, topic: str, *, is_publisher: bool) -> list[Any]:
        """Return the publishers or subscriptions of a topic in the sources."""
        name = topic.rpartition("/")[2]
        return [
            e for e in self._ends if e.is_publisher is is_publisher and e.topic.rpartition("/")[2] == name
        ]

    def unwatched(self, file: str) -> list[str]:
        """Return the topics of a file's publishers and subscriptions that every node may have, and that no run records."""
        own = (f"/{end.topic.lstrip('/')}" for end in self._ends if end.creation.source.shown == file)
        return [topic for topic in dict.fromkeys(own) if topic in every_node.HIDDEN_TOPICS]

    def place(self, topic: str, *, is_publisher: bool = True) -> str:
        """Return the place of a publisher or subscription of a topic; empty if it is not known."""
        return next((end.place for end in self.ends(topic, is_publisher=is_publisher)), "")

    def filled(self, topic: str, field: str) -> str:
        """Return where a field such as `linear.x` is set; else where its topic is published."""
        for source in itertools.chain.from_iterable(
            package.sources.values() for package in self.look.packages
        ):
            for node in source.nodes:
                is_filled = isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store)
                if is_filled and ast.unparse(node).endswith(f".{field}"):
                    return source.at(node)
        return self.place(topic)

    def main(self, program: str) -> str:
        """Return the file with the entry point of a program; empty if it is not known."""
        found = self.entry(program)
        return found[0].sources[found[1]].shown if found else ""

    def entry(self, program: str) -> tuple[NodeSources, str] | None:
        """Return the sources of a package and the module with a program's entry point; None if not known."""
        for package in self.look.packages:
            for point in (package.setup.entry_points if package.setup else None) or ():
                if point.name == executable_of(program) and point.module in package.sources:
                    return self.look.sources(package), point.module
        return None

    def entrance(self, program: str) -> Entrance | None:
        """Return the entry point of a program, with all that it calls; None if it is not known."""
        for package in self.look.packages:
            for point in (package.setup.entry_points if package.setup else None) or ():
                sources, name = self.look.sources(package), f"{point.module}.{point.function}"
                if point.name == executable_of(program) and name in sources.functions:
                    return Entrance(sources, name)
        return None

    def names(self, run: Run) -> set[str]:
        """Return the names that the files of a program use, as far as they belong to its package."""
        found = self.entry(run.programs[0])
        files = (found[0].around(found[1]) or found[0]).sources if found else {}
        nodes = itertools.chain.from_iterable(source.nodes for source in files.values())
        return {getattr(node, "attr", getattr(node, "id", "")) for node in nodes}

    def are_apart(self, *nodes: str) -> bool:
        """Return whether no launch file starts all programs with nodes of these names."""
        runs = [run for run in self.alone if not set(nodes).isdisjoint(run.nodes)]
        programs = {executable_of(run.programs[0]) for run in runs}
        files = [{node.executable for node in file.nodes} for file in self.look.launch_files]
        return not any(programs <= started for started in files)

    def is_of_run(self, fault: Fault) -> bool:
        """Return whether a fault comes only from starting all programs together.

        Nodes with the same name may be alternatives if no launch file starts them together. Topics that nearly match
        may match if a launch file renames nodes or topics, except absolute ones.
        """
        if isinstance(fault, SharedName):
            return self.are_apart(fault.node)
        if not isinstance(fault, NearMiss) or not fault.meant_ends:
            return False
        ends = (*fault.ends, *fault.meant_ends)
        nodes = {end.node for end in ends}
        moved = {
            name
            for (_, name), started in self.look.launched.items()
            if started.namespace or started.launched.remappings
        }
        is_moved = any(
            executable_of(run.programs[0]) in moved and not nodes.isdisjoint(run.nodes) for run in self.alone
        )
        written = [
            written_end for end in ends for written_end in self.ends(end.topic, is_publisher=end.is_publisher)
        ]
        return (
            is_moved
            and self.are_apart(*nodes)
            and not any(written_end.is_absolute for written_end in written)
        )

    def heard(self, run: Run) -> dict[str, list[Heard]]:
        """Return everything that was published in a run, by topic and in order."""
        found: dict[str, list[Heard]] = {}
        for stretch in (run.quiet, *(command.topics for command in run.commands)):
            for topic, heard in stretch.items():
                found.setdefault(topic, []).append(heard)
        return found

    def published(self, run: Run) -> set[str]:
        """Return the topics on which something was published in a run: heard from outside, or noted by a program itself."""
        said = self.said.alone if run in self.alone else self.said.together
        noted = (topics.items() for name, topics in said.items() if name in run.programs)
        return {*self.heard(run), *(t for topics in noted for t, sent in topics if sent.count)}

    @property
    def command_topic(self) -> str:
        """The topic on which commands were sent; empty if none were."""
        return self.assignment.commanded.topic if self.assignment.commanded else ""

    @property
    def has_parameters(self) -> bool:
        """Whether all nodes offer parameter services, as far as the sources show."""
        sources = itertools.chain.from_iterable(package.sources.values() for package in self.look.packages)
        return not any(
            isinstance(node, ast.keyword) and node.arg == "start_parameter_services"
            for source in sources
            for node in source.nodes
        )

    def is_free(self, run: Run) -> bool:
        """Return whether the nodes of a run wait only for commands, as far as is known."""
        is_of_topics = all(topic in (self.command_topic, "/clock") for topic in run.subscribes)
        return is_of_topics and not self._is_told_otherwise(run)

    def _is_told_otherwise(self, run: Run) -> bool:
        """Return whether a parameter that is false, or a service or input, may hold a program back."""
        values = [pair for parameters in run.parameters.values() for pair in parameters.items()]
        is_off = any(value is False and name != "use_sim_time" for name, value in values)
        return is_off or not self.names(run).isdisjoint(ASKS)


def seen_faults(seen: Seen) -> Iterator[Finding]:
    """Yield the findings about the runs."""
    for run in seen.alone:
        name = run.programs[0]
        if run.ended.get(name) and not is_told_alone(seen, run):
            continue
        yield from _life(seen, run, name)
        yield from unended_faults(seen, run, name)
        is_told = any(
            finding.code == "name-twice" and name in finding.about for finding in seen.look.findings
        )
        for node in run.twins if not is_told else ():
            yield Finding(
                "name-twice",
                f"The program {name} makes two nodes named {node.rpartition('/')[2]} and spins only one of them.",
                seen.main(name),
                "make one node, keep it in a variable, and pass that to rclpy.spin",
            )
        yield from _silent(seen, run)
        yield from content_faults(seen, run)
        yield from _rhythms(seen, run)
    yield from ended_together(seen)
    yield from word_faults(seen)
    asked = {f"/{topic}" for package in seen.look.packages for topic in asked_of(seen.look.sources(package))}
    for run in seen.together or seen.alone:
        faults = [
            fault
            for fault in graph_of(_observation(run), everything=True, expected_topics=sorted(asked)).faults
            if not seen.is_of_run(fault)
            if not (isinstance(fault, SharedName) and len(run.programs) == 1)
        ]
        for found in filter(None, map(finding_of, faults)):
            places = [seen.place(t, is_publisher=side) for t in found.about for side in (True, False)]
            yield replace(found, place=next(filter(None, places), ""))


def _life(seen: Seen, run: Run, name: str) -> Iterator[Finding]:
    """Yield why a program ended, has no node, or has a node that is not spun."""
    if name in run.ended:
        yield from explained(seen, run, name)
    elif not run.nodes:
        yield Finding(
            "no-node",
            f"The program {name} is running, but its node does not appear: it is waiting, doing something else first, or in another ROS domain.",
            seen.main(name),
            "make the node in main before anything that waits, and spin it",
        )
    elif fault := _waits(seen, run, name):
        yield fault


def _waits(seen: Seen, run: Run, name: str) -> Finding | None:
    """Return why a node is not spun; None if all are, or if a node needs no spin."""
    # A program that waits for a service is judged by its run together with the others.
    judged = [*seen.together, run][0] if needs_others(seen, run) else run
    unspun = (node.rpartition("/")[2] for node in sorted(_unspun(seen, judged, run.nodes)))
    return next(filter(None, (unspun_fault(seen, judged, name, node) for node in unspun)), None)


def _unspun(seen: Seen, run: Run, nodes: Sequence[str]) -> set[str]:
    """Return the nodes of a program that are not spun.

    If others are spun, a node without topics is not counted: it may only serve to wait for responses.
    """
    busy = {node for ends in (run.publishes, run.subscribes) for nodes in ends.values() for node in nodes}
    if not seen.has_parameters:
        return set()  # without parameter services they cannot be asked
    unasked = run.unasked & {*nodes}
    return unasked if unasked >= {*nodes} else unasked & busy


def _silent(seen: Seen, run: Run) -> Iterator[Finding]:
    """Yield publishers that published nothing, neither by themselves nor after a command."""
    published = set().union(*map(seen.published, (run, *seen.together)))
    unspun = _unspun(seen, run, run.nodes) if _waits(seen, run, run.programs[0]) else set()
    unspun |= {*run.twins}  # these have another finding
    for topic in run.publishes if not run.ended and seen.is_free(run) else ():
        ends = seen.ends(topic, is_publisher=True)
        is_unspun = not {*run.publishes[topic]}.isdisjoint(unspun)
        if (
            topic in published
            or is_unspun
            or topic.endswith(every_node.OF_MANAGED)
            or any(map(_is_managed, ends))
            or is_made_by_words(seen, topic)
        ):
            continue
        why, fix = _why_silent(ends)
        cause = f"{run.programs[0]} has a publisher on {topic}, but published nothing there while it was watched{why}."
        yield Finding("publishes-nothing", cause, seen.place(topic), fix, (run.programs[0],))


def _is_managed(end: Any) -> bool:
    """Return whether a publisher belongs to a managed node, which others activate."""
    owner = end.creation.owner
    return owner is not None and end.sources.is_managed(owner)


def _why_silent(ends: Sequence[Any]) -> tuple[str, str]:
    """Return why publishers are silent, if a long timer period explains it, and what to do."""
    period = min((seconds for end in ends for _, seconds in timers_of(end)), default=0.0)
    if period <= SEEN_PERIOD:
        return (
            "",
            "call publish(msg) in a timer callback, and check whether a condition before it is ever true",
        )
    return (
        f": its timer fires every {period:g} s, because a period is given in seconds",
        f"write {1 / period:.3g} if {period:g} times a second was meant, {period / 1000:g} if milliseconds were; otherwise leave it",
    )


def _rhythms(seen: Seen, run: Run) -> Iterator[Finding]:
    """Yield topics whose messages come at the wrong rate, or stop."""
    for topic, heard in run.quiet.items():
        if fault := pauseless(seen, run, topic, heard):
            yield fault
            continue
        gap = median_gap(heard.times)
        ends = seen.ends(topic, is_publisher=True)
        wanted = max((asked_of(end.sources).get(topic[1:], ("", 0.0))[1] for end in ends), default=0.0)
        place = next((timer.source.at(timer.call) for end in ends for timer, _ in timers_of(end)), "")
        place = place or seen.place(topic)
        if topic in run.stalled and _has_no_end(seen, topic):
            cause = f"{heard.count} messages came on {topic} and then no more, although its timer is never cancelled."
            fix = "look for a callback that does not return: while it waits or loops, the timer's callback is not called"
        elif gap is not None and wanted and not has_period(gap, wanted):
            cause = f"{topic} is published every {gap:.3g} s, but the course asks for every {wanted:g} s; a period is in seconds."
            fix = f"write create_timer({wanted}, ...)"
        elif gap is not None and heard.type_name in VELOCITIES and gap > LONGEST_PAUSE:
            cause = f"A velocity is published on {topic} only every {gap:.3g} s; a period is in seconds, not in Hz."
            fix = (
                f"write {1 / gap:.3g} if {gap:.3g} Hz was meant; a robot needs several velocities per second"
            )
        else:
            continue
        yield Finding("period", cause, place, fix)


def _has_no_end(seen: Seen, topic: str) -> bool:
    """Return whether a timer always publishes on a topic, and no publishing file cancels a timer."""
    ends = seen.ends(topic, is_publisher=True)
    ended = re.compile(r"\.cancel\(|destroy_timer\(")
    return any(map(goes_on, ends)) and not any(ended.search(end.creation.source.text) for end in ends)


def _observation(run: Run) -> Observation:
    """Return the ROS graph of a run as an observation."""
    ends = [
        End(node, topic, kind, is_publisher, quality)
        for side, is_publisher in ((run.publishes, True), (run.subscribes, False))
        for topic, nodes in side.items()
        for quality in _qualities(run.qos.get(topic, ()), "publisher" if is_publisher else "subscriber")
        for node, kinds in nodes.items()
        for kind in kinds
    ]
    return Observation(nodes=tuple(sorted([*run.nodes, *run.twins])), ends=tuple(ends))


def _qualities(told: Sequence[str], role: str) -> list[QoSProfile]:
    """Return the QoS profiles of one side of a topic; which node has which is not known."""
    words = [text.split() for text in told if text.startswith(role)]
    return [
        QoSProfile(
            depth=10,
            reliability=getattr(ReliabilityPolicy, reliability.upper()),
            durability=getattr(DurabilityPolicy, durability.upper()),
        )
        for _, reliability, durability in words
    ] or [QoSProfile(depth=10)]
