"""`ros2 topic hz`."""

from __future__ import annotations

import argparse
from collections import deque
from collections.abc import Callable
from typing import Any

from portable_ros2 import graph, qos
from portable_ros2.commands.topic import _topics
from portable_ros2.verb import Verb

DEFAULT_WINDOW = 10000
PERIOD = 10**9  # ns between two outputs


class HzVerb(Verb):
    """Print the average publishing rate to screen."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        graph.add_arguments(parser)
        _topics.add_topic_argument(parser, "listen to")
        _topics.add_window_argument(parser, "rate", DEFAULT_WINDOW)
        parser.add_argument(
            "--filter",
            dest="filter_expr",
            metavar="EXPR",
            help="Measure only messages for which this Python expression holds; m is the message",
        )
        parser.add_argument(
            "--wall-time",
            dest="use_wtime",
            action="store_true",
            help="Use wall time, which helps in a simulation that publishes no clock",
        )

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        holds = _topics.expression(args.filter_expr)
        with graph.GraphNode(args) as node:
            from rclpy.clock import Clock, ClockType

            message_class = _topics.topic_class(node, args.topic_name, waits=True)
            clock = Clock(clock_type=ClockType.SYSTEM_TIME) if args.use_wtime else node.get_clock()
            rate = Rate(args.window)

            def count(message: Any) -> None:
                if holds(message):
                    rate.add(clock.now().nanoseconds, print)

            # What is only counted need not be unpacked.
            profile = qos.with_room(qos.preset("sensor_data"))
            is_raw = args.filter_expr is None
            node.create_subscription(message_class, args.topic_name, count, profile, raw=is_raw)
            _topics.spin(node)


class Rate:
    """The rate of messages, of which the time of arrival is told.

    Args:
        window: so many of the newest gaps between messages are taken.
    """

    def __init__(self, window: int) -> None:
        self._gaps: deque[int] = deque(maxlen=window)
        self._newest: int | None = None
        self._told: int | None = None

    def add(self, now: int, tell: Callable[[str], Any]) -> None:
        """Count a message, and tell the rate if the last time is a second ago.

        Args:
            now: its time of arrival in nanoseconds; 0 if the clock does not run yet.
            tell: gets the text.
        """
        if now == 0 or (self._newest is not None and now < self._newest):
            if self._gaps:
                tell("time has reset, resetting counters")
            self._gaps.clear()
            self._newest = self._told = None
        if now == 0:
            return
        if self._newest is not None:
            self._gaps.append(now - self._newest)
        self._newest = now
        if self._told is None:
            self._told = now
        elif now >= self._told + PERIOD:
            self._told = now
            tell(self.text())

    def text(self) -> str:
        """Return the rate and how regular it is."""
        mean, least, greatest, deviation, number = _topics.statistics(self._gaps)
        return (
            f"average rate: {1e9 / mean if mean else 0:.3f}\n\tmin: {least * 1e-9:.3f}s max: {greatest * 1e-9:.3f}s"
            f" std dev: {deviation * 1e-9:.5f}s window: {number}"
        )
