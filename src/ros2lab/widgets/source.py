"""Where a view's messages come from: a session, in which they go on coming, or a recording, which has them all.

A view asks both for the same: a topic's log, a redraw, the time, a publisher. So it does not ask which it has.
"""

from __future__ import annotations

import functools
import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

from rclpy.qos import QoSProfile, ReliabilityPolicy

from ros2lab import course
from ros2lab.recording import Recording
from ros2lab.session import LabSession
from ros2lab.topics import QUEUE_DEPTH, Sample, TopicLog, type_name
from ros2lab.widgets.redraw import redraw_of
from ros2lab.widgets.stored_view import Home, checked_name, resolved

SHORTEST_SPAN = 0.1  # s


class Log(Protocol):
    """What a view reads of a topic's messages: `TopicLog` has it."""

    topic: str

    @property
    def count(self) -> int:
        """How many came."""

    @property
    def latest(self) -> Sample | None:
        """The newest sample, None if nothing came."""

    def samples(self, since: float | None = None) -> list[Sample]:
        """Return the samples, oldest first; only those later than a time, if one is given."""

    def close(self) -> None:
        """Stop listening."""


class Outlet(Protocol):
    """Where a view publishes."""

    @property
    def is_wanted(self) -> bool:
        """Whether anybody listens."""

    def publish(self, message: Any) -> None:
        """Publish a message, with the time in its header."""

    def close(self) -> None:
        """Give it back."""


class Drawer(Protocol):
    """What calls a view's draw functions: `Redraw` has it."""

    def add(self, draw: Callable[[], None], rate: float, *, while_: Callable[[], bool] = ...) -> None:
        """Call `draw` so many times a second from now on, except at turns at which `while_` is false."""

    def hurry(self, draw: Callable[[], None], wait: float = 0.0) -> None:
        """Call `draw` before its turn, after `wait` s."""

    def remove(self, draw: Callable[[], None]) -> None:
        """Stop calling it."""


class Source(Protocol):
    """Where a view's messages come from.

    Attributes:
        home: what the view belongs to.
        redraw: draws what is new.
        began: the time from which on messages count, in s.
        span: how long a recording is, in s; None of a session, which has no end yet.
        name: of a recording's file; empty for a session.
    """

    home: Home
    redraw: Drawer
    began: float
    span: float | None
    name: str

    def now(self) -> float:
        """Return the time, in s."""

    def topic(self, topic: object) -> str:
        """Return a topic's full name.

        Raises:
            TypeError: if it is not a text.
            ValueError: if ROS does not allow it as the name of a topic.
        """

    def log(self, topic: str, message_type: type, *, on_message: Callable[[Any], None] | None = None) -> Log:
        """Return what comes, or came, on a topic; `on_message` is called with each one that comes.

        Raises:
            ValueError: if a recording holds no such messages.
        """

    def outlet(self, message_type: type, topic: str, depth: int) -> Outlet:
        """Return where messages can be published."""


def source_of(given: object, widget: str) -> Source:
    """Check a constructor's first argument, and return what the view reads.

    Raises:
        TypeError: if it is neither a session nor a recording.
        RuntimeError: if the session is closed.
    """
    if isinstance(given, LabSession):
        return _SessionSource(given)
    if isinstance(given, Recording):
        return _RecordingSource(given, widget)
    raise TypeError(
        f"{widget} takes a LabSession as its first argument, or what read_recording() returns, not {given!r}."
    )


class _SessionSource:
    """Messages that come now; times are those of `time.monotonic()`."""

    span: float | None = None
    name = ""

    def __init__(self, session: LabSession) -> None:
        self._session = session
        self.home: Home = session
        self.redraw: Drawer = redraw_of(session)
        self.began = time.monotonic()

    def now(self) -> float:
        return time.monotonic()

    def topic(self, topic: object) -> str:
        return resolved(self._session, topic)

    def log(self, topic: str, message_type: type, *, on_message: Callable[[Any], None] | None = None) -> Log:
        # Best effort hears publishers of every quality of service; its own log, so that the notebook's
        # log of the same topic does not replace it.
        qos = QoSProfile(depth=QUEUE_DEPTH, reliability=ReliabilityPolicy.BEST_EFFORT)
        return TopicLog(self._session.node, topic, message_type, qos=qos, on_message=on_message)

    def outlet(self, message_type: type, topic: str, depth: int) -> Outlet:
        return _SessionOutlet(self._session, message_type, topic, depth)


class _SessionOutlet:
    def __init__(self, session: LabSession, message_type: type, topic: str, depth: int) -> None:
        self._node = session.node
        self._publisher = self._node.create_publisher(message_type, topic, depth)

    @property
    def is_wanted(self) -> bool:
        return bool(self._publisher.get_subscription_count())

    def publish(self, message: Any) -> None:
        message.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(message)

    def close(self) -> None:
        self._node.destroy_publisher(self._publisher)


class _RecordingSource:
    """Messages that came; times are those since the recording's begin, and now is its end."""

    began = math.nextafter(0.0, -1.0)  # s; just before the first message

    def __init__(self, recording: Recording, widget: str) -> None:
        self._recording, self._widget = recording, widget
        self.home: Home = _home(recording.path)
        self.redraw: Drawer = _NothingNew()
        self.name = course.shown_path(recording.path)
        self._end = max(recording.duration, SHORTEST_SPAN)
        self.span: float | None = self._end

    def now(self) -> float:
        return self._end

    def topic(self, topic: object) -> str:
        return f"/{checked_name(topic).lstrip('/')}"

    def log(self, topic: str, message_type: type, **_: object) -> Log:
        if topic not in self._recording.topics:
            raise ValueError(self._recording.no_topic(topic))
        recorded, shown = self._recording.topics[topic], type_name(message_type)
        if recorded.type_name != shown:
            raise ValueError(
                f"{topic} of {self.name} is of the type {recorded.type_name}; {self._widget} shows {shown}."
            )
        if not recorded.count:
            raise ValueError(f"{self.name} holds no message of {topic}: nothing was published there.")
        samples = self._recording[topic]
        return _RecordedLog(topic, [Sample(time, message, time) for time, message in samples])

    def outlet(self, *_: object) -> Outlet:
        return _NobodysOutlet()


class _RecordedLog:
    def __init__(self, topic: str, samples: list[Sample]) -> None:
        self.topic = topic
        self._samples = samples

    @property
    def count(self) -> int:
        return len(self._samples)

    @property
    def latest(self) -> Sample | None:
        return self._samples[-1]

    def samples(self, since: float | None = None) -> list[Sample]:
        return [sample for sample in self._samples if since is None or sample.time > since]

    def close(self) -> None:
        pass


class _NobodysOutlet:
    is_wanted = False

    def publish(self, message: Any) -> None:
        pass

    def close(self) -> None:
        pass


class _NothingNew:
    """Instead of a redraw: a recording does not change."""

    def add(self, *_: object, **__: object) -> None:
        pass

    def hurry(self, *_: object) -> None:
        pass

    def remove(self, draw: Callable[[], None]) -> None:
        pass


class _RecordingHome:
    """A recording's file, which has no end with which a view would close."""

    def on_close(self, callback: Callable[[], None]) -> None:
        pass


@functools.cache
def _home(_: Path) -> _RecordingHome:
    """Return one home for each file, so that the second view of it closes the first."""
    return _RecordingHome()
