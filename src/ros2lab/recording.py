"""Recordings of topics: made in the background, played again, and read for a plot.

A recorder takes messages as serialised bytes, in a thread of its own, so that neither a callback that takes its
time holds it up nor the ROS thread works for it; another thread writes them to disk. The file is MCAP, which
`ros2 bag` and Foxglove open, too.
"""

from __future__ import annotations

import contextlib
import difflib
import html
import operator
import sys
import threading
import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import IO, TYPE_CHECKING, Any, NamedTuple

import yaml
from mcap.records import Schema
from mcap_ros2.decoder import DecoderFactory
from rclpy.callback_groups import CallbackGroup
from rclpy.duration import Duration
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    QoSCompatibility,
    QoSProfile,
    ReliabilityPolicy,
    qos_check_compatible,
)
from rclpy.serialization import deserialize_message

from ros2lab import course
from ros2lab.interrupts import interrupted_says
from ros2lab.mcap_file import RecordedTopic, RecordingFile, RecordingWriter, definition_text, same_fields
from ros2lab.topics import QUEUE_DEPTH, find_type, matching_qos, one_type_a_topic

if TYPE_CHECKING:
    from rclpy.node import Node

INTAKE_THREAD, WRITER_THREAD = "ros2lab-recorder-intake", "ros2lab-recorder-writer"
REPLAY_THREAD = "ros2lab-replay"
TAKE_PERIOD = 0.05  # s, in which ROS holds what has come: up to QUEUE_DEPTH messages of a topic
WRITE_PERIOD = 0.1  # s
LAST_WAIT = 0.1  # s, for a message that is on its way when the recording ends
LOOK_PERIOD = 0.2  # s, for new topics, of which rclpy sends no event
FLUSH_PERIOD = 1.0  # s: what a kill can cost
MATCH_TIMEOUT = 1.0  # s
STOP_TIMEOUT = 10.0  # s
POLL_PERIOD = 0.005  # s, for facts about the graph
MOST_WAITING = 64 * 2**20  # bytes that wait for the disk
SLOWEST, FASTEST = 0.1, 100.0
KEPT_DEPTH = 10  # messages that a replayed transient-local topic keeps for late-joining subscribers

# Every node publishes on them, so what was recorded there would mix with what the nodes say now.
EVERYONES_TOPICS = ("/rosout", "/parameter_events")


class RecordedSample(NamedTuple):
    """A message of a recording.

    Attributes:
        time: when it was received, in s from the beginning of the recording.
        message: the message.
    """

    time: float
    message: Any


class Recording(Mapping[str, "list[RecordedSample]"]):
    """What a recording holds: `recording["/cmd_vel"]` is the list of the samples of a topic, oldest first.

    Usually made by `read_recording`.

    Args:
        file: the file.

    Attributes:
        topics: what the file says of each topic, by name.
        is_whole: whether the file was ended properly; if not, it is read up to where it was cut off.
    """

    def __init__(self, file: RecordingFile) -> None:
        self._file = file
        self._samples: dict[str, list[RecordedSample]] = {}
        self.topics = file.topics
        self.is_whole = file.is_whole

    @property
    def duration(self) -> float:
        """The time from the first message to the last one, in s."""
        return (self._file.ended - self._file.began) / 1e9

    @property
    def count(self) -> int:
        """How many messages it holds."""
        return sum(topic.count for topic in self.topics.values())

    def columns(self, topic: str, *fields: str) -> tuple[list[Any], ...]:
        """Return the times of a topic's messages, and the values of some of their fields.

        `twist_figure(*recording.columns("/cmd_vel", "linear.x", "angular.z"))` draws a drive.

        Args:
            topic: the topic's name.
            fields: names as in `linear.x`.

        Returns:
            A list of n times in s from the beginning of the recording, and a list of n values for each field.

        Raises:
            KeyError: if the recording has no such topic.
            AttributeError: if its messages have no such field.
        """
        samples = self[topic]
        getters = [operator.attrgetter(field) for field in fields]
        times = [sample.time for sample in samples]
        return times, *([getter(sample.message) for sample in samples] for getter in getters)

    def __getitem__(self, topic: str) -> list[RecordedSample]:
        if topic not in self.topics:
            raise KeyError(_no_topic(topic, self._file, course.shown_path(self._file.path)))
        if topic not in self._samples:
            decode = _decoder(self.topics[topic])
            self._samples[topic] = [
                RecordedSample((message.time - self._file.began) / 1e9, decode(message.data))
                for message in self._file.messages([topic])
            ]
        return self._samples[topic]

    def __iter__(self) -> Iterator[str]:
        return iter(self.topics)

    def __len__(self) -> int:
        return len(self.topics)

    def _rows(self) -> list[tuple[str, str, str]]:
        topics = sorted(self.topics.values(), key=lambda topic: topic.name)
        return [(topic.name, topic.type_name, str(topic.count)) for topic in topics]

    @property
    def headline(self) -> str:
        """What it holds, in one line."""
        name = course.shown_path(self._file.path)
        numbers = f"{_counted(self.count, 'message')}, {self.duration:.1f} s, {_size(self._file.size)}"
        end = "" if self.is_whole else "; it was cut off, and this is what was saved until then"
        return f"{name}: {numbers}{end}"

    def __repr__(self) -> str:
        return (
            f"Recording({course.shown_path(self._file.path)!r}, {_counted(len(self), 'topic')}, "
            f"{_counted(self.count, 'message')}, {self.duration:.1f} s)"
        )

    def __str__(self) -> str:
        return _text_table(self.headline, self._rows())

    def _repr_html_(self) -> str:
        return _html_table(self.headline, self._rows())


def read_recording(path: str | Path) -> Recording:
    """Read a recording, so that what it holds can be shown and plotted.

    Args:
        path: the file, as the lab's terminals write it: `~`, and what is relative, is in the student's folder.

    Raises:
        FileNotFoundError: if there is no such file; the text names those that are there.
        ValueError: if it is not MCAP, or holds nothing of ROS 2.
    """
    return Recording(_open_recording(course.student_path(path)))


class Recorder:
    """Records topics into an MCAP file until it is stopped, or the session ends.

    Made by `LabSession.record`. An existing file of the same name is kept in `~/earlier`. Topics that appear
    later are recorded from then on; hidden ones only if they are named.

    Args:
        node: the node that subscribes.
        path: the file.
        topics: only these; None takes all.
        most_waiting: how many bytes may wait for the disk; what comes beyond is dropped and counted.

    Raises:
        ValueError: if the path is a folder.
        OSError: if the file cannot be written.
    """

    def __init__(
        self,
        node: Node,
        path: Path,
        topics: Collection[str] | None = None,
        *,
        most_waiting: int = MOST_WAITING,
    ) -> None:
        self.path = path
        self._node = node
        self._wanted = None if topics is None else {node.resolve_topic_name(topic) for topic in topics}
        self._buffer = _Buffer(most_waiting)
        self._tracks: dict[str, _Track] = {}
        self._left_out: dict[str, str] = {}
        self._failure = ""
        self._stop_asked = threading.Event()
        self._is_taken_in = False
        self._is_told = False
        self._began = time.monotonic()
        self._ended: float | None = None
        self._stream = _new_file(path)
        self._writer = RecordingWriter(self._stream)
        self._group = _NotSpun()
        self._intake = threading.Thread(target=self._run_intake, name=INTAKE_THREAD, daemon=True)
        self._thread = threading.Thread(target=self._run_writer, name=WRITER_THREAD, daemon=True)
        try:
            self._look()
            self._meet()
        except BaseException:  # an interrupt, too
            self._stop_asked.set()
            raise
        finally:
            self._intake.start()
            self._thread.start()

    @property
    def counts(self) -> dict[str, int]:
        """How many messages were written, by topic."""
        return {topic: track.count for topic, track in list(self._tracks.items())}

    @property
    def count(self) -> int:
        """How many messages were written."""
        return sum(self.counts.values())

    @property
    def dropped(self) -> int:
        """How many messages came faster than they could be written, and were dropped."""
        return self._buffer.dropped

    @property
    def missed(self) -> int:
        """How many messages never came, as the numbers that a topic's only publisher gives them tell."""
        return sum(track.missed for track in list(self._tracks.values()))

    @property
    def duration(self) -> float:
        """How long it has recorded, in s."""
        return (self._ended or time.monotonic()) - self._began

    @property
    def is_recording(self) -> bool:
        """Whether it still records."""
        return not self._stop_asked.is_set()

    @property
    def failure(self) -> str:
        """Why the recording had to end early; empty if it had not."""
        return self._failure

    @property
    def problems(self) -> list[str]:
        """Sentences that say what is not in the file, and why."""
        problems = [self._failure] if self._failure else []
        problems += self._left_out.values()
        if self.dropped:
            problems.append(
                f"{_counted(self.dropped, 'message')} came faster than they could be written, and "
                f"{'is' if self.dropped == 1 else 'are'} not in the file; record fewer topics."
            )
        if self.missed:
            problems.append(
                f"{_counted(self.missed, 'message')} did not reach the recorder: "
                "a best-effort publisher, or more than this computer can take."
            )
        return problems

    def stop(self) -> None:
        """End the recording and the file; prints what is missing in it. Stopping twice does no harm."""
        self._stop_asked.set()
        with interrupted_says(f"{course.shown_path(self.path)} is finished in the background."):
            self._thread.join(STOP_TIMEOUT)
        if not self._is_told:
            self._is_told = True
            name = course.shown_path(self.path)
            sys.stdout.write("".join(f"{name}: {problem}\n" for problem in self.problems))

    def _run_intake(self) -> None:
        try:
            self._take_in()
        except Exception as error:  # it must be told, and the file ended, whatever it was
            self._fail(error)
        finally:
            self._unsubscribe()
            self._is_taken_in = True
            self._buffer.wake.set()

    def _take_in(self) -> None:
        looked = time.monotonic()
        while not self._stop_asked.wait(TAKE_PERIOD):
            self._take_messages()
            if time.monotonic() - looked >= LOOK_PERIOD:
                looked = time.monotonic()
                self._look()
        # What was published before the end may be on its way, and its topic not even known.
        self._look()
        self._meet()
        time.sleep(LAST_WAIT)
        self._take_messages()

    def _take_messages(self) -> None:
        for track in self._tracks.values():
            for data, info in track.waiting():
                track.note(info["publication_sequence_number"] or 0)
                self._buffer.put(track, data, info)

    def _run_writer(self) -> None:
        try:
            self._write_out()
        except Exception as error:  # as above
            self._fail(error)
        finally:
            self._stop_asked.set()
            with contextlib.suppress(OSError):
                self._stream.close()
            self._ended = time.monotonic()

    def _write_out(self) -> None:
        flushed = time.monotonic()
        while not self._is_taken_in:
            self._buffer.wait(WRITE_PERIOD)
            self._write()
            if time.monotonic() - flushed >= FLUSH_PERIOD:
                flushed = time.monotonic()
                self._writer.flush()
        self._write()
        for topic, track in self._tracks.items():
            self._channel(topic, track)  # to be seen in the file also where nothing came
        self._writer.finish()

    def _write(self) -> None:
        items = self._buffer.take()
        items.sort(key=lambda item: item[2]["received_timestamp"])
        for track, data, info in items:
            published = info["source_timestamp"]
            self._writer.add(
                self._channel(track.topic, track),
                data,
                received=info["received_timestamp"] or published,
                published=published,
                sequence=info["publication_sequence_number"] or 0,
            )
            track.count += 1

    def _channel(self, topic: str, track: _Track) -> int:
        if not track.channel:
            track.channel = self._writer.add_topic(
                topic,
                track.type_name,
                track.definition,
                offered_qos=track.offered_qos,
                type_hash=track.type_hash,
            )
        return track.channel

    def _fail(self, error: Exception) -> None:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else error
        self._failure = f"The recording ended early: {reason}."
        self._stop_asked.set()

    def _look(self) -> None:
        """Subscribe to topics that have appeared, and anew where a publisher offers less than was asked for."""
        for topic, _ in self._node.get_topic_names_and_types():
            if topic in self._left_out or not self._is_wanted(topic):
                continue
            offers = self._node.get_publishers_info_by_topic(topic)
            if not offers:
                continue
            try:
                self._take(topic, offers)
            except (LookupError, ValueError) as error:
                self._left_out[topic] = f"{topic} is not recorded: {error}"

    def _take(self, topic: str, offers: Sequence[Any]) -> None:
        track = self._tracks.get(topic) or _Track(topic, offers)
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
        self._tracks[topic] = track

    def _is_wanted(self, topic: str) -> bool:
        if self._wanted is not None:
            return topic in self._wanted
        return not any(part.startswith("_") for part in topic.split("/"))

    def _meet(self) -> None:
        """Wait until the publishers that the graph shows have been met: what is published before is lost."""

        def has_met_all() -> bool:
            return all(
                track.subscription.get_publisher_count() >= len(track.publishers)
                for track in list(self._tracks.values())
            )

        _wait(has_met_all, MATCH_TIMEOUT)

    def _unsubscribe(self) -> None:
        for track in self._tracks.values():
            if track.subscription is not None:
                self._node.destroy_subscription(track.subscription)
                track.subscription = None

    def __enter__(self) -> Recorder:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    def _rows(self) -> list[tuple[str, str, str]]:
        tracks = list(self._tracks.items())
        return sorted((topic, track.type_name, str(track.count)) for topic, track in tracks)

    @property
    def headline(self) -> str:
        """What was recorded so far, in one line."""
        doing = "recording" if self.is_recording else "recorded"
        numbers = f"{_counted(self.count, 'message')}, {self.duration:.1f} s"
        return " ".join([f"{course.shown_path(self.path)}: {doing}, {numbers}.", *self.problems])

    def __repr__(self) -> str:
        state = "recording" if self.is_recording else "stopped"
        return f"Recorder({course.shown_path(self.path)!r}, {state}, {_counted(self.count, 'message')})"

    def __str__(self) -> str:
        return _text_table(self.headline, self._rows())

    def _repr_html_(self) -> str:
        return _html_table(self.headline, self._rows())


class Replay:
    """Publishes the messages of a recording again, on their topics, with their timing.

    Made by `LabSession.replay`. Times are in s from the beginning of the recording. Its publishers end with it:
    a robot that is still driving then keeps its last velocity, so end a drive with a message that stops it.

    Args:
        node: the node that publishes.
        path: the file.
        rate: how many times faster than recorded, from 0.1 to 100.
        topics: only these; None takes all but `/rosout` and `/parameter_events`, where every node publishes.
        loop: whether it begins again at the end.

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
        self._file = _open_recording(path)
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
        return (self._file.ended - self._file.began) / 1e9

    @property
    def position(self) -> float:
        """Where it is, in s from the beginning of the recording."""
        with self._changed:
            return min(self._now(), self.duration)

    @property
    def count(self) -> int:
        """How many messages were published."""
        return self._count

    @property
    def is_playing(self) -> bool:
        """Whether it has not ended, been stopped or paused."""
        return not self.has_ended and not self._is_paused

    @property
    def has_ended(self) -> bool:
        """Whether it has come to its end, or was stopped."""
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
        """Stand still until `resume`."""
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
            others = self._others_on(topic)
            try:
                message_type = _installed_type(recorded)
                with one_type_a_topic(self._node, topic, recorded.type_name):
                    publishers[topic] = self._node.create_publisher(
                        message_type, topic, replayed_qos(recorded.offered_qos)
                    )
            except ValueError as error:
                self.notes.append(f"{topic} is not replayed: {error}")
                continue
            if others:
                verb = "publishes" if len(others) == 1 else "publish"
                self.notes.append(
                    f"{' and '.join(others)} {verb} on {topic}, too, so its subscribers receive both: stop "
                    f"{'it' if len(others) == 1 else 'them'}, or leave the topic out with topics=[...]."
                )
        if not publishers:
            raise ValueError(
                " ".join(self.notes) or f"{course.shown_path(self.path)} holds no messages to replay."
            )
        return publishers

    def _chosen(self, topics: Collection[str] | None) -> list[str]:
        if topics is None:
            return [name for name, topic in self._file.topics.items() if _is_played(topic)]
        names = [self._node.resolve_topic_name(topic) for topic in topics]
        for name in names:
            if name not in self._file.topics:
                raise ValueError(_no_topic(name, self._file, course.shown_path(self.path)))
        return names

    def _others_on(self, topic: str) -> list[str]:
        """Return the names of the nodes that publish on a topic, without the session's own."""
        own = self._node.get_name(), self._node.get_namespace()
        infos = self._node.get_publishers_info_by_topic(topic)
        return sorted({info.node_name for info in infos if (info.node_name, info.node_namespace) != own})

    def _run(self) -> None:
        try:
            _wait(lambda: self._is_stopped or self._has_met_all(), MATCH_TIMEOUT)
            with self._changed:
                self._set_clock(self._position, is_running=not self._is_paused)
            while self._play_on():
                pass
            # The last message has to arrive before its publisher goes.
            for publisher in self._publishers.values():
                publisher.wait_for_all_acked(Duration(seconds=MATCH_TIMEOUT))
        except Exception as error:  # whatever a damaged file makes its reader raise
            self._failure = f"The replay of {course.shown_path(self.path)} ended early: {error}."
        finally:
            self._is_over = True
            for publisher in self._publishers.values():
                self._node.destroy_publisher(publisher)

    def _play_on(self) -> bool:
        """Publish from the position on; return whether there is more to play."""
        with self._changed:
            jumps = self._jumps
            start = self._file.began + round(self._position * 1e9)
        for message in self._file.messages(self._publishers, start):
            if not self._is_due((message.time - self._file.began) / 1e9, jumps):
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
        """Wait until a position is reached; return False if the replay was stopped or set elsewhere meanwhile."""
        with self._changed:
            while not self._is_stopped and self._jumps == jumps:
                remaining = (position - self._now()) / self._rate if self._since is not None else None
                if remaining is not None and remaining <= 0.0:
                    return True
                self._changed.wait(remaining)
        return False

    def _now(self) -> float:
        passed = 0.0 if self._since is None else time.monotonic() - self._since
        return self._position + passed * self._rate

    def _set_clock(self, position: float, *, is_running: bool) -> None:
        self._position = position
        self._since = time.monotonic() if is_running else None

    def _has_met_all(self) -> bool:
        return all(
            publisher.get_subscription_count() >= self._node.count_subscribers(topic)
            for topic, publisher in self._publishers.items()
        )

    def __enter__(self) -> Replay:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    def __repr__(self) -> str:
        state = "ended" if self.has_ended else "paused" if self._is_paused else "playing"
        where = f"{self.position:.1f} of {self.duration:.1f} s, {self.rate:g} times as fast"
        return f"Replay({course.shown_path(self.path)!r}, {state}, {where})"


def qos_text(profiles: Sequence[QoSProfile]) -> str:
    """Write qualities of service as rosbag2 does in Jazzy."""
    return str(
        yaml.safe_dump(
            [
                {
                    "history": profile.history.name.lower(),
                    "depth": profile.depth,
                    "reliability": profile.reliability.name.lower(),
                    "durability": profile.durability.name.lower(),
                    "deadline": _time(profile.deadline),
                    "lifespan": _time(profile.lifespan),
                    "liveliness": profile.liveliness.name.lower(),
                    "liveliness_lease_duration": _time(profile.liveliness_lease_duration),
                    "avoid_ros_namespace_conventions": profile.avoid_ros_namespace_conventions,
                }
                for profile in profiles
            ],
            sort_keys=False,
        )
    )


def replayed_qos(offered: str) -> QoSProfile:
    """Return a quality of service that serves every subscriber that one of the recorded publishers served.

    Args:
        offered: the recorded offers as YAML, in the words of Jazzy or the numbers of earlier versions.
    """
    try:
        profiles = [profile for profile in yaml.safe_load(offered) or [] if isinstance(profile, dict)]
    except (yaml.YAMLError, TypeError):
        profiles = []
    reliabilities = {_policy(ReliabilityPolicy, profile.get("reliability")) for profile in profiles}
    durabilities = {_policy(DurabilityPolicy, profile.get("durability")) for profile in profiles}
    is_lossy = reliabilities == {ReliabilityPolicy.BEST_EFFORT}
    is_kept = DurabilityPolicy.TRANSIENT_LOCAL in durabilities
    depths = [depth for profile in profiles if isinstance(depth := profile.get("depth"), int)]
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        # How many a publisher keeps is not told to others: rosbag2 records 0 for it.
        depth=(max(depths, default=0) or KEPT_DEPTH) if is_kept else QUEUE_DEPTH,
        reliability=ReliabilityPolicy.BEST_EFFORT if is_lossy else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if is_kept else DurabilityPolicy.VOLATILE,
    )


class _Track:
    """A topic that is recorded.

    Raises:
        ValueError: if its type is not installed here.
        LookupError: if the definition of its type is not.
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
        verdict, _ = qos_check_compatible(offer, self.qos)
        return bool(verdict != QoSCompatibility.ERROR)

    def waiting(self) -> Iterator[tuple[bytes, dict[str, Any]]]:
        """Take the messages that have come, at most as many as ROS holds."""
        handle = self.subscription.handle
        with handle:  # it is not destroyed meanwhile
            for _ in range(QUEUE_DEPTH):
                taken = handle.take_message(self.message_type, True)
                if taken is None:
                    return
                yield taken

    def note(self, sequence: int) -> None:
        """Take note of a message's number, and of those that are missing before it."""
        if self._last:
            self._gaps += max(0, sequence - self._last - 1)
        self._last = sequence

    def met(self, publishers: set[bytes]) -> None:
        """Take note of who publishes now. Only the numbers of one and the same publisher tell what is missing."""
        if publishers == self.publishers and len(publishers) == 1:
            self.missed += self._gaps
        else:
            self._last = 0
        self._gaps = 0
        self.publishers = publishers


class _NotSpun(CallbackGroup):
    """Subscriptions that the executor leaves alone: a recorder takes their messages itself.

    So no slow callback of a node holds them up, and a message costs a sixth of what it costs by way of the executor.
    """

    def can_execute(self, _: object) -> bool:
        return False

    def beginning_execution(self, _: object) -> bool:
        return False

    def ending_execution(self, _: object) -> None:
        pass


def _not_called(_: bytes) -> None:
    pass


class _Buffer:
    """What was taken in and is not yet written, up to a number of bytes."""

    def __init__(self, most: int) -> None:
        self.dropped = 0
        self.wake = threading.Event()
        self._most = most
        self._lock = threading.Lock()
        self._bytes = 0
        self._items: list[tuple[_Track, bytes, dict[str, Any]]] = []

    def put(self, track: _Track, data: bytes, info: dict[str, Any]) -> None:
        with self._lock:
            if self._bytes + len(data) > self._most:
                self.dropped += 1
                return
            self._bytes += len(data)
            self._items.append((track, data, info))
        if 2 * self._bytes > self._most:
            self.wake.set()

    def take(self) -> list[tuple[_Track, bytes, dict[str, Any]]]:
        with self._lock:
            items, self._items, self._bytes = self._items, [], 0
        return items

    def wait(self, timeout: float) -> None:
        """Wait until it is half full, or the time is up."""
        self.wake.wait(timeout)
        self.wake.clear()


def _new_file(path: Path) -> IO[bytes]:
    """Open a new file, after an existing one of its name was moved to `~/earlier`."""
    if path.is_dir():
        raise ValueError(f"{course.shown_path(path)} is a folder; name a file, such as drive.mcap.")
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.exists():
        try:
            kept = course.keep_earlier(path, is_moved=True)
        except OSError:  # on another disk
            kept = course.keep_earlier(path)
            path.unlink()
        sys.stdout.write(f"The earlier {path.name} is kept as {course.shown_path(kept)}.\n")
    return path.open("xb")


def _open_recording(path: Path) -> RecordingFile:
    shown = course.shown_path(path)
    try:
        return RecordingFile(path, shown)
    except FileNotFoundError:
        there = sorted(other.name for other in path.parent.glob("*.mcap"))
        named = f"there are: {', '.join(there)}" if there else "there is no recording"
        raise FileNotFoundError(
            f"There is no file {shown}; in {course.shown_path(path.parent)} {named}."
        ) from None


def _decoder(topic: RecordedTopic) -> Callable[[bytes], Any]:
    """Return what makes a message of bytes: of the type installed here, else as the recording defines it."""
    try:
        message_type = _installed_type(topic)
    except ValueError as error:
        schema = Schema(1, topic.definition.encode(), topic.encoding, topic.type_name)
        decoder = DecoderFactory().decoder_for("cdr", schema)
        if decoder is None:
            raise ValueError(f"{topic.name} cannot be read: {error}") from None
        return decoder
    return lambda data: deserialize_message(data, message_type)


def _installed_type(topic: RecordedTopic) -> type:
    """Return the message class of a recorded topic.

    Raises:
        ValueError: if its type is not installed here, or has other fields than where it was recorded.
    """
    message_type = find_type(topic.type_name)
    if topic.encoding == "ros2msg":
        with contextlib.suppress(LookupError):  # a type without its definition is taken to be the same
            if not same_fields(topic.definition, definition_text(topic.type_name)):
                raise ValueError(f"{topic.type_name} has other fields here than where it was recorded.")
    return message_type


def _is_played(topic: RecordedTopic) -> bool:
    return topic.count > 0 and topic.name not in EVERYONES_TOPICS


def _no_topic(topic: str, file: RecordingFile, shown: str) -> str:
    close = difflib.get_close_matches(topic, file.topics, n=1, cutoff=0.6)
    hint = (
        f"did you mean {close[0]}?" if close else f"it holds: {', '.join(sorted(file.topics)) or 'nothing'}."
    )
    return f"{shown} holds no topic {topic}; {hint}"


def _checked_rate(rate: float) -> float:
    if not SLOWEST <= rate <= FASTEST:
        raise ValueError(
            f"The rate must be from {SLOWEST:g} to {FASTEST:g} times the recorded speed, not {rate:g}."
        )
    return float(rate)


def _policy(policies: Any, value: object) -> Any:
    """Return the policy of a recorded word or number, None if there is none."""
    if isinstance(value, int):
        return next((policy for policy in policies if policy.value == value), None)
    return policies.__members__.get(str(value).upper())


def _time(duration: Duration) -> dict[str, int]:
    seconds, nanoseconds = divmod(duration.nanoseconds, 10**9)
    return {"sec": seconds, "nsec": nanoseconds}


def _wait(condition: Callable[[], bool], timeout: float) -> bool:
    """Wait until a fact about the graph holds; return whether it does."""
    deadline = time.monotonic() + timeout
    while not condition():
        if time.monotonic() >= deadline:
            return False
        time.sleep(POLL_PERIOD)
    return True


def _counted(n: int, word: str) -> str:
    return f"{n:,} {word}" if n == 1 else f"{n:,} {word}s"


def _size(n: float) -> str:
    for unit in ("bytes", "kB", "MB"):
        if n < 1000:
            return f"{n:.3g} {unit}"
        n /= 1000
    return f"{n:.3g} GB"


def _text_table(headline: str, rows: Sequence[tuple[str, str, str]]) -> str:
    table = [("topic", "type", "messages"), *rows]
    widths = [max(len(row[column]) for row in table) for column in range(3)]
    lines = [f"{name:<{widths[0]}}  {kind:<{widths[1]}}  {n:>{widths[2]}}" for name, kind, n in table]
    return "\n".join([headline, *lines])


def _html_table(headline: str, rows: Sequence[tuple[str, str, str]]) -> str:
    left, right = 'style="text-align:left"', 'style="text-align:right"'
    body = "".join(
        f'<tr><th scope="row" {left}>{html.escape(topic)}</th><td {left}>{html.escape(kind)}</td>'
        f"<td {right}>{n}</td></tr>"
        for topic, kind, n in rows
    )
    return (
        f'<table><caption {left}>{html.escape(headline)}</caption><thead><tr><th scope="col" {left}>topic</th>'
        f'<th scope="col" {left}>type</th><th scope="col" {right}>messages</th></tr></thead>'
        f"<tbody>{body}</tbody></table>"
    )
