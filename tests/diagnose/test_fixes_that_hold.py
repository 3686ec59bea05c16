"""A fix is told only if it does what it is needed for; where that is not known, the fix says less."""

from __future__ import annotations

from pathlib import Path

import pytest
from one_file import sources_of
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.rules import source_faults

NAME = NAMES[1]
HEAD = """\
import rclpy
from geometry_msgs.msg import Pose, Twist
from rclpy.node import Node
from std_msgs.msg import Float32, String


class Robot(Node):
    def __init__(self):
        super().__init__('robot')
        self.state = 'idle'
"""
END = "\n\ndef main():\n    rclpy.init()\n    node = Robot()\n    rclpy.spin(node)\n"


def robot(made: str, *methods: str, end: str = END) -> str:
    """Return a node with more lines in its constructor, and with methods of some lines each."""
    lines = "".join(f"        {line}\n" for line in made.splitlines())
    bodies = "".join("\n" + "".join(f"    {line}\n" for line in method.splitlines()) for method in methods)
    return f"{HEAD}{lines}{bodies}{end}"


def fixes(text: str, folder: Path, *codes: str) -> list[str]:
    return [f.fix for f in source_faults(sources_of(text, folder)) if f.code in codes]


def fixes_of_workspace(files: Files, folder: Path, *codes: str) -> list[str]:
    return [f.fix for f in of_workspace(files.write(folder)) if f.code in codes]


TIMER = "self.timer = self.create_timer(1.0, self.send)"
SEND = "def send(self, text):\n    self.get_logger().info(text)"


@pytest.mark.parametrize(
    ("text", "fix"),
    [
        (robot(TIMER, "def send(self, text):\n    self.get_logger().info('on')"), "write def send(self):"),
        (
            robot(TIMER, SEND),
            "write def send(self): and give text a value in its body, which uses it",
        ),
        (robot(f"{TIMER}\nself.send('on')", SEND), "remove this line, or give it a method of its own: send is right for the call on line 12"),
        (robot(TIMER, SEND, end=END.replace("rclpy.spin", "node.send('on')\n    rclpy.spin")), "remove this line, or give it a method of its own: send is right for the call on line 20"),
        (robot(f"{TIMER}\nself.state.send()", SEND), "write def send(self): and give text a value in its body, which uses it"),
        (robot(TIMER, "def send(self, text):\n    text = 'on'\n    self.get_logger().info(text)"), "write def send(self):"),
        (robot("self.sub = self.create_subscription(String, 'chat', self.send, 10)", "def send(self, msg, count, more):\n    self.get_logger().info(msg.data * count)"), "write def send(self, msg): and give count a value in its body, which uses it"),
        (robot(TIMER, SEND.replace("text):", "text='on'):")), ""),
        (robot("self.timer = self.create_timer(1.0, lambda: self.send('on'))", SEND), ""),
    ],
)  # fmt: skip
def test_a_def_is_changed_only_if_nothing_else_needs_it(tmp_path: Path, text: str, fix: str) -> None:
    """A callback's def keeps the parameters with which other code calls it, and what its body uses gets a value."""
    assert fixes(text, tmp_path, "callback-arguments") == [fix] * bool(fix)


SUB = (
    "self.sub = self.create_subscription({}, {}, self.hear, 10)\nself.pub = self.create_publisher({}, {}, 10)"
)
HEAR = "def hear(self, msg):\n    self.get_logger().info(str(msg))"
SENT = "write self.pub.publish(msg) in the callback that has the message"


@pytest.mark.parametrize(
    ("ends", "fix"),
    [
        (("String", "'in'", "String", "'out'"), SENT),
        (("String", "'chat'", "String", "'chat'"), "write another topic here, or remove the publisher: a callback that publishes on 'chat', which it receives itself, never comes to an end"),
        (("String", "'/chat'", "String", "'chat'"), "write another topic here, or remove the publisher: a callback that publishes on 'chat', which it receives itself, never comes to an end"),
        (("String", "self.state", "String", "self.state"), "write another topic here, or remove the publisher: a callback that publishes on self.state, which it receives itself, never comes to an end"),
        (("String", "'in'", "Twist", "'out'"), "write self.pub.publish(...) in a callback, with a Twist that is made there"),
        (("String", "'chat'", "Twist", "'chat'"), "write self.pub.publish(...) in a callback, with a Twist that is made there"),
    ],
)  # fmt: skip
def test_a_callback_publishes_what_it_receives_only_on_another_topic(
    tmp_path: Path, ends: tuple[str, ...], fix: str
) -> None:
    assert fixes(robot(SUB.format(*ends), HEAR), tmp_path, "never-sent") == [fix]


PUBLISHER = "self.pub = self.create_publisher({}, 'out', 10)"


@pytest.mark.parametrize(
    ("kind", "method", "fix"),
    [
        ("String", "def send(self, msg):\n    self.pub.publish(String(data=msg.data))", "pass self.send as the callback to a create_subscription in __init__"),
        ("String", "def send(self, heard):\n    self.pub.publish(String(data=heard.data))", "pass self.send as the callback to a create_subscription in __init__"),
        ("Float32", "def send(self, angle):\n    msg = Float32()\n    msg.data = float(angle)\n    self.pub.publish(msg)", "write `self.send(...)` where its angle is known, or remove it"),
        ("Pose", "def send(self, pose):\n    self.pub.publish(pose)", "write `self.send(...)` where its pose is known, or remove it"),
        ("String", "def send(self, text):\n    self.pub.publish(String(data=text.upper()))", "write `self.send(...)` where its text is known, or remove it"),
        ("String", "def send(self, joint):\n    self.pub.publish(String(data=joint.name.upper()))", "pass self.send as the callback to a create_subscription in __init__"),
        ("String", "def send(self):\n    self.pub.publish(String(data='on'))", "write `self.timer = self.create_timer(1.0, self.send)` in __init__"),
    ],
)  # fmt: skip
def test_only_what_reads_fields_is_offered_as_the_callback_of_a_subscription(
    tmp_path: Path, kind: str, method: str, fix: str
) -> None:
    assert fixes(robot(PUBLISHER.format(kind), method), tmp_path, "never-called") == [fix]


@pytest.mark.parametrize(
    ("body", "fix"),
    [
        ("if text:\n    rclpy.shutdown()\n    return\n    rclpy.shutdown()", "remove line 17"),
        ("rclpy.shutdown()\nself.state = text\nraise SystemExit\nrclpy.shutdown()\nself.state = text", "remove lines 17 to 18"),
        ("raise ValueError(text)\nreturn None", "remove line 15"),
        ("return\nself.state = text\nself.state += 'on'", "remove line 14, or what comes after it; or write the return below the condition it belongs to"),
        ("if text:\n    return\n    self.state = text", "move the return to the end, or below the condition it belongs to"),
        ("while text:\n    break\n    self.state = text\nself.state = text", "move the break to the end, or below the condition it belongs to"),
        ("return self.state\nself.state = text", "move the return to the end, or below the condition it belongs to"),
    ],
)  # fmt: skip
def test_what_was_done_before_a_jump_is_removed_after_it(tmp_path: Path, body: str, fix: str) -> None:
    lines = "".join(f"    {line}\n" for line in body.splitlines())
    text = robot("self.hear('on')", f"def hear(self, text):\n{lines}")
    assert fixes(text, tmp_path, "unreachable") == [fix]


def test_only_what_follows_in_the_same_block_is_never_reached(tmp_path: Path) -> None:
    body = "def hear(self, text):\n    while text:\n        return text\n        break\n    self.state = text"
    (found,) = (
        f
        for f in source_faults(sources_of(robot("self.hear('on')", body), tmp_path))
        if f.code == "unreachable"
    )
    assert found.cause == "Python never reaches line 16 (`break`), because of `return text` on line 15."


def with_use(made: str, use: str) -> Files:
    """Return a workspace whose first node has more lines in its constructor, and a line in its callback."""
    files = Files.right(NAME)
    files.change("node", "        self.count = 0\n", f"        self.count = 0\n        {made}\n")
    return files.change("node", "        self.count += 1\n", f"        self.count += 1\n        {use}\n")


@pytest.mark.parametrize(
    ("made", "use", "fix"),
    [
        ("self.speaking = False", "self.speakClient.wait_for_server()", "define self.speakClient in __init__"),
        ("self.counter = 0", "self.counters.append(1)", "define self.counters in __init__"),
        ("self.counter = []", "self.counters.append(1)", "write self.counter, or define self.counters in __init__"),
        ("self.publisher_out = self.create_publisher(String, 'o', 10)", "self.publsher_out.publish(String())", "write self.publisher_out, or define self.publsher_out in __init__"),
        ("self.names = {}", "self.nmaes['a'] = 1", "write self.names, or define self.nmaes in __init__"),
        ("# self.voice = self.create_publisher(String, 'o', 10)", "self.voice.publish(String())", "remove the # from line 13"),
    ],
)  # fmt: skip
def test_a_near_name_that_cannot_do_it_is_not_offered(tmp_path: Path, made: str, use: str, fix: str) -> None:
    assert fixes_of_workspace(with_use(made, use), tmp_path, "attribute-missing") == [fix]


LAUNCH = """\
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
IMPORT


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument('device', default_value=''),
        ACTIONS
    ])
"""
LISTED = (
    "Node(package='tf2_ros', executable='echo', parameters=[\n            # {}\n            {{'rate': 1}}])"
)
TALKER = "Node(package='PACKAGE', executable='MODULE')"
CONDITION = "Node(package='PACKAGE', executable='MODULE', condition=Condition(LaunchConfiguration('device')))"


@pytest.mark.parametrize(
    ("line", "actions", "fix"),
    [
        ("from launch.actions import Condition", CONDITION, "import what is meant there: line 11 cannot use launch.Condition as it does"),
        ("from launch.actions import IfCondition", CONDITION.replace("=Cond", "=IfCond"), "write `from launch.conditions import IfCondition`"),
        ("from launch.actions import PushRosNamespace", "PushRosNamespace('a')", "write `from launch_ros.actions import PushRosNamespace`"),
        ("from launch_ros.actions import TimerAction", "TimerAction(period=1.0, actions=[])", "write `from launch.actions import TimerAction`"),
        ("from launch_ros.actions import TimerAction", "TimerAction(1.0, [])", "import what is meant there: line 11 cannot use launch.actions.TimerAction as it does"),
    ],
)  # fmt: skip
def test_an_import_is_offered_only_if_its_use_works_then(
    tmp_path: Path, line: str, actions: str, fix: str
) -> None:
    text = LAUNCH.replace("IMPORT", line).replace("ACTIONS", actions)
    found = fixes_of_workspace(Files.right(NAME).put("launch/more.launch.py", text), tmp_path, "import-wrong")
    assert found == [fix]


@pytest.mark.parametrize(
    ("declared", "actions", "fix"),
    [
        ("device", TALKER, "pass it to the Node on line 11: parameters=[{'device': LaunchConfiguration('device')}]"),
        ("device", TALKER.replace(")", ", parameters=[{'rate': 1}])"), "add {'device': LaunchConfiguration('device')} to the parameters of the Node on line 11"),
        ("device", TALKER.replace(")", ", parameters=[FILE])"), "add {'device': LaunchConfiguration('device')} to the parameters of the Node on line 11"),
        ("device", TALKER.replace(")", ", parameters=[FILE, {'device': 'a' + 'b'}])"), "write LaunchConfiguration('device') instead of 'a' + 'b' on line 11"),
        ("device", f"{TALKER}, {TALKER}", "pass it to a node, as one of its parameters: {'device': LaunchConfiguration('device')}"),
        ("other", TALKER, "remove it, or write LaunchConfiguration('device') where its value is needed"),
        ("device", "Node(package='tf2_ros', executable='echo')", "remove it, or write LaunchConfiguration('device') where its value is needed"),
        ("device", "# Node(package='PACKAGE', executable='MODULE', parameters=[{'device': LaunchConfiguration('device')}])", "remove it, or remove the # from line 11, which would use it"),
        ("device", LISTED.format("{'port': LaunchConfiguration('device')},"), "remove it, or remove the # from line 12, which would use it"),
        ("device", LISTED.format("{'port': LaunchConfiguration('device')}"), "remove it, or write LaunchConfiguration('device') where its value is needed"),
        ("device", LISTED.format("{'rate': LaunchConfiguration('device')},"), "remove it, or write LaunchConfiguration('device') where its value is needed"),
        ("device", LISTED.format("here stood LaunchConfiguration('device') once"), "remove it, or write LaunchConfiguration('device') where its value is needed"),
    ],
)  # fmt: skip
def test_an_argument_is_for_a_node_that_declares_it(
    tmp_path: Path, declared: str, actions: str, fix: str
) -> None:
    files = with_use(f"self.declare_parameter('{declared}', '')", "pass")
    files.put(
        "launch/more.launch.py", LAUNCH.replace("IMPORT", "FILE = 'a.yaml'").replace("ACTIONS", actions)
    )
    assert fixes_of_workspace(files, tmp_path, "launch-unused") == [fix]


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("", "[{'device': LaunchConfiguration('device')}], with `from launch.substitutions import LaunchConfiguration` at the top"),
        ("from launch import substitutions", "[{'device': substitutions.LaunchConfiguration('device')}]"),
        ("from launch.substitutions import LaunchConfiguration as Given", "[{'device': Given('device')}]"),
    ],
)  # fmt: skip
def test_an_argument_is_read_by_what_the_file_imports(tmp_path: Path, line: str, fix: str) -> None:
    files = with_use("self.declare_parameter('device', '')", "pass")
    text = LAUNCH.replace("from launch.substitutions import LaunchConfiguration", line)
    files.put("launch/more.launch.py", text.replace("IMPORT", "").replace("ACTIONS", TALKER))
    assert fixes_of_workspace(files, tmp_path, "launch-unused") == [
        f"pass it to the Node on line 11: parameters={fix}"
    ]


@pytest.mark.parametrize(
    ("items", "told", "fix"),
    [
        ("[range, ears]", "`range` is the range of Python itself", "write talker instead of range"),
        ("[id, talker, ears]", "`id` is the id of Python itself", "remove id from the list, or write what is meant instead"),
        ("[talker, ears, None]", "`None` is None", "remove None from the list, or write what is meant instead"),
        ("[launch, talker]", "`launch` is the module launch", "write ears instead of launch"),
        ("[Node, talker, ears]", "`Node` is the class Node itself", "write Node(...), with what it needs in the parentheses, instead of Node"),
        ("[max, input, talker, ears]", "`max` is the max of Python itself and `input` is the input of Python itself", "remove max and input from"),
        ("talker", "takes a list of LaunchDescriptionEntitys, in brackets here, but `talker` is a Node", "give it a list"),
    ],
)  # fmt: skip
def test_of_a_list_only_the_wrong_items_are_told(tmp_path: Path, items: str, told: str, fix: str) -> None:
    made = "".join(f"    {name} = {TALKER}\n" for name in ("talker", "ears"))
    text = f"import launch\nfrom launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\ndef generate_launch_description():\n{made}    return LaunchDescription({items})\n"
    (found,) = of_workspace(Files.right(NAME).put("launch/more.launch.py", text).write(tmp_path))
    assert told in found.cause
    assert found.fix.startswith(fix)


POINT = "'console_scripts': ["
START = "def begin():\n    pass\n\n\ndef start():\n    begin()\n\n\nif __name__ == '__main__':\n    start()\n"


@pytest.mark.parametrize(
    ("files", "fix"),
    [
        ({"wheels_2d": "def begin(): ...\n\n\ndef main(): ...\n"}, "write 'more = PACKAGE.core.wheels_2d:main', and build again"),
        ({"wheels_2d": START}, "write 'more = PACKAGE.core.wheels_2d:start', and build again"),
        ({"wheels_2d": "def start(): ...\n"}, "write 'more = PACKAGE.core.wheels_2d:start', and build again"),
        ({"wheels_2d": "print('on')\n"}, "create src/PACKAGE/PACKAGE/wheels_1d.py with the function main, or remove this entry point"),
        ({"wheels_2d": "print('on')\n", "wheels_3d": "def begin(): ...\n\n\ndef main(): ...\n"}, "write 'more = PACKAGE.core.wheels_3d:main', and build again"),
    ],
)  # fmt: skip
def test_an_entry_point_is_offered_a_function_that_is_there(
    tmp_path: Path, files: dict[str, str], fix: str
) -> None:
    given = Files.right(NAME).change("setup.py", POINT, f"{POINT}'more = PACKAGE.wheels_1d:main',")
    for name, text in {"__init__": "", **files}.items():
        given.put(f"PACKAGE/core/{name}.py", text)
    assert fixes_of_workspace(given, tmp_path, "entry-point-module") == [given.filled(fix)]


@pytest.mark.parametrize(
    ("changes", "codes"),
    [
        ({"package.xml": "<name>lab_bot<"}, ["package-name"]),
        ({"setup.cfg": "lib/lab_bot"}, ["setup-cfg-missing"]),
        ({"package.xml": "<name>lab_bot<", "setup.cfg": "lib/lab_bot"}, ["package-name", "setup-cfg-missing"]),
    ],
)  # fmt: skip
def test_a_name_is_corrected_towards_one_side(
    tmp_path: Path, changes: dict[str, str], codes: list[str]
) -> None:
    """Every fix writes the name that the folder and setup.py have."""
    files = Files.right(NAME)
    for path, text in changes.items():
        files.texts[files.path(path)] = files.texts[files.path(path)].replace(
            text.replace("lab_bot", NAME.package), text
        )
    wanted = ("package-name", "setup-cfg-missing")
    found = [f for f in of_workspace(files.write(tmp_path)) if f.code in wanted]
    assert [f.code for f in found] == codes
    assert all(NAME.package in f.fix and "lab_bot" not in f.fix for f in found)
