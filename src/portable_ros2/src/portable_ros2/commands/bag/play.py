"""`ros2 bag play`."""

from __future__ import annotations

import argparse
import time
from typing import TYPE_CHECKING, Any

from portable_ros2.commands.bag import _bags
from portable_ros2.commands.topic import _topics
from portable_ros2.graph import NODE_NAME_PREFIX, POLL_PERIOD, GraphNode
from portable_ros2.verb import Verb

if TYPE_CHECKING:
    from portable_ros2.bags.bag import Bag

MATCH_TIME = 2.0  # s in which subscribers that are there may find the publishers
LONGEST_SLEEP = 3600.0  # s; a file may name times that are further apart than a system can sleep
LAST_SECOND = 2**31 - 1  # that a message can name
LAST_WAIT = 1.0  # s for the last messages to be acknowledged


class PlayVerb(Verb):
    """Play back ROS data from a bag."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        _bags.add_bag_argument(parser)
        parser.add_argument(
            "-r",
            "--rate",
            type=_topics.positive_float,
            default=1.0,
            help="Rate at which to play back messages. Valid range > 0.0.",
        )
        parser.add_argument(
            "--topics", metavar="topic", nargs="+", default=[], help="Space-delimited list of topics to play"
        )
        _bags.add_filter_arguments(parser, "Play")
        parser.add_argument(
            "-l",
            "--loop",
            action="store_true",
            help="Start back at the beginning on reaching the end, indefinitely",
        )
        parser.add_argument(
            "-m",
            "--remap",
            nargs="+",
            default=[],
            help='List of topics to be remapped: in the form "old_topic1:=new_topic1 old_topic2:=new_topic2 etc."',
        )
        parser.add_argument(
            "-d",
            "--delay",
            type=float,
            default=0.0,
            help="Sleep duration before play (each loop), in seconds",
        )
        parser.add_argument(
            "--start-offset",
            type=float,
            default=0.0,
            help="Start the playback player this many seconds into the bag file",
        )
        parser.add_argument(
            "--clock",
            type=_topics.positive_float,
            nargs="?",
            const=40.0,
            help="Publish to /clock at a specific frequency in Hz, to act as a ROS Time Source",
        )
        parser.add_argument(
            "--disable-keyboard-controls", action="store_true", help="There are none, and it does nothing"
        )

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        bag = _bags.opened(args.bag_path)
        remappings = dict(_remapping(text) for text in args.remap)
        names = args.topics or _bags.taken(bag.topics, args)
        missing = [name for name in names if name not in bag.topics]
        if missing:
            raise RuntimeError(f"The bag '{args.bag_path}' has no topic {missing[0]}")
        with GraphNode(argparse.Namespace(), name=f"{NODE_NAME_PREFIX}_rosbag2_player") as node:
            player = _Player(node, bag, names, remappings)
            while True:
                player.play(args)
                if not args.loop:
                    return


class _Player:
    """Publishes the messages of a bag.

    Args:
        node: publishes.
        bag: what is published.
        names: the topics of it.
        remappings: other names for them.
    """

    def __init__(self, node: GraphNode, bag: Bag, names: list[str], remappings: dict[str, str]) -> None:
        from rclpy.exceptions import NameValidationException

        from portable_ros2 import messages
        from portable_ros2.bags.offers import replayed_qos

        self.node, self.bag = node, bag
        self.publishers: dict[str, Any] = {}
        for name in names:
            topic = bag.topics[name]
            try:
                self.publishers[name] = node.create_publisher(
                    messages.find_message(topic.type_name),
                    remappings.get(name, name),
                    replayed_qos(topic.offered_qos),
                )
            except (RuntimeError, NameValidationException) as error:
                reason = str(error).partition("\n")[0]
                node.get_logger().warning(f"Ignoring a topic '{name}', reason: {reason}")

    def play(self, args: argparse.Namespace) -> None:
        """Publish the messages once, with their timing."""
        time.sleep(args.delay)
        self._wait_for_match()
        first = self.bag.began + round(args.start_offset * 1e9)
        clock = _Clock(self.node, args.clock) if args.clock else None
        began = time.monotonic()
        for message in self.bag.messages(list(self.publishers), first):
            due = (message.time - first) / 1e9 / args.rate
            while (left := began + due - time.monotonic()) > 0:
                if clock is not None:
                    clock.tell(first + round((time.monotonic() - began) * args.rate * 1e9))
                time.sleep(min(left, LONGEST_SLEEP if clock is None else clock.period))
            self.publishers[message.topic].publish(message.data)
        from rclpy.duration import Duration

        for publisher in self.publishers.values():
            publisher.wait_for_all_acked(Duration(seconds=LAST_WAIT))

    def _wait_for_match(self) -> None:
        """Wait until the subscribers that the graph shows have matched: what is published before is lost."""
        deadline = time.monotonic() + MATCH_TIME
        while time.monotonic() < deadline and any(
            publisher.get_subscription_count()
            < len(self.node.get_subscriptions_info_by_topic(publisher.topic_name))
            for publisher in self.publishers.values()
        ):
            time.sleep(POLL_PERIOD)


class _Clock:
    def __init__(self, node: GraphNode, frequency: float) -> None:
        from rosgraph_msgs.msg import Clock

        self.period = 1 / frequency
        self._message = Clock()
        self._publisher = node.create_publisher(Clock, "/clock", 1)

    def tell(self, nanoseconds: int) -> None:
        seconds, self._message.clock.nanosec = divmod(nanoseconds, 10**9)
        self._message.clock.sec = min(max(seconds, -LAST_SECOND - 1), LAST_SECOND)
        self._publisher.publish(self._message)


def _remapping(text: str) -> tuple[str, str]:
    source, separator, target = text.partition(":=")
    if not (source and separator and target):
        raise RuntimeError(f"The remapping '{text}' is not of the form old_topic:=new_topic")
    return source, target
