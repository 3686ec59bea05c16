"""The exercises of `06_dependencies`."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from catkin_pkg.package import InvalidPackage, parse_package, parse_package_string

from ros2lab import course
from ros2lab.checks import CheckError, Question, answer_of, exercise, quiz_of

SURVEY = "~/survey_ws/src"

# For each name its right tags, and what is said of another one.
TAGS = {
    "rclpy": (("exec_depend", "depend"), "when is an import carried out: at the build, or at the run?"),
    "math": (("",), "it comes with Python, and nobody can install it."),
    "python3-pytest": (("test_depend",), "who only runs the node does not need it."),
    "ament_cmake": (("buildtool_depend",), "it is a tool, not a library."),
    "eigen": (("build_depend",), "the compiler needs it, and nobody afterwards."),
    "sensor_msgs": (("depend",), "it is needed at two times, and one tag stands for both."),
}
NO_TAG = ("none", "no", "-")

# The keys of modules whose names differ from them; a ROS package is its own key.
KEYS = {
    "PIL": "python3-pil",
    "cv2": "python3-opencv",
    "numpy": "python3-numpy",
    "pytest": "python3-pytest",
    "serial": "python3-serial",
    "tf2_ros": "tf2_ros_py",
    "yaml": "python3-yaml",
}
# What wind_report imports, as keys: its program must not become simpler instead.
WIND_REPORT_KEYS = {"rclpy", "geometry_msgs", "std_msgs", "python3-yaml"}

# Packages that need each other and others, by the tags that are named.
WORKSPACE = (
    ("arm_driver", {"depend": ["rclpy", "arm_model"], "test_depend": ["python3-pytest"]}),
    ("arm_model", {"buildtool_depend": ["ament_cmake"], "build_depend": ["eigen"]}),
    ("arm_app", {"exec_depend": ["arm_driver", "python3-yaml", "rclpy"], "test_depend": ["arm_model"]}),
)

QUIZ = (
    Question(
        "b",
        "The build of a Python package copies, and does not import.",
        {
            "a": "you have seen a build without any declaration.",
            "c": "was there a warning when the station was built?",
        },
    ),
    Question(
        "c",
        "The key, with a tag for the time when it runs.",
        {"a": "that is the name of the import.", "b": "the node imports it, not only its tests."},
    ),
    Question(
        "a",
        "What lies in the workspace is built, not installed.",
        {"b": "src stands for source, but whose?", "c": "without the folder there would be nothing to read."},
    ),
    Question(
        "c",
        "Only there is nothing left over that could help by luck.",
        {
            "a": "it shows an order, also a wrong one.",
            "b": "what an earlier build has installed is found, declared or not.",
        },
    ),
)


@exercise
def tags(function: Any) -> str:
    """Check that `function` returns a right tag for each of the names.

    Args:
        function: takes nothing, returns the tags by name.

    Raises:
        CheckError: if a name is missing, or its tag is not right.
    """
    answer = answer_of(function, call="tags()")
    if not isinstance(answer, Mapping):
        raise CheckError(
            "tags() returns a dictionary, a tag for each name",
            repr(answer),
            'write return {"rclpy": "...", and so on}.',
        )
    for name, (right, hint) in TAGS.items():
        if name not in answer:
            raise CheckError(f"a tag for {name}", "none", 'where no tag is right, write "".')
        tag = str(answer[name] or "").strip().strip("</>").lower()
        if ("" if tag in NO_TAG else tag) not in right:
            raise CheckError(f"the right tag for {name}", repr(answer[name]), hint)
    return "Right: each dependency has its time, and each time has its tag."


@exercise
def undeclared(function: Any) -> str:
    """Check that `function` returns what rain_gauge imports and does not declare.

    Args:
        function: takes nothing, returns the names.

    Raises:
        CheckError: if there is a name too many or too few.
    """
    folder = _package("rain_gauge")
    missing = _imported_keys(folder) - _declared(folder, "exec_depends")
    answer = answer_of(function, call="undeclared()")
    if isinstance(answer, str):
        answer = [answer]
    if not isinstance(answer, Iterable):
        raise CheckError("undeclared() returns a list of names", repr(answer), 'write return ["..."].')
    found = {str(name) for name in answer}
    for name in sorted(found - missing):
        raise CheckError("only names that are missing", name, _why_not(name, folder))
    if missing - found:
        raise CheckError(
            f"{len(missing)} name{'s' * (len(missing) > 1)} to be declared",
            f"{len(found)}",
            "go through the imports one by one: Python's own, this package's own, or declared?",
            "look at the messages.",
        )
    return "Right: that one would be missing on the next machine."


@exercise
def declared() -> str:
    """Check that the package.xml of wind_report declares what its program imports, for the run, and no more.

    Raises:
        CheckError: if something is missing, has a tag for another time, or is too much.
    """
    folder = _package("wind_report")
    needed = _imported_keys(folder)
    if not needed >= WIND_REPORT_KEYS:
        raise CheckError(
            "the program with its imports", "fewer of them", "run the cell again that saves report.py."
        )
    at_run = _declared(folder, "exec_depends")
    anywhere = at_run | _declared(folder, "build_depends", "buildtool_depends", "test_depends")
    allowed = needed | {KEYS["pytest"]}
    for name in sorted(anywhere - allowed):
        if not name.startswith("ament_"):  # the style checks and the build tool
            raise CheckError("nothing but what is needed", name, _why_not(name, folder))
    for name in sorted(needed - at_run):
        is_elsewhere = name in anywhere
        raise CheckError(
            f"{len(needed)} dependencies that are there when the program runs",
            f"{len(needed & at_run)} of them",
            "one is declared, but with a tag for another time."
            if is_elsewhere
            else "go through the imports: which ones do not come with Python, and what are their keys?",
            f"look at {name}.",
        )
    return "Right: the next machine gets all that the program imports."


@exercise
def keys(function: Any) -> str:
    """Check that `function` returns what packages need from outside their workspace.

    Args:
        function: takes a list of packages as catkin_pkg reads them, returns the names.

    Raises:
        CheckError: if there is a name too many or too few.
    """
    packages = [parse_package_string(_manifest(name, wanted)) for name, wanted in WORKSPACE]
    own = {name for name, _ in WORKSPACE}
    answer = answer_of(function, packages, call="keys(packages)")
    if isinstance(answer, str) or not isinstance(answer, Iterable):
        raise CheckError("keys(packages) returns a set of names", repr(answer), "does it end with a return?")
    found = list(answer)
    if not all(isinstance(name, str) for name in found):
        raise CheckError(
            "names",
            "something else",
            "each entry of a list is a dependency, and has a name: dependency.name.",
        )
    for tag, hint in (
        ("buildtool_depend", "is the list buildtool_depends looked at?"),
        ("build_depend", "is the list build_depends looked at?"),
        ("exec_depend", "is the list exec_depends looked at?"),
        ("test_depend", "is the list test_depends looked at?"),
        ("depend", "are all packages looked at, or only the last one?"),
    ):
        names = {name for _, wanted in WORKSPACE for name in wanted.get(tag, ())} - own
        if names - set(found):
            raise CheckError(f"the key of each <{tag}>", f"no {', '.join(sorted(names - set(found)))}", hint)
    if own & set(found):
        raise CheckError(
            "no package of the workspace itself",
            ", ".join(sorted(own & set(found))),
            "what lies in src is built, not installed: leave those names out.",
        )
    needed = {name for _, wanted in WORKSPACE for some in wanted.values() for name in some} - own
    if set(found) - needed or len(found) != len(set(found)):
        raise CheckError(
            f"{len(needed)} names, each once", f"{len(found)} names", "a set holds each name only once."
        )
    return "Right: these are the keys that rosdep would look up."


quiz = quiz_of(__name__, QUIZ)


def _package(name: str) -> Path:
    """Return the folder of a package of the survey."""
    folder = course.student_path(f"{SURVEY}/{name}")
    if not (folder / "package.xml").is_file():
        raise CheckError(
            f"{course.shown_path(folder)}/package.xml",
            "nothing there",
            "run the cell that makes the package.",
        )
    return folder


def _imported(folder: Path) -> set[str]:
    """Return the modules that the files of a Python package import, by the first part of their names."""
    found: set[str] = set()
    for file in sorted((folder / folder.name).rglob("*.py")):
        try:
            nodes = list(ast.walk(ast.parse(file.read_text(encoding="utf-8"))))
        except SyntaxError as error:
            raise CheckError(
                f"{course.shown_path(file)} is Python", f"line {error.lineno}: {error.msg}", "mend that line."
            ) from error
        for node in nodes:
            if isinstance(node, ast.Import):
                found |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                found.add(node.module.partition(".")[0])
    return found


def _imported_keys(folder: Path) -> set[str]:
    """Return the keys of what a package imports, without Python's own modules and the package's own."""
    modules = _imported(folder) - set(sys.stdlib_module_names) - {folder.name}
    return {KEYS.get(module, module) for module in modules}


def _declared(folder: Path, *purposes: str) -> set[str]:
    """Return the names that a package.xml declares for any of the purposes, such as `exec_depends`."""
    try:
        package = parse_package(str(folder), warnings=[])
    except InvalidPackage as error:
        lines = [line.strip() for line in str(error).splitlines() if line.strip()]
        raise CheckError(
            f"{course.shown_path(folder)}/package.xml can be read",
            " ".join(lines[1:] or lines),
            "each tag is opened and closed by the same name, inside <package> and before <export>.",
        ) from error
    return {str(entry.name) for purpose in purposes for entry in getattr(package, purpose)}


def _why_not(name: str, folder: Path) -> str:
    """Return why a name is not to be declared, or not to be declared again."""
    if name in sys.stdlib_module_names:
        return f"{name} comes with Python, and is no key."
    if name == folder.name:
        return "a package does not depend on itself."
    if name in KEYS:
        return f"{name} is the name in the import: what is the key?"
    if name in _declared(folder, "exec_depends") and name in _imported_keys(folder):
        return f"{name} is declared already."
    return f"does the program import {name}?"


def _manifest(name: str, wanted: Mapping[str, Iterable[str]]) -> str:
    lines = "".join(f"<{tag}>{needed}</{tag}>" for tag, some in wanted.items() for needed in some)
    return (
        f'<package format="3"><name>{name}</name><version>1.0.0</version><description>An arm</description>'
        f'<maintainer email="ada@example.org">Ada</maintainer><license>Apache-2.0</license>{lines}</package>'
    )
