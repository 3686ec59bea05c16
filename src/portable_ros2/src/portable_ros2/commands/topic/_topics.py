"""What several verbs of `ros2 topic` do: name a topic, find its type, wait for its messages."""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable, Collection
from typing import Any

from portable_ros2 import messages
from portable_ros2.graph import GraphNode, let_wake

COMPLETION_SPIN_TIME = 0.1  # s; a key was pressed, and somebody waits
TYPE_PERIOD = 0.1  # s between two looks for the type of a topic

NamesAndTypes = list[tuple[str, list[str]]]


def add_topic_argument(parser: argparse.ArgumentParser, purpose: str, dest: str = "topic_name") -> None:
    """Add the name of a topic, which completes."""
    argument = parser.add_argument(dest, help=f"Name of the ROS topic to {purpose} (e.g. '/chatter')")
    argument.completer = complete_topic  # type: ignore[attr-defined]


def add_type_argument(parser: argparse.ArgumentParser, dest: str, purpose: str) -> None:
    """Add the name of a message type, which completes."""
    argument = parser.add_argument(dest, help=f"{purpose} (e.g. 'std_msgs/msg/String')")
    argument.completer = complete_type  # type: ignore[attr-defined]


def add_window_argument(parser: argparse.ArgumentParser, quantity: str, default: int) -> None:
    """Add the number of messages of which something is calculated."""
    parser.add_argument(
        "-w",
        "--window",
        type=positive_int,
        default=default,
        help=f"Number of messages of which the {quantity} is calculated (default: {default})",
    )


def complete_topic(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    """Return the names of the topics that there are."""
    with GraphNode(argparse.Namespace(spin_time=COMPLETION_SPIN_TIME)) as node:
        return [
            name for name, _ in names_and_types(node, getattr(parsed_args, "include_hidden_topics", False))
        ]


def complete_type(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    """Return the types of the topic that was already named, or all that there are."""
    topic = getattr(parsed_args, "topic_name", None)
    if topic:
        with GraphNode(argparse.Namespace(spin_time=COMPLETION_SPIN_TIME)) as node:
            for name, types in names_and_types(node, include_hidden=True):
                if name == topic:
                    return types
    return messages.message_names()


def names_and_types(node: Any, include_hidden: bool) -> NamesAndTypes:
    """Return the topics with their types; a part of a hidden one's name begins with an underscore."""
    found: NamesAndTypes = node.get_topic_names_and_types()
    return [(name, types) for name, types in found if include_hidden or "/_" not in name]


def topic_class(node: Any, topic: str, *, waits: bool = False) -> type[Any]:
    """Return the message class of a topic.

    Args:
        node: looks at the graph.
        topic: a name, perhaps relative.
        waits: whether to wait until somebody publishes or subscribes to it.

    Raises:
        RuntimeError: if there is no such topic, it has more than one type, or its type cannot be loaded.
    """
    full = full_name(node, topic)
    types = _types_of(node, full)
    if not types:
        print(f"WARNING: topic [{topic}] does not appear to be published yet")
    while waits and not types:
        time.sleep(TYPE_PERIOD)
        types = _types_of(node, full)
    if not types:
        raise RuntimeError("Could not determine the type for the passed topic")
    if len(types) > 1:
        listed = ", ".join(types)
        raise RuntimeError(f"Cannot echo topic '{topic}', as it contains more than one type: [{listed}]")
    return messages.find_message(types[0], f"The message type '{types[0]}' is invalid")


def full_name(node: Any, topic: str) -> str:
    """Return the name of a topic from the root.

    Raises:
        RuntimeError: if it is not a valid name; the text shows where.
    """
    from rclpy.exceptions import InvalidTopicNameException
    from rclpy.expand_topic_name import expand_topic_name
    from rclpy.validate_full_topic_name import validate_full_topic_name

    try:
        full: str = expand_topic_name(topic, node.get_name(), node.get_namespace())
        validate_full_topic_name(full)
    except (ValueError, InvalidTopicNameException) as error:
        raise RuntimeError(str(error)) from error
    return full


def _types_of(node: Any, full: str) -> list[str]:
    return next((types for name, types in names_and_types(node, include_hidden=True) if name == full), [])


def spin(node: Any, is_done: Callable[[], bool] = lambda: False, timeout: float | None = None) -> None:
    """Run a node's callbacks until something is done.

    What a callback raises is raised here.

    Args:
        node: whose callbacks are run.
        is_done: asked before each callback.
        timeout: seconds after which it is enough; None waits for ever.
    """
    from rclpy.executors import SingleThreadedExecutor

    deadline = math.inf if timeout is None else time.monotonic() + timeout
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node.node)
    try:
        while not is_done() and (left := deadline - time.monotonic()) > 0:
            executor.spin_once(timeout_sec=None if timeout is None else left)
    except BaseException as error:
        let_wake(error)
        raise
    finally:
        executor.shutdown()


def expression(text: str | None) -> Callable[[Any], bool]:
    """Return a function that tells whether a Python expression holds for a message, which it calls `m`.

    Args:
        text: the expression; None holds for every message.

    Raises:
        RuntimeError: if it is not Python; the function raises it if the expression fails.
    """
    if text is None:
        return lambda _: True
    try:
        code = compile(text.strip(), "<filter>", "eval")
    except (SyntaxError, ValueError) as error:
        raise RuntimeError(f"The filter '{text}' is no Python expression: {error}") from error

    def holds(m: Any) -> bool:
        try:
            return bool(eval(code, {"m": m}))  # noqa: S307 -- the user's own expression
        except Exception as error:
            raise RuntimeError(f"The filter '{text}' failed: {type(error).__name__}: {error}") from error

    return holds


def positive_int(text: str) -> int:
    """Return a whole number above 0, for argparse."""
    return int(_number(text, int, lambda value: value > 0, "value must be a positive integer"))


def unsigned_int(text: str) -> int:
    """Return a whole number from 0, for argparse."""
    return int(_number(text, int, lambda value: value >= 0, "value must be non-negative integer"))


def positive_float(text: str) -> float:
    """Return a number above 0, for argparse."""
    return _number(text, float, lambda value: value > 0, "value must be a positive number")


def _number(text: str, kind: Callable[[str], float], fits: Callable[[float], bool], problem: str) -> float:
    try:
        value = kind(text)
    except ValueError:
        raise argparse.ArgumentTypeError(problem) from None
    if not fits(value):
        raise argparse.ArgumentTypeError(problem)
    return value


def statistics(values: Collection[float]) -> tuple[float, float, float, float, int]:
    """Return mean, least, greatest, standard deviation and number of some values."""
    mean = math.fsum(values) / len(values)
    deviation = math.sqrt(math.fsum((value - mean) ** 2 for value in values) / len(values))
    return mean, min(values), max(values), deviation, len(values)
