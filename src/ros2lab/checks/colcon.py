"""The exercises of `05_colcon`."""

from __future__ import annotations

import json
import shlex
import subprocess
import sys
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from catkin_pkg.package import InvalidPackage
from catkin_pkg.packages import find_packages

from ros2lab import course, environment
from ros2lab.checks import CheckError, Question, answer_of, exercise, quiz_of
from ros2lab.checks.programs import count_tests, overlay_of, run
from ros2lab.node_process import last_line
from ros2lab.workspace import Workspace

HARBOUR = "~/harbour_ws"
WORKSHOP = "~/workshop_ws"

# What is to be selected in each case, and what is said of another selection.
SELECTIONS = (
    (
        {"crane_app", "crane_driver", "harbour_map", "load_model"},
        "nothing is built yet: crane_app, and all that it needs, directly or not.",
    ),
    ({"crane_driver"}, "all the others are built, and are still right."),
    (
        {"load_model", "crane_driver", "crane_app"},
        "look the other way: who needs load_model, directly or not?",
    ),
)
# They say how to build, not what.
_OTHER_OPTIONS = ("--symlink-install", "--merge-install", "--continue-on-error")

OLD_SOUND = "Hi from horn."

# Volts, and how full the battery then is, in percent.
CHARGES = ((12.0, 100.0), (11.0, 50.0), (9.5, 0.0), (11.5, 75.0), (10.0, 0.0), (2.0, 0.0))
TESTS = 3  # of the package battery

QUIZ = (
    Question(
        "a",
        "Without links, what runs is a copy, and only a build makes a new one.",
        {
            "b": "Python reads the file in install/, not the one in src/.",
            "c": "sourcing says where install/ is; what lies there stays as it is.",
        },
    ),
    Question(
        "c",
        "Up to A: all that A needs, and A at the end.",
        {"b": "that is --packages-above.", "a": "the alphabet has no say in a build."},
    ),
    Question(
        "b",
        "A build takes nothing away, so you do.",
        {
            "a": "that is for CMake; what has a Python package to do with it?",
            "c": "links are added, and what lies in build/ stays there.",
        },
    ),
    Question(
        "c",
        "What is not declared there does not count.",
        {"a": "colcon reads no Python code.", "b": "the folders may have any names."},
    ),
)


@exercise
def build_order(function: Any) -> str:
    """Check that `function` returns the packages of the harbour so that each comes after all that it needs.

    Args:
        function: takes nothing, returns a sequence of names.

    Raises:
        CheckError: if a name is missing, too many or too early.
    """
    needs = _needs(HARBOUR)
    answer = answer_of(function, call="build_order()")
    if answer is None or isinstance(answer, str) or not isinstance(answer, Iterable):
        raise CheckError(
            f"build_order() returns a list of {len(needs)} names",
            repr(answer),
            'write return ["...", "..."].',
        )
    order = [str(name) for name in answer]
    if sorted(order) != sorted(needs):
        raise CheckError(
            f"each of {', '.join(sorted(needs))} once", ", ".join(order) or "no name", "compare the names."
        )
    for number, name in enumerate(order):
        late = sorted(needs[name].difference(order[:number]))
        if late:
            raise CheckError(
                "each package after all that it needs",
                f"{name} as number {number + 1}, and something that it needs comes later",
                "begin with a package that needs no other; then take one whose needs are all in your list.",
                f"{name} needs {' and '.join(late)}.",
            )
    return "Right: each package comes after those that it needs."


@exercise
def selections(*options: str) -> str:
    """Check by `colcon list` that the options select the packages that are asked for.

    Args:
        options: for each of the three cases what stands after `colcon build`.

    Raises:
        CheckError: if one selects other packages, or colcon does not understand it.
    """
    _needs(HARBOUR)
    if len(options) != len(SELECTIONS):
        raise CheckError(
            f"{len(SELECTIONS)} texts, one for each case",
            str(len(options)),
            'write them in quotes, with commas between them, such as "--packages-select ship_pilot".',
        )
    with ThreadPoolExecutor() as pool:
        found = list(pool.map(_selected, options))
    for number, ((expected, hint), names) in enumerate(zip(SELECTIONS, found, strict=True), 1):
        if names != expected:
            raise CheckError(
                f"case {number} builds {len(expected)} package{'s' * (len(expected) > 1)}, the right ones",
                ", ".join(sorted(names)) or "no package",
                f"{hint[0].upper()}{hint[1:]}",
                f"It builds {', '.join(sorted(expected))}: look at the table of options.",
            )
    return "Right: no package too many, and none too few."


@exercise
def edit_takes_effect() -> str:
    """Check that `ros2 run horn blow` says what the edited source says.

    Raises:
        CheckError: if it does not, or the edit is not there any more.
    """
    package = _package(WORKSHOP, "horn")
    source = _run_source("import horn.blow; horn.blow.main()", package)
    if source.returncode or source.stdout.strip() in ("", OLD_SOUND):
        raise CheckError(
            "the source of horn says something new",
            source.stdout.strip() or last_line(source.stderr) or "nothing",
            "the edit must stay: it is the build that has to follow.",
        )
    overlay = overlay_of(Workspace(package.parents[1]))
    built = run(["ros2", "run", "horn", "blow"], "`ros2 run horn blow`", environ=overlay)
    if built.returncode or built.stdout != source.stdout:
        raise CheckError(
            f"ros2 run horn blow says {source.stdout.strip()!r}, as the source does",
            repr(built.stdout.strip() or last_line(built.stderr) or "nothing"),
            "what runs is the copy in install/: who makes it?",
            f"cd {WORKSHOP}, and build the package horn again.",
        )
    return "Right: what runs is what you have written."


@exercise
def mended_test() -> str:
    """Check that the battery is never less than empty, and that its tests have been run since and have passed.

    Raises:
        CheckError: if it is not so.
    """
    package = _package(WORKSHOP, "battery")
    _check_charges(package)
    passed = _passed_tests(course.student_path(WORKSHOP) / "build" / "battery", package)
    if passed < TESTS:
        raise CheckError(
            f"{TESTS} tests of battery that have passed",
            f"{passed} that {'has' if passed == 1 else 'have'}",
            "run colcon test again; no test may be taken away or skipped.",
        )
    return "Right: the function is mended, and its tests say so."


quiz = quiz_of(__name__, QUIZ)


def _needs(workspace: str) -> dict[str, set[str]]:
    """Return for each package of a workspace those of its other packages that it needs."""
    source = course.student_path(workspace) / "src"
    try:
        packages = find_packages(str(source), warnings=[]).values()
    except InvalidPackage as error:
        raise CheckError(
            "package.xml files that can be read", str(error), "run the cell that makes them."
        ) from error
    names = {str(package.name) for package in packages}
    if not names:
        raise CheckError(
            f"packages in {workspace}/src", "none", "run the cells at the beginning, which make them."
        )
    return {
        str(package.name): names
        & {dependency.name for dependency in package.build_depends + package.exec_depends}
        for package in packages
    }


def _package(workspace: str, name: str) -> Path:
    """Return the folder of a package in a workspace."""
    folder = course.student_path(workspace) / "src" / name
    if not (folder / name).is_dir():
        raise CheckError(
            f"the package {course.shown_path(folder)}", "nothing there", "run the cell that makes it."
        )
    return folder


def _selected(options: str) -> set[str]:
    """Return the names of the packages of the harbour that `colcon build` with these options builds."""
    try:
        words = [word for word in shlex.split(str(options)) if word not in _OTHER_OPTIONS]
    except ValueError as error:
        raise CheckError("options as in a shell", f"{options!r}: {error}", "is each quote closed?") from error
    if words[:2] == ["colcon", "build"]:
        words = words[2:]
    command = ["colcon", "--log-base", "/dev/null", "list", "--names-only", *words]
    listed = run(command, "`colcon list`", folder=course.student_path(HARBOUR))
    if listed.returncode:
        raise CheckError(
            "options that colcon understands",
            f"{options!r}: {last_line(listed.stderr)}",
            "write them as after colcon build in a terminal.",
        )
    return set(listed.stdout.split())


def _check_charges(package: Path) -> None:
    """Check what the function of the battery returns."""
    voltages = [volts for volts, _ in CHARGES]
    program = f"import battery.charge as c, json; print(json.dumps([c.percent(v) for v in {voltages}], default=float))"
    called = _run_source(program, package)
    if called.returncode:
        raise CheckError(
            "percent() returns a number for every voltage",
            last_line(called.stderr),
            "read the last line of the error.",
        )
    for (volts, expected), found in zip(CHARGES, json.loads(last_line(called.stdout)), strict=True):
        if found is None:
            raise CheckError(f"percent({volts}) is {expected:g}", "None", "the function needs a return.")
        if not isinstance(found, (int, float)) or abs(found - expected) > 1e-6:
            raise CheckError(
                f"percent({volts}) is {expected:g}",
                repr(found),
                "the range is from 10 V to 12 V, and what is below counts as empty.",
                "max(a, b) is the larger one of two numbers.",
            )


def _passed_tests(results: Path, package: Path) -> int:
    """Return how many tests have passed when colcon ran them last; 0 if the code has changed since."""
    report = results / "pytest.xml"
    tests = count_tests(report)
    sources = [*package.glob("battery/*.py"), *package.glob("test/*.py")]
    if tests is None or any(source.stat().st_mtime > report.stat().st_mtime for source in sources):
        return 0
    return tests["passed"]


def _run_source(program: str, package: Path) -> subprocess.CompletedProcess[str]:
    """Run a line of Python where it imports a package's source, which gets no bytecode beside it."""
    environ = {**environment.lab_environment(), "PYTHONDONTWRITEBYTECODE": "1"}
    return run(
        [sys.executable, "-c", program], f"the source of {package.name}", folder=package, environ=environ
    )
