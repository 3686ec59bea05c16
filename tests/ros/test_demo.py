"""The demonstration drives the real robot, and sees when it does not do what it should."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
from pathlib import Path

import psutil
import pytest
from typer.testing import CliRunner

from deadlines import DEADLINE
from ros2lab import course
from ros2lab.cli import app
from ros2lab.verbs import demo
from ros2lab.verbs.demo import Demonstration, demonstrate
from ros2lab.workspace import Workspace

COMMAND = ["-c", "from ros2lab.cli import main; main()", "demo"]

# Another right robot: one process, no class, other names, a sleeping loop, a velocity that changes and is
# published only while it moves and once when it stops, best effort, a status in no particular form.
OTHER_ROBOT = """
import math
import threading
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import qos_profile_sensor_data
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import String


def main():
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    teller, listener, driver = map(rclpy.create_node, ("teller", "listener", "driver"))
    status = teller.create_publisher(String, "robot/status", qos_profile_sensor_data)
    velocity = driver.create_publisher(Twist, "cmd_vel", qos_profile_sensor_data)
    running = threading.Event()

    def obey(message):
        listener.get_logger().info("heard " + message.data)
        if message.data == "start":
            running.set()
        elif message.data in ("stop", "reset"):
            running.clear()
            velocity.publish(Twist())

    def swing():
        if running.is_set():
            twist = Twist()
            twist.angular.z = 1.5 + math.sin(time.monotonic())
            velocity.publish(twist)

    def report():
        while True:
            status.publish(String(data="alles gut"))
            time.sleep(2)

    listener.create_subscription(String, "robot/command", obey, 10)
    driver.create_timer(0.05, swing)
    threading.Thread(target=report, daemon=True).start()
    executor = SingleThreadedExecutor()
    for node in (teller, listener, driver):
        executor.add_node(node)
    try:
        executor.spin()
    except KeyboardInterrupt:
        pass
    rclpy.shutdown()
"""


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    """A copy of the reference workspace, to be spoilt."""
    return Workspace(course.copy_reference(tmp_path))


def spoil(workspace: Workspace, module: str, old: str, new: str) -> None:
    """Change a module of the reference package, which must hold `old`."""
    path = workspace.path / "src/robot_controller/robot_controller" / f"{module}.py"
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")


def unmet(demonstration: Demonstration) -> dict[str, str]:
    """Return what was seen of each expectation that was not met, by its text."""
    return {
        expectation.text: expectation.seen
        for expectation in demonstration.expectations
        if not expectation.is_met
    }


def test_the_command(tmp_path: Path) -> None:
    """It prints every tick and the table, leaves the picture, and ends with 0; nothing else stays."""
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    finished = subprocess.run(
        [sys.executable, *COMMAND, "--output", tmp_path / "out"],
        env={**os.environ, "TMPDIR": str(scratch), "COLUMNS": "160"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert finished.returncode == 0, finished.stdout + finished.stderr
    assert "✗" not in finished.stdout
    for topic in ("/robot/status", "/robot/command", "/cmd_vel"):
        assert any(topic in line and "/msg/" in line for line in finished.stdout.splitlines())
    picture = tmp_path / "out" / demo.PICTURE
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert [path for path in scratch.iterdir() if path.name.startswith("ros2lab-demo")] == []


@pytest.mark.parametrize(
    ("fault", "text", "seen"),
    [
        pytest.param(
            ("status_publisher", '"robot/status"', '"robot/state_of_things"'),
            "status_publisher: Publishes on /robot/status", "",
            marks=pytest.mark.thorough,
        ),
        pytest.param(
            ("status_publisher", '"period", 2.0', '"period", 2.4'),
            "status_publisher: A message comes every 2.0 s", "every 2.4 s, not every 2.0 s",
            marks=pytest.mark.thorough,
        ),
        pytest.param(
            ("robot_state", "(State.RUNNING, Command.STOP): State.STOPPED,", ""),
            "stop: the robot comes to a stand, and stays there", "not zero",
            marks=pytest.mark.thorough,
        ),
        pytest.param(
            ("robot_state", "(State.IDLE, Command.START): State.RUNNING,", ""),
            "start: the robot moves", "none of them not zero",
            marks=pytest.mark.thorough,
        ),
        pytest.param(
            ("velocity_publisher", "self._publish(STANDSTILL)", "pass"),
            "the last velocity before the end is zero", "m/s",
            marks=pytest.mark.thorough,
        ),
    ],
)  # fmt: skip
def test_a_robot_that_does_something_wrong(
    workspace: Workspace, domain_id: int, fault: tuple[str, str, str], text: str, seen: str
) -> None:
    """The line that names it is crossed, with what was seen."""
    spoil(workspace, *fault)
    demonstration = demonstrate(workspace, domain_id=domain_id)
    assert not demonstration.is_ok
    assert seen in unmet(demonstration)[text], unmet(demonstration)


@pytest.mark.thorough  # that it is told so is asked in unit/test_demo_verdicts.py
def test_a_node_that_ends_by_itself(workspace: Workspace, domain_id: int) -> None:
    """It is named with the last thing that it said."""
    spoil(workspace, "command_subscriber", "except ValueError as error:", "except KeyError as error:")
    seen = unmet(demonstrate(workspace, domain_id=domain_id))
    assert seen["every node runs until Ctrl-C"].startswith(
        "command_subscriber ended by itself: ValueError: 'dance'"
    )


@pytest.mark.thorough  # as above
def test_one_fault_is_one_cross(workspace: Workspace, domain_id: int) -> None:
    """A wrong period says nothing against the rest."""
    spoil(workspace, "status_publisher", '"period", 2.0', '"period", 1.6')
    demonstration = demonstrate(workspace, domain_id=domain_id)
    assert list(unmet(demonstration)) == ["status_publisher: A message comes every 2.0 s"]


@pytest.mark.thorough
def test_another_right_robot(workspace: Workspace, domain_id: int) -> None:
    """Names, styles and qualities of service are free."""
    package = workspace.path / "src/robot_controller"
    (package / "robot_controller" / "other.py").write_text(OTHER_ROBOT)
    setup = (package / "setup.py").read_text()
    begin, end = setup.index('"console_scripts": ['), setup.index("],", setup.index('"console_scripts": ['))
    entry = '"console_scripts": ["everything = robot_controller.other:main"'
    (package / "setup.py").write_text(setup[:begin] + entry + setup[end:])
    demonstration = demonstrate(workspace, domain_id=domain_id)
    assert unmet(demonstration) == {}


@pytest.mark.thorough
def test_a_workspace_that_does_not_build(
    workspace: Workspace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The command ends with 1 and tells the first real error."""
    (workspace.path / "src/robot_controller/resource/robot_controller").unlink()
    monkeypatch.setattr(course, "copy_reference", lambda _: workspace.path)
    result = CliRunner().invoke(app, ["demo", "--output", str(tmp_path)], env={"COLUMNS": "160"})
    assert result.exit_code == 1
    assert "error: can't copy 'resource/robot_controller'" in result.output


def test_a_folder_that_cannot_be_written() -> None:
    """It is said at once, and not after the run."""
    result = CliRunner().invoke(app, ["demo", "--output", "/proc/none"])
    assert result.exit_code == 1
    assert "The demonstration cannot run" in result.output
    assert "Traceback" not in result.output


def test_ros_that_cannot_be_imported(tmp_path: Path) -> None:
    """One sentence, and where to look; no traceback."""
    finished = subprocess.run(
        [sys.executable, *COMMAND, "--output", tmp_path],
        env={**os.environ, "_ROS_WHEELS_BOOTSTRAP_COMPLETE": "1", "LD_LIBRARY_PATH": ""},
        capture_output=True,
        text=True,
        check=False,
    )
    assert finished.returncode == 1
    assert finished.stderr.startswith("The demonstration cannot run: librcl")
    assert finished.stderr.endswith("`ros2lab doctor` may tell more.\n")


def test_interrupt(tmp_path: Path) -> None:
    """Ctrl-C while the nodes run ends with 130, and nothing of it stays."""
    with subprocess.Popen(
        [sys.executable, *COMMAND, "--output", tmp_path / "out"],
        env={**os.environ, "TMPDIR": str(tmp_path)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        nodes: list[psutil.Process] = []
        while process.poll() is None and len(nodes) < 3:
            nodes = [one for one in psutil.process_iter() if is_node_below(one, tmp_path)]
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(0.1)
        process.send_signal(signal.SIGINT)
        output, errors = process.communicate(timeout=DEADLINE)
    assert process.returncode == 130, output + errors
    assert "Traceback" not in output + errors
    _, alive = psutil.wait_procs(nodes, timeout=DEADLINE)
    assert alive == []
    assert list(tmp_path.glob("ros2lab-demo-*")) == []


def is_node_below(process: psutil.Process, folder: Path) -> bool:
    """Return whether a process runs an executable that was built below a folder."""
    try:
        return any(
            word.startswith(str(folder)) and "/lib/robot_controller/" in word for word in process.cmdline()
        )
    except psutil.Error:
        return False
