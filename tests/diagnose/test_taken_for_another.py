"""One thing that is taken for another: a module, a class, an executable, a node, a member, or what a terminal shows."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text, of_workspace
from ros2lab.diagnose.explaining.typed_message import as_message

NAME = NAMES[1]
PACKAGE = f"src/{NAME.package}"
INNER = f"{PACKAGE}/{NAME.package}"
HELPER = "def twice(value):\n    return 2 * value\n"


def codes(files: Files, root: Path) -> dict[str, str]:
    return {one.code: one.fix for one in of_workspace(files.write(root))}


@pytest.mark.parametrize(
    "line", ["from helper import twice", "import helper", "from aids.helper import twice"]
)
def test_a_module_of_ones_own_without_its_package(tmp_path: Path, line: str) -> None:
    files = Files.right(NAME).change("node", "import rclpy\n", f"import rclpy\n{line}\n")
    files.put(f"{NAME.package}/helper.py", HELPER).put(f"{NAME.package}/aids/helper.py", HELPER)
    files.put(f"{NAME.package}/aids/__init__.py", "")
    module = line.split()[1]
    assert codes(files, tmp_path)["import-wrong"] == (
        f"write {NAME.package}.{module} instead of {module} there, and build again"
    )


@pytest.mark.parametrize(
    "line",
    [
        f"from {NAME.package}.helper import twice",
        "from .helper import twice",
        "try:\n    from helper import twice\nexcept ImportError:\n    from .helper import twice",
        "import json",
    ],
)
def test_a_module_that_is_found(tmp_path: Path, line: str) -> None:
    files = Files.right(NAME).change("node", "import rclpy\n", f"import rclpy\n{line}\n")
    files.put(f"{NAME.package}/helper.py", HELPER).put(f"{NAME.package}/json.py", HELPER)
    assert "import-wrong" not in codes(files, tmp_path)


@pytest.mark.parametrize(
    ("use", "is_own"),
    [
        ("import helper\nprint(helper.twice(2))", True),
        ("import helper as aid\nprint(aid.twice(aid.LIMIT))", True),
        ("from helper import *", True),
        ("import helper\nprint(helper.Serial('/dev/ttyUSB0'))", False),
        ("import helper as aid\nprint(aid.solutions.hands)", False),
        ("from helper import Helper", False),
        ("from helper import twice, Helper", False),
        ("import MODULE\nprint(MODULE.CLASS)", False),
    ],
)
def test_a_library_with_the_name_of_a_module_of_ones_own(tmp_path: Path, use: str, is_own: bool) -> None:
    files = Files.right(NAME).change("node", "import rclpy\n", f"import rclpy\n{use}\n")
    root = files.put(f"{NAME.package}/helper.py", f"{HELPER}LIMIT = 1\n").write(tmp_path)
    assert any(one.code == "import-wrong" for one in of_workspace(root)) is is_own
    module = NAME.module if "MODULE" in use else "helper"
    path = root / INNER / f"{NAME.module}.py"
    printed = f'Traceback (most recent call last):\n  File "{path}", line 2, in <module>\n    {use}\nModuleNotFoundError: No module named {module!r}'
    (found, *_) = of_text(printed, root)
    assert found.code == ("import-wrong" if is_own else "module-missing")
    assert found.fix.startswith("write" if is_own else "install the library")


BARE = "from helper import twice\n"


@pytest.mark.parametrize(
    ("module", "line", "in_setup", "in_launch"),
    [
        ("node", f"import os, sys\nsys.path.append(os.path.dirname(__file__))\n{BARE}", "", ""),
        ("node", f"from sys import path\npath.insert(0, __file__)\n{BARE}", "", ""),
        (f"{NAME.package}/by_hand.py", f"{BARE}\nprint(twice(2))\n", "", ""),
        ("node", BARE, f"        ('lib/' + package_name, ['{NAME.package}/helper.py']),\n", ""),
        ("node", BARE, "", ", additional_env={'PYTHONPATH': 'here'}"),
    ],
)
def test_a_module_that_is_found_without_its_package(
    tmp_path: Path, module: str, line: str, in_setup: str, in_launch: str
) -> None:
    files = Files.right(NAME).put(f"{NAME.package}/helper.py", HELPER)
    files.put(module, line + files.texts.get(files.path(module), ""))
    files.change("setup.py", "    data_files=[\n", f"    data_files=[\n{in_setup}")
    files.change("launch/robot.launch.py", "executable='MODULE'", f"executable='MODULE'{in_launch}")
    assert "import-wrong" not in codes(files, tmp_path)


def test_a_module_without_its_package_in_one_that_an_executable_imports(tmp_path: Path) -> None:
    files = Files.right(NAME).change("node", "import rclpy\n", "import rclpy\nfrom .first import twice\n")
    files.put(f"{NAME.package}/first.py", BARE).put(f"{NAME.package}/helper.py", HELPER)
    assert f"{NAME.package}.helper" in codes(files, tmp_path)["import-wrong"]


@pytest.mark.parametrize(
    ("old", "new", "fix"),
    [
        ("            'MODULE =", "            'draw_shapes = PACKAGE.draw_shapes:main',\n            'MODULE =", "remove this entry point"),
        ("PACKAGE.MODULE:main", "PACKAGE.MODULEs:main", "'talker = my_bot.talker:main'"),
        ("            'MODULE =", "            'again = PACKAGE.MODULEs:main',\n            'MODULE =", "'again = my_bot.talker:main'"),
    ],
)  # fmt: skip
def test_an_entry_point_to_a_file_that_is_gone(tmp_path: Path, old: str, new: str, fix: str) -> None:
    """The file of another entry point is meant by a misspelling alone."""
    files = Files.right(NAMES[1]).change("setup.py", old, new)
    files.put("PACKAGE/draw_circle.py", files.texts[files.path("listener")])
    row = "            'draw_circle = PACKAGE.draw_circle:main',\n            'LISTENER ="
    files.change("setup.py", "            'LISTENER =", row)
    assert fix in codes(files, tmp_path)["entry-point-module"]


@pytest.mark.parametrize(
    ("declared", "code", "fix"),
    [
        ("'flip', 0", "", ""),
        ("'top_count', 0", "", ""),
        ("'top_speed', 0.8", "parameter-unread", "write self.speed = self.get_parameter('top_speed').value"),
    ],
)
def test_a_parameter_that_nothing_reads(tmp_path: Path, declared: str, code: str, fix: str) -> None:
    """A counter begins with 0, too, and is no parameter's attribute."""
    files = Files.right(NAMES[1])
    line = f"self.count = 0\n        self.declare_parameter({declared})\n        self.speed = 0.8"
    files.change("node", "self.count = 0", line).change("node", "{self.count}'", "{self.count} {self.speed}'")
    assert codes(files, tmp_path) == ({code: fix} if code else {})


def test_an_executable_that_calls_the_file_of_another(tmp_path: Path) -> None:
    point = f"{NAME.listener} = {NAME.package}.{NAME.listener}:main"
    files = Files.right(NAME)
    files.texts[f"{INNER}/subscriber_member_function.py"] = files.texts.pop(files.path("listener"))
    files.change("setup.py", point, f"{NAME.listener} = {NAME.package}.{NAME.module}:main")
    meant = f"if {NAME.listener} should run that file, write '{NAME.listener} = {NAME.package}.subscriber_member_function:main', and build again"
    assert codes(files, tmp_path)["entry-point-function"] == meant


@pytest.mark.parametrize(
    ("points", "unused", "fixes"),
    [
        (("Drive_Node = drive", "Drive_New = drive"), "drive_new", ["Drive_New = {}"]),
        (("Drive_Node = drive", "New_Drive = drive"), "drive_new", ["New_Drive = {}"]),
        (("New_Drive = drive", "Drive_Node = drive"), "drive_new", ["New_Drive = {}"]),
        (("a = drive", "b = drive", "c = drive", "new_c = drive"), "new_driver_c", ["new_c = {}"]),
        (("drive_a = drive", "drive_b = drive"), "drive_c", []),
        (("gui_node = read", "read = read", "go = drive", "go_new = drive"), "go_new_way", ["go_new = {}"]),
        (("gui_node = read", "read = read"), "drive", ["if gui_node should run that file, write 'gui_node = {}"]),
        (("gui_node = read", "show_node = read"), "drive", []),
        (("gui_node = read", "show_node = read"), "", []),
    ],
)  # fmt: skip
def test_which_of_two_executables_should_run_the_file_that_none_runs(
    tmp_path: Path, points: tuple[str, ...], unused: str, fixes: list[str]
) -> None:
    files = Files.right(NAME)
    rows = ",\n            ".join(f"'{point.replace('= ', '= my_bot.')}:main'" for point in points)
    files.change("setup.py", "'console_scripts': [\n", f"'console_scripts': [\n            {rows},\n")
    for name in {*(point.split()[-1] for point in points), unused} - {""}:
        files.put(f"{NAME.package}/{name}.py", "def main():\n    print(1)\n")
    found = [one.fix for one in of_workspace(files.write(tmp_path)) if one.code == "entry-point-function"]
    assert len(found) == len(fixes)
    assert all(fix.format(f"my_bot.{unused}:main") in told for fix, told in zip(fixes, found, strict=True))


@pytest.mark.parametrize(
    ("executable", "fix"),
    [
        ("talker_node", "write talker instead"),
        ("tlaker", "write talker instead"),
        ("path_reader", "remove this Node, or write the program"),
        ("left_wheels_talker_gui", "remove this Node, or write the program"),
        ("arm_wheels", "remove this Node, or write the program"),
    ],
)
def test_a_shared_word_makes_no_other_executable_the_meant_one(
    tmp_path: Path, executable: str, fix: str
) -> None:
    files = Files.right(NAME)
    rows = "'leg_wheels = my_bot.wheels:main', 'path_talker = my_bot.talker:main',"
    files.change("setup.py", "'console_scripts': [\n", f"'console_scripts': [\n            {rows}\n")
    files.change("launch/robot.launch.py", "executable='MODULE'", f"executable='{executable}'")
    assert codes(files, tmp_path)["launch-executable"].startswith(fix)


@pytest.mark.parametrize(
    ("point", "code", "fix"),
    [
        ("my_bot.__init__:main", "", ""),
        ("my_bot:main", "", ""),
        ("my_bot.sub.__init__:main", "", ""),
        ("my_bot.__main__:main", "", ""),
        ("my_bot.__init__:mian", "entry-point-function", "has main"),
        ("my_bot.nothere.__init__:main", "entry-point-module", "write 'wheels = my_bot.wheels:main'"),
    ],
)
def test_a_package_and_its_init_are_one_module(tmp_path: Path, point: str, code: str, fix: str) -> None:
    files = Files.right(NAME).change("setup.py", f"my_bot.{NAME.driver}:main", point)
    for name in ("__init__", "sub/__init__", "__main__"):
        files.put(f"my_bot/{name}.py", "def main():\n    print(1)\n")
    found = {one.code: one.fix for one in of_workspace(files.write(tmp_path)) if NAME.driver in one.about}
    assert [*found] == [code] * bool(code)
    assert fix in found.get(code, "")


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("from launch import SomeActionsType", ["import-wrong"]),
        ("from launch.conditions import LaunchConfigurationNotEqual", ["import-wrong"]),
        ("from launch_ros.actions import Nod", ["import-wrong"]),
        ("import launch.nothing", []),
        ("import my_helpers", ["launch-package"]),
        ("from nav2_common.launch import RewrittenYaml", ["launch-package"]),
    ],
)
def test_a_name_that_a_module_lacks_is_no_package(tmp_path: Path, line: str, expected: list[str]) -> None:
    files = Files.right(NAME)
    path = f"{PACKAGE}/launch/robot.launch.py"
    files.texts[path] = f"{line}\n{files.texts[path]}"
    assert [code for code in codes(files, tmp_path) if code in ("import-wrong", "launch-package")] == expected


@pytest.mark.parametrize(
    ("there", "named", "fix"),
    [
        ("", "print", "define main(args=None) in src/my_bot/my_bot/ears.py"),
        ("def shown(image):\n    return image\n", "print", "define main(args=None) in src/my_bot/my_bot/ears.py"),
        ("def run():\n    pass\n", "print", "ears.py has run"),
        ("", "Node('ears')", "write 'ears = my_bot.looks:main'"),
    ],
)  # fmt: skip
def test_the_main_of_another_program(tmp_path: Path, there: str, named: str, fix: str) -> None:
    """Every program may have a main(), so that alone does not say that it is meant."""
    files = Files.right(NAME).put("listener", there)
    text = "from rclpy.node import Node\n\n\ndef main():\n    MADE\n"
    files.put(f"{NAME.package}/looks.py", text.replace("MADE", named))
    assert fix in codes(files, tmp_path)["entry-point-function"]


def test_two_names_for_one_executable_are_right(tmp_path: Path) -> None:
    point = f"'{NAME.listener} = {NAME.package}.{NAME.listener}:main'"
    files = Files.right(NAME).change(
        "setup.py", point, f"{point},\n            'echo{point[1 + len(NAME.listener) :]}"
    )
    assert "entry-point-function" not in codes(files, tmp_path)


def test_a_class_that_hides_the_message_type_that_it_imports(tmp_path: Path) -> None:
    files = Files.right(NAME).change("node", f"class {NAME.class_name}(", "class String(")
    files.change("node", f"{NAME.class_name}()", "String()")
    root = files.write(tmp_path)
    first = of_workspace(root)[0]
    assert (first.code, first.fix) == (
        "name-shadowed",
        "rename the class to StringNode, here and where the class is meant; String stays where the message is",
    )
    said = "AttributeError: type object 'type' has no attribute '_TYPE_SUPPORT' This might be a ROS 1 message type"
    line = first.place.rpartition(":")[2]
    report = f'Traceback (most recent call last):\n  File "{root}/{INNER}/{NAME.module}.py", line {int(line) + 4}, in __init__\n    x\n{said}\n'
    assert of_text(report, root)[0].code == "name-shadowed"


@pytest.mark.parametrize(
    ("word", "kind", "meant"),
    [
        ("{data: true}", "boolean", ""),
        ("{data: no}", "boolean", ""),
        ("data: False", "boolean", ""),
        ("{data: 'on'}", "string", ""),
        ("{data: 1}", "double", ""),
        ("true", "boolean", "{data: true}"),
        ("{data: on}", "string", "{data: 'on'}"),
        ("{data:true}", "boolean", "{data: true}"),
    ],
)
def test_a_message_is_what_yaml_reads(word: str, kind: str, meant: str) -> None:
    assert as_message(word, {"data": kind}) == (meant or word)


TWO = """\
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


class Left(Node):
    def __init__(self):
        super().__init__('left')


class Right(Node):
    def __init__(self):
        super().__init__('right')


def main():
    rclpy.init()
    executor = SingleThreadedExecutor()
    for node in MADE:
        executor.add_node(node)
    executor.spin()
"""


@pytest.mark.parametrize(("made", "is_told"), [("[Left(), Right()]", True), ("[Left()]", False)])
def test_a_name_that_a_launch_file_gives_to_several_nodes(tmp_path: Path, made: str, is_told: bool) -> None:
    files = Files.right(NAME)
    files.texts[files.path("driver")] = TWO.replace("MADE", made)
    files.change("launch/robot.launch.py", "executable='DRIVER'", "executable='DRIVER', name='pair'")
    fix = "remove name='pair', so that each node keeps the name from its code"
    assert (codes(files, tmp_path).get("name-twice") == fix) == is_told


@pytest.mark.parametrize(
    ("made", "told"), [("[Left(), Right()]", {"name-twice"}), ("[Left()]", {"parameter-file-node"})]
)
def test_the_parameters_that_nodes_of_one_name_do_not_get_are_told_with_it(
    tmp_path: Path, made: str, told: set[str]
) -> None:
    files = Files.right(NAME)
    files.texts[files.path("driver")] = TWO.replace("MADE", made)
    named = "executable='DRIVER', parameters=[config], name='pair'"
    files.change("launch/robot.launch.py", "executable='DRIVER'", named)
    files.texts[files.path("config/robot.yaml")] = "left:\n  ros__parameters:\n    speed: 1.0\n"
    assert codes(files, tmp_path).keys() & {"name-twice", "parameter-file-node"} == told


@pytest.mark.parametrize("other", ["topic", "topic + '_out'"])
def test_a_node_that_answers_itself_on_a_topic_in_a_variable(tmp_path: Path, other: str) -> None:
    files = Files.right(NAME)
    files.texts[files.path("listener")] = f"""\
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Echo(Node):
    def __init__(self, topic='echo'):
        super().__init__('{NAME.listener}')
        self.out = self.create_publisher(String, {other}, 10)
        self.create_subscription(String, topic, self.heard, 10)

    def heard(self, msg):
        self.out.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Echo())
"""
    assert ("endless-loop" in codes(files, tmp_path)) == (other == "topic")


def test_a_stamp_is_made_by_a_method_of_the_time(tmp_path: Path) -> None:
    files = Files.right(NAME)
    files.change("node", "import rclpy\n", "import rclpy\nfrom geometry_msgs.msg import PoseStamped\n")
    files.change(
        "node",
        "        msg = String()\n",
        "        pose = PoseStamped()\n        pose.header.stamp = self.get_clock().now()\n        msg = String()\n",
    )
    root = files.write(tmp_path)
    text = (root / INNER / f"{NAME.module}.py").read_text()
    line = text[: text.index("pose.header.stamp")].count("\n") + 1
    report = f"Traceback (most recent call last):\n  File \"{root}/{INNER}/{NAME.module}.py\", line {line}, in tick\n    pose.header.stamp = self.get_clock().now()\nAssertionError: The 'stamp' field must be a sub message of type 'Time'\n"
    assert of_text(report, root)[0].fix == "write `pose.header.stamp = self.get_clock().now().to_msg()`"


PAIR = """\
import functools
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Speaker(Node):
    def __init__(self):
        super().__init__('speaker')
        self.out = self.create_publisher(String, 'orders', 10)
        self.create_timer(1.0, lambda: self.out.publish(String(data='go')))


class Hearer(Node):
    def __init__(self):
        super().__init__('hearer')
        self.create_subscription(String, '/orders', print, 10)


def run(kind):
    rclpy.init()
    rclpy.spin(kind())


def speak():
    run(Speaker)


hear = functools.partial(run, Hearer)
"""


def test_of_several_nodes_in_one_file_each_has_its_own_topics(tmp_path: Path) -> None:
    """A launch file that starts both in a namespace takes them apart, and each is said to do what it does."""
    files = Files.right(NAME)
    files.put(f"{NAME.package}/pair.py", PAIR)
    point = f"'{NAME.listener} = {NAME.package}.{NAME.listener}:main'"
    more = f"'speak = {NAME.package}.pair:speak',\n            'hear = {NAME.package}.pair:hear'"
    files.change("setup.py", point, f"{point},\n            {more}")
    nodes = ", ".join(
        f"Node(package='{NAME.package}', executable='{name}', namespace='ship')" for name in ("speak", "hear")
    )
    files.texts[files.path("launch/robot.launch.py")] = (
        "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\n"
        f"def generate_launch_description():\n    return LaunchDescription([{nodes}])\n"
    )
    found = next(one for one in of_workspace(files.write(tmp_path)) if one.code == "launch-apart")
    assert "speak publishes on /ship/orders, but hear subscribes to /orders" in found.cause
    assert found.fix == "write 'orders' instead of '/orders'"


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("float(rate) / 2", "PythonExpression(['float(', rate, ') / 2'])"),
        ("1 / float(rate)", "PythonExpression(['1 / float(', rate, ')'])"),
        ("max(int(rate) - 1, 0)", "PythonExpression(['max(int(', rate, ') - 1, 0)'])"),
        ("-2 * float(rate)", "PythonExpression(['-2 * float(', rate, ')'])"),
    ],
)
def test_a_calculation_with_an_argument_of_a_launch_file(tmp_path: Path, written: str, meant: str) -> None:
    files = Files.right(NAME)
    files.texts[files.path("launch/robot.launch.py")] = f"""\
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    rate = LaunchConfiguration('rate')
    return LaunchDescription([
        DeclareLaunchArgument('rate', default_value='1.0'),
        Node(package='{NAME.package}', executable='{NAME.module}', parameters=[{{'period': {written}}}]),
    ])
"""
    fix = next(one.fix for one in of_workspace(files.write(tmp_path)) if one.code == "launch-argument")
    assert fix.startswith(f"write {meant} instead of {written}, with")


def test_a_terminal_that_was_sourced_between_two_builds(tmp_path: Path) -> None:
    root = Files.right(NAME).write(tmp_path)
    index = root / "install" / NAME.package / "share/ament_index/resource_index/packages"
    index.mkdir(parents=True)
    (index / NAME.package).touch()
    said = f"student$ colcon build\nstudent$ source install/setup.bash\nstudent$ colcon build\nstudent$ ros2 run {NAME.package} x\nPackage '{NAME.package}' not found\n"
    found = of_text(said, root)[0]
    assert found.code == "not-sourced"
    assert "was sourced before" in found.cause
