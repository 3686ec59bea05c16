"""The exercises of `03_packages`, and the broken package that one of them mends."""

from __future__ import annotations

import subprocess
from collections.abc import Iterable
from pathlib import Path, PurePath

from catkin_pkg.package import InvalidPackage, Package, parse_package

from ros2lab import course, environment
from ros2lab.checks import CheckError, Question, exercise, quiz_of
from ros2lab.checks.programs import overlay_of, run
from ros2lab.node_process import last_line
from ros2lab.workspace import Workspace

WORKSPACE = "~/packages_ws"

LOST_FILES = ("resource/lamp_driver", "setup.cfg", "lamp_driver/__init__.py")
LAMP = "def main():\n    print('The lamp is on.')\n"

QUIZ = (
    Question(
        "a",
        "an entry point is `executable = package.module:function`.",
        {
            "b": "what stands before the equals sign is what you type after `ros2 run` and the package.",
            "c": "a path with slashes is for the shell; Python's modules are named with dots.",
        },
    ),
    Question(
        "b",
        "without setup.cfg the executable is built, but lies where `ros2 run` does not look.",
        {
            "a": "the package was listed, so its marker was found.",
            "c": "a missing __init__.py lets the executable start, and then fail to import.",
        },
    ),
    Question(
        "c",
        "colcon warned, took the folder for plain Python, and went on.",
        {
            "b": "look again at what `colcon list` showed in brackets, and whether it ended with an error.",
            "a": "nothing of package.xml is ever repaired for you.",
        },
    ),
    Question(
        "a",
        "data_files names what is copied to share/; everything else stays in src/.",
        {
            "b": "you saw that folder in src/, and not in install/.",
            "c": "package.xml names other packages, not files of this one.",
        },
    ),
)


@exercise
def manifest() -> str:
    """Check that `weather_station/package.xml` is valid and says what the task asks for.

    Raises:
        CheckError: if something in it is missing.
    """
    found = _manifest("weather_station")
    if "TODO" in found.description or not found.description.strip():
        raise CheckError(
            "a description of your own", repr(found.description), "say in a sentence what it does."
        )
    if not found.licenses or any("TODO" in name for name in found.licenses):
        raise CheckError(
            "a licence", ", ".join(map(repr, found.licenses)), "a short name, such as MIT or Apache-2.0."
        )
    needed = {dependency.name for dependency in found.exec_depends}
    missing = [name for name in ("rclpy", "sensor_msgs") if name not in needed]
    if missing:
        raise CheckError(
            "rclpy and sensor_msgs are there when the package runs",
            f"{missing[0]} is not among what it needs to run ({', '.join(sorted(needed)) or 'nothing'})",
            "is each name spelt right, and each tag closed?",
            "<depend> counts for building and for running; a <build_depend> alone does not.",
            "one line for each, between <license> and <export>: how does my_robot_controller name them?",
        )
    if found.package_format != 3 or found.get_build_type() != "ament_python":
        raise CheckError(
            "format 3 and the build type ament_python",
            f"format {found.package_format} and {found.get_build_type()}",
            "leave the first lines and <export> as `ros2 pkg create` wrote them.",
        )
    return "Right: the tools can read it, and it says all that they need."


@exercise
def entry_point() -> str:
    """Check that `ros2 run battery_monitor charge` calls the function.

    Raises:
        CheckError: if it does not.
    """
    _check_runs(
        "battery_monitor",
        "charge",
        "Battery:",
        "is there a line for charge in console_scripts, and was the package built after that?",
        "an entry point reads executable = package.module:function.",
        "the package is battery_monitor, the module is the file gauge.py without .py, and the function is in it.",
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
    wrong = sorted(named - set(LOST_FILES))
    if wrong or len(named) != len(LOST_FILES):
        raise CheckError(
            "the three files that are missing",
            f"{wrong[0]} is not one of them" if wrong else f"you have {len(named)} of {len(LOST_FILES)}",
            "compare the two trees: what does my_robot_controller have that lamp_driver has not?",
            "the three that you took away from my_robot_controller before package.xml.",
        )
    return "Right: these three are missing."


@exercise
def lamp_driver() -> str:
    """Check that the mended package is built and runs.

    Raises:
        CheckError: if it is not, or does not.
    """
    _check_runs(
        "lamp_driver",
        "lamp",
        "The lamp is on.",
        "build it, and read the first line that begins with `error`; then run it. Each mend may show the next fault.",
        "`No executable found` speaks of setup.cfg, `No module named` of __init__.py, `can't copy` of the marker.",
        "two of the files are empty, and `touch` makes them; the third one has four lines with the package's name.",
    )
    return "Right: the package is whole again."


quiz = quiz_of(__name__, QUIZ)


def make_broken_package() -> str:
    """Make `lamp_driver`, a package that has lost three files; one that is there already stays as it is.

    Raises:
        OSError: if a file cannot be written.
        subprocess.CalledProcessError: if `ros2 pkg create` fails.
    """
    folder = course.student_path(f"{WORKSPACE}/src/lamp_driver")
    if not folder.exists():
        folder.parent.mkdir(parents=True, exist_ok=True)
        command = ["ros2", "pkg", "create", "lamp_driver", "--build-type", "ament_python"]
        command += ["--node-name", "lamp", "--license", "Apache-2.0"]
        command += ["--maintainer-name", "Ada Lovelace", "--maintainer-email", "ada@example.org"]
        environ = environment.lab_environment()
        subprocess.run(command, cwd=folder.parent, env=environ, check=True, capture_output=True)
        (folder / "lamp_driver" / "lamp.py").write_text(LAMP, encoding="utf-8")
        for name in LOST_FILES:
            (folder / name).unlink()
    return f"{course.shown_path(folder)} is there, and something is wrong with it."


def _manifest(package: str) -> Package:
    file = course.student_path(f"{WORKSPACE}/src/{package}/package.xml")
    try:
        return parse_package(str(file), warnings=[])
    except (InvalidPackage, OSError) as error:
        lines = [line.strip() for line in str(error).splitlines() if line.strip()]
        raise CheckError(
            f"a package.xml that can be read in {course.shown_path(file.parent)}",
            " ".join(lines[1:] or lines),
            "each tag that opens must close, and name, version, description, maintainer and license must be there.",
        ) from error


def _check_runs(package: str, executable: str, words: str, *hints: str) -> None:
    """Check that an executable of the workspace is installed, ends well, and prints some words."""
    workspace = Workspace(course.student_path(WORKSPACE))
    expected = f"`ros2 run {package} {executable}` runs"
    if executable not in [known.name for known in workspace.executables(package)]:
        raise CheckError(expected, _why_absent(workspace.path, package), *hints)
    name = f"`ros2 run {package} {executable}`"
    finished = run(["ros2", "run", package, executable], name, environ=overlay_of(workspace))
    output = finished.stdout + finished.stderr
    if finished.returncode or words not in output:
        said = last_line(output)
        raise CheckError(
            f"{expected} and prints {words!r}", repr(said) if said else "it prints nothing", *hints
        )


def _why_absent(workspace: Path, package: str) -> str:
    prefix = workspace / "install" / package
    if not (workspace / "src" / package).is_dir():
        return f"no package {package} in {course.shown_path(workspace)}/src"
    if not (prefix / "share").is_dir():
        return f"{package} is not built"
    return (
        f"the built {package} has no such executable where `ros2 run` looks, install/{package}/lib/{package}"
    )


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
