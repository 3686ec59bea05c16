"""Right code that looks like a fault: each workspace is quiet, and the fault beside it is still told."""

from __future__ import annotations

import shutil
import textwrap
from pathlib import Path

import pytest
from one_file import sources_of
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.code.argument_names import argument_name_faults
from ros2lab.diagnose.code.expression_faults import expression_faults
from ros2lab.diagnose.code.lost_parameters import lost_parameters
from ros2lab.diagnose.sources.spelling import is_near_miss

NAME = NAMES[1]
PACKAGE = NAME.package
LAUNCH = """\
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    return LaunchDescription([ACTIONS])
"""
OWN = f"Node(package='{PACKAGE}', executable='{NAME.module}', output='screen', MORE)"
PATH = f"PathJoinSubstitution([FindPackageShare('{PACKAGE}'), 'config', 'more.yaml'])"
FILTER = f"Node(package='ekf', executable='ekf_node', name='filter', parameters=[{PATH}])"


def codes(files: Files, folder: Path, *wanted: str) -> list[str]:
    """Return the codes of the findings of a workspace, of those that are asked for."""
    return [finding.code for finding in of_workspace(files.write(folder)) if finding.code in wanted]


@pytest.mark.parametrize(
    ("section", "actions", "is_told"),
    [
        ("filter:\n  ros__parameters:\n    frequency: 30.0\n", "", False),
        ("filter:\n  ros__parameters:\n    period: 3.0\n", FILTER, False),
        ("filter:\n  ros__parameters:\n    period: 3\n", FILTER, False),
        ("robot:\n  wheels:\n    ros__parameters:\n      frequency: 30.0\n", "", False),
        ("filter:\n  ros__parameters:\n    period: 3.0\n", "", True),
        (f"{NAME.module}s:\n  ros__parameters:\n    frequency: 30.0\n", "", True),
        (f"{NAME.module}_01:\n  ros__parameters:\n    period: 3.0\n", "", False),
        ("voice:\n  ros__parameters:\n    period: 3.0\n", OWN.replace("MORE", "namespace='left'"), False),
    ],
)
def test_a_section_for_another_node(tmp_path: Path, section: str, actions: str, is_told: bool) -> None:
    files = Files.right(NAME)
    files.put("config/more.yaml", section)
    if actions:
        files.put("launch/more.launch.py", LAUNCH.replace("ACTIONS", actions))
    found = codes(files, tmp_path, "parameter-file-node", "parameter-type")
    assert found == ["parameter-file-node"] * is_told


def test_a_section_is_for_the_node_that_declares_its_parameters(tmp_path: Path) -> None:
    files = Files.right(NAME).put("config/more.yaml", "filter:\n  ros__parameters:\n    period: 3.0\n")
    (found,) = [f for f in of_workspace(files.write(tmp_path)) if f.code == "parameter-file-node"]
    assert found.fix == f"write {NAME.module} instead of filter"


CLOCK = "parameters=[{'use_sim_time': True}]"
ARGUMENT = "DeclareLaunchArgument('use_sim_time', default_value='VALUE')"
ASKED = CLOCK.replace("True", "LaunchConfiguration('use_sim_time')")


@pytest.mark.parametrize(
    ("actions", "is_told"),
    [
        (OWN.replace("MORE", CLOCK), True),
        (f"{OWN.replace('MORE', CLOCK)}, Node(package='ros_gz_bridge', executable='bridge')", False),
        (f"{ARGUMENT.replace('VALUE', 'true')}, {OWN.replace('MORE', ASKED)}", True),
        (f"{ARGUMENT.replace('VALUE', 'false')}, {OWN.replace('MORE', ASKED)}", False),
        (OWN.replace("MORE", ASKED.replace("time')", "time', default='true')")), True),
        (
            f"DeclareLaunchArgument('simulator'), LogInfo(msg=LaunchConfiguration('simulator')), {OWN.replace('MORE', CLOCK)}",
            False,
        ),
    ],
)
def test_a_clock_of_a_simulator(tmp_path: Path, actions: str, is_told: bool) -> None:
    files = Files.right(NAME)
    files.put("launch/more.launch.py", LAUNCH.replace("ACTIONS", actions))
    assert codes(files, tmp_path, "period") == ["period"] * is_told


@pytest.mark.parametrize("folder", ["plain", "2024", "week-2", "my ws"])
@pytest.mark.parametrize("name", ["helper", "helpers"])
def test_the_path_above_a_workspace_does_not_matter(tmp_path: Path, folder: str, name: str) -> None:
    files = Files.right(NAME)
    files.put(f"{PACKAGE}/__init__.py", "from .tools import *\n")
    files.put(f"{PACKAGE}/tools.py", "def helper(number):\n    return number\n")
    files.put(f"{PACKAGE}/use.py", f"import {PACKAGE}\n\nprint({PACKAGE}.{name}(1))\n")
    found = codes(files, tmp_path / folder, "attribute-missing", "attribute-unknown")
    assert len(found) == (name == "helpers")


@pytest.mark.parametrize(
    ("name", "wanted", "is_slip"),
    [
        ("uav2_pose", "uav1_pose", False),
        ("robot1/scan", "robot2/scan", False),
        ("report2", "report", True),
        ("uva1_pose", "uav1_pose", True),
        ("robot_localization", "localization", False),
    ],
)
def test_one_of_a_row_is_no_slip(name: str, wanted: str, is_slip: bool) -> None:
    assert is_near_miss(name, wanted) == is_slip


POINT = "'console_scripts': ["
OTHER = "from setuptools import setup\n\nsetup(name='shared', version='0.0.0', packages=['shared'])\n"
MAIN = "import rclpy\n\n\ndef main():\n    rclpy.init()\n    node = rclpy.create_node('talk')\n    rclpy.spin(node)\n"


@pytest.mark.parametrize(("module", "is_told"), [("shared.talk", False), ("shared.tolk", True)])
def test_an_entry_point_into_another_package(tmp_path: Path, module: str, is_told: bool) -> None:
    files = Files.right(NAME).change("setup.py", POINT, f"{POINT}'more = {module}:main',")
    root = files.write(tmp_path)
    for path, text in {"setup.py": OTHER, "shared/__init__.py": "", "shared/talk.py": MAIN}.items():
        (root / "src/shared" / path).parent.mkdir(parents=True, exist_ok=True)
        (root / "src/shared" / path).write_text(text, encoding="utf-8")
    found = [f for f in of_workspace(root) if f.code in ("entry-point-module", "entry-points-missing")]
    assert any(f.code == "entry-point-module" for f in found) == is_told
    assert is_told or not found
    assert all(f"src/{PACKAGE}shared" not in f.fix for f in found)


def test_a_module_may_be_called_after_a_launch(tmp_path: Path) -> None:
    files = Files.right(NAME).change("setup.py", POINT, f"{POINT}'rocket = {PACKAGE}.rocket_launch:main',")
    files.put(
        f"{PACKAGE}/rocket_launch.py",
        MAIN.replace("import rclpy", "import rclpy\nfrom rclpy.node import Node"),
    )
    assert codes(files, tmp_path, "import-wrong", "launch-function", "not-in-data-files") == []


@pytest.mark.parametrize(
    ("manifest", "is_told"),
    [("<buildtool_depend>catkin</buildtool_depend>", False), ("<export><build_type>ament_cmake</build_type></export>", True)],
)  # fmt: skip
def test_a_package_of_ros_1_may_be_data(tmp_path: Path, manifest: str, is_told: bool) -> None:
    about = "<name>arm</name><version>1.0.0</version><description>x</description><maintainer email='a@b.cc'>a</maintainer><license>BSD</license>"
    files = Files.right(NAME).put(
        "models/arm/package.xml", f"<package format='3'>{about}{manifest}</package>"
    )
    assert codes(files, tmp_path, "package-passed-over") == ["package-passed-over"] * is_told


def test_a_program_of_its_own_needs_no_node(tmp_path: Path) -> None:
    files = Files.right(NAME).change("setup.py", POINT, f"{POINT}'sum = {PACKAGE}.{NAME.module}:add',")
    files.put(
        files.path("node"),
        f"{files.filled(files.texts[files.path('node')])}\n\ndef add():\n    print(1 + 1)\n",
    )
    assert codes(files, tmp_path, "never-made") == []


MOVES = "    def connect(self, frame_id, parent_frame_id):\n        print(frame_id, parent_frame_id)\n\n    def more(self, found, parent_frame_id, frame_id):\n        self.connect(CALL)\n"


@pytest.mark.parametrize(
    ("call", "is_told"),
    [
        ("'tool', found.frame_id", False),
        ("found.parent_frame_id, found.frame_id", True),
        ("parent_frame_id, frame_id", True),
    ],
)
def test_a_field_of_another_object_is_not_a_name_here(tmp_path: Path, call: str, is_told: bool) -> None:
    text = f"class Mover:\n{MOVES.replace('CALL', call)}"
    found = [*argument_name_faults(sources_of(text, tmp_path))]
    assert [finding.code for finding in found] == ["argument-order"] * is_told


TURN = "def turn(angle, rotation_angle):\n    print(angle, rotation_angle)\n\n\ndef more(angle, speed):\n    turn(CALL)\n"


@pytest.mark.parametrize(
    ("call", "is_told"),
    [
        ("-1 * angle * 3, angle", False),
        ("0.5 * speed, angle", False),  # `angle` is a word of rotation_angle
        ("rotation_angle(speed), angle", False),
        ("speed, angle", False),
        ("rotation_angle, angle", True),
    ],
)
def test_what_is_made_of_a_value_is_not_swapped_with_it(tmp_path: Path, call: str, is_told: bool) -> None:
    found = [*argument_name_faults(sources_of(TURN.replace("CALL", call), tmp_path))]
    assert [finding.code for finding in found] == ["argument-order"] * is_told


KEYS = """
class Keys:
    def __init__(self):
        self.speed = 0.5
        self.turns = 0

    def pressed(self, key):
        linear = 0.0
        OTHER
        CHANGE
        return linear
"""
IF = "if key == 'w':\n            linear = 0.4\n        elif key == 's':\n            linear =- 0.2"
MATCH = "match key:\n            case 'w':\n                linear = 0.4\n            case _:\n                linear =- 0.2"


@pytest.mark.parametrize(
    ("other", "change", "is_told"),
    [
        ("", IF, False),
        ("", MATCH, False),
        ("linear = self.speed", "if key == 's':\n            linear =- self.speed", False),
        ("", "if key == 's':\n            linear =- 0.2", False),  # it begins anew each time
        ("", "if key == 'r':\n            self.speed =- self.speed", False),
        ("", "for letter in key:\n            linear =+ 0.2", True),
        ("", "self.turns =+ 1", True),
        ("if key == 'w':\n            linear = 0.4", "self.turns =+ 1", True),
    ],
)
def test_a_sign_of_a_value_may_stand_by_itself(
    tmp_path: Path, other: str, change: str, is_told: bool
) -> None:
    text = KEYS.replace("OTHER", other or "print(key)").replace("CHANGE", change)
    found = [*expression_faults(sources_of(text, tmp_path))]
    assert [finding.code for finding in found] == ["no-effect"] * is_told


@pytest.mark.parametrize("folder", ["a_copy", "z_copy"])
@pytest.mark.parametrize(("executable", "is_told"), [(NAME.module, False), ("driver", True)])
def test_an_executable_of_a_package_that_is_there_twice(
    tmp_path: Path, folder: str, executable: str, is_told: bool
) -> None:
    files = Files.right(NAME)
    files.put(
        "launch/more.launch.py",
        LAUNCH.replace("ACTIONS", OWN.replace(NAME.module, executable).replace(", MORE", "")),
    )
    root = files.write(tmp_path)
    copy = root / "src" / folder
    shutil.copytree(root / "src" / PACKAGE, copy)
    shutil.rmtree(copy / "launch")
    setup = (copy / "setup.py").read_text(encoding="utf-8")
    (copy / "setup.py").write_text(setup.replace(f"'{NAME.module} = ", "'older = "), encoding="utf-8")
    found = [finding.code for finding in of_workspace(root) if finding.code == "launch-executable"]
    assert found == ["launch-executable"] * is_told


COUNTED = """
def near(x0, y0, r0, x1, y1, r1):
    return x0, y0, r0, x1, y1, r1


def pair(left1, left2):
    return left1, left2


def clip(speed, limit):
    return min(speed, limit)


def more(found, x1, y1, x2, y2, r1, r2, left2, left3, limit, speed):
    CALL
"""


@pytest.mark.parametrize(
    ("call", "is_told"),
    [
        ("near(found.x, found.y, r1, x2, y2, r2)", False),
        ("near(x1, y1, r1, x2, y2, r2)", False),
        ("pair(left2, left3)", False),
        ("pair(left2, 0)", False),
        ("clip(limit, 2 * limit)", False),
        ("clip(limit, found)", False),
        ("clip(limit, speed)", True),
        ("pair(left2, left1)", True),
    ],
)
def test_names_that_are_counted_from_another_number_are_not_swapped(
    tmp_path: Path, call: str, is_told: bool
) -> None:
    found = [*argument_name_faults(sources_of(COUNTED.replace("CALL", call), tmp_path))]
    assert [finding.code for finding in found] == ["argument-order"] * is_told


NESTED = "filter:\n  ros__parameters:\n    corners: [[1, 2], [3, 4]]\n"
READER = "import yaml\n\n\ndef read():\n    return yaml.safe_load(open('config/more.yaml'))\n"
OTHER_READER = READER.replace("more", "other")
SHARE = "get_package_share_directory('PACKAGE')"
JOINED = f"os.path.join({SHARE}, 'config', 'more.yaml', {SHARE}, 'config', 'robot.yaml')"
GIVEN = f"os.path.join({SHARE}, 'config', 'more.yaml')"
JOINING = LAUNCH.replace(
    "from launch import",
    "import os\nfrom ament_index_python.packages import get_package_share_directory\nfrom launch import",
)


@pytest.mark.parametrize(
    ("reader", "given", "is_told"),
    [
        ("", GIVEN, True),
        ("", "", True),
        (READER, "", False),
        (OTHER_READER, "", True),
        (READER.replace("yaml.safe_load(open", "print((").replace("import yaml", ""), "", True),
        (READER.replace("import yaml", "from yaml import safe_load").replace("yaml.safe", "safe"), "", False),
        (READER, JOINED, False),
        (READER, GIVEN, True),
        (READER, f"PathJoinSubstitution([FindPackageShare('{PACKAGE}'), 'config', 'more.yaml'])", True),
    ],
)
def test_a_file_that_only_programs_read_is_any_yaml(
    tmp_path: Path, reader: str, given: str, is_told: bool
) -> None:
    files = Files.right(NAME).put("config/more.yaml", NESTED).put("PACKAGE/read.py", reader)
    if given:
        files.put(
            "launch/more.launch.py", JOINING.replace("ACTIONS", OWN.replace("MORE", f"parameters=[{given}]"))
        )
    found = [f for f in of_workspace(files.write(tmp_path)) if f.code == "parameter-file-syntax"]
    assert len(found) == is_told
    assert all(("read.py reads the file, too" in f.fix) == (reader == READER) for f in found)


GOAL = """\
from rclpy.action import CancelResponse
from std_msgs.msg import String

SPEED = 2.0


class Robot:
    def ask(self, goal_handle):
        LINE
"""


@pytest.mark.parametrize(
    ("line", "is_told"),
    [
        ("return CancelResonse.ACCEPT", False),
        ("return GoalResponse.ACCEPT", False),
        ("self.pub.publish(Sting(data='on'))", False),
        ("return SPED * 2", False),
        ("step = 1.0; return stpe", False),
        ("return msg.data", True),
        ("print(request.order)", True),
    ],
)
def test_a_name_with_a_better_reading_is_no_parameter(tmp_path: Path, line: str, is_told: bool) -> None:
    sources = sources_of(GOAL.replace("LINE", line), tmp_path)
    assert len([*lost_parameters(sources)]) == is_told


PRINTS = "def main():\n    print('on', flush=True)\n"


@pytest.mark.parametrize(
    ("more", "is_told"),
    [
        ("", True),
        ("prefix='xterm -e'", False),
        ("prefix=['gnome-terminal', ' --']", False),
        ("prefix=LaunchConfiguration('device')", False),
        ("output='screen'", False),
        ("arguments=['--prefix']", True),
        ("prefix=''", True),
    ],
)
def test_what_another_program_starts_may_print_elsewhere(tmp_path: Path, more: str, is_told: bool) -> None:
    files = Files.right(NAME).change("setup.py", POINT, f"{POINT}'shout = {PACKAGE}.shout:main',")
    files.put(f"{PACKAGE}/shout.py", PRINTS)
    actions = f"DeclareLaunchArgument('device', default_value='nice'), Node(package='{PACKAGE}', executable='shout', {more})"
    files.put("launch/more.launch.py", LAUNCH.replace("ACTIONS", actions))
    assert codes(files, tmp_path, "never-shown") == ["never-shown"] * is_told


ASKS = "from my_bot import Helper\n\n\ndef main():\n    Helper()\n"
RUN = "\n\nif __name__ == '__main__':\n    main()\n"


@pytest.mark.parametrize(
    ("path", "text", "others", "fix"),
    [
        ("PACKAGE/by_hand.py", ASKS + RUN, {}, ""),
        ("PACKAGE/test_by_hand.py", ASKS + RUN, {}, ""),
        ("PACKAGE/by_hand.py", ASKS, {}, "write `from my_bot.my_bot import Helper`"),
        ("PACKAGE/listed.py", ASKS + RUN, {}, "write `from my_bot.my_bot import Helper`"),
        ("PACKAGE/by_hand.py", ASKS + RUN, {"PACKAGE/__init__.py": "from .my_bot import Helper\n"}, ""),
        ("PACKAGE/by_hand.py", ASKS.replace("Helper", "Nobody") + RUN, {}, "remove Nobody here, with what uses it on line 5, or define it in my_bot"),
        ("PACKAGE/inner/by_hand.py", ASKS + RUN, {"PACKAGE/inner/__init__.py": ""}, "write `from my_bot.my_bot import Helper`"),
        ("PACKAGE/by_hand.py", ASKS.replace("Helper", "Other"), {"PACKAGE/kept.py": "class Other: ...\n"}, "write `from my_bot.kept import Other`"),
    ],
)  # fmt: skip
def test_a_script_finds_the_file_beside_it_before_its_package(
    tmp_path: Path, path: str, text: str, others: dict[str, str], fix: str
) -> None:
    files = Files.right(NAME).change("setup.py", POINT, f"{POINT}'listed = {PACKAGE}.listed:main',")
    files.put("PACKAGE/listed.py", "def main(): ...\n").put("PACKAGE/my_bot.py", "class Helper: ...\n")
    for name, given in {**others, path: text}.items():
        files.put(name, given)
    found = [f.fix for f in of_workspace(files.write(tmp_path)) if f.code == "import-wrong"]
    assert found == [fix] * bool(fix)


TICK = "        self.count += 1\n"
INNER = {
    "a handler": ("class Handler(BaseHTTPRequestHandler):\n    def do_GET(self):\n        self.send_response(200)", ""),
    "a thread": ("class Worker(threading.Thread):\n    def run(self):\n        print(self.ident)", ""),
    "one of a base of the file": ("class Inner(Base):\n    def go(self):\n        return self.reply()", ""),
    "two levels": ("def made():\n    class Handler(BaseHTTPRequestHandler):\n        def do_GET(self):\n            return self.path\n    return Handler", ""),
    "a function that becomes a method": ("def reply(self):\n    return self.path\nkind = type('H', (BaseHTTPRequestHandler,), {'do_GET': reply})", ""),
    "the node's self": ("def later():\n    return self.nothing", "nothing"),
    "the node's self in a lambda": ("later = lambda: self.nothing", "nothing"),
    "the node beside a handler": ("class Handler(BaseHTTPRequestHandler):\n    def do_GET(self):\n        return self.path\nself.nothing()", "nothing"),
}  # fmt: skip


@pytest.mark.parametrize("name", INNER)
def test_the_self_of_an_inner_class_is_another(tmp_path: Path, name: str) -> None:
    inner, lacks = INNER[name]
    files = Files.right(NAME).change("node", TICK, TICK + textwrap.indent(inner, " " * 8) + "\n")
    head = "import threading\nfrom http.server import BaseHTTPRequestHandler\n\nimport rclpy\n"
    base = "class Base:\n    def reply(self):\n        return 1\n\n\nclass CLASS("
    files.change("node", "import rclpy\n", head).change("node", "class CLASS(", base)
    found = [f.cause for f in of_workspace(files.write(tmp_path)) if f.code == "attribute-missing"]
    assert [lacks in cause for cause in found] == [True] * bool(lacks), found


@pytest.mark.parametrize("where", ["class State(Enum):\n        def label(self):\n            return self.value", "class Deep(threading.Thread):\n        def run(self):\n            return self.ident"])  # fmt: skip
def test_the_self_of_a_class_in_the_body_is_another(tmp_path: Path, where: str) -> None:
    files = Files.right(NAME).change("node", "(Node):\n", f"(Node):\n    {where}\n\n")
    files.change("node", "import rclpy\n", "import threading\nfrom enum import Enum\n\nimport rclpy\n")
    assert codes(files, tmp_path, "attribute-missing") == []
