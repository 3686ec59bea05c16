"""A recording on disk is what rosbag2 and Foxglove expect, and is read as far as it goes."""

from __future__ import annotations

import os
import struct
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import lz4.frame  # type: ignore[import-untyped]
import pytest
import zstandard
from mcap.reader import make_reader
from mcap.writer import Writer
from rosbags.highlevel import AnyReader

from portable_ros2.bags import mcap_file
from portable_ros2.bags.definitions import definition_text, same_fields
from portable_ros2.bags.mcap_file import RecordedMessage, RecordingFile, RecordingWriter, TooLargeError

DEFINITIONS = {
    "pond/msg/Duck.msg": "# A duck.\n\nstring name  # its own\nEgg[] eggs\nland/Place place\n",
    "pond/msg/Egg.msg": "int32 SIZE=3\nland/Place place\nfloat64 mass\n",
    "land/msg/Place.msg": "float64 x\nfloat64 y\n",
}
PLACE = "float64 x\nfloat64 y\n"
TYPE = "land/msg/Place"


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Install two packages of messages, as ament lays them out, and nothing else."""
    for file, text in DEFINITIONS.items():
        package = file.split("/")[0]
        for kind in ("packages", "rosidl_interfaces"):
            resource = tmp_path / "share/ament_index/resource_index" / kind / package
            resource.parent.mkdir(parents=True, exist_ok=True)
            resource.touch()
        path = tmp_path / "share" / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))


def place(x: float, y: float) -> bytes:
    """Serialise a Place by hand: four bytes that say little-endian CDR, and two doubles."""
    return b"\x00\x01\x00\x00" + struct.pack("<2d", x, y)


def recorded(path: Path, n: int, *, flushed_every: int = 1000, is_finished: bool = True) -> Path:
    """Write `n` places on `/place`, one a millisecond."""
    with path.open("wb") as stream:
        writer = RecordingWriter(stream)
        channel = writer.add_topic("/place", TYPE, PLACE)
        for number in range(n):
            moment = 10**18 + number * 10**6
            writer.add(
                channel, place(number, -1.0), received=moment, published=moment - 5, sequence=number + 1
            )
            if number % flushed_every == flushed_every - 1:
                writer.flush()
        if is_finished:
            writer.finish()
    return path


@pytest.mark.usefixtures("installed")
def test_a_definition_comes_with_those_of_all_types_in_it_each_once() -> None:
    line = "=" * 80
    assert definition_text("pond/msg/Duck") == (
        "# A duck.\n\nstring name  # its own\nEgg[] eggs\nland/Place place\n"
        f"{line}\nMSG: pond/Egg\nint32 SIZE=3\nland/Place place\nfloat64 mass\n"
        f"{line}\nMSG: land/Place\nfloat64 x\nfloat64 y\n"
    )


@pytest.mark.usefixtures("installed")
@pytest.mark.parametrize("name", ["pond/msg/Swan", "sea/msg/Duck", "Duck"])
def test_a_definition_that_is_not_installed_is_named(name: str) -> None:
    with pytest.raises(LookupError, match=name.partition("/")[0]):
        definition_text(name)


@pytest.mark.parametrize(
    ("other", "is_same"),
    [
        ("float64   x # m\n\nfloat64 y\nint32 N=3\n", True),
        ("float64 x\nfloat32 y\n", False),
        ("float64 y\nfloat64 x\n", False),
        ("float64 x\n", False),
    ],
    ids=["comments and constants", "another type", "another order", "one less"],
)
def test_definitions_are_compared_by_what_is_serialised(other: str, is_same: bool) -> None:
    """Also those of the types in a type, whose names are written in two ways."""
    line = "=" * 80
    assert same_fields(PLACE, other) is is_same
    nested = f"Place place\n{line}\nMSG: land/Place\n{PLACE}"
    assert same_fields(nested, f"Place place\n{line}\nMSG: land/msg/Place\n{other}") is is_same


def test_an_independent_reader_reads_the_same(tmp_path: Path) -> None:
    path = recorded(tmp_path / "a.mcap", 3)
    with AnyReader([path]) as reader:
        assert [(known.topic, known.msgtype) for known in reader.connections] == [("/place", TYPE)]
        messages = [
            (moment, reader.deserialize(data, known.msgtype)) for known, moment, data in reader.messages()
        ]
    assert [(moment - 10**18, message.x, message.y) for moment, message in messages] == [
        (0, 0.0, -1.0),
        (10**6, 1.0, -1.0),
        (2 * 10**6, 2.0, -1.0),
    ]


def test_the_file_has_the_profile_and_the_encodings_of_ros_2(tmp_path: Path) -> None:
    with recorded(tmp_path / "a.mcap", 1).open("rb") as stream:
        reader = make_reader(stream)
        assert reader.get_header().profile == "ros2"
        ((schema, channel, message),) = reader.iter_messages()
    assert schema is not None
    assert (schema.name, schema.encoding, schema.data.decode()) == (TYPE, "ros2msg", PLACE)
    assert channel.message_encoding == "cdr"
    assert "offered_qos_profiles" in channel.metadata
    assert (message.log_time - message.publish_time, message.sequence) == (5, 1)


def test_a_whole_file_is_read(tmp_path: Path) -> None:
    file = RecordingFile(recorded(tmp_path / "a.mcap", 250, flushed_every=100))
    assert file.is_whole
    assert (file.topics["/place"].type_name, file.topics["/place"].count) == (TYPE, 250)
    assert (file.began, file.ended) == (10**18, 10**18 + 249 * 10**6)
    messages = list(file.messages())
    assert messages[-1] == RecordedMessage("/place", file.ended, place(249, -1.0))
    assert [message.time for message in messages] == sorted(message.time for message in messages)
    assert list(file.messages(since=file.began + 248 * 10**6)) == messages[248:]
    assert list(file.messages(["/elsewhere"])) == []


def test_a_file_that_is_cut_off_anywhere_is_read_up_to_there(tmp_path: Path) -> None:
    """No message is changed or out of order, and what was flushed before the cut is there."""
    whole = recorded(tmp_path / "a.mcap", 12, flushed_every=4)
    messages = list(RecordingFile(whole).messages())
    data = whole.read_bytes()
    found = []
    (header,) = struct.unpack("<Q", data[9:17])
    for length in range(17 + header, len(data), 3):
        cut = tmp_path / "cut.mcap"
        cut.write_bytes(data[:length])
        file = RecordingFile(cut)
        assert not file.is_whole
        read = list(file.messages())
        assert read == messages[: len(read)]
        assert sum(topic.count for topic in file.topics.values()) == len(read)
        found.append(len(read))
    assert found == sorted(found)
    assert set(found) == {0, 4, 8, 12}


def test_what_was_flushed_is_there_without_an_end(tmp_path: Path) -> None:
    """As after a kill."""
    file = RecordingFile(recorded(tmp_path / "a.mcap", 10, flushed_every=4, is_finished=False))
    assert not file.is_whole
    assert file.topics["/place"].count == len(list(file.messages())) == 8


def test_a_recording_without_messages_is_one(tmp_path: Path) -> None:
    file = RecordingFile(recorded(tmp_path / "a.mcap", 0))
    assert file.is_whole
    assert (file.topics["/place"].count, file.began, file.ended) == (0, 0, 0)
    assert list(file.messages()) == []


def test_topics_of_another_encoding_are_left_out(tmp_path: Path) -> None:
    """As in a file that Foxglove wrote of several robots; a topic may have two channels."""
    path = tmp_path / "a.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start("", "a test")
        schema = writer.register_schema(TYPE, "ros2msg", PLACE.encode())
        channels = [writer.register_channel("/place", "cdr", schema) for _ in range(2)]
        channels.append(writer.register_channel("/json", "json", 0))
        for number, channel in enumerate(channels):
            writer.add_message(channel, number, place(0, 0), number)
        writer.finish()
    file = RecordingFile(path)
    assert {name: topic.count for name, topic in file.topics.items()} == {"/place": 2}
    assert [message.time for message in file.messages()] == [0, 1]


def other_mcap(path: Path) -> None:
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start("ros1", "a test")
        writer.register_channel("/a", "ros1", writer.register_schema("a/B", "ros1msg", b""))
        writer.finish()


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda path: path.write_bytes(b""), "drive is empty: nothing was recorded."),
        (lambda path: path.write_bytes(b"\x89MC"), "drive is not a recording: it is not in the format MCAP."),
        (lambda path: path.write_bytes(b"SQLite format 3\0" * 9), "drive is not a recording: .*"),
        (other_mcap, r"drive is MCAP, but holds no messages of ROS 2 \(its profile is 'ros1'\)."),
        (lambda path: path.mkdir(), "drive is a folder; name the .mcap file in it."),
    ],
    ids=["empty", "three bytes", "SQLite", "ROS 1", "a folder"],
)
def test_what_is_no_recording_of_ros_2_is_refused_in_a_sentence(
    tmp_path: Path, make: object, sentence: str
) -> None:
    path = tmp_path / "drive"
    make(path)  # type: ignore[operator]
    with pytest.raises(ValueError, match=f"^{sentence}$"):
        RecordingFile(path, "drive")


# --- Files that were made to fill the memory, with less room for them, so that they are quickly made ---------------

MOST = 10**6  # bytes that may be held
MAGIC = b"\x89MCAP0\r\n"
PACKERS: dict[str, Callable[[bytes], bytes]] = {
    "zstd": zstandard.ZstdCompressor().compress,
    "lz4": lz4.frame.compress,
    "": bytes,
}


def text(value: str) -> bytes:
    return struct.pack("<I", len(value)) + value.encode()


def record(kind: int, body: bytes, length: int | None = None) -> bytes:
    """Write a record, which may say that it has another length."""
    return struct.pack("<BQ", kind, len(body) if length is None else length) + body


def schema(length: int = 0) -> bytes:
    return record(3, struct.pack("<H", 1) + text(TYPE) + text("ros2msg") + text("#" * length))


def message(length: int) -> bytes:
    return record(5, struct.pack("<HIQQ", 1, 0, 1, 1) + bytes(length))


def chunk(contents: bytes, packing: str, said: int) -> bytes:
    packed = PACKERS[packing](contents)
    return record(
        6, struct.pack("<QQQI", 1, 2, said, 0) + text(packing) + struct.pack("<Q", len(packed)) + packed
    )


CHANNEL = record(4, struct.pack("<HH", 1, 1) + text("/place") + text("cdr") + text(""))
START = MAGIC + record(1, text("ros2") + text("a test"))


def written(path: Path, data: bytes, *, indexed: int = 0) -> Path:
    """Write a file of some records, with an index that names the first of them so many times, or none."""
    begin = START + schema() + CHANNEL
    body = begin + data + record(15, bytes(4))
    index = struct.pack("<QQQQ", 1, 2, len(begin), len(data)) + bytes(12) + text("") + bytes(16)
    statistics = struct.pack("<QHIIIIQQ", 1, 1, 1, 0, 0, 1, 1, 2) + bytes(4)
    summary = schema() + CHANNEL + record(11, statistics) + record(8, index) * indexed
    footer = record(2, struct.pack("<QQI", len(body) if indexed else 0, 0, 0))
    path.write_bytes(body + (summary if indexed else b"") + footer + MAGIC)
    return path


@pytest.mark.parametrize(
    "layout", [(10, 0), (2**63, 1)], ids=["says less, has no index", "says more, has an index"]
)
@pytest.mark.parametrize("packing", PACKERS)
@pytest.mark.parametrize(
    ("contents", "is_read"),
    [
        (message(16 * MOST), False),
        (message(0) * 3000, False),
        (record(99, bytes(16 * MOST)), True),  # passed over
        (b"".join(chunk(bytes(MOST), "zstd", MOST) for _ in range(20)), True),  # a chunk in a chunk is none
        (record(5, bytes(30), 2**63), False),
        (message(10), True),
    ],
    ids=["a long message", "short messages", "something unknown", "chunks", "a length that lies", "harmless"],
)
def test_what_a_chunk_unpacks_to_is_not_held(  # noqa: PLR0917
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    contents: bytes,
    is_read: bool,
    packing: str,
    layout: tuple[int, int],
) -> None:
    """Whatever it says of itself: it is refused in a sentence, or read without being held."""
    said, indexed = layout
    monkeypatch.setattr(mcap_file, "MOST_AT_ONCE", MOST)
    path = written(tmp_path / "a.mcap", chunk(contents, packing, said), indexed=indexed)
    packed = path.stat().st_size
    if not packing:
        monkeypatch.setattr(mcap_file, "MOST_PACKED", 0)
    tracemalloc.start()
    try:
        if is_read and packed < MOST:
            assert len(list(RecordingFile(path, "drive").messages())) == (contents == message(10))
        else:
            with pytest.raises(TooLargeError, match=r"^drive unpacks to more than the \d+ MB that .*\.$"):
                list(RecordingFile(path, "drive").messages())
        assert tracemalloc.get_traced_memory()[1] < 9 * MOST
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    ("data", "indexed"),
    [
        (chunk(message(MOST // 4), "zstd", 0), 1000),
        (b"".join(chunk(schema(MOST // 8), "zstd", 0) for _ in range(50)), 0),
        (record(6, bytes(40), 2**63), 0),
        (record(3, bytes(40), MOST), 0),
    ],
    ids=["a chunk that the index names again and again", "definitions", "a long chunk", "a long definition"],
)
def test_what_would_fill_the_memory_piece_by_piece_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, data: bytes, indexed: int
) -> None:
    monkeypatch.setattr(mcap_file, "MOST_AT_ONCE", MOST)
    with pytest.raises(TooLargeError):
        list(RecordingFile(written(tmp_path / "a.mcap", data, indexed=indexed)).messages())


@pytest.mark.parametrize(
    "data",
    [record(9, b"", 2**40), record(12, text("a") + b"\xff" * 4), record(3, bytes(2) + b"\xff" * 4)],
    ids=["an attachment", "metadata", "a definition"],
)
def test_a_length_that_the_file_does_not_have_is_where_it_was_cut_off(tmp_path: Path, data: bytes) -> None:
    assert list(RecordingFile(written(tmp_path / "a.mcap", message(8) + data)).messages()) == [
        RecordedMessage("/place", 1, bytes(8))
    ]


def test_an_index_that_names_itself_is_read_once(tmp_path: Path) -> None:
    for start in len(START), 2**63:
        path = tmp_path / "a.mcap"
        path.write_bytes(START + record(15, bytes(4)) + record(2, struct.pack("<QQI", start, 0, 0)) + MAGIC)
        assert RecordingFile(path).topics == {}


def test_what_is_no_file_on_a_disk_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "drive")
    with pytest.raises(ValueError, match=r"^drive is no file on a disk, "):
        RecordingFile(tmp_path / "drive", "drive")
