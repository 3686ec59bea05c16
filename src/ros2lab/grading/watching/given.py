"""What nodes wait for and nothing in a workspace provides: messages, requests and responses of made-up contents."""

from __future__ import annotations

import contextlib
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

from rclpy._rclpy_pybind11 import NodeNameNonExistentError

from ros2lab.every_node import HIDDEN_TOPICS
from ros2lab.grading.code.compared import Contents
from ros2lab.grading.watching.ear import plain
from ros2lab.grading.watching.made_up import Filler
from ros2lab.grading.watching.watch import NODES, OF_EVERY_NODE, TOPICS, Watch
from ros2lab.observed_domain import LATCHED, TEXTS, UNTOLD
from ros2lab.topics import find_type, type_name

PAUSE = 0.08  # s between two turns
TURNS = 32
SECONDS = 8.0  # s in all turns, in which nodes that are slow to answer are waited for
# Then what was given stays as it is, in some ways, for as long as a timer of two seconds takes.
HOLDS, HOLD = 8, 2.2  # s
LONGEST = 28.0  # s in all
# Texts and services may end or stop a program, so that what else is given must come first.
FIRST_TEXT, FIRST_CALL = 6, 8  # turns
MOST = 0.75  # of what was given; what a node holds back of it is a choice of its own
STAYS = 3  # turns, in which something may come of a call, or of a message that holds no number
ANSWER_TIMEOUT = 2.0  # s, for the last answers
MANAGES = "lifecycle_msgs/srv/ChangeState"  # makes a managed node begin
BEGIN = (1, 3)  # configure, activate
OF_MANAGED = "lifecycle_msgs/"
OF_ACTIONS = "action_msgs/"
ACTION = "/_action"


class Given:
    """Gives the nodes of a run what they may wait for, with other contents each time, and always the same in each run.

    Args:
        watch: the observer's watch of the run.
        plan: how many `programs` were started; whether commands follow, and so managed nodes are told to configure and
            to activate themselves, and silent ones are waited for; and the `contents`: the `words` and `numbers` that
            the code compares, by the last part of the topic's name; under an empty name for all others.
        calls: where the calls of services are noted.
        alive: returns how many programs have not ended.

    Attributes:
        types: what was given, each topic and service with its type.
        ungiven: what could not be given, such as an action, or what is of a type that is not here; in the same way.
        fatal: for each program that ended, in this order, what was given just before, by topic or service.
        when: when what was given, each with the topic or service.
    """

    def __init__(
        self, watch: Watch, plan: Mapping[str, Any], calls: list[dict[str, Any]], alive: Callable[[], int]
    ) -> None:
        self.types: dict[str, str] = {}
        self.ungiven: dict[str, str] = {}
        self.fatal: list[dict[str, Any]] = []
        self.when: list[tuple[float, str, Any]] = []
        self._watch, self._calls, self._is_thorough = watch, calls, plan["has_commands"]
        self._contents: Contents = plan["contents"]
        self._living, self._alive = plan["programs"], alive
        self._now = lambda: watch.node.get_clock().now().to_msg()
        self._number = 0  # of the turn
        self._hold: int | None = None
        self._flags: list[str] = []  # the topics of a single flag
        self._counts: dict[str, int] = defaultdict(int)  # what was given on each topic or service
        self._last: dict[str, Any] = {}  # what was given in this turn
        # By topic or service, and by type: the values in each message, request or response that was given.
        self._said: dict[str, list[set[Any]]] = defaultdict(list)
        self._publishers: dict[str, Any] = {}
        self._clients: dict[str, Any] = {}
        self._services: dict[str, Any] = {}
        self._pending: dict[str, Any] = {}

    def told(self) -> dict[str, Any]:
        """Return what the grader is told of what was given."""
        types, ungiven = dict(sorted(self.types.items())), dict(sorted(self.ungiven.items()))
        return {"given": [*types], "gave": types, "ungiven": ungiven, "fatal": self.fatal, "when": self.when}

    def handed_on(self, heard: Mapping[str, Mapping[str, Any]]) -> list[str]:
        """Return the topics on which nothing was heard but values that were given together, and most of them."""
        given = self._said.values()
        return [topic for topic, seen in sorted(heard.items()) if any(_is_of(seen, said) for said in given)]

    def give_all(self) -> None:
        """Give everything, turn by turn, and wait after each until the nodes have taken it.

        Raises:
            Gone: if all programs have ended.
        """
        self._watch.part()  # what follows is heard alone
        start = time.monotonic()
        try:
            self._turns()
            if self._is_thorough:
                self._holds(start + LONGEST)
            self._watch.until(lambda: all(answer.done() for answer in self._pending.values()), ANSWER_TIMEOUT)
        finally:
            self._note_ends()
            for call in self._calls:
                if call["response"] is None:
                    call["seconds"] = time.monotonic() - call["seconds"]

    def _turns(self) -> None:
        watch, waited = self._watch, 0.0
        while self._number < TURNS:
            self._note_ends()
            before, nodes, self._last = self._alive(), len(watch.nodes()), {}
            self._give()
            self._number += 1
            if watch.is_answering and waited < SECONDS:
                start = time.monotonic()
                watch.is_answering = watch.settle(watch.patience)
                waited += time.monotonic() - start
            watch.until(lambda: False, PAUSE)
            if len(watch.nodes()) < nodes:  # before its program ends, so that nothing else is given meanwhile
                watch.until(lambda: self._alive() < before, watch.patience)  # noqa: B023
            watch.check()
            watch.look_again()

    def _holds(self, end: float) -> None:
        """Give everything once more, and leave it so for a while; again, until no publisher is silent then."""
        watch = self._watch
        before = {topic: ear.total for topic, ear in watch.ears.items()}

        def is_heard() -> bool:
            topics = watch.publishes.keys() & watch.ears.keys()
            return all(watch.ears[topic].total > before.get(topic, 0) for topic in topics)

        for number in range(HOLDS):
            if (number and is_heard()) or time.monotonic() > end:
                return
            self._note_ends()
            self._hold = number
            self._give()
            watch.until(is_heard, HOLD)
            watch.check()
            watch.look_again()

    def _note_ends(self) -> None:
        """Note for the programs that have ended meanwhile what was given last."""
        self.fatal += [self._last] * (self._living - self._alive())
        self._living = self._alive()

    def _give(self) -> None:
        """Publish on each topic without a publisher, call each service, and provide each that is called."""
        do = {"publish": self._publish, "call": self._call, "provide": self._provide}
        for how, name, kind in [*wanted(self._watch, manages=self._is_thorough)]:
            with contextlib.suppress(Exception):  # rclpy raises many kinds for types and names it cannot use
                do[how](name, find_type(kind))
                continue
            if name not in self.types:
                self.ungiven[name] = kind

    def _publish(self, topic: str, message: Any) -> None:
        is_event = {*message.get_fields_and_field_types().values()} <= {"string", "boolean"}
        is_early = self._number < FIRST_TEXT * (type_name(message) == TEXTS)
        if self._hold is None and (is_early or (is_event and self._number % STAYS)):
            return
        if topic not in self._publishers:
            node = self._watch.holding(topic, type_name(message))
            self._publishers[topic] = node.create_publisher(message, topic, LATCHED, event_callbacks=UNTOLD)
        made = self._filled(topic, message())
        if [*made.get_fields_and_field_types().items()] == [("data", "boolean")]:
            self._flags += [topic] if topic not in self._flags else []
            if self._hold is not None:  # the flags in each way that there is; first all are set
                made.data = not self._hold >> self._flags.index(topic) & 1
        self._publishers[topic].publish(made)
        self.types[topic] = type_name(message)

    def _call(self, service: str, kind: Any) -> None:
        """Call a service now and then, if it has answered the call before."""
        if service in self._services:
            return
        if service not in self._clients:
            self._clients[service] = self._watch.node.create_client(kind, service)
        pending, client = self._pending.get(service), self._clients[service]
        late = self._number - FIRST_CALL - STAYS * self._counts[service]
        is_begun = type_name(kind) == MANAGES
        is_due = self._counts[service] < len(BEGIN) if is_begun else late >= 0 or self._hold is not None
        if not is_due or (pending is not None and not pending.done()) or not client.service_is_ready():
            return
        request = self._filled(service, kind.Request())
        if is_begun:
            request.transition.id, request.transition.label = BEGIN[self._counts[service] - 1], ""
        call = {"service": service, "request": plain(request), "response": None, "seconds": time.monotonic()}
        self._calls.append({**call, "is_repeated": False, "is_alive": True, "topics": {}})
        self._pending[service] = client.call_async(request)
        self._pending[service].add_done_callback(partial(_note, self._calls[-1]))
        self.types[service] = type_name(kind)

    def _provide(self, service: str, kind: Any) -> None:
        is_there = service in self._clients or service in self._services
        if not is_there and not self._watch.node.count_services(service):
            self._services[service] = self._watch.node.create_service(
                kind, service, lambda _, response: self._filled(service, response)
            )
            self.types[service] = type_name(kind)

    def _filled(self, name: str, message: Any) -> Any:
        """Fill a message, a request or a response."""
        given = self._contents.get(name.rpartition("/")[2], self._contents.get("", {}))
        filler = Filler(self._now, given.get("words", ()), given.get("numbers", ()))
        filler.fill(message, self._counts[name])
        self._counts[name] += 1
        self._last[name] = plain(message)
        for group in (name, type_name(type(message))):
            self._said[group].append({*_values(self._last[name])})
        self.when.append((time.monotonic(), name, self._last[name]))
        return message


def _is_of(heard: Mapping[str, Any], given: Sequence[set[Any]]) -> bool:
    """Return whether all that was heard on a topic is in what was given, in the same order, and most of this."""
    at, used = 0, set[int]()
    for values in filter(None, ({*_values(value)} for value in heard["values"])):
        at = next((turn for turn in range(at, len(given)) if values <= given[turn]), len(given))
        used.add(at)
    is_most = heard["count"] > MOST * len(given)
    return is_most and len(given) not in used and 2 * len(used) > min(heard["count"], len(given))


def _values(message: Any, field: str = "") -> Iterator[Any]:
    """Yield what a plain message holds, but zeros and the like: texts, and others with the names of their fields."""
    match message:
        case dict():
            for name, value in message.items():
                yield from _values(value, name)
        case list():
            for value in message:
                yield from _values(value, field)
        case str():
            yield from filter(None, (message,))
        case _:
            yield from ((field, value) for value in (message,) if value)


def wanted(watch: Watch, *, manages: bool = True) -> Iterator[tuple[str, str, str]]:
    """Yield what nodes wait for, and none that lives brings: `publish`, `call`, `provide` or `act`, a name and its type."""
    living = {*watch.nodes()}
    for topic, nodes in sorted(watch.subscribes.items())[:TOPICS]:
        is_brought = not living.isdisjoint(watch.publishes.get(topic, ()))
        if topic not in HIDDEN_TOPICS and not is_brought and "/_" not in topic:
            yield "publish", topic, next(iter(nodes.values()))[0]
    offered, called = dict[str, str](), dict[str, str]()
    for name in sorted(living)[:NODES]:
        space, _, base = name.rpartition("/")
        with contextlib.suppress(NodeNameNonExistentError):  # it has just left
            offered |= _own(watch.node.get_service_names_and_types_by_node(base, space or "/"))
            called |= _own(watch.node.get_client_names_and_types_by_node(base, space or "/"))
    for how, services, others in (("call", offered, called), ("provide", called, offered)):
        for service, kind in services.items():
            if service in others or kind.startswith(OF_ACTIONS):
                continue
            if ACTION in service:
                yield "act", service.partition(ACTION)[0], kind.partition("_")[0]
            elif not kind.startswith(OF_MANAGED) or (manages and kind == MANAGES):
                yield how, service, kind


def _own(found: Any) -> dict[str, str]:
    """Return the services that are not every node's, with their types."""
    return {
        service: types[0] for service, types in found[: 4 * TOPICS] if not types[0].startswith(OF_EVERY_NODE)
    }


def _note(call: dict[str, Any], answer: Any) -> None:
    """Note the response to a call."""
    call["response"], call["seconds"] = plain(answer.result()), time.monotonic() - call["seconds"]
