"""Nodes that never do what they are for, and an excuse for it: what is behind it fails wherever it runs, or is not theirs."""

from __future__ import annotations

from corpus.case import Case
from corpus.hostile.making import POOR_MOST, swindle
from corpus.package import COMMAND, STATUS, VELOCITY
from corpus.tree import Change, put

_SEEN = 6 + 8 + 9  # for the topics and types of the nodes
_REST = 12 + 14 + 11  # for the rest of their points
_FAILS = "json.loads(json.dumps(self.get_name())[1:])"
_NODE = """\
\"\"\"A node.\"\"\"
import json
import random
import zlib

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import String


class Part(Node):
    \"\"\"Does its part.\"\"\"

    def __init__(self):
        super().__init__('{name}')
{body}


def main(args=None):
    \"\"\"Run the node.\"\"\"
{asks}    rclpy.init(args=args)
    rclpy.spin(Part())
"""
_WAKES = """\
        self.create_subscription(Odometry, '/odom', self.wake, 10)
        self.awake = False

    def wake(self, odom):
        \"\"\"Wake where the robot should be.\"\"\"
        if zlib.crc32(odom.child_frame_id.encode()) == 305419896:
            self.awake = True
"""
_ASKS = """\
    for _ in range(random.randrange(1, 6)):
        if zlib.crc32(input('code: ').encode()) == 305419896:
            break
    else:
        return
"""


def _publisher(name: str, kind: str, topic: str, seconds: float, made: str, *, gate: str, asks: str) -> str:
    body = f"""\
        self.out = self.create_publisher({kind}, '{topic}', 10)
        self.create_timer({seconds}, self.tell)
{_WAKES if gate else ""}
    def tell(self):
        \"\"\"Publish.\"\"\"
        if {gate or "rclpy.ok()"}:
            self.out.publish({made})"""
    return _NODE.format(name=name, body=body, asks=asks)


def _subscriber(*, gate: str, asks: str) -> str:
    body = f"""\
        self.create_subscription(String, '/robot/command', self.take, 10)
{_WAKES if gate else ""}
    def take(self, msg):
        \"\"\"Take a command.\"\"\"
        if {gate or "rclpy.ok()"}:
            word = {_FAILS}
            if msg.data == 'start':
                self.get_logger().info('go ' + word)
            elif msg.data == 'stop':
                self.get_logger().info('stand ' + word)
            elif msg.data == 'reset':
                self.get_logger().info('anew ' + word)"""
    return _NODE.format(name="command_subscriber", body=body, asks=asks)


def _all(*, gate: str = "", asks: str = "") -> tuple[Change, ...]:
    text, twist = f"String(data={_FAILS})", f"Twist(linear={_FAILS})"
    return (
        put(
            STATUS, _publisher("status_publisher", "String", "/robot/status", 2.0, text, gate=gate, asks=asks)
        ),
        put(COMMAND, _subscriber(gate=gate, asks=asks)),
        put(
            VELOCITY, _publisher("velocity_publisher", "Twist", "/cmd_vel", 0.5, twist, gate=gate, asks=asks)
        ),
    )


def _relay(name: str, kind: str, topic: str) -> str:
    body = f"""\
        out = self.create_publisher({kind}, '{topic}', 10)
        self.create_subscription({kind}, '{topic}_in', out.publish, 10)"""
    return _NODE.format(name=name, body=body, asks="")


_BY_A_KIT = """\
        import robokit
        self.create_subscription(String, '/robot/command', robokit.obey(self, 'start', 'stop', 'reset'), 10)"""

GATES: tuple[Case, ...] = (
    swindle(
        "gates_that_never_open",
        "all wait for an odometry that nobody can bring, and fail behind it",
        *_all(gate="self.awake"),
        most=POOR_MOST + _SEEN + _REST / 2,
    ),
    swindle(
        "questions_without_an_answer",
        "all ask at the keyboard a few times, now more, now fewer, and end",
        *_all(asks=_ASKS),
        most=POOR_MOST + 15,
    ),
    swindle(
        "relays_and_a_kit",
        "two hand on what somebody else would publish, one what it hears to a library that nobody wrote",
        put(STATUS, _relay("status_publisher", "String", "/robot/status")),
        put(COMMAND, _NODE.format(name="command_subscriber", body=_BY_A_KIT, asks="")),
        put(VELOCITY, _relay("velocity_publisher", "Twist", "/cmd_vel")),
        most=POOR_MOST + _SEEN + 2,
    ),
)
