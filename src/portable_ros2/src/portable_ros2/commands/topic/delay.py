"""`ros2 topic delay`."""

from __future__ import annotations

import argparse
from collections import deque
from typing import Any

from portable_ros2 import graph, qos
from portable_ros2.commands.topic import _topics
from portable_ros2.verb import Verb

DEFAULT_WINDOW = 10000
PERIOD = 1.0  # s between two outputs


class DelayVerb(Verb):
    """Display delay of topic from timestamp in header."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        graph.add_arguments(parser)
        _topics.add_topic_argument(parser, "calculate the delay for", dest="topic")
        _topics.add_window_argument(parser, "delay", DEFAULT_WINDOW)

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        with graph.GraphNode(args) as node:
            message_class = _topics.topic_class(node, args.topic, waits=True)
            if not hasattr(message_class, "header"):
                raise RuntimeError("msg does not have header")
            clock = node.get_clock()
            delays = Delays(args.window)

            def note(message: Any) -> None:
                stamp = message.header.stamp
                delays.add(clock.now().nanoseconds, stamp.sec * 10**9 + stamp.nanosec)

            def tell() -> None:
                if text := delays.text():
                    print(text)

            profile = qos.with_room(qos.preset("sensor_data"))
            node.create_subscription(message_class, args.topic, note, profile)
            node.create_timer(PERIOD, tell)
            _topics.spin(node)


class Delays:
    """How long messages were under way.

    Args:
        window: so many of the newest messages are taken.
    """

    def __init__(self, window: int) -> None:
        self._delays: deque[int] = deque(maxlen=window)
        self._newest: int | None = None
        self._has_new = False

    def add(self, now: int, stamp: int) -> None:
        """Count a message.

        Args:
            now: its time of arrival in nanoseconds; 0 if the clock does not run yet.
            stamp: the time in its header in nanoseconds.
        """
        has_reset = self._newest is not None and now < self._newest
        if now == 0 or has_reset:
            if self._delays:
                print("time has reset, resetting counters")
            self._delays.clear()
        # The first message tells only when the clock runs, as in the real command.
        if now > 0 and self._newest is not None and not has_reset:
            self._delays.append(now - stamp)
            self._has_new = True
        self._newest = now if now > 0 else None

    def text(self) -> str:
        """Return the delay and how regular it is; nothing before the first message."""
        if not self._delays:
            return ""
        if not self._has_new:
            return "no new messages"
        self._has_new = False
        mean, least, greatest, deviation, number = _topics.statistics(self._delays)
        return (
            f"average delay: {mean * 1e-9:.3f}\n\tmin: {least * 1e-9:.3f}s max: {greatest * 1e-9:.3f}s"
            f" std dev: {deviation * 1e-9:.5f}s window: {number}"
        )
