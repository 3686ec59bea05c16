"""Recordings, published again on their topics."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rclpy.duration import Duration
from rclpy.exceptions import NameValidationException

from portable_ros2.bags.mcap_file import RecordedTopic
from portable_ros2.bags.offers import replayed_qos
from ros2lab import every_node
from ros2lab.interrupts import interrupted_says
from ros2lab.recording.files import no_topic, open_recording
from ros2lab.recording.read import installed_type
from ros2lab.recording.subscriptions import MATCH_TIMEOUT, wait_for_match
from ros2lab.topics import one_type_a_topic

if TYPE_CHECKING:
    from rclpy.node import Node

REPLAY_THREAD = "ros2lab-replay"
STOP_TIMEOUT = 10.0  # s
SLOWEST, FASTEST = 0.1, 100.0


class Replay:
    """Publishes the messages of a recording again, on their topics, with their timing.

    Made by `LabSession.replay`. Times are in s from the beginning of the recording. Its publishers end with it:
    a robot that is still driving then keeps its last velocity, so end a drive with a message that stops it.

    Args:
        node: the node that publishes.
        path: the file.
        rate: how many times faster than recorded, from 0.1 to 100.
        topics: the topics to replay; None takes all but `/rosout` and `/parameter_events`, where every node
            publishes.
        loop: whether it starts again at the end.

    Raises:
        FileNotFoundError: if there is no such file; the text names those that are there.
        ValueError: if the file is not a recording of ROS 2, has none of the topics, none of their types is
            installed here, or the rate is not from 0.1 to 100.
    """

    def __init__(
        self,
        node: Node,
        path: Path,
        *,
        rate: float = 1.0,
        topics: Collection[str] | None = None,
        loop: bool = False,
    ) -> None:
        self.path = path
        self.loop = loop
        self._node = node
        self._rate = _checked_rate(rate)
        self._file = open_recording(path)
        self.notes: list[str] = []
        self._publishers = self._new_publishers(topics)
        self._changed = threading.Condition()
        self._position = 0.0  # s from the beginning of the recording, at the moment `_since`
        self._since: float | None = None  # s of time.monotonic(); None while the clock stands
        self._is_paused = False
        self._is_stopped = False
        self._is_over = False
        self._failure = ""
        self._jumps = 0
        self._count = 0
        sys.stdout.write("".join(f"{note}\n" for note in self.notes))
        self._thread = threading.Thread(target=self._run, name=REPLAY_THREAD, daemon=True)
        self._thread.start()

    @property
    def duration(self) -> float:
        """The length of the recording in s."""
        return self._file.duration

    @property
    def position(self) -> float:
        """The current position, in s from the beginning of the recording."""
        with self._changed:
            return min(self._now(), self.duration)

    @property
    def count(self) -> int:
        """The number of messages published."""
        return self._count

    @property
    def is_playing(self) -> bool:
        """Whether it is neither paused nor has it ended."""
        return not self.has_ended and not self._is_paused

    @property
    def has_ended(self) -> bool:
        """Whether it has reached its end or was stopped."""
        return self._is_stopped or self._is_over

    @property
    def topics(self) -> list[str]:
        """The topics on which it publishes."""
        return sorted(self._publishers)

    @property
    def rate(self) -> float:
        """How many times faster than recorded; it can be set while it plays."""
        return self._rate

    @rate.setter
    def rate(self, rate: float) -> None:
        checked = _checked_rate(rate)
        with self._changed:
            self._set_clock(self._now(), is_running=self._since is not None)
            self._rate = checked
            self._changed.notify_all()

    def pause(self) -> None:
        """Pause until `resume`."""
        with self._changed:
            self._is_paused = True
            self._set_clock(self._now(), is_running=False)
            self._changed.notify_all()

    def resume(self) -> None:
        """Go on after `pause`."""
        with self._changed:
            if self._is_paused:
                self._is_paused = False
                self._set_clock(self._position, is_running=True)
                self._changed.notify_all()

    def seek(self, seconds: float) -> None:
        """Go on at another time, in s from the beginning of the recording.

        Raises:
            ValueError: if that is not within the recording.
            RuntimeError: if the replay has ended.
        """
        if not 0.0 <= seconds <= self.duration:
            raise ValueError(f"The recording is {self.duration:.1f} s long; {seconds:g} s is not within it.")
        with self._changed:
            if self.has_ended:
                raise RuntimeError("This replay has ended; start a new one with session.replay().")
            self._jumps += 1
            self._set_clock(seconds, is_running=self._since is not None)
            self._changed.notify_all()

    def wait(self, timeout: float | None = None) -> None:
        """Wait until the replay has ended. One that loops ends when it is stopped.

        Args:
            timeout: the longest wait in s; None waits as long as it takes.

        Raises:
            TimeoutError: if it has not ended by then.
            RuntimeError: if it had to end early; the text says why.
        """
        with interrupted_says("the replay goes on; its stop() ends it."):
            self._thread.join(timeout)
        if self._thread.is_alive():
            raise TimeoutError(
                f"The replay is at {self.position:.1f} s of {self.duration:.1f} s after {timeout:g} s of waiting."
            )
        if self._failure:
            raise RuntimeError(self._failure)

    def stop(self) -> None:
        """End the replay. Stopping twice does no harm."""
        with self._changed:
            self._is_stopped = True
            self._changed.notify_all()
        self._thread.join(STOP_TIMEOUT)

    def _new_publishers(self, topics: Collection[str] | None) -> dict[str, Any]:
        publishers = {}
        for topic in self._chosen(topics):
            recorded = self._file.topics[topic]
            nodes = self._others_on(topic)
            try:
                message_type = installed_type(recorded)
                with one_type_a_topic(self._node, topic, recorded.type_name):
                    publishers[topic] = self._node.create_publisher(
                        message_type, topic, replayed_qos(recorded.offered_qos)
                    )
            except (ValueError, NameValidationException) as error:
                self.notes.append(f"{topic} is not replayed: {error}")
                continue
            if nodes:
                verb = "publishes" if len(nodes) == 1 else "publish"
                self.notes.append(
                    f"{' and '.join(nodes)} {verb} on {topic}, too, so its subscribers receive both: stop "
                    f"{'it' if len(nodes) == 1 else 'them'}, or leave the topic out with topics=[...]."
                )
        if not publishers:
            raise ValueError(" ".join(self.notes) or f"{self._file.shown} holds no messages to replay.")
        return publishers

    def _chosen(self, topics: Collection[str] | None) -> list[str]:
        if topics is None:
            return [name for name, topic in self._file.topics.items() if _is_played(topic)]
        names = [self._node.resolve_topic_name(topic) for topic in topics]
        for name in names:
            if name not in self._file.topics:
                raise ValueError(no_topic(self._file, name))
        return names

    def _others_on(self, topic: str) -> list[str]:
        """Return the names of the nodes that publish on a topic, without the session's own."""
        own = self._node.get_name(), self._node.get_namespace()
        infos = self._node.get_publishers_info_by_topic(topic)
        return sorted({info.node_name for info in infos if (info.node_name, info.node_namespace) != own})

    def _run(self) -> None:
        try:
            wait_for_match(lambda: self._is_stopped or self._has_matched_all())
            with self._changed:
                self._set_clock(self._position, is_running=not self._is_paused)
            while self._play_on():
                pass
            # The last message must arrive before its publisher is destroyed.
            for publisher in self._publishers.values():
                publisher.wait_for_all_acked(Duration(seconds=MATCH_TIMEOUT))
        except Exception as error:  # whatever a damaged file makes its reader raise
            self._failure = f"The replay of {self._file.shown} ended early: {error}."
        finally:
            self._is_over = True
            for publisher in self._publishers.values():
                self._node.destroy_publisher(publisher)

    def _play_on(self) -> bool:
        """Publish from the current position on; return whether there is more to play."""
        with self._changed:
            jumps = self._jumps
            start = self._file.began + round(self._position * 1e9)
        for message in self._file.messages(self._publishers, start):
            if not self._is_due(self._file.seconds(message.time), jumps):
                return not self._is_stopped
            self._publishers[message.topic].publish(message.data)
            self._count += 1
        if self.loop:
            # A recording of a single moment is repeated once a second.
            if self._is_due(self.duration or 1.0, jumps):
                with self._changed:
                    self._set_clock(0.0, is_running=True)
            return not self._is_stopped
        with self._changed:
            self._is_over = self._jumps == jumps or self._is_stopped
            return not self._is_over

    def _is_due(self, position: float, jumps: int) -> bool:
        """Wait until a position is due; return False if the replay was stopped or moved meanwhile."""
        with self._changed:
            while not self._is_stopped and self._jumps == jumps:
                remaining = (position - self._now()) / self._rate if self._since is not None else None
                if remaining is not None and remaining <= 0.0:
                    return True
                self._changed.wait(None if remaining is None else min(remaining, threading.TIMEOUT_MAX))
        return False

    def _now(self) -> float:
        passed = 0.0 if self._since is None else time.monotonic() - self._since
        return self._position + passed * self._rate

    def _set_clock(self, position: float, *, is_running: bool) -> None:
        self._position = position
        self._since = time.monotonic() if is_running else None

    def _has_matched_all(self) -> bool:
        return all(
            publisher.get_subscription_count() >= self._node.count_subscribers(topic)
            for topic, publisher in self._publishers.items()
        )

    def __enter__(self) -> Replay:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def __repr__(self) -> str:
        state = "ended" if self.has_ended else "paused" if self._is_paused else "playing"
        where = f"{self.position:.1f} of {self.duration:.1f} s, {self.rate:g} times as fast"
        return f"Replay({self._file.shown!r}, {state}, {where})"


def _is_played(topic: RecordedTopic) -> bool:
    return topic.count > 0 and topic.name not in every_node.TOPICS


def _checked_rate(rate: float) -> float:
    if not SLOWEST <= rate <= FASTEST:
        raise ValueError(
            f"The rate must be from {SLOWEST:g} to {FASTEST:g} times the recorded speed, not {rate:g}."
        )
    return float(rate)
