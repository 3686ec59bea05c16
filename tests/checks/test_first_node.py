"""The checks of `04_first_node`: right answers in many styles are accepted, wrong ones of many kinds are not."""

from __future__ import annotations

import itertools
import os
import shutil
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import Int32, Int64, String

from ros2lab import course, environment
from ros2lab.checks import CheckError, first_node
from ros2lab.session import LabSession


class Usual(Node):
    """As the solution has it."""

    def __init__(self) -> None:
        super().__init__("battery")
        self.charge = 100
        self.publisher = self.create_publisher(Int32, "battery", 10)
        self.timer = self.create_timer(0.5, self.tell)

    def tell(self) -> None:
        self.publisher.publish(Int32(data=self.charge))
        self.charge -= 1


class Terse(Node):
    """With few names, other arguments, and an absolute topic."""

    def __init__(self) -> None:
        super().__init__("battery", start_parameter_services=False)
        charges = itertools.count(100, -1)
        publisher = self.create_publisher(Int32, "/battery", qos_profile=QoSProfile(depth=1))
        self.create_timer(callback=lambda: publisher.publish(Int32(data=next(charges))), timer_period_sec=0.5)


class WithParameter(Node):
    """With a parameter, a logger, another topic, and a message that is kept."""

    def __init__(self, name: str = "power", period: float = 0.25) -> None:
        super().__init__(node_name=name, namespace="")
        self.declare_parameter("full", 100)
        self.message = Int32()
        self.message.data = self.get_parameter("full").value
        self.other = self.create_publisher(String, "battery/text", 10)
        self.publisher_ = self.create_publisher(topic="battery", msg_type=Int32, qos_profile=10)
        self.half = False
        self.create_timer(period, self.tick)

    def tick(self) -> None:
        self.half = not self.half
        if not self.half:
            self.get_logger().info(f"{self.message.data} %")
            self.other.publish(String(data="still running"))
            self.publisher_.publish(Int32(data=self.message.data))
            self.message.data -= 1


class Derived(Usual):
    """A node class may be derived from another one."""


@pytest.mark.parametrize("right", [Usual, Terse, WithParameter, Derived])
def test_a_right_battery(right: type[Node]) -> None:
    """Whatever its names and its style."""
    assert first_node.battery(right).startswith("Right")


def test_a_battery_is_checked_beside_a_session(domain_id: int) -> None:
    """The student's own session goes on, and does not hear the node that is checked."""
    with LabSession(domain_id=domain_id) as session:
        log = session.log("/battery", Int32)
        own = session.log("/own", String)
        assert first_node.battery(Usual).startswith("Right")
        session.publish("/own", "still here")
        own.wait_for(1)
        assert log.count == 0
    assert os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "LOCALHOST"


def variant(**changes: Any) -> type[Node]:
    """Return a battery node with some of its parts changed."""

    class Variant(Node):
        def __init__(self) -> None:
            super().__init__(changes.get("name", "battery"))
            self.charge = changes.get("first", 100)
            self.type = changes.get("type", Int32)
            if changes.get("has_publisher", True):
                self.publisher = self.create_publisher(self.type, changes.get("topic", "battery"), 10)
            if changes.get("has_timer", True):
                self.create_timer(changes.get("period", 0.5), changes.get("callback", self.tell))

        def tell(self) -> None:
            if not changes.get("is_silent"):
                self.publisher.publish(self.type(data=changes.get("convert", int)(self.charge)))
            self.charge -= changes.get("less", 1)

    return Variant


class NoNode(Node):
    """Forgets super().__init__()."""

    def __init__(self) -> None:
        self.charge = 100
        self.publisher = self.create_publisher(Int32, "battery", 10)


class OnlyTold(Node):
    """Publishes the charge in percent."""


class Loop(Node):
    """Never comes back from its __init__."""

    def __init__(self) -> None:
        super().__init__("battery")
        publisher = self.create_publisher(Int32, "battery", 10)
        for charge in itertools.count(100, -1):
            publisher.publish(Int32(data=charge % 1000))
            time.sleep(0.5)


class AllAtOnce(Node):
    """Says everything before the clock runs."""

    def __init__(self) -> None:
        super().__init__("battery")
        publisher = self.create_publisher(Int32, "battery", 10)
        for charge in range(100, 90, -1):
            publisher.publish(Int32(data=charge))


class Called(Usual):
    """Calls the callback instead of naming it."""

    def __init__(self) -> None:
        super().__init__()
        self.create_timer(0.5, self.tell())


@pytest.mark.parametrize(
    ("wrong", "complaint"),
    [
        (variant(topic="batery"), "messages on /batery"),
        (variant(topic="/robot/battery"), "messages on /robot/battery"),
        (variant(has_timer=False), "a publisher on /battery, and no timer"),
        (variant(is_silent=True), "a publisher on /battery, silent"),
        (variant(has_publisher=False, is_silent=True), "no publisher"),
        (variant(has_publisher=False), "it raised AttributeError"),
        (variant(type=String, convert=str), "std_msgs/msg/String"),
        (variant(type=Int64), "std_msgs/msg/Int64"),
        (variant(convert=str), "it raised (TypeError|AssertionError|SystemError)"),
        (variant(period=1.0), r"1\.0, 2\.0, 3\.0"),
        (variant(period=500), "a publisher on /battery, silent"),
        (variant(period=0.05), "messages at"),
        (variant(period=0.7), "messages at"),
        (variant(period=0.0), "still does something else"),
        (variant(first=99), "99, 98, 97"),
        (variant(less=0), "100, 100, 100"),
        (variant(less=-1), "100, 101, 102"),
        (variant(callback=None), "it raised TypeError"),
        (variant(name="my battery"), "it raised InvalidNodeNameException"),
        (NoNode, "it raised AttributeError"),
        (OnlyTold, "it raised TypeError"),
        (Loop, "still does something else"),
        (AllAtOnce, r"messages at 0\.0, 0\.0"),
        (Called, "it raised TypeError"),
        (Usual.__init__, "without brackets"),
        (None, "without brackets"),
        (int, "without brackets"),
    ],
)
def test_a_wrong_battery(wrong: Any, complaint: str) -> None:
    """What it does instead is told, and a node that never ends is ended."""
    with pytest.raises(CheckError, match=complaint):
        first_node.battery(wrong)


BATTERY = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32, String


class Battery(Node):
    def __init__(self):
        super().__init__("battery")
        self.charge = 100
        self.publisher = self.create_publisher(Int32, "battery", 10)
        self.timer = self.create_timer(0.2, self.tell)

    def tell(self):
        self.publisher.publish(Int32(data=self.charge))
        self.charge -= 1


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Battery())
"""
NO_CLASS = """
import time, rclpy
from std_msgs.msg import Int32
def run():
    rclpy.init()
    node = rclpy.create_node("anything")
    publisher = node.create_publisher(Int32, "/battery", 10)
    charge = 100
    while publisher.get_subscription_count() == 0:
        time.sleep(0.05)
    while rclpy.ok():
        publisher.publish(Int32(data=charge))
        charge -= 1
        rclpy.spin_once(node, timeout_sec=0.1)
"""
NEWS = BATTERY.replace('Int32, "battery"', 'String, "robot_news"').replace(
    "Int32(data=self.charge)", 'String(data=f"{text} #{{101 - self.charge}}")'
)


def create(work: Path, *entry_points: str, options: tuple[str, ...] = ("--symlink-install",)) -> Path:
    """Make a workspace with `my_robot_controller`, build it, and return the folder of its modules."""
    package = first_node.PACKAGE
    src = work / "first_node_ws" / "src"
    src.mkdir(parents=True)
    environ = environment.lab_environment()
    command = ["ros2", "pkg", "create", package, "--build-type", "ament_python"]
    subprocess.run(command, cwd=src, env=environ, check=True, capture_output=True)
    setup = src / package / "setup.py"
    setup.write_text(
        setup.read_text().replace("'console_scripts': [", f"'console_scripts': {list(entry_points)} + [")
    )
    command = ["colcon", "build", *options]
    subprocess.run(command, cwd=src.parent, env=environ, check=True, capture_output=True)
    return src / package / package


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A student's folder in which both executables are built as links: a test only writes their modules."""
    work = tmp_path_factory.mktemp("my work")
    points = ("battery = my_robot_controller.battery:main", "my_first_node = my_robot_controller.news:main")
    create(work, *points)
    return work


@pytest.fixture
def source(built: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the modules of the built package."""
    monkeypatch.setenv("ROS2LAB_WORK", str(built))
    folder = course.student_path(f"{first_node.WORKSPACE}/src") / first_node.PACKAGE / first_node.PACKAGE
    # Python takes a module of the same second and length for the one that it has compiled.
    shutil.rmtree(folder / "__pycache__", ignore_errors=True)
    return folder


ABSOLUTE = BATTERY.replace('"battery", 10', '"/battery", 1')


@pytest.mark.parametrize(
    ("text", "point", "option"),
    [
        (BATTERY, "battery = my_robot_controller.module:main", "--symlink-install"),
        (NO_CLASS, "battery=my_robot_controller.module:run", "--continue-on-error"),
        (ABSOLUTE, "battery = my_robot_controller.module:main", "--merge-install"),
    ],
)
def test_a_right_program(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, point: str, option: str
) -> None:
    """In any file, with or without a class, built in any way."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path))
    source = create(tmp_path, point, options=(option,))
    (source / "module.py").write_text(text)
    if option != "--symlink-install":
        folder = source.parents[2]
        command = ["colcon", "build", option]
        subprocess.run(
            command, cwd=folder, env=environment.lab_environment(), check=True, capture_output=True
        )
    assert first_node.battery_program().startswith("Right")


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("Int32", "String", "(TypeError|AssertionError)|of the type std_msgs/msg/String"),
        ("self.charge -= 1", "self.charge += 1", r"goes down by one\. Found: 1\d\d, 1\d\d"),
        ("self.charge -= 1", "pass", "Found: 100, 100"),
        ("self.charge -= 1", "self.charge -= 5", "goes down by one"),
        ("self.charge -= 1", "raise SystemExit", "nothing on it|one message and no more"),
        ("    rclpy.spin(Battery())\n", "    Battery()\n", "nothing on it, and no output"),
        ("    rclpy.init(args=args)\n", "", "NotInitializedException"),
        ("def main", "def mian", "has no attribute 'main'"),
        ("class Battery(Node):", "class Battery(Node)", "SyntaxError"),
        (BATTERY, "", "has no attribute 'main'"),
    ],
)
def test_a_wrong_program(source: Path, old: str, new: str, complaint: str) -> None:
    """What the program did instead is told."""
    assert old in BATTERY
    (source / "battery.py").write_text(BATTERY.replace(old, new))
    with pytest.raises(CheckError, match=complaint):
        first_node.battery_program()


@pytest.mark.parametrize("topic", ["batery", "/battery/charge", "Battery"])
def test_a_program_that_is_heard_elsewhere(source: Path, topic: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is not waited for for ever."""
    monkeypatch.setattr(first_node, "HEAR_TIMEOUT", 3.0)
    (source / "battery.py").write_text(BATTERY.replace('"battery", 10', f'"{topic}", 10'))
    with pytest.raises(CheckError, match="nothing on it, and no output"):
        first_node.battery_program()


def test_a_program_of_another_type(source: Path) -> None:
    """The topic is right, its type is not."""
    (source / "battery.py").write_text(NEWS.format(text="full").replace("robot_news", "battery"))
    with pytest.raises(CheckError, match="a publisher of the type std_msgs/msg/String"):
        first_node.battery_program()


def test_a_program_that_is_not_built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file is no executable, whether something else was built or not."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path))
    with pytest.raises(CheckError, match="no executable battery"):
        first_node.battery_program()
    source = create(tmp_path, "my_first_node = my_robot_controller.battery:main")
    (source / "battery.py").write_text(BATTERY)
    with pytest.raises(CheckError, match="no executable battery"):
        first_node.battery_program()


@pytest.mark.parametrize(
    "text", ["The robot is well, message", "Neues vom Büro: alles grün,", "hello ros2 is old,"]
)
def test_right_words(source: Path, text: str) -> None:
    """Any words count, with a number at the end."""
    (source / "news.py").write_text(NEWS.format(text=text))
    assert first_node.own_words().startswith("Right")


@pytest.mark.parametrize(
    ("text", "old", "new", "complaint"),
    [
        ("Hello ROS2! Message", "", "", "words of your own"),
        ("", "", "", "words of your own"),
        ("News", " #{101", " {101", "words of your own"),
        ("News", "{101 - self.charge}", "1.", "# and a number"),
        ("News", "{101 - self.charge}", "{self.charge}", "# and a number"),
        ("News", 'f"', '"', "# and a number"),
        ("News", "String", "Int32", "its last line is|of the type"),
        ("News #4 of robot", "#{101", "{101", "# and a number"),
        ("News", 'f"News', "News", "SyntaxError"),
    ],
)
def test_wrong_words(source: Path, text: str, old: str, new: str, complaint: str) -> None:
    """The old words, no words, no counter, and no message."""
    program = NEWS.format(text=text)
    assert old in program
    (source / "news.py").write_text(program.replace(old, new) if old else program)
    with pytest.raises(CheckError, match=complaint):
        first_node.own_words()
