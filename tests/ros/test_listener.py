"""A node's messages, requests and answers are handed on in the thread that listens."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool

from ros2lab.listener import Listener
from ros2lab.observed_domain import LATCHED

PATIENCE = 10.0  # s


@pytest.fixture
def context(domain_id: int) -> Iterator[Context]:
    context = Context()
    context.init(domain_id=domain_id)
    yield context
    context.try_shutdown()


@pytest.fixture
def node(context: Context) -> Iterator[Node]:
    node = Node("listening", context=context, start_parameter_services=False)
    yield node
    node.destroy_node()


@pytest.fixture
def until(node: Node, context: Context) -> Callable[[Callable[[], object]], bool]:
    """Listen until a condition holds; return whether it does in time."""
    listener = Listener(node, context)

    def until(condition: Callable[[], object]) -> bool:
        end = time.monotonic() + PATIENCE
        while not condition() and time.monotonic() < end:
            listener.listen(0.02)
        return bool(condition())

    return until


def test_messages_come_in_the_form_that_was_asked_for(node: Node, until: Callable[[Any], bool]) -> None:
    plain: list[Any] = []
    told: list[Any] = []
    raw: list[Any] = []
    node.create_subscription(String, "/word", plain.append, LATCHED)
    node.create_subscription(String, "/word", lambda message, info: told.append((message, info)), LATCHED)
    node.create_subscription(String, "/word", raw.append, LATCHED, raw=True)
    publisher = node.create_publisher(String, "/word", LATCHED)
    for word in ("one", "two"):
        publisher.publish(String(data=word))
    assert until(lambda: len(plain) == len(told) == len(raw) == 2)
    assert [message.data for message in plain] == ["one", "two"]
    assert told[0][0].data == "one"
    assert told[0][1]["received_timestamp"] > 0
    assert b"two" in raw[1]


def test_requests_are_answered_and_answers_come(node: Node, until: Callable[[Any], bool]) -> None:
    def answer(request: Any, response: Any) -> Any:
        response.success, response.message = request.data, "heard"
        return response

    node.create_service(SetBool, "/set", answer)
    client = node.create_client(SetBool, "/set")
    assert until(client.service_is_ready)
    answers = [client.call_async(SetBool.Request(data=value)) for value in (True, False)]
    assert until(lambda: all(future.done() for future in answers))
    assert [future.result().success for future in answers] == [True, False]


def test_an_answer_for_which_nobody_waits_any_more_is_dropped(
    node: Node, until: Callable[[Any], bool]
) -> None:
    node.create_service(SetBool, "/set", lambda _request, response: response)
    client = node.create_client(SetBool, "/set")
    assert until(client.service_is_ready)
    client.remove_pending_request(client.call_async(SetBool.Request()))
    kept = client.call_async(SetBool.Request())
    assert until(kept.done)


def test_what_is_made_and_destroyed_between_two_looks_is_noticed(
    node: Node, until: Callable[[Any], bool]
) -> None:
    publisher = node.create_publisher(String, "/word", LATCHED)
    publisher.publish(String(data="kept"))
    for _ in range(2):
        heard: list[Any] = []
        subscription = node.create_subscription(String, "/word", heard.append, LATCHED)
        assert until(lambda: heard)  # noqa: B023
        node.destroy_subscription(subscription)


def test_a_context_that_was_shut_down_is_told(node: Node, context: Context) -> None:
    listener = Listener(node, context)
    listener.listen(0.0)
    context.shutdown()
    with pytest.raises(ExternalShutdownException):
        listener.listen(0.0)
