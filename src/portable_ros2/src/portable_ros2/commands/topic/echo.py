"""`ros2 topic echo`."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable
from typing import Any

from portable_ros2 import graph, messages, qos
from portable_ros2.commands.topic import _topics
from portable_ros2.verb import Verb

DEFAULT_TRUNCATE_LENGTH = 128
END = "---\n"  # after each message


class EchoVerb(Verb):
    """Output messages from a topic."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        graph.add_arguments(parser)
        _topics.add_topic_argument(parser, "listen to")
        argument = parser.add_argument(
            "message_type", nargs="?", help="Type of the ROS message (e.g. 'std_msgs/msg/String')"
        )
        argument.completer = _topics.complete_type  # type: ignore[attr-defined]
        qos.add_arguments(parser, "subscribe", "sensor_data")
        parser.add_argument(
            "--once", action="store_true", help="Print the first message received and then exit"
        )
        parser.add_argument(
            "--timeout", metavar="N", type=_topics.positive_float, help="Exit after N seconds"
        )
        parser.add_argument(
            "--filter",
            dest="filter_expr",
            metavar="EXPR",
            help="Print only messages for which this Python expression holds; m is the message",
        )
        parser.add_argument(
            "--no-lost-messages", action="store_true", help="Don't report when a message is lost"
        )
        parser.add_argument("--raw", action="store_true", help="Echo the raw binary representation")
        _add_format_arguments(parser)

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        holds = _topics.expression(args.filter_expr)
        path = _path(args.field)
        text_of = _formatter(args)
        with graph.GraphNode(args) as node:
            message_class, profile = _find(node, args)
            if path:
                _check_path(message_class, path, args)
            printed = False

            def show(message: Any, info: dict[str, int]) -> None:
                nonlocal printed
                if args.once and printed:
                    return
                shown = _inner(message, path)
                if holds(shown):
                    sys.stdout.write(text_of(shown, info))
                    printed = True

            _subscribe(node, message_class, profile, show, args)
            _topics.spin(node, lambda: args.once and printed, args.timeout)


def _add_format_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--csv",
        action="store_true",
        help="Output all recursive fields separated by commas (e.g. for plotting)",
    )
    parser.add_argument(
        "--field", help="Echo a selected field of a message, such as pose.pose.position or ranges[0]"
    )
    parser.add_argument(
        "-f", "--full-length", action="store_true", help="Output all elements of arrays, bytes and strings"
    )
    parser.add_argument(
        "-l",
        "--truncate-length",
        type=_topics.unsigned_int,
        default=DEFAULT_TRUNCATE_LENGTH,
        help=f"The length to truncate arrays, bytes and strings to (default: {DEFAULT_TRUNCATE_LENGTH})",
    )
    parser.add_argument("--no-arr", action="store_true", help="Don't print array fields of messages")
    parser.add_argument("--no-str", action="store_true", help="Don't print string fields of messages")
    parser.add_argument(
        "--flow-style", action="store_true", help="Print collections in one line (not available with --csv)"
    )
    parser.add_argument(
        "-i",
        "--include-message-info",
        action="store_true",
        help="Show the time stamps and numbers of each message",
    )


def _find(node: Any, args: argparse.Namespace) -> tuple[type[Any], Any]:
    """Return the message class and the quality of service to subscribe with."""
    topic = _topics.full_name(node, args.topic_name)
    profile, notes = qos.profile_for(node.get_publishers_info_by_topic(topic), args)
    for note in notes:
        print(note)
    if args.message_type is None:
        return _topics.topic_class(node, args.topic_name), profile
    return messages.find_message(args.message_type), profile


def _subscribe(
    node: Any,
    message_class: type[Any],
    profile: Any,
    callback: Callable[[Any, dict[str, int]], None],
    args: argparse.Namespace,
) -> None:
    from rclpy.event_handler import SubscriptionEventCallbacks

    events = None if args.no_lost_messages else SubscriptionEventCallbacks(message_lost=_tell_lost)
    node.create_subscription(
        message_class,
        args.topic_name,
        callback,
        qos.with_room(profile, args),
        event_callbacks=events,
        raw=args.raw,
    )


def _tell_lost(status: Any) -> None:
    sys.stdout.write(
        f"A message was lost!!!\n\ttotal count change:{status.total_count_change}"
        f"\n\ttotal count: {status.total_count}{END}"
    )


def _formatter(args: argparse.Namespace) -> Callable[[Any, dict[str, int]], str]:
    """Return a function that gives the text of a message or of a part of one."""
    limits = {
        "truncate_length": None if args.full_length else args.truncate_length,
        "no_arr": args.no_arr,
        "no_str": args.no_str,
    }

    def text(shown: Any, info: dict[str, int]) -> str:
        if not hasattr(shown, "SLOT_TYPES"):  # a number, a text, an array, the bytes of a message
            before = f"---Got new message, message info:---\n{info}\n---Message data:---\n"
            return f"{before if args.include_message_info else ''}{shown}\n{END}"
        if args.csv:
            numbers = [*map(str, info.values())] if args.include_message_info else []
            return ",".join([*numbers, messages.to_csv(shown, **limits)]) + "\n"
        before = messages.dict_to_yaml(dict(sorted(info.items()))) + END if args.include_message_info else ""
        return before + messages.to_yaml(shown, **limits, flow_style=args.flow_style) + END

    return text


def _path(field: str | None) -> list[str | int]:
    """Return the steps to a field: names, and numbers for the elements of a list."""
    if field is None:
        return []
    parts = re.findall(r"\[(-?\d+)\]|([^.\[\]]+)", field)
    if not parts or re.sub(r"\[(-?\d+)\]|([^.\[\]]+)|\.", "", field):
        raise RuntimeError(f"Invalid field value '{field}'")
    return [int(number) if number else name for number, name in parts]


def _check_path(message_class: type[Any], path: list[str | int], args: argparse.Namespace) -> None:
    """Raise an error if the messages of a class cannot have such a field."""
    if args.raw:
        raise RuntimeError("--field needs a message, but --raw shows its bytes; leave one of them out")
    kind: Any = None
    names = dict(messages.fields_of(message_class))
    for step in path:
        if isinstance(step, int) and hasattr(kind, "value_type"):
            kind = kind.value_type
        elif isinstance(step, str) and step in names:
            kind = names[step]
        else:
            known = f"there are {', '.join(names)}" if names else "there are none"
            raise RuntimeError(f"Invalid field '{args.field}': no field '{step}' there; {known}")
        names = {}
        if hasattr(kind, "namespaces"):
            names = dict(messages.fields_of(messages.find_message("/".join(kind.namespaced_name()))))


def _inner(message: Any, path: list[str | int]) -> Any:
    for step in path:
        try:
            message = message[step] if isinstance(step, int) else getattr(message, step)
        except IndexError:
            raise RuntimeError(f"Invalid field: no element [{step}] in a list of {len(message)}") from None
    return message
