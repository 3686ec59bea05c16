"""Which silent programs are run as the README says, and what of that counts."""

from __future__ import annotations

from dataclasses import replace

import evidences
import pytest
from evidences import VELOCITY

from ros2lab.grading.evidence import DOCUMENTED, Files, Run
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict
from ros2lab.grading.watching.job import Program
from ros2lab.grading.watching.other_values import documented

SILENT, HEARD = evidences.velocity_run(values=[]), evidences.velocity_run()
RUN = "ros2 run robot_controller velocity_publisher --ros-args"


@pytest.mark.parametrize(
    ("run", "readme", "expected"),
    [
        (SILENT, f"`{RUN} -p enabled:=true -p speed:=0.3`", [["enabled:=true", "speed:=0.3"]]),
        (SILENT, f"{RUN} --param 'mode:=auto'  # drives", [["mode:=auto"]]),
        (SILENT, f"{RUN} \\\n  -p enabled:=true", [["enabled:=true"]]),
        (SILENT, f"{RUN} -p mode:=idle\n{RUN} -p mode:=auto", [["mode:=idle"], ["mode:=auto"]]),
        (SILENT, "`ros2 param set /velocity_publisher enabled true`", [["enabled:=true"]]),
        (SILENT, "ros2 param set /other enabled true", []),
        (SILENT, f"{RUN.replace('velocity', 'status')} -p enabled:=true", []),
        (SILENT, f"{RUN}\n-p enabled:=true", []),
        (SILENT, RUN, []),
        (HEARD, f"{RUN} -p enabled:=true", []),
        (replace(SILENT, publishes={}), f"{RUN} -p enabled:=true", []),
    ],
)
def test_a_silent_program_is_run_with_the_parameters_of_the_readme(
    run: Run, readme: str, expected: list[list[str]]
) -> None:
    programs = documented([Program(VELOCITY, ["/lib/velocity"])], [run], Files(readme=readme))
    found = [(list(program.parameters), program.setting) for program in programs]
    assert found == [(given, DOCUMENTED) for given in expected]


def test_what_comes_as_the_readme_says_counts() -> None:
    """It is told that it comes with these parameters."""
    evidence = evidences.right([evidences.status_run(), evidences.command_run(), SILENT])
    grade = verdict(replace(evidence, runs=[*evidence.runs, replace(HEARD, setting=DOCUMENTED)]), load())
    assert grade.components[VELOCITY].points == 20
    assert any("with the parameters that the README gives" in one.reason for one in grade.criteria)


@pytest.mark.parametrize(("node", "points"), [("/velocity_publisher", 20), ("/another", 9)])
def test_what_a_launch_file_switches_on_counts_where_it_is_the_programs_own(node: str, points: float) -> None:
    """What a launch file starts besides, such as `ros2 topic pub`, does not."""
    evidence = evidences.right([evidences.status_run(), evidences.command_run(), SILENT])
    on = evidences.launched([evidences.status_run(), evidences.command_run(), evidences.velocity_run(node)])
    runs = [on if run.setting == "launched" else run for run in evidence.runs]
    assert verdict(replace(evidence, runs=runs), load()).components[VELOCITY].points == points
