"""What beginners bring along from ROS 1, from C++ and from plain Python packages, and where it leads."""

from __future__ import annotations

import os
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
FIRST = "        self.speed = 0.5\n"

# What stands in the constructor of a node, which then fails, and what the fix holds.
FAILS = {
    "a method of rospy's name": (
        "self.get_logger().warning_throttle(2.0, 'hot')",
        "`self.get_logger().warning('hot', throttle_duration_sec=2.0)`",
    ),
    "a method that Python's logging has": ("self.get_logger().info_once('hi')", "`self.get_logger().info('hi', once=True)`"),
    "a field of the type's name in Python": (
        "self.declare_parameter('gain', 1.0).get_parameter_value().float_value",
        "write double_value",
    ),
    "another one": ("self.declare_parameter('n', 1).get_parameter_value().int_value", "write integer_value"),
    "a template of C++": (
        "self.create_publisher<Twist>('/cmd_vel', 10)",
        "`self.create_publisher(Twist, '/cmd_vel', 10)`",
    ),
    "an element of a list that is empty": (
        "js = JointState()\n        js.position[0] = 0.5\n        js.position[1] = self.get_clock().now().nanoseconds * 1e-9",
        "`js.position = [0.5, self.get_clock().now().nanoseconds * 1e-09]`",
    ),
    # What a mend must fit: the lines around it, and what is there already.
    "elements in a loop": (
        "js = JointState()\n        for i in range(6):\n            js.position[i] = 0.5 * i",
        "write `js.position.append(0.5 * i)` instead of `js.position[i] = 0.5 * i`",
    ),
    "a condition above others": (
        "self.call = None\n        self.look()\n\n    def look(self):\n        if self.call.data == 1:\n            pass\n        elif self.call.data == 2:\n            pass\n\n    def keep(self, msg):\n        self.call = msg",
        "write these two lines above line 15: `if self.call is None:`, and indented below it `return`",
    ),
    "a method that rclpy calls": (
        "self.bed = {}\n\n    def get_namespace(self):\n        return self.bed['room']",
        "rename it, for example to get_namespace_",
    ),
    # What somebody else owns, or holds.
    "an attribute of rclpy's": ("self._clock = 3\n        self.create_timer(1.0, self.drive)", "write self.clock instead"),
    "the class of another node": ("super(JointState, self).__init__('again')", "write super() instead of super(JointState, self)"),
    "a method by a name that is made up": ("getattr(self, 'do_' + 'dance'.upper())()", "write `getattr(self, 'do_' + 'dance'.upper(), None)`"),
    "one that another object is to have": ("getattr(\n            rclpy, 'spin_' + self.get_name(),\n        )()", "write `getattr(rclpy, 'spin_' + self.get_name(), None)`"),
    "a message for what it holds": ("from std_msgs.msg import Float64\n        level = Float64(data=2.0)\n        round(level)", "level.data"),
}  # fmt: skip

# A mend of a kind that another one of these has, too.
OF_A_KIND = {
    "a method that Python's logging has",
    "another one",
    "the class of another node",
    "a message for what it holds",
}


def printed(root: Path) -> str:
    """Run a node until it fails by itself, and return what is then on the screen."""
    command = [sys.executable, "-c", f"from {NAME.package}.{NAME.driver} import main; main()"]
    done = subprocess.run(
        command, cwd=root / PACKAGE, capture_output=True, text=True, timeout=DEADLINE, check=False
    )
    return f"student$ ros2 run {NAME.package} {NAME.driver}\n{done.stdout}{done.stderr}"


def said_by_pytest(root: Path, *options: str) -> str:
    """Run the tests of a package, and return what is then on the screen.

    The plugins that are installed here take longer to load than the tests take, and say nothing of them.
    """
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", *options, "-p", "no:cacheprovider", "test"],
        cwd=root / PACKAGE,
        env={**os.environ, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        capture_output=True,
        text=True,
        timeout=DEADLINE,
        check=False,
    )
    return f"student$ python3 -m pytest test\n{done.stdout}"


def driver(line: str) -> Files:
    files = Files.right(NAME).change("driver", FIRST, f"{FIRST}        {line}\n")
    return files.change("driver", "import rclpy\n", "import rclpy\nfrom sensor_msgs.msg import JointState\n")


@pytest.mark.parametrize(
    "what", [pytest.param(what, marks=pytest.mark.thorough if what in OF_A_KIND else ()) for what in FAILS]
)
def test_what_another_language_or_release_has_is_put_right(tmp_path: Path, what: str) -> None:
    line, fix = FAILS[what]
    root = driver(line).write(tmp_path)
    text = printed(root)
    assert fix in of_text(text, root)[0].fix, text


def test_a_node_that_is_a_dataclass(tmp_path: Path) -> None:
    files = Files.right(NAME).change("driver", "class Driver", "@dataclass\nclass Driver")
    root = files.change(
        "driver", "import rclpy\n", "from dataclasses import dataclass\nimport rclpy\n"
    ).write(tmp_path)
    assert "remove @dataclass on line 7" in of_text(printed(root), root)[0].fix


def test_a_variable_of_another_function(tmp_path: Path) -> None:
    files = Files.right(NAME).change(
        "driver", "        self.publisher_.publish(msg)", "        node.publisher_.publish(msg)"
    )
    root = files.change("driver", "    rclpy.spin(node)", "    node.drive()").write(tmp_path)
    first = of_text(printed(root), root)[0]
    assert first.cause.startswith("node is a variable of main()")
    assert first.fix == "write `self.publisher_.publish(msg)`"


def first_of(files: Files, folder: Path) -> Finding:
    return of_workspace(files.write(folder))[0]


# Where an edit is made in the right workspace, and what is then told first: its code and a part of its fix.
SILENT = {
    "the last one of a loop": (
        "driver",
        "self.timer = self.create_timer(0.1, self.drive)",
        "for name in ('a', 'b'):\n            self.create_timer(1.0, lambda: print(name))\n        self.timer = self.create_timer(0.1, self.drive)",
        "computed-once",
        "`lambda name=name: print(name)`",
    ),
    "the last one of a loop, with a message": (
        "driver",
        "self.timer = self.create_timer(0.1, self.drive)",
        "for name in ('a', 'b'):\n            self.create_subscription(Twist, name, lambda msg: print(name, msg), 10)\n        self.timer = self.create_timer(0.1, self.drive)",
        "computed-once",
        "`lambda msg, name=name: print(name, msg)`",
    ),
    "a period without its rest": (
        "driver",
        "create_timer(0.1,",
        "create_timer(1 // 10,",
        "period",
        "`1 / 10`",
    ),
    "a period of nothing": ("driver", "create_timer(0.1,", "create_timer(0,", "period", "above 0"),
    "one name for two publishers": (
        "driver",
        "        self.timer =",
        "        self.publisher_ = self.create_publisher(Twist, '/other', 10)\n        self.timer =",
        "replaced",
        "self.publisher__2",
    ),
    "no package is found": (
        "setup.py",
        "find_packages(exclude=['test'])",
        "find_packages(where='src')",
        "package-not-listed",
        "write packages=['my_bot']",
    ),
    "a value that is given twice": (
        "setup.py",
        "    zip_safe=True,",
        "    zip_safe=True,\n    version='0.1.0',",
        "setup-syntax",
        "or the version on line",
    ),
    "a command as one text": (
        "launch/robot.launch.py",
        "    return LaunchDescription([",
        "    ExecuteProcess(cmd='ros2 topic list')\n    return LaunchDescription([",
        "launch-argument",
        "cmd=['ros2', 'topic', 'list']",
    ),
    "a simulator's time": (
        "launch/robot.launch.py",
        "parameters=[",
        "parameters=[{'use_sim_time': True}, ",
        "period",
        "set use_sim_time to False",
    ),
}


@pytest.mark.parametrize("what", SILENT)
def test_what_no_error_tells(tmp_path: Path, what: str) -> None:
    file, right, wrong, code, fix = SILENT[what]
    files = Files.right(NAME).change(file, right, wrong)
    if "launch" in file:
        files.change(
            file, "from launch import", "from launch.actions import ExecuteProcess\nfrom launch import"
        )
    first = first_of(files, tmp_path)
    assert first.code == code
    assert fix in first.fix


# What looks alike and is right.
RIGHT = [
    ("driver", "self.timer = self.create_timer(0.1, self.drive)", "for name in ('a', 'b'):\n            self.create_timer(1.0, lambda name=name: name.upper())\n        self.timer = self.create_timer(0.1, self.drive)"),
    ("driver", "create_timer(0.1,", "create_timer(1 / 10,"),
    ("driver", "        self.timer =", "        self.publisher_.publish(Twist())\n        self.timer ="),
    ("launch/robot.launch.py", "    return LaunchDescription([", "    return LaunchDescription([ExecuteProcess(cmd='ros2 topic list', shell=True), "),
]  # fmt: skip


@pytest.mark.parametrize("row", RIGHT)
def test_what_looks_alike_and_is_right(tmp_path: Path, row: tuple[str, str, str]) -> None:
    files = Files.right(NAME).change(*row)
    if "launch" in row[0]:
        files.change(
            row[0], "from launch import", "from launch.actions import ExecuteProcess\nfrom launch import"
        )
    assert [one for one in of_workspace(files.write(tmp_path)) if one.code != "sent-early"] == []


def test_a_table_that_takes_the_entry_points_over(tmp_path: Path) -> None:
    files = Files.right(NAME).put("pyproject.toml", "[project]\nname = 'my_bot'\nversion = '0.1.0'\n")
    assert first_of(files, tmp_path / "a").code == "entry-points-missing"
    files.put(
        "pyproject.toml", "[project]\nname = 'my_bot'\ndynamic = ['version', 'scripts', 'entry-points']\n"
    )
    assert of_workspace(files.write(tmp_path / "b")) == []


def test_a_setup_that_was_written_for_catkin(tmp_path: Path) -> None:
    text = "from catkin_pkg.python_setup import generate_distutils_setup\nfrom setuptools import setup\nsetup(**generate_distutils_setup(packages=['my_bot'], package_dir={'': 'src'}))\n"
    first = first_of(Files.right(NAME).put("setup.py", text), tmp_path)
    assert first.fix == "remove the line with package_dir"


@pytest.mark.parametrize(
    ("there", "fix"),
    [("", f"touch {PACKAGE}/README.md"), ("Readme.md", "write 'Readme.md' instead of 'README.md'")],
)
def test_a_file_that_setup_reads_and_that_is_not_there(tmp_path: Path, there: str, fix: str) -> None:
    files = Files.right(NAME).change(
        "setup.py", "    zip_safe=True,", "    zip_safe=True,\n    long_description=open('README.md').read(),"
    )
    said = (
        "student$ colcon build\nStarting >>> my_bot\nTraceback (most recent call last):\n"
        '  File "<string>", line 1, in <module>\n  File "/usr/lib/python3/dist-packages/setuptools/_distutils/core.py", line 268, in run_setup\n'
        "    exec(code, g)\n  File \"<string>\", line 22, in <module>\nFileNotFoundError: [Errno 2] No such file or directory: 'README.md'\n"
        "Failed   <<< my_bot [1.0s, exited with code 1]\nstudent$ ros2 run my_bot driver\nPackage 'my_bot' not found\n"
    )
    files = files.put(there, "# Robot\n") if there else files
    assert of_text(said, files.write(tmp_path))[0].fix.startswith(fix)


def test_a_parameter_file_that_is_searched_where_launch_is_typed(tmp_path: Path) -> None:
    old = "os.path.join(get_package_share_directory('PACKAGE'), 'config', 'robot.yaml')"
    first = first_of(Files.right(NAME).change("launch/robot.launch.py", old, "'config/robot.yaml'"), tmp_path)
    assert first.fix.startswith(
        "write PathJoinSubstitution([FindPackageShare('my_bot'), 'config', 'robot.yaml'])"
    )


@pytest.mark.parametrize(
    ("typed", "fix"),
    [
        ("ros2 topic echo /cmd_vel/linear/x", "ros2 topic echo /cmd_vel --field linear.x"),
        ("ros2 topic echo /cmd_vel/linear", "ros2 topic echo /cmd_vel --field linear"),
    ],
)
def test_a_field_behind_the_name_of_its_topic(tmp_path: Path, typed: str, fix: str) -> None:
    said = f"student$ {typed}\nWARNING: topic [{typed.rsplit(maxsplit=1)[-1]}] does not appear to be published yet\n"
    assert of_text(said, Files.right(NAME).write(tmp_path))[0].fix == f"type `{fix}`"


def test_fields_with_dots_in_a_message_that_is_typed(tmp_path: Path) -> None:
    typed = "ros2 topic pub --once /cmd_vel geometry_msgs/msg/Twist '{linear.x: 0.2, angular.z: 0.1}'"
    said = f"student$ {typed}\nFailed to populate field: geometry_msgs/msg/Twist has no field 'linear.x'\n"
    first = of_text(said, Files.right(NAME).write(tmp_path))[0]
    assert first.fix.endswith("'{linear: {x: 0.2}, angular: {z: 0.1}}'`")


def test_a_launch_file_in_the_words_of_another_release(tmp_path: Path) -> None:
    """Why it is no Python is not why it cannot be read as XML."""
    files = Files.right(NAME).put(
        "launch/old.launch.xml", "<launch>\n  <node pkg='my_bot' type='driver' name='d'/>\n</launch>\n"
    )
    said = (
        "student$ ros2 launch my_bot old.launch.xml\n[ERROR] [launch]: Caught exception in launch (see debug for traceback): "
        "Caught multiple exceptions when trying to load file of format [xml]:\n"
        " - AttributeError: Attribute 'exec' of type '<class 'str'>' not found in Entity 'node'\n"
        " - SyntaxError: invalid syntax (old.launch.xml, line 1)\nstudent@lab:~/ws$ \n"
    )
    assert of_text(said, files.write(tmp_path))[0].fix == "write exec instead of type"


TEST = "def PREFIXsum():\n    assert 0.1 + 0.2 == 0.3\n"


def test_tests_that_pytest_does_not_find(tmp_path: Path) -> None:
    tested = Files.right(NAME).change("setup.py", "zip_safe=True", "extras_require={'test': ['pytest']}")
    found = [
        first_of(tested.put(name, TEST.replace("PREFIX", prefix)), tmp_path / str(n)).fix
        for n, (name, prefix) in enumerate((("test/sum_tests.py", "check_"), ("test/test_sum.py", "check_")))
    ]
    assert found[0].startswith(
        f"mv {PACKAGE}/test/sum_tests.py {PACKAGE}/test/test_sum.py, and begin the names"
    )
    assert "test_sum" in found[1]


def test_two_numbers_that_are_nearly_one(tmp_path: Path) -> None:
    root = Files.right(NAME).put("test/test_sum.py", TEST.replace("PREFIX", "test_")).write(tmp_path)
    first = of_text(said_by_pytest(root), root)[0]
    assert first.fix.startswith("write `assert 0.1 + 0.2 == pytest.approx(0.3)`")


def test_a_period_that_a_name_stands_for(tmp_path: Path) -> None:
    for number, (value, fix) in enumerate(
        (("1 // 2", "write `1 / 2`"), ("0", "write a period above 0"), ("0.5", ""))
    ):
        files = Files.right(NAME)
        text = files.texts[files.path("node")]
        call = re.search(r"self.create_timer\(([^,]+),", text)
        assert call
        text = text.replace(call[0], "self.create_timer(pause,", 1)
        text = re.sub(r"( +)(.*self.create_timer\()", rf"\1pause = {value}\n\1\2", text, count=1)
        files.texts[files.path("node")] = text
        found = [one.fix for one in of_workspace(files.write(tmp_path / str(number))) if one.code == "period"]
        assert [one.startswith(fix) for one in found] == ([True] if fix else []), value


def test_a_manifest_whose_name_is_the_odd_one(tmp_path: Path) -> None:
    package = NAME.package
    files = Files.right(NAME).change("package.xml", f"<name>{package}</name>", "<name>other</name>")
    root = files.write(tmp_path)
    printed = f"student$ ros2 run {package} {NAME.module}\nPackage '{package}' not found\n"
    first = of_text(printed, root)[0]
    assert first.place.endswith("package.xml:3")
    assert first.fix.startswith(f"write <name>{package}</name>")


def test_a_class_method_makes_whichever_class_it_is_called_on(tmp_path: Path) -> None:
    made = "\n\n    @classmethod\n    def run(cls):\n        return cls()\n"
    base = f"class Base:\n    def __init__(self, name):\n        self.name = name{made}"
    files = Files.right(NAME).put(f"{NAME.package}/base.py", base)
    assert of_workspace(files.write(tmp_path)) == []


def test_what_was_installed_under_a_former_name(tmp_path: Path) -> None:
    files = Files.right(NAME)
    root = files.write(tmp_path)
    assert not any("no longer names" in one.cause for one in of_workspace(root))
    for name in (NAME.module, NAME.listener):
        program = root / "install/former/lib/former" / name
        program.parent.mkdir(parents=True, exist_ok=True)
        program.write_text("#!/usr/bin/python3\n")
    marker = root / "install/former/share/ament_index/resource_index/packages/former"
    marker.parent.mkdir(parents=True)
    marker.touch()
    found = [one for one in of_workspace(root) if one.place == "install/former"]
    assert [one.fix.partition(",")[0] for one in found] == ["rm -r build/former install/former"]


@pytest.mark.parametrize(
    ("typed", "printed", "wanted"),
    [
        ('"{data: Hello!!}"', '"{data: Hellols -l}"', "'{data: Hello!!}'"),
        ('"{data: go!now}"', "bash: !now}: event not found", "'{data: go!now}'"),
        ("'{data: Hello!!}'", "publishing #1", ""),
        ('"{data: Hello! you}"', "publishing #1", ""),
    ],
)
def test_what_bash_puts_in_place_of_an_exclamation_mark(
    typed: str, printed: str, wanted: str, tmp_path: Path
) -> None:
    command = "ros2 topic pub --once /robot/command std_msgs/msg/String"
    shown = printed if "bash" in printed else f"{command} {printed}"
    root = Files.right(NAME).write(tmp_path)
    found = of_text(f"student$ {command} {typed}\n{shown}\n", root)
    told = [one.fix for one in found if "double quotes, bash" in one.cause]
    assert told == ([f"type `{command} {wanted}`"] if wanted else [])


OWN = """from PACKAGE.limits import Counter
from PACKAGE.MODULE import CLASS


def test_it():
    LINE
"""


OF_ONES_OWN = [
    ("assert Counter().increment() == 1", "test/test_it.py:6", "remove increment here, or define it in Counter"),
    ("assert Counter.add() == 1", "test/test_it.py:6", "write `assert Counter().add() == 1`"),
    ("assert Counter(2).add() == 2", "test/test_it.py:6", "fix Counter(2).add() if 2 is right; otherwise write 3 here"),
    ("CLASS()", "test/test_it.py:6", "write rclpy.init() above this line"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("line", "place", "words", "style"),
    [
        # Each line in one form, and each form twice; all in both are thorough.
        pytest.param(*row, style, marks=() if n % 2 == m else pytest.mark.thorough)
        for n, row in enumerate(OF_ONES_OWN)
        for m, style in enumerate(("short", "long"))
    ],
)
def test_what_a_test_of_ones_own_says(line: str, place: str, words: str, style: str, tmp_path: Path) -> None:
    """Of a real pytest, in both forms in which it names a line."""
    name = NAMES[1]
    counter = "class Counter:\n    def __init__(self, start=0):\n        self.count = start\n\n    def add(self):\n        self.count += 1\n        return self.count\n"
    text = OWN.replace("LINE", line).replace("PACKAGE", name.package)
    text = text.replace("MODULE", name.module).replace("CLASS", name.class_name)
    files = Files.right(name).put(f"{name.package}/limits.py", counter).put("test/test_it.py", text)
    root = files.write(tmp_path)
    text = said_by_pytest(root, f"--tb={style}")
    first = of_text(text, root)[0]
    assert first.place.endswith(place), text
    assert first.fix.startswith(words), text


def test_a_python_package_that_two_packages_install(tmp_path: Path) -> None:
    for name in NAMES[1:3]:
        files = Files.right(name).change(
            "setup.py", "find_packages(exclude=['test'])", f"['{name.package}', 'helpers']"
        )
        files.put("helpers/__init__.py", "").write(tmp_path)
    found = [one for one in of_workspace(tmp_path) if one.code == "name-shadowed"]
    assert "both install a Python package helpers" in found[0].cause


def test_numbers_in_lists_and_dictionaries_that_are_nearly_one(tmp_path: Path) -> None:
    for n, (left, right) in enumerate(
        (("[0.1, 0.2, 0.1 * 3]", "[0.1, 0.2, 0.3]"), ("{'a': 0.1 * 3}", "{'a': 0.3}"))
    ):
        test = f"def test_sum():\n    assert {left} == {right}\n"
        root = Files.right(NAME).put("test/test_sum.py", test).write(tmp_path / str(n))
        text = said_by_pytest(root)
        first = of_text(text, root)[0]
        assert first.fix.startswith(f"write `assert {left} == pytest.approx({right})`"), text


def test_of_a_circle_the_dependency_that_nothing_uses_goes(tmp_path: Path) -> None:
    one, other = NAMES[1:3]
    for name, wants in ((one, other), (other, one)):
        files = Files.right(name).change(
            "package.xml", "  <depend>std_msgs", f"  <depend>{wants.package}</depend>\n  <depend>std_msgs"
        )
        if name is other:
            files.change(
                "driver", "import rclpy\n", f"import rclpy\nfrom {wants.package} import {wants.module}\n"
            )
        files.write(tmp_path)
    first = of_workspace(tmp_path)[0]
    assert (
        first.fix
        == f"remove the dependency on {other.package} from the package.xml of {one.package}, which does not use it"
    )


def test_a_topic_that_is_only_asked_about_is_met_by_either_side(tmp_path: Path) -> None:
    root = Files.right(NAME).write(tmp_path)
    said = (
        'student$ ros2 topic pub --once /robot/command std_msgs/msg/Int32 "{data: 1}"\nWaiting for at least 1 matching subscription(s)...\n'
        "student$ ros2 topic info /robot/command\nType: std_msgs/msg/String\nPublisher count: 0\nSubscription count: 1\n"
    )
    assert of_text(said, root)[0].code == "topic-type"


def test_a_description_that_is_kept_in_a_variable(tmp_path: Path) -> None:
    text = (
        "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\ndef generate_launch_description():\n    ld = LaunchDescription()\n"
        "    driver = Node(package='my_bot', executable='EXECUTABLE')\n    return ld\n"
    )
    files = Files.right(NAME)
    files.put("launch/robot.launch.py", text)
    found = [one.fix for one in of_workspace(files.write(tmp_path)) if one.code == "launch-lost"]
    assert found == ["write `ld.add_action(driver)` below line 7"]


def test_a_launch_argument_that_is_reckoned_with(tmp_path: Path) -> None:
    text = (
        "from launch import LaunchDescription\nfrom launch.actions import DeclareLaunchArgument\nfrom launch.substitutions import LaunchConfiguration\n\n\n"
        "def generate_launch_description():\n    top = LaunchConfiguration('floors') - 1\n    return LaunchDescription([DeclareLaunchArgument('floors', default_value=top)])\n"
    )
    first = first_of(Files.right(NAME).put("launch/robot.launch.py", text), tmp_path)
    assert first.fix.startswith("write PythonExpression([LaunchConfiguration('floors'), ' - 1'])")


@pytest.mark.parametrize(
    ("unknown", "fix"),
    [
        ("arg", "$(var ...)"),
        pytest.param("find", "$(find-pkg-share ...)", marks=pytest.mark.thorough),
        ("evil", "$(eval ...)"),
        ("zoom", "one that launch has: $(all ...)"),
    ],
)
def test_a_substitution_of_an_earlier_release(tmp_path: Path, unknown: str, fix: str) -> None:
    files = Files.right(NAME).put(
        "launch/old.launch.xml", f"<launch>\n  <arg name='a' default='$({unknown} b)'/>\n</launch>\n"
    )
    said = f"student$ ros2 launch my_bot old.launch.xml\n[ERROR] [launch]: Caught exception in launch (see debug for traceback): Unknown substitution: {unknown}\n"
    first = of_text(said, files.write(tmp_path))[0]
    assert first.place.endswith("old.launch.xml:2")
    assert fix in first.fix


@pytest.mark.parametrize(("rest", "is_fault"), [(1.0, True), (0.01, False)])
def test_a_loop_that_rests_between_two_turns(tmp_path: Path, rest: float, is_fault: bool) -> None:
    loop = f"    while rclpy.ok():\n        rclpy.spin_once(node)\n        time.sleep({rest})\n"
    files = Files.right(NAME).change("driver", "    rclpy.spin(node)\n", loop)
    files.change("driver", "import rclpy\n", "import time\nimport rclpy\n")
    codes = [one.code for one in of_workspace(files.write(tmp_path))]
    assert ("callback-waits" in codes) is is_fault


@pytest.mark.parametrize(
    ("loop", "is_fault"),
    [
        ("while rclpy.ok():\n        time.sleep(1.0)", True),
        ("for _ in range(9):\n        node.get_name()\n        time.sleep(rest)", True),
        ("threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()\n    while rclpy.ok():\n        time.sleep(1.0)", False),
        ("time.sleep(1.0)\n    rclpy.spin(node)", False),
        ("while rclpy.ok():\n        time.sleep(0.01)\n        rclpy.spin_once(node)", False),
    ],
)  # fmt: skip
def test_a_loop_that_spins_nothing(tmp_path: Path, loop: str, is_fault: bool) -> None:
    files = Files.right(NAME).change("driver", "    rclpy.spin(node)\n", f"    {loop}\n")
    files.change("driver", "import rclpy\n", "import threading\nimport time\nimport rclpy\nrest = 1.0\n")
    fixes = [one.fix for one in of_workspace(files.write(tmp_path)) if one.code == "spin-missing"]
    assert [fix.partition(" instead")[0] for fix in fixes] == (
        [f"write rclpy.spin_once(node, timeout_sec={'1.0' if '1.0' in loop else 'rest'})"] if is_fault else []
    )


def test_a_package_of_the_name_of_a_module_of_pythons_own(tmp_path: Path) -> None:
    files = Files.right(NAME).change("setup.py", "find_packages(exclude=['test'])", "find_packages()")
    files.put("test/__init__.py", "")
    assert of_workspace(files.write(tmp_path / "a")) == []
    found = of_workspace(files.put("queue/__init__.py", "").write(tmp_path / "b"))
    assert found[0].place == f"{PACKAGE}/queue"


def test_a_pattern_that_takes_no_file(tmp_path: Path) -> None:
    files = Files.right(NAME).change("setup.py", "launch/*.launch.py", "launch/*.launch.pv")
    first = first_of(files, tmp_path)
    assert (
        first.fix == "write glob('launch/*.launch.py') instead of glob('launch/*.launch.pv'), and build again"
    )


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("'data: Crane 3: closed'", "\"{data: 'Crane 3: closed'}\""),
        ("'{data: a: b}'", "\"{data: 'a: b'}\""),
    ],
)
def test_a_text_that_yaml_does_not_take(tmp_path: Path, typed: str, meant: str) -> None:
    command = "ros2 topic pub --once /robot/command std_msgs/msg/String"
    said = f"student$ {command} {typed}\nThe passed value is not valid YAML at line 1, column 14: mapping values are not allowed here\n"
    assert of_text(said, Files.right(NAME).write(tmp_path))[0].fix == f"type `{command} {meant}`"


def test_a_program_that_was_only_frozen(tmp_path: Path) -> None:
    said = (
        "student$ ros2 run my_bot wheels\n^Z\n[1]+  Stopped                 ros2 run my_bot wheels\n"
        "student$ ros2 topic echo /cmd_vel\n"
    )
    first = of_text(said, Files.right(NAME).write(tmp_path))[0]
    assert first.fix.startswith("type `bg`")


def test_a_program_that_launch_starts_again_and_again(tmp_path: Path) -> None:
    files = Files.right(NAME).change("launch/robot.launch.py", "parameters=[", "respawn=True, parameters=[")
    begun = "[INFO] [wheels-1]: process started with pid [1]\n[INFO] [wheels-1]: process has finished cleanly [pid 1]\n"
    root = files.write(tmp_path)
    first = of_text(f"student$ ros2 launch my_bot robot.launch.py\n{begun * 3}", root)[0]
    assert "respawn" in first.fix
    assert of_text(f"student$ ros2 launch my_bot robot.launch.py\n{begun}", root) == []


@pytest.mark.parametrize("inside", ["time.sleep(0.05)", "pass"])
def test_a_callback_that_waits_for_another_one(tmp_path: Path, inside: str) -> None:
    methods = f"    def order(self, msg):\n        while not self.paid:\n            {inside}\n\n    def pay(self, msg):\n        self.paid = True\n\n"
    made = "        self.paid = False\n        self.create_subscription(Twist, 'order', self.order, 10)\n        self.create_subscription(Twist, 'pay', self.pay, 10)\n"
    files = Files.right(NAME).change("driver", FIRST, f"{FIRST}{made}")
    files.change("driver", "    def drive(self):", f"{methods}    def drive(self):")
    files.change("driver", "import rclpy\n", "import time\nimport rclpy\n")
    assert "callback-waits" in [one.code for one in of_workspace(files.write(tmp_path / "a"))]
    files.change("driver", "rclpy.spin(node)", "rclpy.spin(node, MultiThreadedExecutor())")
    files.change(
        "driver", "import rclpy\n", "import rclpy\nfrom rclpy.executors import MultiThreadedExecutor\n"
    )
    (told,) = (one for one in of_workspace(files.write(tmp_path / "b")) if one.code == "callback-waits")
    made = told.fix.partition("`")[2].partition("`")[0]  # in several threads, the group counts
    files.change("driver", "self.create_subscription(Twist, 'order', self.order, 10)", made)
    files.change(
        "driver",
        "import rclpy\n",
        "import rclpy\nfrom rclpy.callback_groups import MutuallyExclusiveCallbackGroup\n",
    )
    assert "callback-waits" not in [one.code for one in of_workspace(files.write(tmp_path / "c"))]


def test_a_copied_line_with_the_topic_of_another_program(tmp_path: Path) -> None:
    files = Files.right(NAME)
    for name in ("height", "reach"):
        text = (
            files.texts[files.path("driver")]
            .replace("'/cmd_vel'", "'/crane/height'")
            .replace("'wheels'", f"'{name}'")
        )
        files.put(f"{NAME.package}/{name}.py", text)
    files.change(
        "listener",
        "        self.subscription",
        "        self.create_subscription(Twist, '/crane/height', print, 10)\n        self.create_subscription(Twist, '/crane/reach', print, 10)\n        self.subscription",
    )
    files.change("listener", "import rclpy\n", "import rclpy\nfrom geometry_msgs.msg import Twist\n")
    found = [one for one in of_workspace(files.write(tmp_path)) if one.code == "topic-near-miss"]
    assert [one.fix for one in found] == ["write 'crane/reach' instead of 'crane/height' here"]
    assert "reach.py" in found[0].place
