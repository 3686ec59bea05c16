"""Names that are somewhere else, names that hide others, and what stops a node from being called; mended as is said."""

from __future__ import annotations

import re
import textwrap
from pathlib import Path

import pytest
from one_file import sources_of
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.code.bound_names import undefined_names
from ros2lab.diagnose.code.expression_faults import expression_faults
from ros2lab.diagnose.nodes.life_faults import life_faults

TICK = "    def CALLBACK(self):\n        msg = String()\n        msg.data = f'running {self.count}'\n        self.PUBLISHER.publish(msg)\n        self.get_logger().info(msg.data)\n        self.count += 1\n"


@pytest.fixture
def files() -> Files:
    return Files.right(NAMES[1])


def test_a_method_that_lost_its_indentation(tmp_path: Path, files: Files) -> None:
    files.change("node", TICK, textwrap.dedent(TICK))
    (finding,) = of_workspace(files.write(tmp_path))
    assert finding.code == "attribute-missing"
    assert "indented too little" in finding.cause
    assert finding.fix.startswith("indent def tick")
    files.change("node", textwrap.dedent(TICK), TICK)
    assert of_workspace(files.write(tmp_path)) == []


def test_a_method_that_slipped_into_the_constructor(tmp_path: Path, files: Files) -> None:
    files.change("node", TICK, textwrap.indent(TICK, "    "))
    (finding,) = of_workspace(files.write(tmp_path))
    assert "inside __init__()" in finding.cause


def test_a_method_in_the_wrong_class(tmp_path: Path, files: Files) -> None:
    files.change("node", TICK, "")
    files.change("node", "class CLASS(Node)", f"class Other:\n{TICK}\n\nclass CLASS(Node)")
    (finding,) = of_workspace(files.write(tmp_path))
    assert "it belongs to Other" in finding.cause
    assert finding.fix == "move the method tick into the class Talker"


def test_self_left_out_where_it_is_set(tmp_path: Path, files: Files) -> None:
    files.change("node", "self.count = 0", "count = 0").change("node", "self.count += 1", "pass")
    (finding,) = of_workspace(files.write(tmp_path))
    assert finding.fix == "write `self.count = 0` on line 12"
    files.change("node", "        count = 0", "        self.count = 0")
    assert of_workspace(files.write(tmp_path)) == []


@pytest.mark.parametrize("name", ["random.py", "std_msgs/__init__.py", "glob.py"])
def test_a_file_that_hides_a_module(tmp_path: Path, files: Files, name: str) -> None:
    files.put(name, "").change("node", "import rclpy\n", "import random\nimport rclpy\n")
    found = of_workspace(files.write(tmp_path))
    shadowed = [one for one in found if one.code == "name-shadowed"]
    assert shadowed
    assert found[0].code in ("name-shadowed", "package-not-listed")
    new = re.search(r"to (\S+),", shadowed[0].fix)
    assert new
    top = name.partition("/")[0]
    (tmp_path / "src/my_bot" / top).rename(tmp_path / "src/my_bot" / new[1])
    assert of_workspace(tmp_path) == []


WAITS = [
    (
        "callback-waits",
        "        msg = String()\n",
        "        import time\n        time.sleep(2)\n        msg = String()\n",
    ),
    ("callback-waits", "        msg = String()\n", "        input('next? ')\n        msg = String()\n"),
    ("spin-inside", "        self.count = 0\n", "        self.count = 0\n        rclpy.spin(self)\n"),
    ("spin-inside", "        msg = String()\n", "        rclpy.spin(self)\n        msg = String()\n"),
]


@pytest.mark.parametrize("number", range(len(WAITS)))
def test_what_stops_a_node(tmp_path: Path, files: Files, number: int) -> None:
    code, old, new = WAITS[number]
    files.change("node", old, new)
    (finding,) = of_workspace(files.write(tmp_path))
    assert finding.code == code
    files.change("node", new, old)
    assert of_workspace(files.write(tmp_path)) == []


SERVER = """\
import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger


class Arm(Node):
    def __init__(self):
        super().__init__('arm')
        MADE

    def pick(self, request, response):
        ASKED
        response.success = True
        return response

    def receive(self, msg):
        TOLD

    def move(self):
        time.sleep(2.0)
        print('there')
        time.sleep(2.0)


def main():
    rclpy.init()
    node = Arm()
    rclpy.spin(node)
"""
SERVES = "self.create_service(Trigger, 'pick', self.pick)"
HEARS = "self.create_subscription(String, 'go', self.receive, 10)"
GROUP = "add callback_group=MutuallyExclusiveCallbackGroup() to create_service(...) on line"


@pytest.mark.parametrize(
    ("made", "called", "fixes"),
    [
        ((SERVES, HEARS), ("self.move()", "pass"), [f"{GROUP} 12"]),
        ((HEARS, SERVES), ("self.move()", "self.move()"), [f"{GROUP} 13"]),
        ((HEARS, SERVES), ("pass", "self.move()"), ["create_timer(period, self.callback)"]),
        ((HEARS, SERVES), ("time.sleep(1)", "time.sleep(1)"), [GROUP, "create_timer(period, self.callback)"]),
        ((HEARS, SERVES), ("input()", "pass"), ["call input() in a separate thread"]),
        ((SERVES,), ("self.move()", "pass"), []),
    ],
)
def test_a_service_waits_in_a_thread_of_its_own(
    tmp_path: Path, files: Files, made: tuple[str, ...], called: tuple[str, str], fixes: list[str]
) -> None:
    """It answers when the wait is over: what is done later, in a timer, would come after the answer."""
    text = (
        SERVER.replace("MADE", "\n        ".join(made)).replace("ASKED", called[0]).replace("TOLD", called[1])
    )
    root = files.put("driver", text).write(tmp_path)
    found = [finding.fix for finding in of_workspace(root) if finding.code == "callback-waits"]
    assert len(found) == len(fixes)
    assert all(fix in whole for fix, whole in zip(fixes, found, strict=True))


RIGHT = [
    ("        msg = String()\n", "        import time\n        time.sleep(0.01)\n        msg = String()\n"),
    ("import rclpy\n", "import threading\nimport time\nimport rclpy\n\n\ndef ask():\n    time.sleep(3)\n    input()\n\n\nthreading.Thread(target=ask)\n"),
    ("        self.count = 0\n", "        self.count = 0\n        rclpy.spin_once(self, timeout_sec=0)\n"),
    ("import rclpy\n", "from random import randint\nimport logging\nimport rclpy\n"),
]  # fmt: skip


@pytest.mark.parametrize("number", range(len(RIGHT)))
def test_what_is_right_raises_no_alarm(tmp_path: Path, files: Files, number: int) -> None:
    files.change("node", *RIGHT[number])
    files.put("PACKAGE/logging.py", "")  # inside the package it hides nothing
    assert of_workspace(files.write(tmp_path)) == []


@pytest.mark.parametrize(
    ("of_class", "codes"),
    [
        ("timers = None", []),
        ("timers: dict = {}", []),
        ("timers: dict", ["node-property"]),
        ("clients = None", ["node-property"]),
    ],
)
def test_a_value_of_the_class_hides_the_property_of_every_node(
    tmp_path: Path, files: Files, of_class: str, codes: list[str]
) -> None:
    files.change(
        "node", "class CLASS(Node):\n", f"class Base(Node):\n    {of_class}\n\n\nclass CLASS(Base):\n"
    )
    files.change("node", "self.count = 0", "self.count = 0\n        self.timers = {}")
    assert [finding.code for finding in of_workspace(files.write(tmp_path))] == codes


SPUN = [
    ("try:\n    rclpy.spin(self)\nexcept KeyboardInterrupt:\n    pass\nself.destroy_node()", "before Ctrl-C", "move the whole try on line 13 and line 17 to main"),
    ("try:\n    rclpy.spin(self)\nfinally:\n    self.destroy_node()", "never returns", "move the whole try on line 13 to main"),
    ("rclpy.spin(self)\nself.destroy_node()", "never returns", "move `rclpy.spin(self)` and line 14 to main"),
    ("rclpy.spin(self)", "never returns", "remove `rclpy.spin(self)` here"),
]  # fmt: skip


@pytest.mark.parametrize("number", range(len(SPUN)))
def test_what_belongs_to_a_spin_is_moved_with_it(tmp_path: Path, files: Files, number: int) -> None:
    lines, cause, fix = SPUN[number]
    lines = textwrap.indent(f"self.count = 0\n{lines}", " " * 8)
    files.change("node", "        self.count = 0", lines)
    found = [one for one in of_workspace(files.write(tmp_path)) if one.code == "spin-inside"]
    assert [(cause in one.cause, one.fix[: len(fix)]) for one in found] == [(True, fix)]


OF_PYTHON_2 = [
    ("try:\n    kind = unicode\nexcept NameError:\n    kind = str", []),
    ("try:\n    kind = unicode\nexcept Exception:\n    kind = str", ["unicode"]),
    ("kind = str if PY3 else basestring", []),
    ("kind = OLD and unicode or str", []),
    ("if OLD:\n    range = xrange", []),
    ("if sys.version_info < (3,):\n    input = raw_input", []),
    ("def text(x):\n    if not OLD:\n        return str(x)\n    return unicode(x)", []),
    ("if sys.version_info < (3, 8):\n    sys.exit('too old')\nprint(unicode)", ["unicode"]),
    ("def main():\n    if OLD:\n        return 1\n    print(unicode)", ["unicode"]),
    ("for _ in xrange(3):\n    pass", ["xrange"]),
    ("if OLD:\n    range = xrange\nprint(xrange(3))", ["xrange"]),
]


@pytest.mark.parametrize(("lines", "names"), OF_PYTHON_2)
def test_a_name_of_another_python_may_be_used_under_a_guard(
    tmp_path: Path, lines: str, names: list[str]
) -> None:
    text = f"import sys\n\nPY3 = sys.version_info[0] == 3\nOLD = not PY3\n{lines}\n"
    (source,) = sources_of(text, tmp_path).sources.values()
    assert [name for name, _ in undefined_names(source)] == names


@pytest.mark.parametrize(("takes", "fits"), [("msg", "create_subscription"), ("", "create_timer")])
def test_one_callback_of_a_timer_and_a_subscription(
    tmp_path: Path, files: Files, takes: str, fits: str
) -> None:
    made = "self.create_timer(1.0, self.shared)\n        self.create_subscription(String, 'heard', self.shared, 10)"
    files.change("node", "self.count = 0", f"self.count = 0\n        {made}")
    given = f"self, {takes}" if takes else "self"
    files.change(
        "node", "    def CALLBACK(", f"    def shared({given}):\n        self.count = 0\n\n    def CALLBACK("
    )
    (finding,) = of_workspace(files.write(tmp_path))
    assert finding.fix.startswith("remove this line")
    assert f"shared is right for the {fits} on line" in finding.fix


@pytest.mark.parametrize(
    ("written", "fix"),
    [
        ("None(package='my_bot', executable='talker')", "write Node instead of None"),
        ("'Node'(package='my_bot', executable='talker')", "write Node instead of 'Node'"),
    ],
)
def test_a_value_that_is_called_with_names(tmp_path: Path, files: Files, written: str, fix: str) -> None:
    files.texts["src/my_bot/launch/two.launch.py"] = (
        "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\n"
        "def generate_launch_description():\n    return LaunchDescription([\n"
        f"        Node(package='my_bot', executable='ears'),\n        {written},\n    ])\n"
    )
    assert fix in [finding.fix for finding in of_workspace(files.write(tmp_path), None)]


def test_a_field_of_a_field_that_is_given_by_name(tmp_path: Path, files: Files) -> None:
    files.change(
        "node",
        "from std_msgs.msg import String",
        "from geometry_msgs.msg import Twist\nfrom std_msgs.msg import String",
    )
    files.change("node", "self.count = 0", "self.count = 0\n        self.twist = Twist(x=0.5)")
    (finding,) = (f for f in of_workspace(files.write(tmp_path)) if f.code == "message-field")
    assert finding.fix.startswith("write linear=Vector3(x=0.5) or angular=Vector3(x=0.5) instead of x=0.5")
    assert "`from geometry_msgs.msg import Vector3`" in finding.fix


def test_a_member_with_another_word_is_not_meant(tmp_path: Path, files: Files) -> None:
    files.change("node", "self.count += 1", "self.count += 1\n        self.destroy()")
    (finding,) = (f for f in of_workspace(files.write(tmp_path)) if f.code == "attribute-missing")
    assert "destroy_rate" not in finding.fix


NODE = """\
import sys

import rclpy
from rclpy.node import Node


class Camera(Node):
    def __init__(self):
        super().__init__('camera')
        try:
            self.port = open('/dev/camera')
        except OSError:
            rclpy.shutdown()
            LINE

    def is_alive(self):
        return rclpy.ok()


def main():
    rclpy.init()
    node = Camera()
    SPIN
"""


@pytest.mark.parametrize(
    ("line", "spin", "is_told"),
    [
        ("pass", "rclpy.spin(node)", True),
        ("return", "rclpy.spin(node)", True),
        ("self.port = None", "rclpy.spin(node)", True),
        ("raise", "rclpy.spin(node)", False),
        ("sys.exit(1)", "rclpy.spin(node)", False),
        ("pass", "if rclpy.ok():\n        rclpy.spin(node)", False),
        ("pass", "if node.is_alive():\n        rclpy.spin(node)", False),
        ("pass", "if not rclpy.ok():\n        return\n    rclpy.spin(node)", False),
        ("return", "try:\n        rclpy.spin(node)\n    finally:\n        print(rclpy.ok())", True),
        ("pass", "try:\n        rclpy.spin(node)\n    except Exception:\n        pass", False),
        ("pass", "print(node.port)", False),
    ],
)
def test_a_constructor_that_shuts_down_ends_the_program(
    tmp_path: Path, line: str, spin: str, is_told: bool
) -> None:
    sources = sources_of(NODE.replace("LINE", line).replace("SPIN", spin), tmp_path)
    found = [finding.fix for finding in life_faults(sources, None) if finding.code == "life-order"]
    assert found == ["write `raise` instead of `rclpy.shutdown()`"] * is_told


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("os.path.join(share('a'), 'config', 'a.yaml')", ""),
        ("os.path.join(share('a'), 'a.yaml', share('b'), 'b.yaml')", "write 2 paths: `os.path.join(share('a'), 'a.yaml'), os.path.join(share('b'), 'b.yaml')`"),
        ("PathJoinSubstitution([FindPackageShare('a'), 'a', FindPackageShare('b'), 'b'])", "write 2 paths: `PathJoinSubstitution([FindPackageShare('a'), 'a']), PathJoinSubstitution([FindPackageShare('b'), 'b'])`"),
        ("os.path.join(HOME, 'a.yaml', share('b'), 'b.yaml')", "write 2 paths: `os.path.join(HOME, 'a.yaml'), os.path.join(share('b'), 'b.yaml')`"),
        ("os.path.join(os.getcwd(), share('b'))", ""),
        ("', '.join([share('a'), share('b')])", ""),
        ("try:\n    main()\nexcept KeyboardInterrupt():\n    pass", "write KeyboardInterrupt instead of KeyboardInterrupt()"),
        ("try:\n    main()\nexcept (OSError, ExternalShutdownException()):\n    pass", "write ExternalShutdownException instead of ExternalShutdownException()"),
        ("try:\n    main()\nexcept (OSError, KeyboardInterrupt):\n    pass", ""),
        ("try:\n    main()\nexcept errors_of(os):\n    pass", ""),
    ],
)  # fmt: skip
def test_what_python_takes_otherwise_than_it_looks(tmp_path: Path, line: str, fix: str) -> None:
    head = "import os\nfrom ament_index_python.packages import get_package_share_directory\nHOME = get_package_share_directory('a')\n"
    name = "get_package_share_directory"
    sources = sources_of(head + line.replace("share(", f"{name}("), tmp_path)
    found = [f.fix for f in expression_faults(sources) if f.code in ("path-absolute", "argument-type")]
    assert found == [fix.replace("share(", f"{name}(")] * bool(fix)
