"""Recordings on disk: MCAP files of ROS 2 messages, as rosbag2 and Foxglove write and read them.

Nothing here needs ROS.
Source: https://mcap.dev/spec/registry and https://mcap.dev/spec
"""

from __future__ import annotations

import heapq
import io
import stat
import struct
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import IO, Any, NamedTuple

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, ChunkIndex, Footer, Header, McapRecord, Message, Schema, Statistics
from mcap.well_known import MessageEncoding, Profile, SchemaEncoding
from mcap.writer import MCAP0_MAGIC, Writer

QOS_KEY, HASH_KEY = "offered_qos_profiles", "topic_type_hash"  # the names that rosbag2 gives them


# What a file may make of itself. The longest messages, images and clouds of points, have some 100 MB, and what
# packs best of all that is recorded, images of a still scene, becomes a hundred times smaller.
MOST_AT_ONCE = 10**9  # bytes that are held in memory
MOST_PACKED = 1000  # times the size of the file that it unpacks to, if that is more than may be held
OF_AN_OBJECT = 500  # bytes that Python needs for a message or the like, however short it is


class TooLargeError(ValueError):
    """A recording that would take more memory or time than what anybody records."""


class Room:
    """What there is room for of a recording.

    Args:
        shown: what the recording is called in sentences.
        size: the size of the file, if what is counted is all that it unpacks to, and not what is held of it.
    """

    def __init__(self, shown: str, size: int = 0) -> None:
        self.shown = shown
        self._most = max(MOST_AT_ONCE, MOST_PACKED * size)
        self._why = "a file of its size may hold" if size else "can be held in memory"
        self._taken = 0

    def take(self, size: int) -> None:
        """Count something of so many bytes.

        Raises:
            TooLargeError: if that is too much.
        """
        self._taken += size + OF_AN_OBJECT
        if self._taken > self._most:
            raise TooLargeError(
                f"{self.shown} unpacks to more than the {self._most // 10**6} MB that {self._why}."
            )

    def give_back(self, size: int) -> None:
        """Count that something of so many bytes is no longer held."""
        self._taken -= size + OF_AN_OBJECT


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
        if not stat.S_ISREG(path.stat().st_mode):
            raise ValueError(f"{shown} is no file on a disk, which a recording is.")
        self.size = path.stat().st_size
        with path.open("rb") as stream:
            _check_magic(stream, shown)
            self.is_whole = _ends_whole(stream, self.size)
            summary = _summary(stream, self._total()) if self.is_whole else None
            seen = summary or _scanned(stream, self._total())
            self._indexes = seen.indexes
            self._channels = seen.channels
            self.topics = seen.topics()
            _check_profile(stream, self._total(), self.topics)
        self.began, self.ended = seen.times or (0, 0)

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
            if self._indexes:
                yield from self._in_order(stream, wanted, since)
                return
            channels: dict[int, Channel] = {}
            for record in _records(stream, len(MCAP0_MAGIC), self._total()):
                if isinstance(record, Channel):
                    channels[record.id] = record
                elif isinstance(record, Message) and record.log_time >= since:
                    channel = channels.get(record.channel_id)
                    if channel is not None and channel.topic in wanted:
                        yield RecordedMessage(channel.topic, record.log_time, record.data)

    def _total(self) -> Room:
        return Room(self.shown, self.size)

    def _in_order(self, stream: IO[bytes], wanted: set[str], since: int) -> Iterator[RecordedMessage]:
        """Yield the messages by their time; of chunks that overlap, those wait whose turn comes later."""
        numbers = {number for number, channel in self._channels.items() if channel.topic in wanted}
        indexes = [
            index
            for index in self._indexes
            if index.message_end_time >= since
            and (not index.message_index_offsets or numbers & index.message_index_offsets.keys())
        ]
        indexes.sort(key=lambda index: (index.message_start_time, index.chunk_start_offset))
        room, total = Room(self.shown), self._total()
        waiting: list[tuple[int, int, int, RecordedMessage]] = []
        for index in indexes:
            while waiting and waiting[0][0] < index.message_start_time:
                yield _next(waiting, room)
            stream.seek(index.chunk_start_offset)
            chunk = next(_parsed(stream, total), None)
            if not isinstance(chunk, Chunk):
                raise ValueError("its index names a place at which no messages are.")
            for number, record in enumerate(_parsed(_unpacked(chunk), total)):
                if isinstance(record, Message) and record.channel_id in numbers and record.log_time >= since:
                    topic = self._channels[record.channel_id].topic
                    message = RecordedMessage(topic, record.log_time, record.data)
                    room.take(len(message.data))
                    heapq.heappush(waiting, (message.time, index.chunk_start_offset, number, message))
        while waiting:
            yield _next(waiting, room)


def _next(waiting: list[tuple[int, int, int, RecordedMessage]], room: Room) -> RecordedMessage:
    message = heapq.heappop(waiting)[-1]
    room.give_back(len(message.data))
    return message


@dataclass
class _Seen:
    """What was read of a file that says what it holds."""

    shown: str
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    counts: dict[int, int] = field(default_factory=dict)
    times: tuple[int, int] | None = None
    statistics: Statistics | None = None
    indexes: list[ChunkIndex] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._room = Room(self.shown)

    def add(self, record: McapRecord) -> None:
        """Add a record.

        Raises:
            TooLargeError: if there is too much of it.
        """
        if isinstance(record, Schema):
            self._room.take(len(record.data))
            self.schemas[record.id] = record
        elif isinstance(record, Channel):
            metadata = sum(len(key) + len(value) + OF_AN_OBJECT for key, value in record.metadata.items())
            self._room.take(len(record.topic) + metadata)
            self.channels[record.id] = record
        elif isinstance(record, ChunkIndex):
            self._room.take(len(record.message_index_offsets) * OF_AN_OBJECT)
            self.indexes.append(record)
        elif isinstance(record, Statistics):
            self.statistics = record
            self.counts = record.channel_message_counts
            self.times = record.message_start_time, record.message_end_time
        elif isinstance(record, Message):
            self.counts[record.channel_id] = self.counts.get(record.channel_id, 0) + 1
            first, last = self.times or (record.log_time, record.log_time)
            self.times = min(first, record.log_time), max(last, record.log_time)

    def topics(self) -> dict[str, RecordedTopic]:
        """Return the topics of ROS 2. Some writers make a channel for each publisher of one."""
        topics: dict[str, RecordedTopic] = {}
        for channel in self.channels.values():
            if channel.message_encoding != MessageEncoding.CDR:
                continue
            count = self.counts.get(channel.id, 0)
            if channel.topic in topics:
                known = topics[channel.topic]
                topics[channel.topic] = replace(known, count=known.count + count)
                continue
            schema = self.schemas.get(channel.schema_id)
            topics[channel.topic] = RecordedTopic(
                name=channel.topic,
                type_name=schema.name if schema else "",
                count=count,
                definition=schema.data.decode(errors="replace") if schema else "",
                encoding=schema.encoding if schema else "",
                offered_qos=channel.metadata.get(QOS_KEY, ""),
            )
        return topics


def _check_magic(stream: IO[bytes], shown: str) -> None:
    start = stream.read(len(MCAP0_MAGIC))
    if not start:
        raise ValueError(f"{shown} is empty: nothing was recorded.")
    if start != MCAP0_MAGIC:
        raise ValueError(f"{shown} is not a recording: it is not in the format MCAP.")


def _check_profile(stream: IO[bytes], total: Room, topics: Collection[str]) -> None:
    header = next(_records(stream, len(MCAP0_MAGIC), total), None)
    profile = header.profile if isinstance(header, Header) else ""
    if not topics and profile != Profile.ROS2:
        raise ValueError(
            f"{total.shown} is MCAP, but holds no messages of ROS 2 (its profile is {profile!r})."
        )


def _ends_whole(stream: IO[bytes], size: int) -> bool:
    stream.seek(-min(len(MCAP0_MAGIC), size), io.SEEK_END)
    return size > len(MCAP0_MAGIC) and stream.read() == MCAP0_MAGIC


def _summary(stream: IO[bytes], total: Room) -> _Seen | None:
    """Return what the end of a file says of it, None if it does not tell of all messages."""
    footer = next(_records(stream, -(_FOOTER_SIZE + len(MCAP0_MAGIC)), total), None)
    if not isinstance(footer, Footer) or not footer.summary_start:
        return None
    seen = _Seen(total.shown)
    for record in _records(stream, footer.summary_start, total):
        if isinstance(record, Message):
            return None
        seen.add(record)
    is_told = seen.statistics is not None and len(seen.channels) == seen.statistics.channel_count
    return seen if is_told else None


def _scanned(stream: IO[bytes], total: Room) -> _Seen:
    """Read the whole file, or what there is of it, to say what it holds."""
    seen = _Seen(total.shown)
    for record in _records(stream, len(MCAP0_MAGIC), total):
        if isinstance(record, Schema | Channel | Message):
            seen.add(record)
    return seen


# --- Records ------------------------------------------------------------------------------------------------------
# The readers of the library unpack a chunk as a whole, and read whatever length a record says that it has.
# Here no more of a chunk is unpacked than is read, and what is not needed is passed over.

_HEAD = struct.Struct("<BQ")  # what kind of record, and how long
_FOOTER_SIZE = _HEAD.size + 20
_PIECE = 2**20  # bytes
_READERS: dict[int, Callable[[ReadDataStream, int], McapRecord]] = {
    Opcode.HEADER: lambda stream, _: Header.read(stream),
    Opcode.FOOTER: lambda stream, _: Footer.read(stream),
    Opcode.SCHEMA: lambda stream, _: Schema.read(stream),
    Opcode.CHANNEL: lambda stream, _: Channel.read(stream),
    Opcode.MESSAGE: Message.read,
    Opcode.CHUNK: lambda stream, _: Chunk.read(stream),
    Opcode.CHUNK_INDEX: lambda stream, _: ChunkIndex.read(stream),
    Opcode.STATISTICS: lambda stream, _: Statistics.read(stream),
}


def _records(stream: IO[bytes], start: int, total: Room) -> Iterator[McapRecord]:
    """Yield the records from a place on, also those in chunks, to the end or to where the file was cut off.

    Raises:
        TooLargeError: if there is more of them than there is room for.
    """
    try:
        stream.seek(start, io.SEEK_SET if start >= 0 else io.SEEK_END)
        for record in _parsed(stream, total):
            if isinstance(record, Chunk):
                yield from _parsed(_unpacked(record), total)
            else:
                yield record
            if isinstance(record, Footer):
                return
    except TooLargeError:
        raise
    except Exception:  # of half a record the library raises whatever its parts raise
        return


def _parsed(stream: IO[bytes], total: Room) -> Iterator[McapRecord]:
    """Yield the records of a stream that are of use, to its end."""
    while len(head := stream.read(_HEAD.size)) == _HEAD.size:
        kind, length = _HEAD.unpack(head)
        if kind not in _READERS:
            total.take(0)
            if not _skip(stream, length):
                return
            continue
        Room(total.shown).take(length)
        total.take(length)
        data = stream.read(length)
        if len(data) < length:
            return
        yield _READERS[kind](ReadDataStream(io.BytesIO(data)), length)


def _skip(stream: IO[bytes], length: int) -> bool:
    """Pass over a part of a stream, and return whether it has one of this length."""
    if isinstance(stream, io.BufferedReader) and isinstance(stream.raw, io.FileIO):
        here = stream.tell()
        return stream.seek(0, io.SEEK_END) >= here + length and stream.seek(here + length) >= 0
    while length > 0 and (piece := stream.read(min(length, _PIECE))):
        length -= len(piece)
    return length == 0


def _unpacked(chunk: Chunk) -> IO[bytes]:
    """Return what unpacks a chunk as it is read.

    Raises:
        ValueError: if it is packed in a way that is not known here.
    """
    packed: Any = io.BytesIO(chunk.data)
    if chunk.compression == "zstd":
        import zstandard

        return io.BufferedReader(zstandard.ZstdDecompressor().stream_reader(packed), _PIECE)
    if chunk.compression == "lz4":
        import lz4.frame  # type: ignore[import-untyped]

        return io.BufferedReader(lz4.frame.LZ4FrameFile(packed), _PIECE)
    if chunk.compression:
        raise ValueError(f"its chunks are packed with {chunk.compression!r}, which is not known here.")
    return io.BytesIO(chunk.data)
