"""Recordings on disk: MCAP files of ROS 2 messages, as rosbag2 and Foxglove write and read them.

Nothing here needs ROS.
Source: https://mcap.dev/spec/registry and https://mcap.dev/spec
"""

from __future__ import annotations

import io
from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, NamedTuple

from mcap.reader import SeekingReader
from mcap.records import Channel, Header, McapRecord, Message, Schema
from mcap.stream_reader import StreamReader
from mcap.summary import Summary
from mcap.well_known import MessageEncoding, Profile, SchemaEncoding
from mcap.writer import MCAP0_MAGIC, Writer

QOS_KEY, HASH_KEY = "offered_qos_profiles", "topic_type_hash"  # the names that rosbag2 gives them


class RecordedMessage(NamedTuple):
    """A message as it lies in the file.

    Attributes:
        topic: its topic.
        time: when it was received, in ns since 1970.
        data: the serialised message (CDR).
    """

    topic: str
    time: int
    data: bytes


@dataclass(frozen=True)
class RecordedTopic:
    """What a file says of a topic.

    Attributes:
        name: the topic's name.
        type_name: its type, such as `std_msgs/msg/String`.
        count: how many messages of it there are.
        definition: the definition of the type, with those of all types in it.
        encoding: how the definition is written: `ros2msg`, `ros2idl`, or empty if there is none.
        offered_qos: the qualities of service that its publishers offered, as YAML; empty if unknown.
    """

    name: str
    type_name: str
    count: int
    definition: str
    encoding: str
    offered_qos: str


class RecordingWriter:
    """Writes a recording. The stream stays open, and `finish` makes the file whole.

    Args:
        stream: a binary file, open for writing.
        library: what is said to have written it.
    """

    def __init__(self, stream: IO[bytes], library: str = "portable_ros2") -> None:
        self._writer = Writer(stream)
        self._writer.start(profile=Profile.ROS2, library=library)
        self._writer.flush()
        self._schemas: dict[str, int] = {}

    def add_topic(
        self, name: str, type_name: str, definition: str, *, offered_qos: str = "", type_hash: str = ""
    ) -> int:
        """Add a topic, and return the number by which its messages are added.

        Args:
            name: the topic's name.
            type_name: such as `std_msgs/msg/String`.
            definition: of the type, as `message_types.definition_text` returns it.
            offered_qos: what its publishers offer, as YAML.
            type_hash: the hash of the type, as ROS writes it.
        """
        if type_name not in self._schemas:
            self._schemas[type_name] = self._writer.register_schema(
                type_name, SchemaEncoding.ROS2, definition.encode()
            )
        metadata = {QOS_KEY: offered_qos, HASH_KEY: type_hash}
        return self._writer.register_channel(name, MessageEncoding.CDR, self._schemas[type_name], metadata)

    def add(self, channel: int, data: bytes, *, received: int, published: int, sequence: int = 0) -> None:
        """Add a serialised message; times in ns since 1970."""
        self._writer.add_message(channel, received, data, published, sequence & 0xFFFFFFFF)

    def flush(self) -> None:
        """Write what was added so far, so that it is in the file even if the process is killed.

        Raises:
            OSError: if it cannot be written.
        """
        self._writer.flush()

    def finish(self) -> None:
        """Write what is left, and the index.

        Raises:
            OSError: if it cannot be written.
        """
        self._writer.finish()


class RecordingFile:
    """A recording on disk: what it holds, and its messages.

    A file that was cut off, such as by a kill, is read up to there.

    Args:
        path: the file.
        shown: what it is called in sentences; None takes the path.

    Attributes:
        path: the file.
        shown: what it is called in sentences.
        size: its size in bytes.
        is_whole: whether its writer has ended it properly.
        topics: what it says of its topics, by name; those that are not of ROS 2 are left out.
        began: when the first message was received, in ns since 1970; 0 if there is none.
        ended: when the last one was received, in ns since 1970; 0 if there is none.

    Raises:
        ValueError: if it is not MCAP, or holds nothing of ROS 2.
        OSError: if it cannot be read.
    """

    def __init__(self, path: Path, shown: str | None = None) -> None:
        self.path = path
        self.shown = shown = shown or str(path)
        if path.is_dir():
            raise ValueError(f"{shown} is a folder; name the .mcap file in it.")
        self.size = path.stat().st_size
        with path.open("rb") as stream:
            _check_magic(stream, shown)
            summary = _summary(stream, self.size)
            self._has_index = summary is not None and bool(summary.chunk_indexes)
            contents = _summarised(summary) if summary is not None else _scanned(stream)
            _check_profile(stream, shown, contents)
        self.is_whole = _ends_whole(path)
        self.topics, self.began, self.ended = contents

    @property
    def duration(self) -> float:
        """The time from the first message to the last one, in s."""
        return self.seconds(self.ended)

    def seconds(self, time: int) -> float:
        """Return a time in ns since 1970 as s from the beginning of the recording."""
        return (time - self.began) / 1e9

    def messages(self, topics: Collection[str] | None = None, since: int = 0) -> Iterator[RecordedMessage]:
        """Yield the messages, oldest first as far as the file has an index, else in the order of the file.

        Args:
            topics: only of these; None takes all.
            since: only those received at this time or later, in ns since 1970.
        """
        wanted = set(self.topics if topics is None else self.topics.keys() & set(topics))
        with self.path.open("rb") as stream:
            if self._has_index:
                found = SeekingReader(stream).iter_messages(wanted, starting_at=since)
                for _, channel, message in found:
                    yield RecordedMessage(channel.topic, message.log_time, message.data)
                return
            channels: dict[int, str] = {}
            for record in _records(stream):
                if isinstance(record, Channel):
                    channels[record.id] = record.topic
                elif isinstance(record, Message) and record.log_time >= since:
                    topic = channels.get(record.channel_id)
                    if topic in wanted:
                        yield RecordedMessage(topic, record.log_time, record.data)


class _Contents(NamedTuple):
    topics: dict[str, RecordedTopic]
    began: int
    ended: int


def _check_magic(stream: IO[bytes], shown: str) -> None:
    start = stream.read(len(MCAP0_MAGIC))
    if not start:
        raise ValueError(f"{shown} is empty: nothing was recorded.")
    if start != MCAP0_MAGIC:
        raise ValueError(f"{shown} is not a recording: it is not in the format MCAP.")


def _check_profile(stream: IO[bytes], shown: str, contents: _Contents) -> None:
    header = next(_records(stream), None)
    profile = header.profile if isinstance(header, Header) else ""
    if not contents.topics and profile != Profile.ROS2:
        raise ValueError(f"{shown} is MCAP, but holds no messages of ROS 2 (its profile is {profile!r}).")


def _ends_whole(path: Path) -> bool:
    with path.open("rb") as stream:
        stream.seek(-min(len(MCAP0_MAGIC), path.stat().st_size), io.SEEK_END)
        return path.stat().st_size > len(MCAP0_MAGIC) and stream.read() == MCAP0_MAGIC


def _summary(stream: IO[bytes], size: int) -> Summary | None:
    """Return the summary at the end of the file, None if there is none that tells of all messages."""
    stream.seek(-len(MCAP0_MAGIC), io.SEEK_END)
    if stream.read() != MCAP0_MAGIC:
        return None
    stream.seek(0)
    try:
        summary = SeekingReader(stream, record_size_limit=size).get_summary()
    except Exception:  # of a damaged file the library raises whatever its parts raise
        return None
    if summary is None or summary.statistics is None:
        return None
    return summary if len(summary.channels) == summary.statistics.channel_count else None


def _summarised(summary: Summary) -> _Contents:
    counted = summary.statistics
    assert counted is not None
    counts = counted.channel_message_counts
    topics: dict[str, RecordedTopic] = {}
    for channel in summary.channels.values():
        _add(topics, channel, summary.schemas.get(channel.schema_id), counts.get(channel.id, 0))
    return _Contents(topics, counted.message_start_time, counted.message_end_time)


def _scanned(stream: IO[bytes]) -> _Contents:
    """Read the whole file, or what there is of it, to say what it holds."""
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    counts: dict[int, int] = {}
    times: list[int] = []
    for record in _records(stream):
        if isinstance(record, Schema):
            schemas[record.id] = record
        elif isinstance(record, Channel):
            channels[record.id] = record
        elif isinstance(record, Message):
            counts[record.channel_id] = counts.get(record.channel_id, 0) + 1
            earliest, latest = (times[0], times[1]) if times else (record.log_time, record.log_time)
            times = [min(earliest, record.log_time), max(latest, record.log_time)]
    topics: dict[str, RecordedTopic] = {}
    for channel in channels.values():
        _add(topics, channel, schemas.get(channel.schema_id), counts.get(channel.id, 0))
    began, ended = times or (0, 0)
    return _Contents(topics, began, ended)


def _add(topics: dict[str, RecordedTopic], channel: Channel, schema: Schema | None, count: int) -> None:
    """Add a channel to the topics. Some writers make a channel for each publisher."""
    if channel.message_encoding != MessageEncoding.CDR:
        return
    if channel.topic in topics:
        known = topics[channel.topic]
        topics[channel.topic] = replace(known, count=known.count + count)
        return
    topics[channel.topic] = RecordedTopic(
        name=channel.topic,
        type_name=schema.name if schema else "",
        count=count,
        definition=schema.data.decode(errors="replace") if schema else "",
        encoding=schema.encoding if schema else "",
        offered_qos=channel.metadata.get(QOS_KEY, ""),
    )


def _records(stream: IO[bytes]) -> Iterator[McapRecord]:
    """Yield the records from the beginning to the end, or to where the file was cut off."""
    stream.seek(0, io.SEEK_END)
    size = stream.tell()
    stream.seek(0)
    records = StreamReader(stream, record_size_limit=size).records
    while True:
        try:
            record = next(records)
        except StopIteration:
            return
        except Exception:  # of half a record the library raises whatever its parts raise
            return
        yield record
