"""The exercises of `03_packages`, and the broken package that one of them fixes."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from pathlib import PurePath

from catkin_pkg.package import Package

from ros2lab import course
from ros2lab.checks import CheckError, exercise, predict_of, questions_of, quiz_of
from ros2lab.checks.manifests import manifest_of, names_in_export
from ros2lab.checks.programs import check_runs, create_package
from ros2lab.manifest_words import describes
from ros2lab.workspace import Workspace

WORKSPACE = "~/packages_ws"

LOST_FILES = ("resource/lamp_driver", "setup.cfg", "lamp_driver/__init__.py")
NEEDED = ("rclpy", "sensor_msgs")  # by weather_station
LAMP = "def main():\n    print('The lamp is on.')\n"


@exercise
def manifest() -> str:
    """Check that `weather_station/package.xml` is valid and says what the task asks for.

    Raises:
        CheckError: if something in it is missing or wrong.
    """
    found = manifest_of(course.student_path(f"{WORKSPACE}/src/weather_station"))
    _check_package("weather_station", found)
    if not describes(found.description, found.name):
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


QUIZ, PREDICTIONS = questions_of(__name__)
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
