"""What the code makes of publishers and subscriptions, as far as it tells without being run."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import pytest

from ros2lab.diagnose.code.syntax_repairs import as_meant
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.rules import text_faults
from ros2lab.diagnose.sources.python_source import PythonSource, read_source
from ros2lab.grading.evidence import WrittenEnd
from ros2lab.grading.reading.diagnosed import corrected
from ros2lab.grading.reading.written_ends import ends_elsewhere, ends_left, hidden_ends, written_ends

WORDS = ("start", "stop", "reset")
SOURCE = """
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import String

PERIOD = 2.0


class Status(Node):
    def __init__(self):
        super().__init__("status")
        self.speed = self.create_publisher(Twist, "cmd_vel", 10)
        self.status = self.create_publisher(String, "/robot/status", 10)
        self.create_subscription(String, "/robot/command", self.on_command, 10)
        self.create_timer(PERIOD, self.tick)
        self.create_timer(0.1, self.on_condition)

    def tick(self):
        message = String()
        self.status.publish(message)

    def on_condition(self):
        if self.speed:
            self.speed.publish(Twist())

    def on_command(self, message):
        pass
"""


def test_topics_types_and_timers_are_read() -> None:
    source = PythonSource("status", "status.py", SOURCE)
    assert written_ends([source], words=WORDS)[0] == [
        WrittenEnd("/cmd_vel", "geometry_msgs/msg/Twist", True, [], "status", ["publishes"], ["varies"]),
        WrittenEnd("/robot/status", "std_msgs/msg/String", True, [2.0], "status", ["publishes"], ["varies"]),
        WrittenEnd("/robot/command", "std_msgs/msg/String", False, [], "status", []),
    ]


@pytest.mark.parametrize(
    ("right", "other", "publishes"),
    [
        ("self.status.publish(message)", "self.latest = message", False),
        ("self.status.publish(message)", "self.status.get_subscription_count()", False),
        ("self.status = self.create", "self.create", False),
        ("self.status.publish(message)", "return self.status.publish(message)", True),
        ("self.status.publish(message)", "return\n        self.status.publish(message)", False),
        ("self.status.publish(message)", "tell(self.status, message)", True),
        ("self.status.publish(message)", "send = self.status.publish\n        send(message)", True),
        ("self.status = self.create", "self.ends['status'] = self.create", True),
        ("self.status.publish(message)", "getattr(self, 'status').publish(message)", True),
    ],
)
def test_whether_a_publisher_is_told_to_publish_is_read(right: str, other: str, publishes: bool) -> None:
    """Or handed on, so that something else may."""
    assert right in SOURCE
    text = f"from tools import tell\n{SOURCE.replace(right, other, 1)}"
    ends = written_ends([PythonSource("status", "status.py", text)])[0]
    does = [end.does for end in ends if end.topic == "/robot/status"]
    assert does == [["publishes"] if publishes else []]


@pytest.mark.parametrize(
    ("right", "slip", "is_undone"),
    [
        ("create_timer(PERIOD, self.tick)", "create_timer(2.0.self.tick)", True),
        ("create_timer(PERIOD", "creat_timer(PERIOD", True),
        ("self.status.publish(", "self.statu.publish(", True),
        ("self.status.publish(", "self.status.publsh(", True),
        ("super().__init__(", "super().__init(", True),
        ("import String", "import Strng", True),
        # Names of another API, or made like another one.
        ("self.create_subscription(", "self.create_subscriber(", True),
        ("self.create_subscription(", "self.create_sub(", True),
        ("self.status = self.create_publisher(", "self.status = self.create_pub(", True),
        ("create_timer(PERIOD", "create_wall_timer(PERIOD", True),
        ("self.create_subscription(", "self.create_robot(", False),
        (
            "create_timer(PERIOD, self.tick)",
            "create_timer(1.0, self.tick)",
            False,
        ),  # what was meant is not known
        ('"/robot/status"', '"/robot/statsu"', False),
    ],
)
def test_what_was_meant_is_read_where_a_slip_ends_the_node(right: str, slip: str, is_undone: bool) -> None:
    """As `diagnose` says to write it: names, dots and commas, and no other number or text."""
    whole = PythonSource("status", "status.py", SOURCE)
    source = PythonSource("status", "status.py", SOURCE.replace(right, slip, 1))
    found = [*text_faults(source)]

    def told(one: PythonSource) -> list[tuple[str, str, list[float]]]:
        return [(end.topic, end.type_name, end.periods) for end in written_ends([one], words=WORDS)[0]]

    assert (told(corrected(source, found)) == told(whole)) is is_undone


def test_what_is_said_to_be_written_instead_of_something_else_is_undone() -> None:
    """However little the two have in common; another text or number is no slip."""
    call = 'String, "/robot/command", self.on_command, 10)'
    source = PythonSource(
        "status", "status.py", SOURCE.replace("self.create_subscription(", "rclpy.Subscriber(")
    )
    new, old = (
        f"{name}({call}".replace('"', "'") for name in ("self.create_subscription", "rclpy.Subscriber")
    )
    line = source.text[: source.text.index("rclpy.Subscriber(")].count("\n") + 1
    for fix, is_undone in [
        (f"write `{new}` instead of `{old}`", True),
        (f"write `{new.replace('command', 'orders', 1)}` instead of `{old}`", False),
    ]:
        found = corrected(source, [Finding("ros1-import", "", f"status.py:{line}", fix)])
        assert ("self.create_subscription(" in found.text) is is_undone, fix


def test_a_publisher_of_the_same_name_in_another_node_is_another_one() -> None:
    """In another file, or another class of one file; one in a class derived from it is the same."""
    silent = SOURCE.replace("self.status.publish(message)", "pass").replace("class Status", "class Silent")
    other = PythonSource("silent", "silent.py", silent)
    both = PythonSource("both", "both.py", SOURCE + silent.partition("PERIOD = 2.0")[2])
    derived = f"{silent}\nclass Loud(Silent):\n    def on_command(self, message):\n        self.status.publish(message)\n"
    told = {
        "files": written_ends([PythonSource("status", "status.py", SOURCE), other])[0],
        "classes": written_ends([both])[0],
        "derived": written_ends([PythonSource("derived", "derived.py", derived)])[0],
    }
    does = {name: [end.does for end in ends if end.topic == "/robot/status"] for name, ends in told.items()}
    assert does == {"files": [["publishes"], []], "classes": [["publishes"], []], "derived": [["publishes"]]}


IMPORTS = "import rclpy\nfrom rclpy.node import Node\nfrom std_msgs.msg import String\n"
TAKES = "super().__init__('a'); self.create_subscription(String, '/robot/command', {}, 10)"
METHOD = f"""{IMPORTS}
class Commands(Node):
    def __init__(self):
        {TAKES.format("self.obey")}

    def obey(self, message):
        %s
"""
SAYS = "self.get_logger().info(message.data)"


@pytest.mark.parametrize(
    ("text", "does"),
    [
        (METHOD % "'Take start, stop and reset.'", []),
        (METHOD % "self.get_logger().info('a command: start, stop or reset')", ["logs"]),
        (METHOD % SAYS, ["reads", "logs"]),
        (METHOD % "self.state = {'start': 1, 'stop': 0, 'reset': 0}.get(message.data)", ["reads", "compares"]),
        (
            METHOD % f"{SAYS}\n        if message.data in ['start', 'stop', 'reset']: self.state = message.data",
            ["reads", "logs", "compares"],
        ),
        (
            METHOD % f"{SAYS}\n        if message.data == 'start': self.state = message.data",
            ["reads", "logs"],
        ),
        (
            METHOD % "getattr(self, f'on_{message.data}')()\n"
            "    def on_start(self): print('go')\n    def on_stop(self): pass\n    def on_reset(self): pass\n",
            ["reads", "logs", "compares"],
        ),
        (
            METHOD % "self.state = State[message.data.upper()]\nclass State(Enum):\n    START, STOP, RESET = 1, 2, 3\n",
            ["reads", "compares"],
        ),
        (METHOD % "if False: self.state = message.data", []),
        (
            f"{IMPORTS}class A(Node):\n    def __init__(self):\n        {TAKES.format('lambda m: print(m.data)')}\n",
            ["reads"],
        ),
        (f"{IMPORTS}class A(Node):\n    def __init__(self):\n        {TAKES.format('lambda m: None')}\n", []),
        (f"{IMPORTS}class A(Node):\n    def __init__(self):\n        {TAKES.format('partial(f, 1)')}\n", []),
        (
            f"{IMPORTS}from functools import partial\ndef f(n, m): print(m.data)\nclass A(Node):\n    def __init__(self):\n        {TAKES.format('partial(f, 1)')}\n",
            ["reads", "logs"],
        ),
        (
            f"{IMPORTS}import kit\nclass A(Node):\n    def __init__(self):\n        "
            + TAKES.format("kit.obey(self, 'start', 'stop', 'reset')"),
            ["compares"],
        ),
        (
            f"{IMPORTS}def obey(m): print(m.data)\ndef main():\n    rclpy.init()\n    node = Node('a')\n"
            "    node.create_subscription(String, '/robot/command', obey, 10)\n    print('ready')\n",
            ["reads", "logs"],
        ),
        (
            f"{IMPORTS}heard = []\ndef obey(m): heard.append(m)\ndef main():\n    rclpy.init()\n    node = Node('a')\n"
            "    node.create_subscription(String, '/robot/command', obey, 10)\n    print('ready')\n",
            ["reads"],
        ),
        (
            f"{IMPORTS}heard = []\ndef obey(m): heard.append(m)\ndef main():\n    rclpy.init()\n    node = Node('a')\n"
            "    node.create_subscription(String, '/robot/command', obey, 10)\n    while True: print(heard.pop())\n",
            ["reads", "logs"],
        ),
    ],
)  # fmt: skip
def test_what_a_subscriber_does_with_commands_is_read(text: str, does: list[str] | None) -> None:
    """In many styles; what only describes the code, or begins it, is no reaction."""
    source = PythonSource("commands", "commands.py", text)
    assert source.tree.body, source.fault
    assert [end.does for end in written_ends([source], words=WORDS)[0]] == [does]


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("(PERIOD, self.tick)", "(PERIOD, self.tick"),
        ("def __init__(self):", "def __init__(self)"),
        ("(Node):", "(Node)"),
        ("message = String()", "message = String() // of the status"),
        ("message = String()", 'message = String("'),
        (
            "message = String()",
            "\n<<<<<<< HEAD\n        message = String()\n=======\n        message = String()\n>>>>>>> mine",
        ),
        ("import rclpy", "Here is the node:\n```python\nimport rclpy"),
        ("message = String()", "message = String()\n        if True\n            x = [1, 2"),
    ],
)
def test_what_a_file_makes_is_read_past_what_python_cannot_read(right: str, wrong: str) -> None:
    """It dies at once, and what its code plainly has is there all the same."""
    source = PythonSource("status", "status.py", SOURCE)
    spoilt = PythonSource("status", "status.py", SOURCE.replace(right, wrong, 1))
    assert right in SOURCE
    assert spoilt.readable_to < len(spoilt.text.split("\n"))
    found, right_ones = (
        [[replace(end, never=[]) for end in ends] for ends in written_ends([one])] for one in (spoilt, source)
    )
    assert found == right_ones


def test_what_python_cannot_read_at_all_is_left_as_it_is() -> None:
    source = PythonSource("notes", "notes.py", "\n".join(["dear teacher ,"] * 20))
    assert as_meant(source) is source


PLAIN = "import rclpy\nnode = rclpy.create_node('a')\nnode.create_publisher(String, '/a', 1)\n"


@pytest.mark.parametrize(
    ("files", "publishers"),
    [
        ({}, []),
        ({"README.md": "Call create_publisher(String, '/a', 1)."}, []),
        ({"src/a/a/status.py": PLAIN.replace("node.create", "make = node.create").replace("her(", "her; make(")}, [True]),
        ({"src/a/a/status.py": f"{PLAIN}getattr(node, 'create_publisher')(String, '/b', 1)\n"}, [True]),
        ({"src/a/a/status.py": f"{PLAIN}# create_publisher\n"}, []),
        ({"src/a/scripts/talker": f"#!/usr/bin/env python3\n{PLAIN}"}, [True]),
        ({"src/b/b.cpp": "node->create_publisher<String>(topic, 1);"}, [True]),
        ({"src/a/data/table.py": "X = [\n" + "    1,\n" * 150_000 + "]\n"}, [True, False]),
    ],
    ids=["nothing", "prose", "other name", "text", "comment", "no ending", "C++", "too large"],
)  # fmt: skip
def test_what_may_make_an_end_besides_is_known(
    tmp_path: Path, files: dict[str, str], publishers: list[bool]
) -> None:
    """So that a node counts as somebody else's only where nothing that was handed in can make it."""
    for name, text in {"src/a/a/status.py": PLAIN, **files}.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    source = read_source(tmp_path / "src/a/a/status.py", "a.status", "status.py")
    paths = [path.relative_to(tmp_path) for path in tmp_path.rglob("*") if path.is_file()]
    found = ends_elsewhere(tmp_path, paths, [source], written_ends([source])[0])
    assert [end.is_publisher for end in found] == publishers


_MADE = "import rclpy\nfrom std_msgs.msg import String\nfrom geometry_msgs.msg import Twist\n"


@pytest.mark.parametrize(
    ("code", "types"),
    [
        ("self.p = self.create_generic_publisher(Twist, '/cmd_vel', 10)", {"geometry_msgs/msg/Twist"}),
        ("ends = {'publisher': (Twist, '/a')}\nfor k, (t, n) in ends.items():\n    getattr(self, f'create_{k}')(t, n, 1)", {"geometry_msgs/msg/Twist", ""}),
        ("self.s = message_filters.Subscriber(self, String, '/robot/command')", {"std_msgs/msg/String"}),
        ("publish = partial(self.create, msg_type=Twist)", {"geometry_msgs/msg/Twist"}),
        ("make = operator.methodcaller('_'.join(['create', kind]), Twist, '/a', 10)", {"geometry_msgs/msg/Twist", ""}),
        ("def make(kind=Twist):\n    return kind", {"geometry_msgs/msg/Twist"}),
        ("Node.__dict__['create_' + kind](self, get_message(name), '/a', 1)", {""}),
        ("module = importlib.import_module('geometry_msgs.msg')", {""}),
        ("self.p = self.create_publisher(Twist, '/cmd_vel', 10)", set()),
        ("self.p = self.create_lifecycle_publisher(Twist, '/cmd_vel', 10)", set()),
        ("message = Twist()\nmessage.linear.x = 1.0", set()),
        ("def obey(self, message: Twist) -> Twist:\n    known: String = message\n    return isinstance(message, (Twist, String))", set()),
        ("subprocess.run(['ros2', 'topic', 'pub', '/cmd_vel', 'geometry_msgs/msg/Twist'])", set()),
        ("from demo_nodes_py.topics.talker import main\nmain(['talker'])", set()),
        ("x = getattr(self, 'speed', 0.0)\ncall = operator.attrgetter('x')", set()),
    ],
    ids=["another method", "table", "library", "partial", "methodcaller", "default", "__dict__", "import",
         "plain", "lifecycle", "message", "annotation", "program", "demo", "by a text"],
)  # fmt: skip
def test_an_end_that_reading_does_not_see_may_be_made_by_what_has_its_type(
    code: str, types: set[str]
) -> None:
    """Only where nothing is given the message's class, and nothing is looked up, is it known that none is made."""
    source = PythonSource("node", "node.py", _MADE + code)
    found = [*hidden_ends([source], [*itertools.chain(*written_ends([source]))])]
    assert {end.type_name for end in found} == types
    assert all(not end.topic for end in found)


LOOPING = f"""{IMPORTS}
import threading

def main():
    rclpy.init()
    node = rclpy.create_node('a')
    there = node.create_publisher(String, '/a', 10)
    rate = node.create_rate(10)
    def go_on(*_):
        while rclpy.ok():
            there.publish(String())
            rate.sleep()
    %s

if __name__ == '__main__':
    main()
"""


@pytest.mark.parametrize(
    ("text", "begins"),
    [
        ("while rclpy.ok(): there.publish(String()); rate.sleep()", True),
        ("while True: there.publish(String()); input()", True),
        ("there.publish(String()); lock.acquire()", True),
        ("go_on()", True),
        ("threading.Thread(target=go_on).start()", True),
        ("node.create_timer(1.0, go_on); rclpy.spin(node)", False),
        ("node.create_subscription(String, '/b', go_on, 10); rclpy.spin(node)", False),
        ("while rclpy.ok():\n        if node.is_on: there.publish(String())", False),
        ("if node.is_on: go_on()", False),
        ("while rclpy.ok(): rate.sleep(); there.publish(String())", False),
        ("rclpy.spin(node); go_on()", False),
        ("client.wait_for_service()\n    while True: there.publish(String())", False),
    ],
)
def test_what_is_published_before_anything_calls_back_is_read(text: str, begins: bool) -> None:
    ends, _ = written_ends([PythonSource("a", "a.py", LOOPING % text)])
    assert [end.begins for end in ends if end.is_publisher] == [begins]


CALL = "self.status.publish(message)"
SENT = "\n\n    def send(self, message):\n        self.status.publish(message)\n"


@pytest.mark.parametrize(
    ("other", "line"),
    [
        (f"self.send{SENT}", "self.send"),
        (f"self.send(message){SENT.replace('def', 'async def')}", "self.send(message)"),
        (f"{CALL}\n        yield message", "yield message"),
        (f"self.send(message){SENT}\n    def send(self, message):\n        print(message)\n", "def send(self, message):"),
        (f"with self.lock:\n            self.locked(message)\n\n    def locked(self, message):\n        with self.lock:\n            {CALL}\n", "self.locked(message)"),
        # with another way to it, or in vain for something else
        (f"{CALL}\n        self.send{SENT}", ""),
        (f"{CALL}\n        self.tell\n\n    def tell(self):\n        print('well')\n", ""),
        (f"{CALL}\n\n    def tell(self):\n        print('a')\n\n    def tell(self):\n        print('b')\n", ""),
    ],
)  # fmt: skip
def test_what_is_done_in_vain_is_left_out(other: str, line: str) -> None:
    """Whatever `diagnose` calls in vain on the only way to it; what it says of other lines changes nothing."""
    text = SOURCE.replace(CALL, other).replace("import rclpy", "import threading\nimport rclpy", 1)
    text = text.replace(
        "        self.speed =", "        self.lock = threading.Lock()\n        self.speed =", 1
    )
    source = PythonSource("status", "status.py", text)
    findings = [one for one in text_faults(source) if one.never]
    assert findings
    ends = written_ends([source], words=WORDS)[0]
    left = ends_left(ends, findings, lambda vain: written_ends([source], words=WORDS, vain=vain)[0])
    row = max(
        (number for number, said in enumerate(text.splitlines(), 1) if line and said.strip() == line),
        default=0,
    )
    told = {(*(end.does or ()), end.vain) for end in left if end.topic == "/robot/status"}
    does = {first for first, *_ in told}
    assert does == {f"status.py:{row}"} if line else does <= {"publishes"}
