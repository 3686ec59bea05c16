"""`ros2 topic bw`."""

from __future__ import annotations

import argparse
import sys
from collections import deque

from portable_ros2 import graph, qos
from portable_ros2.commands.topic import _topics
from portable_ros2.verb import Verb

DEFAULT_WINDOW = 100
PERIOD = 1.0  # s between two outputs


class BwVerb(Verb):
    """Display bandwidth used by topic."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        graph.add_arguments(parser)
        _topics.add_topic_argument(parser, "monitor for bandwidth utilization", dest="topic")
        _topics.add_window_argument(parser, "bandwidth", DEFAULT_WINDOW)

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        with graph.GraphNode(args) as node:
            message_class = _topics.topic_class(node, args.topic, waits=True)
            clock = node.get_clock()
            arrived: deque[tuple[int, int]] = deque(maxlen=args.window)  # when (ns), how many bytes

            def note(message: bytes) -> None:
                arrived.append((clock.now().nanoseconds, len(message)))

            def tell() -> None:
                now = clock.now().nanoseconds
                if len(arrived) > 1 and now <= arrived[0][0]:
                    print("WARNING: time is reset!", file=sys.stderr)
                    arrived.clear()
                if len(arrived) > 1:
                    print(bandwidth((now - arrived[0][0]) * 1e-9, [size for _, size in arrived]))

            profile = qos.with_room(qos.preset("sensor_data"))
            node.create_subscription(message_class, args.topic, note, profile, raw=True)
            print(f"Subscribed to [{args.topic}]")
            node.create_timer(PERIOD, tell)
            _topics.spin(node)


def bandwidth(duration: float, sizes: list[int]) -> str:
    """Return the bandwidth as a text.

    Args:
        duration: seconds since the first of the messages.
        sizes: how many bytes each of them has.
    """
    rate = sum(sizes) / duration
    if rate < 1e3:
        unit = _in_bytes
    elif rate < 1e6:
        unit = _in_kilobytes
    else:
        unit = _in_megabytes
    mean, least, greatest = unit(sum(sizes) / len(sizes)), unit(min(sizes)), unit(max(sizes))
    return (
        f"{unit(rate)}/s from {len(sizes)} messages\n\tMessage size mean: {mean} min: {least} max: {greatest}"
    )


def _in_bytes(count: float) -> str:
    return f"{count:.0f} B"


def _in_kilobytes(count: float) -> str:
    return f"{count / 1e3:.2f} KB"


def _in_megabytes(count: float) -> str:
    return f"{count / 1e6:.2f} MB"
