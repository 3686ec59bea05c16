"""`ros2 bag info`."""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from typing import TYPE_CHECKING

from portable_ros2.commands.bag import _bags
from portable_ros2.verb import Verb

if TYPE_CHECKING:
    from portable_ros2.bags.bag import Bag
    from portable_ros2.bags.mcap_file import RecordedTopic

EVENTS = "/_service_event"  # what is said to and by a service stands on a topic of its own
INDENT = " " * 19


class InfoVerb(Verb):
    """Print information about a bag to the screen."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        _bags.add_bag_argument(parser)
        parser.add_argument("-t", "--topic-name", action="store_true", help="Only display topic names")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        bag = _bags.opened(args.bag_path)
        if args.topic_name:
            print(*(topic.name for topic in bag.topics.values() if not _is_events(topic)), sep="\n")
        else:
            print("\n" + "\n".join(_lines(bag)) + "\n")


def _lines(bag: Bag) -> Iterator[str]:
    topics = [topic for topic in bag.topics.values() if not _is_events(topic)]
    events = [topic for topic in bag.topics.values() if _is_events(topic)]
    yield f"Files:             {f'{chr(10)}{INDENT}'.join(bag.names)}"
    yield f"Bag size:          {_size(bag.size)}"
    yield "Storage id:        mcap"
    yield f"ROS Distro:        {bag.distro}"
    yield f"Duration:          {_seconds(bag.ended - bag.began)}s"
    yield f"Start:             {_date(bag.began)}"
    yield f"End:               {_date(bag.ended)}"
    yield f"Messages:          {sum(topic.count for topic in topics)}"
    rows = [
        f"Topic: {topic.name} | Type: {topic.type_name} | Count: {topic.count} | Serialization Format: cdr"
        for topic in topics
    ]
    yield f"Topic information: {f'{chr(10)}{INDENT}'.join(rows)}"
    yield f"Service:           {len(events)}"
    rows = [
        f"Service: {topic.name.removesuffix(EVENTS)} | Type: {topic.type_name.removesuffix('_Event')} | "
        f"Event Count: {topic.count} | Serialization Format: cdr"
        for topic in events
    ]
    yield f"Service information: {f'{chr(10)}{INDENT}  '.join(rows)}"


def _is_events(topic: RecordedTopic) -> bool:
    return topic.name.endswith(EVENTS) and "/srv/" in topic.type_name and topic.type_name.endswith("_Event")


def _size(count: float) -> str:
    units = ["B", "KiB", "MiB", "GiB", "TiB"]
    while count >= 1024 and len(units) > 1:
        count /= 1024
        del units[0]
    return f"{count:.{0 if units[0] == 'B' else 1}f} {units[0]}"


def _seconds(nanoseconds: int) -> str:
    return f"{nanoseconds // 10**9}.{nanoseconds % 10**9:09}"


def _date(nanoseconds: int) -> str:
    local = time.localtime(nanoseconds // 10**9)
    fraction = f"{nanoseconds % 10**9:09}"
    return f"{time.strftime('%b %e %Y %H:%M:%S', local)}.{fraction} ({_seconds(nanoseconds)})"
