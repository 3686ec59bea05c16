"""A topic while it is recorded."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from rclpy.qos import QoSCompatibility, QoSProfile, qos_check_compatible

from portable_ros2.bags.definitions import definition_text
from portable_ros2.bags.offers import qos_text
from ros2lab.topics import QUEUE_DEPTH, find_type


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
