"""The checks of the dependencies lesson accept every right answer, and say what is wrong with the others."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pytest

from ros2lab import checks
from ros2lab.checks import CheckError
from ros2lab.checks import dependencies as check

MANIFEST = """<?xml version="1.0"?>
<package format="3">
  <name>{name}</name>
  <version>1.0.0</version>
  <description>A test</description>
  <maintainer email="ada@example.org">Ada</maintainer>
  <license>Apache-2.0</license>
  {lines}
  <test_depend>ament_flake8</test_depend>
  <test_depend>python3-pytest</test_depend>
  <export>
    <build_type>ament_python</build_type>
  </export>
</package>
"""
GAUGE = """import time

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import RelativeHumidity
from std_msgs.msg import Float64

from rain_gauge.funnel import AREA
"""
REPORT = """import math

import rclpy
import yaml
from geometry_msgs.msg import Vector3
from std_msgs.msg import Float64
"""
TAGS = {
    "rclpy": "exec_depend",
    "math": "",
    "python3-pytest": "test_depend",
    "ament_cmake": "buildtool_depend",
    "eigen": "build_depend",
    "sensor_msgs": "depend",
}
NEEDED = ("rclpy", "geometry_msgs", "std_msgs", "python3-yaml")


def make_package(folder: Path, code: str, lines: str) -> Path:
    """Make a package of one module, as far as the checks look at it."""
    module = folder / folder.name / "module.py"
    module.parent.mkdir(parents=True)
    module.write_text(code)
    (folder / "package.xml").write_text(MANIFEST.format(name=folder.name, lines=lines))
    return folder


def tagged(tag: str, *names: str) -> str:
    return "\n".join(f"<{tag}>{name}</{tag}>" for name in names)


@pytest.fixture(autouse=True)
def survey(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give the test a student's folder with the two packages as the lesson makes them."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path / "my work"))
    monkeypatch.setattr(checks, "_failures", Counter())  # each test gets the first hint
    source = tmp_path / "my work" / "survey_ws" / "src"
    make_package(source / "rain_gauge", GAUGE, tagged("depend", "rclpy", "std_msgs"))
    make_package(source / "wind_report", REPORT, "")
    return source


@pytest.mark.parametrize(
    "right",
    [
        lambda: TAGS,
        lambda: {**TAGS, "rclpy": "depend", "math": None},
        lambda: {name: f"<{tag}>" if tag else "none" for name, tag in TAGS.items()},
        lambda: MappingProxyType({**TAGS, "launch": "exec_depend"}),
    ],
)
def test_right_tags(right: Callable[[], Any]) -> None:
    """With or without brackets; where two tags are right, both are."""
    assert check.tags(right).startswith("Right")


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda: None, "a dictionary"),
        (lambda: list(TAGS), "a dictionary"),
        (lambda: {**TAGS, "rclpy": "build_depend"}, "the right tag for rclpy.*when is an import"),
        (lambda: {**TAGS, "math": "exec_depend"}, "comes with Python"),
        (lambda: {**TAGS, "python3-pytest": "depend"}, "who only runs the node"),
        (lambda: {**TAGS, "ament_cmake": "build_depend"}, "it is a tool"),
        (lambda: {**TAGS, "eigen": "depend"}, "the compiler needs it"),
        (lambda: {**TAGS, "sensor_msgs": "exec_depend"}, "at two times"),
        (lambda: {name: tag for name, tag in TAGS.items() if name != "eigen"}, "a tag for eigen"),
        (lambda: TAGS["rospy"], "it raised KeyError"),
        (TAGS, "without its parentheses"),
    ],
)
def test_wrong_tags(wrong: Any, message: str) -> None:
    """Each name has a hint of its own."""
    with pytest.raises(CheckError, match=message):
        check.tags(wrong)


@pytest.mark.parametrize(
    "right",
    [lambda: ["sensor_msgs"], lambda: {"sensor_msgs"}, lambda: ("sensor_msgs",), lambda: "sensor_msgs"],
)
def test_the_right_one_undeclared(right: Callable[[], Any]) -> None:
    """Any collection counts."""
    assert check.undeclared(right).startswith("Right")


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda: None, "a list of names"),
        (list, "1 name to be declared"),
        (lambda: ["sensor_msgs", "time"], "time comes with Python"),
        (lambda: ["rain_gauge"], "does not depend on itself"),
        (lambda: ["std_msgs", "sensor_msgs"], "std_msgs is declared already"),
        (lambda: ["geometry_msgs"], "does the program import geometry_msgs"),
        (lambda: [1 / 0], "it raised ZeroDivisionError"),
        ("sensor_msgs", "without its parentheses"),
    ],
)
def test_a_wrong_one_undeclared(wrong: Any, message: str) -> None:
    """Why a name does not belong there is told."""
    with pytest.raises(CheckError, match=message):
        check.undeclared(wrong)


@pytest.mark.parametrize(
    "lines",
    [
        tagged("exec_depend", *NEEDED),
        tagged("depend", *NEEDED),
        tagged("depend", *NEEDED[:2]) + tagged("exec_depend", *NEEDED[2:]),
        tagged("build_depend", *NEEDED)
        + tagged("exec_depend", *NEEDED)
        + tagged("buildtool_depend", "ament_python"),
        '<exec_depend version_gte="1.0.0">rclpy</exec_depend>' + tagged("depend", *reversed(NEEDED[1:])),
    ],
)
def test_a_complete_manifest(survey: Path, lines: str) -> None:
    """Either of two tags, in any order, with more where it does no harm."""
    (survey / "wind_report" / "package.xml").write_text(MANIFEST.format(name="wind_report", lines=lines))
    assert check.declared().startswith("Right")


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("", "Found: 0 of them"),
        (tagged("depend", *NEEDED[:-1]), "Found: 3 of them.*what are their keys"),
        (tagged("depend", *NEEDED[:-1], "yaml"), "name in the import"),
        (tagged("depend", *NEEDED, "math"), "math comes with Python"),
        (tagged("depend", *NEEDED, "sensor_msgs"), "does the program import sensor_msgs"),
        (tagged("depend", *NEEDED, "wind_report"), "same name as this package"),
        (tagged("depend", *NEEDED[1:]) + tagged("build_depend", "rclpy"), "a tag for another time"),
        (tagged("depend", *NEEDED[1:]) + tagged("test_depend", "rclpy"), "a tag for another time"),
        ("<depend>rclpy<depend>", "can be read"),
        (tagged("depends", *NEEDED), "can be read"),
    ],
)
def test_an_incomplete_manifest(survey: Path, lines: str, message: str) -> None:
    """What is missing, too much, at the wrong time or no XML is told apart."""
    (survey / "wind_report" / "package.xml").write_text(MANIFEST.format(name="wind_report", lines=lines))
    with pytest.raises(CheckError, match=message):
        check.declared()


def test_a_program_that_imports_less(survey: Path) -> None:
    """The manifest is to follow the program, not the other way round."""
    (survey / "wind_report" / "wind_report" / "module.py").write_text("import math\n")
    with pytest.raises(CheckError, match=r"saves report\.py"):
        check.declared()


def test_a_program_that_is_no_python(survey: Path) -> None:
    """The line is told."""
    (survey / "wind_report" / "wind_report" / "module.py").write_text("import math\nimport\n")
    with pytest.raises(CheckError, match="line 2"):
        check.declared()


def test_a_package_that_is_not_there(survey: Path) -> None:
    """A cell makes it."""
    (survey / "wind_report" / "package.xml").unlink()
    with pytest.raises(CheckError, match="run the cell that makes the package"):
        check.declared()


PURPOSES = ("buildtool_depends", "build_depends", "exec_depends", "test_depends")


def with_comprehension(packages: list[Any]) -> Any:
    names = {
        entry.name for package in packages for purpose in PURPOSES for entry in getattr(package, purpose)
    }
    return names - {package.name for package in packages}


def with_loops(packages: list[Any]) -> Any:
    own = [package.name for package in packages]
    found = []
    for package in packages:
        for some in (
            package.test_depends,
            package.exec_depends,
            package.build_depends,
            package.buildtool_depends,
        ):
            for entry in some:
                if entry.name not in own and entry.name not in found:
                    found.append(entry.name)
    return found


def with_every_list(packages: list[Any]) -> Any:
    purposes = (*PURPOSES, "build_export_depends", "buildtool_export_depends", "doc_depends")
    names = {
        entry.name for package in packages for purpose in purposes for entry in getattr(package, purpose)
    }
    return sorted(names.difference(package.name for package in packages))


@pytest.mark.parametrize("right", [with_comprehension, with_loops, with_every_list])
def test_right_keys(right: Any) -> None:
    """Any collection, any way of finding them."""
    assert check.keys(right).startswith("Right")


def without(purpose: str) -> Callable[[list[Any]], Any]:
    """Return a function that forgets one of the lists."""

    def keys(packages: list[Any]) -> Any:
        purposes = [one for one in PURPOSES if one != purpose]
        names = {e.name for package in packages for one in purposes for e in getattr(package, one)}
        return names - {package.name for package in packages}

    return keys


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda _: None, "a set of names"),
        (lambda _: "rclpy", "a set of names"),
        (lambda packages: [e for package in packages for e in package.exec_depends], r"dependency\.name"),
        (without("buildtool_depends"), "is the list buildtool_depends looked at"),
        (without("build_depends"), "is the list build_depends looked at"),
        (without("exec_depends"), "is the list exec_depends looked at"),
        (without("test_depends"), "is the list test_depends looked at"),
        (lambda packages: with_comprehension(packages[-1:]), "looked at"),
        (
            lambda packages: with_comprehension(packages) | {package.name for package in packages},
            "leave those names out",
        ),
        (lambda packages: [*with_loops(packages), "rclpy"], "each once"),
        (lambda packages: [*with_loops(packages), "rospy"], "each once"),
        (lambda packages: packages.keys(), "it raised AttributeError"),
        (["rclpy"], "without its parentheses"),
    ],
)
def test_wrong_keys(wrong: Any, message: str) -> None:
    """Which list, which package or which names are forgotten is told."""
    with pytest.raises(CheckError, match=message):
        check.keys(wrong)
