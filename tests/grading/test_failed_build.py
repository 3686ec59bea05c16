"""A build that fails costs half of its points, and its fault what it costs where it belongs."""

from __future__ import annotations

from dataclasses import replace

import evidences
import pytest

from ros2lab.grading.evidence import OTHER_TYPE
from ros2lab.grading.grade import Grade
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

_CMAKE = evidences.submission(package=replace(evidences.PACKAGE, build_type="ament_cmake"))
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
def test_a_package_that_does_not_build_loses_half_of_the_build_besides(fault: str) -> None:
    """The lost points say which error it is, and the package loses what it did."""
    error, changes = CHARGED[fault]
    grade = _graded(*changes, evidences.unbuilt(error))
    build = next(criterion for criterion in grade.criteria if criterion.id == "workspace.build")
    assert _lost(grade, "workspace") == 3
    assert 2 <= _lost(grade, "package") <= 5
    assert build.reason.endswith(f"does not build it: “{error}”.")
    assert build.hint
    assert any(one.component == "workspace" and error in one.cause for one in grade.faults)


def test_an_error_of_setup_py_is_told_to_its_end() -> None:
    error = f"Problems to parse EntryPoint(name='a', value='{'robot_controller.status_publisher:main' * 2}')"
    build = next(one for one in _graded(evidences.unbuilt(error)).criteria if one.id == "workspace.build")
    assert error in build.reason


@pytest.mark.parametrize(
    ("error", "lost"),
    [
        ("ModuleNotFoundError: No module named 'generate_parameter_library_py' (setup.py, line 2)", 0),
        ("OSError: [Errno 2] No such file or directory: '/dev/ttyUSB0'", 0),
        ("ModuleNotFoundError: No module named 'setuptool' (setup.py, line 2)", 8),
        ("ModuleNotFoundError: No module named 'robot_controler' (setup.py, line 2)", 8),
        ("ModuleNotFoundError: No module named 'robot_controller' (setup.py, line 2)", 8),
        ("NameError: name 'glob' is not defined (setup.py, line 9)", 8),
    ],
)
def test_what_is_not_installed_here_is_no_fault_of_a_setup_py(error: str, lost: float) -> None:
    grade = _graded(evidences.unbuilt(error))
    assert _lost(grade, "workspace") + _lost(grade, "package") == lost
    if not lost:
        assert "could not be tried" in next(c.reason for c in grade.criteria if c.id == "workspace.build")


def test_one_that_colcon_takes_for_another_type_is_not_said_to_fail() -> None:
    """Without a valid package.xml colcon may build it as plain Python, and CMake is not everywhere."""
    error = f"{OTHER_TYPE[0]}: a tag is not closed"
    for change in (
        evidences.both(evidences.facts("manifest", "is_valid"), evidences.unbuilt(error)),
        evidences.both(
            _CMAKE, evidences.facts("manifest", "is_ament_python"), evidences.unbuilt("CMake Error")
        ),
    ):
        assert _lost(_graded(change), "workspace") == 0


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
    assert build.reason.endswith(f"does not build it: “{error}”.")
    assert build.hint
    alone = _graded(other, evidences.misplaced(*evidences.NODES))
    assert _lost(grade, "package") >= _lost(alone, "package")


def test_what_this_machine_cannot_build_is_not_told_as_an_error_of_cmake() -> None:
    grade = _graded(
        _CMAKE,
        evidences.facts("manifest", "is_ament_python"),
        evidences.unbuilt("CMake Error at CMakeLists.txt:9"),
    )
    build = next(criterion for criterion in grade.criteria if criterion.id == "workspace.build")
    assert build.points == build.max
    assert build.reason.endswith("its build type is not ament_python.")
