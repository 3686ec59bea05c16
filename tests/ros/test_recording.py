"""What is recorded is what was published, and is published again as it was."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point, PoseStamped, Twist
from kernels import Kernel
from nav_msgs.msg import Path as Way
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosbags.highlevel import AnyReader
from std_msgs.msg import Header, Int32, String

from deadlines import DEADLINE
from portable_ros2.bags.definitions import definition_text
from portable_ros2.bags.mcap_file import RecordingWriter
from portable_ros2.bags.offers import qos_text, replayed_qos
from ros2lab import Recording, course, environment, read_recording
from ros2lab.recording import Recorder
from ros2lab.recording.subscriptions import Track
from ros2lab.session import LabSession
from ros2lab.widgets.twist_plot import twist_figure
from ros2lab.workspace import Workspace

KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
LOSSY = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)

FLOOD = """
import sys, time, rclpy
from rclpy.qos import QoSProfile
from std_msgs.msg import Int32
rclpy.init()
node = rclpy.create_node("flood")
publisher = node.create_publisher(Int32, "/flood", QoSProfile(depth=10_000))
while not publisher.get_subscription_count():
    time.sleep(0.001)
began = time.monotonic()
for number in range(int(sys.argv[1])):
    publisher.publish(Int32(data=number))
    time.sleep(max(0.0, began + number / 1000 - time.monotonic()))
sys.stdin.read()
"""

LISTENER = """
import json, sys, rclpy
from rclpy.qos import QoSProfile
from std_msgs.msg import Int32, String
rclpy.init()
node = rclpy.create_node("listener")
heard = {"/count": [], "/word": []}
for type_, topic in ((Int32, "/count"), (String, "/word")):
    node.create_subscription(type_, topic, lambda m, t=topic: heard[t].append(m.data), QoSProfile(depth=1000))
while len(heard["/count"]) < int(sys.argv[1]):
    rclpy.spin_once(node)
print(json.dumps(heard))
"""

KILLED = """
import time
from std_msgs.msg import Int32
from ros2lab import LabSession
session = LabSession()
recorder = session.record("killed.mcap")
for number in range(10**6):
    session.publish("/count", Int32(data=number))
    time.sleep(0.002)
"""


class Counter(Node):
    """Publishes numbers on demand."""

    name, topic, qos = "counter", "/count", QoSProfile(depth=1000)

    def __init__(self) -> None:
        super().__init__(self.name)
        self.publisher_ = self.create_publisher(Int32, self.topic, self.qos)

    def say(self, *numbers: int) -> None:
        for number in numbers:
            self.publisher_.publish(Int32(data=number))


class LossyCounter(Counter):
    """Offers best effort on the same topic."""

    name, qos = "lossy_counter", LOSSY


class KeptCounter(Counter):
    """Keeps its last message for late-joining subscribers."""

    name, topic, qos = "kept_counter", "/kept", KEPT


@pytest.fixture(autouse=True)
def work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the student's folder."""
    folder = tmp_path / "work"
    course.open_work_folder(folder)
    monkeypatch.setenv("ROS2LAB_WORK", str(folder))
    return folder


@pytest.fixture
def child() -> Iterator[Callable[..., subprocess.Popen[str]]]:
    """Return what starts a Python program as a process of its own."""
    started: list[subprocess.Popen[str]] = []

    def start(code: str, *arguments: str) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [sys.executable, "-c", code, *arguments],
            env=environment.lab_environment(),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        started.append(process)
        return process

    yield start
    for process in started:
        process.kill()
        process.communicate()


def eventually(condition: Callable[[], Any], what: str) -> None:
    deadline = time.monotonic() + DEADLINE
    while not condition():
        assert time.monotonic() < deadline, f"{what} did not happen"
        time.sleep(0.005)


def seen_by_others(path: Path) -> dict[str, list[Any]]:
    """Read a recording with a library that has nothing in common with the one that wrote it."""
    found: dict[str, list[Any]] = {}
    with AnyReader([path]) as reader:
        for known, _, data in reader.messages():
            found.setdefault(known.topic, []).append(reader.deserialize(data, known.msgtype))
    return found


def numbers(recording: Recording, topic: str = "/count") -> list[int]:
    return [sample.message.data for sample in recording[topic]]


def written(path: Path, *seconds: float, topic: str = "/count", kind: str = "std_msgs/msg/Int32") -> Path:
    """Write a recording of the numbers 0, 1, ... at these times."""
    definition = (
        definition_text(kind) if kind in ("std_msgs/msg/Int32", "rcl_interfaces/msg/Log") else "int32 data\n"
    )
    with path.open("wb") as stream:
        writer = RecordingWriter(stream)
        channel = writer.add_topic(topic, kind, definition, offered_qos=qos_text([KEPT]))
        for number, second in enumerate(seconds):
            moment = 10**18 + round(second * 1e9)
            data = b"\x00\x01\x00\x00" + number.to_bytes(4, "little")
            writer.add(channel, data, received=moment, published=moment)
        writer.finish()
    return path


# ---- recording ------------------------------------------------------------------------------------------


def test_the_reference_robot_is_recorded_as_another_library_reads_it(
    session: LabSession, work: Path, tmp_path: Path
) -> None:
    """Three nodes in processes of their own, one of them with a topic for late-joining subscribers."""
    workspace = Workspace(course.copy_reference(tmp_path, has_tests=False))
    assert workspace.build(show=False).is_ok
    with session.record("drive.mcap") as recorder:
        for executable in workspace.executables("robot_controller"):
            session.start_process("robot_controller", executable.name, workspace=workspace)
        session.wait_for_subscribers("/robot/command", 1, DEADLINE)
        session.publish("/robot/command", "start")
        eventually(lambda: recorder.counts.get("/cmd_vel", 0) >= 20, "twenty velocities")
        eventually(lambda: recorder.counts.get("/robot/status", 0) >= 2, "two statuses")
        session.publish("/robot/command", "stop")
        eventually(lambda: recorder.counts.get("/robot/command", 0) >= 2, "two commands")
    assert recorder.problems == []
    recording, others = read_recording("drive.mcap"), seen_by_others(work / "drive.mcap")
    assert recording.is_whole
    assert {topic: len(samples) for topic, samples in recording.items() if samples} == {
        topic: len(messages) for topic, messages in others.items()
    }
    for topic in ("/robot/command", "/robot/status"):
        assert [sample.message for sample in recording[topic]] == [
            String(data=message.data) for message in others[topic]
        ]
    assert [sample.message.data for sample in recording["/robot/command"]] == ["start", "stop"]
    velocities = [(sample.message.linear.x, sample.message.angular.z) for sample in recording["/cmd_vel"]]
    assert velocities == [(message.linear.x, message.angular.z) for message in others["/cmd_vel"]]
    assert any(linear for linear, _ in velocities)
    assert twist_figure(*recording.columns("/cmd_vel", "linear.x", "angular.z"))


def test_the_offers_of_a_publisher_are_kept(session: LabSession, work: Path) -> None:
    node = session.run(KeptCounter)
    node.say(7)
    with session.record("a.mcap", "/kept") as recorder:
        eventually(lambda: recorder.count, "the message that was published before")
    with AnyReader([work / "a.mcap"]) as reader:
        (known,) = reader.connections
    (offer,) = known.ext.offered_qos_profiles  # type: ignore[union-attr]
    assert (offer.reliability.name, offer.durability.name) == ("RELIABLE", "TRANSIENT_LOCAL")
    assert numbers(read_recording("a.mcap"), "/kept") == [7]


def test_nested_types_come_back_equal(session: LabSession, work: Path) -> None:
    way = Way(header=Header(stamp=Time(sec=3, nanosec=4), frame_id="map"))
    for step in range(3):
        pose = PoseStamped(header=Header(frame_id=f"pose {step}"))
        pose.pose.position = Point(x=step / 3, y=-1.5, z=0.0)
        way.poses.append(pose)
    with session.record("a.mcap", ["way"]) as recorder:
        session.publish("/way", way)
        eventually(lambda: recorder.count, "the message")
    assert [sample.message for sample in read_recording("a.mcap")["/way"]] == [way]
    (other,) = seen_by_others(work / "a.mcap")["/way"]
    assert [(pose.header.frame_id, pose.pose.position.x) for pose in other.poses] == [
        (pose.header.frame_id, pose.pose.position.x) for pose in way.poses
    ]


def test_a_topic_that_appears_later_is_recorded(session: LabSession) -> None:
    """What a publisher keeps for late-joining subscribers is not even missing its beginning."""
    with session.record("a.mcap") as recorder:
        session.run(KeptCounter).say(1)
        eventually(lambda: recorder.counts.get("/kept"), "the kept message")
    assert numbers(read_recording("a.mcap"), "/kept") == [1]


def test_only_the_topics_asked_for_are_recorded(session: LabSession) -> None:
    counter, kept = session.run(Counter), session.run(KeptCounter)
    with session.record("a.mcap", ["/count"]) as recorder:
        kept.say(1)
        counter.say(2)
        eventually(lambda: recorder.count, "the message")
    assert list(read_recording("a.mcap")) == ["/count"]


def test_a_publisher_that_offers_less_than_the_first_one_is_recorded_too(session: LabSession) -> None:
    session.run(Counter)
    with session.record("a.mcap", "/count") as recorder:
        lossy = session.run(LossyCounter)

        def is_recorded() -> bool:
            lossy.say(5)
            return bool(recorder.count)

        eventually(is_recorded, "a message of the second publisher")


def test_a_flood_of_1_khz_loses_nothing(session: LabSession, child: Any) -> None:
    child(FLOOD, "3000")
    with session.record("flood.mcap", "/flood") as recorder:
        eventually(lambda: recorder.count >= 3000, "the end of the flood")
        assert (recorder.dropped, recorder.missed) == (0, 0)
    assert numbers(read_recording("flood.mcap"), "/flood") == list(range(3000))


def test_a_callback_that_takes_its_time_loses_nothing(session: LabSession) -> None:
    """While a node blocks the ROS thread, more comes than ROS would hold for a subscription."""
    counter = session.run(Counter)
    is_blocked, is_over = threading.Event(), threading.Event()

    class Blocker(Node):
        def __init__(self) -> None:
            super().__init__("blocker")
            self.create_timer(0.001, self.block)

        def block(self) -> None:
            is_blocked.set()
            is_over.wait(DEADLINE)

    try:
        with session.record("a.mcap", "/count") as recorder:
            session.run(Blocker)
            assert is_blocked.wait(DEADLINE)
            for start in range(0, 3000, 500):
                counter.say(*range(start, start + 500))
                eventually(lambda end=start + 500: recorder.count == end, "what came meanwhile")  # type: ignore[misc]
    finally:
        is_over.set()
    assert numbers(read_recording("a.mcap")) == list(range(3000))


def test_what_the_buffer_cannot_hold_is_counted_and_said(
    session: LabSession, work: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    counter = session.run(Counter)
    with Recorder(session.node, work / "a.mcap", ["/count"], most_waiting=0) as recorder:
        counter.say(1, 2, 3)
        eventually(lambda: recorder.dropped == 3, "three messages to be dropped")
    recorder.stop()
    told = "~/a.mcap: 3 messages came faster than they could be written, and are not in the file; "
    assert capsys.readouterr().out == f"{told}record fewer topics.\n"
    assert read_recording("a.mcap").count == 0


class Offer:
    """What the graph says of a publisher, as far as a track asks."""

    topic_type, topic_type_hash, qos_profile = "std_msgs/msg/Int32", "RIHS01_", KEPT


def test_missing_numbers_tell_what_never_came() -> None:
    """But not while publishers change, whose numbers have nothing to do with each other."""
    track = Track("/count", [Offer()])
    track.met({b"a"})
    for sequence in (5, 6, 9):
        track.note(sequence)
    track.met({b"a"})
    assert track.missed == 2
    for sequence in (10, 1, 11, 2):
        track.note(sequence)
    track.met({b"a", b"b"})
    track.note(50)
    track.met({b"b"})
    track.note(90)
    track.met({b"b"})
    assert track.missed == 2


def test_a_killed_recorder_leaves_a_file_that_is_read_up_to_there(work: Path, child: Any) -> None:
    process = child(KILLED)

    def is_begun() -> bool:
        try:
            return read_recording("killed.mcap").count >= 100
        except (FileNotFoundError, ValueError):
            return False

    eventually(is_begun, "a hundred messages on disk")
    process.send_signal(signal.SIGKILL)
    process.wait(DEADLINE)
    recording = read_recording("killed.mcap")
    assert not recording.is_whole
    assert "it was cut off, and this is what was saved until then" in str(recording)
    found = numbers(recording)
    assert len(found) >= 100
    assert found == list(range(found[0], found[0] + len(found)))


def test_a_full_disk_ends_the_recording_with_a_sentence(
    session: LabSession, work: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    counter = session.run(Counter)
    monkeypatch.setattr("ros2lab.recording.recorder.new_file", _full_disk)
    monkeypatch.setattr(RecordingWriter, "__init__", _without_flush)
    with session.record("a.mcap", "/count") as recorder:
        counter.say(1)
        eventually(lambda: not recorder.is_recording, "the end of the recording")
    said = "The recording ended early: No space left on device."
    assert recorder.failure == said
    assert capsys.readouterr().out == f"~/a.mcap: {said}\n"


def _full_disk(path: Path) -> Any:
    return Path("/dev/full").open("wb", buffering=10**6)


def _without_flush(self: Any, stream: Any, **_: str) -> None:
    """Begin as on a disk that is full only later."""
    from mcap.writer import Writer

    self._writer, self._schemas = Writer(stream), {}
    self._writer.start("ros2")


def test_an_existing_file_is_kept(
    session: LabSession, work: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Also the one of a recorder whose cell runs again: it is ended first."""
    (work / "a.mcap").write_text("mine")
    first = session.record("~/a.mcap")
    assert (work / "earlier" / "a.mcap-1").read_text() == "mine"
    second = session.record("a.mcap")
    assert not first.is_recording
    assert second.is_recording
    assert read_recording(work / "earlier" / "a.mcap-2").is_whole
    assert capsys.readouterr().out == (
        "The earlier a.mcap is kept as ~/earlier/a.mcap-1.\nThe earlier a.mcap is kept as ~/earlier/a.mcap-2.\n"
    )


def test_a_folder_is_not_written_over(session: LabSession, work: Path) -> None:
    (work / "drive").mkdir()
    with pytest.raises(ValueError, match=r"~/drive is a folder; name a file, such as drive.mcap."):
        session.record("drive")


def test_it_ends_with_the_session_and_twice_does_no_harm(domain_id: int) -> None:
    with LabSession(domain_id=domain_id) as session:
        recorder = session.record("a.mcap")
        session.publish("/word", "last")
    assert not recorder.is_recording
    recorder.stop()
    recording = read_recording("a.mcap")
    assert recording.is_whole
    assert [sample.message.data for sample in recording["/word"]] == ["last"]


def test_an_interrupted_cell_ends_it_and_the_file_is_whole(work: Path) -> None:
    kernel = Kernel(work, "08_drive_the_robot.ipynb")
    try:
        kernel.run("from ros2lab import LabSession, read_recording; import time; session = LabSession()")
        code = "with session.record('a.mcap'):\n  session.publish('/w', 'x'); print('go'); time.sleep(600)"
        kernel.interrupt(code, when="go")
        assert kernel.run("print(read_recording('a.mcap').is_whole)") == "True\n"
    finally:
        kernel.close()


def test_it_says_what_it_does(session: LabSession) -> None:
    with session.record("a.mcap", "/word") as recorder:
        session.publish("/word", "x")
        eventually(lambda: recorder.count, "the message")
        assert repr(recorder) == "Recorder('~/a.mcap', recording, 1 message)"
        assert re.fullmatch(r"~/a.mcap: recording, 1 message, \d+\.\d s\.", recorder.headline)
    assert "recorded, 1 message" in str(recorder)
    assert '<td style="text-align:left">std_msgs/msg/String</td>' in recorder._repr_html_()


# ---- reading --------------------------------------------------------------------------------------------


def test_a_recording_says_what_it_holds(work: Path) -> None:
    written(work / "a.mcap", 0.0, 0.5, 2.5)
    recording = read_recording("a.mcap")
    assert repr(recording) == "Recording('~/a.mcap', 1 topic, 3 messages, 2.5 s)"
    assert re.fullmatch(
        r"~/a.mcap: 3 messages, 2.5 s, [\d.]+ kB\ntopic +type +messages\n/count +std_msgs/msg/Int32 +3",
        str(recording),
    )
    assert '<th scope="row" style="text-align:left">/count</th>' in recording._repr_html_()
    assert recording.columns("/count", "data") == ([0.0, 0.5, 2.5], [0, 1, 2])
    with pytest.raises(KeyError, match=r"~/a.mcap holds no topic /cuont; did you mean /count\?"):
        recording["/cuont"]


def test_a_missing_file_names_those_that_are_there(work: Path) -> None:
    written(work / "a.mcap", 0.0)
    with pytest.raises(FileNotFoundError, match=r"There is no file ~/b.mcap; in ~ there are: a.mcap."):
        read_recording("b.mcap")


def test_a_type_that_is_not_installed_is_read_by_the_definition_in_the_file(work: Path) -> None:
    written(work / "a.mcap", 0.0, 1.0, kind="pond/msg/Duck")
    assert read_recording("a.mcap").columns("/count", "data") == ([0.0, 1.0], [0, 1])


def test_a_type_with_other_fields_is_read_as_it_was_recorded_and_not_replayed(
    session: LabSession, work: Path
) -> None:
    """The bytes would be taken for something else."""
    written(work / "a.mcap", 0.0, 1.0, kind="std_msgs/msg/Int64")
    assert read_recording("a.mcap").columns("/count", "data") == ([0.0, 1.0], [0, 1])
    sentence = "/count is not replayed: std_msgs/msg/Int64 has other fields here than where it was recorded."
    with pytest.raises(ValueError, match=sentence):
        session.replay("a.mcap")


# ---- replaying ------------------------------------------------------------------------------------------


def test_another_process_hears_a_replay_in_order(session: LabSession, child: Any) -> None:
    """At ten times the speed, every message and in the order in which it was published."""
    counter = session.run(Counter)
    with session.record("a.mcap", ["/count", "/word"]) as recorder:
        for number in range(0, 300, 3):
            counter.say(number, number + 1, number + 2)
            time.sleep(0.01)  # a rhythm, on which nothing is asserted
        session.publish("/word", "last")
        eventually(lambda: recorder.count == 301, "all messages")
    session.stop(counter)
    listener = child(LISTENER, "300")
    session.wait_for_subscribers("/count", 1, DEADLINE)
    session.wait_for_subscribers("/word", 1, DEADLINE)
    with session.replay("a.mcap", rate=10) as replay:
        replay.wait(DEADLINE)
        assert replay.count == 301
        out, _ = listener.communicate(timeout=DEADLINE)
    assert json.loads(out)["/count"] == list(range(300))


def test_a_late_joining_subscriber_gets_what_the_recorded_one_got(session: LabSession, work: Path) -> None:
    """The offers of the recorded publisher hold for the replay."""
    written(work / "a.mcap", 0.0, 3600.0)
    with session.replay("a.mcap") as replay:
        eventually(lambda: replay.count == 1, "the first message")
        log = session.log("/count", Int32, qos=KEPT)
        assert [sample.message.data for sample in log.wait_for(1, DEADLINE)] == [0]


def test_a_replay_pauses_seeks_and_goes_on(session: LabSession, work: Path) -> None:
    written(work / "a.mcap", 0.0, 1000.0, 2000.0, 3000.0)
    log = session.log("/count", Int32)
    with session.replay("a.mcap") as replay:
        log.wait_until(lambda message: message.data == 0, DEADLINE)
        replay.pause()
        replay.seek(2000.0)
        assert not replay.is_playing
        assert replay.position == 2000.0
        assert repr(replay) == "Replay('~/a.mcap', paused, 2000.0 of 3000.0 s, 1 times as fast)"
        replay.resume()
        log.wait_until(lambda message: message.data == 2, DEADLINE)
        replay.rate = 100
        replay.seek(999.9)
        log.wait_until(lambda message: message.data == 1, DEADLINE)
        replay.seek(3000.0)
        replay.wait(DEADLINE)
        assert replay.has_ended
        with pytest.raises(RuntimeError, match="This replay has ended"):
            replay.seek(0.0)
        with pytest.raises(ValueError, match=r"3000.0 s long; 3001 s is not within it."):
            replay.seek(3001.0)
    eventually(lambda: log.count == 4, "the last message")
    assert [sample.message.data for sample in log.samples()] == [0, 2, 1, 3]


def test_a_looped_replay_begins_again_until_it_is_stopped(session: LabSession, work: Path) -> None:
    written(work / "a.mcap", 0.0, 0.1, 0.2)
    log = session.log("/count", Int32)
    with session.replay("a.mcap", rate=10, loop=True) as replay:
        samples = log.wait_for(7, DEADLINE)
    assert [sample.message.data for sample in samples[:7]] == [0, 1, 2, 0, 1, 2, 0]
    replay.stop()
    assert replay.has_ended


def test_a_wait_says_how_far_it_is(session: LabSession, work: Path) -> None:
    written(work / "a.mcap", 0.0, 1000.0)
    with session.replay("a.mcap") as replay, pytest.raises(TimeoutError, match=r"of 1000.0 s after 0.01 s"):
        replay.wait(0.01)


def test_two_drivers_are_named(session: LabSession, work: Path, capsys: pytest.CaptureFixture[str]) -> None:
    session.run(Counter)
    written(work / "a.mcap", 0.0)
    eventually(lambda: session.node.count_publishers("/count"), "the publisher in the graph")
    session.replay("a.mcap").wait(DEADLINE)
    assert capsys.readouterr().out == (
        "counter publishes on /count, too, so its subscribers receive both: stop it, or leave the topic out "
        "with topics=[...].\n"
    )


def test_everyones_topics_are_replayed_only_if_they_are_named(session: LabSession, work: Path) -> None:
    written(work / "a.mcap", 0.0, topic="/rosout", kind="rcl_interfaces/msg/Log")
    with pytest.raises(ValueError, match=r"~/a.mcap holds no messages to replay."):
        session.replay("a.mcap")
    with session.replay("a.mcap", topics="/rosout") as replay:
        assert replay.topics == ["/rosout"]


def test_what_cannot_be_replayed_is_said_in_a_sentence(session: LabSession, work: Path) -> None:
    written(work / "a.mcap", 0.0)
    written(work / "duck.mcap", 0.0, kind="pond/msg/Duck")
    (work / "text.mcap").write_text("hello, this is no recording")
    for path, options, sentence in (
        ("a.mcap", {"rate": 1000}, "The rate must be from 0.1 to 100 times the recorded speed, not 1000."),
        ("a.mcap", {"topics": ["/cuont"]}, "~/a.mcap holds no topic /cuont; did you mean /count?"),
        ("duck.mcap", {}, "/count is not replayed: The message type 'pond/msg/Duck' cannot be imported"),
        ("text.mcap", {}, "~/text.mcap is not a recording"),
    ):
        with pytest.raises(ValueError, match=re.escape(sentence)):
            session.replay(path, **options)  # type: ignore[arg-type]
    with session.record("b.mcap"), pytest.raises(ValueError, match=r"~/b.mcap is still being recorded"):
        session.replay("b.mcap")


@pytest.mark.parametrize("offers", [[KEPT], [KEPT, QoSProfile(depth=10)], [LOSSY], [LOSSY, KEPT], []])
def test_a_replay_serves_whom_the_recorded_publishers_served(offers: list[QoSProfile]) -> None:
    """The words are those of Jazzy, the numbers those of earlier versions."""
    text = qos_text(offers)
    numbered = text
    for policy, value in (("transient_local", 1), ("volatile", 2), ("reliable", 1), ("best_effort", 2)):
        numbered = numbered.replace(policy, str(value))
    for written_ in (text, numbered):
        qos = replayed_qos(written_)
        is_lossy = bool(offers) and all(offer is LOSSY for offer in offers)
        assert (qos.reliability == ReliabilityPolicy.BEST_EFFORT) == is_lossy
        assert (qos.durability == DurabilityPolicy.TRANSIENT_LOCAL) == (KEPT in offers)


# ---- the command ----------------------------------------------------------------------------------------


def test_the_command_records_until_ctrl_c_and_replays(session: LabSession, work: Path) -> None:
    environ = {**environment.lab_environment(), "ROS2LAB_WORK": str(work)}
    command = [str(Path(sys.executable).with_name("ros2lab"))]
    session.publish("/cmd_vel", Twist())
    recording = subprocess.Popen(
        [*command, "record", "/cmd_vel", "-o", "drive.mcap"],
        cwd=work,
        env=environ,
        text=True,
        stdout=subprocess.PIPE,
    )
    try:
        eventually(
            lambda: (work / "drive.mcap").exists() and _count(work / "drive.mcap"), "the first message"
        )
        recording.send_signal(signal.SIGINT)
        out, _ = recording.communicate(timeout=DEADLINE)
    finally:
        recording.kill()
        recording.communicate()
    assert recording.returncode == 0
    assert "/cmd_vel  geometry_msgs/msg/Twist" in out
    assert read_recording("drive.mcap").is_whole
    played = subprocess.run(
        [*command, "replay", "drive.mcap"], cwd=work, env=environ, capture_output=True, text=True, check=False
    )
    assert (played.returncode, played.stderr) == (0, "")
    assert "~/drive.mcap: 1 messages published" in played.stdout
    missing = subprocess.run(
        [*command, "replay", "none.mcap"], cwd=work, env=environ, capture_output=True, text=True, check=False
    )
    assert missing.returncode == 1
    assert (
        missing.stderr == "Nothing is replayed: There is no file ~/none.mcap; in ~ there are: drive.mcap.\n"
    )


def _count(path: Path) -> int:
    try:
        return read_recording(path).count
    except ValueError:
        return 0
