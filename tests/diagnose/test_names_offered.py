"""Names that are offered instead of wrong ones: of topics, of a launch file's attributes, and of message fields."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.node_faults import TOPIC_NAME

NAME = NAMES[1]


def told(files: Files, folder: Path, code: str) -> Finding:
    return next(one for one in of_workspace(files.write(folder)) if one.code == code)


@pytest.mark.parametrize(
    "topic",
    [
        "/cow/1/pose",
        "/1/pose",
        "1",
        "cow/2nd",
        "/cow//pose",
        "cow pose",
        "/käse",
        "pose/",
        "-",
        "cow/1/2/pose",
    ],
)
def test_a_topic_name_that_is_offered_is_a_right_one(tmp_path: Path, topic: str) -> None:
    files = Files.right(NAME).change("PACKAGE/MODULE.py", "'TOPIC'", repr(topic))
    fix = told(files, tmp_path, "topic-name-invalid").fix
    offered = fix.removeprefix("write ").strip("'")
    assert offered != topic
    assert TOPIC_NAME.fullmatch(offered)


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ('<arg name="a" descrption="b"/>', "write description instead of descrption"),
        ('<arg nmae="a"/>', "write name instead of nmae"),
        ('<node pkg="my_bot" exec="talker" ouput="screen"/>', "write output instead of ouput"),
        ('<node pkg="my_bot" exec="talker" colour="red"/>', "remove colour"),
    ],
)
def test_an_attribute_is_compared_with_those_that_launch_asks_for(
    tmp_path: Path, line: str, fix: str
) -> None:
    files = Files.right(NAME)
    files.texts[f"src/{NAME.package}/launch/a.launch.xml"] = f"<launch>\n  {line}\n</launch>\n"
    found = told(files, tmp_path, "launch-argument")
    assert found.fix == fix
    assert found.place.endswith("a.launch.xml:2")


@pytest.mark.parametrize(
    ("read", "fix"),
    [
        ("msg.header.stamp.nanoseconds", "write `Time.from_msg(msg.header.stamp).nanoseconds`"),
        ("msg.header.stamp.sec", None),
        ("msg.header.stamp.secs", "write one of: sec, nanosec"),
    ],
)
def test_a_time_of_a_message_is_made_one_of_rclpy(tmp_path: Path, read: str, fix: str | None) -> None:
    files = Files.right(NAME).change(
        "listener", "from std_msgs.msg import String", "from sensor_msgs.msg import Imu"
    )
    files.change("listener", "create_subscription(String,", "create_subscription(Imu,")
    files.change("listener", "'Received: \"%s\"' % msg.data", f"str({read})")
    found = [one.fix for one in of_workspace(files.write(tmp_path)) if one.code == "message-field"]
    assert len(found) == (fix is not None)
    assert all(one.startswith(str(fix)) for one in found)
