"""`ros2 bag`, with real nodes; what it writes is read by another library."""

from __future__ import annotations

import re
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosbags.highlevel import AnyReader
from running import Running, until
from std_msgs.msg import Int32, String

from portable_ros2.bags.bag import LONGEST, open_bag
from portable_ros2.bags.mcap_file import RecordingFile, RecordingWriter
from portable_ros2.bags.offers import REPLAYED_DEPTH, replayed_qos
from portable_ros2.commands.bag import _bags

Ros2 = Callable[..., "subprocess.CompletedProcess[str]"]
Started = Callable[..., Running]
DEFINITION = "string data\n"
ERROR = "[ERROR] [ros2bag]: "


def test_what_is_recorded_is_shown_and_played(
    node: Node, started: Started, ros2: Ros2, tmp_path: Path
) -> None:
    kept = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    words, numbers = (
        node.create_publisher(String, "/words", kept),
        node.create_publisher(Int32, "/numbers", 10),
    )
    words.publish(String(data="early"))
    bag = tmp_path / "bag"
    recording = started("bag", "record", "-o", str(bag), "/words", "/numbers")
    until(lambda: words.get_subscription_count() and numbers.get_subscription_count(), "subscriptions")
    for number in range(3):
        numbers.publish(Int32(data=number))
    (file,) = bag.glob("*.mcap")
    until(lambda: sum(topic.count for topic in RecordingFile(file).topics.values()) == 4, "all to be flushed")
    assert recording.end() == 0
    assert "Subscribed to topic '/words'" in recording.errors
    assert recording.errors.rstrip().endswith("[rosbag2_recorder]: Recording stopped")

    with AnyReader([bag]) as reader:
        assert {(found.topic, found.msgtype, found.msgcount) for found in reader.connections} == {
            ("/words", "std_msgs/msg/String", 1),
            ("/numbers", "std_msgs/msg/Int32", 3),
        }
    shown = ros2("bag", "info", str(bag)).stdout
    assert "\nFiles:             bag_0.mcap\n" in shown
    assert "\nMessages:          4\n" in shown
    assert "Topic: /words | Type: std_msgs/msg/String | Count: 1 | Serialization Format: cdr\n" in shown

    heard: list[int] = []
    node.create_subscription(Int32, "/played", lambda message: heard.append(message.data), 10)
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    played = started("bag", "play", str(bag), "--topics", "/numbers", "-m", "/numbers:=/played", "-r", "10")

    def has_heard_all() -> bool:
        executor.spin_once(timeout_sec=0.05)
        return heard == [0, 1, 2]

    until(has_heard_all, "three numbers")
    executor.shutdown()
    assert played.process.wait() == 0


def recorded(folder: Path, *names: str, is_whole: bool = True) -> Path:
    """Return a bag with a message on each of some topics, one second apart."""
    folder.mkdir()
    with (folder / "a_0.mcap").open("wb") as stream:
        writer = RecordingWriter(stream)
        for number, name in enumerate(names):
            channel = writer.add_topic(name, "std_msgs/msg/String", DEFINITION)
            writer.add(channel, bytes(12), received=(5 + number) * 10**9, published=1)
        writer.flush()
        if is_whole:
            writer.finish()
    return folder


def test_a_folder_without_metadata_and_a_file_are_bags_too(ros2: Ros2, tmp_path: Path) -> None:
    bag = recorded(tmp_path / "bag", "/a", "/b", is_whole=False)
    for path in (bag, bag / "a_0.mcap"):
        assert ros2("bag", "info", "-t", str(path)).stdout == "/a\n/b\n"
    shown = ros2("bag", "info", str(bag), TZ="UTC").stdout
    assert re.search(r"^Duration:          1\.000000000s$", shown, re.MULTILINE)
    assert "Start:             Jan  1 1970 00:00:05.000000000 (5.000000000)\n" in shown


def test_a_damaged_bag_is_told_in_a_sentence(tmp_path: Path) -> None:
    """Wherever a byte has changed."""
    (file,) = recorded(tmp_path / "bag", "/a", "/b").glob("*.mcap")
    data, told = file.read_bytes(), []
    for place in range(8, len(data), 5):
        file.write_bytes(data[:place] + bytes([data[place] ^ 0xFF]) + data[place + 1 :])
        try:
            bag = open_bag(file.parent)
            assert len(list(bag.messages(list(bag.topics)))) <= 2
        except RuntimeError as error:
            told.append(str(error))
    assert len(told) > 5
    assert all("cannot be read" in text for text in told)


@pytest.mark.thorough
def test_what_cannot_be_read_or_written_is_one_sentence(ros2: Ros2, tmp_path: Path) -> None:
    bag = recorded(tmp_path / "bag", "/a")
    (tmp_path / "empty").mkdir()
    (tmp_path / "db").mkdir()
    (tmp_path / "db" / "metadata.yaml").write_text(
        "rosbag2_bagfile_information: {storage_identifier: sqlite3}\n"
    )
    for words, said in (
        (
            ("info", "empty"),
            "The folder 'empty' is no bag: there is no metadata.yaml and no .mcap file in it.\n",
        ),
        (("info", "db"), "The bag 'db' is stored as sqlite3, and only mcap can be read here"),
        (("play", str(bag), "--topics", "/no"), f"The bag '{bag}' has no topic /no\n"),
        (("play", str(bag), "-m", "a"), "The remapping 'a' is not of the form old_topic:=new_topic\n"),
        (("play", str(bag), "-e", "("), "The regular expression is not valid: "),
        (("record",), f"{ERROR}Need to specify at least one option out of --all, --all-topics, --topics"),
        (("record", "-a", "-o", str(bag)), f"{ERROR}Output folder '{bag}' already exists.\n"),
        (("record", "-a", "-o", "/proc/no/bag"), f"{ERROR}Could not create bag folder '/proc/no/bag'"),
    ):
        result = ros2("bag", *words)
        assert result.returncode == 1, words
        assert result.stderr.startswith(said), words
    assert "Bag path 'nowhere' does not exist!" in ros2("bag", "info", "nowhere").stderr


def test_the_library_is_named_where_it_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    with pytest.raises(RuntimeError, match=r"pip install 'portable_ros2\[bag\]'"):
        _bags.check_library()


@pytest.mark.thorough
def test_a_recording_with_all_topics_ends_whole_by_a_termination(started: Started, tmp_path: Path) -> None:
    recording = started("bag", "record", "-a", "-o", str(tmp_path / "bag"))
    until(lambda: "Recording..." in recording.errors, "the recorder")
    assert recording.end(signal.SIGTERM) == signal.SIGTERM
    with AnyReader([tmp_path / "bag"]) as reader:
        assert "/rosout" in {found.topic for found in reader.connections}


HOSTILE = {
    "aliases": "- &a [x, x]\n- &b [*a, *a]\n- {reliability: *b}\n",
    "deep": "[" * 1000,
    "long": "- {reliability: " + "x" * 200_000 + "}",
    "no day": "- {reliability: 2001-02-31}",
    "a depth that nobody has": "- {durability: transient_local, depth: 100000000000}",
    "a negative depth": "- {durability: transient_local, depth: -5}",
}


@pytest.mark.parametrize("offered", HOSTILE.values(), ids=HOSTILE)
def test_a_topic_with_a_quality_of_service_that_nobody_offers_is_played_with_one_that_serves(
    offered: str,
) -> None:
    assert 1 <= replayed_qos(offered).depth <= REPLAYED_DEPTH


@pytest.mark.parametrize(
    "metadata",
    [b"rosbag2_bagfile_information: {x: &a [1], ros_distro: *a}", b"[" * 1000, b"#" * (LONGEST + 1), b"\xff"],
    ids=["aliases", "deep", "long", "not UTF-8"],
)
def test_metadata_that_no_recorder_writes_are_refused_in_a_sentence(tmp_path: Path, metadata: bytes) -> None:
    recorded(tmp_path / "bag", "/words")
    (tmp_path / "bag/metadata.yaml").write_bytes(metadata)
    with pytest.raises(RuntimeError, match="cannot be read: "):
        open_bag(tmp_path / "bag")


def test_a_topic_that_ros_would_not_call_so_is_left_out(ros2: Ros2, tmp_path: Path) -> None:
    bag = recorded(tmp_path / "bag", "/words", "/no word")
    result = ros2("bag", "play", "--clock", "10", str(bag))
    assert result.returncode == 0
    assert "Ignoring a topic '/no word', reason: Invalid topic name: " in result.stderr
    assert "Traceback" not in result.stderr
