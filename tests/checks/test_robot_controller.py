"""The checks of `07_robot_controller` beyond right and wrong answers, which are data in `answers/`."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from ros2lab import course
from ros2lab.checks import robot_controller
from ros2lab.checks.watched_program import WatchedLaunch, WatchedProgram, last_words
from ros2lab.environment import lab_environment
from ros2lab.node_process import NodeProcess
from ros2lab.observed_domain import ObservedDomain
from ros2lab.workspace import Workspace

PRINTED = """\
[INFO] [launch]: Default logging verbosity is set to INFO
[INFO] [talker-1]: process started with pid [11]
[INFO] [listener-2]: process started with pid [12]
[listener-2] Traceback (most recent call last):
[talker-1] [INFO] [talker]: Ready
[listener-2] ValueError: no ears
[ERROR] [listener-2]: process has died [pid 12, exit code 1, cmd 'listener'].
"""
NAMESAKE = """
import time
import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("namesake")
time.sleep({pause})
publisher = node.create_publisher(String, "{topic}", 10)
rclpy.spin(node)
"""


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A student's folder with a built copy of the reference workspace."""
    folder = tmp_path_factory.mktemp("reference")
    assert Workspace(course.copy_reference(folder)).build(show=False).is_ok
    return folder


@pytest.mark.parametrize(
    "check",
    [
        robot_controller.package,
        robot_controller.status_publisher,
        # Other right answers to these are typed in each run, and judged by the same.
        *(
            pytest.param(check, marks=pytest.mark.thorough)
            for check in (
                robot_controller.command_subscriber,
                robot_controller.velocity_publisher,
                robot_controller.executables,
                robot_controller.parameters,
                robot_controller.launch_file,
                robot_controller.error_handling,
            )
        ),
    ],
    ids=lambda check: check.__name__,
)
def test_the_reference_is_right(
    reference: Path, monkeypatch: pytest.MonkeyPatch, check: Callable[[], str]
) -> None:
    """The course's own package passes; its configuration is not the one that the lesson asks for."""
    monkeypatch.setenv("ROS2LAB_WORK", str(reference))
    assert check().startswith("Right")


def test_a_launch_names_the_process_that_ended_with_its_own_words(tmp_path: Path) -> None:
    """What the other processes print meanwhile is not taken for its last words."""
    (tmp_path / "printed").write_text(PRINTED)
    process = NodeProcess(
        "robot", "robot.launch.py", ["cat", str(tmp_path / "printed")], {"PATH": "/usr/bin:/bin"}
    )
    process.wait(10.0)
    domain = None  # nothing is asked of it
    ended = WatchedLaunch(domain, process, tmp_path).ended()  # type: ignore[arg-type]
    assert ended is not None
    assert ended.name == "listener"
    assert last_words(ended.output) == "ValueError: no ears"


def test_the_answer_of_a_namesake_is_not_taken_for_a_slow_programs(tmp_path: Path) -> None:
    with ObservedDomain() as domain:
        for count, (topic, pause) in enumerate((("/soon", 0.0), ("/late", 1.5)), 1):
            command = [sys.executable, "-c", NAMESAKE.format(topic=topic, pause=pause)]
            process = domain.start(topic, command, lab_environment())
            program = WatchedProgram(domain, process, tmp_path, nodes=count)
            program.expect_end(topic, domain.published)
            assert topic in domain.published()
