"""What nodes are given that nothing in a workspace brings, and what is said of what they then do."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from builtin_interfaces.msg import Time
from rclpy.serialization import serialize_message
from right_workspace import right_workspace
from test_trial import build, run_of
from workspace_files import Files

from ros2lab import assignments
from ros2lab.diagnose.look import Look
from ros2lab.grading.evidence import GIVEN, Heard, Run, ServiceCall
from ros2lab.grading.watching.made_up import Filler
from ros2lab.topics import find_type
from ros2lab.trial import try_out
from ros2lab.trial.given import GivenRun, given_faults, open_contents, told_of_given
from ros2lab.trial.seen import Seen

BOOL, INT, SCAN = "std_msgs/msg/Bool", "std_msgs/msg/Int32", "sensor_msgs/msg/LaserScan"
SUM = "/sum"


def messages(kind: str, count: int = 24, **compared: tuple[object, ...]) -> Iterator[object]:
    filler = Filler(lambda: Time(sec=7), **compared)  # type: ignore[arg-type]
    return (filler.fill(find_type(kind)(), turn) for turn in range(count))


@pytest.mark.parametrize(
    "kind",
    [
        "std_msgs/msg/Empty", "std_msgs/msg/Byte", "std_msgs/msg/Char", "std_msgs/msg/ByteMultiArray",
        "sensor_msgs/msg/Imu", "sensor_msgs/msg/BatteryState", "sensor_msgs/msg/PointCloud2", "nav_msgs/msg/Path",
        "nav_msgs/msg/OccupancyGrid", "diagnostic_msgs/msg/DiagnosticArray", "geometry_msgs/msg/PolygonStamped",
    ],
)  # fmt: skip
def test_any_message_is_filled(kind: str) -> None:
    """With all that its fields may hold: nested, in sequences, as single bytes."""
    for message in messages(kind):
        assert serialize_message(message)


def test_each_value_comes_on_each_side_of_what_the_code_compares() -> None:
    """Also the words, and flags both ways; an unsigned number is never below 0."""
    floats = {message.data for message in messages("std_msgs/msg/Float64", numbers=(28.0, 0.4))}
    assert {27.0, 28.0, 29.0, 0.0} <= floats
    assert any(0 < number < 0.4 for number in floats)
    assert any(number < 0 for number in floats)
    words = {message.data for message in messages("std_msgs/msg/String", 3, words=("go", "halt"))}
    assert {"go", "halt"} < words
    assert {message.data for message in messages("std_msgs/msg/Bool", 2)} == {True, False}
    assert min(message.data for message in messages("std_msgs/msg/UInt8")) == 0


def test_no_two_fields_go_together() -> None:
    """A condition on two fields may need any pair of their values."""
    pairs = [(message.x > 0, message.y > 0) for message in messages("geometry_msgs/msg/Point")]
    assert len({*pairs}) == 4


def test_the_fields_of_a_sensor_fit_each_other() -> None:
    """As those of a real one: a wall now far and now near, an image as large as it says, a turn that is one."""
    scans = [*messages(SCAN, numbers=(0.5,))]
    for scan in scans:
        assert len(scan.ranges) == round((scan.angle_max - scan.angle_min) / scan.angle_increment) + 1
        assert all(scan.range_min <= distance <= scan.range_max for distance in scan.ranges)
    assert {min(scan.ranges) < 0.5 for scan in scans} == {True, False}
    assert any(max(scan.ranges) > min(scan.ranges) for scan in scans)
    for image in messages("sensor_msgs/msg/Image"):
        assert len(image.data) == image.height * image.step == 3 * image.height * image.width
    for pose in messages("geometry_msgs/msg/PoseWithCovarianceStamped"):
        turn = pose.pose.pose.orientation
        assert math.isclose(math.hypot(turn.x, turn.y, turn.z, turn.w), 1.0)
        assert all(pose.pose.covariance[7 * number] > 0 for number in range(6))
        assert pose.header.stamp.sec == 7
    for joy in messages("sensor_msgs/msg/Joy"):
        assert {*joy.buttons} <= {0, 1}
        assert max(map(abs, joy.axes)) <= 1


def test_what_may_fail_comes_last() -> None:
    """A division or an index shows first what it does with other numbers."""
    first = [message.data for message in messages(INT, 3)]
    assert 0 not in first
    assert max(map(abs, first)) <= 2


def adding(**changes: str) -> Files:
    """Return the right workspace whose status node also adds the numbers that it receives."""
    files = right_workspace().change("node", "import String", "import Int32, String")
    made = "        self.count = 0\n"
    more = (
        "        self.total = 0\n        self.sums = self.create_publisher(Int32, '/sum', 10)\n"
        "        self.create_subscription(Int32, '/number', self.add, 10)\n\n"
        "    def add(self, msg):\n        if msg.data > 41:\n            self.total += msg.data\n"
        "            self.sums.publish(Int32(data=self.total))\n"
    )
    for old, new in changes.items():
        more = more.replace(old.replace("_", " "), new)
    return files.change("node", made, made + more)


def test_only_what_nothing_brings_is_given(tmp_path: Path) -> None:
    """With the numbers near which something may change; to a workspace that needs nothing, nothing."""
    assert open_contents(Look(right_workspace().write(tmp_path / "right")), "/robot/command") == {}
    found = open_contents(Look(adding().write(tmp_path / "open")), "/robot/command")
    assert {*found} == {"number", "command"}  # the words, too, for they may have to come first
    assert found["number"]["numbers"][:1] == [41]
    assert 10 not in found["number"]["numbers"]  # the depth of a queue
    assert found["command"]["words"] == ["start"]
    fed = adding().change(
        "driver",
        "self.declare_parameter(",
        "self.create_publisher(Int32, '/number', 10)\n        self.declare_parameter(",
    )
    assert open_contents(Look(fed.write(tmp_path / "fed")), "/robot/command") == {}


def told(
    root: Path, *heard: int, ended: str = "", calls: tuple[ServiceCall, ...] = ()
) -> tuple[list[str], list[str]]:
    """Return what is said of the adding node, and the codes of what is found."""
    node = {"/status_publisher": [INT]}
    alone = replace(run_of("status_publisher", SUM, INT, None), subscribes={"/number": node})
    sums = Heard(
        INT, "/status_publisher", [*range(len(heard))], [{"data": data} for data in heard], len(heard)
    )
    ends = {"status_publisher": ended} if ended else {}
    among: Run = replace(
        alone,
        setting=GIVEN,
        given=["/number"],
        quiet={SUM: sums} if heard else {},
        ended=ends,
        calls=[*calls],
    )
    given = GivenRun(among, [{"/number": {"data": 0}}] if ended else [], frozenset())
    seen = Seen(Look(root), assignments.load(), [alone], [])
    return told_of_given(seen, alone, given), [found.code for found in given_faults(seen, given)]


def test_what_a_node_then_does_is_told(tmp_path: Path) -> None:
    """What varies in it, what does not, and that nothing came."""
    root = adding().write(tmp_path)
    begin = "Given made-up messages on /number (std_msgs/Int32), it "
    assert told(root, 42, 84) == ([f"{begin}published 2 messages on /sum: data 42 or 84."], [])
    assert told(root, 0, 0) == (
        [f"{begin}published 2 messages on /sum, each of them with data = 0."],
        [],
    )
    assert told(root, 42) == ([f"{begin}published 1 message on /sum, with data = 42."], [])
    assert told(root) == ([f"{begin}still published nothing on /sum."], [])


@pytest.mark.parametrize(
    ("error", "is_found"),
    [
        ("AttributeError: 'StatusPublisher' object has no attribute 'totl'", True),
        ("AttributeError: 'NoneType' object has no attribute 'group'", False),
        ("ZeroDivisionError: division by zero", False),
        ("ValueError: too many values to unpack (expected 2)", False),
        ("AssertionError: The 'data' field must be an unsigned integer in [0, 255]", False),
    ],
)
def test_only_what_fails_with_any_content_is_a_finding(tmp_path: Path, error: str, is_found: bool) -> None:
    """All else may be the fault of what was made up, and is only told with it."""
    root = adding().change("node", "self.total += msg.data", "self.totl += msg.data").write(tmp_path)
    (path,) = root.glob("src/*/*/status_publisher.py")
    line = next(n for n, text in enumerate(path.read_text().splitlines(), 1) if "self.totl" in text)
    said = f'Traceback (most recent call last):\n  File "{path}", line {line}, in add\n    self.totl += msg.data\n{error}'
    story, codes = told(root, ended=said)
    assert bool(codes) == is_found
    assert f"status_publisher.py:{line}) soon after data = 0 on /number" in story[0]
    assert ("made up" in story[0]) == (not is_found)


def test_real_nodes_are_given_what_they_wait_for(tmp_path: Path) -> None:
    """One that adds what is above a limit, one whose response is lost, and one that fails at a scan."""
    files = adding()
    files.change("listener", "import String", "import String\nfrom std_srvs.srv import SetBool")
    files.change(
        "listener",
        "    def command_callback(self, msg):",
        "        self.create_service(SetBool, '/listen', self.listen)\n\n"
        "    def listen(self, request, response):\n        self.is_on = request.data\n"
        "        SetBool.Response(success=True)\n        return response\n\n"
        "    def command_callback(self, msg):",
    )
    files.change("driver", "import Twist", "import Twist\nfrom sensor_msgs.msg import LaserScan")
    files.change(
        "driver",
        "    def timer_callback(self):",
        "        self.create_subscription(LaserScan, '/scan', self.look, 10)\n\n"
        "    def look(self, msg):\n        self.nearest = min(msg.range)\n\n    def timer_callback(self):",
    )
    root = files.change(
        "package.xml",
        "  <depend>std_msgs",
        "  <depend>sensor_msgs</depend>\n  <depend>std_srvs</depend>\n  <depend>std_msgs",
    ).write(tmp_path)
    build(root)
    trial = try_out(root)
    assert [finding.code for finding in trial.findings] == ["message-field"], trial
    assert "velocity_publisher.py" in trial.findings[0].place
    adder, listener, driver = (
        next(line for line in trial.story if line.startswith(name))
        for name in ("status_publisher", "command_subscriber", "velocity_publisher")
    )
    assert "Given made-up messages on /number (std_msgs/Int32), it published" in adder
    assert "on /sum: data " in adder
    assert "called with data = True, answered success = False" in listener
    assert "as a response is before anything is filled in" in listener
    assert "'LaserScan' object has no attribute 'range'" in driver
