"""The nodes as processes: how they end, and that the files of the package agree."""

import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from geometry_msgs.msg import Twist
from std_msgs.msg import String

from conftest import DEADLINE, LATCHED, Bench

NAMES = ["status_publisher", "command_subscriber", "velocity_publisher"]
SIGNALS = [signal.SIGINT, signal.SIGTERM]
Start = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def start(package: Path, domain_id: int) -> Iterator[Start]:
    """Start an executable as a process; what still runs at the end of the test is killed."""
    processes: list[subprocess.Popen[str]] = []

    def start(name: str, *arguments: str, prelude: str = "") -> "subprocess.Popen[str]":
        code = f"{prelude}\nfrom robot_controller.executables import {name}\n{name}()"
        process = subprocess.Popen(
            [sys.executable, "-c", code, *arguments],
            cwd=package,
            env={**os.environ, "ROS_DOMAIN_ID": str(domain_id)},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        processes.append(process)
        return process

    yield start
    for process in processes:
        process.kill()
        process.communicate()


@pytest.mark.parametrize("number", SIGNALS)
@pytest.mark.parametrize("name", NAMES)
def test_a_signal_ends_a_running_node(
    bench: Bench,
    start: Start,
    name: str,
    number: signal.Signals,
) -> None:
    """Exit code 0 and no traceback; the graph knows at once that the node is gone."""
    process = start(name)
    bench.until(lambda: bench.is_running(name), "the node runs")
    process.send_signal(number)
    output, _ = process.communicate(timeout=DEADLINE)
    assert (process.returncode, output) == (0, "")
    bench.until(lambda: not bench.is_running(name), "the node has said goodbye")


@pytest.mark.parametrize("number", SIGNALS)
def test_the_robot_is_stopped_at_the_end(
    bench: Bench,
    start: Start,
    number: signal.Signals,
) -> None:
    """One zero reaches another process before the velocity publisher ends, and then nothing."""
    twists = bench.hear("/cmd_vel", Twist)
    process = start("velocity_publisher")
    bench.speaker("/robot/state", LATCHED).publish(String(data="running"))
    bench.until(lambda: bool(twists) and twists[-1].linear.x == 0.5, "the robot drives")
    process.send_signal(number)
    output, _ = process.communicate(timeout=DEADLINE)
    assert process.returncode == 0, output
    bench.until(lambda: twists[-1].linear.x == 0.0, "a zero at the end")
    first_drive = next(i for i, twist in enumerate(twists) if twist.linear.x != 0.0)
    speeds = [(twist.linear.x, twist.angular.z) for twist in twists[first_drive:]]
    assert speeds == [(0.5, 0.2)] * (len(speeds) - 1) + [(0.0, 0.0)]


def test_two_signals_are_as_good_as_one(bench: Bench, start: Start) -> None:
    """A launch and a terminal may both pass on the same Ctrl-C."""
    process = start("command_subscriber")
    bench.until(lambda: bench.is_running("command_subscriber"), "the node runs")
    for number in (*SIGNALS, *SIGNALS):
        process.send_signal(number)
    output, _ = process.communicate(timeout=DEADLINE)
    assert (process.returncode, output) == (0, "")


# Each sends the process a signal at one moment of its start-up.
DURING_IMPORT = """
import os, sys
class Strike:
    def find_spec(self, name, path=None, target=None):
        if name == "{module}":
            os.kill(os.getpid(), {number})
sys.meta_path.insert(0, Strike())
"""
BEFORE_INIT = """
import os, rclpy
init = rclpy.init
def strike(**arguments):
    os.kill(os.getpid(), {number})
    init(**arguments)
rclpy.init = strike
"""
DURING_CONSTRUCTION = """
import os, rclpy.node
create_publisher = rclpy.node.Node.create_publisher
def strike(*arguments, **further):
    os.kill(os.getpid(), {number})
    return create_publisher(*arguments, **further)
rclpy.node.Node.create_publisher = strike
"""


@pytest.mark.parametrize("number", SIGNALS)
@pytest.mark.parametrize(
    "prelude",
    [
        DURING_IMPORT.replace("{module}", "rclpy"),
        DURING_IMPORT.replace("{module}", "std_msgs.msg"),
        BEFORE_INIT,
        DURING_CONSTRUCTION,
    ],
    ids=["importing rclpy", "importing messages", "before init", "during construction"],
)
def test_a_signal_ends_a_starting_node(start: Start, number: signal.Signals, prelude: str) -> None:
    """Exit code 0 and no traceback, from the first import on."""
    process = start("velocity_publisher", prelude=prelude.replace("{number}", str(int(number))))
    output, _ = process.communicate(timeout=DEADLINE)
    assert (process.returncode, output) == (0, "")


def test_a_fault_in_a_callback_is_shown_and_the_robot_stopped(bench: Bench, start: Start) -> None:
    """A programming error ends the node with its traceback, but not before the zero."""
    prelude = """
from robot_controller import robot_state, velocity
velocity_in = velocity.velocity_in
def stumble(state, cruise):
    if state is robot_state.State.STOPPED:
        raise RuntimeError("a fault")
    return velocity_in(state, cruise)
velocity.velocity_in = stumble
"""
    twists = bench.hear("/cmd_vel", Twist)
    process = start("velocity_publisher", prelude=prelude)
    states = bench.speaker("/robot/state", LATCHED)
    states.publish(String(data="running"))
    bench.until(lambda: bool(twists) and twists[-1].linear.x == 0.5, "the robot drives")
    states.publish(String(data="stopped"))
    output, _ = process.communicate(timeout=DEADLINE)
    assert process.returncode == 1
    assert "RuntimeError: a fault" in output
    bench.until(lambda: twists[-1].linear.x == 0.0, "a zero at the end")


@pytest.mark.parametrize(
    "arguments", [["--params-file", "nowhere.yaml"], ["-p", "period"], ["--no-such-option"]]
)
def test_a_wrong_command_line_is_one_sentence(start: Start, arguments: list[str]) -> None:
    """It is named, without a traceback, and the exit code is not 0."""
    process = start("status_publisher", "--ros-args", *arguments)
    output, _ = process.communicate(timeout=DEADLINE)
    assert process.returncode == 1
    assert "ROS 2 does not start with this command line" in output
    assert "Traceback" not in output


def test_setup_launch_and_configuration_name_the_same_nodes(package: Path) -> None:
    """What is installed, launched and configured are the three nodes."""
    setup = (package / "setup.py").read_text()
    entry_points = re.findall(r'f"(\w+) = \{PACKAGE\}\.executables:(\w+)"', setup)
    assert entry_points == [(name, name) for name in NAMES]
    launch = (package / "launch" / "robot.launch.py").read_text()
    assert sorted(re.findall(r'_node\("(\w+)"', launch)) == sorted(NAMES)
    config = (package / "config" / "robot.yaml").read_text()
    configured = re.findall(r"^/\*\*/(\w+):$", config, re.MULTILINE)
    assert set(configured) == set(NAMES) - {"command_subscriber"}
