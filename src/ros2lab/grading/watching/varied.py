"""What nodes wait for and nothing in a workspace provides: messages, requests and responses of made-up contents."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

from ros2lab.grading.watching.ear import plain
from ros2lab.grading.watching.given import Given
from ros2lab.grading.watching.made_up import Filler
from ros2lab.grading.watching.watch import Watch
from ros2lab.observed_domain import TEXTS
from ros2lab.topics import type_name

PAUSE = 0.08  # s between two turns
SECONDS, TURNS, LEAST_TURNS = 3.2, 32, 24
# Texts and services may end or stop a program, so that what else is given must come first.
FIRST_TEXT, FIRST_CALL = 6, 8  # turns
STAYS = 3  # turns, in which something may come of a call, or of a message that holds no number
ANSWER_TIMEOUT = 2.0  # s, for the last answers
NOT_CALLED = ("lifecycle_msgs/", "action_msgs/")  # a managed node is judged by how the workspace brings it up


class Varied(Given):
    """Gives the nodes of a run what they may wait for, with other contents each time.

    Args:
        watch: the observer's watch of the run.
        contents: the `words` and `numbers` that the code compares, by the last part of the topic's name.
        calls: where the calls of services are noted.
        programs: how many programs were started.
        alive: returns how many of them have not ended.

    Attributes:
        fatal: for each program that ended, in this order, what was given just before, by topic or service.
    """

    def __init__(
        self,
        watch: Watch,
        contents: Mapping[str, Mapping[str, Any]],
        calls: list[dict[str, Any]],
        programs: int,
        alive: Callable[[], int],
    ) -> None:
        super().__init__(watch, (), flags=True)
        self.fatal: list[dict[str, Any]] = []
        self._contents, self._calls, self._living, self._alive = contents, calls, programs, alive
        self._now = lambda: watch.node.get_clock().now().to_msg()
        self._number = 0  # of the turn
        self._counts: dict[str, int] = defaultdict(int)  # what was given on each topic or service
        self._last: dict[str, Any] = {}  # what was given in this turn
        self._pending: dict[str, Any] = {}

    def told(self) -> dict[str, Any]:
        """Return what the grader is told of what was given."""
        return {**super().told(), "fatal": self.fatal}

    def give_all(self) -> None:
        """Give everything, turn by turn, and wait after each until the nodes have taken it.

        Raises:
            Gone: if all programs have ended.
        """
        self._watch.part()  # what follows is heard alone
        try:
            self._turns(time.monotonic() + SECONDS)
            self._watch.until(lambda: all(answer.done() for answer in self._pending.values()), ANSWER_TIMEOUT)
        finally:
            self._note_ends()
            for call in self._calls:
                if call["response"] is None:
                    call["seconds"] = time.monotonic() - call["seconds"]

    def _turns(self, end: float) -> None:
        watch = self._watch
        while self._number < TURNS and (self._number < LEAST_TURNS or time.monotonic() < end):
            self._note_ends()
            before, nodes, self._last = self._alive(), len(watch.nodes()), {}
            self.give()
            self._number += 1
            if watch.is_answering:
                watch.is_answering = watch.settle(watch.patience)
            watch.until(lambda: False, PAUSE)
            if len(watch.nodes()) < nodes:  # before its program ends, so that nothing else is given meanwhile
                watch.until(lambda: self._alive() < before, watch.patience)  # noqa: B023
            watch.check()
            watch.look_again()

    def _note_ends(self) -> None:
        """Note for the programs that have ended meanwhile what was given last."""
        self.fatal += [self._last] * (self._living - self._alive())
        self._living = self._alive()

    def _with_own_stimuli(self) -> set[str]:
        return self._kept

    def _wanted(self) -> Iterator[tuple[Callable[[str, Any], None], str, str]]:
        """Yield what to do, except for what the nodes do among themselves, or what belongs to an action."""
        found = [*super()._wanted()]
        called = {name for do, name, _ in found if do == self._provide}
        offered = {name for do, name, _ in found if do == self._call}
        for do, name, kind in found:
            if "/_" not in name and name not in called & offered and not kind.startswith(NOT_CALLED):
                yield do, name, kind

    def _publish(self, topic: str, message: Any) -> None:
        is_event = {*message.get_fields_and_field_types().values()} <= {"string", "boolean"}
        is_due = self._number >= FIRST_TEXT * (type_name(message) == TEXTS)
        if is_due and not (is_event and self._number % STAYS):
            super()._publish(topic, message)

    def _call(self, service: str, kind: Any) -> None:
        """Call a service now and then, if it has answered the call before."""
        if service not in self._clients:
            self._clients[service] = self._watch.node.create_client(kind, service)
        pending, client = self._pending.get(service), self._clients[service]
        late = self._number - FIRST_CALL - STAYS * self._counts[service]
        if late < 0 or (pending is not None and not pending.done()) or not client.service_is_ready():
            return
        request = self._flagged(service, kind.Request())
        call = {"service": service, "request": plain(request), "response": None, "seconds": time.monotonic()}
        self._calls.append({**call, "is_repeated": False, "is_alive": True, "topics": {}})
        self._pending[service] = client.call_async(request)
        self._pending[service].add_done_callback(partial(_note, self._calls[-1]))
        self.names.add(service)

    def _flagged(self, name: str, message: Any, *, is_first: bool | None = None) -> Any:  # noqa: ARG002
        """Fill a message, a request or a response."""
        given = self._contents.get(name.rpartition("/")[2], {})
        filler = Filler(self._now, given.get("words", ()), given.get("numbers", ()))
        filler.fill(message, self._counts[name])
        self._counts[name] += 1
        self._last[name] = plain(message)
        return message


def _note(call: dict[str, Any], answer: Any) -> None:
    """Note the response to a call."""
    call["response"], call["seconds"] = plain(answer.result()), time.monotonic() - call["seconds"]
