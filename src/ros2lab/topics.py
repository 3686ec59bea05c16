"""What was published on a topic, and when.

A `TopicLog` keeps the newest messages with the times at which they came.
The ROS thread only stores; whoever wants to look reads a copy, or waits for what is to come.
"""

from __future__ import annotations

import contextlib
import difflib
import html
import itertools
import statistics
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from rclpy._rclpy_pybind11 import RCLError
from rclpy.qos import (
    DurabilityPolicy,
    QoSCompatibility,
    QoSProfile,
    ReliabilityPolicy,
    qos_check_compatible,
)

from portable_ros2 import interfaces
from ros2lab import every_node
from ros2lab.interrupts import interrupted_says

if TYPE_CHECKING:
    from rclpy.node import Node

# Long enough that a kernel that gets no processor for some seconds loses nothing at 1 kHz.
QUEUE_DEPTH = 5000

DEFAULT_TIMEOUT = 10.0  # s, so that a slow machine is not taken for a silent node


class Sample(NamedTuple):
    """A message, when it came and when it was published.

    Attributes:
        time: when it came, in s of `time.monotonic()`.
        message: the message.
        published: when it was published, in s of the publisher's `time.time()`: regular also where the
            listener had to wait for the processor.
    """

    time: float
    message: Any
    published: float


@dataclass(frozen=True)
class Statistics:
    """How regularly messages came, over those that the log still holds.

    Attributes:
        count: messages received since the log began, also those no longer held.
        rate: mean rate in Hz, None for fewer than two messages.
        mean_gap: mean time between two messages in s, None for fewer than two messages.
        largest_gap: longest time between two messages in s, None for fewer than two messages.
        gap_std: standard deviation of the gaps in s, None for fewer than three messages.
        last: the newest message, None if there is none.
    """

    count: int
    rate: float | None
    mean_gap: float | None
    largest_gap: float | None
    gap_std: float | None
    last: Any

    @classmethod
    def of(cls, samples: list[Sample], count: int) -> Statistics:
        """Compute the statistics of `samples` (oldest first); `count` is how many came in all."""
        times = [sample.time for sample in samples]
        gaps = [later - earlier for earlier, later in itertools.pairwise(times)]
        mean = statistics.fmean(gaps) if gaps else None
        return cls(
            count=count,
            rate=1.0 / mean if mean else None,
            mean_gap=mean,
            largest_gap=max(gaps, default=None),
            gap_std=statistics.stdev(gaps) if len(gaps) > 1 else None,
            last=samples[-1].message if samples else None,
        )


class TopicLog:
    """The newest messages of one topic, with their receive times.

    Usually made by `LabSession.log`.

    Args:
        node: the node that subscribes; something else must spin it.
        topic: the topic's name.
        message_type: the message class.
        capacity: how many messages are held; older ones are dropped, but still counted.
        qos: the quality of service; None takes what every publisher seen now can serve.
        notes: returns further sentences for the explanation when a wait times out.
        on_message: is called with each message once it is stored, in the ROS thread, and so must be quick.

    Raises:
        ValueError: if `capacity` is less than 1, or a node of this process uses the topic with another type.
    """

    def __init__(
        self,
        node: Node,
        topic: str,
        message_type: type,
        *,
        capacity: int = 10_000,
        qos: QoSProfile | None = None,
        notes: Callable[[], list[str]] = list,
        on_message: Callable[[Any], None] | None = None,
    ) -> None:
        if capacity < 1:
            raise ValueError(f"The capacity of the log of {topic} must be at least 1, not {capacity}.")
        self.topic = node.resolve_topic_name(topic)
        self.type_name = type_name(message_type)
        self.capacity = capacity
        self._node = node
        self._notes = notes
        self._on_message = on_message
        self._qos = qos or matching_qos(node, self.topic)
        self._samples: deque[Sample] = deque(maxlen=capacity)
        self._count = 0
        self._changed = threading.Condition()
        self._is_closed = False
        with one_type_a_topic(node, self.topic, self.type_name):
            self._subscription = node.create_subscription(message_type, self.topic, self._store, self._qos)

    @property
    def count(self) -> int:
        """Messages received since the log began or was cleared."""
        return self._count

    @property
    def latest(self) -> Sample | None:
        """The newest sample, None if nothing came yet."""
        with self._changed:
            return self._samples[-1] if self._samples else None

    def samples(self, since: float | None = None) -> list[Sample]:
        """Return the samples held, oldest first.

        Args:
            since: only those that came later than this time, in s of `time.monotonic()`.
        """
        with self._changed:
            if since is None:
                return list(self._samples)
            newer: list[Sample] = []
            for sample in reversed(self._samples):
                if sample.time <= since:
                    break
                newer.append(sample)
        return newer[::-1]

    def statistics(self) -> Statistics:
        """Return rate and gaps of the samples held."""
        with self._changed:
            return Statistics.of(list(self._samples), self._count)

    def wait_for(self, n: int = 1, timeout: float = DEFAULT_TIMEOUT) -> list[Sample]:
        """Wait until `n` messages have come since the log began, and return the samples held.

        Args:
            n: how many messages in all, those that came before the call included.
            timeout: the longest wait in s.

        Raises:
            TimeoutError: if they did not come; its text says what came instead, and what may be wrong.
        """
        with self._interruptible(), self._changed:
            if (
                self._changed.wait_for(lambda: self._count >= n or self._is_closed, timeout)
                and self._count >= n
            ):
                return list(self._samples)
        raise TimeoutError(self._explain(f"{_messages(n)} within {timeout:g} s"))

    def wait_until(self, predicate: Callable[[Any], bool], timeout: float = DEFAULT_TIMEOUT) -> Sample:
        """Return the first sample, held or yet to come, whose message satisfies `predicate`.

        Args:
            predicate: takes a message and tells whether it is the one.
            timeout: the longest wait in s.

        Raises:
            TimeoutError: if none came; its text says what came instead, and what may be wrong.
        """
        deadline = time.monotonic() + timeout
        with self._interruptible():
            new, seen = self._after(0, deadline)
            while new:
                for sample in new:
                    if predicate(sample.message):
                        return sample
                new, seen = self._after(seen, deadline)
        raise TimeoutError(self._explain(f"a message as asked for within {timeout:g} s"))

    def clear(self) -> None:
        """Forget all messages and begin to count at zero."""
        with self._changed:
            self._samples.clear()
            self._count = 0

    def close(self) -> None:
        """Stop listening; what was received stays. Closing twice does no harm."""
        with self._changed:
            if self._is_closed:
                return
            self._is_closed = True
            self._changed.notify_all()
        self._node.destroy_subscription(self._subscription)

    def _interruptible(self) -> contextlib.AbstractContextManager[None]:
        return interrupted_says(f"the log of {self.topic} goes on.")

    def _after(self, seen: int, deadline: float) -> tuple[list[Sample], int]:
        """Wait for samples beyond the first `seen`; return those held (none at the deadline) and the count."""
        with self._changed:
            remaining = max(0.0, deadline - time.monotonic())
            self._changed.wait_for(lambda: self._count > seen or self._is_closed, remaining)
            new = self._count - seen
            return (list(self._samples)[-new:] if new > 0 else []), self._count

    def _store(self, message: Any, info: dict[str, int]) -> None:
        now = time.monotonic()
        with self._changed:
            self._samples.append(Sample(now, message, info["source_timestamp"] / 1e9))
            self._count += 1
            self._changed.notify_all()
        if self._on_message is not None:
            self._on_message(message)

    def _explain(self, wanted: str) -> str:
        came = f"{_messages(self._count)} came" if self._count else "nothing came"
        if self._is_closed:
            return f"{self.topic}: {wanted} expected, but this log is closed; make a new one."
        reasons = [*silence(self._node, self.topic, self.type_name, self._qos), *self._notes()]
        return " ".join([f"{self.topic}: {wanted} expected, {came}.", *reasons])

    def _rows(self) -> list[tuple[str, str]]:
        now = self.statistics()
        return [
            ("topic", self.topic),
            ("type", self.type_name),
            ("messages", str(now.count)),
            ("rate", _quantity(now.rate, "Hz")),
            ("mean gap", _quantity(now.mean_gap, "s")),
            ("largest gap", _quantity(now.largest_gap, "s")),
            ("standard deviation of the gaps", _quantity(now.gap_std, "s")),
            ("last message", _brief(now.last)),
        ]

    def __repr__(self) -> str:
        return f"TopicLog({self.topic!r}, {self.type_name}, {_messages(self._count)})"

    def __str__(self) -> str:
        rows = self._rows()
        width = max(len(name) for name, _ in rows)
        return "\n".join(f"{name:<{width}}  {value}" for name, value in rows)

    def _repr_html_(self) -> str:
        cells = (
            f'<tr><th scope="row" style="text-align:left">{name}</th>'
            f'<td style="text-align:left">{html.escape(value)}</td></tr>'
            for name, value in self._rows()
        )
        return f"<table>{''.join(cells)}</table>"


def type_name(message_type: type) -> str:
    """Return a message class's name as ROS writes it, such as `std_msgs/msg/String`."""
    package, kind, *_ = message_type.__module__.split(".")
    return f"{package}/{kind}/{message_type.__name__}"


def find_type(name: str) -> type:
    """Return the message class of a name such as `std_msgs/msg/String`.

    Raises:
        ValueError: if the name is not of that form, or the class cannot be imported.
    """
    package, _, rest = name.partition("/")
    kind, _, message = rest.rpartition("/")
    try:
        found: type = getattr(interfaces.module(package, kind or "msg"), message)
    except (ImportError, AttributeError, TypeError, ValueError) as error:
        raise ValueError(
            f"The message type {name!r} cannot be imported ({error}); is its package installed and sourced?"
        ) from error
    return found


@contextlib.contextmanager
def one_type_a_topic(node: Node, topic: str, wanted_type: str) -> Iterator[None]:
    """Turn what DDS says of two types on one topic of one process into a sentence.

    Raises:
        ValueError: instead of "invalid allocator", naming both types.
    """
    try:
        yield
    except RCLError as error:
        types = dict(node.get_topic_names_and_types()).get(topic, [])
        others = ", ".join(name for name in types if name != wanted_type)
        if not others:
            raise
        raise ValueError(
            f"{topic} carries {others} in this kernel, so it cannot carry {wanted_type} too: use that type, "
            "or stop the node that uses it."
        ) from error


def matching_qos(node: Node, topic: str) -> QoSProfile:
    """Return the quality of service that every publisher seen on `topic` can serve.

    Reliable unless one of them is best effort; transient-local (late listeners get what was said before)
    if there is a publisher and all of them are.
    """
    offers = [info.qos_profile for info in node.get_publishers_info_by_topic(topic)]
    is_lossy = any(offer.reliability == ReliabilityPolicy.BEST_EFFORT for offer in offers)
    is_kept = bool(offers) and all(offer.durability == DurabilityPolicy.TRANSIENT_LOCAL for offer in offers)
    return QoSProfile(
        depth=QUEUE_DEPTH,
        reliability=ReliabilityPolicy.BEST_EFFORT if is_lossy else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if is_kept else DurabilityPolicy.VOLATILE,
    )


def silence(node: Node, topic: str, wanted_type: str, qos: QoSProfile) -> list[str]:
    """Explain, from the graph as `node` sees it, why a subscription may hear nothing.

    Returns:
        Sentences, the likeliest cause first; empty if the graph shows nothing wrong.
    """
    publishers = node.get_publishers_info_by_topic(topic)
    if not publishers:
        return [f"No node publishes on {topic}.", *near_misses(node, topic)]
    reasons = []
    for info in publishers:
        if info.topic_type != wanted_type:
            reasons.append(f"{info.node_name} publishes {info.topic_type} there, not {wanted_type}.")
            continue
        verdict, why = qos_check_compatible(info.qos_profile, qos)
        if verdict == QoSCompatibility.ERROR:
            reasons.append(f"The quality of service of {info.node_name} does not fit: {why.rstrip('; ')}.")
    if not reasons:
        names = ", ".join(sorted({info.node_name for info in publishers}))
        reasons.append(f"{names} could be heard; perhaps it publishes less often.")
    return reasons


def near_misses(node: Node, topic: str) -> list[str]:
    """Name the published topics whose names are close to `topic`, or all of them if none is close."""
    published = {name for name, _ in node.get_topic_names_and_types() if node.count_publishers(name)}
    published -= {topic, *every_node.TOPICS}
    close = difflib.get_close_matches(topic, sorted(published), n=3, cutoff=0.75)
    close += sorted(name for name in published - set(close) if name.endswith(topic))
    if close:
        return [f"Did you mean {' or '.join(close)}?"]
    if published:
        return [f"Published are: {', '.join(sorted(published))}."]
    return ["No other topic is published in this domain either; is the node running?"]


def _messages(n: int) -> str:
    return "1 message" if n == 1 else f"{n} messages"


def _quantity(value: float | None, unit: str) -> str:
    return "-" if value is None else f"{value:.3f} {unit}"


def _brief(message: Any, length: int = 100) -> str:
    if message is None:
        return "-"
    text = str(getattr(message, "data", message))
    return text if len(text) <= length else f"{text[: length - 1]}…"
