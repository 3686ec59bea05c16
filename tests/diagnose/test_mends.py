"""A mend is a line to write: real errors of nodes, of setuptools and of pytest, and what is to be typed."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from deadlines import DEADLINE
from ros2lab.diagnose import Finding, of_text, of_workspace

NAME = NAMES[1]
PACKAGE = f"src/{NAME.package}"
# A file, what is right in it, what stands in its place, and the fix; the node fails by itself.
FAILS: dict[str, tuple[str, str, str, str]] = {
    "a duration and a number": (
        "driver",
        "self.speed = 0.5",
        "self.begun = self.get_clock().now()\n        self.get_logger().info(str(self.get_clock().now() - self.begun > 2.0))",
        "write `(self.get_clock().now() - self.begun).nanoseconds / 1e9 > 2.0`",
    ),
    "a time and a number": (
        "driver",
        "self.speed = 0.5",
        "self.get_logger().info(str(self.get_clock().now() - 2.0))",
        "write `self.get_clock().now() - Duration(seconds=2.0)`, with `from rclpy.duration import Duration` at the top",
    ),
    "a text for a factor": (
        "driver",
        "self.speed = 0.5",
        "self.speed = 0.5 * '2'",
        "write `self.speed = 0.5 * 2`",
    ),
    "an argument that is not handed in": (
        "driver",
        "def main(args=None):",
        "def main():",
        "write `def main(args=None):` on line N",
    ),
    "a number for a part of a message": (
        "driver",
        "msg.linear.x = 1.0",
        "msg.linear = self.speed",
        "write msg.linear.x = self.speed",
    ),
    "a list for a part of a message": (
        "driver",
        "msg.linear.x = 1.0",
        "msg.linear = [1.0, 0.0, 0.0]",
        "write msg.linear = Vector3(x=1.0, y=0.0, z=0.0), with `from geometry_msgs.msg import Vector3`",
    ),
    "a value that is called": (
        "node",
        "self.get_parameter('period').value,",
        "self.get_parameter('period').value(),",
        "remove the parentheses after self.get_parameter('period').value",
    ),
    "functions that are called where they are kept": (
        "driver",
        "self.speed = 0.5",
        "self.words = {'go': self.go(), 'halt': self.go()}\n        self.words['go']()\n\n    def go(self):\n        self.get_logger().info('go')",
        "write self.go instead of self.go(), self.go instead of self.go()",
    ),
    "pairs for parameters": (
        "driver",
        "self.speed = 0.5",
        "self.declare_parameter('mode', 'off')\n        self.set_parameters([('mode', 'on')])",
        "write `self.set_parameters([Parameter('mode', value='on')])`, with `from rclpy.parameter import Parameter` at the top",
    ),
    "a field in brackets": (
        "driver",
        "msg.linear.x = 1.0",
        "msg.linear['x'] = 1.0",
        "write msg.linear.x instead of msg.linear['x']",
    ),
    "nothing to publish": (
        "driver",
        "self.publisher_.publish(msg)",
        "self.publisher_.publish()",
        "write `self.publisher_.publish(msg)`",
    ),
    "a small function that takes too much": (
        "driver",
        "self.create_timer(0.1, self.drive)",
        "self.create_timer(0.1, lambda event: self.drive())",
        "write lambda: self.drive()",
    ),
    "a method of nearly that name": (
        "driver",
        "    rclpy.spin(node)\n",
        "    node.destroy()\n",
        "write `node.destroy_node()` instead of `node.destroy()`",
    ),
    "the class for its object": (
        "driver",
        "rclpy.spin(node)",
        "rclpy.spin(Driver)",
        "write `rclpy.spin(node)`",
    ),
    "a module for its class": (
        "driver",
        "from rclpy.node import Node",
        "import rclpy.node as Node",
        "write `from rclpy.node import Node` on line N",
    ),
    "another name for a module": (
        "driver",
        "import rclpy\n",
        "import rclpy as rp\n",
        "write `import rclpy` on line N",
    ),
    "a parameter that is read as another type": (
        "node",
        "self.get_parameter('period').value,",
        "1 / self.get_parameter('period').get_parameter_value().integer_value,",
        "write .double_value instead of .integer_value",
    ),
}

# A mend of a kind that another one of these has, too.
OF_A_KIND = {
    "a time and a number",
    "a number for a part of a message",
    "a value that is called",
    "a field in brackets",
    "a small function that takes too much",
    "the class for its object",
    "another name for a module",
    "a parameter that is read as another type",
}


def printed(root: Path, module: str) -> str:
    """Run a node until it fails by itself, and return what is then on the screen."""
    done = subprocess.run(
        [sys.executable, "-c", f"from {NAME.package}.{module} import main; main()"],
        cwd=root / PACKAGE,
        capture_output=True,
        text=True,
        timeout=DEADLINE,
        check=False,
    )
    return f"student$ ros2 run {NAME.package} {module}\n{done.stdout}{done.stderr}"


@pytest.mark.parametrize(
    "what", [pytest.param(what, marks=pytest.mark.thorough if what in OF_A_KIND else ()) for what in FAILS]
)
def test_what_fails_is_mended_by_what_is_told(tmp_path: Path, what: str) -> None:
    file, right, wrong, fix = FAILS[what]
    root = Files.right(NAME).change(file, right, wrong).write(tmp_path)
    text = printed(root, NAME.driver if file == "driver" else NAME.module)
    first = of_text(text, root)[0]
    assert re.sub(r"line \d+", "line N", first.fix) == fix, text


@pytest.mark.parametrize(
    ("right", "wrong", "fix"),
    [
        ("version='0.1.0'", "version='week 2'", "write version='0.0.0'"),
        ("install_requires=['setuptools']", "install_requires=['setuptools>>3']", "write install_requires=['setuptools']"),
        ("zip_safe=True", "zip_safe=True, python_requires='three'", "remove python_requires"),
        pytest.param("license='Apache-2.0'", "license=['Apache-2.0']", "write license='Apache-2.0'", marks=pytest.mark.thorough),
        ("zip_safe=True", "zip_save=True", "write zip_safe instead of zip_save"),
        ("find_packages(exclude=['test'])", "[package_name, 'nodes']", f"write packages=['{NAME.package}']"),
        ("'console_scripts': [", "'console_scripts' = [", "write `'console_scripts' : [`"),
    ],
)  # fmt: skip
def test_what_setuptools_refuses_is_told_with_what_it_takes(
    tmp_path: Path, right: str, wrong: str, fix: str
) -> None:
    root = Files.right(NAME).change("setup.py", right, wrong).write(tmp_path)
    assert of_workspace(root)[0].fix == fix


@pytest.mark.parametrize(
    "more",
    [
        "tests_require=['pytest']",
        pytest.param("platforms=['Linux']", marks=pytest.mark.thorough),
        "python_requires='>=3.10'",
    ],
)
def test_what_setuptools_takes_or_took_is_right(tmp_path: Path, more: str) -> None:
    assert of_workspace(Files.right(NAME).change("setup.py", "zip_safe=True", more).write(tmp_path)) == []


@pytest.mark.parametrize(
    ("typed", "said", "fix"),
    [
        (
            "ros2 topic pub --once /robot/status std_msgs/msg/String '{data: on}'",
            "publishing #1: std_msgs.msg.String(data='True')",
            "type `ros2 topic pub --once /robot/status std_msgs/msg/String \"{data: 'on'}\"`",
        ),
        (
            "colcon build \u2013packages-select my_bot",
            "colcon: error: unrecognized arguments: \u2013packages-select my_bot",
            "type `colcon build --packages-select my_bot`",
        ),
        (
            "ros2 param set /talker period=0.5",
            "ros2 param set: error: the following arguments are required: value",
            "type `ros2 param set /talker period 0.5`",
        ),
    ],
)
def test_a_command_is_right_when_it_is_typed_as_told(tmp_path: Path, typed: str, said: str, fix: str) -> None:
    root = Files.right(NAME).write(tmp_path)
    assert of_text(f"student$ {typed}\n{said}\n", root)[0].fix == fix


def silent(files: Files, folder: Path) -> Finding:
    return of_workspace(files.write(folder))[0]


def test_a_path_without_its_slash(tmp_path: Path) -> None:
    old = "os.path.join(get_package_share_directory('PACKAGE'), 'config', 'robot.yaml')"
    new = "get_package_share_directory('PACKAGE') + 'config/robot.yaml'"
    first = silent(Files.right(NAME).change("launch/robot.launch.py", old, new), tmp_path)
    assert first.fix == "write '/config/robot.yaml' instead of 'config/robot.yaml'"


def test_what_is_sent_before_anybody_can_hear_it(tmp_path: Path) -> None:
    files = Files.right(NAME).change(
        "node", "        self.count = 0\n", "        self.count = 0\n        self.CALLBACK()\n"
    )
    files.change(
        "node", "self.timer = self.create_timer(self.get_parameter('period').value, self.CALLBACK)", "pass"
    )
    assert silent(files, tmp_path).code == "sent-early"


def test_what_only_asyncio_can_run(tmp_path: Path) -> None:
    files = Files.right(NAME).change("driver", "import rclpy\n", "import asyncio\nimport rclpy\n")
    files.change(
        "driver", "    def drive(self):\n", "    async def drive(self):\n        await asyncio.sleep(0.1)\n"
    )
    assert silent(files, tmp_path).cause.endswith("so asyncio.sleep() fails.")


TEST = "from PACKAGE.MODULE import CLASS\n\n\ndef make_robot():\n    return CLASS\n\n\ndef test_name(robot):\n    assert robot\n"


def test_what_a_test_asks_for_and_nobody_makes(tmp_path: Path) -> None:
    files = Files.right(NAME).put("test/test_name.py", TEST)
    files.change("setup.py", "zip_safe=True", "extras_require={'test': ['pytest']}")
    assert (
        silent(files, tmp_path).fix == "write `def test_name():`, and robot = make_robot() as its first line"
    )


def test_tests_that_colcon_does_not_give_to_pytest(tmp_path: Path) -> None:
    files = Files.right(NAME).put("test/test_name.py", TEST.replace("(robot)", "()"))
    first = silent(files, tmp_path)
    assert (first.code, first.place) == ("tests-not-run", f"{PACKAGE}/setup.py:17")


def test_a_python_package_that_was_made_for_cmake(tmp_path: Path) -> None:
    files = Files(NAME).put("src/talker.py", "print('hello')\n")
    files.put(
        "package.xml",
        Files.right(NAME).texts[f"{PACKAGE}/package.xml"].replace("ament_python", "ament_cmake"),
    )
    files.put("CMakeLists.txt", "project(my_bot)\nfind_package(ament_cmake REQUIRED)\nament_package()\n")
    assert "ros2 pkg create my_bot --build-type ament_python --dependencies rclpy std_msgs geometry_msgs" in (
        silent(files, tmp_path).fix
    )


def test_what_pytest_wrote_is_read(tmp_path: Path) -> None:
    """`colcon test-result` only counts; and a file that would unfold without end says nothing."""
    root = Files.right(NAME).put("test/test_name.py", "from talker import main\n").write(tmp_path)
    written = root / "build" / NAME.package / "pytest.xml"
    written.parent.mkdir(parents=True)
    said = f"student$ colcon test-result --verbose\nbuild/{NAME.package}/pytest.xml: 1 test, 1 error, 0 failures, 0 skipped\n"
    error = "test/test_name.py:1: in &lt;module&gt;\nE   ModuleNotFoundError: No module named 'talker'"
    written.write_text(
        f'<testsuites><testsuite><testcase><error message="collection failure">{error}</error></testcase></testsuite></testsuites>'
    )
    assert of_text(said, root)[0].fix.startswith("write my_bot.talker instead of talker")
    bomb = "".join(f"<!ENTITY a{n} '{f'&a{n - 1};' * 10}'>" for n in range(1, 12))
    written.write_text(f"<!DOCTYPE t [<!ENTITY a0 'ha'>{bomb}]><t><error>&a11;</error></t>")
    assert of_text(said, root) == []


def test_a_class_of_ones_own_needs_no_import(tmp_path: Path) -> None:
    files = Files.right(NAME).change("driver", "class Driver(Node):", "class Parameter(Node):")
    files.change("driver", "node = Driver()", "node = Parameter('driver')")
    text = printed(files.write(tmp_path), NAME.driver)
    assert of_text(text, tmp_path)[0].fix == "write `Parameter()`"
