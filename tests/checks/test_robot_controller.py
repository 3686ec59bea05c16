"""The checks of `07_robot_controller`: nodes in many styles are accepted, and faults of many kinds are named."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from ros2lab import course, environment
from ros2lab.checks import CheckError, robot_controller
from ros2lab.node_process import NodeProcess
from ros2lab.workspace import Workspace

RUN = """
def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(make())
    except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
        pass
"""
HEAD = """
import threading, time
import rclpy, rclpy.executors
from rclpy.node import Node
from geometry_msgs.msg import Twist
from std_msgs.msg import String, Int32
from rclpy.qos import QoSProfile, DurabilityPolicy
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
"""

STATUS = """
class AnyName(Node):
    def __init__(self):
        super().__init__("reporter")
        self.words = self.create_publisher(String, "/robot/status", 10)
        self.create_timer(2.0, self.tell)
    def tell(self):
        self.words.publish(String(data="fine"))
make = AnyName
"""
STATUS_WITHOUT_A_CLASS = """
def make():
    node = rclpy.create_node("reporter", namespace="/robot")
    words = node.create_publisher(String, "status", 1)
    message = String(data="all is well")
    node.create_timer(2.0, lambda: words.publish(message))
    return node
"""
STATUS_THAT_SLEEPS = """
def main():
    rclpy.init()
    node = rclpy.create_node("sleeper")
    words = node.create_publisher(String, "/robot/status", 10)
    try:
        while rclpy.ok():
            words.publish(String(data="awake"))
            time.sleep(2.0)
    except KeyboardInterrupt:
        pass
"""
STATUS_WITH_A_RATE = """
def main():
    rclpy.init()
    node = rclpy.create_node("rated")
    words = node.create_publisher(String, "/robot/status", 10)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    rate = node.create_rate(0.5)
    while rclpy.ok():
        words.publish(String(data="awake"))
        rate.sleep()
"""
COMMANDS = """
class AnyName(Node):
    def __init__(self):
        super().__init__("ears")
        self.words = self.create_publisher(String, "/robot/state", LATCHED)
        self.create_subscription(String, "/robot/command", self.obey, 10)
    def obey(self, message):
        after = {"start": "running", "stop": "stopped", "reset": "idle"}.get(message.data)
        self.get_logger().info(f"I have heard: {message.data}")
        if after:
            self.words.publish(String(data=after))
make = AnyName
"""
COMMANDS_WITHOUT_A_CLASS = """
def make():
    node = rclpy.create_node("ears")
    words = node.create_publisher(String, "/robot/state", 10)
    state = ["idle"]
    def obey(message):
        if message.data == "start":
            state[0] = "running"
            node.get_logger().warning("START! Los geht's")
        elif message.data == "stop":
            state[0] = "stopped"
            node.get_logger().info("STOP! Halt")
        elif message.data == "reset":
            state[0] = "idle"
            node.get_logger().info("RESET! Von vorn")
        else:
            node.get_logger().error("Was?")
    node.create_subscription(String, "/robot/command", obey, LATCHED)
    node.create_timer(0.1, lambda: words.publish(String(data=state[0])))
    return node
"""
VELOCITY = """
class AnyName(Node):
    def __init__(self):
        super().__init__("wheels")
        self.state = "idle"
        self.velocity = self.create_publisher(Twist, "/cmd_vel", 10)
        self.create_subscription(String, "/robot/state", self.hear, 10)
        self.create_timer(0.2, self.drive)
    def hear(self, message):
        self.state = message.data
    def drive(self):
        twist = Twist()
        twist.linear.x = 0.3 if self.state == "running" else 0.0
        self.velocity.publish(twist)
make = AnyName
"""
VELOCITY_FROM_COMMANDS = """
def make():
    node = rclpy.create_node("wheels")
    speed = [0.0]
    velocity = node.create_publisher(Twist, "/cmd_vel", 10)
    def drive():
        twist = Twist()
        twist.angular.z = speed[0]
        velocity.publish(twist)
    def obey(message):
        speed[0] = -1.0 if message.data == "start" else 0.0
    node.create_subscription(String, "/robot/command", obey, 10)
    node.create_timer(0.05, drive)
    return node
"""
VELOCITY_IN_A_THREAD = """
def main():
    rclpy.init()
    node = rclpy.create_node("wheels")
    speed = [0.0]
    node.create_subscription(
        String, "/robot/state", lambda m: speed.__setitem__(0, 0.5 * (m.data == "running")), LATCHED)
    velocity = node.create_publisher(Twist, "/cmd_vel", 10)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    while rclpy.ok():
        twist = Twist()
        twist.linear.x = speed[0]
        velocity.publish(twist)
        time.sleep(0.1)
"""


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A student's package with its inner folder, and nothing in it."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path / "my work"))
    inner = course.student_path(f"{robot_controller.WORKSPACE}/src/robot_controller/robot_controller")
    inner.mkdir(parents=True)
    (inner / "__init__.py").touch()
    return inner.parent


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A built copy of the reference workspace, in a folder that may be copied, not changed."""
    folder = tmp_path_factory.mktemp("reference")
    workspace = Workspace(course.copy_reference(folder))
    assert workspace.build(show=False).is_ok
    return workspace.path


@pytest.fixture
def built(reference: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The student's folder with the built reference, which a test may change."""
    workspace = reference
    kept = reference.with_name("kept")
    shutil.copytree(reference, kept, symlinks=True)  # what is built knows the path at which it was built
    monkeypatch.setenv("ROS2LAB_WORK", str(reference.parent))
    yield workspace
    shutil.rmtree(reference)
    kept.rename(reference)


def write(package: Path, module: str, text: str) -> None:
    source = HEAD + text + ("" if "def main" in text else RUN)
    (package / "robot_controller" / f"{module}.py").write_text(source)


def edit(file: Path, old: str, new: str) -> None:
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))


@pytest.mark.parametrize(
    "options",
    [
        ["--dependencies", "rclpy", "std_msgs", "geometry_msgs"],
        ["--dependencies", "geometry_msgs", "std_msgs", "sensor_msgs", "rclpy", "--license", "MIT"],
        ["--dependencies", "rclpy", "std_msgs", "geometry_msgs", "--node-name", "status_publisher"],
    ],
)
def test_a_right_package(package: Path, options: list[str]) -> None:
    """Made by `ros2 pkg create` with any further options."""
    create(package, "--build-type", "ament_python", *options)
    assert robot_controller.package().startswith("Right")


def test_tags_for_build_and_run_are_dependencies_too(package: Path) -> None:
    """They need not be <depend>."""
    create(package, "--build-type", "ament_python", "--dependencies", "rclpy", "std_msgs", "geometry_msgs")
    edit(package / "package.xml", "<depend>rclpy</depend>", "<exec_depend>rclpy</exec_depend>")
    assert robot_controller.package().startswith("Right")


@pytest.mark.parametrize(
    ("file", "old", "new", "hint"),
    [
        ("package.xml", "<depend>geometry_msgs</depend>", "", "geometry_msgs not among them"),
        ("package.xml", "ament_python", "ament_cmake", "Found: ament_cmake"),
        ("package.xml", "<name>robot_controller", "<name>robot_control", "Found: robot_control"),
        ("package.xml", "</package>", "", "a valid package.xml"),
        ("setup.py", None, None, "the file setup.py"),
        ("robot_controller/__init__.py", None, None, "__init__.py"),
        ("package.xml", None, None, "no package.xml there"),
    ],
)
def test_a_wrong_package(package: Path, file: str, old: str | None, new: str | None, hint: str) -> None:
    """Each fault is named."""
    create(package, "--build-type", "ament_python", "--dependencies", "rclpy", "std_msgs", "geometry_msgs")
    if old is None or new is None:
        (package / file).unlink()
    else:
        edit(package / file, old, new)
    with pytest.raises(CheckError, match=hint):
        robot_controller.package()


@pytest.mark.parametrize(
    "text", [STATUS, STATUS_WITHOUT_A_CLASS, STATUS_THAT_SLEEPS, STATUS_WITH_A_RATE], ids=range(4)
)
def test_a_right_status_publisher(package: Path, text: str) -> None:
    """A class, a function, a loop that sleeps, a rate: what counts is what comes."""
    write(package, "status_publisher", text)
    assert robot_controller.status_publisher().startswith("Right")


@pytest.mark.parametrize(
    ("old", "new", "hint"),
    [
        ("2.0", "1.0", "Found: one every 1 s"),
        ("2.0", "4.0", "Found: one every 4 s"),
        ("2.0", "1.5", r"Found: one every 1\.5 s"),
        ("2.0", "2.5", r"Found: one every 2\.5 s"),
        ("2.0", "0.2", "Found: one every"),
        ("/robot/status", "/robot_status", "it publishes /robot_status.*letter by letter"),
        ("String", "Int32", r"Found: std_msgs/msg/Int32"),
        ("self.create_timer(2.0, self.tell)", "self.create_timer(2.0, self.tell())", "is not callable"),
        ("self.create_timer(2.0, self.tell)", "pass", "0 of them in 10 s"),
        ('data="fine"', 'data=""', "empty texts"),
        ("super()", "super().oops", "it ended"),
        ("class AnyName", "clas AnyName", "is Python. Found: line"),
        ("def main", "def mein", "has a function main"),
        ("rclpy.spin(make())", "make()", "it ended: it said nothing. Hint: .*spin"),
    ],
)
def test_a_wrong_status_publisher(package: Path, old: str, new: str, hint: str) -> None:
    """Period, topic, type, text, timer, spin: each fault is told apart."""
    source = HEAD + (STATUS + RUN).replace(old, new)
    (package / "robot_controller" / "status_publisher.py").write_text(source)
    with pytest.raises(CheckError, match=hint):
        robot_controller.status_publisher()


def test_no_status_publisher_at_all(package: Path) -> None:
    """The file that is looked for is named."""
    with pytest.raises(CheckError, match=r"the file ~/robot_project_ws/.*status_publisher\.py"):
        robot_controller.status_publisher()


@pytest.mark.parametrize(
    "text", [COMMANDS, COMMANDS_WITHOUT_A_CLASS, COMMANDS.replace("I have heard:", "Befehl")], ids=range(3)
)
def test_a_right_command_subscriber(package: Path, text: str) -> None:
    """Any log line that holds the word counts, and any way of publishing the state."""
    write(package, "command_subscriber", text)
    assert robot_controller.command_subscriber().startswith("Right")


@pytest.mark.parametrize(
    ("old", "new", "hint"),
    [
        ("self.get_logger().info(", "print(", "printed, but not logged"),
        ("self.get_logger().info(", "str(", "no log line"),
        ("/robot/command", "/robot/commands", "subscribes to /robot/commands"),
        ("running", "runing", "'running' on /robot/state after 'start'. Found: 'runing'"),
        (".get(message.data)", "[message.data]", "after the command 'dance'"),
        (".get(message.data)", ".get(message.data, message.data)", "'dance' on /robot/state"),
        (".get(message.data)", ".get(message.data, 'idle')", "'idle' on /robot/state"),
        (".get(message.data)", ".get(message.data, 'unknown')", "'unknown' on /robot/state"),
        ("{message.data}", "{message}", ""),
        ("self.obey, 10", "10, self.obey", "it ended"),
        ("/robot/state", "/robot/states", "publishes /robot/state"),
    ],
)
def test_a_wrong_command_subscriber(package: Path, old: str, new: str, hint: str) -> None:
    """What is not heard, not logged, not answered, or not survived is told apart."""
    write(package, "command_subscriber", COMMANDS)
    edit(package / "robot_controller" / "command_subscriber.py", old, new)
    if not hint:  # not a fault: the whole message holds the word, too
        assert robot_controller.command_subscriber().startswith("Right")
        return
    with pytest.raises(CheckError, match=hint):
        robot_controller.command_subscriber()


@pytest.mark.parametrize("text", [VELOCITY, VELOCITY_FROM_COMMANDS, VELOCITY_IN_A_THREAD], ids=range(3))
def test_a_right_velocity_publisher(package: Path, text: str) -> None:
    """It may listen to the state or to the commands, drive on or turn, by a timer or a thread."""
    write(package, "velocity_publisher", text)
    assert robot_controller.velocity_publisher().startswith("Right")


@pytest.mark.parametrize(
    ("old", "new", "hint"),
    [
        ("0.3 if", "0 if", r"float"),
        ("/cmd_vel", "/cmdvel", "it publishes /cmdvel"),
        ('== "running"', '== "start"', "not zero while the state is running"),
        ("else 0.0", "else 0.3", "zero after the state"),
        ("self.create_timer(0.2, self.drive)", "pass", "0 of them"),
        ("(0.2, self.drive)", "(0.2, self.drive, 3, 4, 5, 6, 7)", "it ended"),
        (
            "self.create_publisher(Twist",
            "self.create_publisher(String",
            "Found: std_msgs/msg/String|it ended",
        ),
    ],
)
def test_a_wrong_velocity_publisher(package: Path, old: str, new: str, hint: str) -> None:
    """An int in a float field, a wrong topic, a robot that never moves and one that never stops."""
    write(package, "velocity_publisher", VELOCITY)
    edit(package / "robot_controller" / "velocity_publisher.py", old, new)
    with pytest.raises(CheckError, match=hint):
        robot_controller.velocity_publisher()


@pytest.mark.parametrize(
    "check",
    [
        robot_controller.package,
        robot_controller.status_publisher,
        robot_controller.command_subscriber,
        robot_controller.velocity_publisher,
        robot_controller.executables,
        robot_controller.parameters,
        robot_controller.launch_file,
        robot_controller.configuration,
    ],
    ids=lambda check: check.__name__,
)
def test_the_reference_is_right(built: Path, check: Callable[[], str]) -> None:
    """The best answer passes every check of the files and of what was built."""
    assert check().startswith("Right")


def test_executables_that_are_missing_or_do_not_start(built: Path) -> None:
    """Not built, not named, not startable: each is said."""
    lib = built / "install" / "robot_controller" / "lib" / "robot_controller"
    script = lib / "status_publisher"
    kept = script.read_text()
    script.write_text(f"{kept.splitlines()[0]}\nimport no_such_module\n")
    with pytest.raises(CheckError, match=r"status_publisher runs until Ctrl-C.*no_such_module"):
        robot_controller.executables()
    script.write_text(f"{kept.splitlines()[0]}\n")
    with pytest.raises(CheckError, match="it said nothing"):
        robot_controller.executables()
    script.unlink()
    with pytest.raises(CheckError, match="Found: command_subscriber, velocity_publisher"):
        robot_controller.executables()
    shutil.rmtree(lib)
    with pytest.raises(CheckError, match="Found: none"):
        robot_controller.executables()
    shutil.rmtree(built / "install")
    with pytest.raises(CheckError, match=r"is built\. .*colcon build"):
        robot_controller.executables()


@pytest.mark.parametrize(
    ("text", "is_right"),
    [
        (STATUS.replace("2.0", "self.declare_parameter('every_ms', 2000).value / 1000"), True),
        (STATUS.replace("2.0", "1 / self.declare_parameter('rate', 0.5).value"), True),
        (STATUS.replace("2.0", "self.declare_parameter('seconds', 2.0).value"), True),
        (STATUS, False),
        (STATUS.replace("2.0", "2.0 + 0 * self.declare_parameter('period', 2.0).value"), False),
        (STATUS.replace("2.0", "float(self.declare_parameter('period', '2.0').value)"), False),
        (STATUS.replace("2.0", "self.get_parameter('period').value"), False),
    ],
    ids=range(7),
)
def test_parameters(package: Path, text: str, is_right: bool) -> None:
    """Seconds, milliseconds or a rate, of any name; one that changes nothing is none."""
    write(package, "status_publisher", text)
    write(
        package,
        "velocity_publisher",
        VELOCITY.replace("0.2", "self.declare_parameter('period', 0.1).value"),
    )
    if is_right:
        assert robot_controller.parameters().startswith("Right")
        return
    with pytest.raises(CheckError, match="status_publisher"):
        robot_controller.parameters()


def test_a_launch_file_that_is_not_installed_or_starts_too_little(built: Path) -> None:
    """Only what is installed counts, and all three nodes must be there."""
    file = (
        built / "install" / "robot_controller" / "share" / "robot_controller" / "launch" / "robot.launch.py"
    )
    edit(file, '        _node("velocity_publisher", *_given(context, "velocity_period")),\n', "")
    with pytest.raises(CheckError, match=r"publishes /cmd_vel"):
        robot_controller.launch_file()
    file.write_text("def generate_launch_description():\n    return None\n")
    with pytest.raises(CheckError, match=r"ended|publishes"):
        robot_controller.launch_file()
    file.unlink()
    with pytest.raises(CheckError, match=r"only launch/robot\.launch\.py in src/.*data_files"):
        robot_controller.launch_file()
    shutil.rmtree(built / "src" / "robot_controller" / "launch")
    with pytest.raises(CheckError, match="Found: none"):
        robot_controller.launch_file()


def test_a_configuration_that_does_not_hold(built: Path) -> None:
    """A wrong node, a wrong name, no levels, no YAML, and no file."""
    file = built / "install" / "robot_controller" / "share" / "robot_controller" / "config" / "robot.yaml"
    for text, hint in (
        ("wheels:\n  ros__parameters:\n    period: 1.0\n", "the node's name"),
        ("status_publisher:\n  ros__parameters:\n    perod: 1.0\n", "no such parameter"),
        ("status_publisher:\n  ros_parameters:\n    period: 1.0\n", "two underlines"),
        ("status_publisher: [\n", "blanks, not tabs"),
    ):
        file.write_text(text)
        with pytest.raises(CheckError, match=hint):
            robot_controller.configuration()
    file.unlink()
    with pytest.raises(CheckError, match=r"only config/robot\.yaml in src"):
        robot_controller.configuration()


PARAMETERS = """
{status}:
  ros__parameters:
    limits: {{speed: 0.5, turn: {{left: 1.0}}}}
    gains: [1.0, 0.25]
    counts: [1, 2]
    flags: [true, false]
    names: [a, b]
    small: 1e-3
{velocity}:
  ros__parameters:
    label: fast
"""
# With absolute topics, in a namespace, and with parameters of many types.
NODE = """
import sys, rclpy, rclpy.executors
from geometry_msgs.msg import Twist
from std_msgs.msg import String
rclpy.init(args=sys.argv)
node = rclpy.create_node("{name}")
for name, value in (("limits.speed", 0.1), ("limits.turn.left", 0.1), ("gains", [0.0]), ("counts", [0]),
                    ("flags", [True]), ("names", [""]), ("small", 0.1), ("label", "slow")):
    node.declare_parameter(name, value)
{{
    "command_subscriber": lambda: node.create_subscription(String, "/robot/command", print, 10),
    "status_publisher": lambda: node.create_publisher(String, "/robot/status", 10),
    "velocity_publisher": lambda: node.create_publisher(Twist, "/cmd_vel", 10),
}}["{name}"]()
try:
    rclpy.spin(node)
except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
    pass
"""
LAUNCH = """
from launch import LaunchDescription
from launch_ros.actions import Node

def generate_launch_description():
    return LaunchDescription([
        Node(package="robot_controller", executable=name, namespace={namespace!r}, parameters=[{config!r}])
        for name in {names}
    ])
"""


@pytest.fixture
def share(built: Path) -> Path:
    """Give the built package three nodes of the test's own and no launch file; return its share folder."""
    prefix = built / "install" / "robot_controller"
    for name in robot_controller.EXECUTABLES:
        script = prefix / "lib" / "robot_controller" / name
        script.write_text(script.read_text().splitlines()[0] + NODE.format(name=name))
    (prefix / "share/robot_controller/launch/robot.launch.py").unlink()
    (prefix / "share/robot_controller/config/robot.yaml").unlink()
    return prefix / "share" / "robot_controller"


def write_launch(share: Path, name: str, config: str, namespace: str = "", count: int = 3) -> None:
    names = robot_controller.EXECUTABLES[-count:]
    text = LAUNCH.format(names=names, namespace=namespace, config=str(share / "config" / config))
    (share / "launch" / name).write_text(text)


@pytest.mark.parametrize(
    ("namespace", "status", "velocity"),
    [
        ("", "status_publisher", "/velocity_publisher"),
        ("left/arm", "/left/arm/status_publisher", "/**/velocity_publisher"),
        ("left", "left:\n status_publisher", "/**"),
    ],
    ids=range(3),
)
def test_a_right_configuration(share: Path, namespace: str, status: str, velocity: str) -> None:
    """Nested, arrays, namespaces in many writings; several files, of which the right ones need not come first."""
    text = PARAMETERS.format(status=status, velocity=velocity)
    if "\n" in status:
        text = text.replace("\n  ", "\n   ")
    (share / "config" / "robot.yml").write_text(text)
    (share / "config" / "a_map.yaml").write_text("- image: map.png\n- resolution: 0.05\n")
    (share / "config" / "for_another_launch_file.yaml").write_text(
        "turtle:\n  ros__parameters: {speed: 9.0}\n"
    )
    (share / "launch" / "a_torn.launch.py").write_text("def generate_launch_description(:\n")
    write_launch(share, "all_of_it.py", "robot.yml", namespace)
    assert robot_controller.configuration().startswith("Right")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "speed: 0.5",
            "speed: 0.5, top: 1.0",
            r"limits\.top of /status_publisher is 1\.0.*no such parameter",
        ),
        ("gains: [1.0, 0.25]", "gains: [1, 2]", "publishes /robot/status|ended"),
        ("small: 1e-3", "small: 1", "publishes /robot/status|ended"),
        (
            "/status_publisher:",
            "/left/status_publisher:",
            "/left/status_publisher, where /command_subscriber",
        ),
    ],
    ids=range(4),
)
def test_a_wrong_configuration(share: Path, old: str, new: str, said: str) -> None:
    """A nested name that no node has, whole numbers for floats, which ROS 2 refuses, and another namespace."""
    text = PARAMETERS.format(status="/status_publisher", velocity="velocity_publisher")
    assert old in text
    (share / "config" / "robot.yaml").write_text(text.replace(old, new))
    write_launch(share, "robot.launch.py", "robot.yaml")
    with pytest.raises(CheckError, match=said):
        robot_controller.configuration()


def test_values_that_do_not_reach_the_nodes(share: Path) -> None:
    """The launch file hands another file on."""
    (share / "config" / "robot.yaml").write_text(
        PARAMETERS.format(status="/**", velocity="velocity_publisher")
    )
    (share / "config" / "other.txt").write_text("/**:\n  ros__parameters: {label: other}\n")
    write_launch(share, "robot.launch.py", "other.txt")
    with pytest.raises(CheckError, match=r"limits\.speed of /\*\* is 0\.5.*Found: 0\.1"):
        robot_controller.configuration()


def test_one_of_several_launch_files_starts_all(share: Path) -> None:
    """It need not be the first one."""
    write_launch(share, "a_part.launch.py", "none.yaml", count=1)
    (share / "launch" / "b_nothing.launch.py").write_text("def generate_launch_description(): return None\n")
    write_launch(share, "whole.launch.py", "none.yaml")
    assert robot_controller.launch_file().startswith("Right")


def report(cases: str, **counts: int) -> str:
    attributes = " ".join(f'{name}="{count}"' for name, count in counts.items())
    return f"<testsuites><testsuite {attributes}>{cases}</testsuite></testsuites>"


def case(name: str, inner: str = "") -> str:
    return f'<testcase classname="robot_controller.test.{name}" name="test_it">{inner}</testcase>'


LINTERS = "".join(case(name, "<skipped/>") for name in ("test_copyright", "test_flake8", "test_pep257"))


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        (case("test_robot_state"), ""),
        (LINTERS + case("test_robot_state") * 3, ""),
        (case("test_flake8", "<failure/>") + case("test_robot_state"), ""),
        (None, "no report"),
        ("<torn", "no report in build/ that can be read"),
        (LINTERS, "no test of yours"),
        (case("test_robot_state") + case("test_robot_state", "<failure/>"), "1 of 2 failed"),
        (case("test_robot_state", "<error/>"), "1 of 1 failed"),
        (case("test_robot_state", "<skipped/>"), "no test of yours"),
    ],
    ids=range(9),
)
def test_unit_tests(package: Path, text: str | None, hint: str) -> None:
    """At least one of one's own passed and none failed; the tests that came with the package do not count."""
    file = course.student_path(robot_controller.WORKSPACE) / "build" / "robot_controller" / "pytest.xml"
    if text is not None:
        file.parent.mkdir(parents=True)
        file.write_text(report(text))
    if not hint:
        assert robot_controller.unit_tests().startswith("Right")
        return
    with pytest.raises(CheckError, match=hint):
        robot_controller.unit_tests()


def test_tests_that_were_changed_since(package: Path) -> None:
    """An old report says nothing of new tests."""
    file = course.student_path(robot_controller.WORKSPACE) / "build" / "robot_controller" / "pytest.xml"
    file.parent.mkdir(parents=True)
    file.write_text(report(case("test_robot_state")))
    (package / "test").mkdir()
    newer = package / "test" / "test_robot_state.py"
    newer.touch()
    later = file.stat().st_mtime + 10
    os.utime(newer, (later, later))
    with pytest.raises(CheckError, match="changed since"):
        robot_controller.unit_tests()


def test_nodes_on_the_air(built: Path, package_processes: Callable[[str], NodeProcess]) -> None:
    """Nothing, some and all of the nodes in one's own domain; then a robot that stands, and one that drives."""
    with pytest.raises(CheckError, match="Found: the nodes none"):
        robot_controller.on_the_air()
    with pytest.raises(CheckError, match="nothing on /cmd_vel"):
        robot_controller.drives()
    package_processes("status_publisher")
    package_processes("command_subscriber")
    with pytest.raises(CheckError, match="a running node with /cmd_vel"):
        robot_controller.on_the_air()
    package_processes("velocity_publisher")
    assert robot_controller.on_the_air().startswith("Right")
    with pytest.raises(CheckError, match="0 m/s forward"):
        robot_controller.drives()
    command(built, "start")
    assert robot_controller.drives().startswith("Right")


@pytest.fixture
def package_processes(built: Path) -> Iterator[Callable[[str], NodeProcess]]:
    """Start executables of the built workspace in the test's own domain."""
    started: list[NodeProcess] = []

    def start(name: str) -> NodeProcess:
        words = ["ros2", "run", "robot_controller", name]
        started.append(NodeProcess("robot_controller", name, words, Workspace(built).overlay))
        return started[-1]

    yield start
    for process in started:
        process.stop()


def command(workspace: Path, word: str) -> None:
    words = ["ros2", "topic", "pub", "--once", "/robot/command", "std_msgs/msg/String", f"{{data: {word}}}"]
    subprocess.run(words, env=dict(Workspace(workspace).overlay), check=True, capture_output=True)


def create(package: Path, *options: str) -> None:
    shutil.rmtree(package)
    words = ["ros2", "pkg", "create", "robot_controller", "--maintainer-name", "Ada"]
    words += ["--maintainer-email", "ada@example.org", *options]
    environ = environment.lab_environment()
    subprocess.run(words, cwd=package.parent, env=environ, check=True, capture_output=True)
