"""`ros2 topic pub`."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from typing import Any

from portable_ros2 import graph, messages, qos
from portable_ros2.commands.topic import _topics
from portable_ros2.verb import Verb

WAIT_PERIOD = 0.1  # s between two looks for subscriptions
WAITS_PER_LINE = 10
ACKNOWLEDGEMENT_TIMEOUT = 1.0  # s


class PubVerb(Verb):
    """Publish a message to a topic."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        graph.add_arguments(parser)
        _topics.add_topic_argument(parser, "publish to")
        _topics.add_type_argument(parser, "message_type", "Type of the ROS message")
        _add_value_arguments(parser)
        parser.add_argument(
            "-r",
            "--rate",
            metavar="N",
            type=_topics.positive_float,
            default=1.0,
            help="Publishing rate in Hz (default: 1)",
        )
        parser.add_argument(
            "-p",
            "--print",
            metavar="N",
            type=int,
            default=1,
            help="Only print every N-th published message (default: 1); 0 prints none",
        )
        _add_end_arguments(parser)
        parser.add_argument("-n", "--node-name", help="Name of the created publishing node")
        qos.add_arguments(parser, "publish", "default")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        message = messages.find_message(args.message_type)()
        values = messages.parse_values(sys.stdin.buffer.read() if args.stdin else args.values)
        stamp_setters = messages.fill(message, values)
        times = 1 if args.once else args.times
        wanted = args.wait_matching_subscriptions
        if wanted is None:
            wanted = int(times > 0)
        if not wanted and args.max_wait_time_secs is not None:
            raise RuntimeError(
                "--max-wait-time-secs option is only effective"
                " with --wait-matching-subscriptions, --once or --times"
            )
        with graph.GraphNode(args, name=args.node_name) as node:
            _topics.full_name(node, args.topic_name)
            publisher = node.create_publisher(type(message), args.topic_name, qos.profile(args))
            _wait_for_subscriptions(publisher, wanted, args.max_wait_time_secs)
            print("publisher: beginning loop")
            send = _sender(node, publisher, message, stamp_setters, args.print)
            _publish(node, send, times, args.rate)
            _let_arrive(publisher, args.keep_alive)


def _add_value_arguments(parser: argparse.ArgumentParser) -> None:
    group = parser.add_mutually_exclusive_group()
    argument = group.add_argument(
        "values",
        nargs="?",
        default="{}",
        help="Values to fill the message with in YAML format (e.g. 'data: Hello World'), "
        "otherwise the message will be published with default values",
    )
    argument.completer = _complete_values  # type: ignore[attr-defined]
    group.add_argument("--stdin", action="store_true", help="Read values from standard input")


def _add_end_arguments(parser: argparse.ArgumentParser) -> None:
    group = parser.add_mutually_exclusive_group()
    group.add_argument("-1", "--once", action="store_true", help="Publish one message and exit")
    group.add_argument(
        "-t",
        "--times",
        type=_topics.unsigned_int,
        default=0,
        help="Publish this number of times and then exit",
    )
    parser.add_argument(
        "-w",
        "--wait-matching-subscriptions",
        type=_topics.unsigned_int,
        help="Wait for this number of subscriptions (default: 1 with --once and --times, otherwise 0)",
    )
    parser.add_argument(
        "--max-wait-time-secs",
        type=_topics.positive_float,
        help="Wait so many seconds for subscriptions at the most (default: for ever)",
    )
    parser.add_argument(
        "--keep-alive",
        metavar="N",
        type=_topics.positive_float,
        default=0.1,
        help="Keep publishing node alive for N seconds after the last message (default: 0.1)",
    )


def _complete_values(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    """Return the message with its default values; argcomplete quotes it as the shell needs it."""
    try:
        return [messages.to_yaml(messages.find_message(parsed_args.message_type)()).rstrip()]
    except RuntimeError:
        return []


def _wait_for_subscriptions(publisher: Any, wanted: int, longest: float | None) -> None:
    waits = 0
    while (matched := publisher.get_subscription_count()) < wanted:
        if waits % WAITS_PER_LINE == 0:
            print(f"Waiting for at least {wanted} matching subscription(s)...")
        if longest is not None and waits * WAIT_PERIOD >= longest:
            raise RuntimeError(
                f"Timed out waiting for subscribers: Expected {wanted} subcribers"
                f" but only got {matched} subscribers"
            )
        waits += 1
        time.sleep(WAIT_PERIOD)


def _publish(node: Any, send: Callable[[int], None], times: int, rate: float) -> None:
    """Send message 1 at once and the others at a rate.

    Args:
        node: its clock tells when.
        send: sends the message of a number.
        times: the number of the last message; 0 if there is none.
        rate: in Hz.
    """
    sent = 0

    def send_next() -> None:
        nonlocal sent
        if not times or sent < times:
            sent += 1
            send(sent)

    send_next()
    node.create_timer(1.0 / rate, send_next)
    _topics.spin(node, lambda: sent == times)


def _sender(
    node: Any, publisher: Any, message: Any, stamp_setters: list[messages.StampSetter], print_every: int
) -> Callable[[int], None]:
    def send(number: int) -> None:
        now = node.get_clock().now().to_msg()
        for set_stamp in stamp_setters:
            set_stamp(now)
        if print_every and number % print_every == 0:
            print(f"publishing #{number}: {message!r}\n")
        publisher.publish(message)

    return send


def _let_arrive(publisher: Any, keep_alive: float) -> None:
    """Wait until reliable subscriptions have what was published, and then as long as was asked for."""
    from rclpy.duration import Duration

    publisher.wait_for_all_acked(Duration(seconds=ACKNOWLEDGEMENT_TIMEOUT))
    time.sleep(keep_alive)
