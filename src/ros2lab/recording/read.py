"""Recordings, read for a table or a plot: the types of their messages, and how these are decoded."""

from __future__ import annotations

import contextlib
import operator
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from mcap.records import Schema
from mcap.well_known import SchemaEncoding
from mcap_ros2.decoder import DecoderFactory
from rclpy.serialization import deserialize_message

from portable_ros2.bags.definitions import definition_text, same_fields
from portable_ros2.bags.mcap_file import RecordedTopic, RecordingFile, Room, TooLargeError
from ros2lab import course
from ros2lab.recording.files import no_topic, open_recording
from ros2lab.recording.tables import counted, html_table, size, text_table
from ros2lab.topics import find_type


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
        path: the file's path.
        topics: what the file says about each topic, by name.
        is_whole: whether the file was finished properly; if not, it is read up to where it was cut off.
    """

    def __init__(self, file: RecordingFile) -> None:
        self._file = file
        self._samples: dict[str, list[RecordedSample]] = {}
        self.path = file.path
        self.topics = file.topics
        self.is_whole = file.is_whole

    @property
    def duration(self) -> float:
        """The time from the first message to the last one, in s."""
        return self._file.duration

    @property
    def count(self) -> int:
        """The number of messages in it."""
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

    def no_topic(self, topic: str) -> str:
        """Return a sentence that says that the recording does not hold a topic, and what it holds."""
        return no_topic(self._file, topic)

    def __getitem__(self, topic: str) -> list[RecordedSample]:
        if topic not in self.topics:
            raise KeyError(self.no_topic(topic))
        if topic not in self._samples:
            room = Room(self._file.shown)
            samples = []
            try:
                decode = decoder(self.topics[topic])
                for message in self._file.messages([topic]):
                    room.take(len(message.data))
                    samples.append(RecordedSample(self._file.seconds(message.time), decode(message.data)))
                self._samples[topic] = samples
            except TooLargeError:
                raise
            except Exception as error:  # whatever a damaged file makes its readers raise
                raise ValueError(
                    f"{topic} of {self._file.shown} cannot be read: {error}; record it again if the file is damaged."
                ) from None
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
        numbers = f"{counted(self.count, 'message')}, {self.duration:.1f} s, {size(self._file.size)}"
        end = "" if self.is_whole else "; it was cut off, and this is what was saved until then"
        return f"{self._file.shown}: {numbers}{end}"

    def __repr__(self) -> str:
        return (
            f"Recording({self._file.shown!r}, {counted(len(self), 'topic')}, "
            f"{counted(self.count, 'message')}, {self.duration:.1f} s)"
        )

    def __str__(self) -> str:
        return text_table(self.headline, self._rows())

    def _repr_html_(self) -> str:
        return html_table(self.headline, self._rows())


def read_recording(path: str | Path) -> Recording:
    """Read a recording, so that what it holds can be shown and plotted.

    Args:
        path: the file, as in the lab's terminals: `~` and relative paths are in the student's folder.

    Raises:
        FileNotFoundError: if there is no such file; the text names those that are there.
        ValueError: if it is not MCAP, or holds nothing of ROS 2.
    """
    return Recording(open_recording(course.student_path(path)))


def installed_type(topic: RecordedTopic) -> type:
    """Return the message class of a recorded topic.

    Raises:
        ValueError: if its type is not installed here, or has other fields here than in the recording.
    """
    message_type = find_type(topic.type_name)
    if topic.encoding == SchemaEncoding.ROS2:
        with contextlib.suppress(LookupError):  # a type without a definition is assumed to be the same
            if not same_fields(topic.definition, definition_text(topic.type_name)):
                raise ValueError(f"{topic.type_name} has other fields here than where it was recorded.")
    return message_type


def decoder(topic: RecordedTopic) -> Callable[[bytes], Any]:
    """Return a function that decodes a message: by the installed type, else by the recording's definition."""
    try:
        message_type = installed_type(topic)
    except ValueError as error:
        schema = Schema(1, topic.definition.encode(), topic.encoding, topic.type_name)
        decoder = DecoderFactory().decoder_for("cdr", schema)
        if decoder is None:
            raise ValueError(f"{topic.name} cannot be read: {error}") from None
        return decoder
    return lambda data: deserialize_message(data, message_type)
