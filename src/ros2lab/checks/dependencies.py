"""The exercises of `06_dependencies`."""

from __future__ import annotations

import ast
import difflib
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from importlib.metadata import packages_distributions
from pathlib import Path
from typing import Any

from catkin_pkg.package import parse_package_string

from ros2lab import course
from ros2lab.checks import CheckError, answer_of, exercise, predict_of, questions_of, quiz_of
from ros2lab.checks.manifests import manifest_of, names_in_export
from ros2lab.checks.programs import create_package
from ros2lab.manifest_words import KEYS

SURVEY = "~/survey_ws/src"

WEATHER = "~/weather_ws/src"

# What the packages of the lesson are made of.
APP = """from weather_units.degrees import fahrenheit


def main() -> None:
    \"\"\"Print a temperature.\"\"\"
    print(fahrenheit(21.5), "degrees Fahrenheit")
"""
DEGREES = """def fahrenheit(celsius: float) -> float:
    \"\"\"Return a temperature in degrees Fahrenheit.\"\"\"
    return celsius * 9 / 5 + 32
"""
FUNNEL = "AREA = 0.02  # m²\n"
GAUGE = """import time

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import RelativeHumidity
from std_msgs.msg import Float64

from rain_gauge.funnel import AREA


class Gauge(Node):
    \"\"\"Publishes how much rain has fallen, in litres per square metre.\"\"\"

    def __init__(self) -> None:
        super().__init__("gauge")
        self.rain = self.create_publisher(Float64, "rain", 10)
        self.humidity = self.create_subscription(RelativeHumidity, "humidity", self.keep, 10)

    def keep(self, message: RelativeHumidity) -> None:
        self.last = (time.monotonic(), message.relative_humidity / AREA)


def main() -> None:
    rclpy.init()
    rclpy.spin(Gauge())
"""
REPORT = """import math

import rclpy
import yaml
from geometry_msgs.msg import Vector3
from std_msgs.msg import Float64

SETTINGS = yaml.safe_load("unit: m/s")


def strength(wind: Vector3) -> Float64:
    \"\"\"Return how fast the air moves.\"\"\"
    return Float64(data=math.hypot(wind.x, wind.y))


def main() -> None:
    rclpy.init()
    print(strength(Vector3(x=3.0, y=4.0)).data, SETTINGS["unit"])
    rclpy.try_shutdown()
"""

# For each name the tags that are right, alone or together, and what is said of others.
TAGS: Mapping[str, tuple[tuple[frozenset[str], ...], str]] = {
    "rclpy": (
        (frozenset({"exec_depend"}), frozenset({"depend"})),
        "Python carries out an import when the node runs.",
    ),
    "math": ((frozenset(),), 'math comes with Python, and nobody can install it: write "".'),
    "python3-pytest": (
        (frozenset({"test_depend"}),),
        "only the tests need it, so it is needed while testing.",
    ),
    "ament_cmake": ((frozenset({"buildtool_depend"}),), "it is the tool that builds, not a library."),
    "eigen": ((frozenset({"build_depend"}),), "the compiler needs it, and nobody afterwards."),
    "sensor_msgs": (
        (frozenset({"depend"}), frozenset({"build_depend", "exec_depend"})),
        "it is needed at two times, and one tag stands for both.",
    ),
}
NO_TAG = ("", "none", "no", "-")
KNOWN_TAGS = (
    "buildtool_depend",
    "build_depend",
    "build_export_depend",
    "exec_depend",
    "test_depend",
    "depend",
)

# What wind_report imports, as keys: its program must not become simpler instead.
WIND_REPORT_KEYS = {"rclpy", "geometry_msgs", "std_msgs", "python3-yaml"}

# Packages that need each other and others, by the tags that are named.
WORKSPACE = (
    ("arm_driver", {"depend": ["rclpy", "arm_model"], "test_depend": ["python3-pytest"]}),
    ("arm_model", {"buildtool_depend": ["ament_cmake"], "build_depend": ["eigen"]}),
    ("arm_app", {"exec_depend": ["arm_driver", "python3-yaml", "rclpy"], "test_depend": ["arm_model"]}),
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
            raise CheckError(f"a tag for {name}", "none", f'add {name}; where no tag is right, write "".')
        given = _tags(answer[name])
        unknown = sorted(given.difference(KNOWN_TAGS))
        if unknown:
            raise CheckError(
                f"a tag of the table for {name}", unknown[0], f"the tags are {', '.join(KNOWN_TAGS)}."
            )
        if given not in right:
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
    folder = course.student_path(f"{SURVEY}/rain_gauge")
    missing = _imported_keys(folder) - _declared(folder, "exec_depends")
    answer = answer_of(function, call="undeclared()")
    if isinstance(answer, str):
        answer = [answer]
    if not isinstance(answer, Iterable):
        raise CheckError("undeclared() returns a list of names", repr(answer), 'write return ["..."].')
    found = {str(name).strip() for name in answer}
    for name in sorted(found - missing):
        raise CheckError("only names that are missing in package.xml", name, next(_why_not(name, folder)))
    if missing - found:
        raise CheckError(
            f"{len(missing)} name{'s' * (len(missing) > 1)} to be declared",
            ", ".join(sorted(found)) or "no name",
            "go through the imports one by one: is it Python's own, this package's own, or declared? What is left "
            "is the answer.",
            "look at the messages.",
        )
    return "Right: that one would be missing on the next machine."


@exercise
def declared() -> str:
    """Check that the package.xml of wind_report declares what its program imports, for the run, and no more.

    Raises:
        CheckError: if something is missing, has a tag for another time, or is too much.
    """
    folder = course.student_path(f"{SURVEY}/wind_report")
    needed = _imported_keys(folder)
    if not needed >= WIND_REPORT_KEYS:
        raise CheckError(
            "report.py with its imports",
            f"it imports only {', '.join(sorted(needed)) or 'what comes with Python'}",
            "package.xml follows the program, not the other way round: put the imports back.",
        )
    at_run = _declared(folder, "exec_depends")
    elsewhere = {
        tag: _declared(folder, f"{tag}s") for tag in ("build_depend", "buildtool_depend", "test_depend")
    }
    expected = "all that the program imports is declared for the run, and nothing else"
    for name in sorted(at_run.union(*elsewhere.values()) - needed - {KEYS["pytest"]}):
        if not name.startswith("ament_"):  # the style checks and the build tool
            raise CheckError(expected, f"{name} is declared", next(_why_not(name, folder)))
    for name in sorted(needed - at_run):
        for tag, names in elsewhere.items():
            if name in names:
                raise CheckError(
                    expected,
                    f"{name} is declared with <{tag}>",
                    "the program imports it when it runs: write <exec_depend>, or <depend>.",
                )
        if name in names_in_export(manifest_of(folder)):
            raise CheckError(
                expected, f"{name} stands in <export>", "move its line up, so that it stands before <export>."
            )
        raise CheckError(
            expected,
            f"declared are {', '.join(sorted(needed & at_run))}"
            if needed & at_run
            else "nothing is declared",
            f"the program imports {_module_of(name)}, and no line declares it: write a line before <export>.",
            f"the key is {name}.",
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
            "keys(packages) returns names",
            next(type(name).__name__ for name in found if not isinstance(name, str)),
            "each entry of a list is a dependency, and has a name: dependency.name.",
        )
    needed = {name for _, wanted in WORKSPACE for some in wanted.values() for name in some} - own
    if set(found) - needed - own:
        raise CheckError(
            "only names that a package.xml holds",
            ", ".join(sorted(set(found) - needed - own)),
            "take the names from the lists of the packages that are handed in, and add none of your own.",
        )
    for package, tag, name in (
        (package, tag, name)
        for package, wanted in WORKSPACE
        for tag, names in wanted.items()
        for name in names
    ):
        if name not in own.union(found):
            raise CheckError(
                "all that the packages need from outside",
                f"no {name}",
                f"one of the packages ({package}) declares it with <{tag}>: look at all four lists of every package.",
            )
    if own & set(found):
        raise CheckError(
            "no package of the workspace itself",
            ", ".join(sorted(own & set(found))),
            "what lies in src is built, not installed: leave those names out.",
        )
    if len(found) != len(set(found)):
        raise CheckError(
            f"{len(needed)} names, each once", f"{len(found)} names", "a set holds each name only once."
        )
    return "Right: these are the keys that rosdep would look up."


QUIZ, PREDICTIONS = questions_of(__name__)
quiz = quiz_of(__name__, QUIZ)
predict = predict_of(__name__, PREDICTIONS)


def make_survey() -> str:
    """Make the packages `rain_gauge` and `wind_report`; what is there already stays as it is.

    Raises:
        OSError: if a file cannot be written.
        subprocess.CalledProcessError: if `ros2 pkg create` fails.
    """
    source = course.student_path(SURVEY)
    gauge = {"rain_gauge/gauge.py": GAUGE, "rain_gauge/funnel.py": FUNNEL}
    create_package(source, "rain_gauge", gauge, "--node-name", "gauge", "--dependencies", "rclpy", "std_msgs")
    create_package(source, "wind_report", {"wind_report/report.py": REPORT}, "--node-name", "report")
    return f"rain_gauge and wind_report are in {SURVEY}."


def make_weather() -> str:
    """Make the packages `weather_units` and `weather_app`; what is there already stays as it is.

    Raises:
        OSError: if a file cannot be written.
        subprocess.CalledProcessError: if `ros2 pkg create` fails.
    """
    source = course.student_path(WEATHER)
    create_package(source, "weather_units", {"weather_units/degrees.py": DEGREES})
    create_package(source, "weather_app", {"weather_app/app.py": APP}, "--node-name", "app")
    return f"weather_units and weather_app are in {WEATHER}."


def _imported(folder: Path) -> set[str]:
    """Return the modules that the files of a Python package import, by the first part of their names."""
    found: set[str] = set()
    for file in sorted((folder / folder.name).rglob("*.py")):
        try:
            nodes = list(ast.walk(ast.parse(file.read_text(encoding="utf-8"))))
        except SyntaxError as error:
            raise CheckError(
                f"{course.shown_path(file)} is Python", f"line {error.lineno}: {error.msg}", "fix that line."
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


def _declared(folder: Path, purpose: str) -> set[str]:
    """Return the names that a package.xml declares for a purpose, such as `exec_depends`."""
    return {str(entry.name) for entry in getattr(manifest_of(folder), purpose)}


def _why_not(name: str, folder: Path) -> Iterator[str]:
    """Yield why a name is not to be declared, or not to be declared again, the best reason first."""
    needed = _imported_keys(folder)
    package = name.partition(".")[0]
    if package in sys.stdlib_module_names:
        yield f"{name} comes with Python, and is no key: nobody can install it."
    if name == folder.name:
        yield "it is this package itself, and a package does not depend on itself."
    if name in KEYS:
        yield f"{name} is the name in the import, and not the key: look it up in the table."
    if name in needed:
        yield f"{name} is declared already."
    if re.search(r"[\s,]", name):
        yield "each name has a tag of its own."
    if package in needed:
        yield f"declare the package, not what is in it: {package}."
    for module in KEYS:
        if name in packages_distributions().get(module, ()):
            yield f"{name} is the name that pip uses, and not the key: look up {module} in the table."
    for near in difflib.get_close_matches(name, needed, n=1, cutoff=0.85):
        yield f"the program imports {_module_of(near)}, and not {name}: compare the names letter by letter."
    yield f"the program does not import {name}."


def _module_of(key: str) -> str:
    return next((module for module, known in KEYS.items() if known == key), key)


def _tags(given: object) -> frozenset[str]:
    """Return the tags that are meant, with or without brackets."""
    several = given if isinstance(given, (list, tuple, set, frozenset)) else (given,)
    tags = {str(tag if tag is not None else "").strip().strip("</>").lower() for tag in several}
    return frozenset(tags.difference(NO_TAG))


def _manifest(name: str, wanted: Mapping[str, Iterable[str]]) -> str:
    lines = "".join(f"<{tag}>{needed}</{tag}>" for tag, some in wanted.items() for needed in some)
    return (
        f'<package format="3"><name>{name}</name><version>1.0.0</version><description>An arm</description>'
        f'<maintainer email="ada@example.org">Ada</maintainer><license>Apache-2.0</license>{lines}</package>'
    )
