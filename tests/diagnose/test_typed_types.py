"""A command that waits in silence: its name and its type are compared with what the workspace's code offers."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest
import yaml

from ros2lab.diagnose import of_text
from ros2lab.diagnose.sources import interfaces

NODE = """\
import rclpy
from example_interfaces.action import Fibonacci
from geometry_msgs.msg import Twist
from rclpy.action import ActionServer
from rclpy.node import Node
from std_msgs.msg import Int32
from std_srvs.srv import SetBool, Trigger


class Gate(Node):
    def __init__(self):
        super().__init__('gate', namespace='park')
        self.create_service(SetBool, 'open', self.on_request)
        self.create_service(Trigger, '~/reset', self.on_request)
        self.server = ActionServer(self, Fibonacci, 'count', self.on_goal)
        self.create_subscription(Twist, '/cmd_vel', self.on_twist, 10)

    def on_twist(self, msg):
        self.get_logger().info(f'{msg.linear.x}')

    def on_goal(self, handle):
        handle.succeed()
        return Fibonacci.Result()

    def on_request(self, request, response):
        response.success = True
        return response


def main():
    rclpy.init()
    rclpy.spin(Gate())
"""
MANIFEST = "<package format='3'><name>bot</name><version>0.0.1</version><description>d</description><maintainer email='a@example.org'>a</maintainer><license>MIT</license><depend>rclpy</depend><depend>std_srvs</depend><depend>std_msgs</depend><depend>geometry_msgs</depend><depend>example_interfaces</depend><export><build_type>ament_python</build_type></export></package>"
SETUP = "from setuptools import setup\nsetup(name='bot', version='0.0.1', packages=['bot'], data_files=[('share/ament_index/resource_index/packages', ['resource/bot']), ('share/bot', ['package.xml'])], entry_points={'console_scripts': ['gate = bot.gate:main']})\n"
CALL, GOAL = "ros2 service call", "ros2 action send_goal"
OTHER = [
    (f"{CALL} /park/open std_srvs/srv/Trigger", f'{CALL} /park/open std_srvs/srv/SetBool "{{data: true}}"'),
    (f"{CALL} park/open std_srvs/srv/Trigger '{{}}'", f"{CALL} park/open std_srvs/srv/SetBool '{{}}'"),
    (f"{CALL} /park/open example_interfaces/srv/SetBool '{{data: false}}'", f"{CALL} /park/open std_srvs/srv/SetBool '{{data: false}}'"),
    (f"{CALL} /park/gate/reset std_srvs/srv/SetBool '{{data: true}}'", f"{CALL} /park/gate/reset std_srvs/srv/Trigger"),
    (f"{CALL} /hall/park/open std_srvs/srv/Empty", f'{CALL} /hall/park/open std_srvs/srv/SetBool "{{data: true}}"'),
    (f"{CALL} /open std_srvs/srv/Trigger", f'{CALL} /park/open std_srvs/srv/SetBool "{{data: true}}"'),
    (f"{GOAL} /park/count example_interfaces/action/Count '{{order: 3}}'", f"{GOAL} /park/count example_interfaces/action/Fibonacci '{{order: 3}}'"),
    ("ros2 topic pub /cmd_vel geometry_msgs/msg/Vector3 '{x: 1.0}'", 'ros2 topic pub /cmd_vel geometry_msgs/msg/Twist "{linear: {x: 0.0, y: 0.0, z: 0.0}, angular: {x: 0.0, y: 0.0, z: 0.0}}"'),
]  # fmt: skip
RIGHT = [
    f"{CALL} /park/open std_srvs/srv/SetBool '{{data: true}}'",
    f"{CALL} park/open std_srvs/srv/SetBool '{{data: true}}'",
    f"{CALL} /hall/park/open std_srvs/srv/SetBool '{{data: true}}'",
    f"{GOAL} /park/count example_interfaces/action/Fibonacci '{{order: 3}}'",
]


@pytest.fixture
def root(tmp_path: Path) -> Path:
    package = tmp_path / "src/bot"
    for name, text in {
        "bot/__init__.py": "",
        "bot/gate.py": NODE,
        "package.xml": MANIFEST,
        "setup.py": SETUP,
        "setup.cfg": "[develop]\nscript_dir=$base/lib/bot\n[install]\ninstall_scripts=$base/lib/bot\n",
        "resource/bot": "",
    }.items():
        path = package / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path


def waiting(command: str) -> str:
    what = "an action server" if "action" in command.split()[1] else "service"
    return f"$ {command}\nwaiting for {what} to become available...\n"


@pytest.mark.parametrize(("typed", "right"), OTHER)
def test_another_type_or_name_than_the_codes_is_told(root: Path, typed: str, right: str) -> None:
    found = of_text(waiting(typed), root)[0]
    assert found.fix.startswith(f"type `{right}`")
    words = shlex.split(right)
    kind, given = words[4].replace("/", "."), words[5:]
    fields = interfaces.fields_of(f"{kind}_Request" if ".srv." in kind else kind)
    assert fields is None or not given or {*yaml.safe_load(given[0])} <= {*fields}


@pytest.mark.parametrize("typed", RIGHT)
def test_a_right_type_is_not_blamed(root: Path, typed: str) -> None:
    assert not of_text(waiting(typed), root)


def test_an_answered_call_is_not_blamed(root: Path) -> None:
    answer = "requester: making request: std_srvs.srv.Trigger_Request()\n\nresponse:\nstd_srvs.srv.Trigger_Response(success=True, message='')\n"
    assert not of_text(f"{waiting(f'{CALL} /park/open std_srvs/srv/Trigger')}{answer}", root)
