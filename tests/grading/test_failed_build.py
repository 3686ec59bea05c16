"""A build that fails costs points once: where its fault belongs, or where nothing else has cost them."""

from __future__ import annotations

import evidences
import pytest

from ros2lab.grading.grade import Grade
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

MARKER = "error: can't copy 'resource/robot_controller': doesn't exist"
CFG = evidences.facts("setup", "scripts_go_to_lib")


def _graded(*changes: evidences.Change) -> Grade:
    return verdict(evidences.both(*changes)(evidences.right()), load())


def _lost(grade: Grade, component: str) -> float:
    points = grade.components[component]
    return points.max - points.points


CHARGED = {
    "no marker": (MARKER, [evidences.facts("setup", "marker_exists")]),
    "files that are not there": (
        "error: can't copy 'launch/robot.launch.py'",
        [evidences.facts("setup", "data_files_exist")],
    ),
    "an error in setup.py": ("SyntaxError: invalid syntax", [evidences.facts("setup", "is_valid")]),
    "something that nobody knows": ("RuntimeError: no", []),
    "no package.xml that is valid": ("no element found", [evidences.facts("manifest", "is_valid")]),
}


@pytest.mark.parametrize("fault", CHARGED)
def test_a_fault_that_costs_points_in_the_package_costs_none_for_the_build(fault: str) -> None:
    """But the report says that it does not build, and why."""
    error, changes = CHARGED[fault]
    grade = _graded(*changes, evidences.unbuilt(error))
    build = next(criterion for criterion in grade.criteria if criterion.id == "workspace.build")
    assert _lost(grade, "workspace") == 0
    assert _lost(grade, "package") >= 2
    assert "does not build it" in build.reason
    assert error.split(":")[0] in build.reason


MASKED = {
    "no marker, and a setup.cfg that makes it useless": (
        MARKER,
        [CFG, evidences.facts("setup", "marker_exists")],
        CFG,
    ),
    "files that are not there, of a setup.py that installs no modules": (
        "error: can't copy 'launch/robot.launch.py'",
        [evidences.facts("setup", "installs_modules", "data_files_exist")],
        evidences.facts("setup", "installs_modules"),
    ),
    "something that nobody knows, beside a setup.cfg": ("RuntimeError: no", [CFG], CFG),
}


@pytest.mark.parametrize("fault", MASKED)
def test_a_fault_that_another_one_hides_costs_half_of_the_build(fault: str) -> None:
    """A report names the error; without the fault the other one costs what it did."""
    error, changes, other = MASKED[fault]
    grade = _graded(*changes, evidences.unbuilt(error))
    build = next(criterion for criterion in grade.criteria if criterion.id == "workspace.build")
    assert build.points == build.max / 2
    assert build.reason.endswith(f"does not build it: {error}.")
    assert build.hint
    alone = _graded(other, evidences.misplaced(*evidences.NODES))
    assert _lost(grade, "package") >= _lost(alone, "package")


def test_what_this_machine_cannot_build_is_not_told_as_an_error_of_cmake() -> None:
    grade = _graded(
        evidences.facts("manifest", "is_ament_python"), evidences.unbuilt("CMake Error at CMakeLists.txt:9")
    )
    build = next(criterion for criterion in grade.criteria if criterion.id == "workspace.build")
    assert build.points == build.max
    assert build.reason.endswith("its build type is not ament_python.")
