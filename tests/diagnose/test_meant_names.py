"""What a name that nothing defines was meant as, in nodes, setup.py and launch files."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.code.argument_names import refused_keywords
from ros2lab.diagnose.code.bound_names import undefined_names
from ros2lab.diagnose.code.meant_names import meant
from ros2lab.diagnose.rules import text_faults
from ros2lab.diagnose.sources.python_source import PythonSource

NODE = """import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.pub = self.create_publisher(String, 'chatter', 10)
        self.timer = self.create_timer(0.5, self.tick)
        self.count = 0

    def tick(self):
        msg = String()
        msg.data = f'hello {self.count}'
        self.pub.publish(msg)
        self.count += 1
        if self.count > 5:
            return None
        return [True]


def main(args=None):
    rclpy.init(args=args)
    node = Talker()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
"""

SETUP = """from glob import glob

from setuptools import find_packages, setup

package_name = 'lamps'

setup(
    name=package_name,
    packages=find_packages(exclude=['test']),
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
        ('share/' + package_name + '/launch', glob('launch/*', recursive=True)),
    ],
    zip_safe=True,
)
"""

LAUNCH = """from launch import LaunchDescription
from launch.actions import LogInfo, TimerAction
from launch_ros.actions import Node


def generate_launch_description():
    ld = LaunchDescription()
    ld.add_action(TimerAction(period=1.0, actions=[LogInfo(msg='late')]))
    ld.add_action(Node(package='lamps', executable='lamp'))
    return ld
"""


def fixes(text: str, package: str = "") -> list[str]:
    source = PythonSource("pk.file", "setup.py" if package else "file.py", text)
    return [meant(source, name, node, package=package)[1] for name, node in undefined_names(source)]


@pytest.mark.parametrize(
    ("right", "wrong", "fix"),
    [
        ("return None", "return Nnoe", "write `return None`"),
        ("[True]", "[Ture]", "write `return [True]`"),
        ("return [True]", "reutrn [True]", "write `return [True]`"),
        ("        return None", "        pas", "write `pass`"),
        ("if self.count > 5", "if nto (self.count)", "write `if not (self.count):`"),
        ("node = Talker()", "node == Talker()", "write `node = Talker()`"),
        ("    node = Talker()\n", "", "write `node = Talker()` above line 25"),
        ("rclpy.spin(node)", "rclpy.spin(ndoe)", "write `rclpy.spin(node)`"),
        ("node = Talker()", "ndoe = Talker()", "write `node = Talker()` on line 25"),
        ("        msg = String()\n", "", "write `msg = String()` above line 14"),
        ("        msg = String()", "        mgs = String()", "write `msg = String()` on line 14"),
        ("import rclpy\n", "", "write `import rclpy` at the top"),
        ("from std_msgs.msg import String\n", "", "write `from std_msgs.msg import String` at the top"),
        ("def main(args=None)", "def main()", "write `def main(args=None):` on line 23"),
        ("def tick(self)", "def tick(slf)", "write `def tick(self):` on line 13"),
        ("def main(", "def mian(", "write `def main(args=None):` on line 23"),
        ("self.count += 1", "Self.count += 1", "write `self.count += 1`"),
        ("self.count += 1", "this.count += 1", "write `self.count += 1`"),
        ("rclpy.init(", "Rclpy.init(", "write `rclpy.init(args=args)`"),
        ("rclpy.shutdown()", "try_shutdown()", "write `rclpy.try_shutdown()`"),
        ("self.pub.publish", "self.pub,publish", "write `self.pub.publish(msg)`"),
        ("'__main__'", "__main__", "write `if __name__ == '__main__':`"),
        ("[True]", "[net(self)]", "write `return [next(self)]`"),
        ("self.count = 0", "self.size = use(size)", "write `self.size = use('size')` if"),
        ("[True]", "[Path('/x')]", "write `from pathlib import Path` at the top"),
        ("[True]", "[time.sleep(1)]", "write `import time` at the top"),
        ("[True]", "launch/demo.launch.py", "write `return 'launch/demo.launch.py'`"),
        ("0.5, self", "period, self", "write a line above it that gives period its value"),
    ],
)
def test_a_name_of_a_node_is_read_as_what_was_meant(right: str, wrong: str, fix: str) -> None:
    assert right in NODE
    assert any(told.startswith(fix) for told in fixes(NODE.replace(right, wrong, 1)))


@pytest.mark.parametrize(
    ("right", "wrong", "fix"),
    [
        ("'resource/' + package_name", "'resource/' + packagename", "write `package_name` instead of `packagename`"),
        ("package_name = 'lamps'\n", "", "write `package_name = 'lamps'` above line 6"),
        ("package_name = ", "pakage_name = ", "write `package_name = 'lamps'` on line 5"),
        ("package_name = 'lamps'", "package_name = lamps", "write `package_name = 'lamps'`"),
        ("package_name = 'lamps'", "package_name == 'lamps'", "write `package_name = 'lamps'`"),
        ("'share/' + package_name,", "share/ + package_name,", "write `'share/' + package_name` instead of `share/ + package_name`"),
        ("'package.xml'", "package.xml", "write `'package.xml'` instead of `package.xml`"),
        ("name=package_name", "name==package_name", "write `name=package_name` instead of `name==package_name`"),
        ("zip_safe=True", "zip_safe=true", "write `True` instead of `true`"),
        ("from setuptools import find_packages, setup\n", "", "write `from setuptools import find_packages, setup` at the top"),
        ("from glob import glob\n", "", "write `from glob import glob` at the top"),
    ],
)  # fmt: skip
def test_a_name_of_setup_py_is_read_as_what_was_meant(right: str, wrong: str, fix: str) -> None:
    assert right in SETUP
    assert fixes(SETUP.replace(right, wrong, 1), "lamps")[:1] == [fix]


@pytest.mark.parametrize(
    ("right", "wrong", "fix"),
    [
        ("ld = Launch", "ld == Launch", "write `ld = LaunchDescription()`"),
        ("    ld = LaunchDescription()\n", "", "write `ld = LaunchDescription()` above line 7"),
        ("Node(package=", "Node(package==", "write `ld.add_action(Node(package='lamps', executable='lamp'))`"),
        ("from launch.actions import LogInfo, TimerAction\n", "", "write `from launch.actions import LogInfo, TimerAction` at the top"),
    ],
)  # fmt: skip
def test_a_name_of_a_launch_file_is_read_as_what_was_meant(right: str, wrong: str, fix: str) -> None:
    assert right in LAUNCH
    text = LAUNCH.replace(right, wrong, 1)
    assert fixes(text.replace(", executable", ", executable", 1))[:1] == [fix]


@pytest.mark.parametrize(
    "text",
    [
        NODE,
        SETUP,
        LAUNCH,
        "def use():\n    global last\n    last = 1\n\n\ndef read():\n    return last\n",
        "def walk():\n    path: Path = here()\n    return path\n\n\ndef here():\n    return None\n",
        "from __future__ import annotations\n\n\ndef take(msg: Image) -> Image:\n    return msg\n",
        "class Lamp:\n    size = 2\n    area = size * size\n    both = [side for side in (1, 2)]\n",
        "def outer():\n    count = 0\n\n    def inner():\n        nonlocal count\n        count += 1\n        return __class__\n",
        "try:\n    pass\nexcept OSError as error:\n    print(error)\n",
    ],
)
def test_names_that_python_finds_are_not_told(text: str) -> None:
    assert fixes(text) == []


def test_a_variable_of_another_function_is_told() -> None:
    (fix,) = fixes("def main():\n    node = 1\n\n\ndef show():\n    print(node)\n")
    assert "`global node` as the first line of main()" in fix


@pytest.mark.parametrize(
    ("right", "wrong", "fix"),
    [
        ("exclude=", "excude=", "write `packages=find_packages(exclude=['test']),`"),
        ("recursive=True", "recursiv=True", "write `recursive=True` instead of `recursiv=True`"),
        ("exclude=", "exclude=", None),
    ],
)
def test_a_keyword_that_python_refuses(right: str, wrong: str, fix: str | None) -> None:
    found = refused_keywords(PythonSource("setup", "setup.py", SETUP.replace(right, wrong, 1)))
    told = [finding.fix for finding in found]
    assert len(told) == (fix is not None)
    assert all("exclude=['test']" in one or "recursive=True" in one for one in told)


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        (
            "        self.pub = self.create_publisher(String, 'chatter', 10)\n",
            "write `self.pub = self.create_publisher(String, '...', 10)` below line 8, in __init__(), with the name that the others use instead of the dots",
        ),
        ("self.pub = self.c", "write `self.pub = self.create_publisher(String, 'chatter', 10)`"),
    ],
)
def test_an_attribute_that_nothing_sets_is_given_what_its_uses_need(line: str, fix: str) -> None:
    wrong = "" if line.endswith("\n") else line.replace("=", "==")
    found = text_faults(PythonSource("pk.talker", "talker.py", NODE.replace(line, wrong, 1)))
    assert fix in [finding.fix for finding in found if finding.code == "attribute-missing"]


@pytest.mark.parametrize(
    ("before", "line", "fix"),
    [
        ("# import RPi.GPIO as GPIO\n", "GPIO.cleanup()", "remove the # from line 1, or remove this line"),
        ("", "GPIO.cleanup()", "import or define GPIO above"),
        ("", "# speed = 0.5\n    self.now = 1 + speed", "remove the # from line 6"),
        ("", "'''\n    arm = make(\n        1)\n    '''\n    arm.stop(self)", "take lines 7 to 8 out of the quotes around it, or remove this line"),
        ("", "# speed = top\n    self.now = 1 + speed", "write a line above it that gives speed its value"),
        ("", "# speed = what it drives\n    self.now = 1 + speed", "write a line above it that gives speed its value"),
        ("", "self.now = 1 + speed\n    # speed = 0.5", "write a line above it that gives speed its value"),
        ("def other():\n    # speed = 0.5\n    return 1\n", "self.now = 1 + speed", "write a line above it that gives speed its value"),
    ],
)  # fmt: skip
def test_a_line_out_of_use_that_would_define_a_name_is_put_back(before: str, line: str, fix: str) -> None:
    text = f"{before}def make(n):\n    return n\n\n\ndef move(self):\n    {line}\n"
    assert fixes(text) == [fix]


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("angle - angle_prev", "write a line above it that gives angle_prev its value"),
        ("angle - angle0", "write a line above it that gives angle0 its value"),
        ("left_wheel - right_wheel", "write a line above it that gives right_wheel its value"),
        ("angle - angel", "write a line above it that gives angel its value"),
        ("angle == anlge", "write a line above it that gives anlge its value"),
        ("left_wheel - angel", "write `self.error = left_wheel - angle`"),
        ("lefft_wheel - angle", "write `self.error = left_wheel - angle`"),
        ("leftwheel - angle", "write `self.error = left_wheel - angle`"),
        ("left_whl - angle", "write `self.error = left_wheel - angle`"),
    ],
)
def test_a_name_with_another_word_is_another_thing(line: str, fix: str) -> None:
    head = "def move(self, angle, left_wheel):\n    print(angle, left_wheel)\n"
    assert fixes(f"{head}    self.error = {line}\n") == [fix]


@pytest.mark.parametrize(
    ("lines", "is_text"),
    [
        ("move = Twist()\nmove.linear.x = fast", False),
        ("move = Twist()\nspeed = fast\nmove.linear.x = speed", False),
        ("self.move = Twist()\nself.move.angular.z = fast", False),
        ("flag = Bool()\nflag.data = fast", False),
        ("lift = Lift()\nlift.floor = fast", False),
        ("self.speed = fast\nself.move = Twist()\nself.move.linear.x = self.speed", False),
        ("text = String()\ntext.data = fast", True),
        ("self.text = String()\nself.text.data = fast", True),
        ("self.get_logger().info(fast)", True),
        ("self.mode = {'mode': fast}", True),
    ],
)
def test_a_string_is_proposed_only_where_one_may_stand(tmp_path: Path, lines: str, is_text: bool) -> None:
    imports = "from std_msgs.msg import String\nfrom std_msgs.msg import Bool\nfrom geometry_msgs.msg import Twist\nfrom lift_msgs.msg import Lift\n"
    files = Files.right(NAMES[1]).change("node", "from std_msgs.msg import String\n", imports)
    body = "".join(f"        {line}\n" for line in lines.splitlines())
    root = files.change("node", "        self.count += 1\n", f"        self.count += 1\n{body}").write(
        tmp_path
    )
    (fix,) = (one.fix for one in of_workspace(root) if one.code == "name-undefined")
    assert ("if it is meant as a string" in fix) is is_text
    assert fix.endswith("import or define fast above")
