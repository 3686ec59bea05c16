"""`ros2 topic`: real processes that hear each other by DDS."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile, qos_profile_sensor_data
from running import COMMAND, Running, until
from sensor_msgs.msg import Imu, JointState
from std_msgs.msg import Empty, Int32, Int64, String

from deadlines import DEADLINE
from portable_ros2.commands.topic import bw, delay, echo, hz

Ros2 = Callable[..., "subprocess.CompletedProcess[str]"]
KEPT = QoSProfile(depth=1, durability=rclpy.qos.DurabilityPolicy.TRANSIENT_LOCAL)
WARNING = "WARNING: topic [/nothing] does not appear to be published yet\n"


Started = Callable[..., Running]


def matched(publisher: Any) -> None:
    until(publisher.get_subscription_count, "a subscription")


def kept(node: Node, topic: str, message: Any) -> None:
    """Publish a message that who comes later still gets; `echo` finds that out by itself."""
    node.create_publisher(type(message), topic, KEPT).publish(message)


# --- Looking at the graph


@pytest.fixture
def graph(node: Node) -> Node:
    for message_class, topic in (
        (String, "/words"),
        (String, "/more"),
        (Int32, "/_secret"),
        (Twist, "/ns/move"),
    ):
        node.create_publisher(message_class, topic, 10)
    node.create_publisher(String, "/words", qos_profile_sensor_data)
    node.create_subscription(Int32, "/numbers", lambda _: None, 10)
    return node


def test_list_names_the_topics(graph: Node, ros2: Ros2) -> None:
    known = ["/more", "/ns/move", "/numbers", "/parameter_events", "/rosout", "/words"]
    assert ros2("topic", "list").stdout.splitlines() == known
    hidden = ros2("topic", "list", "--include-hidden-topics").stdout.splitlines()
    assert set(hidden) - set(known) == {"/_secret"}
    assert ros2("topic", "list", "-c").stdout == "6\n"


def test_list_shows_types_and_who_is_there(graph: Node, ros2: Ros2) -> None:
    shown = ros2("topic", "list", "-t").stdout.splitlines()
    assert "/ns/move [geometry_msgs/msg/Twist]" in shown
    assert "/numbers [std_msgs/msg/Int32]" in shown
    published, subscribed = ros2("topic", "list", "-v").stdout.split("\n\n", 1)
    assert published.startswith("Published topics:\n * /more [std_msgs/msg/String] 1 publisher\n")
    assert published.endswith(" * /words [std_msgs/msg/String] 2 publishers")
    assert subscribed == "Subscribed topics:\n * /numbers [std_msgs/msg/Int32] 1 subscriber\n\n"


def test_type_and_find(graph: Node, ros2: Ros2) -> None:
    assert ros2("topic", "type", "/numbers").stdout == "std_msgs/msg/Int32\n"
    assert ros2("topic", "--include-hidden-topics", "type", "/_secret").stdout == "std_msgs/msg/Int32\n"
    for unknown in ("/_secret", "/nothing", "words"):
        done = ros2("topic", "type", unknown)
        assert (done.returncode, done.stdout, done.stderr) == (1, "", "")
    assert ros2("topic", "find", "std_msgs/msg/String").stdout == "/more\n/words\n"
    assert ros2("topic", "find", "-c", "std_msgs/msg/Int32", "--include-hidden-topics").stdout == "2\n"
    done = ros2("topic", "find", "std_msgs/String")
    assert (done.returncode, done.stdout) == (0, "")


def test_info_tells_who_is_there(graph: Node, ros2: Ros2) -> None:
    short = ros2("topic", "info", "/words").stdout
    assert short == "Type: std_msgs/msg/String\nPublisher count: 2\nSubscription count: 0\n"
    done = ros2("topic", "info", "/nothing")
    assert (done.returncode, done.stdout, done.stderr) == (1, "", "Unknown topic '/nothing'\n")


def test_info_tells_the_quality_of_service_of_each(graph: Node, ros2: Ros2) -> None:
    parts = ros2("topic", "info", "-v", "/words").stdout.split("\n\n")
    assert parts[:2] == ["Type: std_msgs/msg/String", "Publisher count: 2"]
    assert parts[-2:] == ["Subscription count: 0", ""]
    assert all(part.startswith("Node name: talker\nNode namespace: /ns\nTopic type: ") for part in parts[2:4])
    assert sorted(re.findall(r"Reliability: (\w+)", "".join(parts))) == ["BEST_EFFORT", "RELIABLE"]


# --- Echo


@pytest.mark.parametrize(
    ("words", "shown"),
    [
        ((), "data: hi\n---\n"),
        (("std_msgs/msg/String",), "data: hi\n---\n"),
        (("--no-str",), "data: '<string length: <2>>'\n---\n"),
        (("--csv",), "hi\n"),
        (("--field", "data"), "hi\n---\n"),
        (("--raw",), "b'\\x00\\x01\\x00\\x00\\x03\\x00\\x00\\x00hi\\x00\\x00'\n---\n"),
        (("--filter", "m.data == 'hi'"), "data: hi\n---\n"),
    ],
)
def test_echo_shows_a_message(node: Node, ros2: Ros2, words: tuple[str, ...], shown: str) -> None:
    """It asks for the kept message, because the publisher offers it."""
    kept(node, "/words", String(data="hi"))
    done = ros2("topic", "echo", "/words", *words, "--once")
    assert (done.returncode, done.stdout, done.stderr) == (0, shown, "")


@pytest.mark.parametrize("words", [("--filter", "False"), ("--qos-durability", "volatile", "--once")])
def test_echo_ends_in_time_without_a_message(node: Node, ros2: Ros2, words: tuple[str, ...]) -> None:
    kept(node, "/words", String(data="hi"))
    done = ros2("topic", "echo", "/words", *words, "--timeout", "0.5")
    assert (done.returncode, done.stdout) == (0, "")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("/nothing",), "Could not determine the type for the passed topic"),
        (("/words", "std_msg/String"), "The passed message type is invalid: there is no package 'std_msg'"),
        (("/words", "--field", "text"), "Invalid field 'text': no field 'text' there; there are data"),
        (("/words", "--field", "data.x"), "Invalid field 'data.x': no field 'x' there; there are none"),
        (("/words", "--field", "data[0]"), "Invalid field 'data[0]': no field '0' there; there are none"),
        (("/words", "--field", "."), "Invalid field value '.'"),
        (("/words", "--field", "data", "--raw"), "--field needs a message"),
        (("/words", "--filter", "m.text"), "The filter 'm.text' failed: AttributeError"),
        (("/words", "--filter", "1 +"), "The filter '1 +' is no Python expression"),
        (("no/../name",), "topic name 'no/../name' is invalid"),
    ],
)
def test_echo_says_what_is_wrong(node: Node, ros2: Ros2, words: tuple[str, ...], message: str) -> None:
    kept(node, "/words", String(data="hi"))
    done = ros2("topic", "echo", *words)
    assert done.returncode == 1
    assert done.stderr.startswith(message)
    assert "Traceback" not in done.stderr
    assert done.stdout == (WARNING if words == ("/nothing",) else "")


def test_a_topic_with_two_types_is_not_guessed(started: Started, ros2: Ros2) -> None:
    for type_name in ("std_msgs/msg/Int32", "std_msgs/msg/String"):
        started("topic", "pub", "/mixed", type_name, "-p", "0").wait_for("beginning loop")
    types = "std_msgs/msg/Int32, std_msgs/msg/String"
    done = ros2("topic", "echo", "/mixed")
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == f"Cannot echo topic '/mixed', as it contains more than one type: [{types}]\n"
    assert ros2("topic", "info", "/mixed").stdout.startswith(
        "Type: ['std_msgs/msg/Int32', 'std_msgs/msg/String']\n"
    )


def test_a_type_that_is_not_installed_is_told(node: Node, ros2: Ros2, tmp_path: Path) -> None:
    kept(node, "/words", String())
    (tmp_path / "std_msgs").mkdir()
    (tmp_path / "std_msgs" / "__init__.py").touch()
    done = ros2("topic", "echo", "/words", PYTHONPATH=str(tmp_path))
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == (
        "The message type 'std_msgs/msg/String' is invalid: the package 'std_msgs' has nothing of the kind 'msg'\n"
    )


def test_publishers_that_differ_are_all_heard(node: Node, started: Started) -> None:
    reliable = node.create_publisher(String, "/words", 10)
    other = node.create_publisher(String, "/words", qos_profile_sensor_data)
    echoing = started("topic", "echo", "/words", "--csv")
    matched(reliable)
    matched(other)
    reliable.publish(String(data="reliable"))
    echoing.wait_for("(?m)^reliable$")

    def heard() -> bool:
        other.publish(String(data="best effort"))  # which may be lost
        return "best effort" in echoing.output

    until(heard, "the other publisher")
    assert echoing.output.startswith(
        "Some, but not all, publishers are offering QoSReliabilityPolicy.RELIABLE."
    )


def test_echo_shows_numbers_and_times_of_each_message(node: Node, ros2: Ros2) -> None:
    kept(node, "/nothing_in_it", Empty())
    shown = ros2("topic", "echo", "/nothing_in_it", "--once", "-i").stdout
    pattern = (
        r"publication_sequence_number: 1\nreceived_timestamp: \d{19}\nreception_sequence_number: null\n"
        r"source_timestamp: \d{19}\n---\n{}\n---\n"
    )
    assert re.fullmatch(pattern, shown)


def test_echo_reaches_into_nested_messages_and_lists(node: Node, ros2: Ros2) -> None:
    kept(node, "/joints", JointState(name=["a", "b"], position=[1.0, 2.5]))
    for field, shown in {
        "header": "stamp:\n  sec: 0\n  nanosec: 0\nframe_id: ''\n",
        "name": "['a', 'b']\n",
        "position[-1]": "2.5\n",
    }.items():
        assert ros2("topic", "echo", "/joints", "--once", "--field", field).stdout == f"{shown}---\n"
    done = ros2("topic", "echo", "/joints", "--once", "--field", "position[2]")
    assert (done.returncode, done.stderr) == (1, "Invalid field: no element [2] in a list of 2\n")


def test_echo_loses_nothing_of_a_fast_topic(node: Node, started: Started) -> None:
    """Two thousand messages, one each millisecond, and then as many as DDS takes."""
    publisher = node.create_publisher(Int64, "/fast", QoSProfile(depth=1000))
    echoing = started("topic", "echo", "/fast", "--csv")
    matched(publisher)
    for number in range(2000):
        publisher.publish(Int64(data=number))
        time.sleep(0.001)
    for number in range(2000, 2500):
        publisher.publish(Int64(data=number))
    echoing.wait_for("(?m)^2499$")
    assert echoing.output.split() == [str(number) for number in range(2500)]


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 2), (signal.SIGTERM, 15)])
def test_a_signal_ends_it_quietly(node: Node, started: Started, number: signal.Signals, code: int) -> None:
    kept(node, "/words", String(data="hi"))
    for words in (("echo", "/words"), ("hz", "/nothing"), ("pub", "/x", "std_msgs/msg/Empty", "-w", "1")):
        running = started("topic", *words)
        running.wait_for(r".\n")
        assert running.end(number) == code, words
        assert running.errors == ""


def test_an_interrupt_ends_it_quietly_where_a_script_has_it_ignored(node: Node, tmp_path: Path) -> None:
    """So a shell starts what runs in the background of a script."""
    kept(node, "/words", String(data="hi"))
    line = f"trap '' INT; exec {COMMAND} topic echo /words > {tmp_path / 'out'}"
    with subprocess.Popen(["bash", "-c", line], stderr=subprocess.PIPE, text=True) as running:
        until(lambda: (tmp_path / "out").exists() and (tmp_path / "out").read_text(), "a message")
        running.send_signal(signal.SIGINT)
        _, errors = running.communicate(timeout=DEADLINE)
    assert (running.returncode, errors) == (2, "")


SIGNALLED = """
import os, pkgutil, signal, sys
from portable_ros2 import command
where, name = sys.argv[1:]
setattr(pkgutil.resolve_name(where), name, lambda *args, **options: os.kill(os.getpid(), signal.SIGTERM))
sys.exit(command.main(["topic", "hz", "/parameter_events"]))
"""


@pytest.mark.parametrize(
    "moment",
    [
        ("rclpy", "create_node"),
        ("rclpy.executors:SingleThreadedExecutor", "spin_once"),
        *(
            pytest.param(moment, marks=pytest.mark.thorough)
            for moment in (
                ("portable_ros2.graph:Discovery", "wait"),
                ("portable_ros2.commands.topic._topics", "topic_class"),
                ("rclpy.executors:SingleThreadedExecutor", "add_node"),
            )
        ),
    ],
    ids="-".join,
)
def test_a_signal_ends_it_whenever_it_comes(moment: tuple[str, str], tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", SIGNALLED, *moment],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=DEADLINE,
        check=False,
    )
    assert (done.returncode, done.stderr) == (int(signal.SIGTERM), "")


WOKEN = """
import os, signal, sys
from portable_ros2 import command
from rclpy.executors import SingleThreadedExecutor
destroy = SingleThreadedExecutor.shutdown
SingleThreadedExecutor.spin_once = lambda self, **_: os.kill(os.getpid(), int(sys.argv[1]))
def shutdown(self):
    print("too early" if self._context.ok() else "woken")
    destroy(self)
SingleThreadedExecutor.shutdown = shutdown
sys.exit(command.main(["topic", "hz", "/parameter_events"]))
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_nothing_is_destroyed_while_rclpy_wakes_who_waits(number: signal.Signals, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", WOKEN, str(int(number))],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=DEADLINE,
        check=False,
    )
    assert (done.returncode, done.stdout.split("\n")[-2:], done.stderr) == (number, ["woken", ""], "")


def test_a_closed_pipe_ends_it_quietly(node: Node, tmp_path: Path) -> None:
    line = f"{COMMAND} topic pub -r 100 /words std_msgs/msg/String '{{data: hi}}' | head -1; echo ${{PIPESTATUS[0]}}"
    done = subprocess.run(
        ["bash", "-c", line], cwd=tmp_path, capture_output=True, text=True, timeout=DEADLINE, check=True
    )
    assert (done.stdout, done.stderr) == ("publisher: beginning loop\n141\n", "")


# --- Pub


def collected(node: Node, message_class: type[Any], topic: str) -> list[Any]:
    found: list[Any] = []
    node.create_subscription(message_class, topic, found.append, 10)
    return found


def spin_until(node: Node, condition: Callable[[], Any]) -> None:
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    deadline = time.monotonic() + DEADLINE
    while not condition():
        assert time.monotonic() < deadline
        executor.spin_once(timeout_sec=0.1)
    executor.shutdown()


@pytest.mark.parametrize(
    "values", ["{linear: {x: 1}, angular: {z: 0.5}}", '{"linear": {"x": 1.0}, "angular": {"z": 0.5}}']
)
def test_pub_waits_for_a_subscription_and_publishes(node: Node, ros2: Ros2, values: str) -> None:
    found = collected(node, Twist, "/move")
    done = ros2("topic", "pub", "/move", "geometry_msgs/msg/Twist", values, "--once")
    assert (done.returncode, done.stderr) == (0, "")
    *_, beginning, shown, empty, end = done.stdout.split("\n")
    assert (beginning, empty, end) == ("publisher: beginning loop", "", "")
    assert shown.startswith(
        "publishing #1: geometry_msgs.msg.Twist(linear=geometry_msgs.msg.Vector3(x=1.0, y=0.0"
    )
    spin_until(node, lambda: found)
    assert (found[0].linear.x, found[0].angular.z) == (1.0, 0.5)


def test_pub_publishes_as_often_as_asked_and_prints_every_second_one(node: Node, ros2: Ros2) -> None:
    found = collected(node, String, "/words")
    words = ("-t", "4", "-r", "50", "-p", "2", "-n", "speaker")
    done = ros2("topic", "pub", "/words", "std_msgs/String", "data: hi", *words)
    spin_until(node, lambda: len(found) == 4)
    assert re.findall(r"#\d", done.stdout) == ["#2", "#4"]


def test_pub_stamps_each_message(node: Node, ros2: Ros2) -> None:
    found = collected(node, Imu, "/imu")
    ros2("topic", "pub", "/imu", "sensor_msgs/msg/Imu", "header: auto", "-t", "2", "-r", "50")
    spin_until(node, lambda: len(found) == 2)
    first, second = (message.header.stamp.sec * 10**9 + message.header.stamp.nanosec for message in found)
    assert 0 < first < second


def test_pub_reads_values_from_standard_input(ros2: Ros2) -> None:
    words = ("topic", "pub", "/words", "std_msgs/msg/String", "--stdin", "--once", "-w", "0")
    assert "(data='from a pipe')" in ros2(*words, text="data: from a pipe\n").stdout


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("nope/msg/Word",), "The passed message type is invalid: there is no package 'nope'"),
        (("std_msgs/msg/String", "data:hi"), "The passed value needs to be a dictionary in YAML format"),
        (("std_msgs/msg/String", "{data: ["), "The passed value is not valid YAML"),
        (("std_msgs/msg/String", "{text: hi}"), "Failed to populate field: std_msgs/msg/String has no field 'text'"),
        (("std_msgs/msg/Float64", "{data: fast}"), "Failed to populate field: 'data' takes a number, not 'fast'"),
        (("std_msgs/msg/Empty", "--max-wait-time-secs", "1"), "--max-wait-time-secs option is only effective with"),
        (("std_msgs/msg/Empty", "-1", "--max-wait-time-secs", "0.2"),
         "Timed out waiting for subscribers: Expected 1 subcribers but only got 0 subscribers"),
        (("std_msgs/msg/Empty", "-n", "a b"), "Invalid node name: "),
    ],
)  # fmt: skip
def test_pub_says_what_is_wrong(ros2: Ros2, words: tuple[str, ...], message: str) -> None:
    done = ros2("topic", "pub", "/words", *words)
    assert done.returncode == 1
    assert done.stderr.startswith(message)
    assert "Traceback" not in done.stderr
    assert "publishing" not in done.stdout


@pytest.mark.parametrize(
    "words",
    [
        ("pub", "/words"),
        ("pub", "/words", "std_msgs/msg/Empty", "-r", "0"),
        ("pub", "/words", "std_msgs/msg/Empty", "-t", "-1"),
        ("pub", "/words", "std_msgs/msg/Empty", "-t", "1", "--once"),
        ("pub", "/words", "std_msgs/msg/Empty", "{}", "--stdin"),
        ("echo",),
        ("echo", "/words", "-l", "-1"),
        ("echo", "/words", "--timeout", "soon"),
        ("hz", "/words", "-w", "0"),
        ("bw", "/words", "--window", "1.5"),
        ("delay",),
        ("find",),
    ],
)
def test_a_wrong_command_line_is_told(words: tuple[str, ...], ros2: Ros2) -> None:
    done = ros2("topic", *words)
    assert (done.returncode, done.stdout) == (2, "")
    assert f"ros2 topic {words[0]}: error: " in done.stderr


# --- Rates


def test_hz_counts_every_message_of_a_fast_topic(node: Node, started: Started) -> None:
    """A message after a pause of more than a second makes it tell what it has counted."""
    publisher = node.create_publisher(Int64, "/fast", QoSProfile(depth=1000))
    counting = started("topic", "hz", "/fast")
    matched(publisher)
    for number in range(2000):
        publisher.publish(Int64(data=number))
        time.sleep(0.001)

    def counted() -> int:
        publisher.publish(Int64())
        windows = re.findall(r"window: (\d+)", counting.output)
        return windows and int(windows[-1])

    until(lambda: counted() >= 0.99 * 2000, "the count of hz")
    shown = r"average rate: \d+\.\d{3}\n\tmin: \d\.\d{3}s max: \d+\.\d{3}s std dev: \d\.\d{5}s window: \d+\n"
    assert re.fullmatch(f"({shown})+", counting.output)


def test_hz_and_bw_and_delay_wait_for_a_topic(node: Node, started: Started) -> None:
    """They hear everything in a graph that begins later, and a filter leaves some of it out."""
    running = {
        r"average rate: .*\n.*window: 3\n": started(
            "topic", "hz", "/imu", "-w", "3", "--filter", "m.orientation.w"
        ),
        r"Subscribed to \[/imu\]\n\d.* from \d+ messages\n\tMessage size mean: 0\.3\d KB": started(
            "topic", "bw", "/imu"
        ),
        r"average delay: \d+\.\d{3}\n\tmin: ": started("topic", "delay", "/imu"),
    }
    for one in running.values():
        one.wait_for(r"WARNING: topic \[/imu\] does not appear to be published yet")
    publisher = node.create_publisher(Imu, "/imu", qos_profile_sensor_data)
    message = Imu()
    for pattern, one in running.items():

        def heard(one: Running = one, pattern: str = pattern) -> Any:
            message.header.stamp = node.get_clock().now().to_msg()
            publisher.publish(message)
            return re.search(pattern, one.output)

        until(heard, pattern)


def test_delay_needs_a_header(node: Node, ros2: Ros2) -> None:
    node.create_publisher(String, "/words", 10)
    done = ros2("topic", "delay", "/words")
    assert (done.returncode, done.stdout, done.stderr) == (1, "", "msg does not have header\n")


def told(rate: hz.Rate, *times: float) -> list[str]:
    lines: list[str] = []
    for time_s in times:
        rate.add(round(time_s * 1e9), lines.append)
    return lines


def test_a_rate_is_told_each_second() -> None:
    lines = told(hz.Rate(100), *(10 + 0.25 * n for n in range(9)))
    assert lines == [
        "average rate: 4.000\n\tmin: 0.250s max: 0.250s std dev: 0.00000s window: 4",
        "average rate: 4.000\n\tmin: 0.250s max: 0.250s std dev: 0.00000s window: 8",
    ]


def test_a_rate_is_that_of_the_newest_messages() -> None:
    (line,) = told(hz.Rate(2), 1.0, 1.5, 1.6, 2.0)
    assert line == "average rate: 4.000\n\tmin: 0.100s max: 0.400s std dev: 0.15000s window: 2"


def test_a_rate_begins_anew_when_time_goes_back() -> None:
    rate = hz.Rate(100)
    assert told(rate, 0.0, 0.0) == []  # a clock that does not run
    assert told(rate, 5.0, 5.5, 2.0) == ["time has reset, resetting counters"]
    assert told(rate, 3.0) == ["average rate: 1.000\n\tmin: 1.000s max: 1.000s std dev: 0.00000s window: 1"]


@pytest.mark.parametrize(
    ("duration", "sizes", "text"),
    [
        (2.0, [100, 300], "200 B/s from 2 messages\n\tMessage size mean: 200 B min: 100 B max: 300 B"),
        (1.0, [1000, 2000], "3.00 KB/s from 2 messages\n\tMessage size mean: 1.50 KB min: 1.00 KB max: 2.00 KB"),
        (0.5, [10**6] * 2, "4.00 MB/s from 2 messages\n\tMessage size mean: 1.00 MB min: 1.00 MB max: 1.00 MB"),
    ],
)  # fmt: skip
def test_a_bandwidth_has_the_unit_that_fits(duration: float, sizes: list[int], text: str) -> None:
    assert bw.bandwidth(duration, sizes) == text


def test_a_delay_is_told_once_for_the_same_messages(capsys: pytest.CaptureFixture[str]) -> None:
    delays = delay.Delays(2)
    assert delays.text() == ""
    for now, stamp in ((10, 0), (20, 19), (30, 27), (40, 35)):
        delays.add(now * 10**9, stamp * 10**9)
    assert delays.text() == "average delay: 4.000\n\tmin: 3.000s max: 5.000s std dev: 1.00000s window: 2"
    assert delays.text() == "no new messages"
    delays.add(5 * 10**9, 0)
    assert capsys.readouterr().out == "time has reset, resetting counters\n"
    assert delays.text() == ""


# --- Completion


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("ros2 topic echo /w", ["/words"]),
        ("ros2 topic echo /_", []),
        ("ros2 topic --include-hidden-topics info /_s", ["/_secret"]),
        ("ros2 topic pub /numbers std_msgs/", ["std_msgs/msg/Int32"]),
        ("ros2 topic pub /nothing std_msgs/msg/Emp", ["std_msgs/msg/Empty"]),
        ("ros2 topic pub /words std_msgs/msg/Bool data", ["data:\\ false"]),
        ("ros2 topic pub /words std_msgs/msg/Nothing data", []),
        ("ros2 topic find std_msgs/msg/Emp", ["std_msgs/msg/Empty"]),
        ("ros2 topic echo /words --qos-profile sen", ["sensor_data"]),
    ],
)
def test_topics_types_and_values_complete(
    graph: Node, ros2: Ros2, tmp_path: Path, line: str, offered: list[str]
) -> None:
    answer = tmp_path / "answer"
    ros2(
        _ARGCOMPLETE="1",
        _ARGCOMPLETE_IFS="\n",
        _ARGCOMPLETE_SUPPRESS_SPACE="1",
        _ARGCOMPLETE_STDOUT_FILENAME=str(answer),
        COMP_LINE=line,
        COMP_POINT=str(len(line)),
    )
    assert [found.strip() for found in answer.read_text().splitlines() if found.strip()] == offered


@pytest.mark.parametrize(
    ("field", "steps"),
    [
        (None, []),
        ("a", ["a"]),
        ("a.b_1", ["a", "b_1"]),
        (".a..b.", ["a", "b"]),
        ("a[0].b[-1]", ["a", 0, "b", -1]),
    ],
)
def test_a_field_is_a_path(field: str | None, steps: list[str | int]) -> None:
    assert echo._path(field) == steps


@pytest.mark.parametrize("field", ["", ".", "a[", "a[x]", "a]0["])
def test_other_paths_are_refused(field: str) -> None:
    with pytest.raises(RuntimeError, match="Invalid field value"):
        echo._path(field)
