"""What is claimed of every run, every file or every callback, where only a part of it is so; and where it is."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.code.expression_faults import expression_faults
from ros2lab.diagnose.code.flow_faults import flow_faults
from ros2lab.diagnose.code.lost_values import lost_values
from ros2lab.diagnose.code.result_faults import result_faults
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.bursts import burst_faults
from ros2lab.diagnose.nodes.life_faults import life_faults
from ros2lab.diagnose.nodes.state_faults import state_faults
from ros2lab.diagnose.nodes.unset_attributes import no_such_member
from ros2lab.diagnose.sources.interfaces import node_members
from ros2lab.diagnose.sources.uses import Uses

HEAD = """\
import random
import sys
import threading
import time
from pathlib import Path

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Float32, String


class Lamp(Node):
    def __init__(self):
        super().__init__('lamp')
"""
SPINS = "rclpy.init()\nrclpy.spin(Lamp())\nrclpy.try_shutdown()"
ENDS = "rclpy.init()\nLamp()\nrclpy.shutdown()"
PUB = "self.pub = self.create_publisher(String, 'out', 10)\n"
SUB = "self.create_subscription(String, 'in', self.heard, 10)\n"
TIMER = "self.create_timer(1.0, self.tick)\n"
DRIVE = "self.pub = self.create_publisher(Twist, 'drive', 10)\n"
SEND = "self.pub.publish(String(data='x'))"
STARTED = "def heard(self, msg):\n    self.timer = self.create_timer(1.0, self.tick)\n\n"
ENDED = "def end(self):\n    self.timer.cancel()\n\ndef tick(self):\n    self.get_logger().info('on')"
HEARD = "def heard(self, msg):\n    self.get_logger().info(msg.data)\n"


def indented(text: str, depth: int) -> str:
    return "".join(f"{' ' * depth}{line}\n" if line else "\n" for line in text.strip("\n").split("\n"))


def findings(folder: Path, init: str, methods: str, main: str = SPINS) -> Iterator[Finding]:
    text = f"{HEAD}{indented(init, 8)}\n{indented(methods, 4)}\n\ndef main():\n{indented(main, 4)}"
    sources = sources_of(text, folder)
    assert not any(source.fault for source in sources.sources.values()), text
    yield from flow_faults(sources)
    yield from expression_faults(sources)
    yield from result_faults(Uses(sources))
    yield from lost_values(Uses(sources))
    yield from life_faults(sources, ["pk.node.main"])
    yield from state_faults(Uses(sources))
    yield from burst_faults(sources)


RIGHT = {
    "a rate in a loop that spins": (PUB + f"rate = self.create_rate(5)\nwhile rclpy.ok():\n    rclpy.spin_once(self)\n    {SEND}\n    rate.sleep()", "def rest(self):\n    pass", ENDS),
    "a rate in a loop that calls what spins": (PUB + "rate = self.create_rate(5)\nwhile rclpy.ok():\n    self.turn()\n    rate.sleep()", f"def turn(self):\n    {SEND}\n    rclpy.spin_once(self)", ENDS),
    "a rate that never sleeps": (SUB + "self.rate = self.create_rate(5)", HEARD, SPINS),
    "a stop instead of what was filled in": (DRIVE + SUB, "def heard(self, msg):\n    cmd = Twist()\n    cmd.linear.x = 0.5\n    if msg.data == 'stop':\n        cmd = Twist()\n    self.pub.publish(cmd)", SPINS),
    "an object that a list has already": (DRIVE + SUB + "self.sent = []", "def heard(self, msg):\n    cmd = Twist()\n    self.sent.append(cmd)\n    cmd.linear.x = 0.5\n    self.pub.publish(self.sent[-1])", SPINS),
    "a positive value": (DRIVE + SUB, "def heard(self, msg):\n    cmd = Twist()\n    if msg.data == 'left':\n        cmd.angular.z=+0.1\n    else:\n        cmd.angular.z=-0.1\n    self.pub.publish(cmd)", SPINS),
    "signs apart from their numbers": (SUB + "self.x = 0.0", "def heard(self, msg):\n    if msg.data == 'left':\n        self.x =+ 1.0\n    else:\n        self.x =- 1.0\n    self.get_logger().info(f'{self.x}')", SPINS),
    "a loop that is all a node does": (PUB + "while True:\n    self.ask()", "def ask(self):\n    self.pub.publish(String(data=input('> ')))", ENDS),
    "a loop that is all a timer's node does": (PUB + "self.create_timer(0.1, self.tick)", "def tick(self):\n    while True:\n        self.pub.publish(String(data=input('> ')))", SPINS),
    "a loop that calls what spins": (PUB + SUB + "while rclpy.ok():\n    self.turn()", f"{HEARD}\ndef turn(self):\n    rclpy.spin_once(self, timeout_sec=0.1)\n    {SEND}", ENDS),
    "a loop that calls what ends": (PUB + SUB + "while True:\n    self.ask()", f"{HEARD}\ndef ask(self):\n    word = input()\n    if not word:\n        sys.exit()\n    self.pub.publish(String(data=word))", SPINS),
    "a loop beside a thread that spins": (PUB + SUB + f"threading.Thread(target=rclpy.spin, args=(self,)).start()\nwhile True:\n    {SEND}", HEARD, ENDS),
    "a method that is called again later": (PUB + "self.send()", f"def send(self):\n    {SEND}", "rclpy.init()\nlamp = Lamp()\nwhile rclpy.ok():\n    lamp.send()\n    rclpy.spin_once(lamp, timeout_sec=0.5)\nrclpy.shutdown()"),
    "a wait with an end": (SUB + TIMER + "self.word = ''", "def heard(self, msg):\n    self.word = msg.data\n\ndef tick(self):\n    tries = 0\n    while not self.word and tries < 5:\n        tries += 1\n    self.get_logger().info(self.word)", SPINS),
    "a publisher that is made once": (SUB + "self.late = None", "def heard(self, msg):\n    if self.late:\n        return\n    self.late = self.create_publisher(String, 'late', 10)", SPINS),
    "a timer that is made once": (SUB + "self.is_on = False", "def heard(self, msg):\n    if self.is_on:\n        return\n    self.is_on = True\n    self.create_timer(1.0, self.tick)\n\ndef tick(self):\n    self.get_logger().info('on')", SPINS),
    "a subscription that was waited for": ("self.word = None\nself.sub = self.create_subscription(String, 'in', self.heard, 10)\nwhile self.word is None:\n    rclpy.spin_once(self)\nself.destroy_subscription(self.sub)\n" + TIMER, "def heard(self, msg):\n    self.word = msg.data\n\ndef tick(self):\n    self.get_logger().info(self.word)", SPINS),
    "a lambda with a variable of its own": ("for name in ['a', 'b']:\n    self.create_subscription(String, name, lambda msg: self.tell([name for name in msg.data]), 10)", "def tell(self, names):\n    self.get_logger().info(str(names))", SPINS),
    "chances": (PUB + TIMER, "def tick(self):\n    word = 'c'\n    if random.random() > 0.5:\n        word = 'a'\n    elif random.random() > 0.8:\n        word = 'b'\n    self.pub.publish(String(data=word))", SPINS),
    "a part of a text": (SUB, "def heard(self, msg):\n    if ' ' in msg.data.strip() or msg.data.lower() in 'Yes and No':\n        self.get_logger().info('two')", SPINS),
    "the value of a key": (SUB + "self.words = {'Stop': 'stop'}", "def heard(self, msg):\n    if msg.data.lower() == self.words['Stop']:\n        self.get_logger().info('stop')", SPINS),
    "a question whether there is an attribute": (SUB, "def heard(self, msg):\n    try:\n        self.last\n    except AttributeError:\n        self.last = msg.data\n        self.get_logger().info(self.last)", SPINS),
    "a question whether it is a number": (SUB, "def heard(self, msg):\n    try:\n        self.number(msg.data)\n    except ValueError:\n        self.get_logger().info('none')\n\ndef number(self, text):\n    return int(text)", SPINS),
    "a file that gets another name": (SUB + "self.file = Path('a')", "def heard(self, msg):\n    self.file.replace('b')\n    self.get_logger().info(str(self.file))", SPINS),
    "a local beside the attribute that is set": (SUB + PUB + "self.word = ''", "def heard(self, msg):\n    word = msg.data\n    self.word = msg.data\n    self.pub.publish(String(data=self.word))", SPINS),
    "a note beside a constant speed": (DRIVE + TIMER + "self.speed = 0.5\nself.state = 'idle'", "def tick(self):\n    self.state = 'moving'\n    cmd = Twist()\n    cmd.linear.x = self.speed\n    self.pub.publish(cmd)", SPINS),
    "a place where it began": ("self.x = 0.0\nself.goal = self.x + 5.0\nself.pub = self.create_publisher(Float32, 'out', 10)\n" + TIMER, "def tick(self):\n    self.x += 0.1\n    msg = Float32()\n    msg.data = self.goal\n    if self.x < self.goal:\n        self.pub.publish(msg)", SPINS),
    "a sum in one callback": ("self.sum = 0.0\nself.pub = self.create_publisher(Float32, 'out', 10)\nself.create_subscription(Float32, 'in', self.heard, 10)", "def heard(self, msg):\n    self.sum = 0.0\n    self.sum += msg.data\n    self.sum += 1.5\n    self.pub.publish(Float32(data=self.sum))", SPINS),
    "a message of what is the same for others": (DRIVE + SUB + TIMER + "self.speed = 0.1\nself.cmd = Twist()\nself.cmd.linear.x = self.speed", "def heard(self, msg):\n    self.speed = float(msg.data)\n\ndef tick(self):\n    self.cmd.angular.z = self.speed\n    self.pub.publish(self.cmd)", SPINS),
    "a message that is filled for others": (DRIVE + SUB + "self.cmd = Twist()", "def heard(self, msg):\n    self.make(self.cmd)\n    self.pub.publish(self.cmd)\n\ndef make(self, cmd):\n    cmd.linear.x = 0.5\n    return cmd", SPINS),
    "a variable that is called as a function of Python": (SUB, "def heard(self, msg):\n    sorted = print\n    sorted(msg.data)", SPINS),
    "a timer that ends itself": (SUB, f"{STARTED}def tick(self):\n    self.timer.cancel()", SPINS),
    "a timer in place of the one before": (SUB + "self.timer = None", STARTED.replace("    self", "    if self.timer:\n        self.timer.cancel()\n    self", 1) + ENDED, SPINS),
    "a timer of a node that is not on": (SUB + "self.timer = None", STARTED.replace("    self", "    if msg.data == 'go' and self.timer is None:\n        self", 1) + ENDED, SPINS),
    "a timer after one that something may end": ("self.wait = self.create_timer(1.0, self.heard)", f"{STARTED.replace(', msg', '')}{ENDED.replace('self.timer', 'self.wait')}", SPINS),
    "a publisher that a method has used": (PUB + f"self.tell()\n{PUB.replace('out', 'other')}" + "self.create_timer(1.0, self.tell)", f"def tell(self):\n    {SEND}", SPINS),
    "a shutdown at the end": (SUB, "def heard(self, msg):\n    self.get_logger().info(msg.data)\n    rclpy.shutdown()", "rclpy.init()\nrclpy.spin(Lamp())"),
    "slow rounds of few messages": (SUB, HEARD, "rclpy.init()\nlamp = Lamp()\nwhile rclpy.ok():\n    rclpy.spin_once(lamp, timeout_sec=0.5)\n    time.sleep(0.5)"),
    "a pause between messages": (PUB + SUB.replace("'in'", "'out'") + TIMER, f"{HEARD}\ndef tick(self):\n    for _ in range(20):\n        {SEND}\n        self.rest()\n\ndef rest(self):\n    time.sleep(0.1)", SPINS),
}  # fmt: skip


@pytest.mark.parametrize("name", RIGHT)
def test_what_holds_only_in_part_is_not_claimed(tmp_path: Path, name: str) -> None:
    assert [*findings(tmp_path, *RIGHT[name])] == []


WRONG = {
    "a rate that nothing wakes": ("rate-without-thread", PUB, HEARD, f"rclpy.init()\nlamp = Lamp()\nrate = lamp.create_rate(2)\nwhile rclpy.ok():\n    lamp.{SEND[5:]}\n    rate.sleep()", "create_timer"),
    "made again in every case": ("filling-lost", DRIVE + SUB, "def heard(self, msg):\n    cmd = Twist()\n    if msg.data == 'go':\n        cmd.linear.x = 0.5\n    cmd = Twist()\n    self.pub.publish(cmd)", SPINS, "remove this line"),
    "filled after it was sent": ("filling-lost", PUB + SUB, "def heard(self, msg):\n    out = String()\n    self.pub.publish(out)\n    out.data = msg.data", SPINS, "move"),
    "an addition": ("no-effect", SUB + "self.x = 0.0", "def heard(self, msg):\n    self.x =+ 0.1\n    self.get_logger().info(f'{self.x}')", SPINS, "self.x += 0.1"),
    "two plus signs": ("no-effect", SUB + "self.x = 0", "def heard(self, msg):\n    ++self.x\n    self.get_logger().info(f'{self.x}')", SPINS, "self.x += 1"),
    "a sleep without its call": ("no-effect", SUB, "def heard(self, msg):\n    time.sleep\n    self.get_logger().info(msg.data)", SPINS, "write time.sleep(seconds), with your own value for seconds"),
    "a result that nobody wants": ("no-effect", SUB + "self.x = 0", "def heard(self, msg):\n    self.x = len(msg.data)\n    self.size()\n\ndef size(self):\n    return self.x", SPINS, "use what it returns, or remove this line"),
    "a loop beside a callback": ("endless-loop", PUB + SUB + f"while True:\n    {SEND}", HEARD, SPINS, "timer"),
    "a loop before the spin": ("endless-loop", PUB + f"while True:\n    {SEND}", HEARD.replace("heard", "said"), SPINS, "timer"),
    "sent in the constructor": ("sent-early", PUB + SEND, HEARD.replace("heard", "said"), SPINS, "create_timer"),
    "a wait that nothing ends": ("callback-waits", SUB + TIMER + "self.word = ''", "def heard(self, msg):\n    self.word = msg.data\n\ndef tick(self):\n    while not self.word:\n        pass\n    self.get_logger().info(self.word)", SPINS, "heard()"),
    "a publisher each time": ("made-again", SUB, "def heard(self, msg):\n    late = self.create_publisher(String, 'late', 10)\n    late.publish(msg)", SPINS, "__init__"),
    "a timer each time": ("timer-in-callback", SUB, "def heard(self, msg):\n    self.create_timer(1.0, self.tick)\n\ndef tick(self):\n    self.get_logger().info('on')", SPINS, "once"),
    "a timer at each start": ("timer-in-callback", SUB + "self.timer = None", STARTED + ENDED, SPINS, "write `if self.timer is not None:` above this line, and `self.destroy_timer(self.timer)`"),
    "a timer at one of its words": ("timer-in-callback", SUB, STARTED.replace("    self", "    if msg.data == 'go':\n        self", 1) + ENDED, SPINS, "; and `self.timer = None` in __init__"),
    "a subscription at each start": ("made-again", SUB, "def heard(self, msg):\n    self.sub = self.create_subscription(String, msg.data, print, 1)\n\ndef end(self):\n    self.destroy_subscription(self.sub)", SPINS, "destroy_subscription(self.sub)"),
    "a client each time": ("made-again", SUB, "def heard(self, msg):\n    self.client = self.create_client(String, 'ask')\n    self.client.call_async(msg)", SPINS, "__init__"),
    "a publisher of each name": ("made-again", SUB, "def heard(self, msg):\n    topic = f'/{msg.data}/echo'\n    late = self.create_publisher(String, topic, 10)\n    late.publish(msg)", SPINS, "in a dictionary of self under `topic`"),
    "a counter that begins anew": ("begun-anew", PUB + TIMER + "self.count = 0", "def tick(self):\n    self.count = 0\n    self.count += 1\n    self.pub.publish(String(data=str(self.count)))", SPINS, "remove"),
    "a text of what changes": ("computed-once", PUB + TIMER + "self.count = 0\nself.text = f'at {self.count}'", "def tick(self):\n    self.count += 1\n    self.pub.publish(String(data=self.text))", SPINS, "first line of tick()"),
    "a message of what changes": ("computed-once", DRIVE + SUB + TIMER + "self.speed = 0.1\nself.cmd = Twist()\nself.cmd.linear.x = self.speed", "def heard(self, msg):\n    self.speed = float(msg.data)\n\ndef tick(self):\n    self.pub.publish(self.cmd)", SPINS, "write `self.cmd.linear.x = self.speed` as the first line of tick()"),
    "a message that nobody takes": ("no-effect", DRIVE + SUB + "self.speed = 0.1", "def heard(self, msg):\n    self.make()\n    self.pub.publish(Twist())\n\ndef make(self):\n    cmd = Twist()\n    cmd.linear.x = self.speed\n    return cmd", SPINS, "use what it returns"),
    "an order that nobody takes": ("no-effect", SUB, "def heard(self, msg):\n    words = msg.data.split()\n    sorted(words)\n    self.get_logger().info(str(words))", SPINS, "write words = sorted(words)"),
    "a second shutdown": ("shutdown-in-callback", SUB, "def heard(self, msg):\n    self.get_logger().info(msg.data)\n    rclpy.shutdown()", "rclpy.init()\nrclpy.spin(Lamp())\nrclpy.shutdown()", "rclpy.try_shutdown()"),
    "an init twice": ("rclpy-init-twice", SUB, HEARD, f"rclpy.init()\n{SPINS}", "remove"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_what_holds_in_every_case_is_told_with_a_fix(tmp_path: Path, name: str) -> None:
    code, init, methods, main, fix = WRONG[name]
    told = {finding.code: finding.fix for finding in findings(tmp_path, init, methods, main)}
    assert fix in told.get(code, ""), told


@pytest.mark.parametrize(
    ("init", "methods", "fix"),
    [
        (SUB, "def heard(self, msg):\n    self.logger.info(msg.data)", "write self.get_logger(), or define"),
        (SUB, "def get_place(self):\n    return self.place", "set self.place in __init__"),
        (SUB, "def heard(self, msg):\n    self.timer_.cancel()", "set self.timer_ in __init__"),
        (SUB, "def heard(self, msg):\n    self.destroy.action()", "set self.destroy in __init__"),
        (
            DRIVE,
            "def stop(self):\n    self.stopper.publish(Twist())",
            "write self.pub instead of self.stopper",
        ),
        (
            DRIVE.replace("self.pub", "self.pub1") + DRIVE.replace("self.pub", "self.pub2"),
            "def stop(self):\n    self.cmd2_pub.publish(Twist())",
            "write self.pub2 instead of self.cmd2_pub",
        ),
        (PUB, "def stop(self):\n    self.stopper.publish(Twist())", "create_publisher(Twist, '...', 10)"),
    ],
)
def test_an_attribute_is_meant_as_it_is_used(tmp_path: Path, init: str, methods: str, fix: str) -> None:
    """A getter is called, but not by itself; a publisher of the type is there already."""
    text = f"{HEAD}{indented(init, 8)}\n{indented(methods, 4)}"
    (owner,) = sources_of(text, tmp_path).nodes
    members = node_members() | owner.attributes
    missing = next(
        node
        for node in owner.source.nodes
        if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "self" and node.attr not in members
    )
    assert fix in no_such_member(owner, missing, "attribute", members).fix


LEFT = "def heard(self, msg):\n    self.get_logger().info(msg.data)\n    if msg.data == 'end':\n        rclpy.shutdown()\n        {}\n\ndef leave(self):\n    sys.exit(0)"
BARE = "rclpy.spin(Lamp())\nrclpy.shutdown()"
FINALLY = "try:\n    rclpy.spin(Lamp())\nfinally:\n    rclpy.shutdown()"
CAUGHT = "try:\n    rclpy.spin(Lamp())\nexcept {}:\n    pass\nrclpy.shutdown()"


@pytest.mark.parametrize(
    ("way", "main", "is_told"),
    [
        ("self.get_logger().info('bye')", BARE, True),
        ("sys.exit(1)", BARE, False),
        ("raise SystemExit", BARE, False),
        ("raise ValueError(msg.data)", BARE, False),
        ("os._exit(1)", FINALLY, False),
        ("self.leave()", BARE, False),
        ("self.leave()", FINALLY, True),
        ("sys.exit(1)", CAUGHT.format("KeyboardInterrupt"), False),
        ("sys.exit(1)", CAUGHT.format("SystemExit"), True),
        ("raise KeyboardInterrupt", CAUGHT.format("KeyboardInterrupt"), True),
        ("if self.sent:\n            sys.exit(1)", BARE, True),
        ("raise NotImplemented", CAUGHT.format("KeyboardInterrupt"), False),
        ("raise self.error", CAUGHT.format("Exception"), True),
    ],
)
def test_a_second_shutdown_is_come_to_after_the_first(
    tmp_path: Path, way: str, main: str, is_told: bool
) -> None:
    """A callback that ends the program, or raises an error, is left past what is not in a `finally`."""
    told = findings(tmp_path, SUB + "self.sent = 0", LEFT.format(way), f"rclpy.init()\n{main}")
    codes = [finding.code for finding in told]
    assert ("shutdown-in-callback" in codes) == is_told
    assert "unknown" not in codes


def test_a_callback_may_end_the_program_at_its_end(tmp_path: Path) -> None:
    once = (
        "def heard(self, msg):\n    self.get_logger().info(msg.data)\n    rclpy.shutdown()\n    sys.exit(0)"
    )
    assert [*findings(tmp_path, SUB, once, f"rclpy.init()\n{BARE}")] == []
