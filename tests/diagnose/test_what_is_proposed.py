"""What a fix proposes can be imported, named and moved, and files of an inner package are not the outer's."""

from __future__ import annotations

import re
import shlex
import subprocess
from pathlib import Path

import pytest
from workspace_files import DRIVER, MANIFEST, NAMES, SETUP, Files

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.look import Look

MOVED = DRIVER.replace("DRIVER", "mover")
GROUPS = "        'console_scripts': [\n"
FIRST = "import rclpy\n"
OWN_MESSAGES = """\
cmake_minimum_required(VERSION 3.8)
project(my_bot)
find_package(ament_cmake REQUIRED)
find_package(rosidl_default_generators REQUIRED)
rosidl_generate_interfaces(${PROJECT_NAME} "srv/Ask.srv")
install(PROGRAMS my_bot/talker.py DESTINATION lib/${PROJECT_NAME})
ament_package()
"""


def right() -> Files:
    return Files.right(NAMES[1])


def found(files: Files, folder: Path, code: str) -> list[str]:
    """Return the fixes of the findings of a code."""
    return [finding.fix for finding in of_workspace(files.write(folder)) if finding.code == code]


def imports(statement: str, **others: str) -> Files:
    """Return a workspace whose first node has one more import, beside other modules."""
    files = right().change("node", FIRST, f"{FIRST}{statement}\n")
    for name, text in others.items():
        files.put(f"PACKAGE/{name}.py", text)
    return files


@pytest.mark.parametrize(
    ("files", "fix"),
    [
        (imports("from my_bot.limit import FAST", limits="FAST = 1.0"), "write my_bot.limits instead of"),
        (imports("from my_bot.limit import FAST", limits="SLOW = 0.1"), "fix the name, or create the file"),
        (
            imports("from .limit import Limit", limits="SLOW = 0.1", kept="class Limit: ..."),
            "write my_bot.kept",
        ),
        (
            imports("from my_bot.pilot import Pilot", auto="from other import Pilot"),
            "fix the name, or create",
        ),
        (
            imports("from .getchar import Getchar", get_char="class GetChar: ..."),
            "write my_bot.get_char instead",
        ),
        (imports("from .limit import fast", limits="from numpy import *"), "write my_bot.limits instead of"),
        (imports("from .talk import KEY"), "fix the name, or create"),
        (imports("from .secrets import KEY", reader="def f(:"), "fix the name, or create"),
    ],
)
def test_a_module_is_proposed_that_has_what_is_imported(tmp_path: Path, files: Files, fix: str) -> None:
    (proposed,) = found(files, tmp_path, "module-missing")
    assert proposed.startswith(fix)


@pytest.mark.parametrize(
    ("statement", "fix"),
    [
        ("from rclpy.node import Node, sys", "write `from rclpy.node import Node` and `import sys`"),
        (
            "from std_msgs.msg import String, math",
            "write `from std_msgs.msg import String` and `import math`",
        ),
        ("from geometry_msgs.msg import json as reader", "write `import json as reader`"),
    ],
)
def test_a_module_is_imported_by_itself(tmp_path: Path, statement: str, fix: str) -> None:
    (proposed,) = found(imports(statement), tmp_path, "import-wrong")
    assert proposed.startswith(fix)


@pytest.mark.parametrize(
    ("file", "point", "command"),
    [
        (
            "my_bot/drive _fast.py",
            "drive_fast = my_bot.drive_fast:main",
            "mv 'src/my_bot/my_bot/drive _fast.py'",
        ),
        (
            "my_bot/drive fast.py",
            "drive_fast = my_bot.drive_fast:main",
            "mv 'src/my_bot/my_bot/drive fast.py'",
        ),
        ("my_bot/drive fasst.py", "drive = my_bot.drive_fast:main", "mv 'src/my_bot/my_bot/drive fasst.py'"),
        ("scripts/drive_fast.py", "drive = my_bot.drive_fast:main", "mv src/my_bot/scripts/drive_fast.py"),
        (
            "nodes/inner/drive_fast.py",
            "drive = my_bot.drive_fast:main",
            "mv src/my_bot/nodes/inner/drive_fast.py",
        ),
    ],
)
def test_the_file_of_an_entry_point_is_moved_where_it_is_looked_for(
    tmp_path: Path, file: str, point: str, command: str
) -> None:
    files = right().put(file, MOVED).change("setup.py", GROUPS, f"{GROUPS}            '{point}',\n")
    (fix,) = found(files, tmp_path, "entry-point-module")
    assert fix.startswith(f"{command} src/my_bot/my_bot/drive_fast.py, then")
    subprocess.run(shlex.split(fix.partition(", then")[0]), cwd=tmp_path, check=True)
    assert Look(tmp_path).findings == []


@pytest.mark.parametrize(
    ("point", "others", "fix"),
    [
        ("show = my_bot.printer:main", {"printer": "print('hi')"}, "define main(args=None)"),
        (
            "show = my_bot.printer:main",
            {"printer": "X = 1", "shows": DRIVER},
            "write 'show = my_bot.shows:main'",
        ),
        ("show = my_bot:printer.main", {"printer": DRIVER}, "write 'show = my_bot.printer:main'"),
        (
            "show = my_bot.printer",
            {"printer": "import rclpy\nrclpy.init()"},
            "write 'show = my_bot.printer:main', and put the lines that run the program, from line 2 of",
        ),
        (
            "show = my_bot.prnter:main",
            {"printer": "class A: ..."},
            "write 'show = my_bot.printer:main', and define main()",
        ),
        ("show = my_bot.print_node:main", {"prints": "def clamp(a, b): ..."}, "create src/my_bot"),
    ],
)
def test_an_executable_does_not_get_the_program_of_another(
    tmp_path: Path, point: str, others: dict[str, str], fix: str
) -> None:
    files = right().change("setup.py", GROUPS, f"{GROUPS}            '{point}',\n")
    for name, text in others.items():
        files.put(f"PACKAGE/{name}.py", text)
    proposed = [f.fix for f in of_workspace(files.write(tmp_path)) if f.code.startswith("entry-point-")]
    assert [text.startswith(fix) for text in proposed] == [True]


@pytest.mark.parametrize(
    ("file", "fix"),
    [
        (
            "launch/robot .launch.py",
            "mv 'src/my_bot/launch/robot .launch.py' src/my_bot/launch/robot.launch.py",
        ),
        (
            "launch/two.launch .py",
            "mv 'src/my_bot/launch/two.launch .py' src/my_bot/launch/two.launch.py, and build",
        ),
        (
            "config/my robot.yml",
            "mv 'src/my_bot/config/my robot.yml' src/my_bot/config/my_robot.yml, add ('share/",
        ),
    ],
)
def test_a_file_with_a_space_is_renamed_first(tmp_path: Path, file: str, fix: str) -> None:
    files = right().change("setup.py", "glob('launch/*.launch.py')", "glob('launch/[a-z]*[a-z].launch.py')")
    files.put(
        file, files.texts[files.path("launch/robot.launch.py" if "launch" in file else "config/robot.yaml")]
    )
    (proposed,) = found(files, tmp_path, "not-in-data-files")
    assert fix in proposed


def nested(where: str, *, name: str = "inner", files: Files | None = None) -> Files:
    """Return a workspace with a package inside another one, which needs more than that declares."""
    files = files or right()
    manifest = MANIFEST.replace("PACKAGE", name).replace("geometry_msgs", "sensor_msgs")
    files.put(f"{where}/package.xml", manifest)
    files.put(f"{where}/setup.py", SETUP.replace("PACKAGE", name).replace("find_packages", "find_packages"))
    files.put(f"{where}/{name}/__init__.py", "")
    return files.put(
        f"{where}/{name}/scan.py", "from sensor_msgs.msg import LaserScan\nprint(LaserScan, scanned)\n"
    )


@pytest.mark.parametrize("where", ["PACKAGE/lab-code", "PACKAGE/inner", "PACKAGE/a/b", "inner"])
def test_the_files_of_an_inner_package_are_not_the_outer_ones(tmp_path: Path, where: str) -> None:
    findings = of_workspace(nested(where).write(tmp_path))
    assert [finding.code for finding in findings] == ["package-passed-over"]
    assert "inside the package my_bot," in findings[0].cause


def test_an_inner_package_that_python_cannot_read_is_told(tmp_path: Path) -> None:
    files = nested("PACKAGE/lab").put("PACKAGE/lab/inner/scan.py", "def main(:\n    pass\n")
    findings = of_workspace(files.write(tmp_path))
    assert [finding.code for finding in findings] == ["package-passed-over", "node-syntax"]


def test_of_several_copies_one_is_moved(tmp_path: Path) -> None:
    files = nested("PACKAGE/a/inner", files=nested("b/inner", files=nested("PACKAGE/c/d/inner")))
    root = files.write(tmp_path)
    (fix,) = [f.fix for f in of_workspace(root) if f.code == "package-passed-over"]
    assert fix.startswith("mv src/my_bot/b/inner src/, and build again; leave its other copies")
    subprocess.run(shlex.split(fix.partition(", and")[0]), cwd=root, check=True)
    assert "package-passed-over" not in {finding.code for finding in of_workspace(root)}


def test_a_package_is_not_moved_into_another_one(tmp_path: Path) -> None:
    root = nested("PACKAGE/code/my_bot", name="inner").write(tmp_path)
    (fix,) = [f.fix for f in of_workspace(root) if f.code == "package-passed-over"]
    assert fix.startswith("mv src/my_bot/my_bot/code/my_bot src/inner, and")


@pytest.mark.parametrize(
    ("tag", "fix"),
    [
        ("<depend>rviz</depend>", "write rviz2 instead of rviz"),
        ("<exec_depend>rospy</exec_depend>", "remove this line: rclpy is declared as well"),
        ("<depend>tf</depend>", "write tf2_ros_py instead of tf"),
    ],
)
def test_a_package_of_ros_1_has_another_name(tmp_path: Path, tag: str, fix: str) -> None:
    files = right().change("package.xml", "  <export>", f"  {tag}\n  <export>")
    assert found(files, tmp_path, "dependency-unknown") == [fix]


def test_a_package_does_not_depend_on_itself(tmp_path: Path) -> None:
    tags = "  <exec_depend>launch_ros</exec_depend>\n  <exec_depend>my_bot</exec_depend>\n  <export>"
    files = right().change("package.xml", "  <export>", tags)
    assert found(files, tmp_path, "manifest-invalid") == [
        "remove this line: a package does not depend on itself"
    ]


@pytest.mark.parametrize(
    ("cmake", "is_right"),
    [(OWN_MESSAGES, True), (re.sub("rosidl_generate.*\n", "", OWN_MESSAGES), False)],
)
@pytest.mark.parametrize("has_setup", [True, False])
def test_a_package_of_cmake_may_make_its_own_messages(
    tmp_path: Path, cmake: str, is_right: bool, has_setup: bool
) -> None:
    files = right().change("package.xml", "<build_type>ament_python", "<build_type>ament_cmake")
    files.put("CMakeLists.txt", cmake).put("srv/Ask.srv", "int32 n\n---\nbool ok\n")
    files.change("node", FIRST, f"{FIRST}from my_bot.srv import Ask\n")
    if not has_setup:
        files.remove("setup.py").remove("setup.cfg")
    findings = [f for f in of_workspace(files.write(tmp_path)) if f.code == "module-missing"]
    assert len(findings) == (not is_right)
    assert all("ament_python" not in finding.cause for finding in findings)
    assert all('"srv/Ask.srv"' in finding.fix for finding in findings)


RENAMING = "executable='DRIVER', remappings=[{}]"


@pytest.mark.parametrize(
    ("pairs", "wanted"),
    [
        ("('speed_in', '/speed'), ('cmd', '/robot/cmd')", ["speed_limit", "/cmd_vel"]),
        ("('cmd', '/robot/cmd'), ('speed_in', '/speed')", ["/cmd_vel", "speed_limit"]),
        ("('/cmd_vel', '/robot/cmd'), ('velocity', '/speed')", ["speed_limit"]),
        ("('anything', '/robot/status')", ["speed_limit"]),
        ("('anything', '/robot/command')", ["/cmd_vel"]),
    ],
)
def test_a_remapping_is_of_the_name_that_is_left_and_of_the_other_end(
    tmp_path: Path, pairs: str, wanted: list[str]
) -> None:
    more = "        self.create_subscription(Twist, 'speed_limit', self.on_limit, 10)\n"
    method = "    def on_limit(self, msg):\n        self.speed = msg.linear.x\n\n"
    files = right().change("driver", "        self.timer", f"{more}        self.timer")
    files.change("driver", "    def drive(", f"{method}    def drive(")
    files.change("launch/robot.launch.py", "executable='DRIVER'", RENAMING.format(pairs))
    look = Look(files.write(tmp_path), loads=True)
    fixes = [finding.fix for finding in look.findings if finding.code == "remap-unknown"]
    named = [re.findall(r"write '/?([^']+)' as the first name", fix) for fix in fixes]
    assert named == [[name.lstrip("/")] for name in wanted]


def test_a_parameter_file_is_for_the_nodes_that_it_names(tmp_path: Path) -> None:
    line = "    config = os.path.join(get_package_share_directory('my_bot'), 'config', 'more.yaml')\n"
    files = right().change(
        "launch/robot.launch.py", "    return", f"{line.replace('config =', 'more =')}    return"
    )
    files.put("config/more.yaml", "wheels:\n  ros__parameters:\n    speed: 1.0\n")
    look = Look(files.write(tmp_path), loads=True)
    (fix,) = [finding.fix for finding in look.findings if finding.code == "launch-unused"]
    number = next(
        n
        for n, text in enumerate(files.texts[files.path("launch/robot.launch.py")].splitlines(), 1)
        if "wheels" in text
    )
    assert fix == f"add parameters=[more] to the Node on line {number}"


def test_no_message_shows_where_launch_was_tried(tmp_path: Path) -> None:
    path = "os.path.join(get_package_share_directory('my_bot'), 'config', 'robot.yaml')"
    files = right().change(
        "launch/robot.launch.py", "executable='DRIVER'", f"executable='DRIVER', arguments=[{path}, 'fast']"
    )
    look = Look(files.write(tmp_path), loads=True)
    (finding,) = [finding for finding in look.findings if finding.code == "words-unread"]
    assert "`install/my_bot/share/my_bot/config/robot.yaml fast`" in finding.cause
    assert not any("scratch" in f"{finding.cause}{finding.fix}" for finding in look.findings)


@pytest.mark.parametrize(
    "statement", ["from my_bot.tools import units", "from my_bot.tools.units import HALF"]
)
def test_a_folder_of_modules_needs_its_file(tmp_path: Path, statement: str) -> None:
    files = imports(statement).put("PACKAGE/tools/units.py", "HALF = 0.5\n")
    assert found(files, tmp_path, "init-file-missing") == [
        "touch src/my_bot/my_bot/tools/__init__.py, and build again"
    ]


SETTING_UP = "def setup(node):\n    node.get_logger().info('ready')\n"


@pytest.mark.parametrize(
    "files",
    [
        right().put("PACKAGE/setup.py", SETTING_UP),
        right().put("PACKAGE/tools/__init__.py", "").put("PACKAGE/tools/setup.py", SETTING_UP),
        imports("from my_bot.tools.units import HALF")
        .put("PACKAGE/tools/units.py", "HALF = 0.5\n")
        .put("PACKAGE/tools/__init__.py", ""),
        imports("from my_bot.srv import helper")
        .put("PACKAGE/srv/helper.py", "HALF = 0.5\n")
        .put("PACKAGE/srv/__init__.py", ""),
        imports("import sys"),
        imports("from rclpy import logging"),
        imports("from my_bot.limits import FAST", limits="from numpy import *"),
        imports("from my_bot import listener", listener="from .ears import Listener\n"),
        right()
        .put("PACKAGE/shown.py", "from my_bot.ears import main\n")
        .change("setup.py", GROUPS, f"{GROUPS}            'shown = my_bot.shown:main',\n"),
        right().put("PACKAGE/drive fast.py", DRIVER),
        right()
        .put("PACKAGE/nodes/__init__.py", "from . import ear\n")
        .put("PACKAGE/nodes/ear.py", MOVED)
        .change("setup.py", GROUPS, f"{GROUPS}            'ear = my_bot.nodes:ear.main',\n"),
        right().change("package.xml", "  <export>", "  <exec_depend>rviz2</exec_depend>\n  <export>"),
        right().change(
            "launch/robot.launch.py", "executable='DRIVER'", RENAMING.format("('cmd_vel', 'steering')")
        ),
        nested("resource/COPY").put("resource/COPY/COLCON_IGNORE", ""),
    ],
)
def test_right_code_that_looks_alike(tmp_path: Path, files: Files) -> None:
    assert Look(files.write(tmp_path), loads=True).findings == []


@pytest.mark.parametrize(
    ("words", "fix"),
    [
        ("'map.pgm'", "remove arguments; if the node needs the value, declare a parameter for it there"),
        ("'--period', '0.5'", "write parameters=[{'period': 0.5}] instead of arguments"),
        ("'--speed', '0.5'", "remove arguments; if"),
    ],
)
def test_words_are_turned_only_into_a_parameter_of_the_node(tmp_path: Path, words: str, fix: str) -> None:
    files = right().change(
        "launch/robot.launch.py", "executable='MODULE'", f"executable='MODULE', arguments=[{words}]"
    )
    look = Look(files.write(tmp_path), loads=True)
    (proposed,) = [finding.fix for finding in look.findings if finding.code == "words-unread"]
    assert proposed.startswith(fix)


HIDDEN = "        try:\n            {}\n        except Exception:\n            return\n"


def in_callback(lines: str, *changes: tuple[str, str]) -> Files:
    """Return a workspace with lines at the head of the second node's callback, and with other changes of its file."""
    files = right().change("driver", "        msg = Twist()\n", f"{lines}        msg = Twist()\n")
    for old, new in changes:
        files.change("driver", old, new)
    return files


IN_MAIN = ("    rclpy.spin(node)", "    node.create_timer(1.0, look)\n    rclpy.spin(node)")
LOOK = "\n\ndef look():\n    try:\n        print(1 / len('a'))\n    except Exception:\n        pass\n\n\ndef main("


@pytest.mark.parametrize(
    ("files", "shown"),
    [
        (in_callback(HIDDEN.format("self.speed = 1 / self.speed")), "self.get_logger().error(str(error))"),
        (
            in_callback(
                HIDDEN.format("self.speed = 1 / self.speed"),
                ("(Node)", ""),
                ("super().__init__('wheels')", "self.nh = rclpy.create_node('wheels')"),
                ("self.create_publisher", "self.nh.create_publisher"),
                ("self.create_timer", "self.nh.create_timer"),
                ("rclpy.spin(node)", "rclpy.spin(node.nh)"),
            ),
            "self.nh.get_logger().error(str(error))",
        ),
        (right().change("driver", *IN_MAIN).change("driver", "\n\ndef main(", LOOK), "print(error)"),
        (
            right().change(
                "driver",
                "    rclpy.spin(node)",
                LOOK.removeprefix("\n\n")
                .removesuffix("\n\n\ndef main(")
                .replace("\n", "\n    ")
                .join(("    ", "\n"))
                + IN_MAIN[1],
            ),
            "node.get_logger().error(str(error))",
        ),
    ],
)
def test_an_error_is_shown_by_a_node_that_is_known_there(tmp_path: Path, files: Files, shown: str) -> None:
    (fix,) = found(files, tmp_path, "errors-hidden")
    assert f" and {shown} below it" in fix


@pytest.mark.parametrize(
    ("lines", "way"),
    [
        ("        raise ValueError\n        return\n", "remove line "),
        ("        raise ValueError\n        print(1)\n", "move the raise to the end"),
    ],
)
def test_what_is_never_reached(tmp_path: Path, lines: str, way: str) -> None:
    """What ends a function is not moved behind what ends it, too."""
    text = f"        try:\n            self.speed += 1\n        except TypeError:\n{lines.replace('        ', '            ')}"
    fixes = found(in_callback(text), tmp_path, "unreachable")
    assert [fix.startswith(way) for fix in fixes] == [True]


@pytest.mark.parametrize(
    ("module", "call", "way"),
    [
        ("random", "random(-1.0, 1.0)", "write random.NAME(...), with"),
        ("time", "time()", "write time.time(...) instead of time(...)"),
        ("random", "random()", "write random.random(...) instead of random(...)"),
        ("math", "math(2)", "write math.NAME(...), with"),
        ("datetime", "datetime(2024, 1, 1)", "write datetime.datetime(...) instead of datetime(...)"),
    ],
)
def test_a_module_is_called(tmp_path: Path, module: str, call: str, way: str) -> None:
    files = in_callback(f"        self.got = {call}\n", (FIRST, f"{FIRST}import {module}\n"))
    (fix,) = found(files, tmp_path, "not-callable")
    assert fix.startswith(way)


@pytest.mark.parametrize("declared", ["rcl.py", "rclpy.node"])
def test_a_tag_that_has_a_package_s_letters_means_it(tmp_path: Path, declared: str) -> None:
    files = right().change("package.xml", "<depend>rclpy</depend>", f"<depend>{declared}</depend>")
    assert found(files, tmp_path, "dependency-joined") == ["write `<depend>rclpy</depend>`"]


@pytest.mark.parametrize(
    ("name", "module"),
    [("XMLLaunchDescriptionSource", "launch_xml"), ("YAMLLaunchDescriptionSource", "launch_yaml")],
)
def test_a_source_of_another_launch_package(tmp_path: Path, name: str, module: str) -> None:
    line = f"from launch.launch_description_sources import {name}\n"
    launch = "launch/robot.launch.py"
    files = right()
    files.change(launch, "from launch import", f"{line}from launch import")
    fix = f"write `from {module}.launch_description_sources import {name}`"
    assert [told.startswith(fix) for told in found(files, tmp_path, "import-wrong")] == [True]


@pytest.mark.parametrize(
    ("name", "way"),
    [
        ("period", "pass it to a node"),
        ("use_sim_time", "pass it to a node"),
        ("use_gui", "remove it, or write LaunchConfiguration('use_gui') where"),
    ],
)
def test_a_launch_argument_is_given_to_a_node_that_has_the_parameter(
    tmp_path: Path, name: str, way: str
) -> None:
    files = right().change(
        "launch/robot.launch.py",
        "LaunchDescription([",
        f"LaunchDescription([DeclareLaunchArgument({name!r}, default_value='1'), ",
    )
    files.change(
        "launch/robot.launch.py",
        "from launch import",
        "from launch.actions import DeclareLaunchArgument\nfrom launch import",
    )
    assert [fix.startswith(way) for fix in found(files, tmp_path, "launch-unused")] == [True]


LAUNCHED = "import os\nfrom ament_index_python.packages import get_package_share_directory as share\n"
WORKED_OUT = "def generate_launch_description():\n    given = os.path.join(share('my_bot'), 'config', {!r})\n"
PUBLISHES = "self.PUBLISHER.publish(msg)"
LOOPS = "        self.count = 0\n        {}\n            while rclpy.ok():\n                self.count += 1\n"
UNREAD = "        self.declare_parameter('pitch', 0.7)\n        self.speed = 0.5\n"


def commented(name: str) -> Files:
    """Return a workspace whose node publishes with an attribute that only a comment sets."""
    files = right().change("node", PUBLISHES, f"self.{name}.publish(msg)")
    lost = f"# self.{name} = self.create_publisher(\n        #     String, 'x', 10\n        # )"
    return files.change("node", "        self.PUBLISHER =", f"        {lost}\n        self.PUBLISHER =")


@pytest.mark.parametrize(
    ("files", "code", "way"),
    [
        (commented("warnings"), "attribute-missing", "remove the # from lines 10 to 12"),
        (
            Files.right(NAMES[2]).change(
                "node", PUBLISHES, f"{PUBLISHES}\n        self.warning_out.publish(msg)"
            ),
            "attribute-missing",
            "set self.warning_out in __init__",
        ),
        (
            right().change("node", PUBLISHES, "self.publisher.publish(msg)"),
            "attribute-missing",
            "write self.PUBLISHER",
        ),
        (
            right()
            .change("driver", "        self.speed = 0.5\n", UNREAD)
            .change("driver", "linear.x = 1.0", "linear.x = 0.7"),
            "parameter-unread",
            "write msg.linear.x = self.get_parameter('pitch').value if that is the value it should set",
        ),
        (
            right().change("node", "        self.count = 0\n", LOOPS.format("with open('a'):")),
            "endless-loop",
            "move it with what is around it into a method of its own",
        ),
        (
            right().change(
                "node", "        self.count = 0\n", LOOPS.format("if True:") + " " * 16 + "continue\n"
            ),
            "endless-loop",
            "write `pass` instead of the loop, and run its body in a timer callback, with `return` instead of",
        ),
        (
            right().change("node", "class CLASS", "if not self.count:\n    print('x')\n\n\nclass CLASS"),
            "name-undefined",
            "move the statement into a method whose first parameter is self",
        ),
        (
            right().change(
                "node", "    def __init__", "    pub = self.create_client(String, 'a')\n\n    def __init__"
            ),
            "name-undefined",
            "write `self.pub = self.create_client(String, 'a')` below line 10, in __init__, and remove this line",
        ),
        (
            right()
            .put("config/bridge.yaml", "- topic: a\n")
            .change(
                "launch/robot.launch.py",
                "def generate_launch_description():\n",
                LAUNCHED + WORKED_OUT.format("bridge.yaml"),
            ),
            "launch-unused",
            "remove it, or give given to the Node that reads it",
        ),
    ],
)
def test_a_fix_has_what_it_needs(tmp_path: Path, files: Files, code: str, way: str) -> None:
    assert [fix.startswith(files.filled(way)) for fix in found(files, tmp_path, code)] == [True]


def test_an_executable_of_another_package_is_started_from_there(tmp_path: Path) -> None:
    other = Files.right(NAMES[0])
    files = right().change("launch/robot.launch.py", "executable='DRIVER'", "executable='velocity_publisher'")
    files.texts |= {path: text for path, text in other.texts.items() if "/launch/" not in path}
    (fix,) = found(files, tmp_path, "launch-executable")
    assert fix == "write robot_controller instead of my_bot as its package"


@pytest.mark.parametrize(
    ("copies", "hidden"),
    [
        (["my_bot", "my_bot_2"], ["my_bot_2"]),
        (["my_bot_2", "my_bot", "my_bot_3"], ["my_bot_2", "my_bot_3"]),
        (["backup/my_bot", "my_bot"], ["backup/my_bot"]),
        (["stage_1", "stage_2", "stage_3"], ["stage_1", "stage_2"]),
    ],
)
def test_of_several_packages_of_one_name_one_is_kept(
    tmp_path: Path, copies: list[str], hidden: list[str]
) -> None:
    files = right()
    own = {path: text for path, text in files.texts.items() if path.startswith("src/my_bot/")}
    files.texts = {
        path.replace("src/my_bot/", f"src/{copy}/", 1): own[path] for copy in copies for path in own
    }
    (fix,) = found(files, tmp_path, "package-duplicate")
    assert fix.endswith(f"touch {' '.join(f'src/{place}/COLCON_IGNORE' for place in hidden)}")
    for place in hidden:
        (tmp_path / f"src/{place}/COLCON_IGNORE").touch()
    assert "package-duplicate" not in [one.code for one in of_workspace(tmp_path)]


def test_dashes_are_told_once_and_as_setuptools_takes_them(tmp_path: Path) -> None:
    files = right()
    for name in ("script_dir", "install_scripts"):
        files.change("setup.cfg", name, name.replace("_", "-"))
    (finding,) = (one for one in of_workspace(files.write(tmp_path)) if one.code == "setup-cfg-dashes")
    assert "with a warning" in finding.cause
    assert (
        finding.fix
        == "write script_dir instead of script-dir, and on line 4 install_scripts instead of install-scripts"
    )


@pytest.mark.parametrize("comma", ["", ","])
@pytest.mark.parametrize("keyword", ["parameters=[{'period': 1.0}]", "remappings=[('/a', '/b')]"])
def test_what_is_written_below_a_node_is_moved_into_it(tmp_path: Path, keyword: str, comma: str) -> None:
    text = "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\ndef generate_launch_description():\n"
    text += f"    one = Node(package='my_bot', executable='talker')\n    {keyword}{comma}\n    return LaunchDescription([one])\n"
    files = right().put("launch/one.launch.py", text)
    assert found(files, tmp_path, "launch-unused") == [f"add {keyword} to the Node on line 6"]
    assert "comma-tuple" not in {one.code for one in of_workspace(tmp_path)}
