"""A ROS domain that is observed: who is there, what is said, and how often; programs can be started in it.

The one who observes spins the listening node itself, and only while it waits: nothing runs in the background
but the programs.
"""

from __future__ import annotations

import array
import bisect
import contextlib
import itertools
import math
import socket
import time
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from functools import partial
from typing import Any

from rcl_interfaces.srv import GetParameters
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.exceptions import InvalidServiceNameException
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.task import Future
from std_msgs.msg import String

from ros2lab import environment, every_node
from ros2lab.domain_lease import discovery, leased
from ros2lab.listener import Listener
from ros2lab.node_process import NodeProcess
from ros2lab.processor_share import processor_share
from ros2lab.rhythm import has_period, median_gap
from ros2lab.scratch import scratch_folder
from ros2lab.topics import TopicLog, find_type

LEAST_PATIENCE = 3.0  # s
LATE = 0.5  # s
STOP_TIMEOUT = 2.0  # s
RESTLESS = 3.0  # s, for nodes which publish whenever they answer
STILL = 1.0  # s of the stepped clock, in which it is seen whether there are such nodes
TURN = 0.02  # s, for which is listened before the next look at what is waited for
TEXTS = "std_msgs/msg/String"
CLOCK = "rosgraph_msgs/msg/Clock"
LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
# By itself a publisher warns of subscriptions that do not fit, which makes each wait longer.
UNTOLD = PublisherEventCallbacks(use_default_callbacks=False)
SILENT_PERIODS = 2.5  # after so many without a message, none is waited for any longer


class ObservedDomain:
    """A ROS domain with a node that listens; a context manager that ends all that was started in it.

    Args:
        number: of the domain; None leases one that nobody else on this machine has, and that ends at this
            machine, whatever the environment says.

    Attributes:
        number: of the domain.
        node: listens; it is spun while `wait` waits.
        patience: how long to wait for what a node that spins does at once, such as to answer, in s.
        simulated: what the simulated clock shows, in s.
        is_restless: whether something was still received when `settle` gave up.

    Raises:
        NoDomainError: if all of the domains that can be leased are leased.
    """

    def __init__(self, number: int | None = None) -> None:
        environment.apply()
        environment.remove_dead_shared_memory()
        with contextlib.ExitStack() as stack:  # which gives all back if this fails half-way
            self._is_private = number is None
            self.number = (
                leased(stack.enter_context(socket.socket(socket.AF_UNIX))) if number is None else number
            )
            self._logs = str(stack.enter_context(scratch_folder()))
            self._context = Context()
            stack.callback(self._context.try_shutdown)
            with discovery("LOCALHOST") if self._is_private else contextlib.nullcontext():
                self._context.init(args=["--ros-args", "--disable-stdout-logs"], domain_id=self.number)
            self.node = Node("observer", context=self._context, start_parameter_services=False)
            stack.callback(self.node.destroy_node)
            self._listener = Listener(self.node, self._context)
            stack.callback(self._listener.close)
            self._open = stack.pop_all()
        self.patience = LEAST_PATIENCE
        self.simulated = 0.0
        self._steps: list[tuple[float, float]] = []  # when the simulated clock was set, and to what
        self._publishers: dict[str, Any] = {}
        self._clock: Any = None
        self._questions: dict[tuple[Node, str], Any] = {}
        self._listening: list[TopicLog] = []
        self.is_restless = False

    @property
    def late(self) -> float:
        """How long what is due may take to arrive, in s: longer on a busy machine."""
        return LATE * self.patience / LEAST_PATIENCE

    def start(self, name: str, command: Sequence[str], environ: Mapping[str, str]) -> NodeProcess:
        """Start a program in this domain; it ends with the domain.

        Args:
            name: how it is called.
            command: its words.
            environ: its environment; the domain is added.
        """
        own = {**environ, "ROS_DOMAIN_ID": str(self.number), "ROS_LOG_DIR": self._logs}
        if self._is_private:
            own |= {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "ROS_STATIC_PEERS": ""}
        process = NodeProcess(name, name, list(command), own)
        self._open.callback(process.stop, STOP_TIMEOUT)
        return process

    def wait(self, condition: Callable[[], object], timeout: float | None = None) -> bool:
        """Listen until the condition holds; tell whether it did within `timeout` seconds, or `patience` if None.

        Only time in which this process had its turn counts: where it had to wait for the processor or the disk,
        those who are waited for had to wait, too.
        """
        left = self.patience if timeout is None else timeout
        while not condition():
            if left < 0:
                return False
            begin = time.monotonic()
            self._listener.listen(TURN)
            left -= min(time.monotonic() - begin, TURN)
        return True

    def wait_for_start(self, condition: Callable[[], object], timeout: float) -> bool:
        """Wait as `wait` does, for what programs do first, and be the more patient from now on the slower they were."""
        begin = time.monotonic()
        is_met = self.wait(condition, timeout)
        if is_met:
            self.patience = max(self.patience, 2 * (time.monotonic() - begin))
        return is_met

    def nodes(self) -> list[str]:
        """Return the full names of the nodes that others run here, sorted."""
        names = self.node.get_node_names_and_namespaces()
        others = (f"{space.rstrip('/')}/{name}" for name, space in names if name != self.node.get_name())
        return sorted(name for name in others if not name.startswith("/_"))

    def published(self) -> dict[str, list[str]]:
        """Return the types of what others publish, by topic; what every node has is left out."""
        return _types(self.publishers())

    def subscribed(self) -> dict[str, list[str]]:
        """Return the types of what others subscribe to, by topic; what every node has is left out."""
        return _types(self.subscribers())

    def publishers(self) -> dict[str, dict[str, list[str]]]:
        """Return who else publishes: the types by topic and full name; what every node has is left out."""
        return self._ends(self.node.get_publishers_info_by_topic)

    def subscribers(self) -> dict[str, dict[str, list[str]]]:
        """Return who else subscribes: the types by topic and full name; what every node has is left out."""
        return self._ends(self.node.get_subscriptions_info_by_topic)

    def log(self, topic: str, type_name: str, qos: QoSProfile | None = None) -> TopicLog:
        """Keep what is published on a topic, with a quality of service that its publishers serve, or a given one."""
        self._listening.append(TopicLog(self.node, topic, find_type(type_name), qos=qos))
        return self._listening[-1]

    def say(self, topic: str, text: str) -> None:
        """Publish a `std_msgs/String` to all who listen by now; it is kept for those who listen later."""
        if topic not in self._publishers:
            self._publishers[topic] = self.node.create_publisher(String, topic, LATCHED)
        publisher = self._publishers[topic]
        count, taking = publisher.get_subscription_count, self.node.get_subscriptions_info_by_topic
        self.wait(
            lambda: (
                count() >= self.node.count_subscribers(topic)
                or count() >= sum(info.topic_type == TEXTS for info in taking(topic))
            )
        )
        publisher.publish(String(data=text))

    def has_arrived(self) -> bool:
        """Return whether all that was said has come to those who listen; the lab's profile lets them tell soon."""
        # Without a timeout, for rclpy holds the interpreter's lock while it waits.
        return all(publisher.wait_for_all_acked(Duration()) for publisher in self._publishers.values())

    def period(self, log: TopicLog, expected: float) -> float | None:
        """Measure the time between messages (s) on a simulated clock, by driving it.

        Args:
            log: of the topic.
            expected: about what it should be, in s; the clock makes eighths of it, and six of it at most.

        Returns:
            None if fewer than three messages came, or not evenly, or more come while the clock stands: what
            publishes does not follow this clock.
        """
        period, count = self._measure(log, expected)
        if count > 1 and not has_period(period, expected):
            # A message may have come later than the answers that tell of it, or one that no timer sent between two.
            period, _ = self._measure(log, expected)
        return None if period is None or self._goes_on(log) else period

    def _goes_on(self, log: TopicLog) -> bool:
        """Return whether messages come while the clock stands, for four times as long as they took before."""
        count = log.count + 1  # one may be late
        gap = median_gap([sample.published for sample in log.samples()]) or 0.0
        return self.wait(lambda: log.count > count, 4 * gap)

    def _measure(self, log: TopicLog, expected: float) -> tuple[float | None, int]:
        """Return the period, None if there is none to be seen, and how many messages came."""
        begin, times = self.simulated, list[float]()
        for number in range(1, 49):
            before = log.count
            is_silent = number > (len(times) + 1) * 8 * SILENT_PERIODS
            if len(times) >= 3 or is_silent or not self.step_clock(begin + number * expected / 8):
                break
            times += [self.simulated] * (log.count - before)
        gaps = [later - earlier for earlier, later in itertools.pairwise(times)]
        # A step or less: what publishes is faster than the steps, or is woken by them.
        is_even = bool(gaps) and max(gaps) - min(gaps) <= expected / 4 and min(gaps) >= 3 / 16 * expected
        return (median_gap(times) if len(gaps) > 1 and is_even else None), len(times)

    def make_clock(self) -> None:
        """Have a simulated clock in the domain."""
        if self._clock is None:
            self._clock = self.node.create_publisher(find_type(CLOCK), "/clock", 10, event_callbacks=UNTOLD)

    def step_clock(self, seconds: float) -> bool:
        """Set the simulated clock, and wait until every node has done what was then due.

        Returns:
            Whether there is a node that follows the clock, and all nodes answered.
        """
        self.make_clock()
        if not self.wait(lambda: self._clock.get_subscription_count() > 0):
            return False
        self.simulated = round(seconds, 6)
        message = find_type(CLOCK)()
        message.clock.sec, message.clock.nanosec = divmod(round(self.simulated * 1e9), 10**9)
        self._steps.append((time.monotonic(), self.simulated))
        self._clock.publish(message)
        return self.settle()

    def settle(self, timeout: float | None = None, least: int = 1) -> bool:
        """Wait until all nodes have done what was to be done, and nothing more is received.

        Args:
            timeout: for an answer, in s; None is `patience`.
            least: how many rounds of questions, at least.

        Returns:
            Whether there are nodes, and all of them answered; `is_restless` tells whether something was received at
            each answer all the same.
        """
        start, names = time.monotonic(), self.asked()
        # On a clock, the second answer comes after what was due at the first.
        rounds, times = (3, 2) if self._clock else (1, 1)
        for number in range(1, 10 * least + 1):
            before = self.counts()
            if not names or self.ask(names, self.patience if timeout is None else timeout, times):
                return False
            left = self._still_at_work(before, names)
            self.is_restless = bool(left)
            if number < least:
                continue
            if not left or (least == 1 and number >= rounds and time.monotonic() - start > RESTLESS):
                break
            names = left
        return True

    def _still_at_work(self, before: Mapping[str, int], names: list[str]) -> list[str]:
        """Return which of some nodes may not be done, by how many messages had come on each topic before they answered."""
        came = [topic for topic, count in self.counts().items() if count > before.get(topic, 0)]
        if not came or self.simulated <= STILL:
            return names if came else []
        # Whoever publishes at each answer was found out; now only what others make of a message is to come.
        receivers = self.receivers(came)
        return [name for name in names if name in receivers]

    def simulated_at(self, when: float) -> float:
        """Return what the simulated clock showed at a time of `time.monotonic()`, in s."""
        number = bisect.bisect(self._steps, (when, math.inf))
        return self._steps[number - 1][1] if number else 0.0

    def all_answer(self) -> bool:
        """Ask every node for its parameters, and tell whether there are any and all of them answer: they spin."""
        return self.wait(self.nodes) and not self.ask(self.asked(), self.patience)

    def ask(self, names: Collection[str], timeout: float, times: int = 1) -> set[str]:
        """Ask nodes for their parameters, so that they answer when they have done what was to be done before.

        Each participant that listens asks: an answer tells nothing of what another one hears, or is known to hear.

        A service drops a response if it has not met the client's subscription within 0.1 s (rmw_fastrtps, pull
        request 467), which is longer on a busy machine: who has not answered in half of the time is asked once more.

        Args:
            names: of the nodes.
            timeout: for the answers, in s; longer on a busy machine, where a node waits for its turn.
            times: how often each is asked, at once.

        Returns:
            The names of those that do not answer: nobody spins them.
        """
        asked = [(node, name) for node in self._listener.nodes for name in names]
        clients = {who: client for who in asked if (client := self._client(*who)) is not None}
        self.wait(
            lambda: all(client.service_is_ready() for client in clients.values()) or self.has_lost(), timeout
        )
        left = {who: client for who, client in clients.items() if client.service_is_ready()}
        absent = {name for _, name in {*asked} - {*left}}
        for _ in range(2):
            self._take_answers(left, timeout / 2, times)
            if not left or self.has_lost():
                break
        return absent | {name for _, name in left}

    def _take_answers(self, clients: dict[tuple[Node, str], Any], timeout: float, times: int) -> None:
        """Ask nodes, and take away the clients of those that answer."""
        # All but the last answers tell only that they come, and an empty one is least work for the node.
        before = [GetParameters.Request()] * (times - 1)
        answers = {
            who: [client.call_async(request) for request in (*before, self.request(who[1]))]
            for who, client in clients.items()
        }
        self.wait(lambda: self.has_lost() or _all_done(answers.values()), timeout / processor_share())
        if self.has_lost():
            self.wait(lambda: _all_done(answers.values()), LATE)
        for who, futures in answers.items():
            if _all_done([futures]) and futures[-1].result() is not None:
                self.take_answer(who[1], futures[-1].result())
                del clients[who]

    def asked(self) -> list[str]:
        """Return the names of the nodes that are asked."""
        return list(dict.fromkeys(self.nodes()))

    def receivers(self, topics: Collection[str]) -> set[str]:
        """Return the full names of the nodes that subscribe to topics."""
        subscribers = self.subscribers()
        return {node for topic in topics for node in subscribers.get(topic, ())}

    def counts(self) -> dict[str, int]:
        """Return how many messages were received on each topic that is listened to."""
        return {log.topic: log.count for log in self._listening}

    def request(self, name: str) -> GetParameters.Request:  # noqa: ARG002 -- others ask each something else
        """Return what a node is asked."""
        return GetParameters.Request()

    def take_answer(self, name: str, answer: GetParameters.Response) -> None:
        """Take what a node has answered; here, that it does is all."""

    def has_lost(self) -> bool:
        """Return whether a program has ended meanwhile; here, nobody tells."""
        return False

    def forget_questions(self) -> None:
        """Ask by new clients from now on: an answer to one comes after its program knows of what was made before."""
        for node, name in list(self._questions):
            node.destroy_client(self._questions.pop((node, name)))

    def _client(self, node: Node, name: str) -> Any:
        """Return a node's client that asks another node; None if that one's name is too long for a service's."""
        if (node, name) not in self._questions:
            with contextlib.suppress(InvalidServiceNameException):
                self._questions[node, name] = node.create_client(GetParameters, f"{name}/get_parameters")
        return self._questions.get((node, name))

    def parameters(self, name: str) -> dict[str, Any]:
        """Return the values of a node's parameters by their names, arrays as lists; none if it does not answer."""
        client = AsyncParameterClient(self.node, name)
        if not self.wait(client.services_are_ready):
            return {}
        if not (listed := self._answers(client.list_parameters)):
            return {}
        names = list(listed[0].result.names)
        if not (got := self._answers(partial(client.get_parameters, names))):
            return {}
        found = (parameter_value_to_python(value) for value in got[0].values)
        plain = (list(value) if isinstance(value, array.array) else value for value in found)
        return dict(zip(names, plain, strict=False))  # a node may answer with fewer than it has named

    def set_parameter(self, node: str, name: str, value: Any) -> bool:
        """Set a parameter of a node that runs, and return whether the node has accepted the value."""
        client = AsyncParameterClient(self.node, node)
        if not self.wait(client.services_are_ready):
            return False
        answers = self._answers(partial(client.set_parameters, [Parameter(name, value=value)]))
        return bool(answers) and all(result.successful for result in answers[0].results)

    def _answers(self, *questions: Callable[[], Future[Any]]) -> list[Any]:
        """Ask services, and those once more that have not answered in half of the patience.

        A service drops a response if it has not met the client's subscription within 0.1 s (rmw_fastrtps, pull
        request 467), which is longer on a busy machine.

        Args:
            questions: each calls a service, whose response is the same when it is called again.

        Returns:
            The responses; none if one did not come.
        """
        asked = [(question, question()) for question in questions]
        self.wait(lambda: all(future.done() for _, future in asked), self.patience / 2)
        futures = [future if future.done() else question() for question, future in asked]
        is_answered = self.wait(lambda: all(future.done() for future in futures), self.patience / 2)
        return [future.result() for future in futures] if is_answered else []

    def count_publishers(self, topic: str) -> int:
        """Return how many publishers others have on a topic."""
        infos = self.node.get_publishers_info_by_topic(topic)
        return sum(info.node_name != self.node.get_name() for info in infos)

    def close(self) -> None:
        """End the programs and give the domain back. Closing twice does no harm."""
        self._open.close()

    def _ends(self, infos_of: Callable[[str], list[Any]]) -> dict[str, dict[str, list[str]]]:
        found: dict[str, dict[str, list[str]]] = {}
        for topic, _ in sorted(self.node.get_topic_names_and_types()):
            for info in infos_of(topic) if topic not in every_node.HIDDEN_TOPICS else ():
                name = f"{info.node_namespace.rstrip('/')}/{info.node_name}"
                types = found.setdefault(topic, {}).setdefault(name, [])
                if info.topic_type not in types:
                    types.append(info.topic_type)
            found.get(topic, {}).pop(f"/{self.node.get_name()}", None)
        return {topic: nodes for topic, nodes in found.items() if nodes}

    def __enter__(self) -> ObservedDomain:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _all_done(groups: Iterable[Sequence[Future[Any]]]) -> bool:
    return all(future.done() for futures in groups for future in futures)


def _types(ends: Mapping[str, Mapping[str, Sequence[str]]]) -> dict[str, list[str]]:
    return {
        topic: sorted({name for types in nodes.values() for name in types}) for topic, nodes in ends.items()
    }
