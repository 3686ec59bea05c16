"""Any topic, live: the newest message as a tree of its fields, and how regularly messages come."""

from __future__ import annotations

import threading
import time
from typing import Any

import traitlets
from matplotlib.figure import Figure
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message

from ros2lab.arrivals import Arrivals, Rhythm
from ros2lab.message_tree import message_tree
from ros2lab.session import LabSession
from ros2lab.topics import find_type, matching_qos, one_type_a_topic, silence, type_name
from ros2lab.widgets.redraw import redraw_of
from ros2lab.widgets.stored_view import PausingView, check_session, resolved, style_sheet, text_figure
from ros2lab.widgets.watched import Watched, script

RATE = 5.0  # Hz
GRAPH_RATE = 2.0  # Hz
LINES_IN_PICTURE = 40
PICTURE_WIDTH = 100  # letters


class TopicMonitor(PausingView, Watched):
    """Shows the newest message of a topic as a tree, with rate (Hz), jitter (ms), size (bytes) and age (s), live.

    Every message is counted, however fast they come; five times a second the newest is shown.
    It follows publishers of every quality of service. While nothing comes, it says what may be wrong.

    Args:
        session: where the topic is listened to; closing it closes the monitor.
        topic: the topic's name.
        message_type: the message class or its name, such as `std_msgs/msg/String`; None takes what is published
            there, now or later.

    Attributes:
        type_name: of the messages; empty until it is known.
        paused: whether the picture stands still; messages go on being counted.

    Raises:
        TypeError: if an argument is of another kind.
        ValueError: if the topic's name is none, the type cannot be imported, or a node of this kernel uses the
            topic with another type.
        RuntimeError: if the session is closed.
    """

    _esm = script("topic_monitor")
    _css = style_sheet("topic_monitor")

    topic = traitlets.Unicode("", read_only=True).tag(sync=True)
    type_name = traitlets.Unicode("", read_only=True).tag(sync=True)
    note = traitlets.Unicode("", read_only=True).tag(sync=True)

    def __init__(self, session: LabSession, topic: str, message_type: type | str | None = None) -> None:
        check_session(session, "TopicMonitor")
        topic = resolved(session, topic)
        self._type = None if message_type is None else message_class(message_type)
        self._redraw = redraw_of(session)
        self._arrivals = Arrivals()
        self._sending = threading.Lock()
        self._sent_count = 0
        self._looking = threading.Lock()
        self._subscription: Any = None
        self._qos: QoSProfile | None = None
        self._node = session.node
        self.set_trait("topic", topic)
        if self._type is not None:
            self._subscribe()
        super().__init__()
        self.on_msg(self._on_message)
        self._open_in(session, topic)
        self._look_around()
        self._redraw.add(self._send_new, RATE, while_=self.is_watched)
        # Unseen, too, it waits for the first publisher: it counts every message.
        self._redraw.add(
            self._look_around, GRAPH_RATE, while_=lambda: self._subscription is None or self.is_watched()
        )

    @property
    def latest(self) -> Any:
        """The newest message, None if none came."""
        _, newest = self._arrivals.newest()
        return None if newest is None else deserialize_message(newest, self._type)

    @property
    def rhythm(self) -> Rhythm:
        """How many messages came, and how regularly."""
        return self._arrivals.rhythm(time.monotonic())

    def still(self) -> Figure:
        """Draw the newest message, as far as it fits, with matplotlib."""
        message = self.latest
        lines = [self._headline()]
        if message is not None:
            tree = list(message_tree(message).lines())
            lines += ["", *tree[:LINES_IN_PICTURE]]
            lines += [f"… {len(tree) - LINES_IN_PICTURE} lines more"] if len(tree) > LINES_IN_PICTURE else []
        elif self.note:
            lines.append(self.note)
        cut = [line if len(line) <= PICTURE_WIDTH else f"{line[: PICTURE_WIDTH - 1]}…" for line in lines]
        return text_figure(f"Monitor {self.topic} {self.type_name}".rstrip(), cut)

    @property
    def description(self) -> str:
        """What is to be seen now, in words."""
        kind = f" ({self.type_name})" if self.type_name else ""
        return f"Monitor of {self.topic}{kind}: {self._headline()}."

    def _headline(self) -> str:
        rhythm = self.rhythm
        if not rhythm.count:
            return "no message yet"
        texts = [f"{rhythm.count} message{'' if rhythm.count == 1 else 's'}"]
        texts += [f"{rhythm.rate:.1f} Hz"] if rhythm.rate is not None else []
        texts += [f"jitter {1000 * rhythm.jitter:.1f} ms"] if rhythm.jitter is not None else []
        return ", ".join(texts)

    def _subscribe(self) -> None:
        """Listen as every publisher seen can serve.

        Raises:
            ValueError: if a node of this kernel uses the topic with another type.
        """
        assert self._type is not None
        qos = matching_qos(self._node, self.topic)
        if self._subscription is not None:
            self._node.destroy_subscription(self._subscription)
            self._subscription = None
        name = type_name(self._type)
        with one_type_a_topic(self._node, self.topic, name):
            # Raw: of a thousand messages a second only those that are shown are made into Python objects.
            self._subscription = self._node.create_subscription(
                self._type, self.topic, self._store, qos, raw=True
            )
        self._qos = qos
        self.set_trait("type_name", name)

    def _store(self, message: bytes, _: object) -> None:
        self._arrivals.add(time.monotonic(), message)

    def _look_around(self) -> None:
        """Find the type, follow the publishers' quality of service, and say why nothing comes."""
        with self._looking:
            if not self._is_open:
                return
            try:
                self._follow_publishers()
            except ValueError as error:
                self._say(str(error))
                return
            rhythm = self.rhythm
            is_silent = rhythm.age is None or rhythm.age > rhythm.patience
            self._say(" ".join(self._reasons()) if is_silent else "")

    def _follow_publishers(self) -> None:
        if self._type is None:
            infos = self._node.get_publishers_info_by_topic(self.topic)
            if not infos:
                return
            self._type = find_type(infos[0].topic_type)
        if self._subscription is None or not self._hears_all():
            self._subscribe()

    def _hears_all(self) -> bool:
        """Return whether a new subscription would hear no more than this one."""
        wanted, present = matching_qos(self._node, self.topic), self._qos
        assert present is not None
        is_reliable = present.reliability == ReliabilityPolicy.RELIABLE
        if is_reliable and wanted.reliability == ReliabilityPolicy.BEST_EFFORT:
            return False
        is_kept = present.durability == DurabilityPolicy.TRANSIENT_LOCAL
        wants_kept = wanted.durability == DurabilityPolicy.TRANSIENT_LOCAL
        # What was kept for late ones is asked for once: later it would be counted a second time.
        return is_kept == wants_kept or (wants_kept and self._arrivals.count > 0)

    def _reasons(self) -> list[str]:
        wanted = type_name(self._type) if self._type is not None else ""
        return silence(self._node, self.topic, wanted, self._qos or QoSProfile(depth=1))

    def _say(self, note: str) -> None:
        if note != self.note:
            self.set_trait("note", note)

    def _on_message(self, _: object, content: Any, __: object) -> None:
        if content == {"ask": "message"}:
            with self._sending:
                self._send_newest(is_whole=True)

    def _send_new(self) -> None:
        with self._sending:
            if not self.paused and self._arrivals.count != self._sent_count:
                self._send_newest()

    def _send_newest(self, *, is_whole: bool = False) -> None:
        count, newest = self._arrivals.newest()
        self._sent_count = count
        rhythm = self._arrivals.rhythm(time.monotonic())
        content: dict[str, Any] = {
            "is_whole": is_whole,
            "count": rhythm.count,
            "rate": rhythm.rate,
            "jitter": rhythm.jitter,
            "age": rhythm.age,
            "patience": rhythm.patience,
        }
        if newest is not None:
            message = deserialize_message(newest, self._type)
            content |= {"size": len(newest), "tree": message_tree(message).plain()}
        self.send(content)

    def _on_watched(self) -> None:
        for draw in (self._look_around, self._send_new):
            self._redraw.hurry(draw)

    def _stop(self) -> None:
        self._redraw.remove(self._send_new)
        self._redraw.remove(self._look_around)
        with self._looking:
            if self._subscription is not None:
                self._node.destroy_subscription(self._subscription)
                self._subscription = None

    def __repr__(self) -> str:
        return f"TopicMonitor({self.topic})"


def message_class(message_type: object) -> type:
    """Check a constructor's argument and return the message class that it is or names.

    Raises:
        TypeError: if it is neither a message class nor a text.
        ValueError: if there is no message class of that name.
    """
    if isinstance(message_type, str):
        message_type = find_type(message_type)
    if not (isinstance(message_type, type) and hasattr(message_type, "get_fields_and_field_types")):
        raise TypeError(
            f"The message type is a message class, or a name such as 'std_msgs/msg/String', not {message_type!r}."
        )
    return message_type
