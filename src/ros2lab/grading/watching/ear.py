"""What is received on one topic of a run, and messages as plain data."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message

from ros2lab.topics import find_type, matching_qos

if TYPE_CHECKING:
    from ros2lab.grading.watching.watch import Watch

KEPT = 200  # messages of a topic, in a part of a run
LARGEST = 64_000  # bytes of a message that is read
MESSAGE_BYTES, TOPIC_BYTES, TOPIC_COUNT = 1_000_000, 20_000_000, 20_000  # beyond these, a topic is cut
TEXT, ITEMS, DEPTH = 500, 50, 8
# By default, a subscription warns of incompatible publishers, which makes each wait longer.
UNHEARD = SubscriptionEventCallbacks(use_default_callbacks=False)


class Ear:
    """Receives the messages of a topic, up to a limit, and reads them only on request."""

    def __init__(self, watch: Watch, topic: str, type_name: str) -> None:
        self.topic, self.type_name = topic, type_name
        self.total = self.count = 0  # in the run, and in this part of it
        self.last = b""
        self.is_closed = False
        self._watch = watch
        self._bytes = 0
        self._type = find_type(type_name)
        self._times: list[float] = []
        self._kept: list[bytes] = []
        self._aside: tuple[int, list[float], list[bytes]] = (0, [], [])
        self._node = watch.holding(topic, type_name)
        offered = matching_qos(watch.node, topic)
        qos = QoSProfile(depth=100, reliability=offered.reliability, durability=offered.durability)
        self._subscription = self._node.create_subscription(
            self._type, topic, self._take, qos, raw=True, event_callbacks=UNHEARD
        )

    def _take(self, raw: bytes, info: dict[str, int]) -> None:
        self.total += 1
        self.count += 1
        self._bytes += len(raw)
        self.last = raw
        if len(self._kept) < KEPT:
            self._times.append(self._watch.time_of(info["received_timestamp"]))
            self._kept.append(raw if len(raw) <= LARGEST else b"")
        if self.total > TOPIC_COUNT or self._bytes > TOPIC_BYTES or len(raw) > MESSAGE_BYTES:
            self._watch.excessive.add(self)

    def plain(self, raw: bytes) -> Any:
        """Return a message as plain data; of one that is too long or cannot be read, no field is known."""
        if not raw or len(raw) > LARGEST:
            return {}
        try:
            return plain(deserialize_message(raw, self._type))
        except Exception:  # bytes that a submission has chosen
            return {}

    def gaps(self) -> list[float]:
        """Return the times between the messages of this part, the first from 0, in s."""
        return gaps(self._times)

    def is_overdue(self) -> bool:
        """Return whether twice the longest gap has passed since the last message; this part needs two."""
        return self._watch.now() - self._times[-1] > 2 * max(self.gaps()[1:])

    def part(self) -> dict[str, Any]:
        """Return what was received since the last call, as the fields of `Heard`, and begin a new part."""
        seen = self._watch.publishes.get(self.topic, {})
        nodes = sorted(node for node, types in seen.items() if self.type_name in types)
        result = {
            "type_name": self.type_name,
            "node": ", ".join(nodes),
            "times": self._times,
            "values": [self.plain(raw) for raw in self._kept],
            "count": self.count,
        }
        self._times, self._kept, self.count = [], [], 0
        return result

    def forget(self, count: int) -> None:
        """Forget all but the first `count` messages of this part."""
        self.count = count
        del self._times[count:], self._kept[count:]

    def set_aside(self) -> None:
        """Set aside all but the last message of this part."""
        self._aside = max(0, self.count - 1), self._times[:-1], self._kept[:-1]
        self.count = min(self.count, 1)
        del self._times[:-1], self._kept[:-1]

    def take_back(self) -> None:
        """Put the messages that were set aside back into this part."""
        count, times, kept = self._aside
        self.count += count
        self._times[:0], self._kept[:0] = times, kept

    def close(self) -> None:
        """Unsubscribe."""
        self.is_closed = True
        self._node.destroy_subscription(self._subscription)


def plain(value: Any, depth: int = DEPTH) -> Any:
    """Return a ROS message, or a field of one, as JSON data, shortened."""
    result = value
    if isinstance(value, float) and not math.isfinite(value):
        result = str(value)
    elif isinstance(value, str):
        result = value[:TEXT]
    elif isinstance(value, bytes) or depth == 0:
        result = None
    elif hasattr(value, "get_fields_and_field_types"):
        result = {name: plain(getattr(value, name), depth - 1) for name in value.get_fields_and_field_types()}
    elif hasattr(value, "tolist"):
        result = value.tolist()[:ITEMS]
    elif isinstance(value, Iterable):
        result = [plain(item, depth - 1) for item in itertools.islice(value, ITEMS)]
    return result


def gaps(times: list[float]) -> list[float]:
    """Return the times between messages, the first from 0, in s."""
    return [later - earlier for earlier, later in itertools.pairwise([0.0, *times])]
