"""Values that are made, filled in or changed, and reach nobody; and those that do, however they are written."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.code.lost_values import lost_values
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.uses import Uses

FILE = """\
import copy
import rclpy
from builtin_interfaces.msg import Time
from example_interfaces.srv import AddTwoInts
from geometry_msgs.msg import Point, PoseStamped, TransformStamped, Twist
from rclpy.action import ActionServer
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Header, String
from std_srvs.srv import SetBool
from tf2_msgs.action import LookupTransform


class Robot(Node):
    def __init__(self):
        super().__init__('robot')
        self.pub = self.create_publisher(Twist, 'cmd_vel', 10)
        self.said = self.create_publisher(String, 'said', 10)
        self.poses = self.create_publisher(PoseStamped, 'pose', 10)
        self.joints = self.create_publisher(JointState, 'joint_states', 10)
        self.cli = self.create_client(AddTwoInts, 'add')
        self.create_service(SetBool, 'on', self.on)
        self.create_timer(1.0, self.tick)
        self.act = ActionServer(self, LookupTransform, 'look', self.look)
        self.speed = 0.5
        self.is_on = False
        {init}

    def on(self, request, response):
        {on}

    def tick(self):
        {tick}

    def look(self, goal_handle):
        {look}

    def more(self, msg):
        {more}


def main():
    rclpy.init()
    robot = Robot()
    {main}
    rclpy.spin(robot)
"""
RIGHT = {
    "main": "pass",
    "init": "pass",
    "on": "response.success = True\nreturn response",
    "tick": "pass",
    "look": "goal_handle.succeed()\nreturn LookupTransform.Result()",
    "more": "pass",
}
P, Q = "self.pub.publish(msg)", "self.poses.publish(msg)"
T = "msg = Twist()\n"
FULL = "msg = Twist()\nmsg.linear.x = self.speed\n"
NOW = "self.get_clock().now().to_msg()"
STAMP = f"msg.header.stamp = {NOW}\n"
POSE = "msg = PoseStamped()\n"


def sources_with(folder: Path, bodies: Mapping[str, str]) -> NodeSources:
    inside = {
        name: text.replace("\n", "\n    " if name == "main" else "\n        ")
        for name, text in {**RIGHT, **bodies}.items()
    }
    return sources_of(FILE.format(**inside), folder)


def told(folder: Path, bodies: Mapping[str, str]) -> list[str]:
    found = lost_values(Uses(sources_with(folder, bodies)))
    return [f"{finding.code}: {finding.cause} {finding.fix}" for finding in found]


LOST = [
    # what is filled is not what goes out
    ({"on": "response.success = True\nresponse.message = 'on'\nreturn SetBool.Response()"}, "never-sent: on() fills response but never returns it: it returns SetBool.Response() instead. write return response"),
    ({"on": "answer = SetBool.Response()\nresponse.success = request.data\nreturn answer"}, "it returns answer instead. write return response"),
    ({"on": "answer = SetBool.Response(success=True)\nreturn response"}, "on() fills answer but never returns it: it returns response instead."),
    ({"on": "if request.data:\n    response.success = True\n    return response\nresponse.message = 'no'\nreturn SetBool.Response()"}, "What on() fills into response above does not go out: it returns SetBool.Response() here instead. write return response"),
    ({"look": "result = LookupTransform.Result()\nresult.error.error_string = 'x'\ngoal_handle.succeed()\nreturn LookupTransform.Result()"}, "write return result"),
    ({"tick": "request = AddTwoInts.Request()\nrequest.a = 1\nself.future = self.cli.call_async(AddTwoInts.Request())"}, "it sends AddTwoInts.Request() instead. write self.cli.call_async(request)"),
    ({"tick": f"{FULL}self.pub.publish(Twist())"}, "it publishes Twist() instead. write self.pub.publish(msg)"),
    ({"tick": f"{FULL}cmd = Twist()\nself.pub.publish(cmd)"}, "it publishes cmd instead. write self.pub.publish(msg)"),
    ({"init": "self.msg = Twist()", "tick": f"{FULL}self.pub.publish(self.msg)"}, "it publishes self.msg instead. write self.pub.publish(msg)"),
    ({"init": "self.msg = Twist()", "tick": f"self.msg.linear.x = 0.1\n{T}{P}"}, "tick() fills self.msg but never sends it: it publishes msg instead. write self.pub.publish(self.msg)"),
    ({"tick": f"{FULL}print(msg)\nself.pub.publish(Twist())"}, "it publishes Twist() instead."),
    # it goes nowhere
    ({"tick": f"{FULL}self.get_logger().info(f'sent {{msg.linear.x}}')"}, "tick() fills msg but never sends it."),
    ({"tick": FULL}, "never-sent: tick() fills msg but never sends it. write `self.pub.publish(msg)` as the last line of tick()"),
    ({"tick": "request = AddTwoInts.Request()\nrequest.a = 1"}, "write `self.cli.call_async(request)` as the last line of tick()"),
    ({"look": "feedback = LookupTransform.Feedback()\nfeedback.x = 1\ngoal_handle.succeed()\nreturn LookupTransform.Result()"}, "write `goal_handle.publish_feedback(feedback)` above line"),
    ({"tick": f"header = Header(frame_id='map')\n{POSE}msg.pose.position.x = 1.0\n{Q}"}, "puts it nowhere: msg.header stays at its default. write `msg.header = header` above line"),
    ({"tick": f"point = Point()\npoint.x = 1.0\n{POSE}{STAMP}{Q}"}, "msg.pose.position stays at its default. write `msg.pose.position = point` above line"),
    # too late, or before it is made anew
    ({"tick": f"{T}{P}\nmsg.linear.x = 1.0"}, "filling-lost: `msg.linear.x = 1.0` comes after `self.pub.publish(msg)`"),
    ({"tick": f"{T}{P}\nif self.is_on:\n    msg.linear.x = 1.0"}, "`msg.linear.x = 1.0` comes after"),
    ({"tick": f"{FULL}{P}\nmsg.angular.z = 0.5"}, "`msg.angular.z = 0.5` comes after"),
    ({"tick": f"for _ in range(3):\n    {T}    {P}\n    msg.linear.x = 1.0"}, "`msg.linear.x = 1.0` comes after"),
    ({"tick": f"try:\n    {T}    {P}\n    msg.linear.x = 1.0\nexcept ValueError:\n    pass"}, "`msg.linear.x = 1.0` comes after"),
    ({"tick": "request = AddTwoInts.Request()\nself.cli.call_async(request)\nrequest.a = 1"}, "move `self.cli.call_async(request)` after the lines that fill request"),
    ({"tick": "msg = JointState()\nself.joints.publish(msg)\nmsg.name.append('left')"}, "`msg.name.append('left')` comes after"),
    ({"tick": f"{FULL}{T}{P}"}, "msg is created again here, so what line 35 filled in is lost. remove this line"),
    # copied before it changes
    ({"tick": f"{T}speed = self.speed\nmsg.linear.x = speed\nspeed = min(speed, 0.2)\n{P}"}, "filling-lost: `msg.linear.x = speed` copies speed before line 37 changes it"),
    ({"tick": f"{T}speed = self.speed\nmsg.linear.x = speed\nif speed > 0.2:\n    speed = speed / 2\nelse:\n    pass\n{P}"}, "move `msg.linear.x = speed` below line 40"),
    ({"tick": "msg = String()\ntext = 'a'\nmsg.data = text\ntext += ' b'\nself.said.publish(msg)"}, "move `msg.data = text` below line 37"),
    # the value is there, the field is not set
    ({"tick": f"{POSE}now = {NOW}\nmsg.header.frame_id = 'map'\n{Q}"}, "never-read: tick() sets now, which nothing reads, and msg.header.stamp stays at its default in what is sent. write `msg.header.stamp = now`"),
    ({"tick": f"{POSE}stamp = self.get_clock().now()\n{Q}"}, "write `msg.header.stamp = stamp.to_msg()`"),
    ({"tick": f"{POSE}frame_id = 'map'\n{STAMP}{Q}"}, "write `msg.header.frame_id = frame_id`"),
    ({"tick": f"names = ['left']\nmsg = JointState(position=[0.0])\n{STAMP}self.joints.publish(msg)"}, "write `msg.name = names`"),
    ({"init": "self.joint_names = ['left']", "tick": f"msg = JointState()\n{STAMP}self.joints.publish(msg)"}, "write `msg.name = self.joint_names`"),
    ({"init": "self.frame_id = 'map'", "tick": f"{POSE}{STAMP}{Q}"}, "__init__() sets self.frame_id, which nothing reads"),
    ({"tick": f"angular_z = self.speed * 2.0\n{FULL}{P}"}, "write `msg.angular.z = angular_z`"),
    ({"tick": f"angular = self.speed * 2.0\n{FULL}{P}"}, "fill msg.angular with it"),
]  # fmt: skip


@pytest.mark.parametrize(("bodies", "said"), LOST)
def test_what_reaches_nobody_is_told_with_a_fix(tmp_path: Path, bodies: Mapping[str, str], said: str) -> None:
    (found,) = told(tmp_path, bodies)
    assert said in found


REACHED = [
    {"on": "answer = SetBool.Response()\nanswer.success = True\nreturn answer"},
    {"on": "response = SetBool.Response()\nresponse.success = True\nreturn response"},
    {"on": "if not request.data:\n    return SetBool.Response()\nresponse.success = True\nreturn response"},
    {"on": "response.success = False\nif not request.data:\n    return SetBool.Response(message='no')\nreturn response"},
    {"on": "response.success, response.message = True, 'on'\nreturn response"},
    {"on": "self.answer(response)\nresponse.message = 'on'\nreturn SetBool.Response()"},
    {"on": "try:\n    response.success = True\n    return response\nfinally:\n    self.is_on = request.data"},
    {"on": "response.success = True\nresponse.message = 'on'\nanswer = response\nreturn answer"},
    {"look": "feedback = LookupTransform.Feedback()\nfeedback.x = 1\ngoal_handle.publish_feedback(feedback)\ngoal_handle.succeed()\nreturn LookupTransform.Result()"},
    {"tick": f"{FULL}if self.is_on:\n    {P}\nelse:\n    self.pub.publish(Twist())"},
    {"tick": f"{FULL}if not self.is_on:\n    {T}{P}"},
    {"tick": f"msg = Twist()\nmsg.linear.x = 0.0\n{T}{P}"},
    {"tick": "msg = Twist()\nmsg.linear.x = 0.0\nself.pub.publish(Twist())"},
    {"tick": f"{FULL}{P}\nmsg.linear.x = 0.0"},
    {"tick": f"{FULL}{P}\nmsg.linear.x += 1.0"},
    {"tick": f"{T}msg.linear = V\n{P}\nmsg.linear.x = 0.0"},
    {"tick": f"{T}{P}\nmsg.linear.x = 1.0\n{P}"},
    {"tick": f"{T}while rclpy.ok():\n    {P}\n    msg.linear.x += 0.1"},
    {"tick": f"{T}for _ in range(3):\n    if self.is_on:\n        {P}\n        continue\n    msg.linear.x = 1.0"},
    {"tick": f"{T}try:\n    msg.linear.x = float('x')\nexcept ValueError:\n    msg.linear.x = 1.0\nfinally:\n    {P}"},
    {"tick": f"{T}if self.is_on:\n    {P}\n    return\nmsg.linear.x = 1.0\n{P}"},
    {"tick": f"{T}self.last = msg\n{P}\nmsg.linear.x = 1.0"},
    {"tick": f"{T}send = lambda: {P}\nmsg.linear.x = 1.0\nsend()"},
    {"tick": f"{FULL}self.send([msg])"},
    {"tick": f"{FULL}return msg"},
    {"tick": f"{FULL}yield msg"},
    {"tick": f"{FULL}cmd = Twist()\nself.fill(cmd, msg)\nself.pub.publish(cmd)"},
    {"tick": f"{FULL}cmd = Twist()\ncmd.linear = msg.linear\nself.pub.publish(cmd)"},
    {"tick": f"{FULL}cmd = copy.copy(msg)\nself.pub.publish(cmd)"},
    {"init": "self.msg = Twist()", "tick": "self.msg.linear.x = 0.1\nself.pub.publish(self.msg)"},
    {"init": "self.msg = Twist()", "tick": "self.pub.publish(self.msg)\nself.msg.linear.x = 0.1"},
    {"init": "self.msg = Twist()", "more": "self.msg.linear.x = 0.1", "tick": "self.pub.publish(Twist() if self.is_on else self.msg)"},
    {"init": "self.cmd = Twist()\nself.msg = Twist()\nself.all = [self.msg]", "more": "self.msg.linear.x = 0.1", "tick": "self.pub.publish(self.cmd)"},
    {"init": "self.msg = Twist()\nself.cmd = Twist()", "more": "self.msg.linear.x = 0.1", "tick": "self.pub.publish(self.cmd)"},
    {"init": "self.msg = Twist()", "more": "self.msg.linear.x = msg.linear.x\nprint(self.msg.linear.x)\nself.pub.publish(msg)", "tick": "self.pub.publish(Twist())"},
    {"init": "self.msg = Twist()\nself.msg.linear.x = self.get_parameter('speed').value", "tick": "self.pub.publish(Twist())"},
    {"init": "self.msg = Twist()", "tick": f"self.msg.linear.x = 0.1\nself.get_logger().info(f'{{self.msg}}')\n{T}{P}"},
    {"more": "wanted = Twist()\nwanted.linear.x = 0.5\nself.get_logger().info(f'wanted {wanted}, got {msg}')\nself.pub.publish(msg)"},
    {"more": "change = Twist()\nchange.linear.x = msg.linear.x - 0.5\nprint('change', change.linear.x)\nself.pub.publish(msg)"},
    {"tick": f"{FULL}print(msg)\nif self.is_on:\n    self.pub.publish(Twist())"},
    {"init": "self.cmd = Twist()", "tick": f"{FULL}print(msg.linear.x)\nself.pub.publish(self.cmd)"},
    {"tick": f"{FULL}print(msg)", "more": "self.pub.publish(msg)"},
    {"tick": f"point = Point(x=1.0)\nprint(point)\n{POSE}{STAMP}{Q}"},
    {"tick": f"{T}speed = self.speed\nmsg.linear.x = speed\n{P}\nself.speed = speed + 1.0"},
    {"tick": f"{T}speed = self.speed\nmsg.linear.x = speed\nspeed = -speed\nmsg.angular.z = speed\n{P}"},
    {"tick": f"{T}speed = 0.0\nwhile rclpy.ok():\n    msg.linear.x = speed\n    speed += 0.1\n    {P}"},
    {"tick": "count = 0\nfor word in ['a', 'b']:\n    self.said.publish(String(data=f'{count}{word}'))\n    count += 1"},
    {"tick": "count = 0\nfor word in ['a', 'b']:\n    count += len(word)\nself.said.publish(String(data=str(count)))"},
    {"tick": f"{T}speed = self.speed\nmsg.linear.x = speed\nspeed = 0.0\n{P}"},
    {"tick": "msg = String()\nstate = 'ok'\nmsg.data = state\nif state == 'ok':\n    state = 'told'\nself.said.publish(msg)"},
    {"tick": "msg = JointState()\nnames = ['left']\nmsg.name = names\nnames += ['right']\nself.joints.publish(msg)"},
    {"tick": "msg = JointState()\nnames = ['left']\nmsg.name = names\nnames = self.completed(names)\nself.joints.publish(msg)"},
    {"tick": f"{T}row = 1\nmsg.linear.x = row\nrow += 1\n{P}"},
    {"tick": f"{T}row = 1\nmsg.linear.x = row\nrow = row + 1\n{P}"},
    {"more": "line = 1\ntext = f'{line}: {msg}'\nline += 1\nself.said.publish(String(data=text))"},
    {"more": "place = 0\nkind = msg.position[place]\nplace += 1\nself.said.publish(String(data=kind))"},
    {"tick": "row = 0\nself.write(row)\nrow += 1\nself.write(row)\nrow += 1"},
    {"tick": f"{POSE}now = {NOW}\nself.get_logger().info(f'{{now}}')\n{Q}"},
    {"tick": f"{POSE}now = {NOW}\nmsg.header.stamp = now\n{Q}"},
    {"tick": f"{POSE}now = {NOW}\nself.stamp(msg)\n{Q}"},
    {"tick": f"{POSE}msg.header = Header(stamp={NOW}, frame_id='map')\nframe_id = 'map'\n{Q}"},
    {"tick": f"{POSE}frame = self.look_up()\n{STAMP}{Q}"},
    {"tick": f"{POSE}x = self.look_up()\n{STAMP}{Q}"},
    {"tick": f"{POSE}_, frame_id = self.look_up()\nprint(_)\n{STAMP}{Q}"},
    {"init": "self.frame_id = 'map'", "tick": f"{POSE}{STAMP}msg.header.frame_id = 'odom'\n{Q}\npose = PoseStamped()\n{Q.replace('msg', 'pose')}"},
    {"init": "self.frame_id = 'map'", "tick": f"{POSE}{STAMP}msg.header.frame_id = self.frame_id\n{Q}"},
    {"init": "self.msg = PoseStamped()\nself.frame_id = 'map'", "main": "robot.msg.header.frame_id = 'odom'", "tick": "self.poses.publish(self.msg)"},
    {"init": "self.msg = PoseStamped()\nself.frame_id = 'map'", "main": "robot.msg = filled()", "tick": "self.poses.publish(self.msg)"},
    {"init": "self.msg = PoseStamped()\nself.frame_id = 'map'", "main": "def fill(node):\n    node.msg.header.frame_id = 'odom'", "tick": "fill(self)\nself.poses.publish(self.msg)"},
    {"init": "import filling\nself.msg = PoseStamped()\nself.frame_id = 'map'\nfilling.fill(self)", "tick": "self.poses.publish(self.msg)"},
    {"init": "self.linear_x = 0.1\nself.msg = Twist()\nnode = self\ndef step():\n    node.msg.linear.x = 0.2\nself.step = step", "tick": "self.pub.publish(self.msg)"},
    {"init": "self.frame_id = 'map'", "more": "from operator import attrgetter\nprint(attrgetter('frame_id')(self))", "tick": f"{POSE}{STAMP}{Q}"},
    {"more": f"def publish(msg):\n    {STAMP}    {Q}", "tick": f"now = {NOW}\n{POSE}self.publish(msg)"},
    {"more": "def publish(msg):\n    self.waiting.append(msg)", "tick": f"{T}self.outbox.publish(msg)\nmsg.linear.x = 1.0\nself.outbox.flush()"},
    {"more": "def call(msg):\n    return msg", "tick": f"{T}cmd = self.call(msg)\nmsg.linear.x = 0.5\nself.pub.publish(cmd)"},
    {"init": "self.frame_id = 'map'", "tick": f"msg = PoseStamped(**self.fields())\n{STAMP}{Q}"},
    {"init": f"self.last_time = {NOW}\nself.linear = 0.1", "tick": f"{POSE}{Q}\nmsg = Twist()\nmsg.angular.z = 1.0\n{P}"},
]  # fmt: skip


@pytest.mark.parametrize("bodies", REACHED)
def test_of_what_somebody_gets_or_nobody_misses_nothing_is_told(
    tmp_path: Path, bodies: Mapping[str, str]
) -> None:
    assert told(tmp_path, bodies) == []


def test_an_attribute_that_another_package_may_read_is_left_alone(tmp_path: Path) -> None:
    sources = sources_with(tmp_path, {"init": "self.frame_id = 'map'", "tick": f"{POSE}{Q}"})
    assert [*lost_values(Uses(sources))]
    for used in ([*sources.classes], [*sources.sources]):
        assert not [*lost_values(Uses(NodeSources(sources.sources, used)))]
