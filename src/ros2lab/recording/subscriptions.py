"""Topics while they are recorded, the subscriptions to them, and waiting until both ends have found each other."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from rclpy.callback_groups import CallbackGroup
from rclpy.qos import QoSCompatibility, QoSProfile, qos_check_compatible

from portable_ros2.bags.definitions import definition_text
from portable_ros2.bags.offers import qos_text
from ros2lab.topics import QUEUE_DEPTH, find_type, matching_qos, one_type_a_topic

if TYPE_CHECKING:
    from rclpy.node import Node


class Subscriptions:
    """Subscribes to published topics and takes their messages.

    Args:
        node: the node that subscribes.
        topics: the topics to record; None takes all but hidden ones.

    Attributes:
        tracks: the topics that are recorded, by name.
        left_out: why a topic is not recorded, by name.
    """

    def __init__(self, node: Node, topics: Collection[str] | None) -> None:
        self.tracks: dict[str, Track] = {}
        self.left_out: dict[str, str] = {}
        self._node = node
        self._wanted = None if topics is None else {node.resolve_topic_name(topic) for topic in topics}
        self._group = _NotSpun()

    def look(self) -> None:
        """Subscribe to new topics, and anew where a publisher offers less QoS than was requested."""
        for topic, _ in self._node.get_topic_names_and_types():
            if topic in self.left_out or not self._is_wanted(topic):
                continue
            offers = self._node.get_publishers_info_by_topic(topic)
            if not offers:
                continue
            try:
                self._subscribe(topic, offers)
            except (LookupError, ValueError) as error:
                self.left_out[topic] = f"{topic} is not recorded: {error}"

    def wait_for_match(self) -> None:
        """Wait until the publishers in the graph have matched: messages from before that are lost."""

        def has_matched() -> bool:
            return all(
                track.subscription.get_publisher_count() >= len(track.publishers)
                for track in list(self.tracks.values())
            )

        wait_for_match(has_matched)

    def messages(self) -> Iterator[tuple[Track, bytes, dict[str, Any]]]:
        """Take the messages that have come, at most as many per topic as ROS queues."""
        for track in self.tracks.values():
            for data, info in track.waiting():
                track.note(info["publication_sequence_number"] or 0)
                yield track, data, info

    def close(self) -> None:
        """Unsubscribe from all topics."""
        for track in self.tracks.values():
            if track.subscription is not None:
                self._node.destroy_subscription(track.subscription)
                track.subscription = None

    def _subscribe(self, topic: str, offers: Sequence[Any]) -> None:
        track = self.tracks.get(topic) or Track(topic, offers)
        track.met({bytes(offer.endpoint_gid) for offer in offers})
        if track.subscription is not None:
            if all(track.is_served_by(offer.qos_profile) for offer in offers):
                return
            self._node.destroy_subscription(track.subscription)
        track.qos = matching_qos(self._node, topic)
        with one_type_a_topic(self._node, topic, track.type_name):
            track.subscription = self._node.create_subscription(
                track.message_type, topic, _not_called, track.qos, callback_group=self._group, raw=True
            )
        self.tracks[topic] = track

    def _is_wanted(self, topic: str) -> bool:
        if self._wanted is not None:
            return topic in self._wanted
        return not any(part.startswith("_") for part in topic.split("/"))


class _NotSpun(CallbackGroup):
    """Subscriptions that the executor leaves alone: a recorder takes their messages itself.

    So no node's slow callback holds them up, and a message costs a sixth of what it costs through the
    executor.
    """

    def can_execute(self, _: object) -> bool:
        return False

    def beginning_execution(self, _: object) -> bool:
        return False

    def ending_execution(self, _: object) -> None:
        pass


def _not_called(_: bytes) -> None:
    pass


class Track:
    """A topic that is recorded.

    Raises:
        ValueError: if its type is not installed here.
        LookupError: if the definition of its type is not installed.
    """

    def __init__(self, topic: str, offers: Sequence[Any]) -> None:
        self.topic = topic
        self.type_name = offers[0].topic_type
        self.type_hash = str(offers[0].topic_type_hash)
        self.offered_qos = qos_text([offer.qos_profile for offer in offers])
        self.message_type = find_type(self.type_name)
        self.definition = definition_text(self.type_name)
        self.channel = 0
        self.qos = QoSProfile(depth=QUEUE_DEPTH)
        self.publishers: set[bytes] = set()
        self.subscription: Any = None
        self.count = 0
        self.missed = 0
        self._last = 0
        self._gaps = 0

    def is_served_by(self, offer: QoSProfile) -> bool:
        """Return whether a publisher with this QoS reaches the subscription."""
        verdict, _ = qos_check_compatible(offer, self.qos)
        return bool(verdict != QoSCompatibility.ERROR)

    def waiting(self) -> Iterator[tuple[bytes, dict[str, Any]]]:
        """Take the messages that have come, at most as many as ROS queues."""
        handle = self.subscription.handle
        with handle:  # it is not destroyed meanwhile
            for _ in range(QUEUE_DEPTH):
                taken = handle.take_message(self.message_type, True)
                if taken is None:
                    return
                yield taken

    def note(self, sequence: int) -> None:
        """Note a message's sequence number, and count those that are missing before it."""
        if self._last:
            self._gaps += max(0, sequence - self._last - 1)
        self._last = sequence

    def met(self, publishers: set[bytes]) -> None:
        """Note the current publishers. Only the numbers of one unchanged publisher show what is missing."""
        if publishers == self.publishers and len(publishers) == 1:
            self.missed += self._gaps
        else:
            self._last = 0
        self._gaps = 0
        self.publishers = publishers


MATCH_TIMEOUT = 1.0  # s
POLL_PERIOD = 0.005  # s; rclpy sends no event for every match


def wait_for_match(has_matched: Callable[[], bool]) -> None:
    """Wait until publishers and subscribers have matched, but no longer than `MATCH_TIMEOUT`."""
    deadline = time.monotonic() + MATCH_TIMEOUT
    while not has_matched() and time.monotonic() < deadline:
        time.sleep(POLL_PERIOD)
