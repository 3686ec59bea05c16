"""Names that rcl or launch refuses: the typed rule or the line of the launch file is written as ROS allows it."""

from __future__ import annotations

from pathlib import Path

import pytest
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text
from ros2lab.diagnose.causes.refused_names import allowed

RUN = "ros2 run my_bot talker --ros-args"
TYPED = [
    ("-r __ns:=/line-7", "-r __ns:=/line_7"),
    ("--remap __ns:=line7", "--remap __ns:=/line7"),
    ("-r __ns:=/2cam", "-r __ns:=/cam2"),
    ("-r __node:=my-bus", "-r __node:=my_bus"),
    ("-r __node:=/bus", "-r __node:=bus"),
    ("-r chatter:=talk-1", "-r chatter:=talk_1"),
    ("-r '/chatter:=my topic'", "-r '/chatter:=my_topic'"),
    ("-r a:=b -r talk-er:=x", "-r a:=b -r talk_er:=x"),
    ("-r __ns:=/a -r chatter:=/1st/x", "-r __ns:=/a -r chatter:=/st1/x"),
]
NODE = "        Node(package='PACKAGE', executable='MODULE', "
ERROR = 'Traceback (most recent call last):\n  File "/w/src/my_bot/my_bot/talker.py", line 40, in main\n    rclpy.init(args=args)\n  File "/opt/lib/rclpy/context.py", line 99, in init\n    self.__context = _rclpy.Context(\nrclpy._rclpy_pybind11.RCLError: failed to initialize rcl: Couldn\'t parse remap rule: \'{rule}\'. Error: Expected lexeme type (1) not found, search ended at index 11, at /r/lexer_lookahead.c:239, at /r/arguments.c:380\n'
INVALID = "$ ros2 launch my_bot robot.launch.py\n[ERROR] [launch]: Caught exception in launch (see debug for traceback): Invalid {what}: {what} must not contain characters other than alphanumerics or '_':\n  '{name}'\n      ^\n"


@pytest.mark.parametrize(("typed", "right"), TYPED)
def test_a_typed_rule_is_written_as_ros_allows_it(tmp_path: Path, typed: str, right: str) -> None:
    root = Files.right(NAMES[1]).write(tmp_path)
    rule = typed.rpartition("-r ")[2].strip("'")
    found = of_text(f"$ {RUN} {typed}\n{ERROR.format(rule=f'-r {rule}')}", root)[0]
    assert (found.code, found.place) == ("typed-wrong", "")
    assert found.fix == f"type `{RUN} {right}`"


@pytest.mark.parametrize(
    ("given", "text", "right"),
    [
        ("namespace='line-7'", INVALID.format(what="namespace", name="/line-7"), "'line_7' instead of 'line-7'"),
        ("namespace='/line-7'", INVALID.format(what="namespace", name="/line-7"), "'/line_7' instead of '/line-7'"),
        ("name='my-bus'", INVALID.format(what="node name", name="my-bus"), "'my_bus' instead of 'my-bus'"),
        ("remappings=[('chatter', 'stop-1')]", f"$ ros2 launch my_bot robot.launch.py\n{ERROR.format(rule='-r chatter:=stop-1')}", "'stop_1' instead of 'stop-1'"),
    ],
)  # fmt: skip
def test_a_name_in_a_launch_file_is_written_on_its_line(
    tmp_path: Path, given: str, text: str, right: str
) -> None:
    node = "executable='talker', "
    files = Files.right(NAMES[1]).change("launch/robot.launch.py", node, f"{node}{given}, ")
    found = of_text(text, files.write(tmp_path))[0]
    lines = files.texts["src/my_bot/launch/robot.launch.py"].splitlines()
    number = next(number for number, line in enumerate(lines, 1) if given in line)
    assert found.place == f"src/my_bot/launch/robot.launch.py:{number}"
    assert right in found.fix


NAMES_GIVEN = ["/line-7", "line 7", "/2cam/left", "/a//b/", "a__b", "über", "my.bus", "/line_7", "bus", "b2"]


@pytest.mark.parametrize("name", NAMES_GIVEN)
def test_what_is_proposed_is_allowed(name: str) -> None:
    assert validate_namespace(allowed(name, "namespace"))
    assert validate_node_name(allowed(name, "node name"))
    assert validate_full_topic_name(f"/{allowed(name, 'topic or service name').lstrip('/')}")


@pytest.mark.parametrize("name", ["~/chatter", "/robot/scan", "{node}/x", "rostopic://chatter", "/*/scan"])
def test_a_right_name_stays(name: str) -> None:
    assert allowed(name, "topic or service name") == name
