"""Watch a submission's programs on the ROS graph: the trusted program in a box of its own, which `observe` starts.

Standard input is a socket to the grader, which carries a JSON object a line both ways; what a program of the
submission prints or publishes cannot get into it. Each run has a thread and a ROS domain of its own.
"""

from __future__ import annotations

import contextlib
import difflib
import itertools
import json
import math
import os
import secrets
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from rcl_interfaces.msg import ParameterValue
from rcl_interfaces.srv import GetParameters, ListParameters
from rclpy.parameter import parameter_value_to_python
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message
from std_msgs.msg import String

from ros2lab.observed_domain import CLOCK, HIDDEN_TOPICS, LATCHED, ObservedDomain
from ros2lab.topics import find_type, matching_qos

COMMAND, STRING = "/robot/command", "std_msgs/msg/String"
FLOOD, FLOOD_NAME = 1000, "1000 x start, stop"
# The last ones tell whether the flood was survived, and let the robot move when Ctrl-C comes. There are two, for
# DDS sends again what a flood has crowded out when the next one comes.
COMMANDS = ("start", "stop", "reset", "START", "dance", "", FLOOD_NAME, "start", "start")
FEW_COMMANDS = ("start", "stop", "reset", "dance", "start")
CHANGES = ("start", "stop", "reset", "START")  # those that a state answers to

STEP = 0.1  # s of the stepped clock
BRIEF_HORIZON = 2.6  # s, where periods are known already
HORIZON = 8.0  # s, for three messages of a 2.4 s timer
FAR_HORIZON = 12.0  # s, for two of a 5 s timer
REAL_HORIZON = 5.2  # s, for two messages of a 2.4 s timer, wherever it stands
JUMPS = 3

# What only a wrong program, or one that never spins, makes us wait for, in s.
START_TIMEOUT = 30.0
ANSWER_TIMEOUT = 10.0
MEET_TIMEOUT = 5.0  # participants announce themselves every 3 s
REACTION_TIMEOUT = 1.0
LATE = 0.5
LEAVE_TIMEOUT = 0.5
MOMENT = 0.02
SLOW = 1.0  # s that an answer takes from a node which sleeps

FLOOD_ROUNDS = 20  # each lets a node take two messages out of its queue
KEPT = 200  # messages of a topic, in a part of a run
LARGEST = 64_000  # bytes of a message that is read
MESSAGE_BYTES, TOPIC_BYTES, TOPIC_COUNT = 1_000_000, 20_000_000, 20_000  # with more, a topic is cut
TOPICS, NODES = 20, 20  # that are looked at
TEXT, ITEMS, DEPTH = 500, 50, 8
NAMELESS = "_NODE_NAME_UNKNOWN_"
HIDDEN_PARAMETERS = ("use_sim_time", "start_type_description_service")


class Gone(Exception):  # noqa: N818 -- no fault of ours
    """All programs of the run have ended."""


class NotStepped(Exception):  # noqa: N818
    """A program does not follow the stepped clock; the message says which node or topic shows it."""


class Ear:
    """What is heard on one topic: bounded, and read only when it is asked for."""

    def __init__(self, watch: Watch, topic: str, type_name: str) -> None:
        self.topic, self.type_name = topic, type_name
        self.total = self.count = 0  # in the run, and in this part of it
        self.last = b""
        self.is_closed = False
        self._watch = watch
        self._bytes = 0
        self._type = find_type(type_name)
        self._times: list[float] = []
        self._kept: list[bytes] = []
        offered = matching_qos(watch.node, topic)
        qos = QoSProfile(depth=100, reliability=offered.reliability, durability=offered.durability)
        self._subscription = watch.node.create_subscription(self._type, topic, self._take, qos, raw=True)

    def _take(self, raw: bytes, info: dict[str, int]) -> None:
        self.total += 1
        self.count += 1
        self._watch.heard += 1
        self._bytes += len(raw)
        self.last = raw
        if len(self._kept) < KEPT:
            self._times.append(self._watch.time_of(info["received_timestamp"]))
            self._kept.append(raw if len(raw) <= LARGEST else b"")

    @property
    def is_excessive(self) -> bool:
        """Whether more was heard than is borne, and it is still open."""
        return not self.is_closed and (
            self.total > TOPIC_COUNT or self._bytes > TOPIC_BYTES or len(self.last) > MESSAGE_BYTES
        )

    def plain(self, raw: bytes) -> Any:
        """Return a message as plain data; None if it is too long or none."""
        if not raw or len(raw) > LARGEST:
            return None
        try:
            return plain(deserialize_message(raw, self._type))
        except Exception:  # bytes that a submission has chosen
            return None

    def gaps(self) -> list[float]:
        """Return the times between messages of this part, the first one from 0, in s."""
        return _gaps(self._times)

    def part(self) -> dict[str, Any]:
        """Return what was heard since the last call, as `Heard`, and begin anew."""
        nodes = sorted(self._watch.publishes.get(self.topic, {}))
        result = {
            "type_name": self.type_name,
            "node": ", ".join(nodes),
            "times": self._times,
            "values": [self.plain(raw) for raw in self._kept],
            "count": self.count,
        }
        self._times, self._kept, self.count = [], [], 0
        return result

    def forget(self, count: int) -> None:
        """Forget what came in this part after the first `count` messages."""
        self.count = count
        del self._times[count:], self._kept[count:]

    def close(self) -> None:
        """Hear no more."""
        self.is_closed = True
        self._watch.node.destroy_subscription(self._subscription)


class Watch(ObservedDomain):
    """A domain in which a run's programs are watched.

    Args:
        number: of the domain.
        is_stepped: whether the programs follow a clock that is stepped here.
        alive: tells how many of the programs have not ended.
    """

    def __init__(self, number: int, *, is_stepped: bool, alive: Callable[[], int]) -> None:
        super().__init__(number)
        self.is_stepped = is_stepped
        self._alive = alive
        self._alive_before = alive()
        self._time = 0.0
        self._start = time.time()
        self.heard = 0  # messages, all topics
        self.ears: dict[str, Ear] = {}
        self.logged: list[list[str]] = []
        self.publishes: dict[str, dict[str, list[str]]] = {}
        self.subscribes: dict[str, dict[str, list[str]]] = {}
        self.qos: dict[str, set[str]] = {}
        self.names: set[str] = set()
        self.parameter_names: dict[str, list[str]] = {}
        self.values: dict[str, dict[str, Any]] = {}
        self.notes: set[str] = set()
        self.is_answering = True
        self.is_slow = False
        self._silent: set[str] = set()
        own = f"/observer_{secrets.token_hex(8)}"
        self._mark = self.node.create_publisher(String, own, 1)
        self.wait(lambda: self.node.get_publishers_info_by_topic(own))
        self._prefix = _participant(self.node.get_publishers_info_by_topic(own)[0])
        if is_stepped:
            self._clock = self.node.create_publisher(find_type(CLOCK), "/clock", 10)
        self._rosout = Ear(self, "/rosout", "rcl_interfaces/msg/Log")

    def now(self) -> float:
        """Return the time of the run in s, on its clock."""
        return self._time if self.is_stepped else time.time() - self._start

    def time_of(self, received: int) -> float:
        """Return the time of the run in s at which a message came, by what DDS says of it (ns of the system's clock)."""
        return self._time if self.is_stepped else round(received / 1e9 - self._start, 4)

    def until(self, condition: Callable[[], object], timeout: float) -> bool:
        """Wait as `wait` does, at most until all programs have ended."""
        met = False

        def is_met() -> bool:
            nonlocal met
            for ear in filter(lambda ear: ear.is_excessive, [self._rosout, *self.ears.values()]):
                ear.close()
                self.notes.add(f"{ear.topic} was cut: too many messages, or too large ones.")
            met = bool(condition())
            return met or not self._alive()

        self.wait(is_met, timeout)
        return met

    def nodes(self) -> list[str]:
        """Return the full names of the nodes that others run here, sorted; one that is there twice stands twice."""
        names = [f"{space.rstrip('/')}/{name}" for name, space in self.node.get_node_names_and_namespaces()]
        own = self.node.get_fully_qualified_name()
        if own in names:
            names.remove(own)
        return sorted(name for name in names if not name.rpartition("/")[2].startswith("_"))

    def look(self) -> bool:
        """Take in the graph, and listen to what is new in it; tell whether there was something new to listen to."""
        nodes = self.nodes()
        self.names |= set(nodes)
        self.notes |= {f"Two nodes have the name {name}." for name in nodes if nodes.count(name) > 1}
        is_new = False
        for topic, _ in sorted(self.node.get_topic_names_and_types())[: 4 * TOPICS]:
            publishers = self._others(self.node.get_publishers_info_by_topic(topic))
            subscribers = self._others(self.node.get_subscriptions_info_by_topic(topic))
            count = len({_participant(info) for info in publishers})
            if count > 1 and topic not in HIDDEN_TOPICS:
                self.notes.add(f"{topic} is published by {count} DDS participants.")
            if topic == "/clock" and publishers:
                self.notes.add("The submission publishes /clock itself.")
            if topic in HIDDEN_TOPICS:
                continue
            for ends, infos in ((self.publishes, publishers), (self.subscribes, subscribers)):
                for info in filter(lambda info: info.node_name != NAMELESS, infos):
                    types = ends.setdefault(topic, {}).setdefault(_node(info), [])
                    if info.topic_type not in types:
                        types.append(info.topic_type)
            for role, infos in (("publisher", publishers), ("subscriber", subscribers)):
                self.qos.setdefault(topic, set()).update(_quality(role, info) for info in infos)
            if publishers and topic not in self.ears and len(self.ears) < TOPICS:
                is_new |= self._hear(topic, publishers[0].topic_type)
        target = self.command_topic()
        if target and target not in self._publishers:
            self._publishers[target] = self.node.create_publisher(String, target, LATCHED)
            is_new = True
        return is_new

    def look_again(self) -> bool:
        """Take in the graph, and be heard and told of what is new in it from now on; tell whether there was any."""
        # The graph tells of an end before it tells whose it is.
        self.until(lambda: not self.has_nameless(), self.patience)
        is_new = self.look()
        if is_new and self.is_answering:
            # An answer to a new client comes after its program knows of what was made here before.
            for name in list(self._questions):
                self.node.destroy_client(self._questions.pop(name))
            self.is_answering = self._ask(self.patience)
        return is_new

    def has_nameless(self) -> bool:
        """Tell whether there are publishers or subscriptions of which it is not known yet whose they are."""
        return any(
            info.node_name == NAMELESS
            for topic, _ in self.node.get_topic_names_and_types()[:TOPICS]
            for infos in (
                self.node.get_publishers_info_by_topic(topic),
                self.node.get_subscriptions_info_by_topic(topic),
            )
            for info in infos
        )

    def command_topic(self) -> str:
        """Return the String topic that commands are taken from, the right one or one nearly so named; empty if none."""
        taken = {
            topic for topic, nodes in self.subscribes.items() if any(STRING in t for t in nodes.values())
        }
        if COMMAND in taken:
            return COMMAND
        taken -= set(self.publishes)
        ending = sorted(topic for topic in taken if topic.endswith(COMMAND))
        near = ending or difflib.get_close_matches(COMMAND, sorted(taken), n=1, cutoff=0.75)
        if not near:
            return ""
        self.notes.add(f"Commands were published on {near[0]}, for nothing subscribes to {COMMAND}.")
        return near[0]

    def settle(self, timeout: float = ANSWER_TIMEOUT, least: int = 1) -> bool:
        """Wait until all nodes have done what was to be done, and nothing more is heard.

        Args:
            timeout: for an answer, in s.
            least: how many rounds of questions, at least.

        Returns:
            Whether all nodes answered.
        """
        for number in range(1, 10 * least + 1):
            before = self.heard
            if not self._ask(timeout):
                return False
            if self.heard == before and number >= least:
                break
        return True

    def step(self, seconds: float) -> None:
        """Set the clock forward, and wait until what is then due is done.

        Raises:
            NotStepped: if a node does not answer.
            Gone: if all programs have ended.
        """
        self._time = round(self._time + seconds, 6)
        message = find_type(CLOCK)()
        message.clock.sec, message.clock.nanosec = divmod(round(self._time * 1e9), 10**9)
        self._clock.publish(message)
        if not self.settle():
            self.check()
            raise NotStepped("A node does not answer while the clock is stepped.")

    def check(self) -> None:
        """Raise Gone if all programs have ended."""
        if not self._alive():
            raise Gone

    def clock_followers(self) -> set[str]:
        """Return the full names of the nodes that subscribe to /clock."""
        return {_node(info) for info in self._others(self.node.get_subscriptions_info_by_topic("/clock"))}

    def periodic(self) -> list[Ear]:
        """Return the topics on which more than one message came in this part, and which are still heard."""
        return [ear for ear in self.ears.values() if ear.count > 1 and not ear.is_closed]

    def part(self) -> dict[str, Any]:
        """Return what was heard on each topic since the last call."""
        return {topic: ear.part() for topic, ear in sorted(self.ears.items()) if ear.count}

    def log_part(self) -> list[list[str]]:
        """Return the log lines since the last call, as [level, node, text]."""
        lines = self._rosout.part()["values"]
        return [
            [_LEVELS.get(line["level"], str(line["level"])), line["name"], line["msg"]]
            for line in lines
            if line
        ]

    def list_parameters(self) -> None:
        """Ask which parameters there are; `values` has them after the next answer."""
        for name in sorted(set(self.nodes()) - self._silent)[:NODES]:
            client = self.node.create_client(ListParameters, f"{name}/list_parameters")
            if self.until(client.service_is_ready, self.patience):
                answer = client.call_async(ListParameters.Request())
                if self.until(answer.done, ANSWER_TIMEOUT) and answer.result() is not None:
                    names = answer.result().result.names[:ITEMS]
                    self.parameter_names[name] = [n for n in names if n not in HIDDEN_PARAMETERS]
            self.node.destroy_client(client)

    def participants(self) -> int:
        """Return how many DDS participants (processes, or contexts of one) have nodes."""
        return len(
            {
                _participant(i)
                for i in self._others(self.node.get_publishers_info_by_topic("/parameter_events"))
            }
        )

    def has_unmet(self) -> bool:
        """Tell whether there are more DDS participants than have been met: the kernel knows at once who is there."""
        return len(_discovery_ports(self.number)) > self.participants() + 1  # and our own

    def _hear(self, topic: str, type_name: str) -> bool:
        try:
            self.ears[topic] = Ear(self, topic, type_name)
        except Exception as error:  # rclpy raises many kinds for types and names it cannot use
            self.notes.add(f"{topic} was not heard: {str(error)[:TEXT]}")
            return False
        return True

    def _others(self, infos: Iterable[Any]) -> list[Any]:
        return [info for info in infos if _participant(info) != self._prefix]

    def _ask(self, timeout: float) -> bool:
        """Ask all nodes twice for their parameters; the second answer comes after what was due at the first."""
        names = [name for name in dict.fromkeys(self.nodes()) if name not in self._silent][:NODES]
        start = time.monotonic()
        for name in names:
            if name not in self._questions:
                self._questions[name] = self.node.create_client(GetParameters, f"{name}/get_parameters")
        clients = {name: self._questions[name] for name in names}
        if not clients or not self.until(
            lambda: all(c.service_is_ready() for c in clients.values()) or self._alive() < self._alive_before,
            timeout,
        ):
            return False
        times = 2 if self.is_stepped else 1
        answers = {
            name: [
                client.call_async(GetParameters.Request(names=self.parameter_names.get(name, [])))
                for _ in range(times)
            ]
            for name, client in clients.items()
        }

        def unanswered() -> set[str]:
            return {name for name, pair in answers.items() if not all(answer.done() for answer in pair)}

        self.until(lambda: not unanswered() or self._alive() < self._alive_before, timeout)
        if self._alive() < self._alive_before:  # the nodes of a program that has ended do not answer any more
            self.until(lambda: not unanswered(), LATE)
            self._alive_before = self._alive()
            self._silent |= unanswered()
        self.is_slow |= time.monotonic() - start > SLOW
        for name, pair in answers.items():
            if pair[-1].done() and pair[-1].result() is not None:
                values = map(_parameter, pair[-1].result().values)
                self.values[name] = dict(zip(self.parameter_names.get(name, []), values, strict=False))
        return not unanswered() - self._silent


class Conductor:
    """One run, from the start of its programs to the end.

    Args:
        plan: `run` (its number), `domain`, `programs` (how many), `nodes` (how many a launch file has to start;
            0 if it is none), `is_stepped`, `has_commands`, `is_brief` (what programs do alone is known already).
        say: sends a message to the grader.
    """

    def __init__(self, plan: dict[str, Any], say: Callable[[dict[str, Any]], None]) -> None:
        self.plan = plan
        self._send = say
        self._alive = plan["programs"]
        self._go = threading.Semaphore(0)
        self._marks = 0
        self._commands: list[dict[str, Any]] = []
        self._quiet: dict[str, Any] = {}
        self._quiet_log: list[list[str]] = []
        self._first_values: dict[str, dict[str, Any]] = {}

    def tell(self, message: dict[str, Any]) -> None:
        """Take a message of the grader's: how many programs are alive, and whether to go on."""
        self._alive = message.get("alive", self._alive)
        if message.get("go"):
            self._go.release()

    def run(self) -> None:
        """Conduct the run, and send what was seen."""
        try:
            with contextlib.closing(
                Watch(self.plan["domain"], is_stepped=self.plan["is_stepped"], alive=lambda: self._alive)
            ) as watch:
                self._say("start")
                try:
                    self._observe(watch)
                    watch.look()
                except NotStepped as reason:
                    self._say("real", why=str(reason))
                    return
                except Gone:
                    pass
                self._end(watch)
        except Exception as error:  # the grader says so
            self._say("failed", why=f"{type(error).__name__}: {error}"[:TEXT])

    def _observe(self, watch: Watch) -> None:
        self._await_nodes(watch)
        if watch.is_stepped:
            unfollowing = set(watch.nodes()) - watch.clock_followers()
            if unfollowing:
                raise NotStepped(f"{min(unfollowing)} does not follow the ROS clock.")
            self._watch_stepped(watch)
            if self.plan["programs"] == 1 and any(note.startswith("Two nodes") for note in watch.notes):
                raise NotStepped("Which of two nodes of one name follows the clock cannot be told.")
        else:
            self._watch_real(watch)
        self._quiet = watch.part()
        self._mark()  # what came before is quiet
        self._quiet_log = watch.log_part()
        silent = [ear for ear in watch.ears.values() if ear.total < 2]
        answered = dict.fromkeys((ear.topic for ear in silent), 0)
        if self.plan["has_commands"] and watch.command_topic():
            is_quick = watch.is_answering and not watch.is_slow
            for text in COMMANDS if is_quick and not self.plan["is_brief"] else FEW_COMMANDS:
                self._command(watch, text, answered)
            if not is_quick:
                watch.notes.add("A node is slow to answer: not all of the commands were tried.")
        least = 3 if self.plan["is_brief"] else math.inf  # that came while the clock was stepped
        unknown = [t for t, count in answered.items() if count < 2 and watch.ears[t].total < least]
        if watch.is_stepped and unknown:
            raise NotStepped(_unfollowing(unknown))

    def _await_nodes(self, watch: Watch) -> None:
        watch.wait_for_start(lambda: watch.nodes() or not self._alive, START_TIMEOUT)
        watch.until(lambda: watch.participants() >= self._alive, START_TIMEOUT)
        watch.until(lambda: len(watch.nodes()) >= self.plan["nodes"], START_TIMEOUT)
        watch.check()
        watch.look()  # what does not follow the clock is heard from now on
        watch.is_answering = watch.settle(watch.patience)
        watch.check()
        watch.look()
        # Under load one participant may be met seconds after another; and the graph tells of an end before it
        # tells whose it is.
        watch.until(lambda: not watch.has_unmet() and not watch.has_nameless(), MEET_TIMEOUT)
        watch.look()
        if watch.is_stepped and not watch.is_answering:
            raise NotStepped("A node does not answer.")
        if watch.is_stepped and any("/clock" in note for note in watch.notes):
            raise NotStepped("The submission publishes /clock itself.")
        if watch.is_answering:
            watch.list_parameters()  # by new clients, as in `look_again`
            watch.is_slow = False
            watch.settle()
        watch.check()
        self._first_values = {name: dict(values) for name, values in sorted(watch.values.items())}

    def _watch_stepped(self, watch: Watch) -> None:
        horizon, least = (BRIEF_HORIZON, 1) if self.plan["is_brief"] else (HORIZON, 3)
        while watch.now() < horizon and not (watch.now() >= 1.0 and _all_have(watch, least)):
            watch.step(_step(watch, 2))
        while not self.plan["is_brief"] and watch.now() < FAR_HORIZON and not _all_have(watch, 2):
            watch.step(_step(watch, 5))
        watch.look_again()
        closed = [ear.topic for ear in watch.ears.values() if ear.is_closed]
        if closed:
            raise NotStepped(_unfollowing(closed))
        periodic = watch.periodic()
        if periodic:
            self._jump(watch, periodic)

    def _jump(self, watch: Watch, periodic: list[Ear]) -> None:
        # What follows the clock comes once a jump, however short that is in real time, and not while the clock stands.
        jump = max(max(ear.gaps()) for ear in periodic)
        kept = [(ear, ear.count) for ear in watch.ears.values()]
        longest = 0.0
        for _ in range(JUMPS):
            start, before = time.monotonic(), {ear.topic: ear.total for ear in periodic}
            watch.step(jump)
            if not watch.until(lambda: all(e.total > before[e.topic] for e in periodic), LATE):  # noqa: B023
                watch.check()
                raise NotStepped(_unfollowing(e.topic for e in periodic if e.total <= before[e.topic]))
            longest = max(longest, time.monotonic() - start)
        before = {ear.topic: ear.total for ear in periodic}
        watch.until(lambda: any(e.total > before[e.topic] + 1 for e in periodic), max(0.02, 4 * longest))
        restless = [ear.topic for ear in periodic if ear.total > before[ear.topic] + 1]
        if restless:
            raise NotStepped(_unfollowing(restless))
        for ear, count in kept:
            ear.forget(count)

    def _watch_real(self, watch: Watch) -> None:
        horizon, least = (BRIEF_HORIZON, 1) if self.plan["is_brief"] else (REAL_HORIZON, 3)
        start = watch.now()

        def is_enough() -> bool:
            return watch.now() - start > 1.0 and _all_have(watch, least)

        while watch.now() - start < horizon and not is_enough():
            watch.until(is_enough, LATE)
            watch.check()
            watch.look_again()

    def _command(self, watch: Watch, text: str, answered: dict[str, int]) -> None:
        totals = {topic: watch.ears[topic].total for topic in answered}
        before = {name: dict(values) for name, values in watch.values.items()}
        if text == FLOOD_NAME:
            for _ in range(FLOOD // 2):
                watch.say(watch.command_topic(), "start")
                watch.say(watch.command_topic(), "stop")
        else:
            watch.say(watch.command_topic(), text)
        if watch.is_answering:
            watch.settle(least=FLOOD_ROUNDS if text == FLOOD_NAME else 1)
        if text == FLOOD_NAME:  # how many of them a queue of ten has lost is chance
            watch.part()
            watch.log_part()
            self._mark()
        if text in CHANGES:
            for topic, total in totals.items():
                answered[topic] += watch.ears[topic].total > total
        watch.look_again()
        with contextlib.suppress(Gone):
            watch.check()
            self._let_time_pass(watch)
            if watch.look_again():
                self._let_time_pass(watch)
        self._commands.append(
            {
                "text": text,
                "mark": self._mark(),
                "topics": watch.part(),
                "log": watch.log_part(),
                "parameters": {
                    f"{node}:{name}": value
                    for node, values in sorted(watch.values.items())
                    for name, value in values.items()
                    if before.get(node, {}).get(name) != value
                },
                "alive": self._alive,
            }
        )
        watch.check()

    def _let_time_pass(self, watch: Watch) -> None:
        """Let the topics that come again and again come, after a command."""
        periods = [self._period(topic) for topic in watch.ears]
        longest = max(periods, default=0.0)
        if watch.is_stepped:
            for seconds in (STEP, STEP, STEP, *([longest] * 2 if longest > STEP else [])):
                watch.step(seconds)
            return
        quick = [watch.ears[t] for t, p in zip(watch.ears, periods, strict=True) if 0 < p <= LATE]
        before = {ear.topic: ear.total for ear in quick}
        if quick:
            watch.until(lambda: all(e.total > before[e.topic] + 2 for e in quick), REACTION_TIMEOUT)
        elif not watch.is_answering:
            watch.until(lambda: False, REACTION_TIMEOUT)

    def _period(self, topic: str) -> float:
        """Return the longest time without a message on a topic before any command, in s; 0 if there was none."""
        times = self._quiet.get(topic, {}).get("times", [])
        # On the real clock, what came before the first message is the time in which programs start.
        return max(_gaps(times)[0 if self.plan["is_stepped"] else 1 :], default=0.0)

    def _end(self, watch: Watch) -> None:
        ended_before = self._alive == 0
        participants = watch.participants()
        if participants > self.plan["programs"] and not self.plan["nodes"]:
            watch.notes.add(f"{participants} DDS participants for {self.plan['programs']} programs.")
        self._say("interrupt")
        self._go.acquire()  # all have ended
        topics = [topic for topic in watch.ears if topic in watch.publishes]
        watch.wait(lambda: not any(watch.node.count_publishers(topic) for topic in topics), LEAVE_TIMEOUT)
        before = -1
        while before != watch.heard:  # what they said last
            before = watch.heard
            watch.wait(lambda: watch.heard > before, MOMENT)  # noqa: B023
        final = {topic: ear.plain(ear.last) for topic, ear in watch.ears.items() if ear.last}
        if ended_before and not self._quiet:
            self._quiet = watch.part()
        self._say(
            "result",
            clock="stepped" if watch.is_stepped else "real",
            nodes=sorted(watch.names),
            publishes=_sorted(watch.publishes),
            subscribes=_sorted(watch.subscribes),
            qos={topic: sorted(ends) for topic, ends in sorted(watch.qos.items()) if ends},
            parameters=self._first_values,
            quiet=self._quiet,
            log=self._quiet_log,
            commands=self._commands,
            final=final,
            notes=sorted(watch.notes),
        )

    def _say(self, do: str, **more: Any) -> None:
        self._send({"run": self.plan["run"], "do": do, **more})

    def _mark(self) -> int:
        """Have the grader mark how far the programs' output has come.

        The World reads what programs print and what is printed here in one thread. Once it has read the second
        line, which is written after it has read the first, it has read all that was printed before the first.
        """
        self._marks += 1
        for half in "ab":
            line = f"{self.plan['run']}.{self._marks}{half}\n"
            os.write(1, line.encode())
            self._say("mark", line=line, number=self._marks if half == "b" else 0)
            self._go.acquire()
        return self._marks


def plain(value: Any, depth: int = DEPTH) -> Any:
    """Return a ROS message, or a field of one, as what JSON can hold, shortened."""
    result = value
    if isinstance(value, float) and not math.isfinite(value):
        result = str(value)
    elif isinstance(value, str):
        result = value[:TEXT]
    elif isinstance(value, bytes) or depth == 0:
        result = None
    elif hasattr(value, "get_fields_and_field_types"):
        result = {name: plain(getattr(value, name), depth - 1) for name in value.get_fields_and_field_types()}
    elif hasattr(value, "tolist"):
        result = value.tolist()[:ITEMS]
    elif isinstance(value, Iterable):
        result = [plain(one, depth - 1) for one in itertools.islice(value, ITEMS)]
    return result


_LEVELS = {10: "DEBUG", 20: "INFO", 30: "WARN", 40: "ERROR", 50: "FATAL"}  # rcl_interfaces/msg/Log


def _parameter(value: ParameterValue) -> Any:
    return plain(parameter_value_to_python(value))


def _participant(info: Any) -> bytes:
    return bytes(info.endpoint_gid[:12])


def _discovery_ports(domain: int) -> set[int]:
    """Return the UDP ports on which participants of a domain listen for others (DDSI-RTPS 2.5, 9.6.2.3)."""
    ports = range(7400 + 250 * domain + 10, 7400 + 250 * domain + 250, 2)
    lines = Path("/proc/net/udp").read_text().splitlines()[1:]
    return {int(line.split()[1].rpartition(":")[2], 16) for line in lines}.intersection(ports)


def _node(info: Any) -> str:
    return f"{info.node_namespace.rstrip('/')}/{info.node_name}"


def _quality(role: str, info: Any) -> str:
    qos = info.qos_profile
    return f"{role} {qos.reliability.name.lower()} {qos.durability.name.lower()}"


def _gaps(times: list[float]) -> list[float]:
    return [later - earlier for earlier, later in itertools.pairwise([0.0, *times])]


def _unfollowing(topics: Iterable[str]) -> str:
    return f"{min(topics)} does not follow the ROS clock."


def _step(watch: Watch, times: int) -> float:
    """Return how far to set the clock: in larger steps after a second, if nothing comes at a high rate."""
    is_quick = any(min(ear.gaps()[1:]) < 2 * STEP for ear in watch.periodic())
    return STEP if is_quick or watch.now() < 1.0 else times * STEP


def _sorted(ends: dict[str, dict[str, list[str]]]) -> dict[str, dict[str, list[str]]]:
    return {topic: dict(sorted(nodes.items())) for topic, nodes in sorted(ends.items())}


def _all_have(watch: Watch, count: int) -> bool:
    return all(ear.count >= count or ear.is_closed for ear in watch.ears.values())


def main() -> None:
    """Conduct the runs that the grader asks for, until it closes the socket."""
    grader = socket.socket(fileno=0)
    lock = threading.Lock()

    def say(message: dict[str, Any]) -> None:
        with lock:
            grader.sendall(json.dumps(message).encode() + b"\n")

    runs: dict[int, Conductor] = {}
    with grader.makefile("rb") as lines:
        for line in lines:
            message = json.loads(line)
            if "domain" in message:
                runs[message["run"]] = conductor = Conductor(message, say)
                threading.Thread(target=conductor.run, name=f"run-{message['run']}", daemon=True).start()
            else:
                runs[message["run"]].tell(message)
    sys.stdout.flush()
    os._exit(0)  # the grader has gone, and with it all that the threads wait for


if __name__ == "__main__":
    main()
