"""A package of interfaces that was handed in has in its stand-in what its files define, and nothing else."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from ros2lab.grading.reading import stand_in
from ros2lab.grading.reading.absent import interfaces_in

BEGIN = "cmake_minimum_required(VERSION 3.8)\nproject(robot_msgs)\nfind_package(ament_cmake REQUIRED)\n"
SPEED, SET = "float64 speed 1.0  # m/s\nuint8 FAST=3\nstring<=9[<=4] tags\n", "bool data\n---\nbool success\n"
FILES = {"msg/Speed.msg": SPEED, "srv/Set.srv": SET}
KNOWN = {"msg/Speed": ["speed", "FAST", "tags"], "srv/Set": ["data", "success"]}


def folder_with(folder: Path, script: str, files: dict[str, str] = FILES) -> Path:
    for name, text in files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)
    (folder / "CMakeLists.txt").write_text(f"{BEGIN}{script}ament_package()\n")
    return folder


@pytest.mark.parametrize(
    "script",
    [
        'rosidl_generate_interfaces(${PROJECT_NAME} "msg/Speed.msg" "srv/Set.srv")\n',
        "rosidl_generate_interfaces(robot_msgs\n  msg/Speed.msg  # the speed\n  srv/Set.srv\n  DEPENDENCIES std_msgs)\n",
        'set(files "msg/Speed.msg" "srv/Set.srv")\nrosidl_generate_interfaces(${PROJECT_NAME} ${files})\n',
        'set(m msg/Speed.msg)\nset(s\n  "srv/Set.srv"\n)\nrosidl_generate_interfaces(robot_msgs ${m} ${s})\n',
    ],
)
def test_interfaces_that_are_named_literally_are_known(tmp_path: Path, script: str) -> None:
    assert interfaces_in(folder_with(tmp_path, script)) == KNOWN


@pytest.mark.parametrize(
    ("script", "known"),
    [
        ("", {}),
        ('rosidl_generate_interfaces(${PROJECT_NAME} "srv/Set.srv")\n', {"srv/Set": KNOWN["srv/Set"]}),
    ],
)
def test_what_cmake_does_not_name_is_not_there(
    tmp_path: Path, script: str, known: dict[str, list[str]]
) -> None:
    assert interfaces_in(folder_with(tmp_path, script)) == known


@pytest.mark.parametrize(
    "script",
    [
        'file(GLOB files "msg/*.msg")\nrosidl_generate_interfaces(${PROJECT_NAME} ${files})\n',
        "include(cmake/interfaces.cmake)\n",
        "rosidl_generate_interfaces(${PROJECT_NAME} ${files})\n",
        'rosidl_generate_interfaces(${PROJECT_NAME} "msg/Made.msg")\n',
        'rosidl_generate_interfaces(${PROJECT_NAME} "msg/Speed.idl")\n',
        'rosidl_generate_interfaces(${PROJECT_NAME} "${CMAKE_BINARY_DIR}/msg/Speed.msg")\n',
        'set(a "msg/Speed.msg")\nset(a ${a} "srv/Set.srv")\nrosidl_generate_interfaces(${PROJECT_NAME} ${a})\n',
        'set(a "msg/Speed.msg")\nlist(APPEND a "srv/Set.srv")\nrosidl_generate_interfaces(${PROJECT_NAME} ${a})\n',
    ],
)
def test_where_others_may_be_generated_nothing_is_known(tmp_path: Path, script: str) -> None:
    assert interfaces_in(folder_with(tmp_path, script)) is None


def test_of_an_empty_folder_nothing_is_known(tmp_path: Path) -> None:
    """As of a git submodule that was not handed in."""
    assert interfaces_in(tmp_path) is None


# Python with std_msgs and std_srvs of its own, for these are not needed otherwise.
HEAD = """
import sys, types
class Empty: pass
class Call:
    class Request: pass
    class Response: pass
for name, kind, what in (("std_msgs", "msg", Empty), ("std_srvs", "srv", Call)):
    sys.modules[name] = types.ModuleType(name)
    inner = sys.modules[f"{name}.{kind}"] = types.ModuleType(f"{name}.{kind}")
    inner.Empty = what
"""


def said_by(folder: Path, code: str, *, is_known: bool) -> str:
    """Return the last line of what a program says that uses a package of interfaces and another library."""
    text = Path(stand_in.__file__).read_text(encoding="utf-8")
    (folder / "robot_msgs.py").write_text(f"{text}\nINTERFACES = {KNOWN if is_known else None}\n")
    (folder / "others_msgs.py").write_text(f"{text}\nINTERFACES = None\n")
    done = subprocess.run(
        [sys.executable, "-c", HEAD + code],
        env={"PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    return (done.stderr.strip().splitlines() or [""])[-1]


@pytest.mark.parametrize(
    "code",
    [
        "from robot_msgs.msg import Speed\nSpeed().speed\nSpeed.FAST\nm = Speed(speed=1.0)\nm.speed = 2.0\nm.tags",
        "import robot_msgs.msg\nrobot_msgs.msg.Speed()",
        "from robot_msgs import msg, srv\nmsg.Speed()\nsrv.Set.Request().data\nsrv.Set.Response(success=True)",
        "from robot_msgs.srv import Set\nr = Set.Request()\nr.data = True",
        "from robot_msgs.msg import Speed\nEmpty().speed",  # received
        "from robot_msgs.msg import Speed\nfrom others_msgs.msg import X\nX().a\nEmpty().a\nSpeed().speed",
        "from others_msgs.msg import X\nfrom robot_msgs.msg import Speed\nX().a = 1\nEmpty().a",
        "from robot_msgs.tools import helper\nimport robot_msgs\nrobot_msgs.clock()",
    ],
)
@pytest.mark.parametrize("is_known", [True, False])
def test_what_was_handed_in_is_there(tmp_path: Path, code: str, is_known: bool) -> None:
    assert said_by(tmp_path, code, is_known=is_known) == ""


@pytest.mark.parametrize(
    ("code", "error"),
    [
        ("from robot_msgs.msg import Sped", "ImportError: cannot import name 'Sped'"),
        ("import robot_msgs.msg.Sped", "ModuleNotFoundError"),
        ("from robot_msgs import msg\nmsg.Sped()", "AttributeError"),
        ("from robot_msgs.srv import Speed", "ImportError"),
        ("from robot_msgs.action import Drive", "ImportError"),
        ("from robot_msgs.msg import Speed\nSpeed().velocity", "AttributeError"),
        ("from robot_msgs.msg import Speed\nSpeed.SLOW", "AttributeError"),
        ("from robot_msgs.msg import Speed\nSpeed().velocity = 1.0", "AttributeError"),
        ("from robot_msgs.msg import Speed\nEmpty().velocity", "AttributeError"),  # received
        ("from robot_msgs.srv import Set\nSet.Request().value", "AttributeError"),
        ("from robot_msgs.srv import Set\nCall.Request().value", "AttributeError"),
    ],
)
def test_what_was_not_handed_in_fails_as_anywhere(tmp_path: Path, code: str, error: str) -> None:
    """And is not called something that is not installed."""
    said = said_by(tmp_path, code, is_known=True)
    assert said.startswith(error)
    assert stand_in.NotInstalledHere.__name__ not in said
    assert said_by(tmp_path, code, is_known=False) == ""
