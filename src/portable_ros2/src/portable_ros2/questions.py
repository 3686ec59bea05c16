"""Questions to the services of several nodes at the same time, so that the silent ones cost one deadline."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any, NamedTuple

from portable_ros2.graph import POLL_PERIOD

DEADLINE = 5.0  # s for a service to be there, and again for its answer
ABSENT_DEADLINE = 1.0  # s for a service that a complete look at the graph has not seen


class Question(NamedTuple):
    """What a service of a node is asked."""

    target: str
    service: str
    service_class: Any
    request: Any


def answers(node: Any, questions: Sequence[Question], kind: str) -> list[Any]:
    """Ask services.

    Args:
        node: asks.
        questions: what is asked.
        kind: of what kind the services are, for people.

    Returns:
        The answers, and where there is none a RuntimeError that tells why.
    """
    import rclpy

    present = {name for name, _ in node.get_service_names_and_types()}
    asked = [
        _Asked(
            question,
            kind,
            node.create_client(question.service_class, question.service),
            DEADLINE if question.service in present else ABSENT_DEADLINE,
        )
        for question in questions
    ]
    try:
        still_open = asked
        while still_open := [question for question in still_open if not question.is_over()]:
            rclpy.spin_once(node.node, timeout_sec=POLL_PERIOD)
        return [question.answer for question in asked]
    finally:
        for question in asked:
            node.destroy_client(question.client)


class _Asked:
    def __init__(self, question: Question, kind: str, client: Any, deadline: float) -> None:
        self.question, self.kind, self.client = question, kind, client
        self.deadline = time.monotonic() + deadline
        self.future: Any = None
        self.answer: Any = None

    def is_over(self) -> bool:
        """Send the request once the service is there, and take the answer once it has come."""
        if self.answer is not None:
            return True
        if self.future is None and self.client.service_is_ready():
            self.future = self.client.call_async(self.question.request)
            self.deadline = time.monotonic() + DEADLINE
        if self.future is not None and self.future.done():
            self.answer = self.future.result()
        elif time.monotonic() >= self.deadline:
            self.answer = RuntimeError(self._silence())
        return self.answer is not None

    def _silence(self) -> str:
        target = self.question.target
        if self.future is None:
            return f"Wait for service timed out waiting for {self.kind} services for node {target}"
        return f"Exception while calling service of node '{target}': there was no answer for {DEADLINE:g} seconds"
