"""`ros2 bag record`."""

from __future__ import annotations

import argparse
import datetime
import os
import time
from pathlib import Path
from typing import Any

from portable_ros2.commands.bag import _bags
from portable_ros2.commands.topic import _topics
from portable_ros2.graph import GraphNode
from portable_ros2.verb import Verb

POLLING_INTERVAL = 100  # ms
FLUSH_PERIOD = 1.0  # s: what a kill can cost


class RecordVerb(Verb):
    """Record ROS data to a bag."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        parser.add_argument(
            "-o",
            "--output",
            type=Path,
            help="Destination of the bagfile to create, defaults to a timestamped folder in the current directory",
        )
        _bags.add_storage_argument(parser)
        group = parser.add_mutually_exclusive_group()
        purpose = "Space-delimited list of topics to record"
        for topics in (
            group.add_argument("topics_positional", metavar="Topic", nargs="*", default=[], help=purpose),
            group.add_argument("--topics", metavar="Topic", nargs="+", default=[], help=purpose),
        ):
            topics.completer = _topics.complete_topic  # type: ignore[attr-defined]
        for name in ("-a", "--all"), ("--all-topics",):
            parser.add_argument(*name, action="store_true", help="Record all topics (Exclude hidden topic)")
        _bags.add_filter_arguments(parser, "Record")
        parser.add_argument(
            "--include-hidden-topics", action="store_true", help="Discover and record hidden topics as well"
        )
        parser.add_argument(
            "--no-discovery",
            action="store_true",
            help="Disables topic auto discovery during recording: only topics present at startup will be recorded",
        )
        parser.add_argument(
            "-p",
            "--polling-interval",
            type=_topics.positive_int,
            default=POLLING_INTERVAL,
            help="Time in ms to wait between querying available topics for recording",
        )
        parser.add_argument(
            "--node-name",
            default="rosbag2_recorder",
            help="Specify the recorder node name. Default is %(default)s.",
        )

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> str | None:
        _bags.check_library()
        named = args.topics or args.topics_positional
        if not (named or args.all or args.all_topics or args.regex):
            return "[ERROR] [ros2bag]: Need to specify at least one option out of --all, --all-topics, --topics or --regex"
        folder = args.output or Path(datetime.datetime.now().strftime("rosbag2_%Y_%m_%d-%H_%M_%S"))
        if folder.is_dir():
            return f"[ERROR] [ros2bag]: Output folder '{folder}' already exists."
        with GraphNode(argparse.Namespace(), name=args.node_name) as node:
            wanted = {_topics.full_name(node, name) for name in named}
            recorder = _Recorder(node, folder)
            try:
                recorder.record(args, None if args.all or args.all_topics else wanted)
            except KeyboardInterrupt:
                pass  # this is how a recording ends
            finally:
                recorder.finish()
        _say_stopped(args.node_name)
        return None


class _Recorder:
    """Subscribes to topics as they appear, and writes what comes.

    Args:
        node: subscribes.
        folder: where the bag is made.

    Raises:
        RuntimeError: if it cannot be made.
    """

    def __init__(self, node: GraphNode, folder: Path) -> None:
        from portable_ros2.bags.mcap_file import RecordingWriter

        self.node, self.folder = node, folder
        self.offers: dict[str, str] = {}
        self.hashes: dict[str, str] = {}
        self._left_out: set[str] = set()
        self._logger = node.get_logger()
        try:
            folder.mkdir(parents=True)
            self._stream = (folder / f"{folder.name}_0.mcap").open("wb")
        except OSError as error:
            raise RuntimeError(
                f"[ERROR] [ros2bag]: Could not create bag folder '{folder}': {error.strerror}"
            ) from error
        self._writer = RecordingWriter(self._stream)

    def record(self, args: argparse.Namespace, wanted: set[str] | None) -> None:
        """Record until somebody interrupts it.

        Args:
            args: what the options have become.
            wanted: the topics that are named; None takes all.
        """
        self._logger.info("Listening for topics...")
        self._look(args, wanted)
        self._logger.info("Recording...")

        def look_again() -> None:
            self._look(args, wanted)
            if wanted and not wanted - self.offers.keys():
                self._logger.info("All requested topics are subscribed. Stopping discovery...")
                timer.cancel()

        if not args.no_discovery:
            timer = self.node.create_timer(args.polling_interval / 1000, look_again)
        self.node.create_timer(FLUSH_PERIOD, self._writer.flush)
        _topics.spin(self.node)

    def finish(self) -> None:
        """Write what is left, and what the bag holds."""
        from portable_ros2.bags.bag import write_metadata
        from portable_ros2.bags.mcap_file import RecordingFile

        self._writer.finish()
        self._stream.close()
        file = RecordingFile(Path(self._stream.name))
        distro = os.environ.get("ROS_DISTRO", "jazzy")
        write_metadata(self.folder, file, self.offers, self.hashes, distro)

    def _look(self, args: argparse.Namespace, wanted: set[str] | None) -> None:
        """Subscribe to the topics that have appeared."""
        for name, types in _topics.names_and_types(self.node, args.include_hidden_topics or bool(wanted)):
            is_named = wanted is not None and name in wanted
            is_meant = wanted is None or is_named or bool(args.regex)
            if name in self.offers or name in self._left_out or not is_meant:
                continue
            offered = self.node.get_publishers_info_by_topic(name)
            if offered and (is_named or _bags.taken([name], args)):
                self._subscribe(name, types, offered)

    def _subscribe(self, name: str, types: list[str], offered: list[Any]) -> None:
        from portable_ros2 import messages, qos
        from portable_ros2.bags.definitions import definition_text
        from portable_ros2.bags.offers import qos_text

        try:
            if len(types) > 1:
                raise LookupError(f"it has more than one type: {', '.join(types)}")
            message_class = messages.find_message(types[0])
            definition = definition_text(types[0])
        except (LookupError, RuntimeError) as error:
            self._left_out.add(name)
            self._logger.warning(f"Topic '{name}' is not recorded: {error}")
            return
        profile = qos.preset("default")
        qos.fit(profile, offered)
        self.offers[name] = qos_text([publisher.qos_profile for publisher in offered])
        self.hashes[name] = str(offered[0].topic_type_hash)
        channel = self._writer.add_topic(
            name, types[0], definition, offered_qos=self.offers[name], type_hash=self.hashes[name]
        )

        def write(data: bytes, info: dict[str, int]) -> None:
            self._writer.add(
                channel, data, received=time.time_ns(), published=info["source_timestamp"] or time.time_ns()
            )

        self.node.create_subscription(message_class, name, write, qos.with_room(profile), raw=True)
        self._logger.info(f"Subscribed to topic '{name}'")


def _say_stopped(name: str) -> None:
    """Log it, without the node, which the interrupt has cut off from its topic for logs."""
    from rclpy.logging import get_logger

    get_logger(name).info("Recording stopped")
