"""The exercises of `05_colcon`."""

from __future__ import annotations

import inspect
import json
import shlex
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from catkin_pkg.package import InvalidPackage
from catkin_pkg.packages import find_packages

from ros2lab import course, environment
from ros2lab.checks import CheckError, answer_of, exercise, predict_of, questions_of, quiz_of
from ros2lab.checks.built import built_executable
from ros2lab.checks.programs import TestCase, overlay_of, read_tests, run
from ros2lab.hand_in import GENERATED_TESTS
from ros2lab.manifest_words import NOT_TAKEN
from ros2lab.node_process import last_line
from ros2lab.scratch import scratch_folder
from ros2lab.workspace import Workspace

HARBOUR = "~/harbour_ws"
WORKSHOP = "~/workshop_ws"

# What is to be selected in each case, and what is said of another selection.
SELECTIONS = (
    (
        {"crane_app", "crane_driver", "harbour_map", "load_model"},
        "nothing is built yet: crane_app, and all that it needs, directly or not.",
    ),
    ({"crane_driver"}, "all the others are built, and still right."),
    (
        {"load_model", "crane_driver", "crane_app"},
        "look the other way: who needs load_model, directly or not?",
    ),
)
# `colcon build` up to where it would begin: it prints the packages.
SELECT = """
import sys
import colcon_core.verb.build
from colcon_core.command import main

def show(context, jobs, **_):
    print(*jobs, sep="\\n")
    return 0

colcon_core.verb.build.execute_jobs = show
folder, *options = sys.argv[1:]
bases = ["--build-base", f"{folder}/build", "--install-base", f"{folder}/install"]
sys.argv[0] = "colcon"
sys.exit(main(argv=["--log-base", "/dev/null", "build", *bases, *options]))
"""

OLD_SOUND = "Hi from horn."

# Volts, and how full the battery then is, in percent.
CHARGES = (
    (12.0, 100.0),
    (11.0, 50.0),
    (9.5, 0.0),
    (12.5, 100.0),
    (11.5, 75.0),
    (10.0, 0.0),
    (2.0, 0.0),
    (13.0, 100.0),
)


def _right(volts: float) -> float:
    return max(0, min(100, (volts - 10) * 50))


def _less_than_empty(volts: float) -> float:
    return min(100, (volts - 10) * 50)


def _more_than_full(volts: float) -> float:
    return max(0, (volts - 10) * 50)


def _empty_if_more_than_full(volts: float) -> float:
    return 0 if volts > 12 else max(0, (volts - 10) * 50)


# What tests have to notice: a function, where it is wrong, and the given test that notices it.
FAULTS = (
    (_less_than_empty, 9.5, "test_less_than_empty_is_empty"),
    (_more_than_full, 12.5, ""),
    (_empty_if_more_than_full, 12.5, ""),
)
GIVEN_TESTS = 3  # of the package battery


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
            "It returns nothing: write return [...] with the five names."
            if answer is None
            else 'Write a list, with each name in quotes of its own: return ["...", "..."].',
        )
    order = [str(name) for name in answer]
    _check_names(order, needs)
    for number, name in enumerate(order):
        late = sorted(needs[name].difference(order[:number]))
        if late:
            needed = " and ".join(late)
            raise CheckError(
                "each package after all that it needs",
                f"{name} first, and it needs {needed}"
                if number == 0
                else f"{name} before {needed}, which it needs",
                "Begin with a package that needs no other; then take one that comes after all that it needs.",
                f"{name} needs {needed}: look at the arrows, or ask colcon list --topological-order.",
            )
    return "Right: each package comes after those that it needs."


@exercise
def selections(*options: str) -> str:
    """Check with colcon that the options select the packages that are asked for.

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
            'Write them in quotes, with commas between them, such as "--packages-select ship_pilot".',
        )
    with ThreadPoolExecutor() as pool:
        found = list(pool.map(_selected, options))
    for number, ((expected, hint), (names, warnings)) in enumerate(zip(SELECTIONS, found, strict=True), 1):
        if names != expected:
            raise CheckError(
                f"case {number} builds {len(expected)} package{'s' * (len(expected) > 1)}, the right ones",
                (", ".join(sorted(names)) or "no package")
                + (f"; colcon warns: {warnings}" if warnings else ""),
                "Compare the name with those that colcon list shows."
                if warnings
                else f"{hint[0].upper()}{hint[1:]}",
                f"It builds {', '.join(sorted(expected))}: look at the table of options.",
            )
    return "Right: no package too many, and none too few."


@exercise
def edit_takes_effect() -> str:
    """Check that `ros2 run horn blow` prints what the edited source prints.

    Raises:
        CheckError: if it does not, or the edit is not there any more.
    """
    package = _package(WORKSHOP, "horn")
    place = "src/horn/horn/blow.py"
    source = _run_source("import horn.blow; horn.blow.main()", package)
    if source.returncode:
        raise CheckError(
            f"{place} runs",
            last_line(source.stderr),
            f"Python names the line in {place}, where it defines main.",
        )
    said = source.stdout.strip()
    if said in ("", OLD_SOUND):
        raise CheckError(
            f"{place} prints something new",
            repr(said) if said else "it prints nothing",
            f"The edit has to stand in {place}, and main has to print it; then the build follows.",
        )
    workspace = Workspace(package.parents[1])
    built_executable(workspace, "horn", "blow")
    built = run(["ros2", "run", "horn", "blow"], "`ros2 run horn blow`", environ=overlay_of(workspace))
    if built.returncode or built.stdout != source.stdout:
        raise CheckError(
            f"`ros2 run horn blow` prints {said!r}, as the source does",
            repr(built.stdout.strip() or last_line(built.stderr) or "nothing"),
            f"What runs is in install/: type `cd {WORKSHOP}`, then `colcon build --packages-select horn`.",
        )
    return "Right: what runs is what you have written."


@exercise
def own_test() -> str:
    """Check that the tests of the battery notice a battery that is more than full, and one that is less than empty.

    Raises:
        CheckError: if they pass for a function with such a fault, or fail for a right one.
    """
    count = _check_tests(_package(WORKSHOP, "battery"))
    return f"Right: your {count} tests pass for a right function, and notice {len(FAULTS)} wrong ones."


@exercise
def fixed_test() -> str:
    """Check that the battery is from 0 to 100 % full, and that its tests have been run since and have passed.

    Raises:
        CheckError: if it is not so.
    """
    package = _package(WORKSHOP, "battery")
    _check_charges(package)
    _check_tests(package)
    _check_last_run(course.student_path(WORKSHOP) / "build" / "battery" / "pytest.xml", package)
    return "Right: the function is fixed, and its tests say so."


QUIZ, PREDICTIONS = questions_of(__name__)
quiz = quiz_of(__name__, QUIZ)
predict = predict_of(__name__, PREDICTIONS)


def _check_names(order: Sequence[str], needs: Mapping[str, Any]) -> None:
    """Check that each package is named once."""
    expected = f"each of {', '.join(sorted(needs))} once"
    for name, count in Counter(order).items():
        if name not in needs:
            near = get_close_matches(name, needs, 1, 0.8)
            hint = f"Is {near[0]} meant?" if near else "colcon list shows the packages of this workspace."
            raise CheckError(expected, f"{name} is no package of {HARBOUR}", hint)
        if count > 1:
            raise CheckError(expected, f"{name} is there {count} times", "Each package is built once.")
    missing = sorted(set(needs).difference(order))
    if missing:
        is_are = "is" if len(missing) == 1 else "are"
        raise CheckError(
            expected, f"{' and '.join(missing)} {is_are} missing", "All five packages are to be built."
        )


def _needs(workspace: str) -> dict[str, set[str]]:
    """Return for each package of a workspace those of its other packages that it needs."""
    source = course.student_path(workspace) / "src"
    try:
        packages = find_packages(str(source), warnings=[]).values()
    except (InvalidPackage, *NOT_TAKEN) as error:
        raise CheckError(
            "package.xml files that can be read", str(error), "Run the cell that makes them."
        ) from error
    names = {str(package.name) for package in packages}
    if not names:
        raise CheckError(
            f"packages in {workspace}/src", "none", "Run the cells at the beginning, which make them."
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
            f"the package {course.shown_path(folder)}", "nothing there", "Run the cell that makes it."
        )
    return folder


def _selected(options: str) -> tuple[set[str], str]:
    """Return which packages of the harbour `colcon build` with these options builds, and what it warns of."""
    try:
        words = shlex.split(str(options))
    except ValueError as error:
        raise CheckError("options as in a shell", f"{options!r}: {error}", "Is each quote closed?") from error
    if words[:2] == ["colcon", "build"]:
        words = words[2:]
    with scratch_folder() as folder:
        asked = run(
            [sys.executable, "-c", SELECT, folder, *words], "colcon", folder=course.student_path(HARBOUR)
        )
    if asked.returncode:
        said = last_line(asked.stderr)
        raise CheckError(
            "options that colcon understands",
            f"{options!r}: {said}",
            "Compare it with the table of options: an option is written exactly so, and a name follows it."
            if "unrecognized arguments" in said
            else "Read what colcon says: a name follows the option, one that colcon list shows.",
        )
    marked = (line.partition("WARNING:")[2] for line in asked.stderr.splitlines())
    warnings = "; ".join(line.partition(":")[2] for line in marked if "package_selection" in line)
    return set(asked.stdout.split()), warnings


def _check_charges(package: Path) -> None:
    """Check what the function of the battery returns."""
    voltages = [volts for volts, _ in CHARGES]
    program = f"import battery.charge as c, json; print(json.dumps([c.percent(v) for v in {voltages}], default=float))"
    called = _run_source(program, package)
    if called.returncode:
        raise CheckError(
            "percent() returns a number for every voltage",
            last_line(called.stderr),
            "That is the last line of the error: it names what is wrong in charge.py.",
        )
    for (volts, expected), found in zip(CHARGES, json.loads(last_line(called.stdout)), strict=True):
        if found is None:
            raise CheckError(
                f"percent({volts}) is {expected:g}", "None", "The function computes, and does not return it."
            )
        is_number = isinstance(found, (int, float))
        if not is_number or abs(found - expected) > 1e-6:
            shown = f"{found:g}" if is_number else repr(found)
            raise CheckError(f"percent({volts}) is {expected:g}", shown, _charge_hint(volts, found))


def _charge_hint(volts: float, found: Any) -> str:
    if volts < 10:
        if isinstance(found, (int, float)) and found > 0:
            return "All that is below 10 V counts as 0: the distance from 10 V does not matter there."
        return (
            "All that is below 10 V counts as 0, for every voltage: max(a, b) is the larger of two numbers."
        )
    if volts > 12:
        return "All that is above 12 V counts as 100, for every voltage: min(a, b) is the smaller of two numbers."
    return "Between the ends it grows evenly: from 10 V to 12 V by 50 percent for each volt."


def _check_tests(package: Path) -> int:
    """Check that the tests of the battery tell a right function from a wrong one; return how many there are."""
    functions = [_right, *(function for function, _, _ in FAULTS)]
    with ThreadPoolExecutor() as pool:
        right, *faulty = pool.map(lambda function: _tests_of(package, function), functions)
    expected = "tests that pass for a right function, and fail for a wrong one"
    for test in [test for tests in (right, *faulty) for test in tests]:
        if test.outcome == "skipped":
            raise CheckError(
                expected,
                f"{test.name} is skipped",
                "Take the mark above it away: skip and xfail hide a test.",
            )
    for test in right:
        if test.outcome == "failed":
            raise CheckError(
                expected,
                f"{test.name} fails for a right function, too: {test.message}",
                "Expect what a right function returns: for 9.5 V that is 0, because no battery is less than empty."
                if test.message.startswith(("assert", "AssertionError"))
                else f"It fails for another reason than the charge: look at test/{test.module}.py.",
            )
    for (function, volts, name), tests in zip(FAULTS, faulty, strict=True):
        if all(test.outcome == "passed" for test in tests):
            raise CheckError(
                expected,
                f"{len(right)} tests, and all pass for a function that returns {function(volts):g} for {volts} V",
                *_hints_for_a_test(name, len(right)),
            )
    return len(right)


def _hints_for_a_test(name: str, count: int) -> tuple[str, ...]:
    if name:
        return (f"A test was there for this: put {name} back, with assert percent(9.5) == 0.",)
    if count <= GIVEN_TESTS:
        return (
            "The new test is a function whose name begins with test_, in a file test_*.py: pytest finds no others.",
        )
    return (
        "The new test calls percent of battery.charge, and asserts with == the one number that is right.",
        "It looks as test_less_than_empty_is_empty does, with 12.5 V and the charge of a full battery.",
    )


def _tests_of(package: Path, function: Callable[[float], float]) -> list[TestCase]:
    """Run a copy of the battery's tests on this function instead of the student's."""
    with scratch_folder() as folder:
        copy = shutil.copytree(
            package,
            folder / package.name,
            ignore=shutil.ignore_patterns("__pycache__", ".pytest_cache"),
        )
        source = f"{inspect.getsource(function)}\n\npercent = {function.__name__}\n"
        (copy / "battery" / "charge.py").write_text(source, encoding="utf-8")
        report = Path(folder) / "report.xml"
        command = [
            sys.executable,
            "-m",
            "pytest",
            "-q",
            "-p",
            "no:cacheprovider",
            f"--junit-xml={report}",
            "test",
        ]
        # Plugins, the lab's own among them, are slow to import, and these tests need none.
        environ = {**environment.lab_environment(), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
        run(command, "pytest", folder=copy, environ=environ)
        return read_tests(report, except_of=GENERATED_TESTS) or []


def _check_last_run(report: Path, package: Path) -> None:
    """Check what colcon said of the battery's tests last, and that neither they nor the function changed since."""
    expected = "a run of `colcon test` in which all tests of the battery pass"
    again = f"Type `cd {WORKSHOP}`, then `colcon test --packages-select battery`."
    tests = read_tests(report, except_of=GENERATED_TESTS)
    if tests is None:
        raise CheckError(expected, f"no report in {course.shown_path(report)}", again)
    sources = sorted([*package.glob("battery/*.py"), *package.glob("test/*.py")])
    for source in sources:
        if source.stat().st_mtime > report.stat().st_mtime:
            raise CheckError(expected, f"{source.name} was changed after colcon test ran last", again)
    for test in tests:
        if test.outcome != "passed":
            raise CheckError(expected, f"{test.name} has {test.outcome}: {test.message}", again)


def _run_source(program: str, package: Path) -> subprocess.CompletedProcess[str]:
    """Run a line of Python where it imports a package's source, which gets no bytecode beside it."""
    environ = {**environment.lab_environment(), "PYTHONDONTWRITEBYTECODE": "1"}
    return run(
        [sys.executable, "-c", program], f"the source of {package.name}", folder=package, environ=environ
    )
