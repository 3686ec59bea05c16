"""Namespaces of launch files that the names in the code do not take."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_text
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.grading.evidence import Run
from ros2lab.trial.set_in_vain import set_in_vain

DRONE = """\
import rclpy
from geometry_msgs.msg import Point
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger

class Drone(Node):
    def __init__(self):
        super().__init__('drone')
        self.size = self.declare_parameter('size', 1.0).value
        self.who = self.declare_parameter('who', '').value
        MAKE

    def move(self):
        self.out.publish(Point(x=self.size))

    def hear(self, msg):
        self.get_logger().info(msg.data)

    def land(self, request, response):
        return response


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Drone())
"""
PUBLISH = "self.out = self.create_publisher(Point, '/pose', 10); self.create_timer(1.0, self.move)"
RELATIVE = PUBLISH.replace("/pose", "pose")
LISTEN = "self.create_subscription(String, '/order', self.hear, 10)"
SERVE = "self.create_service(Trigger, '/land', self.land)"
NODE = "Node(package='my_bot', executable='drone'"
TWO = f"{NODE}, namespace='red'), {NODE}, namespace='blue')"
WITH = TWO.replace(")", ", parameters=[{'KEY': VALUE}])")


def _launched(nodes: str, comment: str = "") -> str:
    return f"""\
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction
from launch.conditions import IfCondition, UnlessCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node, PushRosNamespace


def generate_launch_description():
    # {comment}
    return LaunchDescription([{nodes}])
"""


def _found(root: Path, make: str, nodes: str, comment: str = "", other: str = "") -> list[Finding]:
    files = right_workspace().put("my_bot/drone.py", DRONE.replace("MAKE", make))
    row = "'drone = my_bot.drone:main',\n            'tower = my_bot.tower:main',\n            "
    files = files.change("setup.py", "'console_scripts': [", f"'console_scripts': [{row}")
    tower = DRONE.replace("MAKE", other or "pass").replace("Drone", "Tower").replace("'drone'", "'tower'")
    files = files.put("my_bot/tower.py", tower)
    files = files.put("launch/two.launch.py", _launched(nodes, comment))
    look = Look(files.write(root), loads=True)
    assert all(file.is_loaded for file in look.launch_files), look.launch_files
    return [finding for finding in look.findings if finding.code == "namespace-unused"]


def _values(key: str, one: object, other: object) -> str:
    return WITH.replace("KEY", key).replace("VALUE", repr(one), 1).replace("VALUE", repr(other), 1)


GROUPS = ", ".join(f"GroupAction([PushRosNamespace('{space}'), {NODE})])" for space in ("red", "blue"))
CHOICE = (
    "DeclareLaunchArgument('real', default_value='true'), "
    f"{NODE}, namespace='red', condition=IfCondition(LaunchConfiguration('real'))), "
    f"{NODE}, namespace='blue', condition=UnlessCondition(LaunchConfiguration('real')))"
)
REMAPPED = TWO.replace(")", ", remappings=[('/pose', 'pose')])")
TOWER = "Node(package='my_bot', executable='tower'"
READS = "self.create_subscription(Point, '/pose', self.hear, 10)"
SENDS = "self.out = self.create_publisher(String, '/order', 10)"


@pytest.mark.parametrize(
    ("how", "names"),
    [
        ((PUBLISH, TWO, "", ""), "/pose"),
        ((f"{PUBLISH}; {LISTEN}", _values("size", 1.0, 2.0), "", ""), "/pose /order"),
        ((PUBLISH, GROUPS, "", ""), "/pose"),
        ((SERVE, TWO, "", ""), "/land"),
        ((SERVE, _values("who", "red", "blue"), "", ""), "/land"),
        ((LISTEN, TWO, "", ""), "/order"),
        # Each drone has a tower of its own.
        ((PUBLISH, f"{TWO}, {TWO.replace('drone', 'tower')}", "", READS), "/pose"),
        (
            (f"{PUBLISH}; {LISTEN.replace('/order', 'order')}", TWO, "as /red/pose and /blue/pose", ""),
            "/pose",
        ),
        ((PUBLISH, f"{NODE}, namespace='red')", "the tower reads red/pose", ""), "/pose"),
        # Who it is, is told where it sends, or what comes is for all.
        ((PUBLISH.replace("Point,", "Point, ").replace("10)", "10); self.get_name()"), TWO, "", ""), ""),
        ((PUBLISH, _values("who", "red", "blue"), "", ""), ""),
        ((LISTEN, _values("size", 1.0, 2.0), "", ""), ""),
        ((f"{LISTEN}; {RELATIVE}", TWO, "", ""), ""),
        ((f"{PUBLISH}; {LISTEN.replace('/order', 'order')}", TWO, "", ""), ""),
        ((PUBLISH, f"{TWO}, {TOWER})", "", READS), ""),
        ((LISTEN, TWO, "", SENDS), ""),
        ((f"{SENDS}; {LISTEN}", TWO, "", ""), ""),
        ((PUBLISH.replace("/pose", "/tf"), TWO, "", ""), ""),
        # Nothing is set in vain.
        ((RELATIVE, TWO, "as /red/pose", ""), ""),
        ((PUBLISH, f"{NODE}, name='red'), {NODE}, name='blue')", "", ""), ""),
        ((PUBLISH, f"{NODE}, namespace='red')", "", ""), ""),
        ((PUBLISH, REMAPPED, "as /red/pose", ""), ""),
        ((PUBLISH, CHOICE, "", ""), ""),
        (("self.out = self.create_publisher(Point, self.who, 10)", TWO, "", ""), ""),
    ],
)
def test_a_slash_leaves_each_namespace(tmp_path: Path, how: tuple[str, ...], names: str) -> None:
    found = _found(tmp_path, *how)
    assert [" ".join(one.about) for one in found] == ([names] if names else []), found
    assert all(one.place.startswith("src/my_bot/my_bot/drone.py:") for one in found)
    assert all(f"{name[1:]!r} instead of {name!r}" in one.fix for one in found for name in one.about)


RUN = "$ ros2 run my_bot drone --ros-args"


@pytest.mark.parametrize(
    ("said", "cause"),
    [
        (f"{RUN} -r posee:=place\n$ ros2 topic echo /place\nWARNING: topic [/place] does not appear to be published yet", "The command remaps 'posee'"),
        (f"{RUN} -r /order:=/say", "The command remaps '/order'"),
        (f"{RUN} -p siez:=2.0", "The command sets the parameter siez"),
        (f"{RUN} -p size:=2", "drone declares size with a number with a decimal point, but the command gives it 2"),
        (f"{RUN} -r pose:=place -r __ns:=/red -r __node:=one", ""),
        (f"{RUN} -r drone:pose:=place -p use_sim_time:=true -p size:=2.0", ""),
        ("$ ros2 run other drone --ros-args -p siez:=2.0", ""),
    ],
)  # fmt: skip
def test_a_command_sets_what_the_program_cannot_take(tmp_path: Path, said: str, cause: str) -> None:
    _found(tmp_path, RELATIVE, NODE + ")")
    found = of_text(said, tmp_path)
    assert [one.cause.startswith(cause) for one in found if one.code == "typed-wrong"] == [True] * bool(
        cause
    ), found
    assert not cause or found[0].code == "typed-wrong"


BY_PARAMETER = PUBLISH.replace("'/pose'", "self.declare_parameter('topic', '/pose').value + self.who")
MOVED = f"{NODE}, remappings=[('pos', '/place')])"


@pytest.mark.parametrize(
    ("make", "nodes", "topic", "found"),
    [
        (BY_PARAMETER, TWO, "/pose", ["namespace-unused"]),
        (BY_PARAMETER, TWO, "/red/pose", []),
        (BY_PARAMETER, _values("who", "_red", "_blue"), "/pose_red", []),
        (BY_PARAMETER, MOVED, "/pose", ["remap-unknown"]),
        (BY_PARAMETER, MOVED, "/place", []),
        (BY_PARAMETER, MOVED, "", []),
        (f"{BY_PARAMETER}; {SERVE}", MOVED, "/pose", []),
        (PUBLISH, TWO, "/pose", []),  # its code tells it
    ],
)
def test_by_what_was_seen(tmp_path: Path, make: str, nodes: str, topic: str, found: list[str]) -> None:
    told = _found(tmp_path, make, nodes)
    assert bool(told) is (make == PUBLISH)
    publishes = {topic: {"/drone": ["geometry_msgs/msg/Point"]}} if topic else {}
    run = Run(["drone"], "alone", "stepped", [], publishes, {}, {}, {}, {}, [], {}, {}, [])
    look = Look(tmp_path, loads=True)
    assert [one.code for one in set_in_vain(look, {"drone": run})] == found
