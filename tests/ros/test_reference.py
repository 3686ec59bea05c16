"""The reference package builds, passes its own tests under `colcon test`, and these notice what is broken."""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

from ros2lab import course
from ros2lab.session import LabSession
from ros2lab.workspace import Workspace

pytestmark = pytest.mark.long


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    """Return a copy of the reference workspace, not built yet."""
    return Workspace(course.copy_reference(tmp_path))


def test_the_reference_builds_without_a_warning_and_passes_its_tests(workspace: Workspace) -> None:
    """What a student compares with is right."""
    built = workspace.build(show=False)
    assert built.is_ok, built
    assert [package.warnings for package in built.packages] == [()]
    assert [executable.name for executable in workspace.executables("robot_controller")] == [
        "command_subscriber",
        "status_publisher",
        "velocity_publisher",
    ]
    tested = workspace.test(show=False)
    assert tested.is_ok, tested
    assert sum(package.tests for package in tested.packages) > 50


def test_its_tests_fail_when_a_node_is_broken(workspace: Workspace) -> None:
    """A robot that does not stop is noticed by the package's own tests."""
    package = workspace.path / "src" / "robot_controller"
    for test in package.glob("test/test_*.py"):
        if test.name != "test_velocity.py":
            test.unlink()  # in a copy; they too would notice, but each only at its deadline
    module = package / "robot_controller" / "velocity.py"
    right = module.read_text()
    wrong = right.replace("STANDSTILL = Velocity(0.0, 0.0)", "STANDSTILL = Velocity(0.1, 0.0)")
    assert wrong != right
    module.write_text(wrong)
    tested = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test"],
        cwd=package,
        env={**os.environ, "PYTHONPATH": str(package), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert tested.returncode == 1
    assert "FAILED test/test_velocity.py" in tested.stdout


def test_the_reference_runs_without_a_build_and_does_not_hide_what_is_sourced_later(
    session: LabSession, workspace: Workspace, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = set(course.reference_workspace().rglob("*"))
    subscriber, status, velocity = course.reference_nodes()
    assert [one.__name__ for one in (subscriber, status, velocity)] == list(course.project()[1].values())
    for node_class in (subscriber, status, velocity):
        session.run(node_class)
    log = session.log("/cmd_vel", "geometry_msgs/msg/Twist")
    session.wait_for_subscribers("/robot/command")
    session.publish("/robot/command", "start")
    log.wait_until(lambda twist: twist.linear.x == 0.5)
    assert set(course.reference_workspace().rglob("*")) == before
    monkeypatch.syspath_prepend(workspace.path / "src" / "robot_controller")
    try:
        own = importlib.import_module("robot_controller.velocity_publisher")
    finally:
        for name in [name for name in sys.modules if name.partition(".")[0] == "robot_controller"]:
            del sys.modules[name]
    assert Path(own.__file__ or "").is_relative_to(workspace.path)
    assert own.VelocityPublisher is not velocity
