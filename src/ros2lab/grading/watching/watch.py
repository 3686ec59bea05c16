"""The domain of a run as seen from outside: its nodes, the messages on each topic, and the nodes' answers."""

from __future__ import annotations

import secrets
import statistics
import time
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from typing import Any

from rcl_interfaces.srv import GetParameters, ListParameters
from rclpy._rclpy_pybind11 import NodeNameNonExistentError
from rclpy.node import Node
from rclpy.parameter import parameter_value_to_python
from std_msgs.msg import String

from portable_ros2.messages import fill
from ros2lab import every_node
from ros2lab.assignments import Assignment, Part
from ros2lab.diagnose.sources.spelling import is_near_topic
from ros2lab.grading.watching import OWN_CLOCK, ends
from ros2lab.grading.watching.ear import ITEMS, TEXT, Ear, plain
from ros2lab.grading.watching.participants import Participants
from ros2lab.grading.watching.script import topic_for
from ros2lab.observed_domain import LATCHED, LATE, TEXTS, UNTOLD, ObservedDomain
from ros2lab.topics import find_type

# How long we wait, in s, for what only a wrong program, or one that never spins, keeps from coming.
ANSWER_TIMEOUT = 10.0
SLOW = 0.3  # s that nodes which sleep take to answer
SLEEP = 1.0  # s that a step takes if a timer sleeps
SLEEPS = 3  # such steps, after which the clock is not stepped any more
TOPICS = NODES = 20  # that are watched
NAMELESS = "_NODE_NAME_UNKNOWN_"
OF_EVERY_NODE = ("rcl_interfaces/srv/", "type_description_interfaces/srv/")


class Gone(Exception):  # noqa: N818 -- no fault of ours
    """All programs of the run have ended."""


class NotStepped(Exception):  # noqa: N818
    """A program does not follow the stepped clock; the message says which node or topic shows it."""


class Watch(ObservedDomain):
    """A domain in which a run's programs are watched.

    Args:
        assignment: the assignment whose parts the programs may play.
        number: the domain's number.
        is_stepped: whether the programs follow a clock that is stepped here.
        alive: returns how many of the programs have not ended.
        at_each_turn: called whenever all earlier messages were heard, so that what it then does shows.
    """

    def __init__(
        self,
        assignment: Assignment,
        number: int,
        *,
        is_stepped: bool,
        alive: Callable[[], int],
        at_each_turn: Callable[[], None] | None = None,
    ) -> None:
        super().__init__(number)
        self._listener = self._participants = Participants(self.node, self._context, number)
        self._open.callback(self._participants.close)
        self._asked = {part.topic: part.type_name for part in assignment.parts.values()}
        self._commanded = assignment.commanded
        self._services = assignment.services
        self.is_stepped = is_stepped
        self._alive = alive
        self._at_each_turn = at_each_turn
        self._alive_before = alive()
        self._start = time.time()
        self.ears: dict[str, Ear] = {}
        self.excessive: set[Ear] = set()  # ears with too many messages that are still open
        self.logged: list[list[str]] = []
        self.publishes: dict[str, dict[str, list[str]]] = {}
        self.subscribes: dict[str, dict[str, list[str]]] = {}
        self.qos: dict[str, set[str]] = {}
        self.services: dict[str, dict[str, list[str]]] = {}
        self.names: set[str] = set()
        self.enclaves: dict[str, set[str]] = {}  # by node name, those of the programs that have it
        self.twins: set[str] = set()
        self._homes: set[tuple[str, bytes]] = set()  # the nodes that were there at commands, and where
        self.parameter_names: dict[str, list[str]] = {}
        self.values: dict[str, dict[str, Any]] = {}
        self.notes: set[str] = set()
        self._callers: dict[str, Any] = {}
        self.is_answering = True
        self._answered: list[float] = []  # how long each answer took, in s
        self._slept: list[float] = []  # how long the slow steps took, in s
        self._silent: set[str] = set()  # the nodes of programs that have ended
        self._unanswering: set[str] = set()
        self._rosout = Ear(self, "/rosout", "rcl_interfaces/msg/Log")
        own = f"/observer_{secrets.token_hex(8)}"
        self._mark = self.node.create_publisher(String, own, 1, event_callbacks=UNTOLD)
        self.wait(lambda: ends.publishers(self.node, own))
        self._participants.prefixes.add(ends.participant(ends.publishers(self.node, own)[0]))
        if is_stepped:
            self.make_clock()

    @property
    def is_slow(self) -> bool:
        """Whether most answers take long; on a busy machine only a few do."""
        return bool(self._answered) and statistics.median(self._answered) > SLOW

    def now(self) -> float:
        """Return the time of the run on its clock, in s."""
        return self.simulated if self.is_stepped else time.time() - self._start

    def time_of(self, received: int) -> float:
        """Return the run's time in s at which a message came, by its DDS timestamp (ns, system clock)."""
        return self.simulated if self.is_stepped else round(received / 1e9 - self._start, 4)

    def wait_for_start(self, condition: Callable[[], object], timeout: float) -> bool:
        """Wait as any observer does; if the programs do not start by themselves, call `at_each_turn`, too."""
        if self._at_each_turn is None:
            return super().wait_for_start(condition, timeout)
        is_met, left = super().wait_for_start(condition, self.patience), timeout - self.patience
        while not is_met and left > 0:
            self._at_each_turn()
            is_met, left = self.until(condition, LATE), left - LATE
        return is_met

    def until(self, condition: Callable[[], object], timeout: float) -> bool:
        """Wait like `wait`, but only until all programs have ended; return whether the condition was met."""
        met = False

        def is_over() -> bool:
            nonlocal met
            met = bool(condition())
            return met or not self._alive()

        self.wait(is_over, timeout)
        return met

    def wait(self, condition: Callable[[], object], timeout: float | None = None) -> bool:
        """Wait as any observer does, and close the topics that have too many messages."""

        def is_met() -> bool:
            while self.excessive:
                ear = self.excessive.pop()
                ear.close()
                self.notes.add(f"{ear.topic} was cut: too many messages, or too large ones.")
            return bool(condition())

        return super().wait(is_met, timeout)

    def nodes(self) -> list[str]:
        """Return the full names of all nodes but our own, sorted; a name that is there twice comes twice."""
        names = [f"{space.rstrip('/')}/{name}" for name, space in self.node.get_node_names_and_namespaces()]
        own = self.node.get_fully_qualified_name()
        if own in names:
            names.remove(own)
        return sorted(name for name in names if not name.rpartition("/")[2].startswith("_"))

    def look(self) -> bool:
        """Read the graph, and subscribe to new topics; return whether there was anything new.

        Raises:
            NotStepped: if somebody else also publishes the clock that is stepped here.
        """
        nodes = self.nodes()
        self.names |= set(nodes)
        for base, space, enclave in self.node.get_node_names_and_namespaces_with_enclaves():
            self.enclaves.setdefault(f"{space.rstrip('/')}/{base}", set()).add(enclave)
        self.twins |= {name for name in nodes if nodes.count(name) > 1}
        self.notes |= {f"Two nodes have the name {name}." for name in self.twins}
        is_new = False
        topics = sorted(
            (topic not in self._asked, topic) for topic, _ in self.node.get_topic_names_and_types()
        )
        for is_other, topic in topics[: 4 * TOPICS]:
            publishers = self._others(ends.publishers(self.node, topic))
            subscribers = self._others(ends.subscriptions(self.node, topic))
            count = len({ends.participant(info) for info in publishers})
            if count > 1 and topic not in every_node.HIDDEN_TOPICS:
                self.notes.add(f"{count} programs publish on {topic}, or one that joins ROS as often.")
            if topic == "/clock" and publishers:
                self.notes.add(OWN_CLOCK)
                if self.is_stepped:  # whenever the graph shows it
                    raise NotStepped(OWN_CLOCK)
            if topic in every_node.HIDDEN_TOPICS:
                continue
            for role, types, infos in (
                ("publisher", self.publishes, publishers),
                ("subscriber", self.subscribes, subscribers),
            ):
                ends.add_types(types, topic, infos)
                self.qos.setdefault(topic, set()).update(ends.quality(role, info) for info in infos)
            if publishers and (topic in self.ears or len(self.ears) < TOPICS or not is_other):
                is_new |= self._hear(topic, [info.topic_type for info in publishers])
        if self._services:
            self._look_for_services(nodes)
        target = self.command_topic()
        if target and target not in self._publishers:
            node = self.holding(target, TEXTS)
            self._publishers[target] = node.create_publisher(String, target, LATCHED, event_callbacks=UNTOLD)
            is_new = True
        return is_new

    def look_again(self) -> bool:
        """Read the graph, and wait until new nodes know our endpoints; return whether anything was new."""
        # The graph shows an endpoint before it shows its node.
        self.until(lambda: not self.has_nameless(), self.patience)
        is_new = self.look()
        if self._at_each_turn:
            self._at_each_turn()
        if not self.until(lambda: not self._participants.lags(), self.patience):
            self._participants.give_up()
        if is_new and self.is_answering:
            # A program that answers a new client knows of the endpoints that were made here before.
            self.forget_questions()
            names, times = self.asked(), 2 if self.is_stepped else 1
            self.is_answering = bool(names) and not self.ask(names, self.patience, times)
        return is_new

    def glimpsed(self) -> set[str]:
        """Return the nodes that had gone before they answered or were heard: that one is seen is chance."""
        heard = (self.publishes.get(topic, ()) for topic, ear in self.ears.items() if ear.total)
        return self.names.difference(self.nodes(), self.values, *heard)

    def _look_for_services(self, nodes: Iterable[str]) -> None:
        for name in sorted(set(nodes))[:NODES]:
            space, _, base = name.rpartition("/")
            try:
                provided = self.node.get_service_names_and_types_by_node(base, space or "/")
            except NodeNameNonExistentError:  # it has just left
                continue
            for service, types in provided[: 4 * TOPICS]:
                if not any(kind.startswith(OF_EVERY_NODE) for kind in types):
                    self.services.setdefault(service, {})[name] = list(types)

    def service(self, part: Part) -> str:
        """Return the service that plays a part: the right one, else one of its type, else an empty name."""
        fitting = [
            name
            for name, nodes in sorted(self.services.items())
            if any(part.type_name in types for types in nodes.values())
        ]
        taken = {service.topic for service in self._services if service is not part}
        free = (name for name in fitting if name not in taken)
        return min(free, key=lambda n: (n != part.topic, not is_near_topic(n, part.topic)), default="")

    def call(self, part: Part, name: str, request: Mapping[str, Any]) -> tuple[dict[str, Any] | None, float]:
        """Call a service and wait for the response.

        Args:
            part: the part that the service plays.
            name: the service's name.
            request: the request's values by field.

        Returns:
            The response by field, None if none came; and how much longer it took than a node's usual answer,
            in s.
        """
        kind: Any = find_type(part.type_name)
        message = kind.Request()
        fill(message, request)
        if name not in self._callers:
            self._callers[name] = self.node.create_client(kind, name)
        client = self._callers[name]
        if not self.until(client.service_is_ready, self.patience):
            return None, 0.0
        self.settle(self.patience)
        usual = self._answered[-1] if self._answered else 0.0
        start = time.monotonic()
        answer = client.call_async(message)
        self.until(answer.done, part.within + self.patience)
        took = round(max(0.0, time.monotonic() - start - usual), 2)
        is_answered = answer.done() and answer.result() is not None
        return (plain(answer.result()) if is_answered else None), took

    def has_nameless(self) -> bool:
        """Return whether there are publishers or subscriptions whose node is not known yet."""
        return any(
            info.node_name == NAMELESS
            for topic, _ in self.node.get_topic_names_and_types()[:TOPICS]
            for ends_of in (ends.publishers, ends.subscriptions)
            for info in ends_of(self.node, topic)
        )

    def command_topic(self) -> str:
        """Return the topic that takes commands: the right one, else a likely one, else an empty name."""
        part = self._commanded
        return topic_for(part, self.subscribes, self.publishes) if part else ""

    def step(self, seconds: float) -> None:
        """Set the clock forward, and wait until everything that is due then is done.

        Raises:
            NotStepped: if a node does not answer, or sleeps for longer than the clock is set forward.
            Gone: if all programs have ended.
        """
        if self._at_each_turn:
            self._at_each_turn()
        start = time.monotonic()
        is_settled = self.step_clock(self.simulated + seconds)
        took = time.monotonic() - start
        if took > SLEEP:
            self._slept.append(took)
        if len(self._slept) >= SLEEPS and sum(self._slept) > self.simulated:
            raise NotStepped("What is called while the clock is stepped sleeps for longer than that.")
        if not is_settled:
            if not self.nodes():  # programs that have left the graph are about to end
                self.until(lambda: False, self.patience)
            self.check()
            raise NotStepped("A node does not answer while the clock is stepped.")

    def check(self) -> None:
        """Raise Gone if all programs have ended."""
        if not self._alive():
            raise Gone

    def check_still(self) -> None:
        """Raise NotStepped if something was published with each answer although the clock stood still."""
        if self.is_stepped and self.is_restless:
            raise NotStepped("Something is published while the ROS clock stands still.")

    def clock_followers(self) -> set[str]:
        """Return the full names of the nodes that subscribe to /clock."""
        return {ends.node_name(info) for info in self._others(ends.subscriptions(self.node, "/clock"))}

    def periodic(self) -> list[Ear]:
        """Return the open topics that had more than one message since the last call of `part`."""
        return [ear for ear in self.ears.values() if ear.count > 1 and not ear.is_closed]

    def has_part(self) -> bool:
        """Return whether anything was published or logged since the last calls of `part` and `log_part`."""
        return any(ear.count for ear in (self._rosout, *self.ears.values()))

    def part(self) -> dict[str, Any]:
        """Return what was published on each topic since the last call."""
        return {topic: ear.part() for topic, ear in sorted(self.ears.items()) if ear.count}

    def log_part(self) -> list[list[str]]:
        """Return the log lines since the last call, as [level, node, text]."""
        lines = filter(None, self._rosout.part()["values"])
        return [[_LEVELS.get(line["level"], str(line["level"])), line["name"], line["msg"]] for line in lines]

    def list_parameters(self) -> None:
        """Ask the nodes for their parameters' names, all at once; the next answers fill `values`."""
        names = [name for name in self.asked() if name not in self._unanswering]
        clients = [self.node.create_client(ListParameters, f"{name}/list_parameters") for name in names]
        self.until(lambda: all(client.service_is_ready() for client in clients), self.patience)
        ready = [pair for pair in zip(names, clients, strict=True) if pair[1].service_is_ready()]
        answers = {name: client.call_async(ListParameters.Request()) for name, client in ready}
        self.until(lambda: all(answer.done() for answer in answers.values()), ANSWER_TIMEOUT)
        for name, answer in answers.items():
            if answer.done() and (said := answer.result()) is not None:
                own = (n for n in said.result.names[:ITEMS] if n not in every_node.PARAMETERS)
                self.parameter_names[name] = [*own]
        for client in clients:
            self.node.destroy_client(client)

    def participants(self) -> int:
        """Return how many DDS participants (processes, or contexts of one) have nodes."""
        return len({ends.participant(info) for info in self._of_nodes()})

    def anew(self, programs: int) -> list[str]:
        """Return the nodes that began anew since the last call, if there were more participants than programs by then."""
        now = {(ends.node_name(info), ends.participant(info)) for info in self._of_nodes()}
        found = {name for name, _ in now - self._homes} & {name for name, _ in self._homes}
        self._homes |= now
        return sorted(found) if len({home for _, home in self._homes}) > programs else []

    def _of_nodes(self) -> list[Any]:
        return self._others(ends.publishers(self.node, "/parameter_events"))

    def has_unmet(self) -> bool:
        """Return whether some DDS participants were not met yet: the kernel knows at once who is there."""
        return len(ends.discovery_ports(self.number)) > self.participants() + len(self._participants.prefixes)

    def holding(self, topic: str, type_name: str) -> Node:
        """Return the node for an end of a topic: one that has no end of another type there."""
        return self._participants.holding(topic, type_name)

    def _hear(self, topic: str, types: Sequence[str]) -> bool:
        """Subscribe to a topic, by the type that is asked for if it has several; return whether that is new."""
        wanted = self._asked.get(topic, "")
        type_name = wanted if wanted in types else types[0]
        if topic in self.ears:
            if type_name != wanted or self.ears[topic].type_name == wanted:
                return False
            self.ears[topic].close()
        try:
            self.ears[topic] = Ear(self, topic, type_name)
        except Exception as error:  # rclpy raises many kinds for types and names it cannot use
            self.notes.add(f"{topic} was not heard: {str(error)[:TEXT]}")
            return False
        return True

    def _others(self, infos: Iterable[Any]) -> list[Any]:
        return [info for info in infos if ends.participant(info) not in self._participants.prefixes]

    def settle(self, timeout: float | None = ANSWER_TIMEOUT, least: int = 1) -> bool:
        """Wait as any observer does, for all nodes that have not ended."""
        return super().settle(timeout, least)

    def asked(self) -> list[str]:
        """Return the names of the nodes that are asked: not too many, and first those that have a part's topic."""
        ends = (nodes for found in (self.publishes, self.subscribes) for nodes in map(found.get, self._asked))
        first = {name for nodes in ends for name in nodes or ()}
        names = sorted(self.nodes(), key=lambda name: name not in first)
        return [name for name in dict.fromkeys(names) if name not in self._silent][:NODES]

    @property
    def heard(self) -> int:
        """The number of messages received on all topics."""
        return sum(self.counts().values())

    def receivers(self, topics: Collection[str]) -> set[str]:
        """Return the full names of the nodes that subscribe to any of these topics."""
        return {node for topic in topics for node in self.subscribes.get(topic, ())}

    def counts(self) -> dict[str, int]:
        """Return how many messages were received on each topic."""
        return {topic: ear.total for topic, ear in (("/rosout", self._rosout), *self.ears.items())}

    def ask(self, names: Collection[str], timeout: float, times: int = 1) -> set[str]:
        """Ask nodes as any observer does, for parameter values; return the live ones that do not answer."""
        start = time.monotonic()
        self._unanswering = super().ask(names, timeout, times)
        if self._alive() < self._alive_before:  # the nodes of a program that has ended do not answer any more
            self._alive_before = self._alive()
            self._silent |= self._unanswering
        self._answered.append(time.monotonic() - start)
        self._unanswering -= self._silent
        return self._unanswering

    def request(self, name: str) -> GetParameters.Request:
        """Return the request for a node: the values of all its parameters, once their names are known."""
        return GetParameters.Request(names=self.parameter_names.get(name, []))

    def take_answer(self, name: str, answer: GetParameters.Response) -> None:
        """Store the parameter values that a node has answered."""
        with suppress(RuntimeError):  # of a type that no parameter has
            asked = zip(self.parameter_names.get(name, []), answer.values, strict=False)
            self.values[name] = {key: plain(parameter_value_to_python(value)) for key, value in asked}

    def has_lost(self) -> bool:
        """Return whether a program has ended since the nodes were last asked."""
        return self._alive() < self._alive_before


_LEVELS = {10: "DEBUG", 20: "INFO", 30: "WARN", 40: "ERROR", 50: "FATAL"}  # rcl_interfaces/msg/Log
