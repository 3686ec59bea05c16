"""The exercises of `09_troubleshooting`, and the robots that come to its clinic."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from ros2lab import course
from ros2lab.checks import CheckError, Question, exercise, graded, quiz_of
from ros2lab.checks.programs import overlay_of
from ros2lab.node_process import last_line
from ros2lab.observed_domain import ObservedDomain
from ros2lab.workspace import Workspace, WorkspaceError

CLINIC, WARD = "~/clinic_ws", "~/ward_ws"
HEALTHY = "patrol"
TWIST = "geometry_msgs/msg/Twist"
START_TIMEOUT = 30.0  # s, for a program to import ROS and speak on a busy machine
PATIENCE = 5.0  # s, for the messages of a publisher that is there
STOP_TIMEOUT = 2.0  # s
SAID_NOTHING = "it ended, and said nothing"

# The files of a healthy package, with its name.
ROBOT = {
    "package.xml": """\
<?xml version="1.0"?>
<package format="3">
  <name>patrol</name>
  <version>0.1.0</version>
  <description>Drives a little, and watches whether it does.</description>
  <maintainer email="ada@example.org">Ada Lovelace</maintainer>
  <license>MIT</license>
  <depend>rclpy</depend>
  <depend>geometry_msgs</depend>
  <exec_depend>launch_ros</exec_depend>
  <export>
    <build_type>ament_python</build_type>
  </export>
</package>
""",
    "setup.cfg": """\
[develop]
script_dir=$base/lib/patrol
[install]
install_scripts=$base/lib/patrol
""",
    "setup.py": """\
from glob import glob

from setuptools import find_packages, setup

setup(
    name="patrol",
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/patrol"]),
        ("share/patrol", ["package.xml"]),
        ("share/patrol/launch", glob("launch/*")),
        ("share/patrol/config", glob("config/*")),
    ],
    entry_points={"console_scripts": [
        "driver = patrol.driver:main",
        "watcher = patrol.watcher:main",
    ]},
)
""",
    "resource/patrol": "",
    "patrol/__init__.py": "",
    "patrol/driver.py": """\
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.speed = self.declare_parameter("speed", 0.5).value
        self.times = self.declare_parameter("times", 2).value
        self.publisher = self.create_publisher(Twist, "cmd_vel", 10)
        self.timer = self.create_timer(0.1, self.drive)

    def drive(self):
        twist = Twist()
        twist.linear.x = self.speed
        self.publisher.publish(twist)
        self.get_logger().info(f"I drive at {twist.linear.x:.1f} m/s.")
        self.times -= 1
        if self.times == 0:
            raise SystemExit


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Driver())
""",
    "patrol/watcher.py": """\
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Watcher(Node):
    def __init__(self):
        super().__init__("watcher")
        self.subscription = self.create_subscription(Twist, "cmd_vel", self.see, 10)
        self.get_logger().info("I watch.")

    def see(self, twist):
        self.get_logger().info(f"I see {twist.linear.x:.1f} m/s.")
        raise SystemExit


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Watcher())
""",
    "launch/patrol.launch.py": """\
from launch import LaunchDescription
from launch.substitutions import PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    config = PathJoinSubstitution([FindPackageShare("patrol"), "config", "speed.yaml"])
    driver = Node(package="patrol", executable="driver", parameters=[config], output="screen")
    return LaunchDescription([driver])
""",
    "config/speed.yaml": """\
driver:
  ros__parameters:
    speed: 0.8
""",
}


class Change(NamedTuple):
    """What is changed in a healthy package: in a file, one text for another; an empty `old` removes the file."""

    file: str
    old: str = ""
    new: str = ""


# What is wrong with the patients of the exercises, and how the two that look alike differ.
PATIENTS = {
    "owl": (Change("setup.py", "from glob import glob\n\n"), Change("resource/owl")),
    "kite": (
        Change("setup.py", "kite.driver:main", "kite.driver:mian"),
        Change("kite/driver.py", "self.drive)", "self.drive())"),
    ),
    "crow": (
        Change("setup.py", '        ("share/crow/launch", glob("launch/*")),\n'),
        Change("config/speed.yaml", "driver:", "drive:"),
    ),
    "magpie": (
        Change("magpie/driver.py", '__init__("driver")', '__init__("magpie")'),
        Change("config/speed.yaml", "driver:", "magpie:"),
    ),
    "jackdaw": (
        Change("jackdaw/driver.py", '__init__("driver")', '__init__("jackdaw")'),
        Change("config/speed.yaml", "driver:", "jackdaw:"),
        Change("jackdaw/driver.py", '"cmd_vel", 10', '"cmd_vel", qos_profile_sensor_data'),
        Change(
            "jackdaw/driver.py",
            "import Node\n",
            "import Node\nfrom rclpy.qos import qos_profile_sensor_data\n",
        ),
    ),
}
SILENT, SILENT_CAUSE = "jackdaw", "c"

CAUSES = (
    Question(
        "b",
        "`0.1.self` asks the number 0.1 for something named self: the dot should be a comma.",
        {
            "a": "the last line speaks of a float; which float stands in your line?",
            "c": "a timer takes a period with a point. Read your line sign by sign.",
        },
    ),
    Question(
        "c",
        "publish takes a message, and was given the number.",
        {
            "a": "the last line says what publish expected, and that type is the right one.",
            "b": "a float is what a speed should be; but is it what publish should get?",
        },
    ),
    Question(
        "a",
        "2 is a whole number, and the parameter was declared with 0.5; write 2.0.",
        {
            "b": "the node has found it: the line of yours in the traceback is the one that declares it.",
            "c": "your line is right. Who gave the value?",
        },
    ),
)

WRONG_CAUSES = {
    "a": "compare the topics of both in `ros2 topic list`: how many are there?",
    "b": "`ros2 topic info /cmd_vel` names the type; is there more than one?",
    "d": "look at how fast its log lines come, and at those of the other one.",
}

QUIZ = (
    Question(
        "c",
        "The last line names the error; what stands above tells the way there.",
        {
            "a": "in Python the first line is always the same.",
            "b": "that is the second step: first know what is wrong, then where.",
        },
    ),
    Question(
        "b",
        "What runs is in install/, and it is as old as the last build.",
        {
            "a": "a node that was started is loaded already, but this one was started anew.",
            "c": "a terminal that was not sourced would not find the package at all.",
        },
    ),
    Question(
        "a",
        "Names, types and quality of service of both ends stand in the graph, and nowhere else together.",
        {
            "b": "colcon builds packages, and never asks whether two nodes will meet.",
            "c": "no error was raised, so there is none to read.",
        },
    ),
    Question(
        "b",
        "After one change you know what it did; after three you know nothing about any of them.",
        {
            "a": "how long did a build of one package take?",
            "c": "colcon does not know how many lines you have changed.",
        },
    ),
)


@exercise
def causes(*letters: str) -> str:
    """Check the letters of the causes of the three errors that are read alone.

    Raises:
        CheckError: at the first that is not right.
    """
    return graded(CAUSES, letters)


@exercise
def owl() -> str:
    """Check that `owl` can be built, and drives.

    Raises:
        CheckError: if it does not.
    """
    workspace = _built(
        "owl",
        "build it in a terminal: of all that colcon says, which line speaks of a file of yours?",
        "in src/owl, `python3 setup.py --name` shows the first fault without colcon; mend it, and build for the next.",
        "a name must be imported before it is used, and an empty file has got lost in resource/.",
    )
    _check_drives(
        workspace, "owl", "run it in a sourced terminal: `ros2 run owl driver`, and read the last line."
    )
    return "Right: the owl is built, and it drives."


@exercise
def kite() -> str:
    """Check that `kite` runs, and drives.

    Raises:
        CheckError: if it does not.
    """
    workspace = _built("kite", "build it in a terminal, and read the first error.")
    _check_drives(
        workspace,
        "kite",
        "run it: `ros2 run kite driver`. The last line first; then the first line that is yours.",
        "there are two faults, and the second one shows when the first is mended: build, and run again.",
        "the function's name in setup.py; and what create_timer is given.",
    )
    return "Right: the kite's timer calls again and again, and it drives."


@exercise
def crow() -> str:
    """Check that the launch file of `crow` starts it, with the speed of its parameter file.

    Raises:
        CheckError: if it does not.
    """
    workspace = _built("crow", "build it in a terminal, and read the first error.")
    hints = (
        "launch it: `ros2 launch crow crow.launch.py`. Is the file where launch looks for it?",
        "only what data_files of setup.py names is installed, and only by a build.",
        "in the parameter file, values stand under the name of the node: `ros2 node list`, or super().__init__.",
    )
    expected = "`ros2 launch crow crow.launch.py` lets it drive at 0.8 m/s"
    with ObservedDomain() as domain:
        command = ["ros2", "launch", "crow", "crow.launch.py"]
        program = domain.start("crow", command, overlay_of(workspace))
        domain.wait(
            lambda: not program.is_running or re.search(r"drive at \S+ m/s", program.output), START_TIMEOUT
        )
        program.stop(STOP_TIMEOUT)
        speed = re.search(r"drive at (\S+) m/s", program.output)
    if speed is None:
        raise CheckError(expected, last_line(program.output) or SAID_NOTHING, *hints)
    if float(speed[1]) != 0.8:
        raise CheckError(expected, f"it drives at {speed[1]} m/s", hints[-1])
    return "Right: the crow's launch file is found, and so are its parameters."


@exercise
def silent_one(*answer: str) -> str:
    """Check which of the two robots that look alike nobody hears, and why.

    Args:
        answer: the package's name and the letter of the cause.

    Raises:
        CheckError: if one of them is not right.
    """
    words = [str(word).strip().lower() for word in answer]
    if len(words) != 2:
        raise CheckError(
            "a package and a letter",
            f"{len(words)} answers",
            'name both, such as check.silent_one("magpie", "a").',
        )
    package, letter = words
    if package != SILENT:
        raise CheckError(
            "the robot that the watcher does not hear",
            repr(package),
            "start one of them alone: does the watcher end?",
            "stop it, start the other one, and ask the same.",
        )
    if letter != SILENT_CAUSE:
        hint = WRONG_CAUSES.get(letter, "the letters are a, b, c, d.")
        raise CheckError(f"why {package} is not heard", repr(letter), hint)
    return "Right: it offers best effort, the watcher asks for reliable, and so they never meet."


quiz = quiz_of(__name__, QUIZ)


def make_healthy_robot() -> str:
    """Make the workspace of the clinic with the package `patrol` in it.

    Raises:
        OSError: if a file cannot be written.
    """
    return _admitted(CLINIC, {HEALTHY: ()})


def admit(*names: str) -> str:
    """Make copies of the healthy package in the clinic's workspace, each with a name of its own.

    Raises:
        OSError: if a file cannot be written.
    """
    return _admitted(CLINIC, dict.fromkeys(names, ()))


def make_patients() -> str:
    """Make the workspace of the exercises; a package that is there already stays as it is.

    Raises:
        OSError: if a file cannot be written.
    """
    return _admitted(WARD, PATIENTS)


def _admitted(workspace: str, robots: Mapping[str, Sequence[Change]]) -> str:
    src = course.student_path(workspace) / "src"
    for name, changes in robots.items():
        if not (src / name).exists():
            _write_robot(src / name, changes)
    return f"{course.shown_path(src)}: {', '.join(robots)}"


def _write_robot(folder: Path, changes: Sequence[Change]) -> None:
    """Write a package that is called like its folder."""
    files = {
        path.replace(HEALTHY, folder.name): text.replace(HEALTHY, folder.name) for path, text in ROBOT.items()
    }
    lost = [change.file for change in changes if not change.old]
    for change in changes:
        if change.old:
            files[change.file] = files[change.file].replace(change.old, change.new)
    for path, text in files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        if path not in lost:
            (folder / path).write_text(text, encoding="utf-8")


def _built(package: str, *hints: str) -> Workspace:
    """Build a package of the ward, and return the workspace."""
    expected = f"`colcon build --packages-select {package}` in {WARD} succeeds"
    workspace = Workspace(course.student_path(WARD))
    try:
        result = workspace.build(package, show=False)
    except WorkspaceError as error:
        raise CheckError(
            expected, str(error), "the cell with make_patients() makes what is missing."
        ) from error
    if not result.is_ok:
        raise CheckError(expected, str(result.first_error), *hints)
    return workspace


def _check_drives(workspace: Workspace, package: str, *hints: str) -> None:
    """Check that `ros2 run` starts a driver that is heard on /cmd_vel."""
    expected = f"`ros2 run {package} driver` runs, and /cmd_vel has a Twist with 0.5 m/s"
    with ObservedDomain() as domain:
        log = domain.log("/cmd_vel", TWIST)
        command = ["ros2", "run", package, "driver", "--ros-args", "-p", "times:=0"]
        program = domain.start(package, command, overlay_of(workspace))
        domain.wait(
            lambda: log.count >= 2 or not program.is_running or domain.published().keys() - {"/cmd_vel"},
            START_TIMEOUT,
        )
        domain.wait(lambda: log.count >= 2 or not program.is_running, PATIENCE)
        is_running, topics = program.is_running, ", ".join(domain.published())
        program.stop(STOP_TIMEOUT)
    speeds = [sample.message.linear.x for sample in log.samples()]
    if speeds and speeds[-1] != 0.5:
        raise CheckError(expected, f"{speeds[-1]:g} m/s", "only the fault is to be mended.")
    if len(speeds) < 2:
        silence = f"it runs, and publishes on {topics or 'no topic'}"
        raise CheckError(
            expected, silence if is_running else last_line(program.output) or SAID_NOTHING, *hints
        )
