"""What shuts a launch down by time alone is told by launch itself, before it does so."""

from __future__ import annotations

import subprocess
from dataclasses import replace
from pathlib import Path

import evidences
import pytest

from ros2lab import environment
from ros2lab.grading.evidence import TIMED
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict
from ros2lab.grading.watching.rounds import LAUNCH

_FILE = """
from launch import LaunchDescription
from launch.actions import *
from launch.conditions import IfCondition
from launch.event_handlers import *
from launch.events import Shutdown as Event

def generate_launch_description():
    after = lambda *actions, **how: TimerAction(period=0.1, actions=[*actions], **how)
    work = ExecuteProcess(cmd=["true"])
    return LaunchDescription([work, {}])
"""


@pytest.mark.parametrize(
    ("action", "is_timed"),
    [
        ("after(Shutdown())", True),
        ("after(EmitEvent(event=Event()))", True),
        ("after(GroupAction([Shutdown()]))", True),
        ("after(after(Shutdown()))", True),
        ("RegisterEventHandler(OnProcessStart(target_action=work, on_start=[after(Shutdown())]))", True),
        ("OpaqueFunction(function=lambda _: [after(Shutdown())])", True),
        ("after(Shutdown(), condition=IfCondition('false'))", False),
        ("RegisterEventHandler(OnProcessExit(target_action=work, on_exit=[Shutdown()]))", False),
        (
            "after(RegisterEventHandler(OnProcessExit(target_action=work, on_exit=[Shutdown()])))",
            False,
        ),
        ("after(Shutdown(condition=IfCondition('false')))", False),
        ("after(LogInfo(msg='all is well'))", False),
    ],
)
def test_launch_tells_of_a_timer_that_ends_all(tmp_path: Path, action: str, is_timed: bool) -> None:
    file = tmp_path / "robot.launch.py"
    file.write_text(_FILE.format(action), encoding="utf-8")
    environ = environment.lab_environment() | {"ROS_LOG_DIR": str(tmp_path)}
    done = subprocess.run(
        [*LAUNCH, str(file)], capture_output=True, text=True, env=environ, timeout=60, check=True
    )
    assert (TIMED in done.stdout.splitlines()) is is_timed
    assert "process has finished cleanly" in done.stdout + done.stderr


@pytest.mark.parametrize("points", [0, 2])
def test_a_launch_file_keeps_running_what_it_starts(points: float) -> None:
    given = evidences.right()
    runs = [
        replace(
            run, log=[*run.log, ["PRINT", TIMED]] if run.setting == "launched" and not points else run.log
        )
        for run in given.runs
    ]
    grade = verdict(replace(given, runs=runs), load())
    (criterion,) = (one for one in grade.criteria if one.id == "bonus.launch")
    assert criterion.points == points
    assert ("shuts everything down by itself, by a timer" in criterion.reason) == (not points)
