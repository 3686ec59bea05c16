"""The exercises of `03_packages`, and the broken package that one of them fixes."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from pathlib import PurePath

from catkin_pkg.package import Package

from ros2lab import course
from ros2lab.checks import CheckError, Prediction, Question, exercise, predict_of, quiz_of
from ros2lab.checks.manifests import manifest_of, names_in_export
from ros2lab.checks.programs import check_runs, create_package
from ros2lab.workspace import Workspace

WORKSPACE = "~/packages_ws"

LOST_FILES = ("resource/lamp_driver", "setup.cfg", "lamp_driver/__init__.py")
NEEDED = ("rclpy", "sensor_msgs")  # by weather_station
LAMP = "def main():\n    print('The lamp is on.')\n"

QUIZ = (
    Question(
        (
            "Which entry point lets `ros2 run robot_arm wave` call the function `start` in "
            "`robot_arm/hand.py`?"
        ),
        (
            "`wave = robot_arm.hand:start`",
            "`start = robot_arm.wave:hand`",
            "`wave = robot_arm/hand.py:start`",
        ),
        "a",
        "an entry point is `executable = package.module:function`.",
        {
            "b": "what stands before the equals sign is what you type after `ros2 run` and the package.",
            "c": "a path with slashes is for the shell; Python's modules are named with dots.",
        },
    ),
    Question(
        (
            "The build succeeds, `ros2 pkg list` shows the package, and `ros2 run` says `No executable "
            "found`. Which file is missing?"
        ),
        ("the resource marker", "`setup.cfg`", "`__init__.py`"),
        "b",
        "without setup.cfg the executable is built, but lies where `ros2 run` does not look.",
        {
            "a": "the package was listed, so its marker was found.",
            "c": "a missing __init__.py lets the executable start, and then fail to import.",
        },
    ),
    Question(
        "A `package.xml` has no `<license>`. What does colcon do?",
        ("It adds one.", "It stops with an error.", "It warns, and takes the folder for plain Python."),
        "c",
        "colcon warned, took the folder for plain Python, and went on.",
        {
            "b": "look again at what `colcon list` showed in brackets, and whether it ended with an error.",
            "a": "nothing of package.xml is ever repaired for you.",
        },
    ),
    Question(
        "`config/robot.yaml` is to be installed. Where is it named?",
        ("In `data_files` of `setup.py`.", "Nowhere: colcon copies the whole package.", "In `package.xml`."),
        "a",
        "data_files names what is copied to share/; everything else stays in src/.",
        {
            "b": "you saw that folder in src/, and not in install/.",
            "c": "package.xml names other packages, not files of this one.",
        },
    ),
)

PREDICTIONS = {
    "how_many_files": Prediction(
        "How many files will it have?",
        ("1 or 2", "about 4", "9", "more than 20"),
        "c",
        "Nine files: the command names eight of them, and the ninth is `LICENSE`.",
    ),
    "dependencies_option": Prediction(
        "Which files does this option change?",
        ("only `package.xml`", "`package.xml` and `setup.py`", "all files"),
        "a",
        "Only `package.xml` differs: it has one line more for each dependency.",
    ),
    "node_name_option": Prediction(
        "What does this option add?",
        (
            "only a file `my_node.py`",
            "only a line in `setup.py`",
            "a file `my_node.py`, and a line in `setup.py`",
        ),
        "c",
        "A file `my_node.py` with a function `main`, and a line in `setup.py` that names it.",
    ),
    "marker_gone": Prediction(
        "Can anything depend on an empty file? Does `ros2 run` still find the program?",
        (
            "yes: it looks for the program itself",
            "no: it does not even find the package",
            "it finds the package, but no executable in it",
        ),
        "b",
        (
            "The program is there and runs when it is called by its path, but to `ros2` there is no "
            "such package."
        ),
    ),
    "marker_not_in_src": Prediction(
        "Does the build notice?",
        ("no: it succeeds", "it warns, and succeeds", "it fails"),
        "c",
        "The build fails, because `setup.py` tells it to install this file.",
    ),
    "no_setup_py": Prediction(
        "Does `colcon list` still find a package? Can colcon build it?",
        (
            "it finds none, and builds nothing",
            "it finds one, and cannot build it",
            "it finds one, and builds it",
        ),
        "b",
        (
            "It is still a package, because `package.xml` says so; but it cannot be built, because for "
            "`ament_python` `setup.py` is the build."
        ),
    ),
    "no_setup_cfg": Prediction(
        "Does the build fail this time?",
        ("yes, with an error", "it succeeds, with a warning", "it succeeds, without a word"),
        "c",
        "It succeeds without a word.",
    ),
    "no_init": Prediction(
        "An empty file again. Who notices: the build, or Python?",
        ("the build", "Python, when the program starts", "nobody"),
        "b",
        "The build is content again; Python will notice.",
    ),
    "no_package_xml": Prediction(
        "Without `package.xml`, is the folder still a package for colcon?",
        ("no", "yes, and nothing changes", "yes, but of another type"),
        "c",
        "It is, but of another kind: not `ros.ament_python` but only `python`.",
    ),
    "no_tests": Prediction(
        "Who misses the tests?",
        ("`colcon build`", "`colcon test`", "nobody"),
        "c",
        "Nobody: `0 tests, 0 errors, 0 failures`.",
    ),
    "depend_tag": Prediction(
        (
            "`rclpy` stands there once, as `<depend>`. Does it count as needed for building, for "
            "running, or for both?"
        ),
        ("for building", "for running", "for both"),
        "c",
        "For both: `<depend>` is the short way to say it.",
    ),
    "no_license": Prediction(
        "At which of the four does it fail?",
        ("at `colcon list`", "at the build", "when the workspace is sourced", "at `ros2 run`"),
        "d",
        (
            "Only at the last one. colcon warns twice, takes the folder for `(python)`, and builds that"
            " without an error; `ros2` does not find it."
        ),
    ),
    "misspelt_type": Prediction(
        "What does colcon build now?",
        (
            "the package, as before",
            "the package, as plain Python",
            "nothing, and there is an error",
            "nothing, and there is no error",
        ),
        "d",
        (
            "`0 packages finished`, and no error: nothing knows how to build a `ros.ament_pyton`, so it"
            " was left out."
        ),
    ),
    "entry_without_function": Prediction(
        "Does the build fail? Will it install the new file?",
        (
            "it fails, and installs nothing",
            "it succeeds, and installs the file",
            "it succeeds, and does not install the file",
        ),
        "c",
        (
            "It does not fail: an entry point is a promise, and nobody looks whether it holds until the"
            " executable is started. `find` finds nothing: what `data_files` does not name stays in "
            "`src/`."
        ),
    ),
}


@exercise
def manifest() -> str:
    """Check that `weather_station/package.xml` is valid and says what the task asks for.

    Raises:
        CheckError: if something in it is missing or wrong.
    """
    found = manifest_of(course.student_path(f"{WORKSPACE}/src/weather_station"))
    _check_package("weather_station", found)
    if "TODO" in found.description or not found.description.strip():
        raise CheckError(
            "a description of your own",
            repr(found.description),
            "write between <description> and </description> in a sentence what the package does.",
        )
    if not any(name.strip().upper().startswith("MIT") for name in found.licenses):
        raise CheckError(
            "the licence MIT",
            ", ".join(map(repr, found.licenses)),
            "write MIT between <license> and </license>.",
        )
    for name in NEEDED:
        _check_needed(name, found)
    return "Right: the tools can read it, and it says all that they need."


@exercise
def entry_point() -> str:
    """Check that `ros2 run battery_monitor charge` calls the function.

    Raises:
        CheckError: if it does not.
    """
    check_runs(
        Workspace(course.student_path(WORKSPACE)),
        "battery_monitor",
        "charge",
        "Battery:",
        "write 'charge = battery_monitor.gauge:show_charge' into the list console_scripts: the executable, then the "
        "package, the file without .py, and the function.",
    )
    return "Right: `ros2 run` finds your executable, and it calls the function."


@exercise
def missing(*files: str | PurePath | Iterable[str]) -> str:
    """Check that `files` are the three that `lamp_driver` has lost.

    Args:
        files: as paths inside the package; their order does not matter.

    Raises:
        CheckError: if there are others, or not all.
    """
    named = {_canonical(str(name)) for given in files for name in _each(given)}
    for name in sorted(named.difference(LOST_FILES)):
        raise CheckError("only files that lamp_driver has lost", name, _why_not_lost(name))
    if len(named) < len(LOST_FILES):
        raise CheckError(
            f"{len(LOST_FILES)} files",
            ", ".join(sorted(named)) or "no file",
            "look at the two trees: what does my_robot_controller have that lamp_driver has not?",
            "they are the first three that you took away from my_robot_controller in `src`, setup.py left out.",
        )
    return "Right: these three are missing."


@exercise
def lamp_driver() -> str:
    """Check that the fixed package is built and runs.

    Raises:
        CheckError: if it is not, or does not.
    """
    check_runs(
        Workspace(course.student_path(WORKSPACE)),
        "lamp_driver",
        "lamp",
        "The lamp is on.",
        "build it, and read the first line that begins with `error`; then run it: each fix may show the next fault.",
    )
    return "Right: the package is whole again."


quiz = quiz_of(__name__, QUIZ)
predict = predict_of(__name__, PREDICTIONS)


def make_broken_package() -> str:
    """Make `lamp_driver`, a package that has lost three files; one that is there already stays as it is.

    Raises:
        OSError: if a file cannot be written.
        subprocess.CalledProcessError: if `ros2 pkg create` fails.
    """
    source = course.student_path(f"{WORKSPACE}/src")
    is_new = not (source / "lamp_driver").exists()
    folder = create_package(source, "lamp_driver", {"lamp_driver/lamp.py": LAMP}, "--node-name", "lamp")
    for name in LOST_FILES if is_new else ():
        (folder / name).unlink()
    return f"{course.shown_path(folder)} is there, and something is wrong with it."


def _check_package(name: str, found: Package) -> None:
    """Check what `ros2 pkg create` wrote and the task leaves alone."""
    for what, expected, is_now in (
        ("<name>", name, found.name),
        ("format", 3, found.package_format),
        ("<build_type>", "ament_python", found.get_build_type()),
    ):
        if is_now != expected:
            raise CheckError(
                f"the {what} that `ros2 pkg create` wrote, {expected}",
                str(is_now),
                f"the task leaves it alone: write {expected} again.",
            )


def _check_needed(name: str, found: Package) -> None:
    """Check that a dependency is declared for building and for running."""
    to_build, to_run = (
        {dependency.name for dependency in needed} for needed in (found.build_depends, found.exec_depends)
    )
    if name in to_build & to_run:
        return
    expected = f"{name} is declared for building and for running"
    if name in to_build | to_run:
        raise CheckError(
            expected,
            f"only for {'building' if name in to_build else 'running'}",
            f"<depend>{name}</depend> stands for both times.",
        )
    if name in {dependency.name for dependency in found.test_depends}:
        raise CheckError(
            expected, "only for testing", f"write <depend>{name}</depend>, which stands for both times."
        )
    if name in names_in_export(found):
        raise CheckError(
            expected, "its line stands in <export>", "move the line up, so that it stands before <export>."
        )
    declared = sorted(to_build | to_run)
    near = difflib.get_close_matches(name, [other for other in declared if other not in NEEDED], n=1)
    raise CheckError(
        expected,
        f"declared are {', '.join(declared)}" if declared else "nothing is declared",
        f"{near[0]} is not the name that is asked for: write {name}."
        if near
        else f"write <depend>{name}</depend> in a line of its own, between <license> and <export>.",
    )


def _why_not_lost(name: str) -> str:
    """Return why a name is not one of the lost files."""
    folder = course.student_path(f"{WORKSPACE}/src/lamp_driver")
    if (folder / name).is_dir():
        return f"{name} is a folder, and it is there: which file is missing in it?"
    if (folder / name).exists():
        return f"lamp_driver has {name}: look at its tree again."
    if name.startswith("resource/"):
        return "the marker has the name of its own package."
    return f"a package can do without {name}: does my_robot_controller have it?"


def _each(given: object) -> Iterable[object]:
    return given if isinstance(given, (list, tuple, set)) else (given,)


def _canonical(name: str) -> str:
    """Return the lost file that is meant, however its path is written; the name itself if none is."""
    path = name.strip().rstrip("/").removeprefix("./")
    short = {"__init__.py": LOST_FILES[2], "setup.cfg": LOST_FILES[1]}
    for lost in LOST_FILES:
        if path == lost or path.endswith(f"/lamp_driver/{lost}") or path == f"lamp_driver/{lost}":
            return lost
    return short.get(path, path)
