"""The domain of a run as it is seen from outside: who is there, what is heard on each topic, and what nodes answer."""

from __future__ import annotations

import secrets
import statistics
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from rcl_interfaces.msg import ParameterValue
from rcl_interfaces.srv import GetParameters, ListParameters
from rclpy._rclpy_pybind11 import NodeNameNonExistentError
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.parameter import parameter_value_to_python
from std_msgs.msg import String

from portable_ros2.messages import fill
from ros2lab import every_node
from ros2lab.assignments import Assignment, Part
from ros2lab.grading.ear import ITEMS, TEXT, Ear, plain
from ros2lab.grading.players import is_near
from ros2lab.observed_domain import CLOCK, LATCHED, LATE, ObservedDomain
from ros2lab.topics import find_type

# What only a wrong program, or one that never spins, makes us wait for, in s.
ANSWER_TIMEOUT = 10.0
SLOW = 0.3  # that an answer takes from nodes which sleep
SLEEP = 1.0  # that a step takes where a timer sleeps
SLEEPS = 3  # of them, after which the clock is not stepped any more
RESTLESS = 3.0  # for nodes which publish whenever they answer
STILL = 1.0  # s of the stepped clock, in which it is seen whether there are such nodes

TOPICS, NODES = 20, 20  # that are looked at
NAMELESS = "_NODE_NAME_UNKNOWN_"
# By themselves publishers and subscriptions warn of others that do not fit, which makes each wait longer.
UNTOLD = PublisherEventCallbacks(use_default_callbacks=False)
OF_EVERY_NODE = ("rcl_interfaces/srv/", "type_description_interfaces/srv/")
HIDDEN_PARAMETERS = ("use_sim_time", "start_type_description_service")


class Gone(Exception):  # noqa: N818 -- no fault of ours
    """All programs of the run have ended."""


class NotStepped(Exception):  # noqa: N818
    """A program does not follow the stepped clock; the message says which node or topic shows it."""


class Watch(ObservedDomain):
    """A domain in which a run's programs are watched.

    Args:
        assignment: whose parts the programs may play.
        number: of the domain.
        is_stepped: whether the programs follow a clock that is stepped here.
        alive: tells how many of the programs have not ended.
    """

    def __init__(
        self, assignment: Assignment, number: int, *, is_stepped: bool, alive: Callable[[], int]
    ) -> None:
        super().__init__(number)
        self._commanded = assignment.commanded
        self._services = assignment.services
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
        self.services: dict[str, dict[str, list[str]]] = {}
        self.names: set[str] = set()
        self.enclaves: dict[str, set[str]] = {}  # of the programs that have a node of this name
        self.twins: set[str] = set()
        self.parameter_names: dict[str, list[str]] = {}
        self.values: dict[str, dict[str, Any]] = {}
        self.notes: set[str] = set()
        self._callers: dict[str, Any] = {}
        self.is_answering = True
        self.is_restless = False
        self._answered: list[float] = []  # how long each answer took, in s
        self._slept: list[float] = []  # how long steps took that took long, in s
        self._silent: set[str] = set()  # the nodes of programs that have ended
        self._unanswering: set[str] = set()
        own = f"/observer_{secrets.token_hex(8)}"
        self._mark = self.node.create_publisher(String, own, 1, event_callbacks=UNTOLD)
        self.wait(lambda: self.node.get_publishers_info_by_topic(own))
        self._prefix = _participant(self.node.get_publishers_info_by_topic(own)[0])
        if is_stepped:
            self._clock = self.node.create_publisher(find_type(CLOCK), "/clock", 10, event_callbacks=UNTOLD)
        self._rosout = Ear(self, "/rosout", "rcl_interfaces/msg/Log")

    @property
    def is_slow(self) -> bool:
        """Whether most answers take long: on a busy machine a few do."""
        return bool(self._answered) and statistics.median(self._answered) > SLOW

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
        for base, space, enclave in self.node.get_node_names_and_namespaces_with_enclaves():
            self.enclaves.setdefault(f"{space.rstrip('/')}/{base}", set()).add(enclave)
        self.twins |= {name for name in nodes if nodes.count(name) > 1}
        self.notes |= {f"Two nodes have the name {name}." for name in self.twins}
        is_new = False
        for topic, _ in sorted(self.node.get_topic_names_and_types())[: 4 * TOPICS]:
            publishers = self._others(self.node.get_publishers_info_by_topic(topic))
            subscribers = self._others(self.node.get_subscriptions_info_by_topic(topic))
            count = len({_participant(info) for info in publishers})
            if count > 1 and topic not in every_node.HIDDEN_TOPICS:
                self.notes.add(f"{topic} is published by {count} DDS participants.")
            if topic == "/clock" and publishers:
                self.notes.add("The submission publishes /clock itself.")
            if topic in every_node.HIDDEN_TOPICS:
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
        if self._services:
            self._look_for_services(nodes)
        target = self.command_topic()
        if target and target not in self._publishers:
            self._publishers[target] = self.node.create_publisher(
                String, target, LATCHED, event_callbacks=UNTOLD
            )
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
            self.is_answering = self._ask(self.patience, self._asked())
        return is_new

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
        """Return the service that plays a part: the right one, or else one of its type; empty if there is none."""
        fitting = [
            name
            for name, nodes in sorted(self.services.items())
            if any(part.type_name in types for types in nodes.values())
        ]
        taken = {other.topic for other in self._services if other is not part}
        others = [name for name in fitting if name not in taken]
        others.sort(key=lambda name: (name != part.topic, not is_near(name, part.topic)))
        return others[0] if others else ""

    def call(self, part: Part, name: str, request: Mapping[str, Any]) -> tuple[dict[str, Any] | None, float]:
        """Call a service, and wait for the response.

        Args:
            part: of which the service is.
            name: of the service.
            request: by field.

        Returns:
            The response by field, None if none came; and how much longer it took than any answer of a node, in s.
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
        """Return whether there are publishers or subscriptions of which it is not known yet whose they are."""
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
        """Return the String topic that commands are taken from: the right one, or one that plays its part; or none."""
        part = self._commanded
        if part is None:
            return ""
        taken = {
            topic: f"{topic} {' '.join(nodes)}"
            for topic, nodes in sorted(self.subscribes.items())
            if any(part.type_name in types for types in nodes.values())
        }
        if part.topic in taken:
            return part.topic
        others = [topic for topic in taken if topic not in self.publishes]
        near = [topic for topic in others if is_near(topic, part.topic)]
        near += [topic for topic in others if part.is_meant(taken[topic])]
        if not near:
            return ""
        self.notes.add(f"Commands were published on {near[0]}, for nothing subscribes to {part.topic}.")
        return near[0]

    def settle(self, timeout: float = ANSWER_TIMEOUT, least: int = 1) -> bool:
        """Wait until all nodes have done what was to be done, and nothing more is heard.

        Args:
            timeout: for an answer, in s.
            least: how many rounds of questions, at least.

        Returns:
            Whether all nodes answered; `is_restless` tells whether something was heard at each answer all the same.
        """
        start, rounds = time.monotonic(), 3 if self.is_stepped else 1
        names = self._asked()
        for number in range(1, 10 * least + 1):
            before = self.heard, {topic: ear.total for topic, ear in self.ears.items()}
            if not self._ask(timeout, names):
                return False
            self.is_restless = self.heard > before[0]
            if number >= least and self.is_restless and self.is_stepped and self._time > STILL:
                # Whoever publishes at each answer was found out; now only what others make of a message is to come.
                names = self._receivers(before[1])
                self.is_restless = bool(names)
            if number >= least and not self.is_restless:
                break
            if least == 1 and number >= rounds and time.monotonic() - start > RESTLESS:
                break
        return True

    def _receivers(self, totals: Mapping[str, int]) -> list[str]:
        """Return the nodes that receive what has come on topics on which these many messages had come before."""
        came = [topic for topic, total in totals.items() if self.ears[topic].total > total]
        receivers = {node for topic in came for node in self.subscribes.get(topic, ())}
        return [name for name in self._asked() if name in receivers]

    def _asked(self) -> list[str]:
        """Return the names of the nodes that are asked."""
        return [name for name in dict.fromkeys(self.nodes()) if name not in self._silent][:NODES]

    def step(self, seconds: float) -> None:
        """Set the clock forward, and wait until what is then due is done.

        Raises:
            NotStepped: if a node does not answer, or sleeps for longer than the clock is set forward.
            Gone: if all programs have ended.
        """
        self._time = round(self._time + seconds, 6)
        message = find_type(CLOCK)()
        message.clock.sec, message.clock.nanosec = divmod(round(self._time * 1e9), 10**9)
        start = time.monotonic()
        self._clock.publish(message)
        is_settled = self.settle()
        took = time.monotonic() - start
        if took > SLEEP:
            self._slept.append(took)
        if len(self._slept) >= SLEEPS and sum(self._slept) > self._time:
            raise NotStepped("What is called while the clock is stepped sleeps for longer than that.")
        if not is_settled:
            if not self.nodes():  # whoever leaves the graph is about to end
                self.until(lambda: False, self.patience)
            self.check()
            raise NotStepped("A node does not answer while the clock is stepped.")

    def check(self) -> None:
        """Raise Gone if all programs have ended."""
        if not self._alive():
            raise Gone

    def check_still(self) -> None:
        """Raise NotStepped if something was published at each answer, although the clock stood."""
        if self.is_stepped and self.is_restless:
            raise NotStepped("Something is published while the ROS clock stands still.")

    def clock_followers(self) -> set[str]:
        """Return the full names of the nodes that subscribe to /clock."""
        return {_node(info) for info in self._others(self.node.get_subscriptions_info_by_topic("/clock"))}

    def periodic(self) -> list[Ear]:
        """Return the topics on which more than one message came in this part, and which are still heard."""
        return [ear for ear in self.ears.values() if ear.count > 1 and not ear.is_closed]

    def has_part(self) -> bool:
        """Return whether anything was heard or logged since `part` and `log_part` were called."""
        return any(ear.count for ear in (self._rosout, *self.ears.values()))

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
        for name in sorted(set(self.nodes()) - self._silent - self._unanswering)[:NODES]:
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
        """Return whether there are more DDS participants than have been met: the kernel knows at once who is there."""
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

    def _ask(self, timeout: float, names: Sequence[str]) -> bool:
        """Ask nodes twice for their parameters; the second answer comes after what was due at the first."""
        for name in names:
            if name not in self._questions:
                self._questions[name] = self.node.create_client(GetParameters, f"{name}/get_parameters")
        clients = {name: self._questions[name] for name in names}
        if not clients or not self.until(
            lambda: all(c.service_is_ready() for c in clients.values()) or self._alive() < self._alive_before,
            timeout,
        ):
            return False
        start = time.monotonic()
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
        self._answered.append(time.monotonic() - start)
        for name, pair in answers.items():
            if pair[-1].done() and pair[-1].result() is not None:
                values = map(_parameter, pair[-1].result().values)
                self.values[name] = dict(zip(self.parameter_names.get(name, []), values, strict=False))
        self._unanswering = unanswered() - self._silent
        return not self._unanswering


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
