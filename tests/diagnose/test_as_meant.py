"""What was written, and how it was meant: a line of Python, a call of a library, a command, and what is in vain."""

from __future__ import annotations

import ast
import sys
from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_text, of_workspace
from ros2lab.diagnose.code.syntax_repairs import syntax_finding
from ros2lab.diagnose.explaining.commands import corrected
from ros2lab.diagnose.explaining.usage import accepted_form
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.sources.calls import meant_call
from ros2lab.diagnose.sources.checker import newer_syntax
from ros2lab.diagnose.sources.python_source import PythonSource

IMPORTS = """\
import rclpy
from geometry_msgs.msg import Twist, Vector3
from launch import LaunchDescription
from launch.actions import ExecuteProcess, TimerAction
from launch_ros.actions import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import String
"""
NODE = "from rclpy.node import Node\n\n\nclass Talk(Node):\n    def tick(self, msg):\n"


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("self.count++", "self.count += 1"),
        ("int count = 0;", "count = 0"),
        ("String msg = String()", "msg = String()"),
        ("msg = new String()", "msg = String()"),
        ("msg->data = 'a'", "msg.data = 'a'"),
        ("// what comes", "# what comes"),
        ("print 'a', msg", "print('a', msg)"),
        ("text = 'Robot's here'", 'text = "Robot\'s here"'),
        ("text = f'{msg.data'", "text = f'{msg.data}'"),
        ("text = 'count ' self.count", "text = 'count ' + str(self.count)"),
        ("self.publish(msg", "self.publish(msg)"),
        ("self.publish(msg))", "self.publish(msg)"),
        ("self.create(String, '/a' 10)", "self.create(String, '/a', 10)"),
        ("self.create(‘a’)", "self.create('a')"),  # noqa: RUF001 -- the quotes of a text program
        ("self.class = 1", "self.class_ = 1"),
        ("self.call(() => self.tick())", "self.call(lambda : self.tick())"),
        ("if msg.data = 'a': return", "if msg.data == 'a': return"),
        ("if msg.data == 'a' && self.on: return", "if msg.data == 'a' and self.on: return"),
        ("if (msg.data == 'a') {\n            return\n        }", "if (msg.data == 'a'):"),
        (
            "if msg.data == 'a':\n            return\n        else if self.on:\n            return",
            "elif self.on:",
        ),
    ],
)
def test_a_line_is_written_so_that_python_reads_it(line: str, fix: str) -> None:
    """The repair is tried before it is told: Python reads the file with it."""
    source = PythonSource("talk", "talk.py", f"{NODE}        {line}\n        self.done = True\n")
    assert source.tree
    finding = syntax_finding("node-syntax", source)
    assert finding.fix.startswith(f"write `{fix}`"), finding


@pytest.mark.parametrize(
    ("text", "fix"),
    [
        ("def tick():\n    await wait()\n", "remove await, or put it inside an async function"),
        ("return 1\n", "remove return, or put it inside a function"),
        ("break\n", "remove break, or put it inside a loop"),
        ("def tick(a, a):\n    pass\n", "fix this line as the message says"),
    ],
)
def test_what_stands_in_the_wrong_place_lacks_no_comma(text: str, fix: str) -> None:
    source = PythonSource("talk", "talk.py", text)
    assert source.tree
    assert syntax_finding("node-syntax", source).fix == fix


@pytest.mark.parametrize(
    ("call", "meant"),
    [
        (
            "self.create_subscription(String, self.tick, '/a', 10)",
            "self.create_subscription(String, '/a', self.tick, 10)",
        ),
        ("self.create_timer(self.tick, 0.5)", "self.create_timer(0.5, self.tick)"),
        ("self.create_timer(self.period, self.tick)", ""),  # a property, or an attribute
        ("self.create_subscription(String, self.topic, self.tick, 10)", ""),
    ],
)
def test_a_function_of_ones_own_is_no_text_and_no_number(call: str, meant: str) -> None:
    own = "    @property\n    def period(self):\n        return 1.0\n\n    def __init__(self):\n        self.topic = '/a'\n"
    source = PythonSource("talk", "talk.py", f"{IMPORTS}{NODE}        {call}\n\n{own}")
    (found,) = (node for node in source.nodes if isinstance(node, ast.Call))
    assert meant_call(source, found) == (f"write `{meant}`" if meant else "")


@pytest.mark.parametrize(
    ("call", "meant"),
    [
        ("self.create_timer('0.5', self.tick)", "self.create_timer(0.5, self.tick)"),
        ("self.create_timer(0.5, self.tick, 10)", "self.create_timer(0.5, self.tick)"),
        ("self.create_publisher(String, '/a')", "self.create_publisher(String, '/a', 10)"),
        ("self.create_publisher(String, '/a', self.tick, 10)", "self.create_publisher(String, '/a', 10)"),
        ("super().__init__('talk', 'robot')", "super().__init__('talk', namespace='robot')"),
        ("rclpy.spin_once(node, None, '1.0')", "rclpy.spin_once(node, executor=None, timeout_sec=1.0)"),
        ("QoSProfile(10)", "QoSProfile(depth=10)"),
        ("Twist(0.5, 0.2)", "Twist(linear=Vector3(x=0.5), angular=Vector3(z=0.2))"),
        ("Vector3(1, 2, 3)", "Vector3(x=1.0, y=2.0, z=3.0)"),
        ("String('hello')", "String(data='hello')"),
        (
            "Node(package='a', node_executable='b', node_name='c')",
            "Node(package='a', executable='b', name='c')",
        ),
        ("Node(executable='a', output=True)", "Node(executable='a', output='screen')"),
        ("Node(executable='a', remappings={'/a': '/b'})", "Node(executable='a', remappings=[('/a', '/b')])"),
        ("ExecuteProcess(command=['ls'])", "ExecuteProcess(cmd=['ls'])"),
        ("LaunchDescription(Node(executable='a'))", "LaunchDescription([Node(executable='a')])"),
    ],
)
def test_a_call_is_given_what_the_library_takes(call: str, meant: str) -> None:
    """From the signature in the installed library; a call that is right is left alone."""
    for text, fix in ((call, f"write `{meant}`"), (meant, "")):
        source = PythonSource("talk", "talk.py", f"{IMPORTS}{text}\n")
        statement = source.tree.body[-1]
        assert isinstance(statement, ast.Expr)
        assert isinstance(statement.value, ast.Call)
        assert meant_call(source, statement.value) == fix


def test_a_value_too_many_is_given_to_the_keyword_that_comes_next() -> None:
    source = PythonSource("copy", "copy.py", "import shutil\nshutil.copyfile(old, new, False)\n")
    (call,) = source.calls
    assert meant_call(source, call) == "write `shutil.copyfile(old, new, follow_symlinks=False)`"


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("ros2 run status_publisher", "ros2 run my_bot status_publisher"),
        ("ros2 run my_bot status_publisher.py", "ros2 run my_bot status_publisher"),
        ("ros2 run my_bot robot.launch.py", "ros2 launch my_bot robot.launch.py"),
        ("ros2 launch my_bot robot.launch.py speed=1", "ros2 launch my_bot robot.launch.py speed:=1"),
        ("ros2 topic hz /robot/reports", "ros2 topic hz /robot/report"),
        (
            "ros2 topic pub /robot/command String 'data: start'",
            "ros2 topic pub /robot/command std_msgs/msg/String 'data: start'",
        ),
        (
            "ros2 topic pub /robot/command std_msgs/msg/String '{text: start}'",
            "ros2 topic pub /robot/command std_msgs/msg/String '{data: start}'",
        ),
        (
            "ros2 topic pub --once /cmd_vel geometry_msgs/msg/Twist '{linear: 0.5}'",
            "ros2 topic pub --once /cmd_vel geometry_msgs/msg/Twist '{linear: {x: 0.5}}'",
        ),
        ("ros2 param set /velocity_publisher speed 2", "ros2 param set /velocity_publisher speed 2.0"),
        ("ros2 param get velocity_publisher", "ros2 param get velocity_publisher speed"),
        ("ros2 interface show Twist", "ros2 interface show geometry_msgs/msg/Twist"),
        ("ros2 interface show std_msgs/string", "ros2 interface show std_msgs/msg/String"),
        ("ros2 interface show std_msgs/msg/string", "ros2 interface show std_msgs/msg/String"),
        ("ros2 run status_publisher status_publisher", "ros2 run my_bot status_publisher"),
        ("ros2 launch robot.launch.py", "ros2 launch my_bot robot.launch.py"),
        ("ros2 launch status_publisher robot.launch.py", "ros2 launch my_bot robot.launch.py"),
        ("colcon build my_bot", "colcon build --packages-select my_bot"),
        ("export ROS_DOMAIN_ID=500", "export ROS_DOMAIN_ID=7"),
    ],
)
def test_a_command_is_typed_as_it_was_meant(tmp_path: Path, typed: str, meant: str) -> None:
    """Each word against what the workspace has at that place; a command that is right is left alone."""
    look = Look(right_workspace().write(tmp_path))
    found = corrected(typed, look)
    assert found is not None
    assert found.line == meant
    is_declared = "speed:=1" not in meant  # which the launch file does not declare
    assert not is_declared or corrected(meant, look) is None


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("ros2 topic pub -r /a std_msgs/msg/String 'data: x'", "ros2 topic pub -r 1 /a std_msgs/msg/String 'data: x'"),
        ("ros2 topic pub -r 0,5 /a std_msgs/msg/String", "ros2 topic pub -r 0.5 /a std_msgs/msg/String"),
        ("ros2 topic pub /a std_msgs/msg/String data: hello", "ros2 topic pub /a std_msgs/msg/String 'data: hello'"),
        ("ros2 topic echo --qos-reliability /a", "ros2 topic echo --qos-reliability reliable /a"),
        ("ros2 topic hz --windw 5 /a", "ros2 topic hz --window 5 /a"),
        ("ros2 topic ehco /a", "ros2 topic echo /a"),
        ("ros2 launch my_bot robot.launch.py --speed 0.3", "ros2 launch my_bot robot.launch.py speed:=0.3"),
        ("ros2 run --ros-args -p a:=1 my_bot talk", "ros2 run my_bot talk --ros-args -p a:=1"),
    ],
)  # fmt: skip
def test_a_command_that_ros2_refuses_is_typed_so_that_its_parser_takes_it(typed: str, meant: str) -> None:
    form = accepted_form(typed)
    assert form is not None
    assert form[0] == meant
    assert accepted_form(meant) is None


def test_a_refused_command_is_told_with_the_values_that_were_typed(tmp_path: Path) -> None:
    typed = "ros2 topic pub --rate /robot/command std_msgs/msg/String '{data: start}'"
    said = "usage: ros2 topic pub\nros2 topic pub: error: argument -r/--rate: invalid float value: '/robot/command'"
    finding = of_text(f"$ {typed}\n{said}\n", right_workspace().write(tmp_path))[0]
    assert finding.fix == "type `ros2 topic pub --rate 1 /robot/command std_msgs/msg/String '{data: start}'`"


@pytest.mark.parametrize(
    ("name", "old", "new", "code"),
    [
        (
            "node",
            "        self.count = 0\n",
            "        self.count = 0\n        self.timer.cancel()\n",
            "never-started",
        ),
        ("node", "        self.timer = self.create_timer(0.5, self.timer_callback)\n", "", "never-called"),
        ("node", "        msg = String()", "        self.count = 0\n        msg = String()", "begun-anew"),
        (
            "node",
            "        msg = String()",
            "        if self.count == 0:\n            return\n        msg = String()",
            "never-passed",
        ),
        (
            "driver",
            "        self.publisher_.publish(msg)",
            "        msg = Twist()\n        self.publisher_.publish(msg)",
            "filling-lost",
        ),
        ("driver", "        msg.linear.x = self", "        speed = self", "never-read"),
        ("listener", "self.state = 'running'", "self.State = 'running'", "never-read"),
        ("listener", "if msg.data ==", "if self.state == 'runing' or msg.data ==", "never-equal"),
    ],
)
def test_what_is_in_vain_is_found(tmp_path: Path, name: str, old: str, new: str, code: str) -> None:
    files = right_workspace().change(name, old, new)
    if new.startswith("        speed"):
        files.change(name, "msg.angular.z = 0.2", "msg.linear.x = 0.0")
    (finding,) = of_workspace(files.write(tmp_path))
    assert finding.code == code
    assert files.path(name) in finding.place


def test_a_line_that_tutorials_write_is_no_alarm(tmp_path: Path) -> None:
    """What only names an attribute that holds something is written so that it counts as used."""
    files = right_workspace()
    files.change(
        "listener",
        "    def command_callback",
        "        self.subscription  # used\n\n    def command_callback",
    )
    assert of_workspace(files.write(tmp_path)) == []


@pytest.mark.parametrize(
    ("typed", "word"),
    [
        (["bash install/setup.bash"], "runs in its own shell"),
        (["source install/setup.bash", "export AMENT_PREFIX_PATH=/opt/ros"], "removes"),
        (["source install/setup.bash", "colcon build"], "before my_bot was built"),
        (["ls"], "has not sourced"),
    ],
)
def test_why_a_built_package_is_not_found_is_told_by_what_was_typed(
    tmp_path: Path, typed: list[str], word: str
) -> None:
    root = right_workspace().write(tmp_path)
    marker = root / "install/my_bot/share/ament_index/resource_index/packages/my_bot"
    marker.parent.mkdir(parents=True)
    marker.touch()
    lines = [
        *(f"$ {line}" for line in typed),
        "$ ros2 run my_bot status_publisher",
        "Package 'my_bot' not found",
    ]
    finding = of_text("\n".join(lines), root)[0]
    assert word in finding.cause
    assert f"source {root}/install/setup.bash" in finding.fix


METHOD = "    def timer_callback"
UNUSED = [
    ("node", "node = StatusPublisher()", "node = rclpy.create_node('status_publisher')", "never-made", "StatusPublisher()"),
    ("node", "        self.count += 1\n", f"        self.count += 1\n\n{METHOD}(self):\n        self.count += 2\n", "replaced", "move the lines from line 14"),
    ("node", "    def timer_callback", "    def timer_callback(self):\n        print('ready')\n\n    def timer_callback", "replaced", "remove the one on line 14, which does nothing"),
    ("node", "        self.count += 1\n", f"        self.count += 1\n\n{METHOD}(self):\n        pass\n", "replaced", "remove this one, if it is only a draft"),
    ("node", "        self.count += 1\n", f"        self.count += 1\n\n{METHOD}(self):\n        raise NotImplementedError\n", "replaced", "remove this one, if it is only a draft"),
    ("node", "        self.count += 1\n", f"        self.count += 1\n\n    def faster(self):\n        self.create_timer(0.1, self.timer_callback)\n\n{METHOD}(self):\n        self.count += 2\n", "replaced", "move the lines from line 14"),
    ("node", "self.count = 0\n", "self.count = 0\n        self.speeds = {'go': 1.0, 'go': 0.0}\n", "replaced", "'go'"),
    ("node", "self.publisher_.publish(msg)", "self.publisher_.publish(String())", "never-sent", "publish(msg)"),
    ("node", "        self.publisher_.publish(msg)\n", "", "never-sent", "self.publisher_.publish(msg)"),
    ("node", "f'Robot is running: {self.count}'", "'self.count'", "text-not-filled", "str(self.count)"),
    ("node", "        msg = String()", "        limited(self.count)\n        msg = String()", "no-effect", "self.count = limited(self.count)"),
    ("node", "{self.count}'", "{short(self.count)}'", "value-none", "return small"),
    ("node", "        msg = String()", "        begun = 1\n        msg = String()", "not-kept", "global begun"),
    ("driver", "self.get_parameter('speed').value", "0.5", "parameter-unread", "msg.linear.x = self.get_parameter('speed').value"),
    ("driver", "        self.publisher_.publish(msg)", "        if self.moves:\n            self.publisher_.publish(msg)", "never-passed", "self.moves = True"),
    ("listener", "            self.state = 'running'\n", "            pass\n\n    def change(self, word):\n        self.state = word\n", "never-called", "self.change(msg.data)"),
]  # fmt: skip


@pytest.mark.parametrize("row", UNUSED)
def test_what_is_defined_and_does_not_reach_its_use_is_told_with_the_line_to_write(
    tmp_path: Path, row: tuple[str, str, str, str, str]
) -> None:
    name, old, new, code, fix = row
    files = right_workspace()
    if name == "node":
        functions = "def limited(x):\n    return min(x, 9)\n\n\ndef short(x):\n    small = x % 9\n\n\n"
        shown = "begun = 0\nprint(begun)\n\n\n" if "begun" in new else ""
        functions = functions if "(self.count)" in new else ""
        files.change(name, "class StatusPublisher", f"{functions}{shown}class StatusPublisher")
    if "self.moves" in new:
        files.change(name, "('velocity_publisher')\n", "('velocity_publisher')\n        self.moves = False\n")
    if code == "never-called":
        files.change(name, "if msg.data == 'start'", "if msg.data == 'start' or self.state == ''")
    files.change(name, old, new)
    findings = [one for one in Look(files.write(tmp_path)).findings if one.code == code]
    assert findings
    assert any(fix in f"{one.fix} {one.cause}" for one in findings), findings
    assert files.path(name) in findings[0].place


def test_what_the_constructor_computes_and_a_callback_changes_later_is_told(tmp_path: Path) -> None:
    files = right_workspace()
    files.change(
        "node", "self.count = 0\n", "self.count = 0\n        self.text = f'Robot is running: {self.count}'\n"
    )
    files.change("node", "msg.data = f'Robot is running: {self.count}'", "msg.data = self.text")
    (finding,) = of_workspace(files.write(tmp_path))
    assert finding.code == "computed-once"
    assert "as the first line of timer_callback()" in finding.fix


def test_a_constant_switch_and_a_saved_value_are_no_alarm(tmp_path: Path) -> None:
    """A switch that only adds a log, and a value that is kept from the beginning, are meant."""
    files = right_workspace()
    kept = "        self.is_loud = False\n        self.first = self.count\n"
    files.change("node", "self.count = 0\n", f"self.count = 0\n{kept}")
    files.change(
        "node",
        "        self.count += 1",
        "        if self.is_loud:\n            self.get_logger().info(f'{self.first}')\n        self.count += 1",
    )
    assert of_workspace(files.write(tmp_path)) == []


@pytest.mark.skipif(sys.version_info >= (3, 12), reason="this Python reads it")
@pytest.mark.parametrize(
    ("line", "said", "fix"),
    [
        ('text = f"{msg["a"]} is here"', "outer quote character", "write `text = f'{msg[\"a\"]} is here'`"),
        ("text = f\"{', '.join(msg[\"a\"])}\"", "outer quote character", "write it without that, or use Python 3.12"),
        ("text = f\"{'\\n'.join(msg)}\"", "backslash", "write it without that, or use Python 3.12"),
        ("type Pace = float", "type` alias", "write it without that, or use Python 3.12"),
        ("def first[T](all: list[T]) -> T: return all[0]", "type parameter", "write it without that, or use Python 3.12"),
    ],
)  # fmt: skip
def test_what_only_a_later_python_reads_is_told_as_that(line: str, said: str, fix: str) -> None:
    source = PythonSource("talk", "talk.py", f"{NODE}        {line}\n        self.done = True\n")
    assert source.tree
    finding = syntax_finding("node-syntax", source)
    here = (
        f"Python {sys.version_info[0]}.{sys.version_info[1]}, which runs here, cannot read talk.py: it cannot"
    )
    assert finding.cause.startswith(here)
    assert said in finding.cause
    assert finding.cause.endswith("That is valid from Python 3.12 on.")
    assert (finding.place, finding.fix) == ("talk.py:6", fix)


@pytest.mark.parametrize(
    "line", ['text = f"{msg["', 'text = f"{msg[0}"', "print 'a'", "match msg {", "text = f'{msg.data'"]
)
def test_what_no_python_reads_is_the_file_s_fault(line: str) -> None:
    source = PythonSource("talk", "talk.py", f"{NODE}        {line}\n        self.done = True\n")
    assert source.tree
    assert "which runs here" not in syntax_finding("node-syntax", source).cause


@pytest.mark.parametrize(
    ("text", "version"),
    [
        ("match data:\n    case 1:\n        pass\n", (3, 10)),
        ("try:\n    pass\nexcept* ValueError:\n    pass\n", (3, 11)),
        ("if (n := 3):\n    pass\n", (3, 8)),
        ("with (open('a') as a, open('b') as b):\n    pass\n", (3, 9)),
        ("x = 1\n", None),
        ("x = (\n", None),
    ],
)
def test_the_version_that_reads_it_is_asked_for(text: str, version: tuple[int, int] | None) -> None:
    newer = newer_syntax(text, (3, 7))
    assert (newer.version if newer else None) == version
