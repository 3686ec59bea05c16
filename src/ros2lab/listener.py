"""What a node that only listens and asks receives, handed on in the thread that waits for it."""

from __future__ import annotations

import contextlib
from typing import Any

from rclpy._rclpy_pybind11 import WaitSet
from rclpy.client import Client
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.service import Service
from rclpy.subscription import Subscription


class Listener:
    """Hands on messages, requests and answers, as an executor of rclpy does, in a third of its time.

    An executor looks twice for each callback, and makes anew all that it waits with each time that it looks. Timers and
    events are nobody's here, and nothing is destroyed by another thread.

    Args:
        node: that listens.
        context: of the node.

    Attributes:
        nodes: that listen; here, the only one.
    """

    def __init__(self, node: Node, context: Context) -> None:
        self.nodes = [node]
        self._node = node
        self._context = context
        self._waits: tuple[list[int], WaitSet] | None = None

    def listen(self, seconds: float) -> None:
        """Wait until something is there, at most for so long, and hand on what is: of each end what came first.

        Raises:
            ExternalShutdownException: if the context was shut down.
        """
        ends: list[list[Any]] = [
            [*kind] for kind in (self._node.subscriptions, self._node.clients, self._node.services)
        ]
        waits = self._waits_for([*map(len, ends)])
        waits.clear_entities()
        adding = (waits.add_subscription, waits.add_client, waits.add_service)
        for kind, add in zip(ends, adding, strict=True):
            for end in kind:
                add(end.handle)
        waits.wait(round(seconds * 1e9))
        if not self._context.ok():
            raise ExternalShutdownException
        names = ("subscription", "client", "service")
        ready = [{*waits.get_ready_entities(name)} for name in names]
        hands_on = (_hand_on_message, _hand_on_answer, _hand_on_request)
        for kind, there, hand_on in zip(ends, ready, hands_on, strict=True):
            for end in kind:
                if there and end.handle.pointer in there:
                    hand_on(end)

    def close(self) -> None:
        """Give back what it waits with. Closing twice does no harm."""
        self._waits = None

    def _waits_for(self, counts: list[int]) -> WaitSet:
        """Return what waits for so many subscriptions, clients and services."""
        if self._waits is None or self._waits[0] != counts:
            subscriptions, clients, services = counts
            with self._context.handle:
                self._waits = counts, WaitSet(subscriptions, 0, 0, clients, services, 0, self._context.handle)
        return self._waits[1]


def _hand_on_message(subscription: Subscription) -> None:
    taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
    if taken is not None:
        is_alone = subscription._callback_type is Subscription.CallbackType.MessageOnly
        subscription.callback(*taken[:1] if is_alone else taken)


def _hand_on_answer(client: Client) -> None:
    header, response = client.handle.take_response(client.srv_type.Response)
    if header is None:
        return
    with contextlib.suppress(KeyError):  # nobody waits for it any more
        client.get_pending_request(header.request_id.sequence_number).set_result(response)


def _hand_on_request(service: Service) -> None:
    request, header = service.handle.service_take_request(service.srv_type.Request)
    if header is not None:
        service.send_response(service.callback(request, service.srv_type.Response()), header)
