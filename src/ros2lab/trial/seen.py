"""What was seen of nodes while they ran, and what of that is not as it is meant."""

from __future__ import annotations

import ast
import itertools
import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from ros2lab import every_node
from ros2lab.assignments import Assignment
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.graph import EXPECTED_TOPICS, finding_of
from ros2lab.diagnose.nodes.ros_graph import End, Fault, NearMiss, Observation, SharedName, graph_of
from ros2lab.diagnose.nodes.topic_faults import COURSE_TOPICS, ends_of, goes_on, timers_of, word_sources
from ros2lab.diagnose.sources.entrance import Entrance
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.grading.compared import compared
from ros2lab.grading.evidence import CommandSeen, Heard, Run
from ros2lab.grading.reactions import is_still, sense
from ros2lab.grading.running import running
from ros2lab.rhythm import has_period, median_gap
from ros2lab.trial.contents import VELOCITIES, content_faults, has_text, numbers_of
from ros2lab.trial.ends import ended_together, explained, is_told_alone, made, needs_others
from ros2lab.trial.timers import pauseless
from ros2lab.trial.unended import unended_faults
from ros2lab.trial.unspun import unspun_fault

SEEN_PERIOD = 5.0  # s; the timer of a longer one may not call twice while its program is watched
LONGEST_PAUSE = 1.0  # s between two velocities; a robot that gets none for so long stops, or should
LONGEST_WORD = 30  # letters
# By which a program is told what to do, besides topics: nobody does while it is watched.
ASKS = frozenset(("create_service", "create_client", "add_post_set_parameters_callback", "input", "stdin"))
UNKNOWN_WORD = "dance"  # means nothing to any robot


@dataclass(frozen=True)
class Seen:
    """The runs of a workspace's programs, each alone and all together, and where they come from.

    Attributes:
        look: the workspace.
        assignment: which commands were sent, and where.
        alone: a run of each program.
        together: one of all programs; none if there is only one.
    """

    look: Look
    assignment: Assignment
    alone: Sequence[Run]
    together: Sequence[Run]

    @cached_property
    def _ends(self) -> list[Any]:
        return [end for package in self.look.packages for end in ends_of(self.look.sources(package))]

    def ends(self, topic: str, *, is_publisher: bool) -> list[Any]:
        """Return the ends of a topic as the sources have them."""
        name = topic.rpartition("/")[2]
        return [
            e for e in self._ends if e.is_publisher is is_publisher and e.topic.rpartition("/")[2] == name
        ]

    def place(self, topic: str, *, is_publisher: bool = True) -> str:
        """Return where a topic is named in the sources; empty if that is not known."""
        return next((end.place for end in self.ends(topic, is_publisher=is_publisher)), "")

    def filled(self, topic: str, field: str) -> str:
        """Return where a field such as `linear.x` is filled; where its topic is named if that is not known."""
        for source in itertools.chain.from_iterable(one.sources.values() for one in self.look.packages):
            for node in source.nodes:
                is_filled = isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store)
                if is_filled and ast.unparse(node).endswith(f".{field}"):
                    return source.at(node)
        return self.place(topic)

    def main(self, program: str) -> str:
        """Return the file whose function a program calls."""
        found = self._entry(program)
        return found[0].sources[found[1]].shown if found else ""

    def _entry(self, program: str) -> tuple[NodeSources, str] | None:
        """Return a package's files and the module in which a program begins."""
        for package in self.look.packages:
            for point in (package.setup.entry_points if package.setup else None) or ():
                if point.name == program and point.module in package.sources:
                    return self.look.sources(package), point.module
        return None

    def entrance(self, program: str) -> Entrance | None:
        """Return what a program calls, and what that reaches; None if that is not known."""
        for package in self.look.packages:
            for point in (package.setup.entry_points if package.setup else None) or ():
                sources, name = self.look.sources(package), f"{point.module}.{point.function}"
                if point.name == program and name in sources.functions:
                    return Entrance(sources, name)
        return None

    def names(self, run: Run) -> set[str]:
        """Return the names that the files of a program use, as far as the package has them."""
        found = self._entry(run.programs[0])
        files = (found[0].around(found[1]) or found[0]).sources if found else {}
        nodes = itertools.chain.from_iterable(source.nodes for source in files.values())
        return {getattr(node, "attr", getattr(node, "id", "")) for node in nodes}

    def are_apart(self, *nodes: str) -> bool:
        """Return whether no launch file starts all programs that have nodes of these names."""
        programs = {run.programs[0] for run in self.alone if not set(nodes).isdisjoint(run.nodes)}
        files = [{one.executable for one in file.nodes} for file in self.look.launch_files]
        return not any(programs <= started for started in files)

    def is_of_run(self, fault: Fault) -> bool:
        """Return whether only the run made it, which starts all together: no launch file does, and one moves a node.

        One of two nodes of a name may stand for the other, and one beside a namespace may be started in it; but a name
        that begins with a slash stays what it is.
        """
        if isinstance(fault, SharedName):
            return self.are_apart(fault.node)
        if not isinstance(fault, NearMiss) or not fault.meant_ends:
            return False
        ends = (*fault.ends, *fault.meant_ends)
        nodes = {end.node for end in ends}
        moved = {
            name for (_, name), one in self.look.launched.items() if one.namespace or one.launched.remappings
        }
        is_moved = any(run.programs[0] in moved and not nodes.isdisjoint(run.nodes) for run in self.alone)
        written = [one for end in ends for one in self.ends(end.topic, is_publisher=end.is_publisher)]
        return is_moved and self.are_apart(*nodes) and not any(one.is_absolute for one in written)

    def heard(self, run: Run) -> dict[str, list[Heard]]:
        """Return all that was published in a run, by topic, in its order."""
        found: dict[str, list[Heard]] = {}
        for stretch in (run.quiet, *(command.topics for command in run.commands)):
            for topic, one in stretch.items():
                found.setdefault(topic, []).append(one)
        return found

    @property
    def command_topic(self) -> str:
        """The topic on which words were sent."""
        return self.assignment.commanded.topic if self.assignment.commanded else ""

    @property
    def has_parameters(self) -> bool:
        """Whether all nodes can be asked for parameters, as far as the sources tell."""
        sources = itertools.chain.from_iterable(one.sources.values() for one in self.look.packages)
        return not any(
            isinstance(node, ast.keyword) and node.arg == "start_parameter_services"
            for source in sources
            for node in source.nodes
        )

    def is_free(self, run: Run) -> bool:
        """Return whether the nodes of a run wait for nothing but commands, as far as is known."""
        is_of_topics = all(topic in (self.command_topic, "/clock") for topic in run.subscribes)
        return is_of_topics and not self._is_told_otherwise(run)

    def _is_told_otherwise(self, run: Run) -> bool:
        """Return whether a program may be told what to do by more than topics: something is off, or it asks for more."""
        values = [pair for one in run.parameters.values() for pair in one.items()]
        is_off = any(value is False and name != "use_sim_time" for name, value in values)
        return is_off or not self.names(run).isdisjoint(ASKS)


def seen_faults(seen: Seen) -> Iterator[Finding]:
    """Yield what is not as it is meant."""
    for run in seen.alone:
        name = run.programs[0]
        if run.ended.get(name) and not is_told_alone(seen, run):
            continue
        yield from _life(seen, run, name)
        yield from unended_faults(seen, run, name)
        is_told = any(one.code == "name-twice" and name in one.about for one in seen.look.findings)
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
    yield from _words(seen)
    for run in seen.together or seen.alone:
        faults = [
            fault
            for fault in graph_of(_observation(run), everything=True, expected_topics=EXPECTED_TOPICS).faults
            if not seen.is_of_run(fault)
            if not (isinstance(fault, SharedName) and len(run.programs) == 1)
        ]
        for found in filter(None, map(finding_of, faults)):
            places = [seen.place(t, is_publisher=side) for t in found.about for side in (True, False)]
            yield replace(found, place=next(filter(None, places), ""))


def _life(seen: Seen, run: Run, name: str) -> Iterator[Finding]:
    """Yield what keeps a program from having nodes that are spun to its end."""
    if run.ended.get(name):
        yield from explained(seen, run, name)
    elif not run.nodes:
        yield Finding(
            "no-node",
            f"The program {name} is running, but its node never appears: it is waiting, or doing something else first.",
            seen.main(name),
            "make the node in main before anything that waits, and spin it",
        )
    else:
        # Who asks a service may wait for it where nobody offers it, and go on among the others.
        judged = [*seen.together, run][0] if needs_others(seen, run) else run
        if unspun := _unspun(seen, judged, run.nodes):
            yield unspun_fault(seen, judged, name, min(unspun).rpartition("/")[2])


def _unspun(seen: Seen, run: Run, nodes: Sequence[str]) -> set[str]:
    """Return which of a program's nodes are not spun; beside others, one that has no topic may be kept only to wait for answers."""
    busy = {node for ends in (run.publishes, run.subscribes) for nodes in ends.values() for node in nodes}
    if not seen.has_parameters:
        return set()  # who offers none answers nothing
    unasked = run.unasked & {*nodes}
    return unasked if unasked >= {*nodes} else unasked & busy


def _silent(seen: Seen, run: Run) -> Iterator[Finding]:
    """Yield publishers that said nothing, neither by themselves nor after a command."""
    heard = {topic for one in (run, *seen.together) for topic in seen.heard(one)}
    unspun = _unspun(seen, run, run.nodes) | {*run.twins}  # of which something else is told
    for topic in run.publishes if not run.ended and seen.is_free(run) else ():
        ends = seen.ends(topic, is_publisher=True)
        is_unspun = not {*run.publishes[topic]}.isdisjoint(unspun)
        if (
            topic in heard
            or is_unspun
            or topic.endswith(every_node.OF_MANAGED)
            or any(map(_is_managed, ends))
        ):
            continue
        why, fix = _why_silent(ends)
        cause = f"{run.programs[0]} has a publisher on {topic}, but published nothing there while it was watched{why}."
        yield Finding("publishes-nothing", cause, seen.place(topic), fix)


def _is_managed(end: Any) -> bool:
    """Return whether a topic's publisher belongs to a node that is switched on by others."""
    owner = end.creation.owner
    return owner is not None and end.sources.is_managed(owner)


def _why_silent(ends: Sequence[Any]) -> tuple[str, str]:
    """Return why publishers say nothing, if their timers tell it, and what to do."""
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
    """Yield topics that come too seldom, or stop."""
    for topic, one in run.quiet.items():
        if fault := pauseless(seen, run, topic, one):
            yield fault
            continue
        gap = median_gap(one.times)
        wanted = COURSE_TOPICS.get(topic.lstrip("/"), ("", 0.0))[1]
        place = next(
            (t.source.at(t.call) for e in seen.ends(topic, is_publisher=True) for t, _ in timers_of(e)), ""
        )
        place = place or seen.place(topic)
        if topic in run.stalled and _has_no_end(seen, topic):
            cause = f"{one.count} messages came on {topic} and then no more, although its timer is never cancelled."
            fix = "look for a callback that does not return: while it waits or loops, the timer's callback is not called"
        elif gap is not None and wanted and not has_period(gap, wanted):
            cause = f"{topic} is published every {gap:.3g} s, but the course asks for every {wanted:g} s; a period is in seconds."
            fix = f"write create_timer({wanted}, ...)"
        elif gap is not None and one.type_name in VELOCITIES and gap > LONGEST_PAUSE:
            cause = f"A velocity is published on {topic} only every {gap:.3g} s; a period is in seconds, not in Hz."
            fix = (
                f"write {1 / gap:.3g} if {gap:.3g} Hz was meant; a robot needs several velocities per second"
            )
        else:
            continue
        yield Finding("period", cause, place, fix)


def _has_no_end(seen: Seen, topic: str) -> bool:
    """Return whether a timer publishes on a topic each time, and no file that publishes there ever ends one."""
    ends = seen.ends(topic, is_publisher=True)
    ended = re.compile(r"\.cancel\(|destroy_timer\(")
    return any(map(goes_on, ends)) and not any(ended.search(end.creation.source.text) for end in ends)


def _words(seen: Seen) -> Iterator[Finding]:
    """Yield words after which each node does what it did just before, after a word that it cannot know.

    Nodes may share the words among them, and what a word changes depends on the state in which it comes.
    """
    topic = seen.command_topic
    runs = [run for run in seen.alone if run.commands and topic in run.subscribes and not run.unasked]
    sources = [word_sources(seen.look.sources(package)) for package in seen.look.packages]
    own = {text for one in sources for text in compared(node for _, node in running(one))}
    sent, alive = _sent(runs, own), _alive(runs) | made(seen)
    dead = [word for word in sent if word not in alive and word != UNKNOWN_WORD]
    if not dead or (len(dead) < len(sent) and any(map(_heeds_any_word, runs))):
        return
    names_it = re.compile(rf"[\"']\s*{re.escape(dead[0])}\s*[\"']", re.IGNORECASE).search
    ends = seen.ends(topic, is_publisher=False)
    place = next((end.place for end in ends if names_it(end.creation.source.text)), "")
    if len(dead) == len(sent):
        cause = f"After each of the words {', '.join(dead)} on {topic}, the nodes do the same as after {UNKNOWN_WORD!r}, which means nothing."
        fix = "let the callback change an attribute of self (self.state = ...), compare msg.data with ==, and after lower() compare only with lower-case words"
    else:
        like = next((word for word in own if word.lower() == dead[0].lower() and word != dead[0]), "")
        cause = f"The word {dead[0]!r} on {topic} changes nothing{f'; the code compares with {like!r}' if like else ''}."
        fix = f"compare msg.data.strip().lower() with {dead[0].lower()!r}, in lower case"
    yield Finding("word-unanswered", cause, place or seen.place(topic, is_publisher=False), fix)


def _sent(runs: Sequence[Run], own: Collection[str]) -> list[str]:
    """Return the commands that the code names, as they are or in other letters; no other need do anything."""
    named = {text.strip().lower() for text in own}
    sent = dict.fromkeys(command.text for run in runs for command in run.commands)
    return [
        word
        for word in sent
        if word.strip().lower() in named and len(word) < LONGEST_WORD and not word.isupper()
    ]


def _alive(runs: Sequence[Run]) -> set[str]:
    """Return the commands after which a node does something else than after an unknown one just before."""
    return {
        command.text
        for run in runs
        for before, command in itertools.pairwise(run.commands)
        if before.text == UNKNOWN_WORD and _effect(before) != _effect(command)
    }


def _heeds_any_word(run: Run) -> bool:
    """Return whether a word that no node knows changes what is published: it does what another word may be meant to."""
    return any(
        sense(before.topics[topic].values) != sense(heard.values)
        for before, command in itertools.pairwise(run.commands)
        if command.text == UNKNOWN_WORD
        for topic, heard in command.topics.items()
        if heard.values and topic in before.topics and before.topics[topic].values
    )


def _effect(command: CommandSeen) -> str:
    """Return what followed a command, without the word itself and without numbers that count."""
    texts = [re.sub(r"\d+", "#", text) for _, text in command.log]
    texts += [_said_last(heard.values) for heard in command.topics.values() if heard.values]
    bare = {text.replace(command.text, "WORD") if command.text else text for text in texts}
    return "\n".join(sorted([*bare, *map(str, command.parameters.items())]))


def _said_last(values: Sequence[Any]) -> str:
    """Return what messages say last; of numbers alone, which, if they stay."""
    last = values[-1]
    if has_text(last) or not dict(numbers_of(last)):
        return sense([*values])
    if is_still(last):
        return "still"
    return str(last) if len(values) > 1 and values[-2] == last else "varying"


def _observation(run: Run) -> Observation:
    """Return a run's graph as a node sees one."""
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
    """Return the qualities of service of one side of a topic; which node has which is not known."""
    words = [text.split() for text in told if text.startswith(role)]
    return [
        QoSProfile(
            depth=10,
            reliability=getattr(ReliabilityPolicy, reliability.upper()),
            durability=getattr(DurabilityPolicy, durability.upper()),
        )
        for _, reliability, durability in words
    ] or [QoSProfile(depth=10)]
